//! Lowest eigenpairs of the Laplacian: `stiffness * phi = eigenvalue * lumped_mass * phi`.
//!
//! Two ways: `lanczos`, as accurate as asked for, and `nested_iteration`, several times faster and as
//! accurate as a map needs (`docs/speed.md` has what was measured). Small problems are solved densely.

mod coarsening;
mod lanczos;
mod nested_iteration;
mod shift_invert;

use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::spectral::dense::symmetric_eigen;
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::sparse_cholesky::Analysis;
use faer::Mat;
use std::sync::{Arc, OnceLock};

/// Makes `stiffness + SHIFT * mass` positive definite, on a surface of unit area.
const SHIFT: f64 = 10.0;
/// Largest relative residual that [`Eigenbasis::exact`] leaves.
const TOLERANCE: f64 = 1e-7;
/// Below this many vertices the dense solver is used.
const DENSE_LIMIT: usize = 300;

/// Approximate eigenpairs on the way, the constant included.
#[derive(Debug, Clone)]
struct RitzPairs {
    /// Eigenvalues of the Laplacian, ascending.
    values: Vec<f64>,
    /// size x width.
    vectors: Mat<f64>,
}

impl RitzPairs {
    /// The functions row by row.
    fn rows(&self) -> Vec<f32> {
        let width = self.vectors.ncols();
        let mut rows = vec![0.0; self.vectors.nrows() * width];
        for (j, column) in self.vectors.col_iter().enumerate() {
            rows[j..]
                .iter_mut()
                .step_by(width)
                .zip(column.iter())
                .for_each(|(row, value)| *row = *value as f32);
        }
        rows
    }
}

/// The lowest eigenpairs, the constant function left out.
#[derive(Debug, Clone)]
pub struct Eigenbasis {
    /// Ascending, for unit area (Neumann conditions at boundaries). A sphere has `4 pi l (l + 1)`.
    pub eigenvalues: Vec<f64>,
    /// vertices x count; columns orthonormal in `lumped_mass`. The sign of a column has no meaning.
    pub eigenfunctions: Mat<f64>,
}

impl Eigenbasis {
    /// Computes the `count` lowest non-constant eigenpairs, or as many as there are vertices less one, as exactly as a map needs: the
    /// lower half of the eigenvalues to about 1e-5, the last to about 1e-2. On at most `threads` threads.
    ///
    /// Cost: one sparse Cholesky factorisation (about O(n^1.5)) and O(n count^2).
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`]; [`crate::Error::Internal`] if the factorisation breaks down.
    pub fn new(
        surface: &IntrinsicSurface,
        count: usize,
        threads: usize,
        progress: &Progress,
    ) -> Result<Eigenbasis> {
        Eigenbasis::solved(surface, count, |count| {
            nested_iteration::eigenpairs(surface, count, threads, progress)
        })
    }

    /// The same to relative residuals below 1e-7, on one thread.
    ///
    /// # Errors
    /// As [`Eigenbasis::new`].
    pub fn exact(surface: &IntrinsicSurface, count: usize, progress: &Progress) -> Result<Eigenbasis> {
        Eigenbasis::solved(surface, count, |count| {
            lanczos::eigenpairs(&surface.stiffness, &surface.lumped_mass, count, TOLERANCE, progress)
        })
    }

    /// By a dense solver, or a `sparse` one that is given how many pairs it should find, the constant included.
    fn solved(
        surface: &IntrinsicSurface,
        count: usize,
        sparse: impl FnOnce(usize) -> Result<RitzPairs>,
    ) -> Result<Eigenbasis> {
        let size = surface.vertex_count();
        let count = count.min(size.saturating_sub(1));
        let is_small = size <= DENSE_LIMIT.max(count + 4 * lanczos::BLOCK);
        let pairs = if is_small { dense_eigenpairs(surface, count + 1)? } else { sparse(count + 1)? };
        Ok(Eigenbasis::of(&pairs, count))
    }

    /// The `count` lowest eigenpairs of a deformed surface, from a `start` of another shape of it. Several times
    /// faster than [`Eigenbasis::new`], and as exact as long as the shapes are alike.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`]; [`crate::Error::Internal`] if the factorisation breaks down.
    pub fn continued(
        surface: &IntrinsicSurface,
        start: &Start,
        count: usize,
        threads: usize,
        progress: &Progress,
    ) -> Result<Eigenbasis> {
        start.share_analysis(surface)?;
        let pairs = nested_iteration::continued(surface, start.functions.as_ref(), threads, progress)?;
        Ok(Eigenbasis::of(&pairs, count))
    }

    fn of(pairs: &RitzPairs, count: usize) -> Eigenbasis {
        let eigenvalues = pairs.values[1..=count].iter().map(|value| value.max(0.0)).collect();
        let eigenfunctions = pairs.vectors.subcols(1, count).to_owned();
        Eigenbasis { eigenvalues, eigenfunctions }
    }

    /// The first `count` eigenpairs, or all if there are fewer.
    pub fn truncated(&self, count: usize) -> Eigenbasis {
        let count = count.min(self.count());
        Eigenbasis {
            eigenvalues: self.eigenvalues[..count].to_vec(),
            eigenfunctions: self.eigenfunctions.subcols(0, count).to_owned(),
        }
    }

    /// The first `count` eigenpairs, or all if there are fewer, at some `vertices` alone, where they are not orthonormal.
    pub fn at(&self, vertices: &[u32], count: usize) -> Eigenbasis {
        let count = count.min(self.count());
        let value = |i: usize, j: usize| self.eigenfunctions[(vertices[i] as usize, j)];
        let eigenfunctions = Mat::from_fn(vertices.len(), count, value);
        Eigenbasis { eigenvalues: self.eigenvalues[..count].to_vec(), eigenfunctions }
    }

    /// `|stiffness phi - eigenvalue mass phi|` of each in the norm of `mass^-1`, relative to `eigenvalue + 10`.
    pub fn residuals(&self, surface: &IntrinsicSurface) -> Vec<f64> {
        let residual = |j: usize| {
            let (function, value) = (self.eigenfunctions.col_as_slice(j), self.eigenvalues[j]);
            let squared = |i: usize| {
                let image: f64 = surface.stiffness.row(i).map(|(k, entry)| entry * function[k]).sum();
                (image - value * surface.lumped_mass[i] * function[i]).powi(2) / surface.lumped_mass[i]
            };
            (0..function.len()).map(squared).sum::<f64>().sqrt() / (value + SHIFT)
        };
        (0..self.count()).map(residual).collect()
    }

    /// Number of eigenfunctions.
    pub fn count(&self) -> usize {
        self.eigenvalues.len()
    }
}

/// What the eigenpairs of a deformed surface start from: eigenfunctions of another shape of it, and the analysis of its
/// connectivity, made when it is first needed.
#[derive(Debug)]
pub struct Start {
    /// vertices x functions, the constant left out.
    functions: Mat<f32>,
    analysis: OnceLock<Arc<Analysis>>,
}

impl Start {
    /// For `count` pairs, from a shape's `basis`; `None` if that has not [`Start::functions`] of so many, or few vertices,
    /// which need no start.
    pub fn new(basis: &Eigenbasis, count: usize) -> Option<Start> {
        let (vertices, width) = (basis.eigenfunctions.nrows(), Start::functions(count));
        if basis.count() < width || vertices <= DENSE_LIMIT.max(width + 4 * lanczos::BLOCK) {
            return None;
        }
        let functions = Mat::from_fn(vertices, width, |i, j| basis.eigenfunctions[(i, j)] as f32);
        Some(Start { functions, analysis: OnceLock::new() })
    }

    /// Functions that a start for `count` pairs has: some more.
    pub fn functions(count: usize) -> usize {
        nested_iteration::width(count + 1) - 1
    }

    /// One analysis for all shapes.
    fn share_analysis(&self, surface: &IntrinsicSurface) -> Result<()> {
        match self.analysis.get() {
            Some(analysis) => surface.set_analysis(analysis),
            None => drop(self.analysis.set(surface.analysis()?.clone())),
        }
        Ok(())
    }
}

/// The problem with the mass scaled away, by a dense solver.
fn dense_eigenpairs(surface: &IntrinsicSurface, count: usize) -> Result<RitzPairs> {
    let scale: Vec<f64> = surface.lumped_mass.iter().map(|mass| mass.sqrt().recip()).collect();
    let size = scale.len();
    let mut matrix = Mat::<f64>::zeros(size, size);
    for i in 0..size {
        for (j, value) in surface.stiffness.row(i) {
            matrix[(i, j)] = value * scale[i] * scale[j];
        }
    }
    let (values, vectors) = symmetric_eigen(matrix.as_ref())?;
    let vectors = Mat::from_fn(size, count, |i, j| vectors[(i, j)] * scale[i]);
    Ok(RitzPairs { values: values[..count].to_vec(), vectors })
}
