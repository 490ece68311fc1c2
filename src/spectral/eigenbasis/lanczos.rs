//! Shift-invert block Lanczos with full reorthogonalisation (two passes): R. G. Grimes, J. G. Lewis, H. D. Simon,
//! "A Shifted Block Lanczos Algorithm for Solving Sparse Symmetric Generalized Eigenproblems", 1994.

use super::RitzPairs;
use super::shift_invert::ShiftInvert;
use crate::base::error::{Error, Result};
use crate::base::progress::Progress;
use crate::spectral::dense::{orthonormalise, product, subtract_product, symmetric_eigen};
use crate::spectral::laplacian::SymmetricSparse;
use crate::spectral::sparse_cholesky::Analysis;
use faer::{Mat, MatRef};

/// Vectors of a Lanczos block: bounds the multiplicity that is found without rounding's help.
pub const BLOCK: usize = 12;

/// The relative residual of a start for other methods: from it on no answer is wanted.
pub const ROUGH: f64 = 1e-2;

/// The block Krylov basis and the projected operator, which grow step by step.
struct Krylov {
    /// size x `filled`, orthonormal. Room for all steps, which memory backs as they are taken: many are not.
    vectors: Mat<f64>,
    filled: usize,
    /// The operator projected on `vectors`, capacity x capacity.
    projected: Mat<f64>,
    /// Coupling of the last block to the next.
    coupling: Mat<f64>,
    next: Mat<f64>,
}

/// The `count` lowest eigenpairs (the constant included) to a relative residual of `tolerance`: functions at the
/// vertices, orthonormal in the mass.
///
/// # Errors
/// [`Error::Cancelled`], [`Error::Internal`].
pub fn eigenpairs(
    stiffness: &SymmetricSparse,
    mass: &[f64],
    count: usize,
    tolerance: f64,
    progress: &Progress,
) -> Result<RitzPairs> {
    progress.report("eigenfunctions", 0.04)?;
    let analysis = Analysis::new(stiffness)?;
    progress.report("eigenfunctions", 0.07)?;
    let operator = ShiftInvert::new(&analysis, stiffness, mass, super::SHIFT)?;
    progress.report("eigenfunctions", 0.1)?;
    Ok(operator.in_vertex_order(lanczos(&operator, count, tolerance, progress)?))
}

/// The same of a factorised operator, its rows in the order of elimination and times the square root of the mass.
fn lanczos(
    operator: &ShiftInvert<f64>,
    count: usize,
    tolerance: f64,
    progress: &Progress,
) -> Result<RitzPairs> {
    let rough = tolerance >= ROUGH;
    let first_check = (if rough { 3 * count / 2 } else { 2 * count }).div_ceil(BLOCK) + 2;
    // A rough answer is not worth a second look: the dense eigenvalue problem costs more than the steps.
    let more = if rough { 1 } else { 3 * count.div_ceil(BLOCK) + 12 };
    let steps = (operator.size() / BLOCK).min(first_check + more - 1);
    let mut krylov = Krylov::new(operator.scale(), steps)?;
    let mut accepted = None;
    for step in 0..steps {
        krylov.step(operator)?;
        progress.report("eigenfunctions", 0.1 + 0.3 * (step as f64 / first_check as f64).min(1.0))?;
        if step + 1 == steps || (step + 1 >= first_check && (step + 1 - first_check).is_multiple_of(2)) {
            let (inverse, coefficients, worst) = krylov.ritz_pairs(count)?;
            let values = inverse.iter().map(|inverse| 1.0 / inverse - operator.shift).collect();
            accepted = Some((values, coefficients));
            if worst < tolerance {
                break;
            }
        }
    }
    let (values, coefficients) =
        accepted.ok_or_else(|| Error::Internal("the Lanczos iteration took no step".into()))?;
    let basis = krylov.vectors.subcols(0, coefficients.nrows());
    Ok(RitzPairs { values, vectors: product(basis, coefficients.as_ref()) })
}

/// The columns of a transposed block one after another.
fn row_major(transposed: MatRef<f64>) -> Vec<f64> {
    let mut rows = Vec::with_capacity(transposed.nrows() * transposed.ncols());
    for row in transposed.col_iter() {
        rows.extend(row.iter());
    }
    rows
}

impl Krylov {
    fn new(scale: &[f64], steps: usize) -> Result<Krylov> {
        let size = scale.len();
        let capacity = steps * BLOCK;
        let mut random = 0x9E37_79B9_7F4A_7C15u64;
        // The constant function (known exactly) starts the first column.
        let mut next = Mat::from_fn(size, BLOCK, |i, j| {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            if j == 0 { scale[i] } else { (random >> 11) as f64 / (1u64 << 53) as f64 - 0.5 }
        });
        orthonormalise(&mut next)?;
        let projected = Mat::zeros(capacity, capacity);
        let coupling = Mat::zeros(BLOCK, BLOCK);
        Ok(Krylov { vectors: Mat::with_capacity(size, capacity), filled: 0, projected, coupling, next })
    }

    /// Appends `next` to the basis and makes the block after it.
    fn step(&mut self, operator: &ShiftInvert<f64>) -> Result<()> {
        let start = self.filled;
        self.filled += BLOCK;
        let next = &self.next;
        self.vectors.resize_with(next.nrows(), self.filled, |i, j| next[(i, j - start)]);
        if start > 0 {
            self.projected.submatrix_mut(start, start - BLOCK, BLOCK, BLOCK).copy_from(&self.coupling);
        }
        let mut rows = row_major(self.next.transpose());
        operator.apply(&mut rows, BLOCK);
        let mut image = MatRef::from_row_major_slice(&rows, operator.size(), BLOCK).to_owned();
        let basis = self.vectors.subcols(0, self.filled);
        for pass in 0..2 {
            let overlap = product(basis.transpose(), image.as_ref());
            subtract_product(image.as_mut(), basis, overlap.as_ref());
            if pass == 0 {
                let diagonal = overlap.submatrix(start, 0, BLOCK, BLOCK);
                self.projected.submatrix_mut(start, start, BLOCK, BLOCK).copy_from(diagonal);
            }
        }
        self.coupling = orthonormalise(&mut image)?;
        self.next = image;
        Ok(())
    }

    /// The `count` largest eigenvalues, their coefficients in the basis, and the worst relative residual.
    fn ritz_pairs(&self, count: usize) -> Result<(Vec<f64>, Mat<f64>, f64)> {
        let filled = self.filled;
        let lower = Mat::from_fn(filled, filled, |i, j| {
            let (i, j) = (i.max(j), i.min(j));
            if i / BLOCK == j / BLOCK {
                0.5 * (self.projected[(i, j)] + self.projected[(j, i)])
            } else {
                self.projected[(i, j)]
            }
        });
        let (inverse, vectors) = symmetric_eigen(lower.as_ref())?;
        let pick = |j: usize| filled - 1 - j;
        let coefficients = Mat::from_fn(filled, count, |i, j| vectors[(i, pick(j))]);
        let tail = coefficients.submatrix(filled - BLOCK, 0, BLOCK, count);
        let leak = product(self.coupling.as_ref(), tail);
        let worst = (0..count)
            .map(|j| leak.col(j).norm_l2() / inverse[pick(j)].max(f64::MIN_POSITIVE))
            .fold(0.0, f64::max);
        Ok(((0..count).map(|j| inverse[pick(j)]).collect(), coefficients, worst))
    }
}
