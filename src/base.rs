//! The shared vocabulary: errors, options, efforts, limits, progress, threads, atomic files, assignments.

pub mod assignment;
pub mod atomic_file;
pub mod effort;
pub mod error;
pub mod limits;
pub mod options;
pub mod progress;
pub mod symmetry_kind;
pub mod threads;
