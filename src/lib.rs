//! Intrinsic reflectional symmetry of a surface mesh.
//!
//! The folders stand in the order of the data; each imports only from those above it:
//!
//! | folder | what it does |
//! |---|---|
//! | [`base`] | errors, options, efforts, limits, progress, threads |
//! | [`mesh`] | any mesh file, or arrays, -> a validated triangle mesh and its shells |
//! | [`geometry`] | adjacency, points of triangles, shortest paths, the map that every stage passes on |
//! | [`spectral`] | a shell -> Laplacian, eigenfunctions, samples, signatures |
//! | [`search`] | eigenfunctions -> parities, candidate maps, refined on samples and scored |
//! | [`refine`] | a candidate -> the map of all vertices |
//! | [`connectivity`] | mirrored connectivity -> an exact bijection |
//! | [`verify`] | a finished map -> is it a symmetry, and how sure is each vertex |
//! | [`detect`] | the driver, simplified meshes, other shells, the answer |
//! | [`mirror`] | a symmetry -> mirrored selections, attributes, displacements, positions, colours |
//! | [`ffi`] | all of it for C |
#![deny(unsafe_code)]

pub mod base;
pub mod connectivity;
pub mod detect;
pub mod ffi;
pub mod geometry;
pub mod mesh;
pub mod mirror;
#[cfg(feature = "cli")]
pub mod picture;
pub mod refine;
pub mod search;
pub mod spectral;
pub mod verify;

pub use base::error::{Error, Result};
