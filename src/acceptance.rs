//! Whether a finished map is a symmetry at all: "none" is an answer too.
//!
//! A logistic model of three measures of the map that need no truth, and of a fourth once its rigid parts are fitted. The weights are
//! fitted on generated shapes with and without a symmetry (`docs/method.md`).

use crate::candidate_score::Score;

/// Weights of the logistic model: constant, then those of [`Judgement::features`].
const WEIGHTS: [f64; 4] = [-13.5421, -2.4085, -6.4959, 4.5748];
/// The same once rigid parts are fitted.
const WEIGHTS_WITH_PARTS: [f64; 5] = [-28.7525, -1.7797, -5.1894, 5.0455, -4.3087];

/// What a finished map was judged by, and the verdict.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Judgement {
    /// [`Score::isometry`] of the candidate that was finished: lower is better.
    pub isometry_score: f64,
    /// Mean difference of the heat kernel signatures of partners: 0 for an isometry.
    pub signature_mismatch: f64,
    /// [`crate::displacement::mean_displacement`] of the finished map: 0 for the identity.
    pub displacement: f64,
    /// [`crate::rigid_parts::Fitted::disagreement`]: 0 if the map is a rigid motion almost everywhere; `None` where no parts are
    /// fitted.
    pub disagreement: Option<f64>,
    /// Probability, 0..=1, that a map of these measures is a symmetry, where two of five shapes have one.
    pub plausibility: f64,
}

impl Judgement {
    /// Judges a map by the score of its candidate, the mismatch of the coarse map and the displacement of the finished
    /// one.
    pub fn new(score: &Score, signature_mismatch: f64, displacement: f64) -> Judgement {
        let isometry_score = score.isometry();
        let unjudged = Judgement {
            isometry_score,
            signature_mismatch,
            displacement,
            disagreement: None,
            plausibility: 0.0,
        };
        let plausibility = probability(&WEIGHTS, &unjudged.features());
        Judgement { plausibility, ..unjudged }
    }

    /// Judges the map anew by what its rigid parts say, too, if any were fitted.
    pub fn with_disagreement(self, disagreement: Option<f64>) -> Judgement {
        let Some(apart) = disagreement else { return self };
        let [score, mismatch, displacement] = self.features();
        let features = [score, mismatch, displacement, (apart + 0.0005).ln()];
        Judgement { disagreement, plausibility: probability(&WEIGHTS_WITH_PARTS, &features), ..self }
    }

    /// The columns of the model without rigid parts.
    fn features(&self) -> [f64; WEIGHTS.len() - 1] {
        let (mismatch, displacement) = (self.signature_mismatch + 0.002, self.displacement + 0.05);
        [self.isometry_score, mismatch.ln(), displacement.ln()]
    }

    /// Whether the map counts as a symmetry for who asks for at least `percent` of plausibility.
    pub fn accepted(&self, percent: usize) -> bool {
        100.0 * self.plausibility >= percent as f64
    }
}

/// That of the logistic model: `weights` are the constant's, then those of the features.
fn probability(weights: &[f64], features: &[f64]) -> f64 {
    let terms = features.iter().zip(&weights[1..]);
    let logit = weights[0] + terms.map(|(feature, weight)| feature * weight).sum::<f64>();
    1.0 / (1.0 + (-logit).exp())
}
