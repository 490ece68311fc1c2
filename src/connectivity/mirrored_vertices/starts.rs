//! Where percolation may start: vertices around which the estimate, moved by about an edge, meets vertices.

use super::places::{Places, descend};
use super::surroundings::Surroundings;
use crate::base::threads;
use crate::geometry::adjacency::nearest_seeds;
use crate::mesh::NONE;
use crate::mesh::vector::{Vector, squared_norm, subtract};

/// Regions of a shell that are searched for starts, vertices looked at in each, and starts taken from each.
const REGIONS: usize = 80;
const LOOKS: usize = 16;
pub(super) const LOOKED_AT: usize = REGIONS * LOOKS;
const STARTS: usize = 4;
/// Largest mean distance between the moved estimate and vertices, in edges, at a start, and of a vertex that it pairs.
const START_MISS: f64 = 0.2;
const VERTEX_MISS: f64 = 0.3;
/// What moving the estimate by an edge costs a start, in miss: on a grid all fit, and the nearer are likelier.
const SHIFT: f64 = 0.02;

/// A vertex around which the moved estimate meets vertices.
pub(super) struct Start {
    /// Mean distance from them, in edges.
    miss: f64,
    /// The pairs that this gives, the vertex in the middle first.
    pub pairs: Vec<(u32, u32)>,
}

/// Parts of shells: the points nearest to seeds that are spread over the numbers of a shell.
pub(super) struct Regions {
    /// The seed nearest to each point, counted over all shells, or [`NONE`].
    nearest: Vec<u32>,
}

impl Regions {
    /// Of all shells at once. O(points).
    pub fn new<'a>(around: &Surroundings, shells: impl Iterator<Item = &'a [u32]>) -> Regions {
        let seeds: Vec<u32> = shells.flat_map(seeds).collect();
        let neighbours = |point: u32| around.edges.of(point as usize).iter().copied();
        Regions { nearest: nearest_seeds(around.edges.count(), &seeds, neighbours) }
    }

    /// Those of the shell with these points.
    pub fn of(&self, points: &[u32]) -> Vec<Vec<u32>> {
        let mut regions = vec![Vec::new(); seeds(points).count()];
        let first = self.nearest[points[0] as usize];
        let reached = points.iter().filter(|&&point| self.nearest[point as usize] != NONE);
        reached.for_each(|&point| regions[(self.nearest[point as usize] - first) as usize].push(point));
        regions
    }
}

/// Some points of a shell, the first among them.
fn seeds(points: &[u32]) -> impl Iterator<Item = u32> {
    points.iter().copied().step_by(points.len().div_ceil(REGIONS))
}

/// The best starts in every one of some regions of a shell, those at one vertex together.
pub(super) fn starts(
    around: &Surroundings,
    places: &Places,
    regions: Vec<&Vec<u32>>,
    threads: usize,
) -> Vec<Vec<Start>> {
    let best = |region: &Vec<u32>| {
        let looked_at = region.iter().step_by(region.len().div_ceil(LOOKS));
        let found =
            looked_at.map(|&vertex| starts_at(around, places, vertex)).filter(|found| !found.is_empty());
        found.min_by(|a, b| a[0].miss.total_cmp(&b[0].miss))
    };
    threads::map(threads, regions, best).into_iter().flatten().collect()
}

/// The best starts at one vertex: the estimate is moved so that it sends the vertex to one near its image.
fn starts_at(around: &Surroundings, places: &Places, vertex: u32) -> Vec<Start> {
    let positions = &around.mesh.positions;
    let at = places.position[vertex as usize];
    let near = around.close.of(vertex as usize).iter().filter(|&&near| places.vertex[near as usize] != NONE);
    let offsets: Vec<_> = near.map(|&near| (near, subtract(places.position[near as usize], at))).collect();
    let middle = places.vertex[vertex as usize];
    if offsets.is_empty() {
        return Vec::new();
    }
    let mut found = Vec::new();
    for &centre in around.close.of(middle as usize).iter().chain([&middle]) {
        let origin = positions[centre as usize];
        let edge = around.mean_length(centre);
        let mut start = Start { miss: 0.0, pairs: vec![(vertex, centre)] };
        for &(near, offset) in &offsets {
            let wanted: Vector = std::array::from_fn(|axis| origin[axis] + offset[axis]);
            let image = descend(around.mesh, &around.edges, centre, wanted);
            let miss = squared_norm(subtract(positions[image as usize], wanted)).sqrt() / edge;
            start.miss += miss.min(1.0) / offsets.len() as f64;
            if start.miss >= START_MISS {
                break;
            }
            if miss < VERTEX_MISS {
                start.pairs.push((near, image));
            }
        }
        if start.miss < START_MISS {
            let shift = squared_norm(subtract(origin, at)).sqrt() / edge;
            found.push((start.miss + SHIFT * shift, start));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(STARTS);
    found.into_iter().map(|(_, start)| start).collect()
}
