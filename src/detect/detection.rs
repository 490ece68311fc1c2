//! What a detection gives: outcome, symmetries, and the numbers behind them.

use crate::detect::correspondence::Symmetry;
use crate::detect::judging_mesh::JudgingMesh;
use crate::detect::shell_symmetry::PreparedShell;
use crate::mesh::{Mesh, RepairReport};
use crate::search::sign_network::SignPrediction;
use crate::spectral::continuous_family::Orbits;
use crate::verify::acceptance::{Judgement, TWINS};
use crate::verify::outcome::{ALONE, Outcome, outcome};
use crate::verify::reason::{Reason, in_words};
use std::sync::Arc;

/// Numbers behind the outcome.
#[derive(Debug, Clone, serde::Serialize)]
#[non_exhaustive]
pub struct Report {
    /// Vertices of the caller's mesh.
    pub vertices: usize,
    /// Faces of the caller's mesh.
    pub faces: usize,
    /// Shells (connected components).
    pub shells: usize,
    /// Small holes of the largest shell, or of the joined ones, that were filled for the search; nothing of them is in the result.
    pub filled_holes: usize,
    /// Vertices on which the map was sought: those of the largest shell, or of the joined ones, and of what fills their holes, or of the proxy.
    pub solved_vertices: usize,
    /// What was repaired.
    pub repairs: RepairReport,
    /// Eigenvalues of the largest shell, or of the joined ones, holes filled, scaled to unit area, the constant function's zero left out.
    pub eigenvalues: Vec<f64>,
    /// Parity of the first eigenfunctions of the largest shell, its holes filled, or its proxy as the sign network sees it, overruled by what the caller
    /// states; empty without both.
    pub signs: Vec<SignPrediction>,
    /// How the best finished map was judged, accepted or not; `None` if no candidate reverses orientation.
    pub judged: Option<Judgement>,
    /// Whether the largest shell, or the joined ones, have infinitely many symmetries, as a sphere, a torus or a vase has: the one given is
    /// then an arbitrary one of them.
    pub continuous_family: bool,
    /// What that is judged by: 0 for such a shell, large for others (`docs/method.md`); `None` if it cannot be oriented.
    pub least_signature_gradient: Option<f64>,
    /// Whether the symmetries are those of an earlier shape, kept by [`crate::detect_again`].
    pub kept: bool,
    /// Why the outcome is what it is.
    pub reasons: Vec<Reason>,
    /// Seconds of wall time by stage, in order.
    pub seconds: Vec<(String, f64)>,
}

impl Report {
    /// Of a mesh on which nothing was sought yet.
    pub(crate) fn of(mesh: &Mesh) -> Report {
        Report {
            vertices: mesh.point_of_vertex.len(),
            faces: mesh.face_count,
            shells: mesh.shell_count,
            filled_holes: 0,
            solved_vertices: 0,
            repairs: mesh.repairs.clone(),
            eigenvalues: Vec::new(),
            signs: Vec::new(),
            judged: None,
            continuous_family: false,
            least_signature_gradient: None,
            kept: false,
            reasons: Vec::new(),
            seconds: Vec::new(),
        }
    }

    /// The reasons in words: one sentence.
    pub fn evidence(&self) -> String {
        in_words(&self.reasons)
    }

    /// Enters what was seen of the shell on which maps were sought.
    pub(crate) fn with_shell(self, shell: &PreparedShell, orbits: &Orbits) -> Report {
        Report {
            solved_vertices: shell.surface.vertex_count(),
            eigenvalues: shell.basis.eigenvalues.clone(),
            continuous_family: orbits.continuous,
            least_signature_gradient: orbits.least_gradient,
            ..self
        }
    }
}

/// The outcome, the symmetries found (empty if none) and the evidence.
#[derive(Debug, Clone, serde::Serialize)]
#[non_exhaustive]
pub struct Detection {
    /// Found, doubtful or none: that of the first symmetry.
    pub outcome: Outcome,
    /// At most `options.symmetries`: reflections, the most plausible first, then half turns likewise; reflections that exchange the sides of a thin sheet come behind those
    /// of a plausibility of 0.5 or more.
    pub symmetries: Vec<Symmetry>,
    /// Numbers behind the outcome.
    pub report: Report,
    /// What [`crate::detect_again`] needs of the connectivity; `None` where that is not known yet.
    #[serde(skip)]
    pub judging: Option<Arc<JudgingMesh>>,
}

/// An answer of at least this [`Detection::worth`] leaves no doubts: seven of ten right maps of generated shapes.
const SETTLED: f64 = 0.7;
/// Part of the implausibility that is left where a part without a counterpart is found.
const DOUBTS_LEFT: f64 = 0.7;
/// Least mean confidence of a map for which only likely twins speak.
const BY_TWINS: f64 = 0.35;
/// Least mean confidence of a symmetry, and of one that leaves most vertices without a partner.
const LEAST_CONFIDENCE: f64 = 0.01;
const LEAST_CONFIDENCE_OF_FEW: f64 = 0.05;

impl Detection {
    /// The answer that some `symmetries` are, the best first, for whoever asks for `asked` percent of plausibility.
    pub(crate) fn new(symmetries: Vec<Symmetry>, asked: usize, mut report: Report) -> Detection {
        let outcome = symmetries.first().map_or(Outcome::None, |best| {
            outcome(best.plausibility, asked, best.mean_confidence, best.coverage.paired_share)
        });
        if let Some(best) = symmetries.first().filter(|_| outcome == Outcome::Doubtful) {
            report.reasons.push(doubt_about(best, asked));
        }
        Detection { outcome, symmetries, report, judging: None }
    }

    /// Of a `symmetry` that the caller kept: it is not judged.
    pub fn restored(mesh: &Mesh, symmetry: Symmetry) -> Detection {
        let report = Report { reasons: vec![Reason::Restored], ..Report::of(mesh) };
        Detection { outcome: Outcome::Found, symmetries: vec![symmetry], report, judging: None }
    }

    /// The same where time ended what could remove its doubts.
    pub(crate) fn out_of_time(mut self) -> Detection {
        self.outcome = self.outcome.max(Outcome::Doubtful);
        if !self.is_out_of_time() {
            self.report.reasons.push(Reason::TimeLimit);
        }
        self
    }

    /// Whether time ended the search.
    pub(crate) fn is_out_of_time(&self) -> bool {
        self.report.reasons.contains(&Reason::TimeLimit)
    }

    /// Whether no larger plan needs to be followed.
    pub(crate) fn is_settled(&self) -> bool {
        self.outcome == Outcome::Found
            && self.worth() >= SETTLED
            && self.report.judged.is_none_or(|judged| judged.is_clear())
    }

    /// Whether a larger plan would find nothing either.
    pub(crate) fn is_hopeless(&self) -> bool {
        self.outcome == Outcome::None
    }

    /// That of the first symmetry; 0 without one.
    pub(crate) fn plausibility(&self) -> f64 {
        self.symmetries.first().map_or(0.0, |best| best.plausibility)
    }

    /// How much of the surface is answered, and how surely.
    pub(crate) fn worth(&self) -> f64 {
        self.symmetries.first().map_or(0.0, |best| best.plausibility * best.mean_confidence)
    }

    /// Whether this answer has a better outcome than an earlier one, or the same one and is worth more, and gives partners to no less of the surface.
    pub(crate) fn is_worth_more(&self, earlier: &Detection) -> bool {
        let share = |of: &Detection| of.symmetries.first().map_or(0.0, |best| best.coverage.paired_share);
        share(self) >= share(earlier) && (self.outcome, -self.worth()) < (earlier.outcome, -earlier.worth())
    }

    /// Whether a map of joined shells rests on more than likely twins, or is sure of these: a soup of triangles has twins by chance.
    pub(crate) fn is_no_chance(&self) -> bool {
        self.symmetries
            .first()
            .is_some_and(|best| best.plausibility > TWINS || best.mean_confidence >= BY_TWINS)
    }

    /// Whether this answer, of a part of the surface, makes so much less doubtful what another one says of more.
    pub(crate) fn is_much_more_plausible(&self, whole: &Detection) -> bool {
        1.0 - self.plausibility() < DOUBTS_LEFT * (1.0 - whole.plausibility())
    }

    /// The same with the reason that it is of a rest of the searched shell, so large a share.
    pub(crate) fn of_rest(mut self, share: f64) -> Detection {
        self.report.reasons.push(Reason::OfRest { share });
        self.judging = None;
        self
    }

    /// Whether this answer, by a larger plan, takes the place of an earlier one.
    pub(crate) fn is_better(&self, earlier: &Detection) -> bool {
        (self.outcome, -self.plausibility()) <= (earlier.outcome, -earlier.plausibility())
    }

    /// None if the first symmetry says nothing of nearly the whole surface, as that of one of ten thousand loose parts does, unless whoever
    /// asks takes any map: a plausibility from `least` percent on. Later ones that say nothing are left out.
    pub(crate) fn without_empty(mut self, least: usize) -> Detection {
        if least == 0 {
            return self;
        }
        if let Some(first) = self.symmetries.first().filter(|first| is_empty(first)) {
            self.report.reasons.push(Reason::NothingSaid { mean_confidence: first.mean_confidence });
            return Detection { outcome: Outcome::None, symmetries: Vec::new(), judging: None, ..self };
        }
        self.symmetries.retain(|symmetry| !is_empty(symmetry));
        self
    }
}

fn is_empty(symmetry: &Symmetry) -> bool {
    let paired = symmetry.partner.iter().filter(|&&partner| partner >= 0).count();
    let are_few = 2 * paired < symmetry.partner.len();
    symmetry.mean_confidence < if are_few { LEAST_CONFIDENCE_OF_FEW } else { LEAST_CONFIDENCE }
}

/// What makes a symmetry doubtful for whoever asks for `asked` percent of plausibility.
fn doubt_about(best: &Symmetry, asked: usize) -> Reason {
    if 100.0 * best.plausibility < asked as f64 {
        Reason::LowPlausibility
    } else if best.coverage.paired_share < 1.0 - ALONE {
        Reason::FewPartners { share: best.coverage.paired_share }
    } else {
        Reason::LowConfidence { mean: best.mean_confidence }
    }
}
