//! Intrinsic reflectional symmetry of a surface mesh: which point is the mirror image of which, along the surface, whatever the pose.
//!
//! ```
//! use intrinsym::{Limits, Mesh, Options, Outcome, Progress, detect, io};
//!
//! let file = io::read("examples/human.ply".as_ref(), &Limits::default())?;
//! let mesh = Mesh::new(&file.polygons, &Limits::default())?;
//! let found = detect(&mesh, &Options::default(), &Progress::default())?;
//! assert_eq!(found.outcome, Outcome::Found);
//! let symmetry = &found.symmetries[0];
//! println!("vertex 0 is the mirror image of vertex {}", symmetry.partner[0]);
//! # assert!(symmetry.mean_confidence > 0.5 && symmetry.partner.len() == file.polygons.positions.len());
//! # Ok::<(), intrinsym::Error>(())
//! ```
//!
//! The names here, with [`io`], [`mirror`] and [`report`], are the interface. Behind it the folders of the source stand in the order of
//! the data; each imports only from those above it.
//!
//! | folder | what it does |
//! |---|---|
//! | `base` | errors, options, efforts, limits, progress, threads |
//! | `mesh` | any mesh file, or arrays, -> a validated triangle mesh and its shells |
//! | `geometry` | adjacency, points of triangles, shortest paths, the map that every stage passes on |
//! | `spectral` | a shell -> Laplacian, eigenfunctions, samples, signatures |
//! | `search` | eigenfunctions -> parities, candidate maps, refined on samples and scored |
//! | `refine` | a candidate -> the map of all vertices |
//! | `connectivity` | mirrored connectivity -> an exact bijection |
//! | `verify` | a finished map -> is it a symmetry, and how sure is each vertex |
//! | `detect` | the driver, simplified meshes, other shells, the answer |
//! | `mirror` | a symmetry -> mirrored selections, attributes, displacements, positions, colours |
#![forbid(unsafe_code)]

mod base;
mod connectivity;
mod detect;
mod geometry;
mod mesh;
pub mod mirror;
mod refine;
mod search;
mod spectral;
mod verify;

pub use base::error::{Error, MeshFault, Result};
pub use base::limits::Limits;
pub use base::options::{Effort, OPTIONS, OptionSpec, Options};
pub use base::progress::{CancelToken, Progress};
pub use base::symmetry_kind::SymmetryKind;
pub use detect::correspondence::{EdgePoint, Polyline, SurfacePoint, Symmetry};
pub use detect::coverage::Coverage;
pub use detect::detect_again::{Previous, detect_again};
pub use detect::detection::{Detection, Report};
pub use detect::driver::detect;
pub use detect::eigen::{Eigen, eigen};
pub use detect::judging_mesh::JudgingMesh;
pub use detect::report;
pub use mesh::{Mesh, NONE, PolygonMesh, RepairReport, connectivity_hash, io};
pub use search::candidate_score::Score;
pub use search::sign_network::SignPrediction;
pub use verify::acceptance::Judgement;
pub use verify::outcome::Outcome;
pub use verify::reason::Reason;

/// The inside, for this project's tests, measurements and command line. It changes without notice.
#[cfg(feature = "internals")]
#[doc(hidden)]
pub mod internals {
    pub mod base {
        pub use crate::base::*;
    }
    pub mod mesh {
        pub use crate::mesh::*;
    }
    pub mod geometry {
        pub use crate::geometry::*;
    }
    pub mod spectral {
        pub use crate::spectral::*;
    }
    pub mod search {
        pub use crate::search::*;
    }
    pub mod refine {
        pub use crate::refine::*;
    }
    pub mod connectivity {
        pub use crate::connectivity::*;
    }
    pub mod verify {
        pub use crate::verify::*;
    }
    pub mod detect {
        pub use crate::detect::*;
    }
}
