//! EXPERIMENTAL: rotations of order three or more, maps R that keep orientation and whose n-th power is the identity.
//!
//! They are not their own inverses, so no map is projected to an involution here, only to an orthogonal matrix. Starts come
//! from the search by blocks ([`crate::search::parity_search`]), from the space of the three lowest eigenfunctions where these
//! coincide, and from the symmetries that were found before: two reflections whose axes meet at an angle make a rotation
//! by twice that angle. A rotation, its powers and its inverse are one cyclic group, of which one is kept.
//!
//! To 30 eigenfunctions a prism is nearly a surface of revolution, which turns by any angle. So the order is that of the
//! finished map, which curvature has drawn to the edges.

use crate::base::effort::Plan;
use crate::base::error::Result;
use crate::base::options::Options;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::base::threads;
use crate::detect::shell_symmetry::{PreparedShell, finish};
use crate::refine::full_refinement::MatchTarget;
use crate::search::candidate_score::Scorer;
use crate::search::candidates::{CANDIDATE_SIZE, Candidate, DISTINCT, GAP, mean_distance, try_start};
use crate::search::compositions::{ROUNDS, composed};
use crate::search::functional_map::{Projection, mean_trace};
use crate::search::parity_search::{Sought, rotations_of_three, search};
use crate::search::refinement::SampleRefiner;
use crate::spectral::dense::product;
use crate::spectral::sampling::{SPREAD_COORDINATES, Samples, spread_rows};
use crate::verify::hypothesis::Hypothesis;
use faer::Mat;
use std::sync::Mutex;

/// Orders that are looked for: 3 to the largest.
const LARGEST_ORDER: usize = 12;
/// Lengths of the starts, and how many of each length and order are tried.
const LENGTHS: [usize; 2] = [6, 8];
const PROPOSALS: usize = 6;
/// Mean distance, in radii of the embedding, of some power of a candidate from the identity, from which finishing it is
/// hopeless.
const HOPELESS: f64 = 2.0 * DISTINCT;
/// A power is the identity if it moves the points by less than this share of what any lower one does: on a surface that is
/// nearly one of revolution some power of any turn comes near to the identity.
const RETURN: f64 = 0.25;
/// So many maps that were finished in vain in a row end the search; and it finds no more than so many, beside two for each
/// rotation that is asked for.
const IN_VAIN: usize = 8;
/// Symmetries that are composed with each other, at most.
const MOST_COMPOSED: usize = 40;

/// Finds up to `options.rotations` rotations of order three or more that count as symmetries: one of each cyclic group, those
/// of highest order first, then the best.
///
/// `involutions` are the symmetries found before. A shell that cannot be oriented gets none.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn find(
    shell: &PreparedShell,
    target: &MatchTarget,
    involutions: &[(Hypothesis, SymmetryKind)],
    plan: &Plan,
    options: &Options,
    progress: &Progress,
) -> Result<Vec<(Hypothesis, SymmetryKind)>> {
    progress.report("rotations", 0.92)?;
    let refiner = &shell.refiner;
    let scorer = shell.scorer(Vec::new());
    let everywhere = Samples::at(&shell.basis, (0..shell.surface.vertex_count() as u32).collect());
    let best = involutions.iter().map(|(map, _)| map.score.isometry()).fold(f64::INFINITY, f64::min);
    let mut groups = Groups {
        shell,
        target: target.with_projection(Projection::Orthogonal),
        refiner,
        scorer: &scorer,
        plan,
        options,
        progress,
        rows: spread_rows(&everywhere, &shell.basis.eigenvalues),
        best,
        found: Vec::new(),
        refused: Vec::new(),
        in_vain: 0,
    };
    for candidate in groups.search()? {
        groups.consider(candidate)?;
    }
    groups.compose(involutions)?;
    let mut found = groups.found;
    found.sort_by(|a, b| b.order().cmp(&a.order()).then(a.map.score.total().total_cmp(&b.map.score.total())));
    found.truncate(options.rotations);
    let with_kind = |rotation: Rotation| {
        let kind = SymmetryKind::Rotation { order: rotation.order() };
        (rotation.map, kind)
    };
    Ok(found.into_iter().map(with_kind).collect())
}

/// A finished rotation, which stands for its cyclic group.
struct Rotation {
    map: Hypothesis,
    /// Images of all vertices under its powers below the identity: itself first, its inverse last.
    powers: Vec<Vec<u32>>,
}

impl Rotation {
    fn order(&self) -> usize {
        self.powers.len() + 1
    }
}

/// The search for the cyclic groups of one shell.
struct Groups<'a> {
    shell: &'a PreparedShell,
    target: MatchTarget<'a>,
    /// Of the samples on which candidates are refined.
    refiner: &'a SampleRefiner,
    scorer: &'a Scorer<'a>,
    plan: &'a Plan,
    options: &'a Options,
    progress: &'a Progress<'a>,
    /// The vertices in the embedding in which maps are compared.
    rows: Vec<[f64; SPREAD_COORDINATES]>,
    /// Score of the best symmetry of any kind.
    best: f64,
    found: Vec<Rotation>,
    /// Images of the samples under the candidates that were finished in vain.
    refused: Vec<Vec<u32>>,
    /// How many of them since the last one that was found.
    in_vain: usize,
}

impl Groups<'_> {
    /// Candidates from starts, the best first.
    fn search(&self) -> Result<Vec<Candidate>> {
        let (samples, eigenvalues) = (&self.refiner.samples, &self.shell.basis.eigenvalues);
        let lengths = LENGTHS.map(|length| length.min(samples.rows.ncols()));
        let of_order = |order: usize| -> Vec<Mat<f64>> {
            let width = self.plan.search.beam_width;
            let found = search(samples, eigenvalues, Sought::Rotations(order), &lengths, width);
            let generators = |starts: Vec<Mat<f64>>| {
                starts.into_iter().filter(|start| is_generator(start, order)).take(PROPOSALS)
            };
            found.into_iter().flat_map(generators).collect()
        };
        let orders = (3..=LARGEST_ORDER).collect();
        let mut starts = threads::map(self.options.threads, orders, of_order).concat();
        starts.extend(rotations_of_three(eigenvalues));
        let (seen, token) = (Mutex::default(), self.progress.token());
        let tried = threads::map(self.options.threads, starts, |start| {
            token.check()?;
            try_start(self.refiner, self.scorer, &start, Projection::Orthogonal, &seen)
        });
        let tried: Vec<Option<Candidate>> = tried.into_iter().collect::<Result<_>>()?;
        let mut candidates: Vec<Candidate> = tried.into_iter().flatten().collect();
        candidates.sort_by(|a, b| {
            let scores = a.score.isometry().total_cmp(&b.score.isometry());
            scores.then_with(|| a.partners.cmp(&b.partners))
        });
        Ok(candidates)
    }

    /// Finishes what may be a rotation that no group holds, and adds it if it is one, instead of the groups that its own one
    /// holds; returns whether it did.
    fn consider(&mut self, candidate: Candidate) -> Result<bool> {
        let images = self.images(&candidate.partners);
        let may_be = candidate.score.is_of(SymmetryKind::HalfTurn)
            && !candidate.score.is_identity()
            && candidate.score.isometry() < self.best + GAP
            && self.in_vain < IN_VAIN
            && self.found.len() < IN_VAIN + 2 * self.options.rotations
            && !self.is_known(&images)
            && self.is_nearly_cyclic(&candidate.partners);
        if !may_be {
            return Ok(false);
        }
        let map = finish(self.shell, &self.target, &candidate, self.plan, 0, self.progress)?;
        let identity: Vec<u32> = (0..self.rows.len() as u32).collect();
        let powers = powers(&map.images.partners, |power| mean_distance(&self.rows, &identity, power));
        let of_samples = |images: &[u32]| self.at_samples(images);
        match powers.filter(|powers| powers.len() > 1 && map.judged.accepted(self.options.plausibility)) {
            Some(powers) if !self.is_known(&of_samples(&powers[0])) => {
                let own: Vec<Vec<u32>> = powers.iter().map(|power| of_samples(power)).collect();
                let mut found = std::mem::take(&mut self.found);
                found.retain(|other| {
                    let other = self.at_samples(&other.powers[0]);
                    !own.iter().any(|power| self.is_same(power, &other))
                });
                found.push(Rotation { map, powers });
                (self.found, self.best) = (found, self.best.min(candidate.score.isometry()));
                self.in_vain = 0;
                Ok(true)
            }
            _ => {
                self.refused.push(images);
                self.in_vain += 1;
                Ok(false)
            }
        }
    }

    /// Considers what follows from the `involutions` and the rotations that were found: their products and conjugates.
    fn compose(&mut self, involutions: &[(Hypothesis, SymmetryKind)]) -> Result<()> {
        let size = CANDIDATE_SIZE.min(self.refiner.samples.rows.ncols());
        let leading = |map: &Hypothesis| map.map.submatrix(0, 0, size, size).to_owned();
        let of_involution = |(map, kind): &(Hypothesis, SymmetryKind)| Element {
            map: leading(map),
            reverses: *kind == SymmetryKind::Reflection,
        };
        let of_rotation = |rotation: &Rotation| Element { map: leading(&rotation.map), reverses: false };
        let mut elements: Vec<Element> = involutions.iter().map(of_involution).collect();
        elements.extend(self.found.iter().map(of_rotation));
        self.in_vain = 0;
        let mut later = 1;
        while later < elements.len().min(MOST_COMPOSED) {
            for earlier in 0..later {
                self.progress.check()?;
                for word in words(&elements[earlier], &elements[later]) {
                    let partners = self.refiner.partners(&word);
                    if self.is_known(&self.images(&partners)) || !self.is_nearly_cyclic(&partners) {
                        continue;
                    }
                    let map = self.refiner.refine(word, &[size; ROUNDS], Projection::Orthogonal)?;
                    let partners = self.refiner.partners(&map);
                    let score = self.scorer.score_of(&map, &partners)?;
                    if self.consider(Candidate { map, partners, score, doubts: Vec::new() })? {
                        elements.extend(self.found.last().map(of_rotation));
                    }
                }
            }
            later += 1;
        }
        Ok(())
    }

    /// The vertices to which candidates send the samples.
    fn images(&self, partners: &[u32]) -> Vec<u32> {
        partners.iter().map(|&partner| self.refiner.samples.vertices[partner as usize]).collect()
    }

    /// What all vertices' `images` are at the samples.
    fn at_samples(&self, images: &[u32]) -> Vec<u32> {
        self.refiner.samples.vertices.iter().map(|&vertex| images[vertex as usize]).collect()
    }

    fn is_same(&self, first: &[u32], second: &[u32]) -> bool {
        mean_distance(&self.rows, first, second) < DISTINCT
    }

    /// Whether some group holds the map with these images of the samples, or it was finished in vain.
    fn is_known(&self, images: &[u32]) -> bool {
        let found = self.found.iter().flat_map(|rotation| &rotation.powers);
        found.map(|power| self.at_samples(power)).any(|power| self.is_same(&power, images))
            || self.refused.iter().any(|refused| self.is_same(refused, images))
    }

    /// Whether a power of three or more comes back to the samples, or nearly so, and no lower one.
    fn is_nearly_cyclic(&self, partners: &[u32]) -> bool {
        let own = &self.refiner.samples.vertices;
        let distance = |power: &[u32]| mean_distance(&self.rows, own, &self.images(power));
        let next = |power: &Vec<u32>| Some(composed(power, partners));
        let distances = std::iter::successors(Some(partners.to_vec()), next).take(LARGEST_ORDER);
        let distances: Vec<f64> = distances.map(|power| distance(&power)).collect();
        distances[..2].iter().all(|distance| *distance > DISTINCT)
            && distances[2..].iter().any(|distance| *distance < HOPELESS)
    }
}

/// Whether the order of a start is `order` and no less, and its first pair that turns turns by less than 180 degrees: else
/// its inverse does.
fn is_generator(start: &Mat<f64>, order: usize) -> bool {
    let mut power = start.clone();
    for _ in 1..order {
        if mean_trace(&power) > 1.0 - 1e-5 {
            return false;
        }
        power = product(power.as_ref(), start.as_ref());
    }
    let first_turn = (1..start.nrows()).map(|j| start[(j - 1, j)]).find(|sine| sine.abs() > 1e-5);
    first_turn.is_some_and(|sine| sine > 0.0)
}

/// A symmetry that may be composed with others.
struct Element {
    /// Its functional map: the transpose is that of its inverse.
    map: Mat<f64>,
    reverses: bool,
}

/// The products of two symmetries, and their conjugates, that keep orientation.
fn words(a: &Element, b: &Element) -> Vec<Mat<f64>> {
    let (first, second) = (a.map.as_ref(), b.map.as_ref());
    let mut words = Vec::new();
    if !b.reverses {
        words.push(product(product(first.transpose(), second).as_ref(), first));
    }
    if !a.reverses {
        words.push(product(product(second.transpose(), first).as_ref(), second));
    }
    if a.reverses == b.reverses {
        words.extend([product(first, second), product(first, second.transpose())]);
    }
    words
}

/// The powers of a map below the identity, the map first; `None` if none up to the largest order comes back as it must, or the
/// map itself hardly moves anything. `distance` is how far a power moves the points, on average.
fn powers(partners: &[u32], distance: impl Fn(&[u32]) -> f64) -> Option<Vec<Vec<u32>>> {
    let mut powers = vec![partners.to_vec()];
    let mut least = distance(partners);
    while powers.len() < LARGEST_ORDER && least > DISTINCT {
        let next = composed(&powers[powers.len() - 1], partners);
        let left = distance(&next);
        if left < DISTINCT.min(RETURN * least) {
            return Some(powers);
        }
        least = least.min(left);
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

    /// Mean distance along a circle of radius about 1.
    fn distance(partners: &[u32]) -> f64 {
        let count = partners.len() as f64;
        let parts = |(own, &partner): (u32, &u32)| f64::from(own.abs_diff(partner)) / count;
        (0..).zip(partners).map(parts).map(|part| part.min(1.0 - part)).sum::<f64>() / count * 6.0
    }

    #[test]
    fn the_order_is_the_first_power_that_is_the_identity() {
        for (corners, by, order) in [(3, 1, 3), (4, 1, 4), (4, 2, 2), (6, 2, 3), (12, 5, 12)] {
            let powers = powers(&turned(corners, by), distance).expect("a rotation");
            assert_eq!(powers.len() + 1, order, "{corners} corners by {by}");
            assert_eq!(
                composed(&powers[order - 2], &powers[0]),
                turned(corners, 0),
                "the last is the inverse"
            );
        }
        assert!(powers(&turned(13, 1), distance).is_none());
        assert!(powers(&turned(5, 0), distance).is_none());
        // A turn by 2 of 7: the fourth power is off by a seventh of a circle, as near as the others' least.
        assert_eq!(powers(&turned(7, 2), distance).map(|powers| powers.len() + 1), Some(7));
    }

    /// A rotation of the plane by `parts` of twelve, or a reflection in the line at half that angle.
    fn of_plane(parts: f64, reverses: bool) -> Element {
        let (sine, cosine) = (std::f64::consts::TAU * parts / 12.0).sin_cos();
        let sign = if reverses { -1.0 } else { 1.0 };
        let rows = [[cosine, sine], [-sign * sine, sign * cosine]];
        Element { map: Mat::from_fn(2, 2, |i, j| rows[i][j]), reverses }
    }

    #[test]
    fn two_reflections_make_a_rotation_and_one_conjugates_another_s_rotation_to_its_inverse() {
        let is = |word: &Mat<f64>, parts: f64| (word - of_plane(parts, false).map).norm_max() < 1e-12;
        let words_of = words(&of_plane(0.0, true), &of_plane(3.0, true));
        assert!(words_of.len() == 2 && is(&words_of[0], 3.0) && is(&words_of[1], 3.0));
        let words_of = words(&of_plane(0.0, true), &of_plane(4.0, false));
        assert!(words_of.len() == 1 && is(&words_of[0], -4.0));
    }

    #[test]
    fn a_generator_has_its_whole_order_and_turns_first_by_less_than_half() {
        for (parts, order, expected) in [(1.0, 12, true), (2.0, 12, false), (2.0, 6, true), (10.0, 6, false)]
        {
            assert_eq!(is_generator(&of_plane(parts, false).map, order), expected, "{parts} of 12, {order}");
        }
    }
}
