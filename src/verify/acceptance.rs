//! Whether a finished map is a symmetry at all: "none" is an answer too.
//!
//! A logistic model of three measures of the map that need no truth; of two of them and two more once its rigid parts are fitted. The weights are
//! fitted on generated shapes with and without a symmetry (`docs/method.md`).

use crate::refine::rigid_parts::Rigidity;
use crate::search::candidate_score::Score;

/// Weights of the logistic model: constant, then those of [`Judgement::features`].
const WEIGHTS: [f64; 4] = [-14.2018, -2.3760, -5.8793, 3.9466];
/// The same for reflections once rigid parts are fitted: of the signature mismatch, the displacement, the parts' disagreement and the scatter.
const WEIGHTS_WITH_PARTS: [f64; 5] = [-5.9423, -10.7357, 3.5435, -2.5912, -45.8264];

/// A map as plausible as this leaves no doubts, if the orientation tells what it is at least so clearly: where legs go to themselves and not to their twins, it does not.
const SURE: f64 = 0.8;
const CLEAR: f64 = 0.6;

/// No map comes to count whose plausibility, by the three measures, is less than this share of what is asked (`docs/notebook/2026-11-25-method.md`).
const HOPELESS: f64 = 0.04;
/// Least plausibility of a map that takes likely twins to each other: these speak for it, so that it is doubtful at worst.
pub const TWINS: f64 = 0.1;

/// What a finished map was judged by, and the verdict.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Judgement {
    /// [`Score::isometry`] of the candidate that was finished: lower is better.
    pub isometry_score: f64,
    /// [`Score::orientation`] of it: -1 for a reflection, 1 for a half turn; 0 where the shell, or twins, tell the kind.
    pub orientation: f64,
    /// Mean difference of the heat kernel signatures of partners: 0 for an isometry.
    pub signature_mismatch: f64,
    /// Mean distance of vertices from their images in the finished map, as the eigenfunctions measure it: 0 for the identity; 1 where shells were joined.
    pub displacement: f64,
    /// How far apart overlapping rigid parts put a point of most of the surface at most, in sqrt(area); `None` where no parts are fitted, and for half turns.
    pub disagreement: Option<f64>,
    /// Share of the surface, 0..=1, that images leave empty beyond what is usual; `None` likewise.
    pub scatter: Option<f64>,
    /// Probability, 0..=1, that a map of these measures is a symmetry: of a reflection with its rigid parts where one of four shapes
    /// has one, of other maps where two of five have.
    pub plausibility: f64,
}

impl Judgement {
    /// Judges a map by the score of its candidate, the mismatch of the coarse map and the displacement of the finished
    /// one.
    pub fn new(score: &Score, signature_mismatch: f64, displacement: f64) -> Judgement {
        let isometry_score = score.isometry();
        let unjudged = Judgement {
            isometry_score,
            orientation: if score.by_twins { 0.0 } else { score.orientation },
            signature_mismatch,
            displacement,
            disagreement: None,
            scatter: None,
            plausibility: 0.0,
        };
        unjudged.by_three_measures()
    }

    /// Judges the map anew where its images have moved since.
    pub(crate) fn with_displacement(self, displacement: f64) -> Judgement {
        Judgement { displacement, ..self }.by_three_measures()
    }

    fn by_three_measures(self) -> Judgement {
        Judgement { plausibility: probability(&WEIGHTS, &self.features()), ..self }
    }

    /// Judges a reflection anew by what its rigid parts say, too, if any were fitted.
    pub fn with_parts(self, rigidity: Option<Rigidity>) -> Judgement {
        let Some(Rigidity { disagreement, scatter }) = rigidity else { return self };
        let [.., displacement] = self.features();
        let features = [self.signature_mismatch, displacement, (disagreement + 0.0005).ln(), scatter];
        Judgement {
            disagreement: Some(disagreement),
            scatter: Some(scatter),
            plausibility: probability(&WEIGHTS_WITH_PARTS, &features),
            ..self
        }
    }

    /// The same of a map with this score, for which likely twins may speak.
    pub(crate) fn by(self, score: &Score) -> Judgement {
        let least = if score.by_twins { TWINS } else { 0.0 };
        Judgement { plausibility: self.plausibility.max(least), ..self }
    }

    /// The columns of the model without rigid parts.
    fn features(&self) -> [f64; WEIGHTS.len() - 1] {
        let (mismatch, displacement) = (self.signature_mismatch + 0.002, self.displacement + 0.05);
        [self.isometry_score, mismatch.ln(), displacement.ln()]
    }

    /// Whether a map judged without its rigid parts is too far from counting, for who asks for at least `percent` of plausibility, to come
    /// to count when they are fitted.
    pub(crate) fn is_hopeless(&self, percent: usize) -> bool {
        100.0 * self.plausibility < HOPELESS * percent as f64
    }

    /// Whether the map leaves no doubts.
    pub(crate) fn is_sure(&self) -> bool {
        self.plausibility >= SURE && self.is_clear()
    }

    /// Whether the orientation tells clearly what the map is.
    pub(crate) fn is_clear(&self) -> bool {
        self.orientation == 0.0 || self.orientation.abs() >= CLEAR
    }

    /// Whether the map counts as a symmetry for who asks for at least `percent` of plausibility.
    pub fn accepted(&self, percent: usize) -> bool {
        100.0 * self.plausibility >= percent as f64
    }
}

/// That of the logistic model: `weights` are the constant's, then those of the features.
pub(super) fn probability(weights: &[f64], features: &[f64]) -> f64 {
    let terms = features.iter().zip(&weights[1..]);
    let logit = weights[0] + terms.map(|(feature, weight)| feature * weight).sum::<f64>();
    1.0 / (1.0 + (-logit).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCORE: Score = Score {
        commutator: 0.05,
        orientation: -1.0,
        fixed: 0.1,
        disagreement: 0.0,
        trace: 0.0,
        by_twins: false,
    };

    #[test]
    fn parts_that_agree_speak_for_a_reflection_and_others_against_it() {
        let judged = Judgement::new(&SCORE, 0.3, 0.7);
        let by_parts =
            |disagreement, scatter| judged.with_parts(Some(Rigidity { disagreement, scatter })).plausibility;
        assert!(by_parts(0.003, 0.01) > 0.9 && by_parts(0.05, 0.01) < 0.1);
        assert!(by_parts(0.003, 0.0) > 0.95 && by_parts(0.003, 0.04) < 0.95);
        assert_eq!(judged.with_parts(None), judged);
    }

    #[test]
    fn no_map_is_hopeless_for_who_takes_any() {
        let poor = Judgement::new(&SCORE, 1.5, 0.2);
        assert!(poor.is_hopeless(50) && !poor.is_hopeless(0), "{poor:?}");
        assert!(!Judgement::new(&SCORE, 0.3, 0.7).is_hopeless(50));
    }

    #[test]
    fn a_map_by_likely_twins_is_doubtful_at_worst() {
        let twins = Score { by_twins: true, ..SCORE };
        let [poor, good] =
            [(1.5, 0.2), (0.3, 0.7)].map(|(mismatch, moved)| Judgement::new(&SCORE, mismatch, moved));
        let by_twins = poor.by(&twins);
        assert!(by_twins.accepted(10) && !by_twins.accepted(11) && !by_twins.is_hopeless(50), "{by_twins:?}");
        assert_eq!([poor.by(&SCORE), good.by(&twins)], [poor, good]);
    }

    #[test]
    fn a_plausible_map_is_sure_where_its_orientation_is_clear_or_unknown_or_twins_tell_the_kind() {
        let is_sure = |orientation, by_twins| {
            let score = Score { orientation, by_twins, ..SCORE };
            Judgement { plausibility: 0.9, ..Judgement::new(&score, 0.3, 0.7) }.is_sure()
        };
        assert_eq!(
            [-0.61, 0.61, 0.0, -0.59, 0.59].map(|of| is_sure(of, false)),
            [true, true, true, false, false]
        );
        assert!(is_sure(-0.59, true));
    }

    #[test]
    fn a_map_that_comes_to_rest_is_none() {
        let judged = Judgement::new(&SCORE, 0.1, 0.7);
        assert!(judged.accepted(50) && !judged.with_displacement(0.01).accepted(50));
        assert_eq!(judged.with_displacement(0.7), judged);
    }
}
