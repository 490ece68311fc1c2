//! `B = sqrt(M) (K + shift M)^-1 sqrt(M) = (M^-1/2 K M^-1/2 + shift)^-1` of a stiffness K and a lumped mass M, whose
//! largest eigenpairs are sought.
//!
//! If `B y = y / (eigenvalue + shift)`, then `phi = y / sqrt(M)` solves `K phi = eigenvalue M phi`.

use super::RitzPairs;
use crate::base::error::Result;
use crate::spectral::laplacian::SymmetricSparse;
use crate::spectral::sparse_cholesky::{Analysis, Factor, Scalar};
use faer::Mat;

/// The operator, its rows in the order of elimination.
pub struct ShiftInvert<'a, T> {
    factor: Factor<'a, T>,
    /// Square root of the mass.
    scale: Vec<f64>,
    /// What makes `K + shift M` positive definite.
    pub shift: f64,
}

impl<'a, T: Scalar> ShiftInvert<'a, T> {
    /// Factorises `stiffness + shift mass`.
    ///
    /// # Errors
    /// [`crate::Error::Internal`] if the factorisation breaks down.
    pub fn new(
        analysis: &'a Analysis,
        stiffness: &SymmetricSparse,
        mass: &[f64],
        shift: f64,
    ) -> Result<Self> {
        let roots: Vec<f64> = mass.iter().map(|mass| mass.sqrt()).collect();
        let factor = analysis.factorise(stiffness, shift, &roots)?;
        let scale = analysis.order.iter().map(|&i| roots[i as usize]).collect();
        Ok(ShiftInvert { factor, scale, shift })
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.scale.len()
    }

    /// Square root of the mass, in the order of elimination.
    pub fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// The vertex of each row.
    pub fn order(&self) -> &[u32] {
        &self.factor.analysis().order
    }

    /// The row of each vertex.
    pub fn places(&self) -> Vec<u32> {
        let mut places = vec![0; self.size()];
        for (row, &vertex) in (0..).zip(self.order()) {
            places[vertex as usize] = row;
        }
        places
    }

    /// Replaces `block` (size x width, row by row) by B times it.
    pub fn apply(&self, block: &mut [T], width: usize) {
        self.factor.solve(block, width);
    }

    /// The functions at the vertices, from scaled vectors in the order of elimination.
    pub fn in_vertex_order(&self, pairs: RitzPairs) -> RitzPairs {
        let places = self.places();
        let vectors = Mat::from_fn(self.size(), pairs.vectors.ncols(), |i, j| {
            let row = places[i] as usize;
            pairs.vectors[(row, j)] / self.scale[row]
        });
        RitzPairs { vectors, ..pairs }
    }
}
