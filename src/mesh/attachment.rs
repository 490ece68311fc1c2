//! How small shells sit on a large one: eyes in a head, buttons on a coat.
//!
//! Shells that share no point have no intrinsic relation, so this one question is answered by
//! positions; what leaves this file are indices and distances.

use super::{Mesh, Shell};
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Where each point of a shell sits on the primary shell.
#[derive(Debug, Clone, Default)]
pub struct Attachment {
    /// Nearest local point of the primary shell.
    pub anchors: Vec<u32>,
    /// Distance to it, in units of the square root of the mesh's area.
    pub heights: Vec<f32>,
}

/// Attaches every shell of `shells` to shell `primary`; the primary's own entry is empty.
///
/// O(points log points).
pub fn attach(mesh: &Mesh, shells: &[Shell], primary: usize) -> Vec<Attachment> {
    let position = |shell: &Shell, local: usize| mesh.positions[shell.points[local] as usize];
    let base = &shells[primary];
    let leaf = |local: usize| GeomWithData::new(position(base, local), local as u32);
    let tree = RTree::bulk_load((0..base.points.len()).map(leaf).collect());
    let attach_shell = |(index, shell): (usize, &Shell)| {
        let mut attachment = Attachment::default();
        if index != primary {
            for local in 0..shell.points.len() {
                let query = position(shell, local);
                let nearest = tree.nearest_neighbor(query).expect("the primary shell has points");
                let squared: f64 = (0..3).map(|axis| (query[axis] - nearest.geom()[axis]).powi(2)).sum();
                attachment.anchors.push(nearest.data);
                attachment.heights.push(squared.sqrt() as f32);
            }
        }
        attachment
    };
    shells.iter().enumerate().map(attach_shell).collect()
}
