//! The lowest eigenpairs of a mesh, in the caller's numbering.

use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::mesh::{Mesh, NONE};
use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::laplacian::IntrinsicSurface;

/// The lowest eigenpairs of a whole mesh, for training and curiosity.
#[derive(Debug, Clone)]
pub struct Eigen {
    /// Ascending, the constant function left out; units of 1 / area of the largest shell.
    pub eigenvalues: Vec<f64>,
    /// Caller's vertices x count, row by row; NaN where the vertex is not on the largest shell.
    pub eigenfunctions: Vec<f64>,
    /// Lumped mass of each caller's vertex, summing to 1 over the largest shell's points; 0 elsewhere.
    pub lumped_mass: Vec<f64>,
    /// Relative residual of each pair.
    pub residuals: Vec<f64>,
}

/// Computes the `count` lowest non-constant eigenpairs of the largest shell.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn eigen(mesh: &Mesh, count: usize, progress: &Progress) -> Result<Eigen> {
    progress.report("shells", 0.0)?;
    let shells = mesh.shells();
    progress.report("laplacian", 0.02)?;
    let surface = IntrinsicSurface::new(&shells[0]);
    let basis = Eigenbasis::exact(&surface, count, progress)?;
    let mut local = vec![NONE; mesh.positions.len()];
    for (index, &point) in shells[0].points.iter().enumerate() {
        local[point as usize] = index as u32;
    }
    let vertices = mesh.point_of_vertex.len();
    let mut eigenfunctions = vec![f64::NAN; vertices * basis.count()];
    let mut lumped_mass = vec![0.0; vertices];
    for (vertex, &point) in mesh.point_of_vertex.iter().enumerate() {
        if point == NONE || local[point as usize] == NONE {
            continue;
        }
        let row = local[point as usize] as usize;
        for j in 0..basis.count() {
            eigenfunctions[vertex * basis.count() + j] = basis.eigenfunctions[(row, j)];
        }
        if mesh.vertex_of_point[point as usize] == vertex as u32 {
            lumped_mass[vertex] = surface.lumped_mass[row];
        }
    }
    progress.report("done", 1.0)?;
    let residuals = basis.residuals(&surface);
    Ok(Eigen { eigenvalues: basis.eigenvalues, eigenfunctions, lumped_mass, residuals })
}
