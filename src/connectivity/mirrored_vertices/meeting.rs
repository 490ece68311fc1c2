//! Whether an estimate meets vertices at all: what costs little, before anything is made for the search.
//!
//! Where vertices are mirrored the estimate around one, moved by about an edge, sends its neighbours onto vertices. It does so at few places
//! between independent triangulations. Starts ([`super::starts`]) have the same condition.

use super::places::descend;
use super::starts::START_MISS;
use super::surroundings::is_hub;
use super::{Estimate, image_position};
use crate::geometry::adjacency::Adjacency;
use crate::mesh::vector::{Vector, squared_norm, subtract};
use crate::mesh::{Mesh, NONE};

/// Vertices of a shell that are looked at.
const LOOKS: usize = 64;
/// Least share of them that the estimate sends among vertices: over 0.4 where vertices are mirrored, under 0.1 between most independent
/// triangulations; those of which a regular grid is a part have more, and are left to the search.
const MET: f64 = 0.25;

/// Whether so on each of the `shells`, given by their points. O(points + triangles).
pub(super) fn meets_vertices<'a>(
    mesh: &Mesh,
    estimate: &Estimate,
    shells: impl Iterator<Item = &'a [u32]>,
) -> Vec<bool> {
    let looks: Vec<Vec<u32>> =
        shells.map(|points| points.iter().copied().step_by(points.len().div_ceil(LOOKS)).collect()).collect();
    let edges =
        edges_around(mesh, looks.iter().flatten().flat_map(|&look| [look, estimate.partner[look as usize]]));
    let met = |look: &&u32| is_met(mesh, estimate, &edges, **look);
    let share = |looks: &Vec<u32>| looks.iter().filter(met).count() as f64 / looks.len() as f64;
    looks.iter().map(|looks| share(looks) >= MET).collect()
}

/// The edges that leave `centres` and the points within two rings of them, without those of hubs.
fn edges_around(mesh: &Mesh, centres: impl Iterator<Item = u32>) -> Adjacency {
    let mut near = vec![false; mesh.positions.len()];
    centres.for_each(|centre| near[centre as usize] = true);
    for _ in 0..2 {
        let inner = near.clone();
        for triangle in mesh.triangles.iter().filter(|corners| corners.iter().any(|&c| inner[c as usize])) {
            triangle.iter().for_each(|&corner| near[corner as usize] = true);
        }
    }
    let mut triangles_around = vec![0; near.len()];
    mesh.triangles.as_flattened().iter().for_each(|&corner| triangles_around[corner as usize] += 1);
    let is_ordinary = |point: u32| !is_hub(triangles_around[point as usize]);
    let ends = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a), (b, a), (c, b), (a, c)]);
    let wanted = |&(from, to): &(u32, u32)| near[from as usize] && is_ordinary(from) && is_ordinary(to);
    Adjacency::new(near.len(), ends.filter(wanted))
}

/// Whether the images of the neighbours of a point are vertices, moved so that its own is one near by.
fn is_met(mesh: &Mesh, estimate: &Estimate, edges: &Adjacency, point: u32) -> bool {
    let at = image_position(mesh, estimate, point);
    let near = edges.of(point as usize).iter().filter(|&&near| estimate.partner[near as usize] != NONE);
    let offsets: Vec<Vector> = near.map(|&near| subtract(image_position(mesh, estimate, near), at)).collect();
    if offsets.is_empty() {
        return false;
    }
    let middle = estimate.partner[point as usize];
    let is_start = |&centre: &u32| {
        let (origin, around) = (mesh.positions[centre as usize], edges.of(centre as usize));
        let distance =
            |vertex: u32, from: Vector| squared_norm(subtract(mesh.positions[vertex as usize], from)).sqrt();
        let edge = around.iter().map(|&end| distance(end, origin)).sum::<f64>() / around.len() as f64;
        let mut left = START_MISS * edge * offsets.len() as f64;
        offsets.iter().all(|offset| {
            let wanted = std::array::from_fn(|axis| origin[axis] + offset[axis]);
            left -= distance(descend(mesh, edges, centre, wanted), wanted).min(edge);
            left > 0.0
        })
    };
    edges.of(middle as usize).iter().chain([&middle]).any(is_start)
}
