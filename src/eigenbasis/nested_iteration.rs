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
use crate::threads;
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Mat, MatMut, MatRef, Par};

/// Columns that are filtered at once, few enough to stay in the cache; widths are multiples of it.
const PANEL: usize = 16;
/// Vertices for each eigenpair from which a coarser operator is made.
const VERTICES_PER_PAIR: usize = 8;
/// Coarse vertices for each eigenpair that are enough for a start; vertices with very many neighbours may leave fewer.
const LEAST_PER_PAIR: f64 = 1.1;
/// Shift for each pair: a tenth of the last eigenvalue, which Weyl's law puts near `4 pi width`. With less, the filter
/// raises the first functions so far above the last that these drown in rounding errors.
const SHIFT_PER_PAIR: f64 = 1.25;
/// Degree of the filter on the finest level; none is needed on those below. With 6 a torus lost a pair to rounding errors, with 9 all shapes did.
const FINEST_DEGREE: usize = 3;
/// Relative residual to which the coarsest problem is solved, or a mesh that has no coarser one, to start from.
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
    threads: usize,
    progress: &Progress,
) -> Result<RitzPairs> {
    let sizes = Sizes { width: width(count), kept: count };
    if pays(mass.len(), sizes.width) {
        corrected(stiffness, mass, sizes, FINEST_DEGREE, threads, progress)
    } else {
        lone(stiffness, mass, sizes, threads, progress)
    }
}

/// Pairs that are carried along for `count`: what is beyond them is damped by their ratio in each inverse iteration.
pub fn width(count: usize) -> usize {
    (count + count / 4).next_multiple_of(PANEL)
}

/// As many of the lowest eigenpairs as `start` (vertices x functions) has, and the constant's, approximately: from the
/// eigenfunctions of another shape of the surface.
///
/// # Errors
/// As [`eigenpairs`].
pub fn continued(
    analysis: &Analysis,
    stiffness: &SymmetricSparse,
    mass: &[f64],
    start: MatRef<f32>,
    threads: usize,
    progress: &Progress,
) -> Result<RitzPairs> {
    let width = start.ncols() + 1;
    let operator = ShiftInvert::new(analysis, stiffness, mass, SHIFT_PER_PAIR * width as f64)?;
    progress.report("eigenfunctions", 0.2)?;
    let mut block = vec![0.0; mass.len() * width];
    for ((row, &vertex), scale) in block.chunks_exact_mut(width).zip(operator.order()).zip(operator.scale()) {
        row[0] = *scale;
        for (j, value) in row[1..].iter_mut().enumerate() {
            *value = scale * f64::from(start[(vertex as usize, j)]);
        }
    }
    let pairs = improve(&operator, block, Sizes { width, kept: width }, FINEST_DEGREE, threads, progress)?;
    progress.report("eigenfunctions", 0.4)?;
    Ok(operator.in_vertex_order(pairs, threads))
}

/// Whether a mesh of `size` vertices leaves a coarse one that can hold `width` eigenpairs.
fn pays(size: usize, width: usize) -> bool {
    size > VERTICES_PER_PAIR * width
}

/// Pairs that are carried along, and how many of them are wanted.
#[derive(Clone, Copy)]
struct Sizes {
    width: usize,
    kept: usize,
}

/// The lowest eigenpairs of a mesh that has no coarser one: a rough answer is the start, and is corrected on the mesh itself.
fn lone(
    stiffness: &SymmetricSparse,
    mass: &[f64],
    sizes: Sizes,
    threads: usize,
    progress: &Progress,
) -> Result<RitzPairs> {
    let analysis = Analysis::new(stiffness)?;
    let operator = ShiftInvert::new(&analysis, stiffness, mass, SHIFT_PER_PAIR * sizes.width as f64)?;
    let start = lanczos::lanczos(&operator, sizes.width, COARSE_TOLERANCE, progress)?;
    let pairs = improve(&operator, start.vectors, sizes, FINEST_DEGREE, threads, progress)?;
    Ok(operator.in_vertex_order(pairs, threads))
}

/// The lowest eigenpairs from a coarse start.
fn corrected(
    stiffness: &SymmetricSparse,
    mass: &[f64],
    sizes: Sizes,
    degree: usize,
    threads: usize,
    progress: &Progress,
) -> Result<RitzPairs> {
    let width = sizes.width;
    let coarse = Coarsening::new(stiffness, mass);
    if (coarse.mass.len() as f64) < LEAST_PER_PAIR * width as f64 {
        return lone(stiffness, mass, sizes, threads, progress);
    }
    let (start, analysis) = if pays(coarse.mass.len(), width) {
        let all = Sizes { width, kept: width };
        let start = corrected(&coarse.stiffness, &coarse.mass, all, 0, threads, progress);
        (start, Analysis::new(stiffness))
    } else {
        let solve =
            || lanczos::eigenpairs(&coarse.stiffness, &coarse.mass, width, COARSE_TOLERANCE, progress);
        threads::join(threads, solve, || Analysis::new(stiffness))
    };
    let (start, analysis) = (start?, analysis?);
    let operator = ShiftInvert::new(&analysis, stiffness, mass, SHIFT_PER_PAIR * width as f64)?;
    progress.report("eigenfunctions", 0.2)?;
    let block = prolonged(&coarse, &start, &operator, threads);
    let pairs = improve(&operator, block, sizes, degree, threads, progress)?;
    progress.report("eigenfunctions", 0.4)?;
    Ok(operator.in_vertex_order(pairs, threads))
}

/// Coarse functions at the fine vertices, times the square root of the mass, in the order of elimination.
fn prolonged(coarse: &Coarsening, start: &RitzPairs, operator: &ShiftInvert, threads: usize) -> Vec<f64> {
    let width = start.width;
    let mut block = vec![0.0; operator.size() * width];
    let at_once = operator.size().div_ceil(threads.max(1)).max(1);
    let rows = operator.order().chunks(at_once).zip(operator.scale().chunks(at_once));
    let parts = block.chunks_mut(at_once * width).zip(rows).collect();
    threads::map(threads, parts, |(out, (order, scale)): (&mut [f64], (&[u32], &[f64]))| {
        for ((row, &vertex), scale) in out.chunks_exact_mut(width).zip(order).zip(scale) {
            for &(j, value) in coarse.prolongation.row(vertex as usize) {
                let from = &start.vectors[j as usize * width..][..width];
                for (sum, entry) in row.iter_mut().zip(from) {
                    *sum += scale * value * entry;
                }
            }
        }
    });
    block
}

/// Damps what lies beyond the block's eigenpairs, then one inverse iteration, then the lowest Ritz pairs.
fn improve(
    operator: &ShiftInvert,
    mut block: Vec<f64>,
    Sizes { width, kept }: Sizes,
    degree: usize,
    threads: usize,
    progress: &Progress,
) -> Result<RitzPairs> {
    let mut bound = 0.0;
    if degree > 0 {
        // The last panel holds the bound of the filter's interval.
        let panel = panel_of(&block, width, width - PANEL);
        let mut image = panel.clone();
        operator.apply(&mut image, PANEL);
        bound = largest_rayleigh_quotient(&panel, &image);
    }
    let mut image = vec![0.0; block.len()];
    let token = progress.token();
    // As many panels at once as there are threads: more would only wait with their results in memory.
    for group in (0..width).step_by(PANEL).collect::<Vec<_>>().chunks(threads.max(1)) {
        let panels = group.iter().map(|&first| (first, panel_of(&block, width, first))).collect();
        let of_panel = |(first, panel)| -> Result<_> {
            token.check()?;
            Ok((first, filtered(operator, panel, degree, bound)))
        };
        for result in threads::map(threads, panels, of_panel) {
            let (first, (filtered, inverse)) = result?;
            put_panel(&mut block, width, first, &filtered);
            put_panel(&mut image, width, first, &inverse);
        }
    }
    let (x, y) = (rows(&block, width), rows(&image, width));
    // For y = B x: y^T B^-1 y = y^T x.
    let products = threads::map(threads, vec![x, y], |right| symmetric_product(y, right));
    let [energy, gram] = <[_; 2]>::try_from(products).expect("two products");
    let (values, coefficients) = generalised_eigen(energy, gram)?;
    let coefficients = coefficients.subcols(0, kept);
    let mut vectors = block;
    vectors.truncate(operator.size() * kept);
    let rows_at_once = operator.size().div_ceil(4 * threads.max(1)).max(1);
    let parts = vectors.chunks_mut(rows_at_once * kept).zip(image.chunks(rows_at_once * width)).collect();
    threads::map(threads, parts, |(out, y): (&mut [f64], &[f64])| {
        let out = MatMut::from_row_major_slice_mut(out, y.len() / width, kept);
        matmul(out, Accum::Replace, rows(y, width), coefficients, 1.0, Par::Seq);
    });
    let values = values[..kept].iter().map(|value| value - operator.shift).collect();
    Ok(RitzPairs { values, vectors, width: kept })
}

/// `T(B) x` and `B T(B) x` of a panel x, with the Chebyshev polynomial T of `degree` on `[0, 1 / bound]`: Y. Saad,
/// "Chebyshev Acceleration Techniques for Solving Nonsymmetric Eigenvalue Problems", 1984.
fn filtered(operator: &ShiftInvert, panel: Vec<f64>, degree: usize, bound: f64) -> (Vec<f64>, Vec<f64>) {
    let (mut before, mut own) = (Vec::new(), panel);
    let mut image = own.clone();
    operator.apply(&mut image, PANEL);
    for step in 0..degree {
        if step == 0 {
            before = own.iter().zip(&image).map(|(x, image)| 2.0 * bound * image - x).collect();
        } else {
            for ((older, own), image) in before.iter_mut().zip(&own).zip(&image) {
                *older = 4.0 * bound * image - 2.0 * own - *older;
            }
        }
        std::mem::swap(&mut before, &mut own);
        image.copy_from_slice(&own);
        operator.apply(&mut image, PANEL);
    }
    (own, image)
}

/// Of B^-1: the largest of the columns' `x^T y / y^T y` with `y = B x`.
fn largest_rayleigh_quotient(panel: &[f64], image: &[f64]) -> f64 {
    let (mut products, mut squares) = ([0.0; PANEL], [0.0; PANEL]);
    for (x, y) in panel.as_chunks::<PANEL>().0.iter().zip(image.as_chunks::<PANEL>().0) {
        for j in 0..PANEL {
            products[j] += x[j] * y[j];
            squares[j] += y[j] * y[j];
        }
    }
    products.iter().zip(&squares).map(|(product, square)| product / square).fold(0.0, f64::max)
}

/// Columns `first..first + PANEL` of a block.
fn panel_of(block: &[f64], width: usize, first: usize) -> Vec<f64> {
    let mut panel = Vec::with_capacity(block.len() / width * PANEL);
    for row in block.chunks_exact(width) {
        panel.extend_from_slice(&row[first..first + PANEL]);
    }
    panel
}

fn put_panel(block: &mut [f64], width: usize, first: usize, panel: &[f64]) {
    for (row, values) in block.chunks_exact_mut(width).zip(panel.as_chunks::<PANEL>().0) {
        row[first..first + PANEL].copy_from_slice(values);
    }
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
