//! The kinds of symmetry.

/// Whether a symmetry, which is its own inverse, reverses orientation (a reflection) or keeps it (a half turn).
///
/// Written as "reflection" or "half_turn". In a list reflections come first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SymmetryKind {
    /// Reverses orientation: left and right are exchanged.
    Reflection,
    /// Keeps orientation.
    HalfTurn,
}
