//! The map between the coarse and the full one: it grows while mean curvature guides it, in several ways.
//!
//! A limb is nearly a surface of revolution, so a map may turn it around its own axis, and whatever grows from that map
//! keeps the turn. Which way it takes hangs on little: where the coarse map is cut back to, and how fast it grows
//! again. The partners' mean curvatures tell the results apart: of maps of one shape, those with the smaller
//! difference are the more accurate ones (measured in `docs/method.md`).

use crate::error::Result;
use crate::full_refinement::{MatchTarget, VertexImages, refine};
use crate::progress::Progress;
use crate::signature::mean;
use crate::spread_points::SpreadPoints;
use crate::vertex_rows::Guide;
use faer::Mat;

/// Ways to grow: the size to which the coarse map is cut back, since what it says of finer functions is partly chance,
/// and the step by which it grows.
const WAYS: [(usize, usize); 2] = [(10, 10), (20, 5)];

/// Grows `coarse`, whose images of `points` are given, to all eigenfunctions.
///
/// Returns the map whose partners' curvatures differ least, and its images of the points; the first where the surface has
/// no curvature. O(points x eigenfunctions^2) a step.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn grow(
    target: &MatchTarget,
    points: &SpreadPoints,
    coarse: &Mat<f64>,
    images: &VertexImages,
    progress: &Progress,
) -> Result<(Mat<f64>, VertexImages)> {
    let (count, seeds) = (target.basis.count(), images.seeds());
    let grown = |(first, step): (usize, usize)| {
        let first = first.min(count);
        let start = coarse.submatrix(0, 0, first, first).to_owned();
        let sizes: Vec<usize> = (first..count).step_by(step).chain([count]).collect();
        refine(target, &points.sources(), start, &seeds, &sizes, Guide::MeanCurvature, progress)
    };
    let mut best = grown(WAYS[0])?;
    if target.surface.mean_curvature.is_empty() {
        return Ok(best);
    }
    let mut least = curvature_mismatch(target, points, &best.1);
    for way in &WAYS[1..] {
        let other = grown(*way)?;
        let mismatch = curvature_mismatch(target, points, &other.1);
        if mismatch < least {
            (least, best) = (mismatch, other);
        }
    }
    Ok(best)
}

/// Mean difference of the diffused mean curvatures of the points and their images, summed over the times of diffusion.
pub fn curvature_mismatch(target: &MatchTarget, points: &SpreadPoints, images: &VertexImages) -> f64 {
    let triangles = &target.surface.triangles;
    let of_column = |column: &Vec<f64>| {
        let pairs = points.vertices.iter().zip(&images.points);
        let differences = pairs
            .map(|(&vertex, image)| (column[vertex as usize] - image.interpolate(triangles, column)).abs());
        mean(&points.mass, differences)
    };
    target.surface.mean_curvature.iter().map(of_column).sum()
}
