//! The symmetries of one shell: all spectral stages in order.

use crate::base::effort::{Plan, Search};
use crate::base::error::Result;
use crate::base::options::Options;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::geometry::vertex_map::VertexMap;
use crate::refine::full_refinement::{self, MatchTarget};
use crate::refine::vertex_rows::Guide;
use crate::search::candidate_score::{Score, ScoreTerms, Scorer};
use crate::search::candidates::{self, CANDIDATE_SIZE, Candidate, Hints, Tried, parities};
use crate::search::compositions;
use crate::search::functional_map::Projection;
use crate::search::refinement::SampleRefiner;
use crate::search::sign_network::{REFERENCES, SIGNS, SignNetwork, SignPrediction};
use crate::spectral::displacement::mean_displacement;
use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::sampling::{Samples, area_weighted_vertices};
use crate::spectral::signature;
use crate::verify::acceptance::Judgement;
use crate::verify::hypothesis::Hypothesis;

/// Sizes of the functional map on samples after a candidate is chosen.
const POLISH_SIZES: [usize; 5] = [30, 30, 36, 42, 50];
/// Size of the map whose signatures are compared, made without curvature: finer and guided ones fit shapes without
/// a symmetry, too.
pub(super) const COARSE_SIZE: usize = 50;

/// Displacement of a map of joined shells of which some are twins, in radii of the embedding: that twins go to each other tells it from the identity, however near to the middle the others lie.
const EXCHANGED: f64 = 1.0;

/// Vertices the network looks at.
const NETWORK_POINTS: usize = 512;

/// A shell with all that its maps are made and scored by.
pub struct PreparedShell {
    /// Laplacian.
    pub surface: IntrinsicSurface,
    /// Eigenbasis.
    pub basis: Eigenbasis,
    /// Farthest-point samples, and what refines maps on them.
    pub refiner: SampleRefiner,
    /// What scores maps.
    terms: ScoreTerms,
}

impl PreparedShell {
    /// O(triangles + samples x functions^2).
    ///
    /// # Errors
    /// As [`SampleRefiner::new`].
    pub fn new(surface: IntrinsicSurface, basis: Eigenbasis, samples: Samples) -> Result<PreparedShell> {
        let terms = ScoreTerms::new(&surface, &basis, &samples);
        Ok(PreparedShell { surface, basis, refiner: SampleRefiner::new(samples)?, terms })
    }

    /// Scores its maps. `predicted` are parities of its first functions, and may be empty.
    pub fn scorer(&self, predicted: Vec<f64>) -> Scorer<'_> {
        Scorer::new(&self.refiner, &self.terms, predicted)
    }

    /// The vertices at its samples.
    pub fn sampled(&self) -> &[u32] {
        &self.refiner.samples.vertices
    }
}

/// Parity of a shell's first eigenfunctions as the network sees it, overruled by the signs that are `known`.
///
/// Empty if the caller wants no network and knows nothing.
///
/// # Errors
/// [`crate::Error::Model`] if a model of the caller's own cannot be used.
pub fn signs(
    surface: &IntrinsicSurface,
    basis: &Eigenbasis,
    options: &Options,
    known: &[i8],
) -> Result<Vec<SignPrediction>> {
    let k = basis.count().min(SIGNS);
    let mut signs = match SignNetwork::own(options)? {
        _ if !options.network || k < REFERENCES => Vec::new(),
        Some(own) => predict(&own, surface, basis, k)?,
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
    hints: &Hints,
    search: &Search,
    options: &Options,
    tried: &mut Tried,
    progress: &Progress,
) -> Result<Vec<Candidate>> {
    let PreparedShell { surface, basis, refiner, .. } = shell;
    let scorer = shell.scorer(parities(hints.signs));
    let mut found = candidates::find(surface, &scorer, hints, search, options, tried, progress)?;
    // Where likely twins exchange, any map reflects, but rather one that says so.
    let reflects = |candidate: &Candidate| candidate.score.orientation <= 0.0;
    if hints.twins.is_some() && found.iter().any(reflects) {
        found.retain(reflects);
    }
    let most = options.symmetries;
    let of_kind = |kind| {
        let found: Vec<Candidate> =
            found.iter().filter(|candidate| candidate.score.kind() == Some(kind)).cloned().collect();
        candidates::distinct(&found, &refiner.samples, &basis.eigenvalues, most, most == 1)
    };
    let mut kept = of_kind(SymmetryKind::Reflection);
    if most > 1 {
        kept.extend(of_kind(SymmetryKind::HalfTurn));
        kept =
            compositions::complete(refiner, &scorer, &basis.eigenvalues, kept, &found, 3 * most, progress)?;
        kept.sort_by(|a, b| {
            let scores = a.score.total_of_kind().total_cmp(&b.score.total_of_kind());
            a.score.kind().cmp(&b.score.kind()).then(scores)
        });
    }
    Ok(kept)
}

/// Refines a candidate on the samples, then on all vertices of the shell, which is `target`, where it grows by the plan's schedule. One
/// that will not count for who asks for `least` percent of plausibility does not grow.
///
/// What the coarse map says of finer functions is partly chance, so the schedule cuts it back first.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn finish(
    shell: &PreparedShell,
    target: &MatchTarget,
    candidate: &Candidate,
    plan: &Plan,
    least: usize,
    progress: &Progress,
) -> Result<Hypothesis> {
    let map = shell.refiner.refine(candidate.map.clone(), &POLISH_SIZES, Projection::Involution)?;
    let samples = shell.sampled();
    let images = shell.refiner.partners(&map).into_iter().map(|sample| samples[sample as usize]);
    let seeds: Vec<(u32, u32)> = samples.iter().copied().zip(images).collect();
    progress.report("refining", 0.75)?;
    let spread = target.images(&map, &seeds, Guide::Eigenfunctions, progress.token())?;
    let (map, images) =
        full_refinement::refine(target, spread, &[COARSE_SIZE], Guide::Eigenfunctions, progress)?;
    let mismatch = signature_mismatch(shell, &images);
    let judged = judge(shell, &candidate.score, mismatch, &images);
    let (map, images) = if judged.is_hopeless(least) {
        (map, images)
    } else {
        progress.report("refining", 0.8)?;
        full_refinement::refine(target, images, &plan.schedule, Guide::MeanCurvature, progress)?
    };
    let judged = judge(shell, &candidate.score, mismatch, &images);
    let doubts = samples.iter().copied().zip(candidate.doubts.iter().copied()).collect();
    Ok(Hypothesis { map, images, score: candidate.score, doubts, judged })
}

/// The symmetry with the given `images`, which the connectivity says; no rival.
///
/// # Errors
/// [`crate::Error::Internal`] if the decomposition of the functional map fails.
pub fn of_images(shell: &PreparedShell, target: &MatchTarget, images: VertexMap) -> Result<Hypothesis> {
    let size = shell.basis.count();
    let map = target.map_of(&images.points, size)?;
    let scored = size.min(CANDIDATE_SIZE);
    let leading = map.submatrix(0, 0, scored, scored).to_owned();
    let score = shell.scorer(Vec::new()).score(&leading)?;
    let mismatch = signature_mismatch(shell, &images);
    let judged = judge(shell, &score, mismatch, &images);
    Ok(Hypothesis { map, images, score, doubts: Vec::new(), judged })
}

/// `images` are those of all vertices.
fn judge(shell: &PreparedShell, score: &Score, signature_mismatch: f64, images: &VertexMap) -> Judgement {
    let displacement = match &shell.surface.parts {
        Some(parts) if parts.any_exchange() => EXCHANGED,
        _ => mean_displacement(&shell.basis, &shell.surface.lumped_mass, &images.partners),
    };
    Judgement::new(score, signature_mismatch, displacement).by(score)
}

/// Mean over the surface.
fn signature_mismatch(shell: &PreparedShell, images: &VertexMap) -> f64 {
    let mismatch = signature::mismatch(&shell.surface, &shell.basis, images);
    signature::mean(&shell.surface.lumped_mass, mismatch.into_iter())
}
