//! Refinement of a functional map on samples.
//!
//! ICP alternates nearest neighbours and re-estimation at fixed size (Ovsjanikov et al. 2012, section
//! 6.2); ZoomOut does the same while the size grows (S. Melzi, J. Ren, E. Rodola, A. Sharma, P. Wonka,
//! M. Ovsjanikov, "ZoomOut: Spectral Upsampling for Efficient Shape Correspondence", 2019, algorithm 1).

use crate::base::error::Result;
use crate::search::functional_map::{self, Projection};
use crate::spectral::dense::{gram_cholesky, product};
use crate::spectral::sampling::Samples;
use crate::spectral::twin_parts::{CODE, TwinParts, code};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use pulp::{Arch, Simd, WithSimd};

/// Samples prepared for repeated estimation: their Gram matrix is formed and factorised once.
pub struct SampleRefiner {
    /// The samples.
    pub samples: Samples,
    /// Cholesky factor of the Gram matrix.
    lower: Mat<f64>,
    single: Mat<f32>,
}

impl SampleRefiner {
    /// O(samples x count^2).
    ///
    /// # Errors
    /// [`crate::Error::Internal`] if the samples' rows are not numbers.
    pub fn new(samples: Samples) -> Result<Self> {
        let rows = samples.rows.as_ref();
        let lower = gram_cholesky(product(rows.transpose(), rows).as_ref())?;
        let single = Mat::from_fn(rows.nrows(), rows.ncols(), |i, j| rows[(i, j)] as f32);
        Ok(SampleRefiner { samples, lower, single })
    }

    /// The sample nearest to each sample's image under `map`.
    pub fn partners(&self, map: &Mat<f64>) -> Vec<u32> {
        let rows = self.single.subcols(0, map.nrows());
        nearest_of_twins(self.samples.parts.as_ref(), embed(rows, map).as_ref(), rows)
    }

    /// Least-squares map of `size` that sends each sample to `partners`.
    pub fn estimate(&self, partners: &[u32], size: usize, projection: Projection) -> Result<Mat<f64>> {
        functional_map::estimate(self.samples.rows.as_ref(), self.lower.as_ref(), partners, size, projection)
    }

    /// Alternates partners and estimation through `sizes`: equal sizes are ICP, growing ones ZoomOut.
    pub fn refine(&self, mut map: Mat<f64>, sizes: &[usize], projection: Projection) -> Result<Mat<f64>> {
        let largest = self.samples.rows.ncols();
        let (mut partners, mut last, mut settled) = (self.partners(&map), 0, false);
        for size in sizes.iter().map(|&size| size.min(largest)) {
            if settled && size == last {
                continue;
            }
            map = self.estimate(&partners, size, projection)?;
            let next = self.partners(&map);
            (settled, last, partners) = (next == partners, size, next);
        }
        Ok(map)
    }
}

/// `rows * map` in single precision.
pub fn embed(rows: MatRef<f32>, map: &Mat<f64>) -> Mat<f32> {
    let map = Mat::from_fn(map.nrows(), map.ncols(), |i, j| map[(i, j)] as f32);
    let mut out = Mat::zeros(rows.nrows(), map.ncols());
    matmul(out.as_mut(), Accum::Replace, rows, map.as_ref(), 1.0, Par::Seq);
    out
}

/// [`nearest`] of samples; where these have parts, among those in the twin of a query's part.
pub fn nearest_of_twins(parts: Option<&TwinParts>, queries: MatRef<f32>, targets: MatRef<f32>) -> Vec<u32> {
    let beside = |parts: &[u8], rows: MatRef<f32>| {
        Mat::from_fn(rows.nrows(), CODE + rows.ncols(), |i, j| match j.checked_sub(CODE) {
            Some(j) => rows[(i, j)],
            None => code(parts[i])[j],
        })
    };
    match parts {
        None => nearest(queries, targets),
        Some(TwinParts { own, twin }) => {
            nearest(beside(twin, queries).as_ref(), beside(own, targets).as_ref())
        }
    }
}

/// For each row of `queries` the nearest row of `targets`, the first of equals. O(queries x targets x columns).
pub fn nearest(queries: MatRef<f32>, targets: MatRef<f32>) -> Vec<u32> {
    Arch::new().dispatch(Nearest { queries, targets })
}

/// Queries that are compared at once with a vector register of targets.
const GROUP: usize = 8;

/// Smallest `|target|^2 / 2 - query . target` of each query, compiled for each instruction set.
struct Nearest<'a> {
    queries: MatRef<'a, f32>,
    targets: MatRef<'a, f32>,
}

impl WithSimd for Nearest<'_> {
    type Output = Vec<u32>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<u32> {
        let (columns, count) = (self.queries.ncols(), self.targets.nrows().next_multiple_of(S::F32_LANES));
        // The negated targets by chunks of as many as a register holds, each column by column.
        let mut values = vec![0.0; count * columns];
        let mut norms = vec![0.0; self.targets.nrows()];
        for (j, column) in self.targets.col_iter().enumerate() {
            for (i, value) in column.iter().enumerate() {
                values[(i / S::F32_LANES * columns + j) * S::F32_LANES + i % S::F32_LANES] = -value;
                norms[i] += value * value;
            }
        }
        norms.iter_mut().for_each(|norm| *norm *= 0.5);
        norms.resize(count, f32::INFINITY);
        let (targets, norms) = (S::as_simd_f32s(&values).0, S::as_simd_f32s(&norms).0);
        let mut partners = Vec::with_capacity(self.queries.nrows() + GROUP);
        let mut group = vec![[0.0; GROUP]; columns];
        for start in (0..self.queries.nrows()).step_by(GROUP) {
            for (j, values) in group.iter_mut().enumerate() {
                for (q, value) in values.iter_mut().enumerate() {
                    *value = self.queries[((start + q).min(self.queries.nrows() - 1), j)];
                }
            }
            let mut lowest = [simd.splat_f32s(f32::INFINITY); GROUP];
            let mut chunk_of = [simd.splat_u32s(0); GROUP];
            for (chunk, norm) in norms.iter().enumerate() {
                let mut distances = [*norm; GROUP];
                for (values, target) in group.iter().zip(&targets[chunk * columns..][..columns]) {
                    for q in 0..GROUP {
                        distances[q] = simd.mul_add_e_f32s(simd.splat_f32s(values[q]), *target, distances[q]);
                    }
                }
                let own = simd.splat_u32s(chunk as u32);
                for q in 0..GROUP {
                    let less = simd.less_than_f32s(distances[q], lowest[q]);
                    lowest[q] = simd.select_f32s(less, distances[q], lowest[q]);
                    chunk_of[q] = simd.select_u32s(less, own, chunk_of[q]);
                }
            }
            for q in 0..GROUP {
                let (values, chunks) =
                    (pulp::bytemuck::bytes_of(&lowest[q]), pulp::bytemuck::bytes_of(&chunk_of[q]));
                partners.push(first_lowest(
                    pulp::bytemuck::cast_slice(values),
                    pulp::bytemuck::cast_slice(chunks),
                ));
            }
        }
        partners.truncate(self.queries.nrows());
        partners
    }
}

/// The first row among the smallest of all lanes.
fn first_lowest(values: &[f32], chunks: &[u32]) -> u32 {
    let lanes = values.len() as u32;
    let rows =
        values.iter().zip(chunks).zip(0..).map(|((value, chunk), lane)| (*value, chunk * lanes + lane));
    let first = |a: (f32, u32), b: (f32, u32)| if b.0 < a.0 || (b.0 == a.0 && b.1 < a.1) { b } else { a };
    rows.reduce(first).expect("lanes").1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_is_the_first_of_equals_at_any_count() {
        let rows = |count: usize, columns: usize, step: usize| {
            Mat::from_fn(count, columns, |i, j| ((i * step + j * 5) % 7) as f32)
        };
        for (sources, count, columns) in [(1, 1, 1), (3, 15, 2), (4, 16, 5), (5, 17, 30), (130, 600, 12)] {
            let (queries, targets) = (rows(sources, columns, 3), rows(count, columns, 4));
            let away = |i: usize, k: usize| -> f32 {
                (0..columns).map(|j| (queries[(i, j)] - targets[(k, j)]).powi(2)).sum()
            };
            let first =
                |i: usize| (0..count).fold(0, |best, k| if away(i, k) < away(i, best) { k } else { best });
            let expected: Vec<u32> = (0..sources).map(|i| first(i) as u32).collect();
            assert_eq!(nearest(queries.as_ref(), targets.as_ref()), expected, "{count} x {columns}");
        }
    }
}
