//! Symmetries that follow from others.
//!
//! Of two symmetries A and B that are their own inverses, the conjugate A B A is one more, and so is the product A B if
//! they commute. A search finds some of a solid's symmetries; what they generate is the rest, or much of it.

use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::search::candidate_score::Scorer;
use crate::search::candidates::{CANDIDATE_SIZE, Candidate, DISTINCT, GAP, doubts, mean_distance};
use crate::search::functional_map::Projection;
use crate::search::refinement::SampleRefiner;
use crate::spectral::sampling::spread_rows;

/// Rounds of refinement of a composition.
const ROUNDS: usize = 3;
/// Maps are composed, and compositions added, whose score is worse than the best one's by less than this. On a shape
/// with one symmetry and many doubtful maps a wider gap adds dozens, all to be refused once they are finished.
const COMPOSED_GAP: f64 = 0.75 * GAP;

/// Adds to the distinct maps `found` those that follow from the good ones among them, until there are `most`; unsorted.
///
/// `rivals` are all maps that were tried: they say how much is to be doubted of an added one. O(`most`^2) compositions of
/// samples; those that are new are refined and scored.
///
/// # Errors
/// [`crate::Error::Cancelled`]; [`crate::Error::Internal`] if a decomposition fails.
pub fn complete(
    refiner: &SampleRefiner,
    scorer: &Scorer,
    eigenvalues: &[f64],
    mut found: Vec<Candidate>,
    rivals: &[Candidate],
    most: usize,
    progress: &Progress,
) -> Result<Vec<Candidate>> {
    let samples = &refiner.samples;
    let rows = spread_rows(samples, eigenvalues);
    let best = found.iter().map(|candidate| candidate.score.isometry()).fold(f64::INFINITY, f64::min);
    let is_good = |candidate: &Candidate| candidate.score.isometry() < best + COMPOSED_GAP;
    let is_new = |partners: &[u32], known: &[Candidate]| {
        known.iter().all(|other| mean_distance(&rows, partners, &other.partners) > DISTINCT)
    };
    let identity: Vec<u32> = (0..samples.count() as u32).collect();
    let is_identity = |partners: &[u32]| mean_distance(&rows, partners, &identity) <= DISTINCT;
    // Every two of them meet once, the added ones too.
    let mut later = 1;
    while later < found.len() {
        for earlier in 0..later {
            progress.check()?;
            if !is_good(&found[earlier]) || !is_good(&found[later]) {
                continue;
            }
            for partners in words(&found[earlier].partners, &found[later].partners) {
                if found.len() >= most {
                    return Ok(found);
                }
                let is_involution = is_identity(&composed(&partners, &partners));
                if !is_involution || is_identity(&partners) || !is_new(&partners, &found) {
                    continue;
                }
                let size = CANDIDATE_SIZE.min(samples.rows.ncols());
                let start = refiner.estimate(&partners, size, Projection::Involution)?;
                let map = refiner.refine(start, &[size; ROUNDS], Projection::Involution)?;
                let partners = refiner.partners(&map);
                let mut added = Candidate::scored(scorer, map, partners)?;
                if added.score.kind().is_some() && is_good(&added) && is_new(&added.partners, &found) {
                    added.doubts = doubts(std::iter::once(&added).chain(rivals), &rows);
                    found.push(added);
                }
            }
        }
        later += 1;
    }
    Ok(found)
}

/// A B A, B A B and A B.
fn words(a: &[u32], b: &[u32]) -> [Vec<u32>; 3] {
    let product = composed(a, b);
    [composed(&product, a), composed(b, &product), product]
}

/// First `a`, then `b`.
fn composed(a: &[u32], b: &[u32]) -> Vec<u32> {
    a.iter().map(|&image| b[image as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_reflections_of_a_square_give_its_other_two_and_its_half_turn() {
        // Corners 0 to 3 in order around the square.
        let (upright, diagonal) = (vec![1, 0, 3, 2], vec![0, 3, 2, 1]);
        let [first, second, product] = words(&upright, &diagonal);
        assert_eq!((first, second), (vec![2, 1, 0, 3], vec![3, 2, 1, 0]));
        assert_eq!(product, [3, 0, 1, 2]);
        assert_eq!(composed(&product, &product), [2, 3, 0, 1]);
        let [.., half_turn] = words(&upright, &[3, 2, 1, 0]);
        assert_eq!(half_turn, [2, 3, 0, 1]);
    }
}
