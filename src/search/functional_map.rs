//! A functional map: the matrix C with `phi(image of x) = phi(x) C`, row vectors of eigenfunctions.
//!
//! M. Ovsjanikov, M. Ben-Chen, J. Solomon, A. Butscher, L. Guibas, "Functional Maps: A Flexible
//! Representation of Maps Between Shapes", 2012. A reflection is its own inverse, so its C is
//! symmetric and orthogonal; projecting to the nearest such matrix is ours (measured in
//! `docs/notebook/2026-11-25-method.md`).

use crate::base::error::{Error, Result};
use crate::spectral::dense::{cholesky_solve, product, symmetric_eigen};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

/// Newton-Schulz iterations at most: singular values below 0.002 are left to a decomposition.
const NEWTON_SCHULZ_STEPS: usize = 18;

/// What C is projected to after it was estimated from points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Projection {
    /// The nearest orthogonal matrix: right for any isometry.
    Orthogonal,
    /// The nearest symmetric orthogonal matrix: right for a map that is its own inverse.
    Involution,
    /// None: the least-squares estimate itself.
    None,
}

/// The diagonal map of a parity vector.
pub fn from_parity(parity: &[i8]) -> Mat<f64> {
    Mat::from_fn(parity.len(), parity.len(), |i, j| if i == j { f64::from(parity[i]) } else { 0.0 })
}

/// Least-squares C of size `size` with `rows C = rows[partner]`, then projected.
///
/// `rows` is samples x at least `size`; `lower` the Cholesky factor of `rows^T rows`, whose leading blocks are those of every size.
pub fn estimate(
    rows: MatRef<f64>,
    lower: MatRef<f64>,
    partner: &[u32],
    size: usize,
    projection: Projection,
) -> Result<Mat<f64>> {
    let source = rows.subcols(0, size);
    let images = Mat::from_fn(rows.nrows(), size, |i, j| rows[(partner[i] as usize, j)]);
    let mut map = product(source.transpose(), images.as_ref());
    cholesky_solve(lower.submatrix(0, 0, size, size), map.as_mut());
    project(map, projection)
}

/// Applies a projection.
pub fn project(map: Mat<f64>, projection: Projection) -> Result<Mat<f64>> {
    match projection {
        Projection::None => Ok(map),
        Projection::Orthogonal => nearest_orthogonal(&map),
        Projection::Involution => nearest_involution(&map),
    }
}

/// The orthogonal matrix nearest to `map` in the Frobenius norm (the polar factor).
pub fn nearest_orthogonal(map: &Mat<f64>) -> Result<Mat<f64>> {
    if let Some(factor) = polar_factor(map) {
        return Ok(factor);
    }
    let svd = map.thin_svd().map_err(|error| Error::Internal(format!("singular values: {error:?}")))?;
    Ok(product(svd.U(), svd.V().transpose()))
}

/// The symmetric orthogonal matrix nearest to `map`: eigenvalues of its symmetric part go to +-1.
pub fn nearest_involution(map: &Mat<f64>) -> Result<Mat<f64>> {
    let size = map.nrows();
    let symmetric = Mat::from_fn(size, size, |i, j| 0.5 * (map[(i, j)] + map[(j, i)]));
    if let Some(factor) = polar_factor(&symmetric) {
        // Rounding leaves it not quite symmetric.
        return Ok(Mat::from_fn(size, size, |i, j| 0.5 * (factor[(i, j)] + factor[(j, i)])));
    }
    let (values, vectors) = symmetric_eigen(symmetric.as_ref())?;
    let signed =
        Mat::from_fn(size, size, |i, j| if values[j] < 0.0 { -vectors[(i, j)] } else { vectors[(i, j)] });
    Ok(product(signed.as_ref(), vectors.transpose()))
}

/// The polar factor by Newton-Schulz iterations `X <- X (3 - X^T X) / 2`, for a symmetric matrix its matrix sign: N. J. Higham,
/// "Functions of Matrices", 2008, sections 5.3 and 8.3. `None` where a singular value is too near to 0.
fn polar_factor(map: &Mat<f64>) -> Option<Mat<f64>> {
    let size = map.nrows();
    let mut factor = map.clone();
    let (mut gram, mut next) = (Mat::<f64>::zeros(size, size), Mat::<f64>::zeros(size, size));
    for step in 0..NEWTON_SCHULZ_STEPS {
        matmul(gram.as_mut(), Accum::Replace, factor.transpose(), factor.as_ref(), 1.0, Par::Seq);
        // Row sums bound the largest squared singular value; the iteration converges below 3.
        let bound = match step {
            0 => (0..size).map(|j| sum_of_sizes(gram.col_as_slice(j))).fold(2.0, f64::max) / 2.0,
            _ => 1.0,
        };
        let mut error = 0.0f64;
        for j in 0..size {
            let column = gram.col_as_slice_mut(j);
            column.iter_mut().for_each(|value| *value *= -0.5 / bound);
            column[j] += 0.5;
            error = error.max(sum_of_sizes(column));
            column[j] += 1.0;
        }
        matmul(next.as_mut(), Accum::Replace, factor.as_ref(), gram.as_ref(), bound.sqrt().recip(), Par::Seq);
        std::mem::swap(&mut factor, &mut next);
        // The error of the next one is the square of this.
        if error < f64::EPSILON.sqrt() {
            return Some(factor);
        }
    }
    None
}

fn sum_of_sizes(values: &[f64]) -> f64 {
    values.iter().map(|value| value.abs()).sum()
}

/// How far the map is from commuting with the Laplacian: `|C L - L C|^2 / (size mean(eigenvalue^2))`.
///
/// 0 for an isometry.
pub fn commutator(map: &Mat<f64>, eigenvalues: &[f64]) -> f64 {
    let size = map.nrows();
    let squares: f64 = eigenvalues[..size].iter().map(|value| value * value).sum();
    let mut total = 0.0;
    for j in 0..size {
        for i in 0..size {
            total += (map[(i, j)] * (eigenvalues[j] - eigenvalues[i])).powi(2);
        }
    }
    total / squares.max(f64::MIN_POSITIVE)
}

/// Trace over size: 1 for the identity, about 0 for a reflection.
pub fn mean_trace(map: &Mat<f64>) -> f64 {
    (0..map.nrows()).map(|i| map[(i, i)]).sum::<f64>() / map.nrows() as f64
}
