//! The kinds of symmetry that are their own inverse.

/// Whether a symmetry reverses orientation (a reflection) or keeps it (a half turn).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SymmetryKind {
    /// Reverses orientation: left and right are exchanged.
    Reflection,
    /// Keeps orientation and is its own inverse.
    HalfTurn,
}
