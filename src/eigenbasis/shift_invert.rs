//! `B = sqrt(M) (K + shift M)^-1 sqrt(M) = (M^-1/2 K M^-1/2 + shift)^-1` of a stiffness K and a lumped mass M, whose
//! largest eigenpairs are sought.
//!
//! If `B y = y / (eigenvalue + shift)`, then `phi = y / sqrt(M)` solves `K phi = eigenvalue M phi`.

use super::RitzPairs;
use crate::error::Result;
use crate::laplacian::SymmetricSparse;
use crate::sparse_cholesky::{Analysis, Factor};
use crate::threads;

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

    /// Replaces `block` (size x width, row by row) by B times it.
    pub fn apply(&self, block: &mut [f64], width: usize) {
        self.factor.solve(block, width);
    }

    /// The functions at the vertices, from scaled vectors in the order of elimination; on at most `threads` threads.
    pub fn in_vertex_order(&self, pairs: RitzPairs, threads: usize) -> RitzPairs {
        let mut place = vec![0; self.size()];
        for (row, &vertex) in self.order().iter().enumerate() {
            place[vertex as usize] = row;
        }
        let mut vectors = vec![0.0; pairs.vectors.len()];
        let at_once = self.size().div_ceil(threads.max(1)).max(1);
        let parts = vectors.chunks_mut(at_once * pairs.width).zip(place.chunks(at_once)).collect();
        threads::map(threads, parts, |(out, places): (&mut [f64], &[usize])| {
            for (out, &row) in out.chunks_exact_mut(pairs.width).zip(places) {
                let scale = self.scale[row];
                for (value, entry) in out.iter_mut().zip(&pairs.vectors[row * pairs.width..]) {
                    *value = entry / scale;
                }
            }
        });
        RitzPairs { vectors, ..pairs }
    }
}
