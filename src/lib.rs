//! Intrinsic reflectional symmetry of a surface mesh.
//!
//! The modules read in pipeline order; data flows one way and each file imports only from the
//! files above it:
//!
//! | stage | module |
//! |---|---|
//! | shared vocabulary | [`error`], [`options`], [`effort`], [`limits`], [`progress`], [`threads`], [`atomic_file`], [`symmetry_kind`] |
//! | any mesh file -> validated triangle mesh | [`mesh`] |
//! | one shell -> stiffness, lumped mass, mean curvature | [`laplacian`] |
//! | operators -> eigenvalues, eigenfunctions | [`sparse_cholesky`], [`eigenbasis`], [`sampling`] |
//! | eigenfunctions -> parity of each, with its probability | [`sign_network`] |
//! | eigenfunctions -> parity vectors | [`parity_search`] |
//! | parity, or pairs of limbs' ends -> functional map, refined and scored | [`functional_map`], [`refinement`], [`shortest_ways`], [`extrema_starts`], [`candidate_score`], [`candidates`], [`compositions`] |
//! | functional map -> map of all vertices | [`adjacency`], [`embedded_triangles`], [`vertex_rows`], [`mesh_descent`], [`full_refinement`] |
//! | eigenfunctions -> is there a continuous family of symmetries | [`continuous_family`] |
//! | finished map -> is it a symmetry at all | [`signature`], [`displacement`], [`acceptance`] |
//! | all spectral stages of one shell | [`shell_symmetry`], [`rotations`] (experimental) |
//! | other shells, confidence, sides | [`companions`], [`confidence`], [`fixed_curve`] |
//! | connectivity that is itself mirrored -> the exact bijection | [`automorphism`] |
//! | vertices that are mirrored where edges are not | [`mirrored_vertices`] |
//! | a shell with small holes <-> one without | [`filled_holes`] |
//! | a fine shell <-> its simplified proxy | [`surface_walk`], [`proxy`], [`stated_signs`] |
//! | the map where parts are rigid | [`rigid_parts`] |
//! | what the next call on the same connectivity needs | [`judging_mesh`] |
//! | candidates -> finished maps | [`finishing`] |
//! | what the caller gets | [`correspondence`], [`assembly`], [`assembler`], [`detection`], [`pipeline`], [`detect_again`], [`report`] |
//! | a symmetry -> mirrored selections, attributes, displacements, positions | [`mirror_tools`] |
//! | a symmetry -> colours that make pairs visible, a picture | [`pair_colour`], `picture` |
//! | all of it for C | [`ffi`] |
#![deny(unsafe_code)]

pub mod acceptance;
pub mod adjacency;
pub mod assembler;
pub mod assembly;
pub mod atomic_file;
pub mod automorphism;
pub mod candidate_score;
pub mod candidates;
pub mod companions;
pub mod compositions;
pub mod confidence;
pub mod continuous_family;
pub mod correspondence;
pub mod dense;
pub mod detect_again;
pub mod detection;
pub mod displacement;
pub mod effort;
pub mod eigenbasis;
pub mod embedded_triangles;
pub mod error;
pub mod extrema_starts;
pub mod ffi;
pub mod filled_holes;
pub mod finishing;
pub mod fixed_curve;
pub mod full_refinement;
pub mod functional_map;
pub mod judging_mesh;
pub mod laplacian;
pub mod limits;
pub mod mesh;
pub mod mesh_descent;
pub mod mirror_tools;
pub mod mirrored_vertices;
pub mod options;
pub mod pair_colour;
pub mod parity_search;
#[cfg(feature = "cli")]
pub mod picture;
pub mod pipeline;
pub mod progress;
pub mod proxy;
pub mod refinement;
pub mod report;
pub mod rigid_parts;
pub mod rotations;
pub mod sampling;
pub mod shell_symmetry;
pub mod shortest_ways;
pub mod sign_network;
pub mod signature;
pub mod sparse_cholesky;
pub mod stated_signs;
pub mod surface_walk;
pub mod symmetric_sparse;
pub mod symmetry_kind;
pub mod threads;
pub mod vertex_rows;

pub use error::{Error, Result};
