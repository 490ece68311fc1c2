//! EXPERIMENTAL: rotations of order three or more, maps R that keep orientation and whose n-th power is the identity.
//!
//! They are not their own inverses, so no map is projected to an involution here, only to an orthogonal matrix. Starts come
//! from the search by blocks ([`crate::parity_search`]), from the space of the three lowest eigenfunctions where these
//! coincide, and from the symmetries that were found before: two reflections whose axes meet at an angle make a rotation
//! by twice that angle. A rotation, its powers and its inverse are one cyclic group, of which one is kept.

use crate::candidate_score::{Score, Scorer};
use crate::candidates::{
    CANDIDATE_SAMPLES, CANDIDATE_SIZE, Candidate, DISTINCT, GAP, mean_distance, try_start,
};
use crate::compositions::{ROUNDS, composed};
use crate::displacement::mean_displacement;
use crate::error::Result;
use crate::full_refinement::MatchTarget;
use crate::functional_map::{Projection, mean_trace};
use crate::options::Options;
use crate::parity_search::{Sought, rotations_of_three, search};
use crate::progress::Progress;
use crate::refinement::SampleRefiner;
use crate::sampling::{SPREAD_COORDINATES, spread_rows};
use crate::shell_symmetry::{PreparedShell, ShellSymmetry, finish};
use crate::symmetry_kind::SymmetryKind;
use crate::threads;
use faer::Mat;
use std::sync::Mutex;

/// Orders that are looked for: 3 to the largest.
const LARGEST_ORDER: usize = 12;
/// Each of these orders divides one of them.
const SEARCHED_ORDERS: [usize; 6] = [7, 8, 9, 10, 11, 12];
/// Lengths of the starts.
const LENGTHS: [usize; 2] = [6, 8];
/// Starts tried of each length and order.
const PROPOSALS: usize = 6;
/// Symmetries that are composed with each other, at most.
const MOST_COMPOSED: usize = 96;

/// A rotation of the samples that stands for its cyclic group.
struct Generator {
    candidate: Candidate,
    /// Its powers below the identity: itself, then its square, ..., last its inverse.
    powers: Vec<Vec<u32>>,
}

impl Generator {
    fn order(&self) -> usize {
        self.powers.len() + 1
    }
}

/// Finds and finishes up to `options.rotations` rotations of order three or more that count as symmetries: one of each cyclic
/// group, those of highest order first, then the best.
///
/// `involutions` are the symmetries found before. A shell that cannot be oriented gets none.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn find(
    shell: &PreparedShell,
    target: &MatchTarget,
    involutions: &[(ShellSymmetry, SymmetryKind)],
    options: &Options,
    progress: &Progress,
) -> Result<Vec<(ShellSymmetry, SymmetryKind)>> {
    let target = target.with_projection(Projection::Orthogonal);
    let generators = generators(shell, involutions, options, progress)?;
    let mut found: Vec<(ShellSymmetry, SymmetryKind)> = Vec::new();
    for generator in generators {
        if found.len() == options.rotations {
            break;
        }
        let map = finish(shell, &target, &generator.candidate, progress)?;
        let is_identity = |partners: &[u32]| {
            mean_displacement(&shell.basis, &shell.surface.lumped_mass, partners) < DISTINCT
        };
        let order = powers(&map.images.partners, is_identity).map_or(0, |powers| powers.len() + 1);
        let is_known = found.iter().any(|(other, _)| {
            let others = powers(&other.images.partners, is_identity).unwrap_or_default();
            others.iter().any(|power| is_identity(&composed(&map.images.partners, power)))
        });
        if order == generator.order() && !is_known && map.judged.accepted(options.plausibility) {
            found.push((map, SymmetryKind::Rotation { order }));
        }
    }
    Ok(found)
}

/// One rotation of the samples for each cyclic group.
fn generators(
    shell: &PreparedShell,
    involutions: &[(ShellSymmetry, SymmetryKind)],
    options: &Options,
    progress: &Progress,
) -> Result<Vec<Generator>> {
    let samples = shell.samples.prefix(CANDIDATE_SAMPLES);
    let refiner = SampleRefiner::new(&samples);
    let eigenvalues = &shell.basis.eigenvalues;
    let scorer = Scorer::new(&shell.surface, &shell.basis, &refiner, Vec::new());
    progress.report("rotations", 0.92)?;
    let by_blocks = |order: usize| -> Vec<Mat<f64>> {
        let lengths = LENGTHS.map(|length| length.min(samples.rows.ncols()));
        let found = search(&samples, eigenvalues, Sought::Rotations(order), &lengths, options.beam_width);
        let few = |starts: Vec<Mat<f64>>| {
            starts.into_iter().filter(|start| mean_trace(start) < 1.0).take(PROPOSALS)
        };
        found.into_iter().flat_map(few).collect()
    };
    let mut starts: Vec<Mat<f64>> =
        threads::map(options.threads, SEARCHED_ORDERS.to_vec(), by_blocks).into_iter().flatten().collect();
    starts.extend(rotations_of_three(eigenvalues));
    let (seen, token) = (Mutex::default(), progress.token());
    let tried = threads::map(options.threads, starts, |start| {
        token.check()?;
        try_start(&refiner, &scorer, &start, Projection::Orthogonal, &seen)
    });
    let tried: Vec<Option<Candidate>> = tried.into_iter().collect::<Result<_>>()?;
    let mut tried: Vec<Candidate> =
        tried.into_iter().flatten().filter(|candidate| keeps_orientation(&candidate.score)).collect();
    let isometry = |candidate: &Candidate| candidate.score.isometry();
    tried.sort_by(|a, b| isometry(a).total_cmp(&isometry(b)).then_with(|| a.partners.cmp(&b.partners)));
    let rows = spread_rows(&samples, eigenvalues);
    let best = involutions.iter().map(|(map, _)| map.score.isometry()).fold(f64::INFINITY, f64::min);
    let mut groups = Groups { rows, best, found: Vec::new() };
    for candidate in tried {
        groups.add(candidate);
    }
    let partners = |(map, kind): &(ShellSymmetry, SymmetryKind)| {
        let size = CANDIDATE_SIZE.min(map.map.nrows());
        let partners = refiner.partners(&map.map.submatrix(0, 0, size, size).to_owned());
        Element { inverse: partners.clone(), partners, reverses: *kind == SymmetryKind::Reflection }
    };
    groups.complete(&refiner, &scorer, involutions.iter().map(partners).collect(), progress)?;
    let Groups { mut found, best, .. } = groups;
    found.retain(|generator| isometry(&generator.candidate) < best + GAP);
    found.sort_by(|a, b| {
        let scores = isometry(&a.candidate).total_cmp(&isometry(&b.candidate));
        b.order().cmp(&a.order()).then(scores)
    });
    Ok(found)
}

fn keeps_orientation(score: &Score) -> bool {
    score.kind() == Some(SymmetryKind::HalfTurn)
}

/// A symmetry of the samples that may be composed with others.
struct Element {
    partners: Vec<u32>,
    inverse: Vec<u32>,
    reverses: bool,
}

/// The cyclic groups of what was found so far.
struct Groups {
    /// The samples in the embedding in which maps are compared.
    rows: Vec<[f64; SPREAD_COORDINATES]>,
    /// [`Score::isometry`] of the best symmetry of any kind.
    best: f64,
    found: Vec<Generator>,
}

impl Groups {
    fn is_same(&self, first: &[u32], second: &[u32]) -> bool {
        mean_distance(&self.rows, first, second) < DISTINCT
    }

    fn is_identity(&self, partners: &[u32]) -> bool {
        let identity: Vec<u32> = (0..partners.len() as u32).collect();
        self.is_same(partners, &identity)
    }

    /// Whether some group holds the map.
    fn is_known(&self, partners: &[u32]) -> bool {
        self.found.iter().any(|known| known.powers.iter().any(|power| self.is_same(power, partners)))
    }

    /// The powers of a map that is a rotation of order three or more.
    fn powers(&self, partners: &[u32]) -> Option<Vec<Vec<u32>>> {
        powers(partners, |power| self.is_identity(power)).filter(|powers| powers.len() > 1)
    }

    /// Adds a rotation that no group holds, instead of the groups that its own one holds; returns whether it did.
    fn add(&mut self, candidate: Candidate) -> bool {
        let isometry = candidate.score.isometry();
        if isometry >= self.best + GAP || self.is_known(&candidate.partners) {
            return false;
        }
        let Some(powers) = self.powers(&candidate.partners) else { return false };
        let mut found = std::mem::take(&mut self.found);
        found.retain(|known| !powers.iter().any(|power| self.is_same(power, &known.candidate.partners)));
        found.push(Generator { candidate, powers });
        (self.found, self.best) = (found, self.best.min(isometry));
        true
    }

    /// Adds the rotations that follow from what was found and from the `elements`.
    fn complete(
        &mut self,
        refiner: &SampleRefiner,
        scorer: &Scorer,
        mut elements: Vec<Element>,
        progress: &Progress,
    ) -> Result<()> {
        let of_generator = |generator: &Generator| Element {
            partners: generator.powers[0].clone(),
            inverse: generator.powers[generator.powers.len() - 1].clone(),
            reverses: false,
        };
        elements.extend(self.found.iter().map(of_generator));
        let size = CANDIDATE_SIZE.min(refiner.samples.rows.ncols());
        let mut tried: Vec<Vec<u32>> = Vec::new();
        let mut later = 1;
        while later < elements.len().min(MOST_COMPOSED) {
            for earlier in 0..later {
                progress.check()?;
                for partners in words(&elements[earlier], &elements[later]) {
                    let is_new = !self.is_known(&partners) && self.powers(&partners).is_some();
                    if !is_new || tried.iter().any(|other| self.is_same(other, &partners)) {
                        continue;
                    }
                    let start = refiner.estimate(&partners, size, Projection::Orthogonal)?;
                    let map = refiner.refine(start, &[size; ROUNDS], Projection::Orthogonal)?;
                    tried.push(partners);
                    let partners = refiner.partners(&map);
                    let score = scorer.score_of(&map, &partners)?;
                    let candidate = Candidate { map, partners, score, doubts: Vec::new() };
                    if keeps_orientation(&score) && !score.is_identity() && self.add(candidate) {
                        elements.extend(self.found.last().map(of_generator));
                    }
                }
            }
            later += 1;
        }
        Ok(())
    }
}

/// The products of two symmetries, and their conjugates, that keep orientation.
fn words(a: &Element, b: &Element) -> Vec<Vec<u32>> {
    let conjugate = |by: &Element, of: &Element| {
        (!of.reverses).then(|| composed(&composed(&by.inverse, &of.partners), &by.partners))
    };
    let mut words: Vec<Vec<u32>> = [conjugate(a, b), conjugate(b, a)].into_iter().flatten().collect();
    if a.reverses == b.reverses {
        words.extend([composed(&a.partners, &b.partners), composed(&a.partners, &b.inverse)]);
        words.push(composed(&b.partners, &a.partners));
    }
    words
}

/// The powers of a map below the identity, the map first; `None` if none up to the largest order is the identity, or the map
/// is.
fn powers(partners: &[u32], is_identity: impl Fn(&[u32]) -> bool) -> Option<Vec<Vec<u32>>> {
    let mut powers = vec![partners.to_vec()];
    while powers.len() < LARGEST_ORDER {
        let next = composed(&powers[powers.len() - 1], partners);
        if is_identity(&next) {
            return (!is_identity(partners)).then_some(powers);
        }
        powers.push(next);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of a regular polygon, turned by some of them.
    fn turned(corners: u32, by: u32) -> Vec<u32> {
        (0..corners).map(|corner| (corner + by) % corners).collect()
    }

    fn is_identity(partners: &[u32]) -> bool {
        (0..).zip(partners).all(|(own, &partner)| own == partner)
    }

    #[test]
    fn the_order_is_the_first_power_that_is_the_identity() {
        for (corners, by, order) in [(3, 1, 3), (4, 1, 4), (4, 2, 2), (6, 2, 3), (12, 5, 12)] {
            let powers = powers(&turned(corners, by), is_identity).expect("a rotation");
            assert_eq!(powers.len() + 1, order, "{corners} corners by {by}");
            assert!(is_identity(&composed(&powers[order - 2], &powers[0])), "the last is the inverse");
        }
        assert!(powers(&turned(13, 1), is_identity).is_none());
        assert!(powers(&turned(5, 0), is_identity).is_none());
    }

    #[test]
    fn two_reflections_make_a_rotation_and_none_is_made_of_a_reflection_and_a_half_turn() {
        let element = |partners: Vec<u32>, reverses| Element { inverse: partners.clone(), partners, reverses };
        let (upright, diagonal) =
            (element(vec![1, 0, 3, 2], true), element(vec![0, 3, 2, 1], true));
        assert_eq!(words(&upright, &diagonal), [turned(4, 3), turned(4, 3), turned(4, 1)]);
        let half_turn = element(turned(4, 2), false);
        assert_eq!(words(&upright, &half_turn), [turned(4, 2)]);
    }
}
