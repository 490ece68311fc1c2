//! What images are sought by: mean curvature and eigenfunctions of points in single precision, a row a point.

use crate::geometry::embedded_triangles::TriangleProducts;
use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::twin_parts::{CODE, code};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Weight of the mean curvature beside the eigenfunctions, whose squares have mean 1 each (`docs/notebook/2026-11-25-method.md`).
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
    /// Columns before those of the eigenfunctions: curvature, then the coordinates of parts.
    leading: usize,
    /// The part of each row's image, where there are parts.
    twins: Vec<u8>,
    arch: Arch,
}

impl VertexRows {
    /// The rows of all vertices. O(vertices x eigenfunctions).
    pub fn new(surface: &IntrinsicSurface, basis: &Eigenbasis) -> VertexRows {
        let (curvature, functions) = (&surface.mean_curvature, &basis.eigenfunctions);
        let codes = if surface.parts.is_some() { CODE } else { 0 };
        let mut rows = VertexRows::zero(functions.nrows(), curvature.len(), codes, functions.ncols());
        for (row, vertex) in rows.values.chunks_exact_mut(rows.width.max(1)).zip(0..) {
            for (value, column) in row.iter_mut().zip(curvature) {
                *value = (CURVATURE_WEIGHT * column[vertex]) as f32;
            }
        }
        if let Some(parts) = &surface.parts {
            rows.twins.clone_from(&parts.twin);
            for (row, &part) in rows.values.chunks_exact_mut(rows.width.max(1)).zip(&parts.own) {
                row[curvature.len()..rows.leading].copy_from_slice(&code(part));
            }
        }
        for (row, vertex) in rows.values.chunks_exact_mut(rows.width.max(1)).zip(0..) {
            row[rows.leading..]
                .iter_mut()
                .zip(functions.row(vertex).iter())
                .for_each(|(to, value)| *to = *value as f32);
        }
        rows
    }

    fn zero(count: usize, curvature_columns: usize, codes: usize, functions: usize) -> VertexRows {
        let leading = curvature_columns + codes;
        let width = leading + functions;
        let values = vec![0.0; count * width];
        VertexRows { values, width, curvature_columns, leading, twins: Vec::new(), arch: Arch::new() }
    }

    /// At each of `points` (three rows and their weights) the weighted sum of the rows, of which only `columns`.
    pub fn combined(
        &self,
        points: impl Iterator<Item = ([u32; 3], [f32; 3])>,
        columns: Range<usize>,
    ) -> VertexRows {
        let points: Vec<_> = points.collect();
        let [curvature, leading] = [self.curvature_columns, self.leading]
            .map(|before| before.clamp(columns.start, columns.end) - columns.start);
        let mut combined =
            VertexRows::zero(points.len(), curvature, leading - curvature, columns.len() - leading);
        let out = &mut combined.values;
        self.arch.dispatch(WeightedSums { rows: self, points: &points, columns, out });
        combined
    }

    /// The same points with their eigenfunctions under `map` (size x size): `functions * map`.
    pub fn mapped(&self, map: &Mat<f64>) -> VertexRows {
        let (curvature, leading, size) = (self.curvature_columns, self.leading, map.ncols());
        let mut mapped = VertexRows::zero(self.count(), curvature, leading - curvature, size);
        let width = mapped.width;
        let map = Mat::from_fn(map.nrows(), size, |i, j| map[(i, j)] as f32);
        for (out, row) in mapped.values.chunks_exact_mut(width.max(1)).zip(0..) {
            out[..curvature].copy_from_slice(&self.row(row)[..curvature]);
            if let Some(&twin) = self.twins.get(row) {
                out[curvature..leading].copy_from_slice(&code(twin));
            }
        }
        let out = MatMut::from_row_major_slice_mut(&mut mapped.values, self.count(), width);
        let (out, from) = (out.subcols_mut(leading, size), self.functions(map.nrows()));
        matmul(out, Accum::Replace, from, map.as_ref(), 1.0, Par::Seq);
        mapped
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.values.len() / self.width.max(1)
    }

    /// Numbers in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The leading `size` eigenfunctions: points x size.
    pub fn functions(&self, size: usize) -> MatRef<'_, f32> {
        MatRef::from_row_major_slice(&self.values, self.count(), self.width).subcols(self.leading, size)
    }

    /// Where the leading `size` eigenfunctions stand in a row.
    pub fn function_columns(&self, size: usize) -> Range<usize> {
        self.leading..self.leading + size
    }

    /// Where they and the parts, and the curvature if it guides, stand in a row.
    pub fn columns(&self, size: usize, guide: Guide) -> Range<usize> {
        let first = if guide == Guide::MeanCurvature { 0 } else { self.curvature_columns };
        first..self.leading + size
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

/// [`VertexRows::combined`], compiled for each instruction set.
struct WeightedSums<'a> {
    rows: &'a VertexRows,
    points: &'a [([u32; 3], [f32; 3])],
    columns: Range<usize>,
    out: &'a mut [f32],
}

impl WithSimd for WeightedSums<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let width = self.columns.len().max(1);
        for (out, (corners, [u, v, w])) in self.out.chunks_exact_mut(width).zip(self.points) {
            let [a, b, c] = corners.map(|corner| &self.rows.row(corner as usize)[self.columns.clone()]);
            for (((out, a), b), c) in out.iter_mut().zip(a).zip(b).zip(c) {
                *out = u * a + v * b + w * c;
            }
        }
    }
}

/// Sum of squared differences, compiled for each instruction set.
pub struct SquaredDistance<'a> {
    /// One row.
    pub left: &'a [f32],
    /// The other, as long.
    pub right: &'a [f32],
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
        if !left_rest.is_empty() {
            let difference =
                simd.sub_f32s(simd.partial_load_f32s(left_rest), simd.partial_load_f32s(right_rest));
            sums[1] = simd.mul_add_e_f32s(difference, difference, sums[1]);
        }
        simd.reduce_sum_f32s(simd.add_f32s(sums[0], sums[1]))
    }
}

/// What the point of a triangle nearest to a query depends on: their rows are equally long. For an operation that is compiled for each instruction set.
#[inline(always)]
pub fn products<S: Simd>(simd: S, query: &[f32], corners: [&[f32]; 3]) -> TriangleProducts {
    let mut sums = [simd.splat_f32s(0.0); 6];
    let rows = [query, corners[0], corners[1], corners[2]];
    let [query, a, b, c] = rows.map(S::as_simd_f32s);
    for i in 0..query.0.len() {
        add_products(simd, &mut sums, [query.0[i], a.0[i], b.0[i], c.0[i]]);
    }
    if !query.1.is_empty() {
        let tails = [query.1, a.1, b.1, c.1].map(|tail| simd.partial_load_f32s(tail));
        add_products(simd, &mut sums, tails);
    }
    let sum = |index: usize| simd.reduce_sum_f32s(sums[index]);
    TriangleProducts { own: sum(0), along: [sum(1), sum(2)], edges: [sum(3), sum(4), sum(5)] }
}

/// Adds some columns of the query and the corners.
#[inline(always)]
fn add_products<S: Simd>(simd: S, sums: &mut [S::f32s; 6], [query, a, b, c]: [S::f32s; 4]) {
    let (to_query, to_b, to_c) = (simd.sub_f32s(query, a), simd.sub_f32s(b, a), simd.sub_f32s(c, a));
    let pairs =
        [(to_query, to_query), (to_query, to_b), (to_query, to_c), (to_b, to_b), (to_b, to_c), (to_c, to_c)];
    for (sum, (left, right)) in sums.iter_mut().zip(pairs) {
        *sum = simd.mul_add_e_f32s(left, right, *sum);
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
            let rows = VertexRows {
                values,
                width,
                curvature_columns: 0,
                leading: 0,
                twins: Vec::new(),
                arch: Arch::new(),
            };
            for first in 0..width.min(3) {
                let expected: f32 = (first..width).map(|j| (value(j) - value(width + j)).powi(2)).sum();
                assert_eq!(rows.distance(0, &rows, 1, &(first..width)), expected, "{first}..{width}");
            }
        }
    }
}
