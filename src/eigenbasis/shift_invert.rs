//! `B = sqrt(M) (K + shift M)^-1 sqrt(M)` of a stiffness K and a lumped mass M, whose largest eigenpairs are sought.
//!
//! If `B y = y / (eigenvalue + shift)`, then `phi = y / sqrt(M)` solves `K phi = eigenvalue M phi`.

use super::RitzPairs;
use crate::error::Result;
use crate::laplacian::SymmetricSparse;
use crate::sparse_cholesky::{Analysis, Factor};

/// The operator, its rows in the order of elimination.
pub struct ShiftInvert<'a> {
    factor: Factor<'a>,
    /// Square root of the mass.
    scale: Vec<f64>,
    /// What makes `K + shift M` positive definite.
    pub shift: f64,
}

impl<'a> ShiftInvert<'a> {
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
        let factor = analysis.factorise(stiffness, shift, mass)?;
        let scale = analysis.order.iter().map(|&i| mass[i as usize].sqrt()).collect();
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

    /// Replaces `block` (size x width, row by row) by B times it.
    pub fn apply(&self, block: &mut [f64], width: usize) {
        self.scale_rows(block, width);
        self.factor.solve(block, width);
        self.scale_rows(block, width);
    }

    /// The functions at the vertices, from scaled vectors in the order of elimination.
    pub fn in_vertex_order(&self, pairs: RitzPairs) -> RitzPairs {
        let mut vectors = vec![0.0; pairs.vectors.len()];
        for ((row, &vertex), scale) in
            pairs.vectors.chunks_exact(pairs.width).zip(self.order()).zip(&self.scale)
        {
            let to = &mut vectors[vertex as usize * pairs.width..][..pairs.width];
            for (value, entry) in to.iter_mut().zip(row) {
                *value = entry / scale;
            }
        }
        RitzPairs { vectors, ..pairs }
    }

    fn scale_rows(&self, block: &mut [f64], width: usize) {
        for (row, scale) in block.chunks_exact_mut(width).zip(&self.scale) {
            row.iter_mut().for_each(|value| *value *= scale);
        }
    }
}
