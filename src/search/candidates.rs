//! Candidate maps: proposed by parity, refined on few samples, scored, ranked, thinned to distinct ones.

use crate::base::effort::{Plan, Search};
use crate::base::error::Result;
use crate::base::options::Options;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::base::threads;
use crate::search::candidate_score::{Score, Scorer};
use crate::search::extrema_starts;
use crate::search::functional_map::{Projection, from_parity, mean_trace};
use crate::search::parity_search::{involutions_of_three, search as beam_search};
use crate::search::refinement::SampleRefiner;
use crate::search::sign_network::SignPrediction;
use crate::search::twin_starts::TwinDistances;
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::sampling::{SPREAD_COORDINATES, Samples, spread_rows};
use faer::Mat;
use std::collections::HashSet;
use std::sync::{Mutex, PoisonError};

/// Size of the candidates' functional maps.
pub const CANDIDATE_SIZE: usize = 30;
/// Lengths of the starts that the beam search proposes.
const LENGTHS: [usize; 3] = [6, 8, 11];
/// Lengths of the network's starts, and how many of the most likely of each are tried.
const NETWORK_PROPOSALS: [(usize, usize); 3] = [(12, 8), (8, 8), (6, 4)];
/// The network's starts are tried so many at a time, until a reflection scores below this.
const FEW: usize = 8;
const CONVINCING: f64 = -3.2;
/// Half turns that are turned over at most.
const TURNED: usize = 3;
/// Mean distance, in radii of the embedding, from which two maps count as different symmetries.
pub const DISTINCT: f64 = 0.25;
/// A further symmetry whose score (without the network's say) is worse than the best one's by this is none.
pub const GAP: f64 = 2.0;
/// Distance, in radii of the embedding, from which two maps send a sample to different places.
const ELSEWHERE: f64 = 0.2;
/// A rival that scores worse by this has a weight of 1 / e.
const RIVAL_SCALE: f64 = 0.5;

/// A refined and scored map.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Functional map of size up to 30.
    pub map: Mat<f64>,
    /// Image (an index into the samples) of each of the first samples.
    pub partners: Vec<u32>,
    /// Its score.
    pub score: Score,
    /// How much speaks for another image of each of the first samples, 0..=1; empty until [`distinct`] has compared
    /// the candidates.
    pub doubts: Vec<f64>,
}

impl Candidate {
    /// A map that gives the samples these partners, scored.
    ///
    /// # Errors
    /// Those of [`Scorer::score_of`].
    pub(super) fn scored(scorer: &Scorer, map: Mat<f64>, partners: Vec<u32>) -> Result<Candidate> {
        let score = scorer.score_of(&map, &partners)?;
        Ok(Candidate { map, partners, score, doubts: Vec::new() })
    }
}

/// What is known before a search.
#[derive(Clone, Copy, Default)]
pub struct Hints<'a> {
    /// Which of the first eigenfunctions are even or odd; empty without a network.
    pub signs: &'a [SignPrediction],
    /// Of a surface whose parts have likely twins.
    pub twins: Option<&'a TwinDistances>,
}

/// What searches on the same samples have found.
#[derive(Default)]
pub struct Tried {
    /// How many of the network's starts were tried, from the first on: they are those of every search.
    network_starts: usize,
    seen: Mutex<HashSet<Passage>>,
    candidates: Vec<Candidate>,
}

/// Refines the starts of a search and returns the maps that are no identity, those of searches before it too, best first.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn find(
    surface: &IntrinsicSurface,
    scorer: &Scorer,
    hints: &Hints,
    search: &Search,
    options: &Options,
    tried: &mut Tried,
    progress: &Progress,
) -> Result<Vec<Candidate>> {
    let (refiner, eigenvalues, token) = (scorer.refiner, scorer.eigenvalues(), progress.token());
    let samples = &refiner.samples;
    let mut starts = propose_signs(hints.signs);
    starts.truncate(search.network_starts);
    let of_network = starts.len();
    // Without a network the beam search stands alone, in the small plan, too.
    let least = if starts.is_empty() { Plan::wide().search.beam_width } else { 0 };
    let beam_width = search.beam_width.max(least);
    let few = if beam_width > 0 { usize::MAX } else { FEW };
    if beam_width > 0 {
        starts.extend(propose(samples, eigenvalues, beam_width));
    }
    if options.symmetries > 1 {
        starts.extend(involutions_of_three(eigenvalues));
    }
    if search.limbs {
        starts.extend(extrema_starts::starts(surface, refiner, options.threads, token)?);
    }
    progress.report("candidates", 0.45)?;
    if tried.seen.get_mut().unwrap_or_else(PoisonError::into_inner).is_empty() {
        tried.candidates = of_twins(refiner, scorer, hints.twins, &tried.seen)?;
    }
    let (known, others) = starts.split_at(of_network);
    for group in known[tried.network_starts.min(of_network)..].chunks(few).chain(others.chunks(few)) {
        let found = threads::map(options.threads, group.iter().collect(), |start| {
            token.check()?;
            try_start(refiner, scorer, start, &tried.seen)
        });
        let found = found.into_iter().collect::<Result<Vec<_>>>()?;
        tried.candidates.extend(found.into_iter().flatten());
        tried.network_starts = (tried.network_starts + group.len()).min(of_network);
        if few == FEW && tried.candidates.iter().any(convinces) {
            break;
        }
    }
    let mut candidates = tried.candidates.clone();
    if search.turned_over {
        let turned = turned_over(samples, scorer, eigenvalues, &candidates)?;
        candidates.extend(turned);
    }
    // Which of two starts that meet goes on depends on the threads, so equal scores are told apart by the map.
    candidates.sort_by(|a, b| {
        a.score.total().total_cmp(&b.score.total()).then_with(|| a.partners.cmp(&b.partners))
    });
    Ok(candidates)
}

/// Maps by parts that are likely twins; each also turned over, unless it is a reflection.
fn of_twins(
    refiner: &SampleRefiner,
    scorer: &Scorer,
    twins: Option<&TwinDistances>,
    seen: &Mutex<HashSet<Passage>>,
) -> Result<Vec<Candidate>> {
    let mut found = Vec::new();
    for start in twins.map_or(Ok(Vec::new()), |twins| twins.starts(refiner))? {
        let Some(candidate) = try_start(refiner, scorer, &start, seen)? else {
            continue;
        };
        if candidate.score.orientation > 0.0
            && let Some((map, partners)) = scorer.turned_over(&candidate.map)?
        {
            found.push(Candidate::scored(scorer, map, partners)?);
        }
        found.push(candidate);
    }
    Ok(found)
}

/// Whether no more of the network's starts need be tried.
fn convinces(candidate: &Candidate) -> bool {
    candidate.score.kind() == Some(SymmetryKind::Reflection) && candidate.score.total() < CONVINCING
}

/// Reflections made of half turns that fit better than every reflection.
fn turned_over(
    samples: &Samples,
    scorer: &Scorer,
    eigenvalues: &[f64],
    candidates: &[Candidate],
) -> Result<Vec<Candidate>> {
    let of_kind = |kind| candidates.iter().filter(move |candidate| candidate.score.kind() == Some(kind));
    let best = of_kind(SymmetryKind::Reflection).map(|own| own.score.total()).fold(f64::INFINITY, f64::min);
    let is_better = |own: &&Candidate| own.score.total_of_kind() < best;
    let mut better: Vec<Candidate> = of_kind(SymmetryKind::HalfTurn).filter(is_better).cloned().collect();
    better.sort_by(|a, b| {
        a.score.total_of_kind().total_cmp(&b.score.total_of_kind()).then_with(|| a.partners.cmp(&b.partners))
    });
    let mut found = Vec::new();
    for half_turn in distinct(&better, samples, eigenvalues, TURNED, true) {
        let Some((map, partners)) = scorer.turned_over(&half_turn.map)? else { break };
        found.push(Candidate::scored(scorer, map, partners)?);
    }
    found.retain(|turned| !turned.score.is_identity());
    Ok(found)
}

/// Expected parity of each function: from -1, odd, to +1, even.
pub(crate) fn parities(signs: &[SignPrediction]) -> Vec<f64> {
    signs.iter().map(|sign| f64::from(sign.even - sign.odd)).collect()
}

/// Refines and scores a start; `None` if it ends near the identity or where another start has been.
fn try_start(
    refiner: &SampleRefiner,
    scorer: &Scorer,
    start: &Mat<f64>,
    seen: &Mutex<HashSet<Passage>>,
) -> Result<Option<Candidate>> {
    let Some(map) = refine(refiner, start, seen)? else { return Ok(None) };
    let partners = refiner.partners(&map);
    Ok(Some(Candidate::scored(scorer, map, partners)?).filter(|found| !found.score.is_identity()))
}

/// The starts of the beam search, as many of each length as it is wide.
fn propose(samples: &Samples, eigenvalues: &[f64], beam_width: usize) -> Vec<Mat<f64>> {
    // A small mesh has fewer eigenfunctions than the shortest proposal.
    let lengths = LENGTHS.map(|length| length.min(samples.rows.ncols()));
    let found = beam_search(samples, eigenvalues, &lengths, beam_width);
    found.into_iter().flatten().filter(|start| mean_trace(start) < 1.0).collect()
}

/// The network's signs, and those with the least certain of them flipped, most likely first.
fn propose_signs(signs: &[SignPrediction]) -> Vec<Mat<f64>> {
    let logits: Vec<f64> = signs.iter().map(|sign| f64::from(sign.logit)).collect();
    let mut starts = Vec::new();
    for (length, most) in NETWORK_PROPOSALS.into_iter().filter(|(length, _)| *length <= logits.len()) {
        let logits = &logits[..length];
        let is_flipped = |flips: usize, function: usize| flips >> function & 1 == 1;
        let cost = |flips: usize| -> f64 {
            (0..length)
                .filter(|&function| is_flipped(flips, function))
                .map(|function| logits[function].abs())
                .sum()
        };
        let mut flip_sets: Vec<(f64, usize)> = (0..1 << length).map(|flips| (cost(flips), flips)).collect();
        flip_sets.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, flips) in flip_sets.into_iter().take(most) {
            let is_odd = |function: usize| (logits[function] < 0.0) != is_flipped(flips, function);
            let parity: Vec<i8> = (0..length).map(|function| if is_odd(function) { -1 } else { 1 }).collect();
            if parity.contains(&-1) {
                starts.push(from_parity(&parity));
            }
        }
    }
    starts
}

/// What the rest of a refinement depends on: the step by which the map grows, its next size, and the partners.
type Passage = (usize, usize, Vec<u32>);

/// ICP at the start's length, then ZoomOut to the candidates' size; `None` on meeting the path of another start.
fn refine(
    refiner: &SampleRefiner,
    start: &Mat<f64>,
    seen: &Mutex<HashSet<Passage>>,
) -> Result<Option<Mat<f64>>> {
    let length = start.nrows();
    let (rounds, step) = if length >= 8 { (5, 3) } else { (2, 2) };
    let mut map = refiner.refine(start.clone(), &vec![length; rounds], Projection::Orthogonal)?;
    for size in (length + step..=CANDIDATE_SIZE).step_by(step) {
        let partners = refiner.partners(&map);
        if !seen.lock().unwrap_or_else(PoisonError::into_inner).insert((step, size, partners.clone())) {
            return Ok(None);
        }
        map = refiner.estimate(&partners, size.min(refiner.samples.rows.ncols()), Projection::Involution)?;
    }
    Ok(Some(map))
}

/// Keeps the best of each group of near-equal maps, at most `most`, and says how much the others doubt them: all others if
/// `of_all`, or those that come after them, where those before are other symmetries.
///
/// `candidates` are sorted, best first.
pub fn distinct(
    candidates: &[Candidate],
    samples: &Samples,
    eigenvalues: &[f64],
    most: usize,
    of_all: bool,
) -> Vec<Candidate> {
    let rows = spread_rows(samples, eigenvalues);
    let mut kept: Vec<Candidate> = Vec::new();
    for (index, candidate) in candidates.iter().enumerate() {
        if kept.len() == most {
            break;
        }
        if kept.iter().all(|other| mean_distance(&rows, &candidate.partners, &other.partners) > DISTINCT) {
            let before = if of_all { &candidates[..index] } else { &[] };
            let all = candidates[index..].iter().chain(before);
            kept.push(Candidate { doubts: doubts(all, &rows), ..candidate.clone() });
        }
    }
    kept
}

/// For each sample the share of the `candidates` that send it elsewhere than the first, the best of them, does; those that
/// score worse weigh less.
pub(crate) fn doubts<'a>(
    candidates: impl Iterator<Item = &'a Candidate> + Clone,
    rows: &[[f64; SPREAD_COORDINATES]],
) -> Vec<f64> {
    let Some(best) = candidates.clone().next() else { return Vec::new() };
    let weight = |other: &Candidate| ((best.score.total() - other.score.total()) / RIVAL_SCALE).exp();
    let all: f64 = candidates.clone().map(weight).sum();
    let mut doubts = vec![0.0; best.partners.len()];
    for other in candidates {
        let share = weight(other) / all;
        for (doubt, (&own, &image)) in doubts.iter_mut().zip(best.partners.iter().zip(&other.partners)) {
            if distance(rows, own, image) > ELSEWHERE {
                *doubt += share;
            }
        }
    }
    doubts
}

/// Mean distance between the images of the samples, in radii of the embedding.
pub(crate) fn mean_distance(rows: &[[f64; SPREAD_COORDINATES]], first: &[u32], second: &[u32]) -> f64 {
    first.iter().zip(second).map(|(&a, &b)| distance(rows, a, b)).sum::<f64>() / first.len() as f64
}

fn distance(rows: &[[f64; SPREAD_COORDINATES]], a: u32, b: u32) -> f64 {
    let (p, q) = (&rows[a as usize], &rows[b as usize]);
    p.iter().zip(q).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(partners: Vec<u32>, commutator: f64) -> Candidate {
        let score = Score {
            commutator,
            orientation: -1.0,
            fixed: 0.0,
            disagreement: 0.0,
            trace: 0.0,
            by_twins: false,
        };
        Candidate { map: Mat::zeros(1, 1), partners, score, doubts: Vec::new() }
    }

    #[test]
    fn rivals_are_doubts_where_they_differ_the_less_the_worse_they_score() {
        // Two pairs of neighbours, which are nearer than what counts as elsewhere.
        let place = |x: f64| std::array::from_fn(|j| if j == 0 { x } else { 0.0 });
        let rows = [place(0.0), place(0.1), place(1.0), place(1.1)];
        let best = candidate(vec![0, 1, 2, 3], 0.01);
        let doubts_by = |rival| doubts([&best, &rival].into_iter(), &rows);
        assert_eq!(doubts_by(candidate(vec![1, 0, 3, 2], 0.01)), [0.0; 4]);
        assert_eq!(doubts_by(candidate(vec![0, 3, 2, 1], 0.01)), [0.0, 0.5, 0.0, 0.5]);
        let worse = doubts_by(candidate(vec![0, 3, 2, 1], 0.1));
        assert!(worse[0] == 0.0 && worse[1] > 0.0 && worse[1] < 0.05, "{worse:?}");
    }

    #[test]
    fn better_candidates_doubt_a_map_only_where_one_is_sought() {
        let samples =
            Samples { vertices: vec![0, 1], rows: Mat::from_fn(2, 1, |i, _| i as f64), parts: None };
        let candidates = [candidate(vec![1, 0], 0.01), candidate(vec![0, 1], 0.011)];
        let doubts_of_second = |of_all| distinct(&candidates, &samples, &[1.0], 2, of_all)[1].doubts.clone();
        assert_eq!(doubts_of_second(false), [0.0; 2]);
        let doubts = doubts_of_second(true);
        assert!(doubts.iter().all(|doubt| *doubt > 0.5 && *doubt < 0.6), "{doubts:?}");
    }
}
