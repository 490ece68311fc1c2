//! Whether a finished map is a symmetry at all: "none" is an answer too.
//!
//! A logistic model of two measures of the map that need no truth. The weights are fitted on generated shapes
//! with and without a symmetry (`docs/method.md`).

use crate::candidate_score::Score;

/// Weights of the logistic model: constant, ln(signature mismatch), isometry score.
const WEIGHTS: [f64; 3] = [-13.873, -4.776, -2.705];
/// Added before the logarithm.
const FLOOR: f64 = 0.002;

/// What a finished map was judged by, and the verdict.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Judgement {
    /// [`Score::isometry`] of the candidate that was finished: lower is better.
    pub isometry_score: f64,
    /// Mean difference of the heat kernel signatures of partners: 0 for an isometry.
    pub signature_mismatch: f64,
    /// Probability, 0..=1, that a map of these measures is a symmetry, where half of the shapes have one.
    pub plausibility: f64,
}

impl Judgement {
    /// Judges a map by the score of its candidate and the mismatch of the finished map.
    pub fn new(score: &Score, signature_mismatch: f64) -> Judgement {
        let isometry_score = score.isometry();
        let logit = WEIGHTS[0] + WEIGHTS[1] * (signature_mismatch + FLOOR).ln() + WEIGHTS[2] * isometry_score;
        Judgement { isometry_score, signature_mismatch, plausibility: 1.0 / (1.0 + (-logit).exp()) }
    }

    /// Whether the map counts as a symmetry for who asks for at least `percent` of plausibility.
    pub fn accepted(&self, percent: usize) -> bool {
        100.0 * self.plausibility >= percent as f64
    }
}
