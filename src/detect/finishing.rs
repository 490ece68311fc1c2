//! Candidates finished, the best first, until as many as are asked for leave no doubts.

use crate::base::error::Result;
use crate::base::options::Options;
use crate::base::progress::{CancelToken, Progress};
use crate::base::symmetry_kind::SymmetryKind;
use crate::base::threads;
use crate::detect::assembler::Assembler;
use crate::detect::shell_symmetry::{PreparedShell, finish};
use crate::search::candidate_score::Score;
use crate::search::candidates::{Candidate, DISTINCT, GAP};
use crate::spectral::displacement::mean_displacement;
use crate::verify::acceptance::doubt;
use crate::verify::hypothesis::Hypothesis;

/// A map of this plausibility comes before one that exchanges sheets.
const LIKELY: f64 = 0.5;

/// A finished map, and the partners that it had before its parts were fitted.
#[derive(Clone)]
pub struct Finished {
    /// Partners of the samples under its candidate.
    candidate: Vec<u32>,
    map: Hypothesis,
    partners: Vec<u32>,
    kind: SymmetryKind,
}

/// Maps that were finished, and what they say about those that are not.
#[derive(Default)]
struct Known {
    maps: Vec<(Hypothesis, SymmetryKind)>,
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
) -> Result<Vec<(Hypothesis, SymmetryKind)>> {
    let mut known = Known::default();
    let mut left: Vec<&Candidate> = candidates.iter().collect();
    loop {
        left.retain(|candidate| known.asks_for(&candidate.score, options));
        if left.is_empty() {
            break;
        }
        progress.report("refining", 0.75)?;
        let at_once = if known.maps.is_empty() { 1 } else { options.threads.clamp(1, left.len()) };
        let group = left.drain(..at_once).collect();
        let (own, token) = (options.threads / at_once, progress.token());
        let samples = &assembler.shell.samples.vertices;
        let one = |candidate: &Candidate| match again(earlier, candidate, samples) {
            Some(finished) => Ok(Some(finished)),
            None => finish_new(assembler, candidate, &known.maps, own, token),
        };
        for finished in threads::map(options.threads, group, one) {
            let Some(finished) = finished? else { continue };
            if earlier.iter().all(|other| other.candidate != finished.candidate) {
                earlier.push(finished.clone());
            }
            known.add(assembler.shell, finished, options);
        }
    }
    rank(&mut known.maps, |(map, kind)| (*kind, map.judged.plausibility, map.exchanges_sheets()));
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
    token: &CancelToken,
) -> Result<Option<Finished>> {
    let kind = candidate.score.kind().unwrap_or(SymmetryKind::Reflection);
    let (target, quiet) = (assembler.target.with_threads(threads), Progress::new(None, token.clone()));
    let map = finish(assembler.shell, &target, candidate, assembler.plan, assembler.least, &quiet)?;
    let partners = map.images.partners.clone();
    if is_met(assembler.shell, &partners, kind, others) {
        return Ok(None);
    }
    let map = assembler.with_parts(map, kind, threads, token)?;
    Ok(Some(Finished { candidate: candidate.partners.clone(), map, partners, kind }))
}

impl Known {
    /// Whether a candidate of this score is worth finishing.
    fn asks_for(&self, score: &Score, options: &Options) -> bool {
        self.sure < options.symmetries && self.best.is_none_or(|best| score.isometry() < best + GAP)
    }

    /// Adds a map unless those before it, with which it was finished side by side, make it needless.
    fn add(&mut self, shell: &PreparedShell, finished: Finished, options: &Options) {
        let Finished { map, partners, kind, .. } = finished;
        if !self.asks_for(&map.score, options) || is_met(shell, &partners, kind, &self.maps) {
            return;
        }
        let exchanges_sheets = map.exchanges_sheets();
        self.sure += usize::from(doubt(map.judged.plausibility) == 0.0 && !exchanges_sheets);
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

/// Leaves maps of one kind in their order, that of the scores, but for those that may be none, which come behind, the more plausible
/// first. `kind_plausibility_sheets` says of a map whether it exchanges sheets, too: then it comes behind all that are likely.
fn rank<M>(maps: &mut [M], kind_plausibility_sheets: impl Fn(&M) -> (SymmetryKind, f64, bool)) {
    let doubt_of = |map: &M| {
        let (kind, plausibility, exchanges_sheets) = kind_plausibility_sheets(map);
        let least = if exchanges_sheets { doubt(LIKELY) } else { 0.0 };
        (kind, doubt(plausibility).max(least))
    };
    maps.sort_by(|a, b| {
        let ((kind, own), (other_kind, other)) = (doubt_of(a), doubt_of(b));
        kind.cmp(&other_kind).then(own.total_cmp(&other))
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use SymmetryKind::{HalfTurn, Reflection};

    #[test]
    fn plausibility_ranks_maps_of_a_kind_only_where_there_is_doubt() {
        let ranked = |mut maps: Vec<(SymmetryKind, f64)>| {
            rank(&mut maps, |(kind, plausibility)| (*kind, *plausibility, false));
            maps.into_iter().map(|(_, plausibility)| plausibility).collect::<Vec<f64>>()
        };
        assert_eq!(ranked(vec![(Reflection, 0.96), (Reflection, 0.99)]), [0.96, 0.99]);
        assert_eq!(ranked(vec![(Reflection, 0.6), (Reflection, 0.4), (Reflection, 0.9)]), [0.9, 0.6, 0.4]);
        assert_eq!(
            ranked(vec![(Reflection, 0.5), (Reflection, 0.98), (Reflection, 0.96)]),
            [0.98, 0.96, 0.5]
        );
        assert_eq!(ranked(vec![(Reflection, 0.1), (HalfTurn, 1.0)]), [0.1, 1.0]);
    }

    #[test]
    fn exchanged_sheets_come_behind_what_is_likely() {
        let ranked = |mut maps: Vec<(f64, bool)>| {
            rank(&mut maps, |(plausibility, sheets)| (Reflection, *plausibility, *sheets));
            maps
        };
        assert_eq!(ranked(vec![(1.0, true), (0.51, false)]), [(0.51, false), (1.0, true)]);
        assert_eq!(ranked(vec![(0.49, false), (1.0, true)]), [(1.0, true), (0.49, false)]);
        assert_eq!(ranked(vec![(0.3, true), (0.2, false)]), [(0.3, true), (0.2, false)]);
    }
}
