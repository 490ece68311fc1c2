//! Lowest eigenpairs from a coarse start: solved on a coarse operator, carried up level by level, and corrected on
//! each by block inverse iteration with a Rayleigh-Ritz projection.
//!
//! Inverse iteration and Rayleigh-Ritz: B. N. Parlett, "The Symmetric Eigenvalue Problem", 1980, chapters 4, 11, 14; the
//! use of a coarse space: W. Hackbusch, "On the Computation of Approximate Eigenvalues and Eigenfunctions of Elliptic
//! Operators by Means of a Multi-Grid Method", 1979. Most of what the coarse space misses is high in frequency, which one
//! inverse iteration all but removes; the rest is near the last pairs in frequency, which a polynomial filter damps
//! ten times faster than as many inverse iterations.

use super::RitzPairs;
use super::coarsening::Coarsening;
use super::lanczos;
use super::shift_invert::ShiftInvert;
use crate::dense::{gram_cholesky, symmetric_eigen};
use crate::error::Result;
use crate::laplacian::SymmetricSparse;
use crate::progress::Progress;
use crate::sparse_cholesky::Analysis;
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Mat, MatMut, MatRef, Par};

/// Vertices for each eigenpair from which a coarser operator is made.
const VERTICES_PER_PAIR: usize = 40;
/// Coarse vertices for each eigenpair that are enough for a start; a vertex with very many neighbours may leave fewer.
const LEAST_PER_PAIR: usize = 4;
/// Relative residual where there is no coarse start.
const LONE_TOLERANCE: f64 = 1e-5;
/// Shift for each pair: a tenth of the last eigenvalue, which Weyl's law puts near `4 pi width`. With less, the filter
/// raises the first functions so far above the last that these drown in rounding errors.
const SHIFT_PER_PAIR: f64 = 1.25;
/// Degree of the filter on the finest level; none is needed on those below.
const FINEST_DEGREE: usize = 3;
/// Relative residual to which the coarsest problem is solved.
const COARSE_TOLERANCE: f64 = 1e-2;

/// The `count` lowest eigenpairs (the constant included) and some more, approximately: functions at the vertices,
/// orthonormal in the mass.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn eigenpairs(
    stiffness: &SymmetricSparse,
    mass: &[f64],
    count: usize,
    progress: &Progress,
) -> Result<RitzPairs> {
    // A margin beyond the wanted pairs: what is farther off is damped by their ratio in each inverse iteration.
    let width = (count + count / 4).next_multiple_of(16);
    if pays(mass.len(), width) {
        corrected(stiffness, mass, width, FINEST_DEGREE, progress)
    } else {
        lanczos::eigenpairs(stiffness, mass, count, LONE_TOLERANCE, progress)
    }
}

/// Whether a mesh of `size` vertices leaves a coarse one that can hold `width` eigenpairs.
fn pays(size: usize, width: usize) -> bool {
    size > VERTICES_PER_PAIR * width
}

/// The `width` lowest eigenpairs from a coarse start.
fn corrected(
    stiffness: &SymmetricSparse,
    mass: &[f64],
    width: usize,
    degree: usize,
    progress: &Progress,
) -> Result<RitzPairs> {
    let coarse = Coarsening::new(stiffness, mass);
    let start = if pays(coarse.mass.len(), width) {
        corrected(&coarse.stiffness, &coarse.mass, width, 0, progress)?
    } else if coarse.mass.len() >= LEAST_PER_PAIR * width {
        lanczos::eigenpairs(&coarse.stiffness, &coarse.mass, width, COARSE_TOLERANCE, progress)?
    } else {
        return lanczos::eigenpairs(stiffness, mass, width, LONE_TOLERANCE, progress);
    };
    let analysis = Analysis::new(stiffness)?;
    let operator = ShiftInvert::new(&analysis, stiffness, mass, SHIFT_PER_PAIR * width as f64)?;
    progress.report("eigenfunctions", 0.2)?;
    let block = prolonged(&coarse, &start, &operator);
    let pairs = improve(&operator, block, width, degree, progress)?;
    progress.report("eigenfunctions", 0.4)?;
    Ok(operator.in_vertex_order(pairs))
}

/// Coarse functions at the fine vertices, times the square root of the mass, in the order of elimination.
fn prolonged(coarse: &Coarsening, start: &RitzPairs, operator: &ShiftInvert) -> Vec<f64> {
    let width = start.width;
    let mut block = vec![0.0; operator.size() * width];
    for ((row, &vertex), scale) in block.chunks_exact_mut(width).zip(operator.order()).zip(operator.scale()) {
        for &(j, value) in coarse.prolongation.row(vertex as usize) {
            let from = &start.vectors[j as usize * width..][..width];
            for (sum, entry) in row.iter_mut().zip(from) {
                *sum += scale * value * entry;
            }
        }
    }
    block
}

/// Damps what lies beyond the block's eigenpairs, then one inverse iteration, then the Ritz pairs.
///
/// The filter is the Chebyshev polynomial of `degree` of B on `[0, 1 / (last eigenvalue + shift)]`: Y. Saad, "Chebyshev
/// Acceleration Techniques for Solving Nonsymmetric Eigenvalue Problems", 1984.
fn improve(
    operator: &ShiftInvert,
    mut block: Vec<f64>,
    width: usize,
    degree: usize,
    progress: &Progress,
) -> Result<RitzPairs> {
    let mut image = block.clone();
    operator.apply(&mut image, width);
    if degree > 0 {
        let last = last_rayleigh_quotient(&block, &image, width);
        // T_1(x) = 2 last B x - x, then T_{i+1} = 2 (2 last B - 1) T_i - T_{i-1}.
        let mut before = block;
        block = before.iter().zip(&image).map(|(x, image)| 2.0 * last * image - x).collect();
        for _ in 1..degree {
            progress.check()?;
            image.copy_from_slice(&block);
            operator.apply(&mut image, width);
            for ((older, own), image) in before.iter_mut().zip(&block).zip(&image) {
                *older = 4.0 * last * image - 2.0 * own - *older;
            }
            std::mem::swap(&mut before, &mut block);
        }
        progress.check()?;
        image.copy_from_slice(&block);
        operator.apply(&mut image, width);
    }
    let (x, y) = (rows(&block, width), rows(&image, width));
    // For y = B x: y^T B^-1 y = y^T x.
    let energy = symmetric_product(y, x);
    let gram = symmetric_product(y, y);
    let (values, coefficients) = generalised_eigen(energy, gram)?;
    let mut vectors = block;
    matmul(
        MatMut::from_row_major_slice_mut(&mut vectors, operator.size(), width),
        Accum::Replace,
        y,
        coefficients.as_ref(),
        1.0,
        Par::Seq,
    );
    Ok(RitzPairs { values: values.iter().map(|value| value - operator.shift).collect(), vectors, width })
}

/// Of B^-1, for the largest of the columns: `x^T y / y^T y` with `y = B x`.
fn last_rayleigh_quotient(block: &[f64], image: &[f64], width: usize) -> f64 {
    let (mut products, mut squares) = (vec![0.0; width], vec![0.0; width]);
    for (x, y) in block.chunks_exact(width).zip(image.chunks_exact(width)) {
        for j in 0..width {
            products[j] += x[j] * y[j];
            squares[j] += y[j] * y[j];
        }
    }
    products.iter().zip(&squares).map(|(product, square)| product / square).fold(0.0, f64::max)
}

fn rows(block: &[f64], width: usize) -> MatRef<'_, f64> {
    MatRef::from_row_major_slice(block, block.len() / width, width)
}

/// The lower triangle of `left^T right`, which is symmetric.
fn symmetric_product(left: MatRef<f64>, right: MatRef<f64>) -> Mat<f64> {
    let mut out = Mat::zeros(left.ncols(), right.ncols());
    triangular::matmul(
        out.as_mut(),
        BlockStructure::TriangularLower,
        Accum::Replace,
        left.transpose(),
        BlockStructure::Rectangular,
        right,
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
    out
}

/// Eigenvalues, ascending, and eigenvectors of `energy v = value gram v`; lower triangles are read.
fn generalised_eigen(energy: Mat<f64>, gram: Mat<f64>) -> Result<(Vec<f64>, Mat<f64>)> {
    let size = gram.nrows();
    // Columns of one length keep the Cholesky factor harmless.
    let lengths: Vec<f64> = (0..size).map(|i| gram[(i, i)].sqrt().max(f64::MIN_POSITIVE)).collect();
    let scaled = |matrix: &Mat<f64>| {
        Mat::from_fn(size, size, |i, j| matrix[(i.max(j), i.min(j))] / (lengths[i] * lengths[j]))
    };
    let lower = gram_cholesky(scaled(&gram).as_ref())?;
    let mut reduced = scaled(&energy);
    solve_lower_triangular_in_place(lower.as_ref(), reduced.as_mut(), Par::Seq);
    solve_lower_triangular_in_place(lower.as_ref(), reduced.as_mut().transpose_mut(), Par::Seq);
    let (values, mut vectors) = symmetric_eigen(reduced.as_ref())?;
    solve_upper_triangular_in_place(lower.transpose(), vectors.as_mut(), Par::Seq);
    let coefficients = Mat::from_fn(size, size, |i, j| vectors[(i, j)] / lengths[i]);
    Ok((values, coefficients))
}
