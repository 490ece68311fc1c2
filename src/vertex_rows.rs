//! What images are sought by: mean curvature and eigenfunctions of points in single precision, a row a point.

use crate::eigenbasis::Eigenbasis;
use crate::laplacian::IntrinsicSurface;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Weight of the mean curvature beside the eigenfunctions, whose squares have mean 1 each (`docs/method.md`).
const CURVATURE_WEIGHT: f64 = 8.0;

/// What images are sought by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guide {
    /// Eigenfunctions alone.
    Eigenfunctions,
    /// Mean curvature beside them, where source and target have it.
    MeanCurvature,
}

/// Rows of points: weighted mean curvature (no column where the surface has none), then eigenfunctions.
pub struct VertexRows {
    values: Vec<f32>,
    width: usize,
    curvature_columns: usize,
    arch: Arch,
}

impl VertexRows {
    /// The rows of all vertices. O(vertices x eigenfunctions).
    pub fn new(surface: &IntrinsicSurface, basis: &Eigenbasis) -> VertexRows {
        let (curvature, functions) = (&surface.mean_curvature, &basis.eigenfunctions);
        let mut rows = VertexRows::zero(functions.nrows(), curvature.len(), functions.ncols());
        for (row, vertex) in rows.values.chunks_exact_mut(rows.width.max(1)).zip(0..) {
            for (value, column) in row.iter_mut().zip(curvature) {
                *value = (CURVATURE_WEIGHT * column[vertex]) as f32;
            }
        }
        // By blocks of rows, which stay in the cache while the columns are read one after the other.
        const BLOCK: usize = 64;
        for (block, rows_of_block) in rows.values.chunks_mut(BLOCK * rows.width.max(1)).enumerate() {
            for j in 0..functions.ncols() {
                let column = &functions.col_as_slice(j)[block * BLOCK..];
                for (row, value) in rows_of_block.chunks_exact_mut(rows.width).zip(column) {
                    row[curvature.len() + j] = *value as f32;
                }
            }
        }
        rows
    }

    fn zero(count: usize, curvature_columns: usize, functions: usize) -> VertexRows {
        let width = curvature_columns + functions;
        VertexRows { values: vec![0.0; count * width], width, curvature_columns, arch: Arch::new() }
    }

    /// The rows of some vertices.
    pub fn at(&self, vertices: &[u32]) -> VertexRows {
        let mut values = Vec::with_capacity(vertices.len() * self.width);
        for &vertex in vertices {
            values.extend_from_slice(self.row(vertex as usize));
        }
        VertexRows { values, ..*self }
    }

    /// At each of `points` (three rows and their weights) the weighted sum of the rows.
    pub fn combined(&self, points: impl ExactSizeIterator<Item = ([u32; 3], [f32; 3])>) -> VertexRows {
        let mut values = vec![0.0; points.len() * self.width];
        for (out, (corners, weights)) in values.chunks_exact_mut(self.width.max(1)).zip(points) {
            for (corner, weight) in corners.into_iter().zip(weights) {
                for (out, value) in out.iter_mut().zip(self.row(corner as usize)) {
                    *out += weight * value;
                }
            }
        }
        VertexRows { values, ..*self }
    }

    /// The same points with their eigenfunctions under `map` (size x size): `functions * map`.
    pub fn mapped(&self, map: &Mat<f64>) -> VertexRows {
        let (count, size) = (self.count(), map.ncols());
        let mut mapped = VertexRows::zero(count, self.curvature_columns, size);
        for (out, row) in mapped.values.chunks_exact_mut(mapped.width.max(1)).zip(0..) {
            out[..self.curvature_columns].copy_from_slice(&self.row(row)[..self.curvature_columns]);
        }
        let map = Mat::from_fn(map.nrows(), size, |i, j| map[(i, j)] as f32);
        let width = mapped.width;
        let all = MatMut::from_row_major_slice_mut(&mut mapped.values, count, width);
        let out = all.subcols_mut(self.curvature_columns, size);
        matmul(out, Accum::Replace, self.functions(map.nrows()), map.as_ref(), 1.0, Par::Seq);
        mapped
    }

    /// Multiplies each row by its factor.
    pub fn scale_rows(&mut self, factors: &[f64]) {
        for (row, factor) in self.values.chunks_exact_mut(self.width.max(1)).zip(factors) {
            row.iter_mut().for_each(|value| *value *= *factor as f32);
        }
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.values.len() / self.width.max(1)
    }

    /// The leading `size` eigenfunctions: points x size.
    pub fn functions(&self, size: usize) -> MatRef<'_, f32> {
        MatRef::from_row_major_slice(&self.values, self.count(), self.width)
            .subcols(self.curvature_columns, size)
    }

    /// Where the leading `size` eigenfunctions, and the curvature if it guides, stand in a row.
    pub fn columns(&self, size: usize, guide: Guide) -> Range<usize> {
        let first = if guide == Guide::MeanCurvature { 0 } else { self.curvature_columns };
        first..self.curvature_columns + size
    }

    /// One row.
    pub fn row(&self, point: usize) -> &[f32] {
        &self.values[point * self.width..(point + 1) * self.width]
    }

    /// Squared distance in `columns` of a row here to a row there.
    #[inline]
    pub fn distance(&self, point: usize, other: &VertexRows, target: usize, columns: &Range<usize>) -> f32 {
        let (left, right) = (&self.row(point)[columns.clone()], &other.row(target)[columns.clone()]);
        self.arch.dispatch(SquaredDistance { left, right })
    }
}

/// Sum of squared differences, compiled for each instruction set.
struct SquaredDistance<'a> {
    left: &'a [f32],
    right: &'a [f32],
}

impl WithSimd for SquaredDistance<'_> {
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f32 {
        let (left, left_rest) = S::as_simd_f32s(self.left);
        let (right, right_rest) = S::as_simd_f32s(self.right);
        let mut sums = [simd.splat_f32s(0.0); 2];
        let (left_pairs, left_last) = left.as_chunks::<2>();
        let (right_pairs, right_last) = right.as_chunks::<2>();
        for (a, b) in left_pairs.iter().zip(right_pairs) {
            for lane in 0..2 {
                let difference = simd.sub_f32s(a[lane], b[lane]);
                sums[lane] = simd.mul_add_e_f32s(difference, difference, sums[lane]);
            }
        }
        for (a, b) in left_last.iter().zip(right_last) {
            let difference = simd.sub_f32s(*a, *b);
            sums[0] = simd.mul_add_e_f32s(difference, difference, sums[0]);
        }
        let rest: f32 = left_rest.iter().zip(right_rest).map(|(a, b)| (a - b) * (a - b)).sum();
        simd.reduce_sum_f32s(simd.add_f32s(sums[0], sums[1])) + rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_the_chosen_columns_at_any_width() {
        for width in 1..70 {
            let value = |i: usize| ((i * 37) % 11) as f32 - 5.0;
            let values: Vec<f32> = (0..2 * width).map(value).collect();
            let rows = VertexRows { values, width, curvature_columns: 0, arch: Arch::new() };
            for first in 0..width.min(3) {
                let expected: f32 = (first..width).map(|j| (value(j) - value(width + j)).powi(2)).sum();
                assert_eq!(rows.distance(0, &rows, 1, &(first..width)), expected, "{first}..{width}");
            }
        }
    }
}
