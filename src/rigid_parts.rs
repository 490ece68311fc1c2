//! Where the surface around a vertex has kept its shape, space says more than the surface alone.
//!
//! A pose bends few places; between them hands, heads and thighs stay as they are. The map of some hundred eigenfunctions is
//! right to about a percent of the surface's size. A rigid motion (with reflection), fitted to how it moves a whole part, averages that
//! error out, and is then fitted to the surface itself: each point comes to lie on the tangent plane of the vertex most
//! like it in place and normal (Y. Chen, G. Medioni, "Object modelling by registration of multiple range images", 1992). What the surface leaves
//! open, as a slide along a limb, stays as the map says. Parts overlap; each vertex follows those it is in, the more the better
//! they fit, but not those that the others contradict. So a vertex that the map tears from its surroundings comes back.
//!
//! Where a joint bends, no rigid part fits, and the map stays. That is how this differs from fitting the whole surface as rigidly as
//! possible, which drifts there (`docs/method.md`).

mod motion;

use crate::adjacency::Adjacency;
use crate::embedded_triangles::TrianglePoint;
use crate::error::Result;
use crate::full_refinement::VertexImages;
use crate::mesh::Shell;
use crate::mesh::vector::{Vector, cross, point_areas, squared_norm, subtract};
use crate::progress::CancelToken;
use crate::sampling::{area_weighted_vertices, farthest_points};
use crate::surface_walk::SurfaceWalk;
use crate::symmetry_kind::SymmetryKind;
use crate::threads;
use motion::{Fit, Motion, Oriented, Place};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::Range;

/// Parts in all; their middles are spread over the shell.
const PARTS: usize = 300;
/// Radius of a part along edges, in sqrt(area).
const RADIUS: f64 = 0.1;
/// Points of a part that its motion is fitted to.
const FITTED_POINTS: usize = 80;
/// A motion that leaves the surface by this much, in sqrt(area), counts half.
const LEAVE: f64 = 0.0015;
/// One that starts this far from what the others agree on counts a quarter there.
const STRAY: f64 = 0.05;
/// Rounds in which the parts around a vertex agree.
const AGREEING_ROUNDS: usize = 2;
/// A turn of the normal by one radian is as unlike as this distance, in sqrt(area).
const TURN: f64 = 0.06;
/// Weight of the map itself.
const MAP_WEIGHT: f64 = 0.02;
/// Vertices that one thread takes at a time.
const CHUNK: usize = 2048;

/// The vertices around one, the motion that mirrors them, and how much it counts at each.
struct Part {
    members: Vec<(u32, f64)>,
    fit: Fit,
}

/// A vertex and a way to it along edges; the shorter way is the greater.
#[derive(PartialEq)]
struct Reached {
    distance: f64,
    vertex: u32,
}

impl Eq for Reached {}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance.total_cmp(&self.distance).then(other.vertex.cmp(&self.vertex))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// A shell and its map.
struct Mapped<'a> {
    shell: &'a Shell,
    graph: Adjacency,
    walk: SurfaceWalk<'a>,
    areas: Vec<f64>,
    /// Unit normals of the vertices.
    normals: Vec<Vector>,
    partners: &'a [u32],
    /// Positions of the images.
    images: Vec<Vector>,
    mirrored: bool,
}

/// Moves the images of an oriented shell's vertices to where the rigid parts put them.
///
/// Images of a shell that is not oriented, or has no area, stay. O(vertices log vertices): some ten to thirty
/// parts at each vertex.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn fit(
    shell: &Shell,
    images: &VertexImages,
    kind: SymmetryKind,
    threads: usize,
    token: &CancelToken,
) -> Result<VertexImages> {
    if !shell.orientable || shell.scale == 0.0 {
        return Ok(images.clone());
    }
    let mapped = Mapped::new(shell, images, kind);
    let part = |middle: u32| {
        token.check()?;
        mapped.part(middle)
    };
    let middles = middles(shell);
    let parts = threads::map(threads, middles, part).into_iter().collect::<Result<Vec<Part>>>()?;
    let goals = mapped.goals(&parts);
    let project = |range: Range<usize>| -> Vec<(u32, TrianglePoint)> {
        range.map(|vertex| mapped.nearest(vertex, goals[vertex])).collect()
    };
    let ranges = threads::ranges(goals.len(), goals.len().div_ceil(CHUNK));
    let (partners, points) = threads::map(threads, ranges, project).into_iter().flatten().unzip();
    Ok(VertexImages { partners, points })
}

impl<'a> Mapped<'a> {
    fn new(shell: &'a Shell, images: &'a VertexImages, kind: SymmetryKind) -> Mapped<'a> {
        let sides = |&[a, b, c]: &[u32; 3]| [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)];
        Mapped {
            shell,
            graph: Adjacency::new(shell.positions.len(), shell.triangles.iter().flat_map(sides)),
            walk: SurfaceWalk::new(&shell.positions, &shell.triangles),
            areas: point_areas(&shell.positions, &shell.triangles),
            normals: normals(shell),
            partners: &images.partners,
            images: images.points.iter().map(|point| at(shell, point, &shell.positions)).collect(),
            mirrored: kind == SymmetryKind::Reflection,
        }
    }

    /// The part around a vertex: what is joined to it within the radius.
    fn part(&self, middle: u32) -> Result<Part> {
        let members = self.members(middle);
        let areas: Vec<f64> = members.iter().map(|&(vertex, _)| self.areas[vertex as usize]).collect();
        let picked = area_weighted_vertices(&areas, FITTED_POINTS).into_iter().map(|index| members[index]);
        let place = |(vertex, weight): (u32, f64)| Place {
            own: Oriented {
                position: self.shell.positions[vertex as usize],
                normal: self.normals[vertex as usize],
            },
            image: self.images[vertex as usize],
            partner: self.partners[vertex as usize],
            weight,
        };
        let places: Vec<Place> = picked.map(place).filter(|place| place.weight > 0.0).collect();
        let start = Motion::between(&places, self.mirrored);
        let fit = start.onto(&places, RADIUS, LEAVE, |goal, start| self.alike(goal, start))?;
        Ok(Part { members, fit })
    }

    /// The vertex most like `goal` in place and normal, sought downhill from `start`.
    fn alike(&self, goal: Oriented, start: u32) -> (u32, Oriented) {
        let at = |vertex: u32| Oriented {
            position: self.shell.positions[vertex as usize],
            normal: self.normals[vertex as usize],
        };
        let unlike = |vertex: u32| {
            let there = at(vertex);
            let turned = squared_norm(subtract(there.normal, goal.normal));
            squared_norm(subtract(there.position, goal.position)) + TURN * TURN * turned
        };
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
                return (best, at(best));
            }
        }
    }

    /// Vertices with their weights, which fall to 0 at the radius.
    fn members(&self, middle: u32) -> Vec<(u32, f64)> {
        let mut members = Vec::new();
        let mut nearest = vec![f64::INFINITY; self.areas.len()];
        nearest[middle as usize] = 0.0;
        let mut queue = BinaryHeap::from([Reached { distance: 0.0, vertex: middle }]);
        while let Some(Reached { distance, vertex }) = queue.pop() {
            if distance > nearest[vertex as usize] {
                continue;
            }
            members.push((vertex, (1.0 - distance * distance / (RADIUS * RADIUS)).powi(2)));
            let from = self.shell.positions[vertex as usize];
            for &near in self.graph.of(vertex as usize) {
                let edge = subtract(self.shell.positions[near as usize], from);
                let distance = distance + squared_norm(edge).sqrt();
                if distance < RADIUS && distance < nearest[near as usize] {
                    nearest[near as usize] = distance;
                    queue.push(Reached { distance, vertex: near });
                }
            }
        }
        members
    }

    /// The vertex and the point nearest to where a vertex's image should lie. The map may have torn it from those around it, so
    /// the walk starts from whichever of their images is nearest.
    fn nearest(&self, vertex: usize, goal: Vector) -> (u32, TrianglePoint) {
        let around = self.graph.of(vertex).iter().map(|&near| self.partners[near as usize]);
        let start = around.fold(self.partners[vertex], |start, other| self.walk.nearer(goal, start, other));
        self.walk.nearest(goal, start)
    }

    /// Where each vertex's image should lie: the mean of what its parts say, but for those that most others contradict, and a
    /// little of the map.
    fn goals(&self, parts: &[Part]) -> Vec<Vector> {
        let start = |fit: &Fit, position| fit.start.of(position);
        let mut agreed = self.mean(parts, None, start);
        for _ in 0..AGREEING_ROUNDS {
            agreed = self.mean(parts, Some(&agreed), start);
        }
        self.mean(parts, Some(&agreed), |fit, position| fit.motion.of(position))
    }

    /// The mean over each vertex's parts of where `place` puts it; parts whose start is far from what is `agreed` count less.
    fn mean(
        &self,
        parts: &[Part],
        agreed: Option<&[Vector]>,
        place: impl Fn(&Fit, Vector) -> Vector,
    ) -> Vec<Vector> {
        let mut sums: Vec<_> =
            self.images.iter().map(|image| (image.map(|x| MAP_WEIGHT * x), MAP_WEIGHT)).collect();
        for Part { members, fit } in parts {
            let trust = 1.0 / (1.0 + (fit.left / LEAVE).powi(4));
            for &(vertex, weight) in members {
                let position = self.shell.positions[vertex as usize];
                let apart = |agreed: &[Vector]| subtract(fit.start.of(position), agreed[vertex as usize]);
                let stray = agreed.map_or(0.0, |agreed| squared_norm(apart(agreed)) / (STRAY * STRAY));
                let weight = trust * weight / (1.0 + stray).powi(2);
                let goal = place(fit, position);
                let (sum, all) = &mut sums[vertex as usize];
                (0..3).for_each(|axis| sum[axis] += weight * goal[axis]);
                *all += weight;
            }
        }
        sums.into_iter().map(|(sum, all)| sum.map(|x| x / all)).collect()
    }
}

/// Vertices spread evenly in space.
fn middles(shell: &Shell) -> Vec<u32> {
    let point = |position: &Vector| std::array::from_fn(|j| position.get(j).map_or(0.0, |&x| x as f32));
    let points: Vec<_> = shell.positions.iter().map(point).collect();
    farthest_points(&points, PARTS.min(points.len())).into_iter().map(|vertex| vertex as u32).collect()
}

/// What the vertices' vectors are at a point inside a triangle.
fn at(shell: &Shell, point: &TrianglePoint, vectors: &[Vector]) -> Vector {
    let corners = shell.triangles[point.triangle as usize].map(|corner| vectors[corner as usize]);
    std::array::from_fn(|axis| (0..3).map(|k| f64::from(point.barycentric[k]) * corners[k][axis]).sum())
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
    let unit = |normal: Vector| normal.map(|x| x / squared_norm(normal).sqrt().max(f64::MIN_POSITIVE));
    normals.into_iter().map(unit).collect()
}
