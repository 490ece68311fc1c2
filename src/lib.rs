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
//! the data; each imports only from those above it, and is compiled without those below it to show it (`make check-folders`).
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

// Each sees those before it: scripts/check_folders.sh leaves the others out.
mod base;
#[cfg(not(without = "mesh"))]
mod mesh;
#[cfg(not(without = "geometry"))]
mod geometry;
#[cfg(not(without = "spectral"))]
mod spectral;
#[cfg(not(without = "search"))]
mod search;
#[cfg(not(without = "refine"))]
mod refine;
#[cfg(not(without = "connectivity"))]
mod connectivity;
#[cfg(not(without = "verify"))]
mod verify;
#[cfg(not(without = "detect"))]
mod detect;
#[cfg(not(without = "mirror"))]
pub mod mirror;

#[cfg(not(without = "mirror"))]
pub use {
    base::error::{Error, MeshFault, Result},
    base::limits::Limits,
    base::options::{Effort, OPTIONS, OptionSpec, Options},
    base::progress::{CancelToken, Progress},
    base::symmetry_kind::SymmetryKind,
    detect::correspondence::{EdgePoint, Polyline, SurfacePoint, Symmetry},
    detect::coverage::Coverage,
    detect::detect_again::{Previous, detect_again},
    detect::detection::{Detection, Report},
    detect::driver::detect,
    detect::eigen::{Eigen, eigen},
    detect::judging_mesh::JudgingMesh,
    detect::report,
    mesh::{Mesh, NONE, PolygonMesh, RepairReport, connectivity_hash, io},
    search::candidate_score::Score,
    search::sign_network::SignPrediction,
    verify::acceptance::Judgement,
    verify::outcome::Outcome,
    verify::reason::Reason,
};

/// The inside, for this project's tests, measurements and command line. It changes without notice.
#[cfg(all(feature = "internals", not(without = "mirror")))]
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
