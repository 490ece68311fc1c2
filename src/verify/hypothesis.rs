//! A finished map of a shell, with what speaks for it.

use crate::geometry::vertex_map::VertexMap;
use crate::search::candidate_score::Score;
use crate::verify::acceptance::Judgement;
use faer::Mat;

/// Vertices that exchange the sides of a thin sheet are nearer than this, in sqrt(area), to their images: 0.01 to 0.05 on plates of a thickness of some percent of
/// their length, where those of other symmetries are 0.09 and more away (`docs/method.md`).
const SHEETS: f64 = 0.06;

/// A map of a shell that may be a symmetry.
#[derive(Debug, Clone)]
pub struct Hypothesis {
    /// Functional map after the last refinement.
    pub map: Mat<f64>,
    /// Images of all vertices.
    pub images: VertexMap,
    /// Score of the candidate it came from.
    pub score: Score,
    /// Some vertices, spread over the shell, each with how much speaks for another image of it, 0..=1; empty if there
    /// are no rivals.
    pub doubts: Vec<(u32, f64)>,
    /// Whether the map is a symmetry at all.
    pub judged: Judgement,
}

/// Whether a map exchanges the sides of a thin sheet that moves vertices by so much in space, in sqrt(area), in the root mean square: a symmetry, but hardly one
/// that anybody asks for.
pub fn exchanges_sheets(moved: f64) -> bool {
    moved < SHEETS
}
