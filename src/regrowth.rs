//! A map that grows once more from what rigid parts have put right.
//!
//! What a map of few functions has wrong, as the turn of a limb about its own axis, stays wrong while it grows, and costs more than what the
//! finest functions could not say. Rigid parts put much of it right, so that a map of few functions that is estimated from their
//! images is a better start than any that the search finds (measured in `docs/method.md`).

use crate::error::Result;
use crate::full_refinement::{MatchTarget, VertexImages, estimate, refine};
use crate::functional_map::project;
use crate::mesh::Shell;
use crate::progress::CancelToken;
use crate::rigid_parts::{self, PartsEffort};
use crate::symmetry_kind::SymmetryKind;
use crate::vertex_rows::Guide;
use faer::Mat;

/// Size from which the map grows again.
const FIRST_SIZE: usize = 40;
/// Step by which it grows.
const STEP: usize = 10;

/// The full map that grows from the images of a shell's vertices, which follow its rigid parts, and its images, which follow them again.
///
/// `shell` is that of the `target`. O(vertices x eigenfunctions^2) a step.
///
/// # Errors
/// Those of [`rigid_parts::fit`].
pub fn regrow(
    shell: &Shell,
    target: &MatchTarget,
    images: &VertexImages,
    kind: SymmetryKind,
    token: &CancelToken,
) -> Result<(Mat<f64>, VertexImages)> {
    let (all, count) = (target.vertices(), target.basis.count());
    let first = FIRST_SIZE.min(count);
    let start = project(estimate(&all, target, &images.points, first, first), target.projection())?;
    let sizes: Vec<usize> = (first + STEP..count).step_by(STEP).chain([count]).collect();
    let (map, images) = refine(target, &all, start, &images.seeds(), &sizes, Guide::MeanCurvature, token)?;
    let effort = PartsEffort::thorough().without_turned();
    let fitted = rigid_parts::fit(shell, target.surface, &images, kind, &effort, target.threads(), token)?;
    Ok((map, fitted.images))
}
