//! Exact bijections: connectivity that is mirrored, and vertices that are mirrored where edges are not.

pub mod automorphism;
pub mod mirrored_vertices;
