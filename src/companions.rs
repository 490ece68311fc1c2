//! Partners of the other shells, once the symmetry of the primary shell is known.
//!
//! A companion shell (an eye, a tooth, a shoe) is described by where it sits on the primary shell.
//! Mirroring those anchors tells where its mirror image must sit: on itself, or on another shell of
//! the same size, with which it swaps. The anchors also start the map between the two shells, which
//! is then refined spectrally like any other functional map.

use crate::eigenbasis::Eigenbasis;
use crate::error::Result;
use crate::full_refinement::{self, MatchTarget, VertexImages};
use crate::functional_map::{Projection, project};
use crate::laplacian::IntrinsicSurface;
use crate::mesh::{Attachment, Shell};
use crate::progress::Progress;
use crate::refinement::nearest;
use crate::sampling::{SPREAD_COORDINATES, Samples, spread_rows};
use crate::vertex_rows::Guide;
use faer::Mat;

/// Spread coordinates of the anchor, and the weighted height above it.
const FEATURES: usize = SPREAD_COORDINATES + 1;
/// Weight of the height against the spread coordinates.
const HEIGHT_WEIGHT: f32 = 2.0;
/// Points of a shell that are compared when shells are paired.
const PAIRING_POINTS: usize = 64;
/// Mean feature distance above which two shells are not taken for partners.
const FARTHEST: f32 = 0.35;
/// Natural logarithm of the largest ratio of two partners' areas.
const AREA_TOLERANCE: f64 = 0.3;
/// Sizes of the functional map between two shells; smaller shells stop earlier.
const SIZES: [usize; 5] = [8, 12, 20, 30, 40];
/// Most companion shells whose map is refined spectrally; the rest keep the anchors' map.
const MOST_REFINED: usize = 200;

/// The map of one companion shell.
#[derive(Debug, Clone)]
pub struct Companion {
    /// The shell that holds its images.
    pub target: usize,
    /// Images of its points, in the target's local numbering.
    pub images: VertexImages,
    /// Mean feature distance of the pairing: 0 perfect, 0.35 the worst accepted.
    pub mismatch: f32,
}

/// What pairing needs to know of the primary shell and its symmetry.
pub struct Primary<'a> {
    /// Its index among the shells.
    pub index: usize,
    /// Its eigenbasis.
    pub basis: &'a Eigenbasis,
    /// Partner of each of its points.
    pub partners: &'a [u32],
}

/// Finds the partner of every shell but the primary; `None` for those that have none.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn find(
    shells: &[Shell],
    attachments: &[Attachment],
    primary: &Primary,
    progress: &Progress,
) -> Result<Vec<Option<Companion>>> {
    let features = Features::new(attachments, primary);
    let pairs = pair_shells(shells, &features, primary.index);
    let mut companions: Vec<Option<Companion>> = shells.iter().map(|_| None).collect();
    for (done, &(first, second, mismatch)) in pairs.iter().enumerate() {
        progress.report("other shells", 0.95)?;
        let refined = done < MOST_REFINED;
        for (source, target) in [(first, second), (second, first)] {
            if companions[source].is_none() {
                let images = match_shells(shells, &features, source, target, refined, progress)?;
                companions[source] = Some(Companion { target, images, mismatch });
            }
        }
    }
    Ok(companions)
}

/// Per shell, a row of features per point: as it is, and as its mirror image should be.
struct Features {
    own: Vec<Mat<f32>>,
    mirrored: Vec<Mat<f32>>,
}

impl Features {
    fn new(attachments: &[Attachment], primary: &Primary) -> Features {
        let count = primary.partners.len();
        let everywhere = Samples::at(primary.basis, (0..count as u32).collect());
        let spread = spread_rows(&everywhere, &primary.basis.eigenvalues);
        let rows = |attachment: &Attachment, anchor_of: &dyn Fn(u32) -> u32| {
            Mat::from_fn(attachment.anchors.len(), FEATURES, |i, j| {
                if j < SPREAD_COORDINATES {
                    spread[anchor_of(attachment.anchors[i]) as usize][j] as f32
                } else {
                    HEIGHT_WEIGHT * attachment.heights[i]
                }
            })
        };
        Features {
            own: attachments.iter().map(|attachment| rows(attachment, &|anchor| anchor)).collect(),
            mirrored: attachments
                .iter()
                .map(|attachment| rows(attachment, &|anchor| primary.partners[anchor as usize]))
                .collect(),
        }
    }

    /// Mean distance from the mirrored points of `source` to the nearest points of `target`.
    fn mismatch(&self, source: usize, target: usize) -> f32 {
        let (queries, targets) = (&self.mirrored[source], &self.own[target]);
        let step = queries.nrows().div_ceil(PAIRING_POINTS).max(1);
        let picked: Vec<usize> = (0..queries.nrows()).step_by(step).collect();
        let picked_rows = Mat::from_fn(picked.len(), FEATURES, |i, j| queries[(picked[i], j)]);
        let partners = nearest(picked_rows.as_ref(), targets.as_ref());
        let total: f32 =
            (0..picked.len()).map(|i| row_distance(&picked_rows, i, targets, partners[i] as usize)).sum();
        total / picked.len() as f32
    }

    /// Distance between the mirrored mean of one shell and the mean of another: a cheap lower guess.
    fn means(rows: &[Mat<f32>]) -> Vec<[f32; FEATURES]> {
        let mean = |m: &Mat<f32>| {
            std::array::from_fn(|j| (0..m.nrows()).map(|i| m[(i, j)]).sum::<f32>() / m.nrows().max(1) as f32)
        };
        rows.iter().map(mean).collect()
    }
}

fn row_distance(left: &Mat<f32>, i: usize, right: &Mat<f32>, j: usize) -> f32 {
    (0..left.ncols()).map(|c| (left[(i, c)] - right[(j, c)]).powi(2)).sum::<f32>().sqrt()
}

/// Pairs of shells (equal where a shell mirrors onto itself) with their mismatch, best first.
fn pair_shells(shells: &[Shell], features: &Features, primary: usize) -> Vec<(usize, usize, f32)> {
    let (mirrored, own) = (Features::means(&features.mirrored), Features::means(&features.own));
    let others: Vec<usize> = (0..shells.len()).filter(|&shell| shell != primary).collect();
    let area = |shell: usize| shells[shell].area().max(f64::MIN_POSITIVE).ln();
    let mut options = Vec::new();
    for &source in &others {
        let alike = |target: &&usize| (area(source) - area(**target)).abs() < AREA_TOLERANCE;
        let mut near: Vec<(f32, usize)> = others
            .iter()
            .filter(alike)
            .map(|&target| {
                let pairs = mirrored[source].iter().zip(&own[target]);
                (pairs.map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt(), target)
            })
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(_, target) in near.iter().take(4) {
            let both = 0.5 * (features.mismatch(source, target) + features.mismatch(target, source));
            options.push((both, source.min(target), source.max(target)));
        }
    }
    options.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut taken = vec![false; shells.len()];
    let mut pairs = Vec::new();
    for (mismatch, first, second) in options {
        if mismatch < FARTHEST && !taken[first] && !taken[second] {
            (taken[first], taken[second]) = (true, true);
            pairs.push((first, second, mismatch));
        }
    }
    pairs
}

fn match_shells(
    shells: &[Shell],
    features: &Features,
    source: usize,
    target: usize,
    refined: bool,
    progress: &Progress,
) -> Result<VertexImages> {
    let (queries, targets) = (&features.mirrored[source], &features.own[target]);
    let anchored = nearest(queries.as_ref(), targets.as_ref());
    let start = VertexImages::at_vertices(&shells[target].triangles, anchored);
    let smallest = shells[source].points.len().min(shells[target].points.len());
    if !refined || smallest < 2 * SIZES[0] {
        return Ok(start);
    }
    let better = refine_between(&shells[source], &shells[target], &start, progress)?;
    let quality = |images: &VertexImages| {
        let partners = images.partners.iter().enumerate();
        partners.map(|(i, p)| row_distance(queries, i, targets, *p as usize)).sum::<f32>()
    };
    // A refinement that leaves the anchors far behind has gone to another symmetry of the shell.
    let trusted = quality(&better) <= 2.0 * quality(&start) + 0.05 * start.partners.len() as f32;
    Ok(if trusted { better } else { start })
}

/// ZoomOut between two shells from the anchors' map.
fn refine_between(
    source: &Shell,
    target: &Shell,
    start: &VertexImages,
    progress: &Progress,
) -> Result<VertexImages> {
    let surfaces = [IntrinsicSurface::new(source), IntrinsicSurface::new(target)];
    let largest = SIZES[SIZES.len() - 1];
    let bases = [
        Eigenbasis::new(&surfaces[0], largest, 1, progress)?,
        Eigenbasis::new(&surfaces[1], largest, 1, progress)?,
    ];
    let from = MatchTarget::new(&surfaces[0], &bases[0], 1);
    let onto = MatchTarget::new(&surfaces[1], &bases[1], 1);
    let count = bases[0].count().min(bases[1].count());
    let mut images = start.clone();
    for size in SIZES.into_iter().filter(|size| *size <= count) {
        let free = full_refinement::estimate(&from.vertices(), &onto, &images.points, size, size);
        let map = project(free, Projection::Orthogonal)?;
        images = onto.images(&from.vertices(), &map, &images.seeds(), Guide::Eigenfunctions);
    }
    Ok(images)
}
