//! Candidates finished, the best first, until as many as are asked for leave no doubts.

use crate::base::error::Result;
use crate::base::options::Options;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::base::threads;
use crate::detect::assembler::Assembler;
use crate::detect::shell_symmetry::{PreparedShell, finish};
use crate::search::candidate_score::Score;
use crate::search::candidates::{Candidate, DISTINCT, GAP, Tried};
use crate::spectral::displacement::mean_displacement;
use crate::verify::choose::{Maps, rank};
use crate::verify::hypothesis::Hypothesis;

/// A finished map, and the partners that it had before its parts were fitted.
#[derive(Clone)]
pub struct Finished {
    /// Partners of the samples under its candidate.
    candidate: Vec<u32>,
    map: Hypothesis,
    partners: Vec<u32>,
    kind: SymmetryKind,
}

/// What plans on the same shell have found.
#[derive(Default)]
pub struct Found {
    /// Candidates.
    pub tried: Tried,
    /// Maps.
    pub finished: Vec<Finished>,
}

/// Maps that were finished, and what they say about those that are not.
#[derive(Default)]
struct Known {
    maps: Maps,
    /// Those that leave no doubts, but for those that exchange sheets.
    sure: usize,
    /// The best score of those that are accepted, likewise.
    best: Option<f64>,
}

/// The maps of `candidates` (best first) that count, finished: reflections, then half turns, the best first.
///
/// Once as many as are asked for leave no doubts, no other is finished, nor are those that score much worse than one that is accepted. The first
/// has all threads, since it often ends the search; those after it are finished side by side. What is finished is added to the `earlier`
/// ones on the same shell, and a candidate that led to one of these is not finished again.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn finish_best(
    assembler: &Assembler,
    candidates: &[Candidate],
    earlier: &mut Vec<Finished>,
    options: &Options,
    progress: &Progress,
) -> Result<Maps> {
    let mut known = Known::default();
    let mut left: Vec<&Candidate> = candidates.iter().collect();
    loop {
        left.retain(|candidate| known.asks_for(&candidate.score, options));
        if left.is_empty() {
            break;
        }
        progress.report("refining", 0.75)?;
        let at_once = if known.maps.is_empty() { 1 } else { options.threads.clamp(1, left.len()) };
        let group: Vec<&Candidate> = left.drain(..at_once).collect();
        let (own, token) = (options.threads / at_once, progress.token());
        let samples = assembler.shell.sampled();
        let one = |candidate: &Candidate, progress: &Progress| match again(earlier, candidate, samples) {
            Some(finished) => Ok(Some(finished)),
            None => finish_new(assembler, candidate, &known.maps, own, progress),
        };
        let quiet = |candidate: &Candidate| one(candidate, &Progress::new(None, token.clone()));
        let group = match *group {
            [alone] => vec![one(alone, progress)],
            _ => threads::map(options.threads, group, quiet),
        };
        for finished in group {
            let Some(finished) = finished? else { continue };
            if earlier.iter().all(|other| other.candidate != finished.candidate) {
                earlier.push(finished.clone());
            }
            known.add(assembler, finished, options);
        }
    }
    rank(&mut known.maps, |(map, kind)| (*kind, map.judged.plausibility, assembler.exchanges_sheets(map)));
    Ok(known.maps)
}

/// What an earlier plan made of a candidate, with what its rivals among the `samples` say now.
fn again(earlier: &[Finished], candidate: &Candidate, samples: &[u32]) -> Option<Finished> {
    let mut finished = earlier.iter().find(|finished| finished.candidate == candidate.partners)?.clone();
    finished.map.doubts = samples.iter().copied().zip(candidate.doubts.iter().copied()).collect();
    Some(finished)
}

/// A finished candidate; `None` if refinement leads it to one of the `others`.
fn finish_new(
    assembler: &Assembler,
    candidate: &Candidate,
    others: &[(Hypothesis, SymmetryKind)],
    threads: usize,
    progress: &Progress,
) -> Result<Option<Finished>> {
    let kind = candidate.score.kind().unwrap_or(SymmetryKind::Reflection);
    let target = assembler.target.with_threads(threads);
    let map = finish(assembler.shell, &target, candidate, assembler.plan, assembler.least, progress)?;
    let partners = map.images.partners.clone();
    if is_met(assembler.shell, &partners, kind, others) {
        return Ok(None);
    }
    progress.report("rigid parts", 0.88)?;
    let map = assembler.with_parts(map, kind, threads, progress)?;
    Ok(Some(Finished { candidate: candidate.partners.clone(), map, partners, kind }))
}

impl Known {
    /// Whether a candidate of this score is worth finishing.
    fn asks_for(&self, score: &Score, options: &Options) -> bool {
        self.sure < options.symmetries && self.best.is_none_or(|best| score.isometry() < best + GAP)
    }

    /// Adds a map unless those before it, with which it was finished side by side, make it needless.
    fn add(&mut self, assembler: &Assembler, finished: Finished, options: &Options) {
        let Finished { map, partners, kind, .. } = finished;
        if !self.asks_for(&map.score, options) || is_met(assembler.shell, &partners, kind, &self.maps) {
            return;
        }
        let exchanges_sheets = assembler.exchanges_sheets(&map);
        self.sure += usize::from(map.judged.is_sure() && !exchanges_sheets);
        if map.judged.accepted(options.plausibility) && !exchanges_sheets {
            let own = map.judged.isometry_score;
            self.best = Some(self.best.map_or(own, |best| best.min(own)));
        }
        self.maps.push((map, kind));
    }
}

/// Whether refinement has led a map of these `partners` to one of the `others`.
fn is_met(
    shell: &PreparedShell,
    partners: &[u32],
    kind: SymmetryKind,
    others: &[(Hypothesis, SymmetryKind)],
) -> bool {
    let is_same = |other: &Hypothesis| {
        let and_back: Vec<u32> =
            partners.iter().map(|&partner| other.images.partners[partner as usize]).collect();
        mean_displacement(&shell.basis, &shell.surface.lumped_mass, &and_back) < DISTINCT
    };
    others.iter().any(|(other, of_kind)| *of_kind == kind && is_same(other))
}
