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
//! The names at the root, and [`mirror`], are the interface. The folders of the source stand in the order of the data; each imports
//! only from those above it. They are hidden here: this project's other packages, tests and measurements use them, and they
//! change without notice.
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

#[doc(hidden)]
pub mod base;
#[doc(hidden)]
pub mod connectivity;
#[doc(hidden)]
pub mod detect;
#[doc(hidden)]
pub mod geometry;
#[doc(hidden)]
pub mod mesh;
pub mod mirror;
#[doc(hidden)]
pub mod refine;
#[doc(hidden)]
pub mod search;
#[doc(hidden)]
pub mod spectral;
#[doc(hidden)]
pub mod verify;

pub use base::error::{Error, Result};
pub use base::limits::Limits;
pub use base::options::{Effort, Options};
pub use base::progress::{CancelToken, Progress};
pub use base::symmetry_kind::SymmetryKind;
pub use detect::correspondence::{EdgePoint, Polyline, SurfacePoint, Symmetry};
pub use detect::coverage::Coverage;
pub use detect::detect_again::{Previous, detect_again};
pub use detect::driver::{Detection, Eigen, Outcome, Report, detect, eigen};
pub use mesh::{Mesh, PolygonMesh, io};
