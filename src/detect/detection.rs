//! What a detection gives: outcome, symmetries, the numbers behind them, and that in words.

use crate::detect::correspondence::Symmetry;
use crate::detect::judging_mesh::JudgingMesh;
use crate::detect::shell_symmetry::PreparedShell;
use crate::mesh::{Mesh, RepairReport};
use crate::search::sign_network::SignPrediction;
use crate::spectral::continuous_family::Orbits;
use crate::verify::acceptance::Judgement;
use crate::verify::hypothesis::Hypothesis;
pub use crate::verify::outcome::Outcome;
use crate::verify::outcome::{CONFIDENT, outcome};
use std::sync::Arc;
use std::time::Instant;

/// Numbers behind the outcome.
#[derive(Debug, Clone, serde::Serialize)]
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
    /// One sentence that says why the outcome is what it is.
    pub evidence: String,
    /// Seconds of wall time by stage, in order.
    pub seconds: Vec<(String, f64)>,
}

impl Report {
    /// Of a mesh on which nothing was sought yet.
    pub fn of(mesh: &Mesh) -> Report {
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
            evidence: String::new(),
            seconds: Vec::new(),
        }
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
pub struct Detection {
    /// Found, doubtful or none: that of the first symmetry.
    pub outcome: Outcome,
    /// At most `options.symmetries`: reflections, best first, then half turns, best first: those of a plausibility of 0.95 or more
    /// by their scores, then the others by their plausibilities; reflections that exchange the sides of a thin sheet come behind those
    /// of a plausibility of 0.5 or more. Then at most `options.rotations` rotations of order three or more (EXPERIMENTAL), one of each cyclic group: those of highest order first, then the best.
    pub symmetries: Vec<Symmetry>,
    /// Numbers behind the outcome.
    pub report: Report,
    /// What [`crate::detect_again`] needs of the connectivity; `None` where that is not known yet.
    #[serde(skip)]
    pub judging: Option<Arc<JudgingMesh>>,
}

/// Least mean confidence of a symmetry, and of one that leaves most vertices without a partner.
const LEAST_CONFIDENCE: f64 = 0.01;
const LEAST_CONFIDENCE_OF_FEW: f64 = 0.05;

impl Detection {
    /// Without symmetries that say nothing of nearly the whole surface, as that of one of ten thousand loose parts does, unless whoever
    /// asks takes any map: a plausibility from `least` percent on.
    pub(crate) fn without_empty(mut self, least: usize) -> Detection {
        let found = self.symmetries.len();
        let highest = self.symmetries.iter().map(|symmetry| symmetry.mean_confidence).fold(0.0, f64::max);
        self.symmetries.retain(|symmetry| least == 0 || !is_empty(symmetry));
        if found > 0 && self.symmetries.is_empty() {
            (self.outcome, self.judging) = (Outcome::None, None);
            self.report.evidence += &format!(
                "; but over the whole surface its mean confidence is {highest:.3}: it is no symmetry of the mesh"
            );
        }
        self
    }
}

fn is_empty(symmetry: &Symmetry) -> bool {
    let paired = symmetry.partner.iter().filter(|&&partner| partner >= 0).count();
    let are_few = 2 * paired < symmetry.partner.len();
    symmetry.mean_confidence < if are_few { LEAST_CONFIDENCE_OF_FEW } else { LEAST_CONFIDENCE }
}

/// The outcome for whoever asks for `asked` percent of plausibility, and what speaks against the first of the `symmetries`, in words.
pub(crate) fn conclusion(symmetries: &[Symmetry], asked: usize) -> (Outcome, String) {
    let Some(best) = symmetries.first() else { return (Outcome::None, String::new()) };
    let outcome = outcome(best.plausibility, asked, best.mean_confidence, best.coverage.paired_share);
    let doubts = match outcome {
        Outcome::Doubtful if 100.0 * best.plausibility < asked as f64 => {
            "; its plausibility is below the one asked for: it is given as doubtful".into()
        }
        Outcome::Doubtful if best.mean_confidence >= CONFIDENT => {
            format!(
                "; it is doubtful: {:.0} % of the surface has a partner",
                100.0 * best.coverage.paired_share
            )
        }
        Outcome::Doubtful => {
            format!("; it is doubtful: its mean confidence over the surface is {:.2}", best.mean_confidence)
        }
        Outcome::Found | Outcome::None => String::new(),
    };
    (outcome, doubts)
}

/// How the best map was judged, and that in words.
pub(crate) fn verdict(best: Option<&Hypothesis>, least: usize) -> (Option<Judgement>, String) {
    match best {
        Some(map) => (Some(map.judged), sentence(map, least)),
        None => (None, "no candidate map reverses orientation".into()),
    }
}

/// What is said to who asks for rotations of order three or more, of which `listed` were found.
pub(crate) fn about_rotations(listed: usize, continuous: bool) -> String {
    match (listed, continuous) {
        (_, true) => {
            "; rotations of higher order (experimental) are not sought in a continuous family".into()
        }
        (0, _) => "; no rotation of order 3 to 12 was found (experimental)".into(),
        (1, _) => "; a rotation of higher order was found (experimental)".into(),
        _ => format!("; {listed} rotations of higher order were found (experimental)"),
    }
}

fn sentence(map: &Hypothesis, least: usize) -> String {
    let parts = match map.judged.disagreement.zip(map.judged.scatter) {
        Some((apart, scatter)) => {
            format!(
                ", rigid parts of it put a point {apart:.4} sqrt(area) apart, images leave {:.1} % of the surface empty beyond what is usual",
                100.0 * scatter
            )
        }
        None => String::new(),
    };
    format!(
        "the best map is a symmetry with a plausibility of {:.0} % (accepted from {least} %): heat kernel \
         signatures of partners differ by {:.3}, score {:.2}, orientation correlation {:+.2} (-1 for a \
         reflection), {:.0} % of the samples hardly move{parts}",
        100.0 * map.judged.plausibility,
        map.judged.signature_mismatch,
        map.score.total(),
        map.score.orientation,
        100.0 * map.score.fixed
    )
}

/// What is said of a shape with a continuous family of symmetries, of which `listed` are given.
pub(crate) fn about_family(listed: usize) -> &'static str {
    match listed {
        0 => "; the shape has a continuous family of symmetries, as a sphere or a vase has",
        1 => {
            "; the shape has a continuous family of symmetries, as a sphere or a vase has: the one given is an arbitrary one of them"
        }
        _ => {
            "; the shape has a continuous family of symmetries, as a sphere or a vase has: those given are arbitrary ones of them"
        }
    }
}

/// Wall time by stage.
pub(crate) struct Clock {
    last: Instant,
    pub(crate) laps: Vec<(String, f64)>,
}

impl Clock {
    pub(crate) fn start() -> Clock {
        Clock { last: Instant::now(), laps: Vec::new() }
    }

    pub(crate) fn lap(&mut self, stage: &str) {
        let now = Instant::now();
        self.laps.push((stage.into(), (now - self.last).as_secs_f64()));
        self.last = now;
    }
}
