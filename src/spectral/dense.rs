//! Small dense helpers over `faer`, sequential and deterministic.

use crate::base::error::{Error, Result};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve as triangular;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};

/// `left * right`.
pub fn product(left: MatRef<f64>, right: MatRef<f64>) -> Mat<f64> {
    let mut out = Mat::zeros(left.nrows(), right.ncols());
    matmul(out.as_mut(), Accum::Replace, left, right, 1.0, Par::Seq);
    out
}

/// `out -= left * right`.
pub fn subtract_product(out: MatMut<f64>, left: MatRef<f64>, right: MatRef<f64>) {
    matmul(out, Accum::Add, left, right, -1.0, Par::Seq);
}

/// Eigenvalues ascending and eigenvectors (columns) of the symmetric `matrix` (lower triangle read).
pub fn symmetric_eigen(matrix: MatRef<f64>) -> Result<(Vec<f64>, Mat<f64>)> {
    let eigen = matrix
        .self_adjoint_eigen(Side::Lower)
        .map_err(|error| Error::Internal(format!("dense eigenvalue problem: {error:?}")))?;
    let values = eigen.S().column_vector().iter().copied().collect();
    Ok((values, eigen.U().to_owned()))
}

/// Lower Cholesky factor of a Gram matrix; a tiny multiple of the trace is added until it exists.
pub fn gram_cholesky(gram: MatRef<f64>) -> Result<Mat<f64>> {
    let size = gram.nrows();
    let trace: f64 = (0..size).map(|i| gram[(i, i)]).sum();
    let mut shift = 0.0;
    for _ in 0..12 {
        let mut shifted = gram.to_owned();
        for i in 0..size {
            shifted[(i, i)] += shift;
        }
        if let Ok(factor) = shifted.llt(Side::Lower) {
            return Ok(factor.L().to_owned());
        }
        shift = if shift == 0.0 { 1e-14 * trace } else { shift * 10.0 };
    }
    Err(Error::Internal("a Gram matrix is not positive definite".into()))
}

/// Solves `L L^T X = right` in place, `L` lower triangular.
pub fn cholesky_solve(lower: MatRef<f64>, mut right: MatMut<f64>) {
    triangular::solve_lower_triangular_in_place(lower, right.as_mut(), Par::Seq);
    triangular::solve_upper_triangular_in_place(lower.transpose(), right, Par::Seq);
}

/// Makes the columns of `block` orthonormal by Cholesky QR, twice ("CholeskyQR2": Yamamoto et al. 2015).
/// Returns `R` with `block_before = block_after * R`.
pub fn orthonormalise(block: &mut Mat<f64>) -> Result<Mat<f64>> {
    let mut upper: Option<Mat<f64>> = None;
    for _ in 0..2 {
        let gram = product(block.transpose(), block.as_ref());
        let lower = gram_cholesky(gram.as_ref())?;
        // block <- block * L^-T, i.e. L * new^T = block^T.
        triangular::solve_lower_triangular_in_place(lower.as_ref(), block.as_mut().transpose_mut(), Par::Seq);
        upper = Some(match upper {
            None => lower.transpose().to_owned(),
            Some(first) => product(lower.transpose(), first.as_ref()),
        });
    }
    Ok(upper.expect("two passes ran"))
}
