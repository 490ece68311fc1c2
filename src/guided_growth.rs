//! The map between the coarse and the full one: it grows while mean curvature guides it, in several ways at first.
//!
//! A limb is nearly a surface of revolution, so a map may turn it around its own axis, and whatever grows from that map
//! keeps the turn. Which way it takes hangs on little: where the coarse map is cut back to, and how fast it grows
//! again. The partners' mean curvatures tell the results apart: of maps of one shape, those with the smaller
//! difference are the more accurate ones (measured in `docs/method.md`). So several are grown to a middle size, at little
//! cost, on half of the points, and only the best of them further.

use crate::error::Result;
use crate::full_refinement::{MatchTarget, VertexImages, refine};
use crate::progress::Progress;
use crate::signature::mean;
use crate::spread_points::SpreadPoints;
use crate::threads;
use crate::vertex_rows::Guide;
use faer::Mat;

/// Ways to grow: the size to which the coarse map is cut back, since what it says of finer functions is partly chance,
/// and the step by which it grows.
const WAYS: [(usize, usize); 4] = [(20, 5), (10, 10), (15, 10), (25, 10)];
/// Size at which one of them is chosen.
const CHOICE_SIZE: usize = 80;
/// Points on which they grow until then.
const WAY_POINTS: usize = 2000;
/// Step by which that one grows on.
const LAST_STEP: usize = 10;

/// Grows `coarse`, whose images of `points` are given, to all eigenfunctions.
///
/// Returns the map and its images of the points. Where the surface has no curvature, it grows in one way. The ways are
/// shared out among the target's threads. O(points x eigenfunctions^2) a step.
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
    let (count, token, guide) = (target.basis.count(), progress.token(), Guide::MeanCurvature);
    let middle = CHOICE_SIZE.min(count);
    let few = SpreadPoints::new(target, WAY_POINTS, middle)?;
    let seeds = few.seeds(&points.vertices, images.partners.iter().copied());
    let alone = target.with_threads(1);
    let grown = |(first, step): (usize, usize)| {
        let first = first.min(middle);
        let start = coarse.submatrix(0, 0, first, first).to_owned();
        let sizes: Vec<usize> = (first..middle).step_by(step).chain([middle]).collect();
        let (map, images) = refine(&alone, &few.sources(), start, &seeds, &sizes, guide, token)?;
        Ok((curvature_mismatch(target, &few, &images), map, images))
    };
    progress.report("refining", 0.8)?;
    let ways = if target.surface.mean_curvature.is_empty() { &WAYS[..1] } else { &WAYS[..] };
    let maps = threads::map(target.threads(), ways.to_vec(), grown);
    let maps: Vec<(f64, Mat<f64>, VertexImages)> = maps.into_iter().collect::<Result<_>>()?;
    let best = maps.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let (_, map, images) = best.expect("there is a way");
    progress.report("refining", 0.85)?;
    let sizes: Vec<usize> = (middle + LAST_STEP..count).step_by(LAST_STEP).chain([count]).collect();
    let seeds = points.seeds(&few.vertices, images.partners.iter().copied());
    refine(target, &points.sources(), map, &seeds, &sizes, guide, token)
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
