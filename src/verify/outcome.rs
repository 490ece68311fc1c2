//! What is answered about a mesh: that it has a symmetry, that a map is doubtful, or that there is none.

/// A map of at least this share of the plausibility that is asked for is given as doubtful; one of less is not given at all: of the shapes that the verdict is
/// fitted to 4 % of the right maps are not then, and 85 % of those of shapes without a symmetry.
const GIVEN: f64 = 0.2;
/// A map of less mean confidence over the surface is doubtful, however plausible it is.
pub const CONFIDENT: f64 = 0.5;
/// One whose plausibility times its mean confidence is less than this share of the plausibility that is asked for is doubtful, too: on development shapes 3 of 185 right
/// maps, and 5 of 12 asymmetric shapes of 500 that are plausible enough (`docs/results.md`).
const WORTH: f64 = 0.9;
/// The same of a map that leaves more than this share of the surface without a partner.
pub const ALONE: f64 = 0.5;

/// What was found, the best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// At least one symmetry.
    Found,
    /// A map is given, but the report says what speaks against it.
    Doubtful,
    /// No map came near to a symmetry; the report holds the evidence.
    None,
}

/// The outcome of a best map of this `plausibility`, `mean_confidence` and share of the surface that has a partner, each 0..=1, for whoever asks for
/// `asked` percent of plausibility.
pub fn outcome(plausibility: f64, asked: usize, mean_confidence: f64, paired_share: f64) -> Outcome {
    let needed = asked as f64;
    let is_weak = mean_confidence < CONFIDENT
        || 100.0 * plausibility * mean_confidence < WORTH * needed
        || 1.0 - paired_share > ALONE;
    match 100.0 * plausibility {
        percent if percent < GIVEN * needed => Outcome::None,
        percent if percent < needed || is_weak => Outcome::Doubtful,
        _ => Outcome::Found,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plausibility_tells_found_from_doubtful_and_from_none() {
        let of = |plausibility| outcome(plausibility, 50, 0.9, 1.0);
        assert_eq!([of(0.5), of(0.49), of(0.1), of(0.09)].map(|outcome| outcome as usize), [0, 1, 1, 2]);
    }

    #[test]
    fn a_map_without_confidence_is_doubtful_at_best() {
        assert_eq!(outcome(0.97, 50, 0.49, 1.0), Outcome::Doubtful);
        assert_eq!(outcome(0.04, 50, 0.49, 1.0), Outcome::None);
        assert_eq!(outcome(0.97, 50, 0.5, 1.0), Outcome::Found);
        assert_eq!(
            [0.88, 0.9].map(|confidence| outcome(0.5, 50, confidence, 1.0)),
            [Outcome::Doubtful, Outcome::Found]
        );
    }

    #[test]
    fn whoever_takes_any_map_is_told_of_its_confidence_alone() {
        assert_eq!(outcome(0.0, 0, 0.9, 1.0), Outcome::Found);
        assert_eq!(outcome(0.0, 0, 0.1, 1.0), Outcome::Doubtful);
    }

    #[test]
    fn a_map_that_leaves_most_of_the_surface_alone_is_doubtful() {
        assert_eq!(outcome(1.0, 50, 0.9, 0.49), Outcome::Doubtful);
        assert_eq!(outcome(1.0, 50, 0.9, 0.5), Outcome::Found);
    }
}
