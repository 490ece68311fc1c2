//! Errors, named by who can act on them.

use std::path::PathBuf;

/// What went wrong, by actor: the mesh, the option, the model file, a limit, the caller's cancel, or us.
///
/// "No symmetry found" is an outcome ([`crate::Outcome`]), never an error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The mesh cannot be used.
    #[error("the mesh cannot be used: {0}")]
    Mesh(#[from] MeshFault),
    /// The file is not a readable mesh file of its format; the message names the line or byte.
    #[error("{path}: {message}", path = path.display())]
    File {
        /// The file that was read or written.
        path: PathBuf,
        /// What is wrong, where, and what to do about it.
        message: String,
    },
    /// An option is outside its range.
    #[error("option {name}: {message}")]
    Option {
        /// The option's name as in [`crate::base::options::Options`].
        name: &'static str,
        /// The value's fault and the accepted range.
        message: String,
    },
    /// The sign network's model cannot be used.
    #[error("the sign network's model cannot be used: {0}")]
    Model(String),
    /// One of [`crate::Limits`], or [`crate::Options::memory`], was hit.
    #[error("{what} {found} exceeds the limit of {limit}; raise the limit if this machine can hold it")]
    Limit {
        /// What was counted, e.g. "the number of vertices".
        what: &'static str,
        /// The count found.
        found: u64,
        /// The limit in force.
        limit: u64,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// [`crate::Options::time_limit`] was reached before there was any answer.
    #[error(
        "the time limit was reached in the stage {stage:?} before there was any answer; raise it, or lower the effort"
    )]
    TimeLimit {
        /// What was under way, as [`crate::Progress`] names it.
        stage: &'static str,
    },
    /// A defect of this library; please report it.
    #[error("internal error, please report it: {0}")]
    Internal(String),
}

/// Why a mesh cannot be used, with its first bad element, numbered from 0 as the caller does.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFault {
    /// There is nothing.
    #[error("it has no vertices; export the geometry again")]
    NoVertices,
    /// There are points alone.
    #[error("it has no faces, only vertices; export a surface, or reconstruct one from the points first")]
    NoFaces,
    /// No face has three corners at different points.
    #[error(
        "none of its {faces} faces has three corners at different points; check how the faces were exported"
    )]
    NoFaceLeft {
        /// Faces that were given.
        faces: usize,
    },
    /// All faces are slivers.
    #[error(
        "its total area is zero: the corners of every face lie on one line or in one point; check the scale and the precision it was exported with"
    )]
    NoArea,
    /// A vertex is so far away that most others are almost one point beside it.
    #[error(
        "vertex {vertex} is over a hundred million times as far away as most others; move or delete it, or check how it was exported"
    )]
    TooFar {
        /// The vertex.
        vertex: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("vertex {vertex} has {} = {value}; every coordinate must be a finite number", ["x", "y", "z"][*axis])]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// 0, 1 or 2 for x, y or z.
        axis: usize,
        /// The coordinate.
        value: f64,
    },
    /// A face names a vertex that is not there.
    #[error(
        "face {face} refers to vertex {vertex}, but there are only {vertices} vertices, numbered from 0; the file is cut off or its indices start elsewhere"
    )]
    Index {
        /// The face.
        face: usize,
        /// The vertex that it names.
        vertex: u32,
        /// Vertices that there are.
        vertices: usize,
    },
    /// The first face does not begin at the first corner.
    #[error("the face offsets start at {offset} instead of 0")]
    FirstOffset {
        /// Where it begins.
        offset: u32,
    },
    /// A face ends before it begins.
    #[error(
        "the face offsets decrease after face {face}, from {from} to {to}; each must be at least the one before"
    )]
    Offsets {
        /// The face.
        face: usize,
        /// Where it begins.
        from: u32,
        /// Where it ends.
        to: u32,
    },
    /// The faces have more or fewer corners than were given.
    #[error("the last face offset is {offset} but there are {corners} face corners; they must agree")]
    LastOffset {
        /// Where the last face ends.
        offset: u32,
        /// Corners that were given.
        corners: usize,
    },
}

/// Shorthand for this crate's results.
pub type Result<T, E = Error> = std::result::Result<T, E>;
