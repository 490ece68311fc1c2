//! Candidates finished: the best one alone if it leaves no doubts, with its rivals if it does.

use crate::acceptance::doubt;
use crate::assembler::Assembler;
use crate::candidate_score::Score;
use crate::candidates::{Candidate, DISTINCT, GAP};
use crate::displacement::mean_displacement;
use crate::error::Result;
use crate::options::Options;
use crate::progress::{CancelToken, Progress};
use crate::shell_symmetry::{PreparedShell, ShellSymmetry, finish};
use crate::symmetry_kind::SymmetryKind;
use crate::threads;

/// A finished map, and the partners that it had before its parts were fitted.
struct Finished {
    map: ShellSymmetry,
    partners: Vec<u32>,
    kind: SymmetryKind,
}

/// Maps that were finished, and what they say about those that are not.
#[derive(Default)]
struct Known {
    maps: Vec<(ShellSymmetry, SymmetryKind)>,
    /// Those that leave no doubts.
    sure: usize,
    /// The best score of those that are accepted.
    best: Option<f64>,
}

/// The maps of `candidates` (best first) that count, finished: reflections, then half turns, the best first.
///
/// Once as many as are asked for leave no doubts, no other is finished, nor are those that score much worse than one that is accepted. The first
/// has all threads, since it often ends the search; those after it are finished side by side.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn finish_best(
    assembler: &Assembler,
    candidates: &[Candidate],
    options: &Options,
    progress: &Progress,
) -> Result<Vec<(ShellSymmetry, SymmetryKind)>> {
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
        let one = |candidate| finish_new(assembler, candidate, &known.maps, own, token);
        for finished in threads::map(options.threads, group, one) {
            if let Some(finished) = finished? {
                known.add(assembler.shell, finished, options);
            }
        }
    }
    rank(&mut known.maps, |(map, kind)| (*kind, map.judged.plausibility));
    Ok(known.maps)
}

/// A finished candidate; `None` if refinement leads it to one of the `others`.
fn finish_new(
    assembler: &Assembler,
    candidate: &Candidate,
    others: &[(ShellSymmetry, SymmetryKind)],
    threads: usize,
    token: &CancelToken,
) -> Result<Option<Finished>> {
    let kind = candidate.score.kind().unwrap_or(SymmetryKind::Reflection);
    let (target, quiet) = (assembler.target.with_threads(threads), Progress::new(None, token.clone()));
    let map = finish(assembler.shell, &target, candidate, assembler.least, &quiet)?;
    let partners = map.images.partners.clone();
    if is_met(assembler.shell, &partners, kind, others) {
        return Ok(None);
    }
    let map = assembler.with_parts(map, kind, threads, token)?;
    Ok(Some(Finished { map, partners, kind }))
}

impl Known {
    /// Whether a candidate of this score is worth finishing.
    fn asks_for(&self, score: &Score, options: &Options) -> bool {
        self.sure < options.symmetries && self.best.is_none_or(|best| score.isometry() < best + GAP)
    }

    /// Adds a map unless those before it, with which it was finished side by side, make it needless.
    fn add(&mut self, shell: &PreparedShell, Finished { map, partners, kind }: Finished, options: &Options) {
        if !self.asks_for(&map.score, options) || is_met(shell, &partners, kind, &self.maps) {
            return;
        }
        self.sure += usize::from(doubt(map.judged.plausibility) == 0.0);
        if map.judged.accepted(options.plausibility) {
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
    others: &[(ShellSymmetry, SymmetryKind)],
) -> bool {
    let is_same = |other: &ShellSymmetry| {
        let and_back: Vec<u32> =
            partners.iter().map(|&partner| other.images.partners[partner as usize]).collect();
        mean_displacement(&shell.basis, &shell.surface.lumped_mass, &and_back) < DISTINCT
    };
    others.iter().any(|(other, of_kind)| *of_kind == kind && is_same(other))
}

/// Leaves maps of one kind in their order, that of the scores, but for those that may be none, which come behind, the more plausible
/// first.
fn rank<M>(maps: &mut [M], kind_and_plausibility: impl Fn(&M) -> (SymmetryKind, f64)) {
    maps.sort_by(|a, b| {
        let ((kind, plausibility), (other_kind, other)) =
            (kind_and_plausibility(a), kind_and_plausibility(b));
        kind.cmp(&other_kind).then(doubt(plausibility).total_cmp(&doubt(other)))
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use SymmetryKind::{HalfTurn, Reflection};

    #[test]
    fn plausibility_ranks_maps_of_a_kind_only_where_there_is_doubt() {
        let ranked = |mut maps: Vec<(SymmetryKind, f64)>| {
            rank(&mut maps, |map| *map);
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
}
