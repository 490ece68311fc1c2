//! The kinds of symmetry: those that are their own inverse, and rotations of higher order.

use serde::{Serialize, Serializer};
use std::cmp::Reverse;

/// Whether a symmetry reverses orientation (a reflection) or keeps it (a half turn, a rotation).
///
/// Written as "reflection", "half_turn" or "rotation".
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SymmetryKind {
    /// Reverses orientation: left and right are exchanged.
    Reflection,
    /// Keeps orientation and is its own inverse.
    HalfTurn,
    /// EXPERIMENTAL. Keeps orientation and is the identity after `order` times, three or more: the partner of a vertex is its
    /// image, and the vertex is not its partner's partner. Listed for who asks for it alone.
    Rotation {
        /// After how many times it is the identity.
        order: usize,
    },
}

impl SymmetryKind {
    /// After how many times the symmetry is the identity: 2 if it is its own inverse.
    pub fn order(self) -> usize {
        match self {
            SymmetryKind::Reflection | SymmetryKind::HalfTurn => 2,
            SymmetryKind::Rotation { order } => order,
        }
    }

    /// Place in a list: reflections, half turns, rotations, of which those of higher order come first.
    pub fn place(self) -> (usize, Reverse<usize>) {
        let kind = match self {
            SymmetryKind::Reflection => 0,
            SymmetryKind::HalfTurn => 1,
            SymmetryKind::Rotation { .. } => 2,
        };
        (kind, Reverse(self.order()))
    }

    /// Whether it is a rotation of order three or more, so not its own inverse.
    pub fn is_rotation(self) -> bool {
        matches!(self, SymmetryKind::Rotation { .. })
    }
}

impl Serialize for SymmetryKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(match self {
            SymmetryKind::Reflection => "reflection",
            SymmetryKind::HalfTurn => "half_turn",
            SymmetryKind::Rotation { .. } => "rotation",
        })
    }
}
