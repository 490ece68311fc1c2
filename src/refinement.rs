//! Refinement of a functional map on samples.
//!
//! ICP alternates nearest neighbours and re-estimation at fixed size (Ovsjanikov et al. 2012, section
//! 6.2); ZoomOut does the same while the size grows (S. Melzi, J. Ren, E. Rodola, A. Sharma, P. Wonka,
//! M. Ovsjanikov, "ZoomOut: Spectral Upsampling for Efficient Shape Correspondence", 2019, algorithm 1).

use crate::dense::product;
use crate::error::Result;
use crate::functional_map::{self, Projection};
use crate::sampling::Samples;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

/// Samples prepared for repeated estimation: their Gram matrix is formed once.
pub struct SampleRefiner<'a> {
    /// The samples.
    pub samples: &'a Samples,
    gram: Mat<f64>,
    single: Mat<f32>,
}

impl<'a> SampleRefiner<'a> {
    /// O(samples x count^2).
    pub fn new(samples: &'a Samples) -> Self {
        let rows = samples.rows.as_ref();
        let gram = product(rows.transpose(), rows);
        let single = Mat::from_fn(rows.nrows(), rows.ncols(), |i, j| rows[(i, j)] as f32);
        SampleRefiner { samples, gram, single }
    }

    /// The sample nearest to each sample's image under `map`.
    pub fn partners(&self, map: &Mat<f64>) -> Vec<u32> {
        let size = map.nrows();
        let rows = self.single.subcols(0, size);
        nearest(embed(rows, map).as_ref(), rows)
    }

    /// Least-squares map of `size` that sends each sample to `partners`.
    pub fn estimate(&self, partners: &[u32], size: usize, projection: Projection) -> Result<Mat<f64>> {
        functional_map::estimate(self.samples.rows.as_ref(), self.gram.as_ref(), partners, size, projection)
    }

    /// Alternates partners and estimation through `sizes`: equal sizes are ICP, growing ones ZoomOut.
    pub fn refine(&self, mut map: Mat<f64>, sizes: &[usize], projection: Projection) -> Result<Mat<f64>> {
        let largest = self.samples.rows.ncols();
        for &size in sizes {
            let partners = self.partners(&map);
            map = self.estimate(&partners, size.min(largest), projection)?;
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

/// For each row of `queries` the nearest row of `targets`, by tiles of a matrix product.
pub fn nearest(queries: MatRef<f32>, targets: MatRef<f32>) -> Vec<u32> {
    const QUERY_TILE: usize = 128;
    const TARGET_TILE: usize = 512;
    let half_norms = half_squared_norms(targets);
    let mut best = vec![(f32::MAX, 0u32); queries.nrows()];
    let mut tile = Mat::<f32>::zeros(TARGET_TILE, QUERY_TILE);
    for target_start in (0..targets.nrows()).step_by(TARGET_TILE) {
        let target_count = TARGET_TILE.min(targets.nrows() - target_start);
        let norms = &half_norms[target_start..target_start + target_count];
        for query_start in (0..queries.nrows()).step_by(QUERY_TILE) {
            let query_count = QUERY_TILE.min(queries.nrows() - query_start);
            let mut products = tile.as_mut().submatrix_mut(0, 0, target_count, query_count);
            let left = targets.subrows(target_start, target_count);
            let right = queries.subrows(query_start, query_count).transpose();
            matmul(products.as_mut(), Accum::Replace, left, right, 1.0, Par::Seq);
            for query in 0..query_count {
                let column = &tile.col_as_slice(query)[..target_count];
                let (value, index) = lowest(norms, column);
                let entry = &mut best[query_start + query];
                if value < entry.0 {
                    *entry = (value, (target_start + index) as u32);
                }
            }
        }
    }
    best.into_iter().map(|entry| entry.1).collect()
}

fn half_squared_norms(rows: MatRef<f32>) -> Vec<f32> {
    (0..rows.nrows())
        .map(|i| 0.5 * (0..rows.ncols()).map(|j| rows[(i, j)] * rows[(i, j)]).sum::<f32>())
        .collect()
}

/// Smallest `norms - products` and its first index.
fn lowest(norms: &[f32], products: &[f32]) -> (f32, usize) {
    const LANES: usize = 16;
    let mut lanes = [f32::MAX; LANES];
    let (norm_chunks, norm_rest) = norms.as_chunks::<LANES>();
    let (product_chunks, product_rest) = products.as_chunks::<LANES>();
    for (norm, product) in norm_chunks.iter().zip(product_chunks) {
        for lane in 0..LANES {
            let value = norm[lane] - product[lane];
            lanes[lane] = if value < lanes[lane] { value } else { lanes[lane] };
        }
    }
    let rest = norm_rest.iter().zip(product_rest).map(|(norm, product)| norm - product);
    let value = lanes.into_iter().chain(rest).fold(f32::MAX, f32::min);
    let index = norms.iter().zip(products).position(|(norm, product)| norm - product <= value);
    (value, index.unwrap_or(0))
}
