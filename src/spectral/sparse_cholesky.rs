//! Sparse Cholesky factorisation `L L^T` of a symmetric positive definite matrix, and its solve for many
//! right-hand sides at once.
//!
//! Ordering (approximate minimum degree: P. Amestoy, T. Davis, I. Duff, 1996), analysis and numeric factorisation
//! (supernodal: E. Ng, B. Peyton, "Block Sparse Cholesky Algorithms on Advanced Uniprocessor Computers", 1993) are
//! faer's. The solve is ours: right-hand sides lie row by row, so that one entry of L meets a whole vector register
//! of them, and each supernode's panel is read once, in order. In single or double precision.

use crate::base::error::{Error, Result};
use crate::spectral::symmetric_sparse::SymmetricSparse;
use dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::traits::{ComplexField, RealField};
use faer::{Par, Side};
use pulp::{Arch, Simd, WithSimd, bytemuck};

/// The order of elimination and the structure of L: all that depends on the sparsity alone.
#[derive(Debug)]
pub struct Analysis {
    symbolic: SymbolicCholesky<u32>,
    column_offsets: Vec<u32>,
    rows: Vec<u32>,
    /// `order[i]` is the matrix's row that is eliminated as the i-th.
    pub order: Vec<u32>,
}

/// Units in its last place by which a diagonal is raised, one after the other.
const RAISED: [f64; 3] = [16.0, 256.0, 4096.0];

/// Single or double precision.
pub trait Scalar: RealField + Copy + bytemuck::Pod {}

impl Scalar for f32 {}
impl Scalar for f64 {}

/// The factor, with its rows and columns in the order of elimination.
pub struct Factor<'a, T> {
    analysis: &'a Analysis,
    /// Each supernode's panel row by row, rows x columns; the diagonal inverted, all else negated.
    panels: Vec<T>,
}

/// One supernode: columns `start..start + columns` of L.
struct Supernode<'a, T> {
    start: usize,
    columns: usize,
    /// Rows of the panel below its diagonal block.
    below: &'a [u32],
    panel: &'a [T],
}

impl Analysis {
    /// Analyses the sparsity of `matrix`. About O(entries of L).
    ///
    /// # Errors
    /// [`Error::Internal`] if the factor has too many entries for 32-bit indices.
    pub fn new(matrix: &SymmetricSparse) -> Result<Analysis> {
        let size = matrix.size();
        let (mut column_offsets, mut rows) =
            (vec![0u32], Vec::with_capacity(matrix.columns.len() / 2 + size));
        for i in 0..size {
            rows.extend(matrix.neighbours(i).iter().filter(|&&j| j as usize <= i));
            column_offsets.push(rows.len() as u32);
        }
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &column_offsets, None, &rows);
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Upper, SymmetricOrdering::Amd, parameters)
            .map_err(|error| Error::Internal(format!("analysing a sparse matrix: {error:?}")))?;
        let order = match symbolic.perm() {
            Some(permutation) => permutation.arrays().0.to_vec(),
            None => (0..size as u32).collect(),
        };
        Ok(Analysis { symbolic, column_offsets, rows, order })
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.order.len()
    }

    /// Factorises `D^-1 matrix D^-1 + shift` with the diagonal D of `scale`; the sparsity is the one analysed.
    ///
    /// Where edges are 10^5 times as long as others, rounding may make a pivot negative. The diagonal is then raised by
    /// some units in its last places, as few as do.
    ///
    /// # Errors
    /// [`Error::Internal`] if the sum is not positive definite.
    pub fn factorise<T: Scalar>(
        &self,
        matrix: &SymmetricSparse,
        shift: f64,
        scale: &[f64],
    ) -> Result<Factor<'_, T>> {
        let rounding = T::epsilon_impl();
        let raised =
            |units: f64| self.factorise_raised(matrix, shift, scale, T::from_f64_impl(units) * rounding);
        RAISED.into_iter().fold(raised(0.0), |found, units| found.or_else(|_| raised(units)))
    }

    /// The same with the diagonal raised by a share of itself.
    fn factorise_raised<T: Scalar>(
        &self,
        matrix: &SymmetricSparse,
        shift: f64,
        scale: &[f64],
        raise: T,
    ) -> Result<Factor<'_, T>> {
        let size = self.size();
        let mut values = Vec::with_capacity(self.rows.len());
        for i in 0..size {
            let lower = matrix.row(i).filter(|(j, _)| *j <= i);
            values.extend(lower.map(|(j, value)| {
                let value = value / (scale[i] * scale[j]);
                let entry = T::from_f64_impl(if i == j { value + shift } else { value });
                if i == j { entry + raise * entry } else { entry }
            }));
        }
        let mut factor = Factor { analysis: self, panels: self.panels(&values)? };
        factor.turn_panels();
        Ok(factor)
    }

    /// Solves `(matrix + diagonal) x = right` for the columns of `right`; the sparsity is the one analysed.
    ///
    /// # Errors
    /// As [`Analysis::factorise`].
    pub fn solve<const N: usize>(
        &self,
        matrix: &SymmetricSparse,
        diagonal: &[f64],
        right: &[[f64; N]],
    ) -> Result<Vec<[f64; N]>> {
        let scale: Vec<f64> = diagonal.iter().map(|value| value.sqrt()).collect();
        let factor = self.factorise::<f64>(matrix, 1.0, &scale)?;
        let scaled = |row: &u32| right[*row as usize].map(|value| value / scale[*row as usize]);
        let mut block: Vec<[f64; N]> = self.order.iter().map(scaled).collect();
        factor.solve(block.as_flattened_mut(), N);
        let mut found = vec![[0.0; N]; right.len()];
        for (solved, &row) in block.iter().zip(&self.order) {
            found[row as usize] = solved.map(|value| value / scale[row as usize]);
        }
        Ok(found)
    }

    /// The supernodes of L, column by column, of a matrix with these values.
    fn panels<T: Scalar>(&self, values: &[T]) -> Result<Vec<T>> {
        let size = self.size();
        let pattern =
            SymbolicSparseColMatRef::new_checked(size, size, &self.column_offsets, None, &self.rows);
        let mut panels = vec![T::zero_impl(); self.symbolic.len_val()];
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<T>(Par::Seq, Default::default());
        let mut memory = MemBuffer::new(scratch);
        let factorised = self.symbolic.factorize_numeric_llt(
            &mut panels,
            SparseColMatRef::new(pattern, values),
            Side::Upper,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        factorised.map_err(|error| Error::Internal(format!("factorising a sparse matrix: {error:?}")))?;
        Ok(panels)
    }

    /// Entries of L in each of its columns, the diagonal included: for measuring.
    #[cfg(feature = "internals")]
    pub fn column_counts(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.supernode_count()).flat_map(|index| {
            let (_, columns, below, _) = self.supernode(index);
            (0..columns).map(move |column| columns - column + below.len())
        })
    }

    fn supernode_count(&self) -> usize {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(structure) => structure.n_supernodes(),
            SymbolicCholeskyRaw::Simplicial(_) => 0,
        }
    }

    /// First column, number of columns, rows below, offset of the panel.
    fn supernode(&self, index: usize) -> (usize, usize, &[u32], usize) {
        let SymbolicCholeskyRaw::Supernodal(structure) = self.symbolic.raw() else {
            unreachable!("a supernodal factorisation was asked for");
        };
        let start = structure.supernode_begin()[index] as usize;
        let end = structure.supernode_end()[index] as usize;
        let below = structure.supernode(index).pattern();
        (start, end - start, below, structure.col_ptr_for_val()[index] as usize)
    }
}

impl<T: Scalar> Factor<'_, T> {
    /// From faer's panels, column by column, to ours.
    fn turn_panels(&mut self) {
        let mut column_major = Vec::new();
        for index in 0..self.analysis.supernode_count() {
            let (_, columns, below, offset) = self.analysis.supernode(index);
            let rows = columns + below.len();
            let panel = &mut self.panels[offset..offset + rows * columns];
            column_major.clear();
            column_major.extend_from_slice(panel);
            for (r, row) in panel.chunks_exact_mut(columns).enumerate() {
                for (c, value) in row.iter_mut().enumerate() {
                    let entry = column_major[c * rows + r];
                    *value = if r == c { T::recip_impl(&entry) } else { -entry };
                }
            }
        }
    }

    fn supernode(&self, index: usize) -> Supernode<'_, T> {
        let (start, columns, below, offset) = self.analysis.supernode(index);
        let panel = &self.panels[offset..offset + (columns + below.len()) * columns];
        Supernode { start, columns, below, panel }
    }

    /// The analysis behind it.
    pub fn analysis(&self) -> &Analysis {
        self.analysis
    }

    /// Solves in place for `width` right-hand sides: `block` is size x width row by row, its rows in the order of
    /// elimination ([`Analysis::order`]). O(entries of L x width).
    pub fn solve(&self, block: &mut [T], width: usize) {
        assert!(block.len() == width * self.analysis.size());
        Arch::new().dispatch(Solve { factor: self, block, width });
    }
}

/// Vector registers of right-hand sides that are solved together.
const REGISTERS: usize = 2;
/// Rows or columns of a panel that meet them together.
const GROUP: usize = 4;

/// One row of a few right-hand sides.
type Row<T, S> = [<T as ComplexField>::SimdVec<S>; REGISTERS];

/// The solve as an operation that is compiled for each instruction set and chosen at run time.
struct Solve<'a, T> {
    factor: &'a Factor<'a, T>,
    block: &'a mut [T],
    width: usize,
}

impl<T: Scalar> WithSimd for Solve<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let lanes = size_of::<Row<T, S>>() / size_of::<T>();
        if self.width == lanes {
            return solve_columns(simd, self.factor, bytemuck::cast_slice_mut(self.block));
        }
        // Columns are solved a few at a time in a block of their own: fewer cache lines than in the wide one.
        let mut columns = vec![T::zero_impl(); self.factor.analysis.size() * lanes];
        for first in (0..self.width).step_by(lanes) {
            let taken = first..self.width.min(first + lanes);
            for (narrow, wide) in columns.chunks_exact_mut(lanes).zip(self.block.chunks_exact(self.width)) {
                narrow[..taken.len()].copy_from_slice(&wide[taken.clone()]);
            }
            solve_columns(simd, self.factor, bytemuck::cast_slice_mut(&mut columns));
            for (narrow, wide) in columns.chunks_exact(lanes).zip(self.block.chunks_exact_mut(self.width)) {
                wide[taken.clone()].copy_from_slice(&narrow[..taken.len()]);
            }
        }
    }
}

#[inline(always)]
fn solve_columns<T: Scalar, S: Simd>(simd: S, factor: &Factor<T>, columns: &mut [T::SimdVec<S>]) {
    let columns: &mut [Row<T, S>] = columns.as_chunks_mut().0;
    let simd = T::simd_ctx(simd);
    let count = factor.analysis.supernode_count();
    for index in 0..count {
        forward::<T, S>(simd, &factor.supernode(index), columns);
    }
    for index in (0..count).rev() {
        backward::<T, S>(simd, &factor.supernode(index), columns);
    }
}

/// `sum += factor * row`.
#[inline(always)]
fn add_multiple<T: Scalar, S: Simd>(simd: T::SimdCtx<S>, sum: &mut Row<T, S>, factor: T, row: &Row<T, S>) {
    let factor = T::simd_splat(&simd, &factor);
    for register in 0..REGISTERS {
        sum[register] = T::simd_mul_add(&simd, factor, row[register], sum[register]);
    }
}

#[inline(always)]
fn scaled<T: Scalar, S: Simd>(simd: T::SimdCtx<S>, row: Row<T, S>, factor: T) -> Row<T, S> {
    row.map(|value| T::simd_mul(&simd, value, T::simd_splat(&simd, &factor)))
}

/// `L y = x` for the columns of a supernode, and their part of the rows below.
#[inline(always)]
fn forward<T: Scalar, S: Simd>(simd: T::SimdCtx<S>, node: &Supernode<T>, x: &mut [Row<T, S>]) {
    let (square, rest) = node.panel.split_at(node.columns * node.columns);
    for (r, row) in square.chunks_exact(node.columns).enumerate() {
        let own = &mut x[node.start..node.start + r + 1];
        let (done, last) = own.split_at_mut(r);
        for (entry, value) in row.iter().zip(done.iter()) {
            add_multiple::<T, S>(simd, &mut last[0], *entry, value);
        }
        last[0] = scaled::<T, S>(simd, last[0], row[r]);
    }
    let (groups, others) = node.below.as_chunks::<GROUP>();
    let mut rows = rest.chunks_exact(node.columns);
    for targets in groups {
        forward_rows::<T, S, GROUP>(simd, node, &mut rows, targets, x);
    }
    for target in others {
        forward_rows::<T, S, 1>(simd, node, &mut rows, &[*target], x);
    }
}

/// The supernode's part of the next few rows below.
#[inline(always)]
fn forward_rows<'a, T: Scalar, S: Simd, const COUNT: usize>(
    simd: T::SimdCtx<S>,
    node: &Supernode<T>,
    rows: &mut impl Iterator<Item = &'a [T]>,
    targets: &[u32; COUNT],
    x: &mut [Row<T, S>],
) {
    let rows: [&[T]; COUNT] = std::array::from_fn(|_| &rows.next().expect("a row")[..node.columns]);
    let mut sums = targets.map(|target| x[target as usize]);
    for (c, value) in x[node.start..][..node.columns].iter().enumerate() {
        for (sum, row) in sums.iter_mut().zip(rows) {
            add_multiple::<T, S>(simd, sum, row[c], value);
        }
    }
    targets.iter().zip(sums).for_each(|(&target, sum)| x[target as usize] = sum);
}

/// `L^T y = x` for the columns of a supernode, from the rows below, which are done.
#[inline(always)]
fn backward<T: Scalar, S: Simd>(simd: T::SimdCtx<S>, node: &Supernode<T>, x: &mut [Row<T, S>]) {
    let (columns, start) = (node.columns, node.start);
    for first in (0..columns).step_by(GROUP) {
        match columns - first {
            1 => backward_columns::<T, S, 1>(simd, node, first, x),
            2 => backward_columns::<T, S, 2>(simd, node, first, x),
            3 => backward_columns::<T, S, 3>(simd, node, first, x),
            _ => backward_columns::<T, S, GROUP>(simd, node, first, x),
        }
    }
    for c in (0..columns).rev() {
        let (own, done) = x[start + c..start + columns].split_first_mut().expect("a column of the supernode");
        for (r, value) in done.iter().enumerate() {
            add_multiple::<T, S>(simd, own, node.panel[(c + 1 + r) * columns + c], value);
        }
        *own = scaled::<T, S>(simd, *own, node.panel[c * columns + c]);
    }
}

/// The part of the rows below in a few columns.
#[inline(always)]
fn backward_columns<T: Scalar, S: Simd, const COUNT: usize>(
    simd: T::SimdCtx<S>,
    node: &Supernode<T>,
    first: usize,
    x: &mut [Row<T, S>],
) {
    let rest = &node.panel[node.columns * node.columns..];
    let at = node.start + first;
    let mut sums: [Row<T, S>; COUNT] = x[at..at + COUNT].try_into().expect("columns of the supernode");
    for (row, &target) in rest.chunks_exact(node.columns).zip(node.below) {
        let value = &x[target as usize];
        for (sum, entry) in sums.iter_mut().zip(&row[first..first + COUNT]) {
            add_multiple::<T, S>(simd, sum, *entry, value);
        }
    }
    x[at..at + COUNT].copy_from_slice(&sums);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The grid graph's Laplacian: `side * side` vertices.
    fn grid(side: usize) -> SymmetricSparse {
        let mut matrix = SymmetricSparse { row_offsets: vec![0], ..Default::default() };
        for i in 0..side * side {
            let (x, y) = (i % side, i / side);
            let near: Vec<usize> = [(y > 0, i.wrapping_sub(side)), (x > 0, i.wrapping_sub(1))]
                .into_iter()
                .chain([(true, i), (x + 1 < side, i + 1), (y + 1 < side, i + side)])
                .filter_map(|(there, j)| there.then_some(j))
                .collect();
            matrix.columns.extend(near.iter().map(|&j| j as u32));
            let value = |&j: &usize| if j == i { near.len() as f64 - 1.0 } else { -1.0 };
            matrix.values.extend(near.iter().map(value));
            matrix.row_offsets.push(matrix.columns.len() as u32);
        }
        matrix
    }

    #[test]
    fn the_solution_solves_the_system_at_any_width() {
        let matrix = grid(23);
        let size = matrix.size();
        let scale: Vec<f64> = (0..size).map(|i| 1.0 + (i % 7) as f64).collect();
        let analysis = Analysis::new(&matrix).unwrap();
        let factor = analysis.factorise::<f64>(&matrix, 0.3, &scale).unwrap();
        let mut place = vec![0; size];
        analysis.order.iter().enumerate().for_each(|(at, &i)| place[i as usize] = at);
        for width in [1, 12, 16, 37] {
            let right: Vec<f64> = (0..size * width).map(|i| (i as f64 * 0.37).sin()).collect();
            let mut solution = right.clone();
            factor.solve(&mut solution, width);
            for i in 0..size {
                for j in 0..width {
                    let at = |row: usize| solution[place[row] * width + j];
                    let image: f64 = matrix.row(i).map(|(k, value)| value / scale[k] * at(k)).sum();
                    let missing = image / scale[i] + 0.3 * at(i) - right[place[i] * width + j];
                    assert!(missing.abs() < 1e-11, "{width}: {missing} at {i}, {j}");
                }
            }
        }
    }

    #[test]
    fn columns_of_the_factor_hold_at_least_those_of_the_matrix() {
        let matrix = grid(5);
        let counts: Vec<usize> = Analysis::new(&matrix).unwrap().column_counts().collect();
        assert!(
            counts.len() == 25 && counts.iter().enumerate().all(|(i, &count)| (1..=25 - i).contains(&count))
        );
        assert!(counts.iter().sum::<usize>() >= (matrix.columns.len() + 25) / 2);
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_refused() {
        let matrix = grid(5);
        let analysis = Analysis::new(&matrix).unwrap();
        assert!(analysis.factorise::<f64>(&matrix, -1.0, &[1.0; 25]).is_err());
    }
}
