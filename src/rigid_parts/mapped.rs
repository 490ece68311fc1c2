//! A shell with its map, as parts of it see it.

use super::motion::{Oriented, Place};
use crate::adjacency::Adjacency;
use crate::embedded_triangles::TrianglePoint;
use crate::full_refinement::VertexImages;
use crate::mesh::Shell;
use crate::mesh::vector::{Vector, cross, dot, point_areas, squared_norm, subtract};
use crate::refinement::nearest;
use crate::sampling::{area_weighted_vertices, farthest_points};
use crate::shortest_ways::Search;
use crate::surface_walk::SurfaceWalk;
use faer::Mat;
use std::ops::ControlFlow;

/// A turn of the normal by one radian is as unlike as this distance, in sqrt(area).
const TURN: f64 = 0.06;

/// A shell and its map.
pub(super) struct Mapped<'a> {
    pub shell: &'a Shell,
    pub graph: Adjacency,
    pub walk: SurfaceWalk<'a>,
    /// Area of each vertex.
    pub areas: Vec<f64>,
    /// Unit normals of the vertices.
    normals: Vec<Vector>,
    /// Images of the vertices.
    pub found: VertexImages,
    /// Positions of the images.
    pub images: Vec<Vector>,
}

/// The vertices within a radius of one, with their weights, which fall to 0 at the radius.
pub(super) struct Disc {
    pub middle: u32,
    pub members: Vec<(u32, f64)>,
}

/// Vertices among which images are sought.
pub(super) struct Sought {
    vertices: Vec<u32>,
    /// Their places and normals.
    rows: Mat<f32>,
}

impl<'a> Mapped<'a> {
    pub fn new(shell: &'a Shell, found: VertexImages) -> Mapped<'a> {
        let sides = |&[a, b, c]: &[u32; 3]| [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)];
        Mapped {
            shell,
            graph: Adjacency::new(shell.positions.len(), shell.triangles.iter().flat_map(sides)),
            walk: SurfaceWalk::new(&shell.positions, &shell.triangles),
            areas: point_areas(&shell.positions, &shell.triangles),
            normals: normals(shell),
            images: found
                .points
                .iter()
                .map(|point| point.interpolate_vectors(&shell.triangles, &shell.positions))
                .collect(),
            found,
        }
    }

    /// Vertices spread evenly in space.
    pub fn spread(&self, count: usize) -> Vec<u32> {
        let point = |position: &Vector| std::array::from_fn(|j| position.get(j).map_or(0.0, |&x| x as f32));
        let points: Vec<_> = self.shell.positions.iter().map(point).collect();
        farthest_points(&points, count.min(points.len())).into_iter().map(|vertex| vertex as u32).collect()
    }

    pub fn disc(&self, middle: u32, radius: f64) -> Disc {
        let weight = |distance: f64| (1.0 - distance * distance / (radius * radius)).powi(2);
        let within = self.within(&[middle], radius).into_iter();
        Disc { middle, members: within.map(|(vertex, distance)| (vertex, weight(distance))).collect() }
    }

    /// Vertices nearer than `radius` to one of `sources` along edges, the nearest first, with their distances.
    pub fn within(&self, sources: &[u32], radius: f64) -> Vec<(u32, f64)> {
        let edges = |vertex: u32| {
            let from = self.shell.positions[vertex as usize];
            let length =
                move |near: u32| squared_norm(subtract(self.shell.positions[near as usize], from)).sqrt();
            self.graph.of(vertex as usize).iter().map(move |&near| (near, length(near)))
        };
        let mut reached = Vec::new();
        Search::new(self.areas.len()).run(sources, radius, edges, |vertex, distance| {
            reached.push((vertex, distance));
            ControlFlow::Continue(())
        });
        reached
    }

    /// Some of a disc's members, each standing for the same area.
    pub fn picked(&self, members: &[(u32, f64)], count: usize) -> Vec<(u32, f64)> {
        let areas: Vec<f64> = members.iter().map(|&(vertex, _)| self.areas[vertex as usize]).collect();
        let picked = area_weighted_vertices(&areas, count).into_iter().map(|index| members[index]);
        picked.filter(|(_, weight)| *weight > 0.0).collect()
    }

    /// Where members are and where the map puts them.
    pub fn places(&self, members: &[(u32, f64)]) -> Vec<Place> {
        let place = |&(vertex, weight): &(u32, f64)| Place {
            own: self.oriented(vertex),
            image: self.images[vertex as usize],
            partner: self.found.partners[vertex as usize],
            weight,
        };
        members.iter().map(place).collect()
    }

    /// The places' images.
    pub fn sought(&self, places: &[Place]) -> Sought {
        let vertices: Vec<u32> = places.iter().map(|place| place.partner).collect();
        let points: Vec<Oriented> = vertices.iter().map(|&vertex| self.oriented(vertex)).collect();
        Sought { rows: rows(&points), vertices }
    }

    /// A vertex's position and normal.
    pub fn oriented(&self, vertex: u32) -> Oriented {
        Oriented { position: self.shell.positions[vertex as usize], normal: self.normals[vertex as usize] }
    }

    /// The vertex most like `goal` in place and normal, sought downhill from `start`.
    pub fn alike(&self, goal: Oriented, start: u32) -> (u32, Oriented) {
        let unlike = |vertex: u32| unlike(goal, self.oriented(vertex));
        let (mut best, mut least) = (start, unlike(start));
        loop {
            let from = best;
            for &near in self.graph.of(from as usize) {
                let near_unlike = unlike(near);
                if near_unlike < least {
                    (best, least) = (near, near_unlike);
                }
            }
            if best == from {
                return (best, self.oriented(best));
            }
        }
    }

    /// Squared: how unlike `goal` a vertex is.
    pub fn unlike_vertex(&self, goal: Oriented, vertex: u32) -> f64 {
        unlike(goal, self.oriented(vertex))
    }

    /// Squared: how unlike `goal` the surface is near a vertex, between vertices too.
    pub fn unlike_near(&self, goal: Oriented, vertex: u32) -> f64 {
        let (_, point) = self.walk.nearest(goal.position, vertex);
        let normal = unit(point.interpolate_vectors(&self.shell.triangles, &self.normals));
        unlike(
            goal,
            Oriented {
                position: point.interpolate_vectors(&self.shell.triangles, &self.shell.positions),
                normal,
            },
        )
    }

    /// The vertex and the point nearest to where a vertex's image should lie. The map may have torn it from those around it, so
    /// the walk starts from whichever of their images is nearest.
    pub fn nearest(&self, vertex: usize, goal: Vector) -> (u32, TrianglePoint) {
        let partners = &self.found.partners;
        let around = self.graph.of(vertex).iter().map(|&near| partners[near as usize]);
        let start = around.fold(partners[vertex], |start, other| self.walk.nearer(goal, start, other));
        self.walk.nearest(goal, start)
    }

    /// How far the map of some vertices is from an isometry that mirrors the surface, or does not: how much it stretches or shrinks
    /// edges (mean of |ln(length of the image / length)|, at most 1 each), plus the share of the area that it turns the wrong way.
    pub fn strain(&self, of: &[bool], mirrored: bool) -> f64 {
        let (mut stretched, mut length) = (0.0, f64::MIN_POSITIVE);
        let (mut wrong, mut area) = (0.0, f64::MIN_POSITIVE);
        for corners in self.shell.triangles.iter().filter(|corners| corners.iter().all(|&c| of[c as usize])) {
            let edges = |positions: &[Vector]| {
                let [a, b, c] = corners.map(|corner| positions[corner as usize]);
                [subtract(b, a), subtract(c, b), subtract(a, c)]
            };
            let (own, image) = (edges(&self.shell.positions), edges(&self.images));
            for (own, image) in own.iter().zip(&image) {
                let [own, image] = [own, image].map(|edge| squared_norm(*edge).sqrt().max(f64::MIN_POSITIVE));
                stretched += own * (image / own).ln().abs().min(1.0);
                length += own;
            }
            let twice = squared_norm(cross(own[0], own[1])).sqrt();
            let normal = cross(image[0], image[1]);
            let there = |&corner: &u32| self.normals[self.found.partners[corner as usize] as usize];
            let facing: f64 = corners.iter().map(|corner| dot(normal, there(corner))).sum();
            wrong += if (facing > 0.0) == mirrored { twice } else { 0.0 };
            area += twice;
        }
        stretched / length + wrong / area
    }

    /// Gives all vertices other images.
    pub fn replace_all(&mut self, found: VertexImages) {
        self.images = found
            .points
            .iter()
            .map(|point| point.interpolate_vectors(&self.shell.triangles, &self.shell.positions))
            .collect();
        self.found = found;
    }

    /// Gives a vertex another image, and gives its former one back.
    pub fn replace(&mut self, vertex: usize, (partner, point): (u32, TrianglePoint)) -> (u32, TrianglePoint) {
        self.images[vertex] = point.interpolate_vectors(&self.shell.triangles, &self.shell.positions);
        let VertexImages { partners, points } = &mut self.found;
        (std::mem::replace(&mut partners[vertex], partner), std::mem::replace(&mut points[vertex], point))
    }
}

impl Sought {
    /// For each goal the vertex most like it.
    pub fn most_alike(&self, goals: &[Oriented]) -> Vec<u32> {
        let found = nearest(rows(goals).as_ref(), self.rows.as_ref());
        found.into_iter().map(|index| self.vertices[index as usize]).collect()
    }
}

/// Rows whose distances are how unlike the points are.
fn rows(points: &[Oriented]) -> Mat<f32> {
    let number = |point: &Oriented, j: usize| match j {
        0..3 => point.position[j],
        _ => TURN * point.normal[j - 3],
    };
    Mat::from_fn(points.len(), 6, |i, j| number(&points[i], j) as f32)
}

fn unlike(goal: Oriented, there: Oriented) -> f64 {
    let turned = squared_norm(subtract(there.normal, goal.normal));
    squared_norm(subtract(there.position, goal.position)) + TURN * TURN * turned
}

/// Unit normals of the vertices, triangles weighted by area.
fn normals(shell: &Shell) -> Vec<Vector> {
    let mut normals = vec![[0.0; 3]; shell.positions.len()];
    for triangle in &shell.triangles {
        let [a, b, c] = triangle.map(|corner| shell.positions[corner as usize]);
        let normal = cross(subtract(b, a), subtract(c, a));
        for &corner in triangle {
            (0..3).for_each(|axis| normals[corner as usize][axis] += normal[axis]);
        }
    }
    normals.into_iter().map(unit).collect()
}

fn unit(vector: Vector) -> Vector {
    vector.map(|x| x / squared_norm(vector).sqrt().max(f64::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::full_refinement::VertexImages;
    use crate::mesh::Shell;
    use crate::rigid_parts::strip;

    /// Strain of all of a flat strip of 41 x 5 vertices whose columns go where `to` says.
    fn strain_of(to: impl Fn(u32) -> u32, mirrored: bool) -> f64 {
        let shell = strip(|column, row| [f64::from(column) / 40.0, f64::from(row) / 20.0, 0.0]);
        let partners = partners(&shell, to);
        let mapped = Mapped::new(&shell, VertexImages::at_vertices(&shell.triangles, partners));
        mapped.strain(&[true; 5 * 41], mirrored)
    }

    fn partners(shell: &Shell, to: impl Fn(u32) -> u32) -> Vec<u32> {
        let vertex =
            |point: u32| (0..).zip(&shell.points).find(|(_, own)| **own == point).expect("a vertex").0;
        shell.points.iter().map(|point| vertex(5 * to(point / 5) + point % 5)).collect()
    }

    #[test]
    fn a_mirror_image_has_no_strain_and_what_is_not_turned_over_has() {
        assert!(strain_of(|column| 40 - column, true) < 1e-6);
        assert!((strain_of(|column| 40 - column, false) - 1.0).abs() < 1e-6);
        assert!((strain_of(|column| column, true) - 1.0).abs() < 1e-6);
        // The first quarter lies on the one after it.
        let folded = strain_of(|column| if column < 10 { 20 + column } else { 40 - column }, true);
        assert!((folded - 0.25).abs() < 0.05, "{folded}");
    }

    #[test]
    fn what_is_torn_or_squeezed_has_strain() {
        let torn = strain_of(|column| if column < 20 { 19 - column } else { 60 - column }, true);
        let squeezed = strain_of(|column| 40 - column.min(30), true);
        assert!(torn > 0.01 && torn < 0.1, "{torn}");
        // A quarter loses all of its length, and none of its height.
        assert!(squeezed > 0.04 && squeezed < 0.1, "{squeezed}");
    }
}
