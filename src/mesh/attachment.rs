//! How small shells sit on a large one: eyes in a head, buttons on a coat.

use super::{Mesh, Shell};
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// For each point of every shell of `shells` the nearest local point of shell `primary`, on which it sits; none for the primary's own.
///
/// O(points log points).
pub fn anchors(mesh: &Mesh, shells: &[Shell], primary: usize) -> Vec<Vec<u32>> {
    let base = &shells[primary];
    let leaf =
        |(local, &point): (usize, &u32)| GeomWithData::new(mesh.positions[point as usize], local as u32);
    let tree = RTree::bulk_load(base.points.iter().enumerate().map(leaf).collect());
    let nearest = |&point: &u32| {
        tree.nearest_neighbor(mesh.positions[point as usize]).expect("the primary shell has points").data
    };
    let of_shell = |(index, shell): (usize, &Shell)| match index == primary {
        true => Vec::new(),
        false => shell.points.iter().map(nearest).collect(),
    };
    shells.iter().enumerate().map(of_shell).collect()
}
