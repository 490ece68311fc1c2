//! From a shell to its Laplacian, eigenfunctions, samples and signatures.

pub mod continuous_family;
pub mod dense;
pub mod displacement;
pub mod eigenbasis;
pub mod laplacian;
pub mod sampling;
pub mod signature;
pub mod sparse_cholesky;
pub mod symmetric_sparse;
pub mod twin_parts;
