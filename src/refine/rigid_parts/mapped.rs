//! A shell with its map, as parts of it see it.

use super::motion::{Oriented, Place};
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::base::threads;
use crate::geometry::adjacency::downhill;
use crate::geometry::shortest_paths::{EdgeLengths, PathSearch};
use crate::geometry::surface_walk::SurfaceWalk;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::Shell;
use crate::mesh::vector::{Vector, cross, dot, point_areas, squared_norm, subtract, summed_normals, unit};
use crate::search::refinement::nearest;
use crate::spectral::sampling::{Point, area_weighted_vertices, farthest_points, squared};
use faer::Mat;
use std::ops::{ControlFlow, Range};

/// A turn of the normal by one radian is as unlike as this distance, in sqrt(area).
const TURN: f64 = 0.06;
/// Discs that a vertex lies in, in the mean over the vertices, before no more are added. Those of the parts are 22 at most on development
/// shapes; where a fan brings all vertices together, each disc has them all.
const MOST_DISCS: usize = 32;

/// A shell and its map.
pub(super) struct Mapped<'a> {
    pub shell: &'a Shell,
    pub walk: SurfaceWalk<'a>,
    /// Area of each vertex.
    pub areas: Vec<f64>,
    /// Edges with their lengths.
    edges: EdgeLengths,
    /// Unit normals of the vertices.
    normals: Vec<Vector>,
    /// Features of the vertices.
    features: Vec<Feature>,
    /// Where the map puts the vertices: on the surface or near it.
    pub images: Vec<Vector>,
    /// The vertices nearest to there.
    pub partners: Vec<u32>,
}

/// A position and a normal times [`TURN`], in single precision: the distance of two is how unlike the points are.
type Feature = Point;

/// The vertices around one, with their weights, which fall to 0 at the radius.
pub(super) struct Disc {
    pub middle: u32,
    pub members: Vec<(u32, f64)>,
}

/// Vertices among which images are sought.
pub(super) struct Sought {
    vertices: Vec<u32>,
    features: Mat<f32>,
}

impl Disc {
    /// What of the vertices `within` some distance, the nearest first, is nearer than `radius`.
    fn of(middle: u32, within: &[(u32, f64)], radius: f64) -> Disc {
        let inside = within.iter().take_while(|(_, distance)| *distance < radius);
        let weight = |distance: f64| (1.0 - distance * distance / (radius * radius)).powi(2);
        Disc { middle, members: inside.map(|&(vertex, distance)| (vertex, weight(distance))).collect() }
    }
}

impl<'a> Mapped<'a> {
    pub fn new(shell: &'a Shell, found: &VertexMap) -> Mapped<'a> {
        let normals: Vec<Vector> =
            summed_normals(&shell.positions, &shell.triangles).into_iter().map(unit).collect();
        let oriented = shell.positions.iter().zip(&normals);
        let walk = SurfaceWalk::new(&shell.positions, &shell.triangles);
        Mapped {
            shell,
            edges: EdgeLengths::of_walk(&walk, &shell.positions),
            walk,
            areas: point_areas(&shell.positions, &shell.triangles),
            features: oriented
                .map(|(&position, &normal)| Oriented { position, normal })
                .map(feature)
                .collect(),
            normals,
            images: found
                .points
                .iter()
                .map(|point| point.interpolate_vectors(&shell.triangles, &shell.positions))
                .collect(),
            partners: found.partners.clone(),
        }
    }

    /// Vertices spread evenly in space; each prefix is, too.
    pub fn spread(&self, count: usize) -> Vec<u32> {
        let point = |position: &Vector| std::array::from_fn(|j| position.get(j).map_or(0.0, |&x| x as f32));
        let points: Vec<_> = self.shell.positions.iter().map(point).collect();
        farthest_points(&points, count).into_iter().map(|vertex| vertex as u32).collect()
    }

    /// The disc around a vertex in space: what lies nearer than `radius` and is joined to the middle by what does. `reached` is false
    /// everywhere, before and after.
    pub fn disc(&self, middle: u32, radius: f64, reached: &mut [bool]) -> Disc {
        let from = self.shell.positions[middle as usize];
        let square = |vertex: u32| {
            squared_norm(subtract(self.shell.positions[vertex as usize], from)) / (radius * radius)
        };
        let joined = self.joined(middle, reached, |vertex| square(vertex) < 1.0);
        let member = |vertex: u32| {
            reached[vertex as usize] = false;
            (vertex, (1.0 - square(vertex)).powi(2))
        };
        Disc { middle, members: joined.into_iter().map(member).collect() }
    }

    /// Discs around vertices along edges, of each radius in turn: where limbs bend sharply, smaller than those in space. Those of the
    /// last vertices are left out where the others lie [`MOST_DISCS`] deep. Progress is told after so many.
    ///
    /// # Errors
    /// Those of [`Progress::check`].
    pub fn discs_along_edges(
        &self,
        middles: &[u32],
        radii: &[f64],
        threads: usize,
        progress: &Progress,
    ) -> Result<Vec<Disc>> {
        let largest = radii.iter().fold(0.0f64, |largest, &radius| largest.max(radius));
        let (mut discs, mut members, token) = (Vec::new(), 0, progress.token());
        for middles in middles.chunks(MOST_DISCS) {
            let some = |range: Range<usize>| -> Result<Vec<Vec<(u32, f64)>>> {
                let mut search = PathSearch::new(self.areas.len());
                let within = |&middle: &u32| {
                    token.check()?;
                    Ok(self.reached(&mut search, &[middle], largest))
                };
                middles[range].iter().map(within).collect()
            };
            let ranges = threads::ranges(middles.len(), 2 * threads);
            let found = threads::map(threads, ranges, some).into_iter().collect::<Result<Vec<_>>>()?;
            for (&middle, within) in middles.iter().zip(found.into_iter().flatten()) {
                members += within.len();
                discs.extend(radii.iter().map(|&radius| Disc::of(middle, &within, radius)));
            }
            progress.goes_on()?;
            if members >= MOST_DISCS * self.areas.len() {
                break;
            }
        }
        Ok(discs)
    }

    /// Vertices nearer than `radius` to one of `sources` along edges, the nearest first, with their distances.
    pub fn within(&self, sources: &[u32], radius: f64) -> Vec<(u32, f64)> {
        self.reached(&mut PathSearch::new(self.areas.len()), sources, radius)
    }

    fn reached(&self, search: &mut PathSearch, sources: &[u32], radius: f64) -> Vec<(u32, f64)> {
        let mut reached = Vec::new();
        search.run(
            sources,
            radius,
            |vertex| self.edges.of(vertex),
            |vertex, distance| {
                reached.push((vertex, distance));
                ControlFlow::Continue(())
            },
        );
        reached
    }

    /// `first` and what is joined to it along edges through vertices `through` which that goes; what was `reached` is left out.
    pub fn joined(&self, first: u32, reached: &mut [bool], through: impl Fn(u32) -> bool) -> Vec<u32> {
        let mut joined = vec![first];
        reached[first as usize] = true;
        let mut next = 0;
        while let Some(&vertex) = joined.get(next) {
            for near in self.walk.around(vertex) {
                if !reached[near as usize] && through(near) {
                    reached[near as usize] = true;
                    joined.push(near);
                }
            }
            next += 1;
        }
        joined
    }

    /// A disc's members, each of which stands for its own area.
    pub fn by_area(&self, members: &[(u32, f64)]) -> Vec<(u32, f64)> {
        let weighted = members.iter().map(|&(vertex, weight)| (vertex, weight * self.areas[vertex as usize]));
        weighted.filter(|(_, weight)| *weight > 0.0).collect()
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
            partner: self.partners[vertex as usize],
            weight,
        };
        members.iter().map(place).collect()
    }

    /// The places' images.
    pub fn sought(&self, places: &[Place]) -> Sought {
        let vertices: Vec<u32> = places.iter().map(|place| place.partner).collect();
        let features: Vec<Feature> = vertices.iter().map(|&vertex| self.features[vertex as usize]).collect();
        Sought { features: rows(&features), vertices }
    }

    /// A vertex's position and normal.
    pub fn oriented(&self, vertex: u32) -> Oriented {
        Oriented { position: self.shell.positions[vertex as usize], normal: self.normals[vertex as usize] }
    }

    /// The vertex most like `goal` in place and normal, sought downhill from `start`, and how unlike it is, squared.
    pub fn alike(&self, goal: Oriented, start: u32) -> (u32, f32) {
        let goal = feature(goal);
        downhill(
            start,
            |from| self.walk.ahead(from),
            |vertex| squared(&goal, &self.features[vertex as usize]),
        )
    }

    /// The vertex most like a goal, for each place sought from the one that is `near`, as the surface that a motion is brought to.
    pub fn surface_from<'n>(&'n self, near: &'n mut [u32]) -> impl FnMut(usize, Oriented) -> Oriented + 'n {
        |index, goal| {
            near[index] = self.alike(goal, near[index]).0;
            self.oriented(near[index])
        }
    }

    /// Squared: how unlike `goal` the surface is beside a vertex, between vertices too.
    pub fn unlike_beside(&self, goal: Oriented, vertex: u32) -> f64 {
        let point = self.walk.nearest_beside(goal.position, vertex);
        let at = |vectors: &[Vector]| point.interpolate_vectors(&self.shell.triangles, vectors);
        let there = Oriented { position: at(&self.shell.positions), normal: unit(at(&self.normals)) };
        f64::from(squared(&feature(goal), &feature(there)))
    }

    /// Gives the vertices other images. The map may have parted one from those around it, so its partner is sought from whichever
    /// of their former ones is nearest.
    pub fn move_to(&mut self, goals: Vec<Vector>, threads: usize) {
        let partner = |vertex: usize| {
            let (goal, around) = (goals[vertex], self.walk.around(vertex as u32));
            let nearer = |start, near: u32| self.walk.nearer(goal, start, self.partners[near as usize]);
            self.walk.nearest_vertex(goal, around.fold(self.partners[vertex], nearer))
        };
        let partners = self.for_all(threads, partner);
        (self.images, self.partners) = (goals, partners);
    }

    /// The images on the surface.
    pub fn on_surface(&self, threads: usize) -> VertexMap {
        let point = |vertex: usize| self.walk.nearest_beside(self.images[vertex], self.partners[vertex]);
        VertexMap { partners: self.partners.clone(), points: self.for_all(threads, point) }
    }

    fn for_all<R: Send>(&self, threads: usize, of: impl Fn(usize) -> R + Sync) -> Vec<R> {
        let ranges = threads::ranges(self.images.len(), 2 * threads);
        let some = |range: Range<usize>| range.map(&of).collect::<Vec<R>>();
        threads::map(threads, ranges, some).into_iter().flatten().collect()
    }

    /// How far the map of some vertices is from an isometry that mirrors the surface, or does not: how much it stretches or shrinks
    /// edges (mean of |ln(length of the image / length)|, at most 1 each), plus the share of the area that it turns the wrong way.
    pub fn distortion(&self, of: &[bool], mirrored: bool) -> f64 {
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
            let there = |&corner: &u32| self.normals[self.partners[corner as usize] as usize];
            let facing: f64 = corners.iter().map(|corner| dot(normal, there(corner))).sum();
            wrong += if (facing > 0.0) == mirrored { twice } else { 0.0 };
            area += twice;
        }
        stretched / length + wrong / area
    }

    /// Gives some vertices other partners and images, and returns their former ones.
    pub fn replaced(&mut self, vertices: &[u32], by: Vec<(u32, Vector)>) -> Vec<(u32, Vector)> {
        let replace = |(&vertex, (partner, image)): (&u32, (u32, Vector))| {
            let vertex = vertex as usize;
            let former = std::mem::replace(&mut self.partners[vertex], partner);
            (former, std::mem::replace(&mut self.images[vertex], image))
        };
        vertices.iter().zip(by).map(replace).collect()
    }
}

impl Sought {
    /// For each goal the vertex most like it.
    pub fn most_alike(&self, goals: impl Iterator<Item = Oriented>) -> Vec<u32> {
        let goals: Vec<Feature> = goals.map(feature).collect();
        let found = nearest(rows(&goals).as_ref(), self.features.as_ref());
        found.into_iter().map(|index| self.vertices[index as usize]).collect()
    }
}

fn rows(features: &[Feature]) -> Mat<f32> {
    Mat::from_fn(features.len(), 6, |i, j| features[i][j])
}

fn feature(Oriented { position: [x, y, z], normal }: Oriented) -> Feature {
    let [p, q, r] = normal.map(|coordinate| TURN * coordinate);
    [x, y, z, p, q, r, 0.0, 0.0].map(|coordinate| coordinate as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::error::Error;
    use crate::base::progress::CancelToken;
    use crate::geometry::vertex_map::VertexMap;
    use crate::mesh::Shell;
    use crate::refine::rigid_parts::strip;
    use std::cell::Cell;

    /// Strain of all of a flat strip of 41 x 5 vertices whose columns go where `to` says.
    fn distortion_of(to: impl Fn(u32) -> u32, mirrored: bool) -> f64 {
        let shell = strip(|column, row| [f64::from(column) / 40.0, f64::from(row) / 20.0, 0.0]);
        let partners = partners(&shell, to);
        let mapped = Mapped::new(&shell, &VertexMap::at_vertices(&shell.triangles, partners));
        mapped.distortion(&[true; 5 * 41], mirrored)
    }

    fn partners(shell: &Shell, to: impl Fn(u32) -> u32) -> Vec<u32> {
        let vertex =
            |point: u32| (0..).zip(&shell.points).find(|(_, own)| **own == point).expect("a vertex").0;
        shell.points.iter().map(|point| vertex(5 * to(point / 5) + point % 5)).collect()
    }

    #[test]
    fn discs_that_hold_everything_are_few() {
        let shell = strip(|column, row| [f64::from(column) / 40.0, f64::from(row) / 20.0, 0.0]);
        let own: Vec<u32> = (0..5 * 41).collect();
        let mapped = Mapped::new(&shell, &VertexMap::at_vertices(&shell.triangles, own.clone()));
        let (token, reports) = (CancelToken::default(), Cell::new(0));
        let callback = |_: &str, _: f64| reports.set(reports.get() + 1);
        let progress = Progress::new(Some(&callback), token.clone());
        let found = |radii: &[f64]| mapped.discs_along_edges(&own, radii, 2, &progress);
        assert_eq!(found(&[0.05, 0.02]).expect("discs").len(), 2 * own.len());
        assert_eq!(reports.replace(0), own.len().div_ceil(MOST_DISCS));
        let all = found(&[9.0]).expect("discs");
        assert!(all.iter().all(|disc| disc.members.len() == own.len()));
        assert_eq!((all.len(), reports.get()), (MOST_DISCS, 1));
        token.cancel();
        assert!(matches!(found(&[9.0]), Err(Error::Cancelled)));
    }

    #[test]
    fn a_mirror_image_has_no_distortion_and_what_is_not_turned_over_has() {
        assert!(distortion_of(|column| 40 - column, true) < 1e-6);
        assert!((distortion_of(|column| 40 - column, false) - 1.0).abs() < 1e-6);
        assert!((distortion_of(|column| column, true) - 1.0).abs() < 1e-6);
        // The first quarter lies on the one after it.
        let folded = distortion_of(|column| if column < 10 { 20 + column } else { 40 - column }, true);
        assert!((folded - 0.25).abs() < 0.05, "{folded}");
    }

    #[test]
    fn what_is_discontinuous_or_squeezed_is_distorted() {
        let discontinuous = distortion_of(|column| if column < 20 { 19 - column } else { 60 - column }, true);
        let squeezed = distortion_of(|column| 40 - column.min(30), true);
        assert!(discontinuous > 0.01 && discontinuous < 0.1, "{discontinuous}");
        // A quarter loses all of its length, and none of its height.
        assert!(squeezed > 0.04 && squeezed < 0.1, "{squeezed}");
    }
}
