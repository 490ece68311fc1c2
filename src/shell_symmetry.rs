//! The symmetries of one shell: all spectral stages in order.

use crate::acceptance::Judgement;
use crate::candidate_score::{Score, Scorer};
use crate::candidates::{self, CANDIDATE_SIZE, Candidate, parities};
use crate::compositions;
use crate::displacement::{mean_displacement, mean_displacement_of};
use crate::effort::{Plan, Search};
use crate::eigenbasis::Eigenbasis;
use crate::error::Result;
use crate::full_refinement::{self, MatchTarget, Sources, VertexImages};
use crate::functional_map::project;
use crate::laplacian::IntrinsicSurface;
use crate::mesh_descent::Seeds;
use crate::options::Options;
use crate::progress::Progress;
use crate::refinement::SampleRefiner;
use crate::sampling::{Samples, area_weighted_vertices};
use crate::sign_network::{REFERENCES, SIGNS, SignNetwork, SignPrediction};
use crate::signature;
use crate::spread_points::SpreadPoints;
use crate::symmetry_kind::SymmetryKind;
use crate::vertex_rows::Guide;
use faer::Mat;

/// Sizes of the functional map on samples after a candidate is chosen.
const POLISH_SIZES: [usize; 5] = [30, 30, 36, 42, 50];
/// Size of the map whose signatures are compared, made without curvature: finer and guided ones fit shapes without
/// a symmetry, too.
const COARSE_SIZE: usize = 50;
/// Vertices that exchange the sides of a thin sheet are nearer than this, in sqrt(area), to their images: 0.01 to 0.05 on plates of a thickness of some percent of
/// their length, where those of other symmetries are 0.09 and more away (`docs/method.md`).
const SHEETS: f64 = 0.06;

/// Vertices the network looks at.
const NETWORK_POINTS: usize = 512;

/// One symmetry of a shell.
#[derive(Debug, Clone)]
pub struct ShellSymmetry {
    /// Functional map after the last refinement.
    pub map: Mat<f64>,
    /// Images of all vertices.
    pub images: VertexImages,
    /// Score of the candidate it came from.
    pub score: Score,
    /// Some vertices, spread over the shell, each with how much speaks for another image of it, 0..=1; empty if there
    /// are no rivals.
    pub doubts: Vec<(u32, f64)>,
    /// Whether the map is a symmetry at all.
    pub judged: Judgement,
    /// Mean distance in space of vertices from their images, in sqrt(area); infinite until positions are looked at.
    pub moved: f64,
}

impl ShellSymmetry {
    /// Whether it exchanges the sides of a thin sheet: a symmetry, but hardly one that anybody asks for.
    pub fn exchanges_sheets(&self) -> bool {
        exchanges_sheets(self.moved)
    }
}

/// Whether a map exchanges the sides of a thin sheet that moves vertices by so much, in sqrt(area), in the mean.
pub fn exchanges_sheets(moved: f64) -> bool {
    moved < SHEETS
}

/// A shell with its operators and eigenbasis.
pub struct PreparedShell {
    /// Laplacian.
    pub surface: IntrinsicSurface,
    /// Eigenbasis.
    pub basis: Eigenbasis,
    /// Farthest-point samples.
    pub samples: Samples,
}

impl PreparedShell {
    /// Solves a surface.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
    pub fn new(
        surface: IntrinsicSurface,
        plan: &Plan,
        threads: usize,
        progress: &Progress,
    ) -> Result<PreparedShell> {
        let basis = Eigenbasis::new(&surface, plan.eigenfunctions, threads, progress)?;
        let samples = Samples::farthest(&basis, plan.samples);
        Ok(PreparedShell { surface, basis, samples })
    }
}

/// Parity of a shell's first eigenfunctions as the network sees it, overruled by the signs that are `known`.
///
/// Empty if the caller wants no network and knows nothing.
///
/// # Errors
/// [`crate::Error::Model`] or [`crate::Error::File`] if a model of the caller's own cannot be used.
pub fn signs(
    surface: &IntrinsicSurface,
    basis: &Eigenbasis,
    options: &Options,
    known: &[i8],
) -> Result<Vec<SignPrediction>> {
    let k = basis.count().min(SIGNS);
    let mut signs = match &options.model {
        _ if options.network == 0 || k < REFERENCES => Vec::new(),
        Some(path) => predict(&SignNetwork::from_file(path)?, surface, basis, k)?,
        None => predict(SignNetwork::shared(), surface, basis, k)?,
    };
    let known = &known[..known.len().min(basis.count())];
    if known.iter().any(|&sign| sign != 0) {
        signs.resize(signs.len().max(known.len()), SignPrediction::UNKNOWN);
        for (sign, &known) in signs.iter_mut().zip(known).filter(|(_, known)| **known != 0) {
            *sign = SignPrediction::certain(known > 0);
        }
    }
    Ok(signs)
}

fn predict(
    network: &SignNetwork,
    surface: &IntrinsicSurface,
    basis: &Eigenbasis,
    k: usize,
) -> Result<Vec<SignPrediction>> {
    let picked = area_weighted_vertices(&surface.lumped_mass, NETWORK_POINTS);
    let functions = &basis.eigenfunctions;
    let rows: Vec<f64> =
        picked.iter().flat_map(|&vertex| (0..k).map(move |j| functions[(vertex, j)])).collect();
    network.predict(&rows, picked.len(), k)
}

/// Distinct candidate maps of a shell, best first: the best reflection if one symmetry is asked for; else up to as many
/// reflections and half turns, and those that [follow](compositions) from them, in all up to three times as many.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn candidates(
    shell: &PreparedShell,
    signs: &[SignPrediction],
    search: &Search,
    options: &Options,
    progress: &Progress,
) -> Result<Vec<Candidate>> {
    let (surface, basis, samples) = (&shell.surface, &shell.basis, &shell.samples);
    let refiner = SampleRefiner::new(samples);
    let scorer = Scorer::new(surface, basis, &refiner, parities(signs));
    let found = candidates::find(surface, &refiner, &scorer, signs, search, options, progress)?;
    let most = options.symmetries;
    let of_kind = |kind| {
        let found: Vec<Candidate> =
            found.iter().filter(|candidate| candidate.score.kind() == Some(kind)).cloned().collect();
        candidates::distinct(&found, samples, &basis.eigenvalues, most, most == 1)
    };
    let mut kept = of_kind(SymmetryKind::Reflection);
    if most > 1 {
        kept.extend(of_kind(SymmetryKind::HalfTurn));
        kept =
            compositions::complete(&refiner, &scorer, &basis.eigenvalues, kept, &found, 3 * most, progress)?;
        kept.sort_by(|a, b| {
            let scores = a.score.total_of_kind().total_cmp(&b.score.total_of_kind());
            a.score.kind().cmp(&b.score.kind()).then(scores)
        });
    }
    Ok(kept)
}

/// Refines a candidate on the samples, then on points spread over the shell, which is `target`, where it grows by the plan's schedule, then
/// once on all its vertices; at each step projected as the target says. One that will not count for who asks for `least` percent
/// of plausibility does not grow.
///
/// What the coarse map says of finer functions is partly chance, so the schedule cuts it back first.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn finish(
    shell: &PreparedShell,
    target: &MatchTarget,
    candidate: &Candidate,
    plan: &Plan,
    least: usize,
    progress: &Progress,
) -> Result<ShellSymmetry> {
    let refiner = SampleRefiner::new(&shell.samples);
    let map = refiner.refine(candidate.map.clone(), &POLISH_SIZES, target.projection())?;
    let count = shell.basis.count();
    let points = SpreadPoints::new(target, plan.points, count)?;
    let samples = &shell.samples.vertices;
    let images = refiner.partners(&map).into_iter().map(|sample| samples[sample as usize]);
    let seeds = points.seeds(samples, images);
    let (few, all) = (points.sources(), target.vertices());
    let refine = |points: &Sources, map, seeds: Seeds, sizes: &[usize], guide| {
        full_refinement::refine(target, points, map, seeds, sizes, guide, progress.token())
    };
    progress.report("refining", 0.75)?;
    let coarse = COARSE_SIZE.min(count);
    let (map, images) = refine(&few, map, Seeds::Vertices(&seeds), &[coarse], Guide::Eigenfunctions)?;
    let mismatch = signature_mismatch(shell, &points.vertices, &points.mass, &images);
    let displacement = mean_displacement_of(&shell.basis, &points.vertices, &points.mass, &images.partners);
    let hopeless = Judgement::new(&candidate.score, mismatch, displacement).is_hopeless(least);
    let seeds_of = |images: &VertexImages| {
        points.vertices.iter().copied().zip(images.partners.iter().copied()).collect::<Vec<_>>()
    };
    let (map, images) = if hopeless {
        refine(&all, map, Seeds::Vertices(&seeds_of(&images)), &[coarse], Guide::Eigenfunctions)?
    } else {
        let guide = Guide::MeanCurvature;
        let sizes: Vec<usize> = plan.schedule.iter().map(|&size| size.min(count)).collect();
        let (first, last) = (sizes[0].min(coarse), sizes[sizes.len() - 1]);
        let start = map.submatrix(0, 0, first, first).to_owned();
        progress.report("refining", 0.8)?;
        let (map, images) = refine(&few, start, Seeds::Points(&images.points), &sizes, guide)?;
        progress.report("refining", 0.9)?;
        refine(&all, map, Seeds::Vertices(&seeds_of(&images)), &[last], guide)?
    };
    let judged = judge(shell, &candidate.score, mismatch, &images);
    let doubts = shell.samples.vertices.iter().copied().zip(candidate.doubts.iter().copied()).collect();
    Ok(ShellSymmetry { map, images, score: candidate.score, doubts, judged, moved: f64::INFINITY })
}

/// The symmetry with the given `images`, which the connectivity says; no rival.
///
/// # Errors
/// [`crate::Error::Internal`] if the decomposition of the functional map fails.
pub fn of_images(shell: &PreparedShell, target: &MatchTarget, images: VertexImages) -> Result<ShellSymmetry> {
    let size = shell.basis.count();
    let map = project(
        full_refinement::estimate(&target.vertices(), target, &images.points, size, size),
        target.projection(),
    )?;
    let refiner = SampleRefiner::new(&shell.samples);
    let scored = size.min(CANDIDATE_SIZE);
    let leading = map.submatrix(0, 0, scored, scored).to_owned();
    let score = Scorer::new(&shell.surface, &shell.basis, &refiner, Vec::new()).score(&leading)?;
    let vertices: Vec<u32> = (0..shell.surface.vertex_count() as u32).collect();
    let mismatch = signature_mismatch(shell, &vertices, &shell.surface.lumped_mass, &images);
    let judged = judge(shell, &score, mismatch, &images);
    Ok(ShellSymmetry { map, images, score, doubts: Vec::new(), judged, moved: f64::INFINITY })
}

/// `images` are those of all vertices.
fn judge(shell: &PreparedShell, score: &Score, signature_mismatch: f64, images: &VertexImages) -> Judgement {
    let displacement = mean_displacement(&shell.basis, &shell.surface.lumped_mass, &images.partners);
    Judgement::new(score, signature_mismatch, displacement)
}

/// `images` are those of `vertices`, of which each stands for an area.
fn signature_mismatch(shell: &PreparedShell, vertices: &[u32], areas: &[f64], images: &VertexImages) -> f64 {
    let mismatch = signature::mismatch(&shell.surface, &shell.basis, vertices, images);
    signature::mean(areas, mismatch.into_iter())
}
