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
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::base::threads;
use crate::spectral::dense::{gram_cholesky, symmetric_eigen};
use crate::spectral::laplacian::{IntrinsicSurface, SymmetricSparse};
use crate::spectral::sparse_cholesky::Analysis;
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Mat, MatRef, Par};

/// Columns that are filtered at once, few enough to stay in the cache; widths are multiples of it.
const PANEL: usize = 16;
/// Rows of products that are summed at once, few enough to stay in the cache.
const ROWS: usize = 256;
/// Vertices for each eigenpair from which a coarser operator is made.
const VERTICES_PER_PAIR: usize = 8;
/// Shift for each pair: a tenth of the last eigenvalue, which Weyl's law puts near `4 pi width`. With less, the filter
/// raises the first functions so far above the last that these drown in rounding errors.
const SHIFT_PER_PAIR: f64 = 1.25;
/// Degree of the filter on the finest level; none is needed on those below. With 6 a torus lost a pair to rounding errors, with 9 all shapes did.
const FINEST_DEGREE: usize = 3;

/// The `count` lowest eigenpairs (the constant included), approximately: functions at the vertices, orthonormal in the
/// mass.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn eigenpairs(
    surface: &IntrinsicSurface,
    count: usize,
    threads: usize,
    progress: &Progress,
) -> Result<RitzPairs> {
    let analysis = surface.analysis()?;
    let problem = Problem { stiffness: &surface.stiffness, mass: &surface.lumped_mass, analysis };
    problem.corrected(width(count), count, FINEST_DEGREE, threads, progress)
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
    surface: &IntrinsicSurface,
    start: MatRef<f32>,
    threads: usize,
    progress: &Progress,
) -> Result<RitzPairs> {
    let width = start.ncols() + 1;
    let analysis = surface.analysis()?;
    let problem = Problem { stiffness: &surface.stiffness, mass: &surface.lumped_mass, analysis };
    let operator = problem.operator(width)?;
    let block = Block::new(&operator, width, |vertex, row| {
        row[0] = 1.0;
        row[1..].iter_mut().zip(start.row(vertex).iter()).for_each(|(value, start)| *value = *start);
    });
    problem.improved(block, width, FINEST_DEGREE, threads, progress)
}

/// One level.
struct Problem<'a> {
    stiffness: &'a SymmetricSparse,
    mass: &'a [f64],
    analysis: &'a Analysis,
}

impl Problem<'_> {
    /// The operator whose largest eigenpairs are sought, shifted for `width` of them.
    fn operator(&self, width: usize) -> Result<ShiftInvert<'_, f32>> {
        ShiftInvert::new(self.analysis, self.stiffness, self.mass, SHIFT_PER_PAIR * width as f64)
    }

    /// The lowest `kept` eigenpairs, `width` of them carried along from a coarse start, or from a rough answer where
    /// there is no coarser mesh that can hold them.
    fn corrected(
        &self,
        width: usize,
        kept: usize,
        degree: usize,
        threads: usize,
        progress: &Progress,
    ) -> Result<RitzPairs> {
        let coarse = pays(self.mass.len(), width).then(|| Coarsening::new(self.stiffness, self.mass));
        // A start takes whole blocks of vectors. Vertices with very many neighbours may leave too few for it.
        let least = (width + 1).next_multiple_of(lanczos::BLOCK);
        let coarse = coarse.filter(|coarse| coarse.mass.len() >= least);
        let rough = |stiffness: &SymmetricSparse, mass: &[f64]| {
            lanczos::eigenpairs(stiffness, mass, width, lanczos::ROUGH, progress)
        };
        let start = || match &coarse {
            Some(coarse) if pays(coarse.mass.len(), width) => {
                let analysis = &Analysis::new(&coarse.stiffness)?;
                let problem = Problem { stiffness: &coarse.stiffness, mass: &coarse.mass, analysis };
                // Beside the other half of the join.
                problem.corrected(width, width, 0, threads.saturating_sub(1).max(1), progress)
            }
            Some(coarse) => rough(&coarse.stiffness, &coarse.mass),
            None => rough(self.stiffness, self.mass),
        };
        let (start, operator) = threads::join(threads, start, || self.operator(width));
        let (start, operator) = (start?.rows(), operator?);
        progress.report("eigenfunctions", 0.2)?;
        let block = Block::new(&operator, width, |vertex, row| match &coarse {
            Some(coarse) => coarse.prolongation.add_product(vertex, &start, row),
            None => row.copy_from_slice(&start[vertex * width..][..width]),
        });
        let degree = if coarse.is_some() { degree } else { FINEST_DEGREE };
        self.improved(block, kept, degree, threads, progress)
    }

    /// Damps what lies beyond the block's eigenpairs, then one inverse iteration, then the lowest Ritz pairs, which are
    /// exact for the block as single precision leaves it.
    fn improved(
        &self,
        mut block: Block,
        kept: usize,
        degree: usize,
        threads: usize,
        progress: &Progress,
    ) -> Result<RitzPairs> {
        block.filter(degree, threads, progress)?;
        let functions = block.at_vertices();
        let (values, coefficients) = self.ritz_pairs(&functions, block.width, threads)?;
        let vectors = combined(&functions, coefficients.subcols(0, kept), threads);
        progress.report("eigenfunctions", 0.4)?;
        Ok(RitzPairs { values: values[..kept].to_vec(), vectors })
    }

    /// Of the space of `functions` (vertices x width, row by row): eigenvalues, ascending, and coefficients.
    fn ritz_pairs(&self, functions: &[f32], width: usize, threads: usize) -> Result<(Vec<f64>, Mat<f64>)> {
        let row = |vertex: usize| &functions[vertex * width..][..width];
        let by_mass = |vertex: usize, out: &mut [f64]| {
            let mass = self.mass[vertex];
            out.iter_mut().zip(row(vertex)).for_each(|(out, value)| *out = mass * f64::from(*value));
        };
        let by_stiffness = |vertex: usize, out: &mut [f64]| {
            out.fill(0.0);
            for (other, weight) in self.stiffness.row(vertex) {
                out.iter_mut().zip(row(other)).for_each(|(out, value)| *out += weight * f64::from(*value));
            }
        };
        let product = |with_mass: bool| match with_mass {
            true => symmetric_product(functions, width, by_mass),
            false => symmetric_product(functions, width, by_stiffness),
        };
        let products = threads::map(threads, vec![false, true], product);
        let [energy, gram] = <[_; 2]>::try_from(products).expect("two products");
        generalised_eigen(energy, gram)
    }
}

/// Whether a mesh of `size` vertices leaves a coarse one that can hold `width` eigenpairs.
fn pays(size: usize, width: usize) -> bool {
    size > VERTICES_PER_PAIR * width
}

/// Functions times the square root of the mass, in the order of elimination.
struct Block<'a> {
    operator: &'a ShiftInvert<'a, f32>,
    width: usize,
    /// Panels of a few columns one after another, each row by row.
    panels: Vec<f32>,
}

impl Block<'_> {
    /// `fill` is given a vertex and its row of zeros.
    fn new<'a>(operator: &'a ShiftInvert<f32>, width: usize, fill: impl Fn(usize, &mut [f32])) -> Block<'a> {
        let mut panels = vec![0.0; operator.size() * width];
        let mut row = vec![0.0; width];
        for (place, (&vertex, scale)) in operator.order().iter().zip(operator.scale()).enumerate() {
            row.fill(0.0);
            fill(vertex as usize, &mut row);
            row.iter_mut().for_each(|value| *value *= *scale as f32);
            for (panel, values) in panels.chunks_exact_mut(operator.size() * PANEL).zip(row.chunks(PANEL)) {
                panel[place * PANEL..][..PANEL].copy_from_slice(values);
            }
        }
        Block { operator, width, panels }
    }

    /// The functions at the vertices, row by row.
    fn at_vertices(&self) -> Vec<f32> {
        let (order, scale) = (self.operator.order(), self.operator.scale());
        let mut functions = vec![0.0; self.panels.len()];
        for (first, panel) in self.panels.chunks_exact(order.len() * PANEL).enumerate() {
            for ((&vertex, scale), row) in order.iter().zip(scale).zip(panel.as_chunks::<PANEL>().0) {
                let out = &mut functions[vertex as usize * self.width + first * PANEL..][..PANEL];
                let scale = scale.recip() as f32;
                out.iter_mut().zip(row).for_each(|(out, value)| *out = scale * value);
            }
        }
        functions
    }

    /// A polynomial filter of `degree`, then one inverse iteration.
    fn filter(&mut self, degree: usize, threads: usize, progress: &Progress) -> Result<()> {
        let length = self.operator.size() * PANEL;
        let bound = match degree {
            0 => 0.0,
            // The last panel holds the bound of the filter's interval.
            _ => largest_rayleigh_quotient(self.operator, &self.panels[self.panels.len() - length..]),
        };
        let panels = self.panels.len() / length;
        let parts = self.panels.chunks_mut(panels.div_ceil(threads.max(1)) * length).collect();
        let token = progress.token();
        let filter = |part: &mut [f32]| -> Result<()> {
            let mut scratch = (vec![0.0; length], vec![0.0; length]);
            for panel in part.chunks_exact_mut(length) {
                token.check()?;
                filter_panel(self.operator, panel, &mut scratch, degree, bound);
            }
            Ok(())
        };
        threads::map(threads, parts, filter).into_iter().collect()
    }
}

/// Replaces a panel x by `B T(B) x`, with the Chebyshev polynomial T of `degree` on `[0, 1 / bound]`: Y. Saad,
/// "Chebyshev Acceleration Techniques for Solving Nonsymmetric Eigenvalue Problems", 1984.
fn filter_panel(
    operator: &ShiftInvert<f32>,
    panel: &mut [f32],
    scratch: &mut (Vec<f32>, Vec<f32>),
    degree: usize,
    bound: f32,
) {
    let (mut before, image) = (&mut scratch.0[..], &mut scratch.1[..]);
    let mut own = &mut panel[..];
    image.copy_from_slice(own);
    operator.apply(image, PANEL);
    for step in 0..degree {
        for ((older, own), image) in before.iter_mut().zip(&*own).zip(&*image) {
            *older = match step {
                0 => 2.0 * bound * image - own,
                _ => 4.0 * bound * image - 2.0 * own - *older,
            };
        }
        std::mem::swap(&mut before, &mut own);
        image.copy_from_slice(own);
        operator.apply(image, PANEL);
    }
    panel.copy_from_slice(image);
}

/// Of B^-1: the largest of the columns' `x^T y / y^T y` with `y = B x`.
fn largest_rayleigh_quotient(operator: &ShiftInvert<f32>, panel: &[f32]) -> f32 {
    let mut image = panel.to_vec();
    operator.apply(&mut image, PANEL);
    let (mut products, mut squares) = ([0.0; PANEL], [0.0; PANEL]);
    for (x, y) in panel.as_chunks::<PANEL>().0.iter().zip(image.as_chunks::<PANEL>().0) {
        for j in 0..PANEL {
            products[j] += x[j] * y[j];
            squares[j] += y[j] * y[j];
        }
    }
    products.iter().zip(&squares).map(|(product, square)| product / square).fold(0.0, f32::max)
}

/// The lower triangle of `functions^T right`, which is symmetric; `fill` writes rows of `right`.
fn symmetric_product(functions: &[f32], width: usize, fill: impl Fn(usize, &mut [f64])) -> Mat<f64> {
    let mut sum = Mat::zeros(width, width);
    let (mut left, mut right) = (vec![0.0; ROWS * width], vec![0.0; ROWS * width]);
    for (chunk, values) in functions.chunks(ROWS * width).enumerate() {
        let (left, right) = (&mut left[..values.len()], &mut right[..values.len()]);
        left.iter_mut().zip(values).for_each(|(left, value)| *left = f64::from(*value));
        right.chunks_exact_mut(width).zip(chunk * ROWS..).for_each(|(row, vertex)| fill(vertex, row));
        triangular::matmul(
            sum.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            rows(left, width).transpose(),
            BlockStructure::Rectangular,
            rows(right, width),
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
    }
    sum
}

/// `functions coefficients`.
fn combined(functions: &[f32], coefficients: MatRef<f64>, threads: usize) -> Mat<f64> {
    let width = coefficients.nrows();
    let mut out = Mat::zeros(functions.len() / width, coefficients.ncols());
    let (mut rest, mut parts) = (out.as_mut(), Vec::new());
    for values in functions.chunks(ROWS * width) {
        let (part, others) = rest.split_at_row_mut(values.len() / width);
        parts.push((part, values));
        rest = others;
    }
    threads::map(threads, parts, |(part, values)| {
        let values: Vec<f64> = values.iter().map(|value| f64::from(*value)).collect();
        matmul(part, Accum::Replace, rows(&values, width), coefficients, 1.0, Par::Seq);
    });
    out
}

fn rows(block: &[f64], width: usize) -> MatRef<'_, f64> {
    MatRef::from_row_major_slice(block, block.len() / width, width)
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
