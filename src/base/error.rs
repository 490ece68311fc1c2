//! Errors, named by who can act on them.

use std::path::PathBuf;

/// What went wrong, by actor: the mesh, the option, the model file, a limit, the caller's cancel, or us.
///
/// "No symmetry found" is an outcome ([`crate::detect::driver::Outcome`]), never an error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The mesh cannot be used; the message names the element and the reason.
    #[error("the mesh cannot be used: {0}")]
    Mesh(String),
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
    /// A limit of [`crate::base::limits`] was hit.
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
    /// A defect of this library; please report it.
    #[error("internal error, please report it: {0}")]
    Internal(String),
}

/// Shorthand for this crate's results.
pub type Result<T, E = Error> = std::result::Result<T, E>;
