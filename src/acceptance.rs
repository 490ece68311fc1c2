//! Whether a finished map is a symmetry at all: "none" is an answer too.
//!
//! A logistic model of three measures of the map that need no truth. The weights are fitted on generated shapes
//! with and without a symmetry (`docs/method.md`).

use crate::candidate_score::Score;

/// Weights of the logistic model: constant, then those of [`Judgement::features`].
const WEIGHTS: [f64; 4] = [-13.5421, -2.4085, -6.4959, 4.5748];

/// What a finished map was judged by, and the verdict.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Judgement {
    /// [`Score::isometry`] of the candidate that was finished: lower is better.
    pub isometry_score: f64,
    /// Mean difference of the heat kernel signatures of partners: 0 for an isometry.
    pub signature_mismatch: f64,
    /// [`crate::displacement::mean_displacement`] of the finished map: 0 for the identity.
    pub displacement: f64,
    /// Probability, 0..=1, that a map of these measures is a symmetry, where two of five shapes have one.
    pub plausibility: f64,
}

impl Judgement {
    /// Judges a map by the score of its candidate, the mismatch of the coarse map and the displacement of the finished
    /// one.
    pub fn new(score: &Score, signature_mismatch: f64, displacement: f64) -> Judgement {
        let isometry_score = score.isometry();
        let mut judged = Judgement { isometry_score, signature_mismatch, displacement, plausibility: 0.0 };
        let terms = judged.features().into_iter().zip(&WEIGHTS[1..]);
        let logit = WEIGHTS[0] + terms.map(|(feature, weight)| feature * weight).sum::<f64>();
        judged.plausibility = 1.0 / (1.0 + (-logit).exp());
        judged
    }

    /// The columns of the logistic model.
    fn features(&self) -> [f64; WEIGHTS.len() - 1] {
        let (mismatch, displacement) = (self.signature_mismatch + 0.002, self.displacement + 0.05);
        [self.isometry_score, mismatch.ln(), displacement.ln()]
    }

    /// Whether the map counts as a symmetry for who asks for at least `percent` of plausibility.
    pub fn accepted(&self, percent: usize) -> bool {
        100.0 * self.plausibility >= percent as f64
    }
}
