//! Lowest eigenpairs of the Laplacian: `stiffness * phi = eigenvalue * lumped_mass * phi`.
//!
//! Shift-invert block Lanczos with full reorthogonalisation (two passes): R. G. Grimes, J. G. Lewis,
//! H. D. Simon, "A Shifted Block Lanczos Algorithm for Solving Sparse Symmetric Generalized
//! Eigenproblems", 1994. The mass is scaled away (`y = sqrt(mass) * phi`), so that the inner product
//! is the ordinary one. Small problems are solved densely.

use crate::dense::{orthonormalise, product, subtract_product, symmetric_eigen};
use crate::error::{Error, Result};
use crate::laplacian::IntrinsicSurface;
use crate::progress::Progress;
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

/// Shift that makes `stiffness + SHIFT * mass` positive definite, on a surface of unit area.
const SHIFT: f64 = 10.0;
/// Vectors of a Lanczos block: bounds the multiplicity that is found without rounding's help.
const BLOCK: usize = 12;
/// Largest relative residual that is accepted without more Lanczos steps.
const TOLERANCE: f64 = 1e-7;
/// Below this many vertices the dense solver is used.
const DENSE_LIMIT: usize = 300;

/// The lowest eigenpairs, the constant function left out.
#[derive(Debug, Clone)]
pub struct Eigenbasis {
    /// Ascending, for unit area (Neumann conditions at boundaries). A sphere has `4 pi l (l + 1)`.
    pub eigenvalues: Vec<f64>,
    /// vertices x count; columns orthonormal in `lumped_mass`. The sign of a column has no meaning.
    pub eigenfunctions: Mat<f64>,
    /// `|stiffness phi - eigenvalue mass phi|` in the norm of `mass^-1`, relative to `eigenvalue + 10`.
    pub residuals: Vec<f64>,
}

impl Eigenbasis {
    /// Computes the `count` lowest non-constant eigenpairs, or as many as there are vertices less one.
    ///
    /// Cost: one sparse Cholesky factorisation (about O(n^1.5)) and O(n count^2).
    ///
    /// # Errors
    /// [`Error::Cancelled`]; [`Error::Internal`] if the factorisation breaks down.
    pub fn new(surface: &IntrinsicSurface, count: usize, progress: &Progress) -> Result<Eigenbasis> {
        let size = surface.vertex_count();
        let count = count.min(size.saturating_sub(1));
        let scale: Vec<f64> = surface.lumped_mass.iter().map(|mass| 1.0 / mass.sqrt()).collect();
        let (values, vectors) = if size <= DENSE_LIMIT.max(count + 4 * BLOCK) {
            dense_eigenpairs(surface, &scale, count + 1)?
        } else {
            lanczos(surface, &scale, count + 1, progress)?
        };
        let eigenfunctions = Mat::from_fn(size, count, |i, j| vectors[(i, j + 1)] * scale[i]);
        let eigenvalues = values[1..=count].iter().map(|value| value.max(0.0)).collect();
        let mut basis = Eigenbasis { eigenvalues, eigenfunctions, residuals: Vec::new() };
        basis.residuals = residuals(surface, &basis);
        Ok(basis)
    }

    /// Number of eigenfunctions.
    pub fn count(&self) -> usize {
        self.eigenvalues.len()
    }
}

/// The symmetric problem with the mass scaled away, by a dense solver.
fn dense_eigenpairs(surface: &IntrinsicSurface, scale: &[f64], count: usize) -> Result<(Vec<f64>, Mat<f64>)> {
    let size = scale.len();
    let mut matrix = Mat::<f64>::zeros(size, size);
    for i in 0..size {
        for (j, value) in surface.stiffness.row(i) {
            matrix[(i, j)] = value * scale[i] * scale[j];
        }
    }
    let (values, vectors) = symmetric_eigen(matrix.as_ref())?;
    Ok((values[..count].to_vec(), vectors.subcols(0, count).to_owned()))
}

/// `x -> scale^-1 (stiffness + SHIFT mass)^-1 scale^-1 x`, whose largest eigenpairs are sought.
struct InverseOperator<'a> {
    factor: faer::sparse::linalg::solvers::Llt<u32, f64>,
    scale: &'a [f64],
}

impl<'a> InverseOperator<'a> {
    fn new(surface: &IntrinsicSurface, scale: &'a [f64]) -> Result<Self> {
        let size = scale.len();
        let mut triplets = Vec::with_capacity(surface.stiffness.columns.len() / 2 + size);
        for i in 0..size {
            for (j, value) in surface.stiffness.row(i).filter(|(j, _)| *j <= i) {
                let shifted = if i == j { value + SHIFT * surface.lumped_mass[i] } else { value };
                triplets.push(Triplet::new(i as u32, j as u32, shifted));
            }
        }
        let matrix = SparseColMat::<u32, f64>::try_new_from_triplets(size, size, &triplets)
            .map_err(|error| Error::Internal(format!("assembling the shifted stiffness: {error:?}")))?;
        let factor = matrix
            .sp_cholesky(Side::Lower)
            .map_err(|error| Error::Internal(format!("factorising the shifted stiffness: {error:?}")))?;
        Ok(InverseOperator { factor, scale })
    }

    fn apply(&self, block: &mut Mat<f64>) {
        self.unscale(block);
        self.factor.solve_in_place(block.as_mut());
        self.unscale(block);
    }

    fn unscale(&self, block: &mut Mat<f64>) {
        for j in 0..block.ncols() {
            for (value, scale) in block.col_as_slice_mut(j).iter_mut().zip(self.scale) {
                *value /= scale;
            }
        }
    }
}

/// The block Krylov basis and the projected operator, which grow step by step.
struct Krylov {
    /// size x capacity; the first `filled` columns are orthonormal.
    vectors: Mat<f64>,
    filled: usize,
    /// The operator projected on `vectors`, capacity x capacity.
    projected: Mat<f64>,
    /// Coupling of the last block to the next.
    coupling: Mat<f64>,
    next: Mat<f64>,
}

fn lanczos(
    surface: &IntrinsicSurface,
    scale: &[f64],
    count: usize,
    progress: &Progress,
) -> Result<(Vec<f64>, Mat<f64>)> {
    let operator = InverseOperator::new(surface, scale)?;
    progress.report("eigenfunctions", 0.1)?;
    let first_check = (2 * count).div_ceil(BLOCK) + 2;
    let steps = (scale.len() / BLOCK).min(first_check + 3 * count.div_ceil(BLOCK) + 12);
    let mut krylov = Krylov::new(scale, steps)?;
    let mut accepted = None;
    for step in 0..steps {
        krylov.step(&operator)?;
        progress.report("eigenfunctions", 0.1 + 0.3 * (step as f64 / first_check as f64).min(1.0))?;
        if step + 1 == steps || (step + 1 >= first_check && (step + 1 - first_check).is_multiple_of(2)) {
            let (values, vectors, worst) = krylov.ritz_pairs(count)?;
            accepted = Some((values, vectors));
            if worst < TOLERANCE {
                break;
            }
        }
    }
    let (values, coefficients) =
        accepted.ok_or_else(|| Error::Internal("the Lanczos iteration took no step".into()))?;
    let vectors = product(krylov.vectors.subcols(0, coefficients.nrows()), coefficients.as_ref());
    Ok((values, vectors))
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
            if j == 0 { 1.0 / scale[i] } else { (random >> 11) as f64 / (1u64 << 53) as f64 - 0.5 }
        });
        orthonormalise(&mut next)?;
        let projected = Mat::zeros(capacity, capacity);
        let coupling = Mat::zeros(BLOCK, BLOCK);
        Ok(Krylov { vectors: Mat::zeros(size, capacity), filled: 0, projected, coupling, next })
    }

    /// Appends `next` to the basis and makes the block after it.
    fn step(&mut self, operator: &InverseOperator) -> Result<()> {
        let start = self.filled;
        self.filled += BLOCK;
        self.vectors.subcols_mut(start, BLOCK).copy_from(&self.next);
        if start > 0 {
            self.projected.submatrix_mut(start, start - BLOCK, BLOCK, BLOCK).copy_from(&self.coupling);
        }
        let mut image = self.next.clone();
        operator.apply(&mut image);
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

    /// The `count` lowest eigenvalues, their coefficients in the basis, and the worst relative residual.
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
        let values = (0..count).map(|j| 1.0 / inverse[pick(j)] - SHIFT).collect();
        Ok((values, coefficients, worst))
    }
}

fn residuals(surface: &IntrinsicSurface, basis: &Eigenbasis) -> Vec<f64> {
    (0..basis.count())
        .map(|j| {
            let function = basis.eigenfunctions.col_as_slice(j);
            let value = basis.eigenvalues[j];
            let squared: f64 = (0..function.len())
                .map(|i| {
                    let image: f64 = surface.stiffness.row(i).map(|(k, entry)| entry * function[k]).sum();
                    (image - value * surface.lumped_mass[i] * function[i]).powi(2) / surface.lumped_mass[i]
                })
                .sum();
            squared.sqrt() / (value + SHIFT)
        })
        .collect()
}
