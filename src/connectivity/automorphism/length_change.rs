//! How much a pairing by connectivity changes lengths: whether the shape agrees with it, without any spectrum.

use super::Automorphism;
use crate::mesh::vector::quantile;
use crate::mesh::{Mesh, NONE};

/// Faces that are looked at, evenly spread.
const FACES: usize = 4096;
/// Largest changes where the shape agrees: a posed person has up to 0.013 and 0.18, the same with noise on one side, sheared or bent
/// 0.05 in the median or more, with one limb of half again the length 0.4 in the 90th percentile or more.
const AGREES: LengthChange = LengthChange { median: 0.03, p90: 0.2 };

/// Changes |ln(l'/l)| between the lengths of an edge and of its image, quantiles weighted by the lengths of edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthChange {
    /// Median.
    pub median: f64,
    /// 90th percentile.
    pub p90: f64,
}

impl LengthChange {
    /// Of the edges whose ends both have partners; `None` if there are none. O(1) beyond some thousand faces.
    pub fn of(mesh: &Mesh, found: &Automorphism) -> Option<LengthChange> {
        let faces = mesh.polygon_offsets.len() - 1;
        let mut changes = Vec::new();
        for face in (0..faces).step_by(faces.div_ceil(FACES).max(1)) {
            let corners = mesh.polygon_offsets[face] as usize..mesh.polygon_offsets[face + 1] as usize;
            let corners = &mesh.polygon_points[corners];
            let ends = corners.iter().zip(corners.iter().cycle().skip(1));
            changes.extend(ends.filter_map(|(&a, &b)| ratio_and_length(mesh, found, a, b)));
        }
        changes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let change = |share: f64| quantile(&changes, share).map(|ratio| 0.5 * ratio.ln());
        Some(LengthChange { median: change(0.5)?, p90: change(0.9)? })
    }

    /// Whether the pairing is as good as an isometry. That of a whole shell which has no rival is then the answer: nothing else need
    /// be sought.
    pub fn agrees(&self) -> bool {
        self.median <= AGREES.median && self.p90 <= AGREES.p90
    }
}

/// The ratio, 1 or more, of the squared lengths of an edge and its image, and the length of the edge.
fn ratio_and_length(mesh: &Mesh, found: &Automorphism, a: u32, b: u32) -> Option<(f64, f64)> {
    let (image_a, image_b) = (found.partner[a as usize], found.partner[b as usize]);
    if image_a == NONE || image_b == NONE {
        return None;
    }
    let square = |a: u32, b: u32| mesh.squared_distance(a, b).max(f64::MIN_POSITIVE);
    let (own, image) = (square(a, b), square(image_a, image_b));
    Some((f64::max(own / image, image / own), own.sqrt()))
}
