//! A coarser operator of the same kind, by smoothed aggregation.
//!
//! P. Vanek, J. Mandel, M. Brezina, "Algebraic Multigrid by Smoothed Aggregation for Second and Fourth Order Elliptic
//! Problems", 1996: vertices are grouped with their neighbours, a function that is constant on each group is smoothed
//! by one Jacobi step, and the stiffness is carried over as `P^T K P`. The mass is lumped again (ours), so that the
//! coarse problem has the form of the fine one: rows of the stiffness sum to 0, masses to the area.

use crate::mesh::{MOST_AROUND, NONE, bucket};
use crate::spectral::laplacian::SymmetricSparse;

/// Steps of the power iteration that bounds the smoother.
const POWER_STEPS: usize = 8;

/// The coarse problem and the way back.
pub struct Coarsening {
    /// Coarse stiffness.
    pub stiffness: SymmetricSparse,
    /// Coarse lumped mass.
    pub mass: Vec<f64>,
    /// Fine x coarse: values of the coarse functions at the fine vertices. Rows sum to 1.
    pub prolongation: SparseRows,
}

/// A sparse matrix by rows.
#[derive(Debug, Clone)]
pub struct SparseRows {
    offsets: Vec<usize>,
    entries: Vec<(u32, f64)>,
}

impl SparseRows {
    fn empty() -> SparseRows {
        SparseRows { offsets: vec![0], entries: Vec::new() }
    }

    /// The entries (column, value) of a row.
    pub fn row(&self, i: usize) -> &[(u32, f64)] {
        &self.entries[self.offsets[i]..self.offsets[i + 1]]
    }

    /// Adds row `i` times a matrix, given row by row, to `out`.
    pub fn add_product(&self, i: usize, matrix: &[f32], out: &mut [f32]) {
        for &(j, value) in self.row(i) {
            let from = &matrix[j as usize * out.len()..][..out.len()];
            out.iter_mut().zip(from).for_each(|(sum, entry)| *sum += value as f32 * entry);
        }
    }

    fn close_row(&mut self) {
        self.offsets.push(self.entries.len());
    }

    fn size(&self) -> usize {
        self.offsets.len() - 1
    }

    fn transpose(&self, columns: usize) -> SparseRows {
        let row = |i: usize| self.row(i).iter().map(move |&(_, value)| (i as u32, value));
        let by_rows: Vec<(u32, f64)> = (0..self.size()).flat_map(row).collect();
        let (offsets, items) = bucket(self.entries.iter().map(|entry| entry.0), columns);
        let offsets = offsets.into_iter().map(|offset| offset as usize).collect();
        let entries = items.into_iter().map(|item| by_rows[item as usize]).collect();
        SparseRows { offsets, entries }
    }
}

impl Coarsening {
    /// Coarsens once: 6 to 8 vertices become one. O(entries of the stiffness).
    pub fn new(stiffness: &SymmetricSparse, mass: &[f64]) -> Coarsening {
        let (groups, count) = aggregate(stiffness);
        let prolongation = smoothed(stiffness, &groups);
        let image = multiply(stiffness.size(), |i| stiffness.row(i), &prolongation, count);
        let transposed = prolongation.transpose(count);
        let restrict = |i: usize| transposed.row(i).iter().map(|&(j, value)| (j as usize, value));
        let coarse = multiply(count, restrict, &image, count);
        let masses: Vec<f64> =
            (0..count).map(|i| restrict(i).map(|(j, value)| value * mass[j]).sum()).collect();
        let least = 1e-3 * masses.iter().sum::<f64>() / count.max(1) as f64;
        Coarsening {
            stiffness: symmetric(coarse),
            mass: masses.into_iter().map(|mass| mass.max(least)).collect(),
            prolongation,
        }
    }
}

/// The group of each vertex, and how many there are: Vanek, Mandel, Brezina, algorithm 2.
fn aggregate(stiffness: &SymmetricSparse) -> (Vec<u32>, usize) {
    let mut group = vec![NONE; stiffness.size()];
    let mut count = 0;
    for i in 0..stiffness.size() {
        if stiffness.neighbours(i).iter().all(|&j| group[j as usize] == NONE) {
            stiffness.neighbours(i).iter().for_each(|&j| group[j as usize] = count);
            count += 1;
        }
    }
    let first = group.clone();
    for i in (0..stiffness.size()).filter(|&i| first[i] == NONE) {
        let strongest =
            stiffness.row(i).filter(|(j, _)| first[*j] != NONE).min_by(|a, b| a.1.total_cmp(&b.1));
        group[i] = strongest.map_or(NONE, |(j, _)| first[j]);
    }
    for own in group.iter_mut().filter(|own| **own == NONE) {
        *own = count;
        count += 1;
    }
    (group, count as usize)
}

/// `(1 - w D^-1 K) P` with the grouping P and `w = 4 / (3 largest eigenvalue of D^-1 K)`; rows of P as they are at hubs.
fn smoothed(stiffness: &SymmetricSparse, groups: &[u32]) -> SparseRows {
    let diagonal = diagonal(stiffness);
    let weight = 4.0 / (3.0 * largest_eigenvalue(stiffness, &diagonal));
    let mut out = SparseRows::empty();
    for i in 0..stiffness.size() {
        let start = out.entries.len();
        out.entries.push((groups[i], 1.0));
        // Smoothed, a hub would couple all groups around it with each other.
        let is_hub = stiffness.neighbours(i).len() > MOST_AROUND as usize;
        for (j, value) in stiffness.row(i).filter(|_| !is_hub) {
            let change = -weight * value / diagonal[i];
            match out.entries[start..].iter_mut().find(|entry| entry.0 == groups[j]) {
                Some(entry) => entry.1 += change,
                None => out.entries.push((groups[j], change)),
            }
        }
        out.close_row();
    }
    out
}

fn diagonal(stiffness: &SymmetricSparse) -> Vec<f64> {
    let entry = |i: usize| stiffness.row(i).find(|(j, _)| *j == i).map_or(0.0, |(_, value)| value);
    (0..stiffness.size()).map(|i| entry(i).max(f64::MIN_POSITIVE)).collect()
}

/// Of `D^-1 K`, by the power iteration; a little above the estimate.
fn largest_eigenvalue(stiffness: &SymmetricSparse, diagonal: &[f64]) -> f64 {
    let mut x: Vec<f64> =
        (0..stiffness.size()).map(|i| (i * 2_654_435_761 % 1000) as f64 / 1000.0 - 0.5).collect();
    let mut largest = 1.0;
    for _ in 0..POWER_STEPS {
        let norm = x.iter().zip(diagonal).map(|(x, d)| d * x * x).sum::<f64>().sqrt();
        x.iter_mut().for_each(|x| *x /= norm.max(f64::MIN_POSITIVE));
        let image: Vec<f64> =
            (0..x.len()).map(|i| stiffness.row(i).map(|(j, value)| value * x[j]).sum()).collect();
        largest = x.iter().zip(&image).map(|(x, y)| x * y).sum();
        x = image.iter().zip(diagonal).map(|(y, d)| y / d).collect();
    }
    1.1 * largest.max(1.0)
}

/// `left * right` with `left` row by row; columns of each row ascend.
fn multiply<R: Iterator<Item = (usize, f64)>>(
    rows: usize,
    left: impl Fn(usize) -> R,
    right: &SparseRows,
    columns: usize,
) -> SparseRows {
    let mut out = SparseRows::empty();
    let mut place = vec![usize::MAX; columns];
    for i in 0..rows {
        let start = out.entries.len();
        for (k, factor) in left(i) {
            for &(j, value) in right.row(k) {
                let at = place[j as usize];
                // A place from an earlier row is below this row's start.
                if at >= start && at < out.entries.len() {
                    out.entries[at].1 += factor * value;
                } else {
                    place[j as usize] = out.entries.len();
                    out.entries.push((j, factor * value));
                }
            }
        }
        out.entries[start..].sort_unstable_by_key(|entry| entry.0);
        for entry in &out.entries[start..] {
            place[entry.0 as usize] = usize::MAX;
        }
        out.close_row();
    }
    out
}

fn symmetric(rows: SparseRows) -> SymmetricSparse {
    SymmetricSparse {
        row_offsets: rows.offsets.iter().map(|&offset| offset as u32).collect(),
        columns: rows.entries.iter().map(|entry| entry.0).collect(),
        values: rows.entries.iter().map(|entry| entry.1).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::adjacency::Adjacency;

    /// The graph Laplacian of `count` vertices and some edges.
    fn laplacian(count: usize, edges: impl Iterator<Item = (u32, u32)> + Clone) -> SymmetricSparse {
        let flat: Vec<[u32; 3]> = edges.map(|(a, b)| [a, b, b]).collect();
        let graph = Adjacency::of_vertices(&flat, &Adjacency::triangles_around(count, &flat));
        let mut matrix = SymmetricSparse { row_offsets: vec![0], ..Default::default() };
        for i in 0..count {
            let mut row: Vec<(u32, f64)> = graph.of(i).iter().map(|&j| (j, -1.0)).collect();
            row.push((i as u32, row.len() as f64));
            row.sort_unstable_by_key(|entry| entry.0);
            matrix.columns.extend(row.iter().map(|entry| entry.0));
            matrix.values.extend(row.iter().map(|entry| entry.1));
            matrix.row_offsets.push(matrix.columns.len() as u32);
        }
        matrix
    }

    /// The path of `count` vertices with unit weights.
    fn path(count: usize) -> SymmetricSparse {
        laplacian(count, (1..count as u32).map(|i| (i - 1, i)))
    }

    #[test]
    fn a_hub_leaves_the_coarse_operator_sparse() {
        // 2000 paths of five vertices that begin at one.
        let edges = (0..2000u32).flat_map(|path| {
            (0..5).map(move |step| (if step == 0 { 0 } else { 5 * path + step }, 5 * path + step + 1))
        });
        let fine = laplacian(10_001, edges);
        let coarse = Coarsening::new(&fine, &[1.0; 10_001]);
        assert!((1500..5000).contains(&coarse.mass.len()), "{}", coarse.mass.len());
        let entries = coarse.stiffness.columns.len();
        assert!(entries < fine.columns.len(), "{entries} from {}", fine.columns.len());
    }

    #[test]
    fn constants_stay_constant_and_the_mass_is_kept() {
        let fine = path(100);
        let coarse = Coarsening::new(&fine, &[0.01; 100]);
        assert!((20..50).contains(&coarse.mass.len()), "{}", coarse.mass.len());
        assert!((coarse.mass.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        for i in 0..100 {
            let sum: f64 = coarse.prolongation.row(i).iter().map(|entry| entry.1).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
        for i in 0..coarse.stiffness.size() {
            assert!(coarse.stiffness.row(i).map(|(_, value)| value).sum::<f64>().abs() < 1e-12);
            assert!(coarse.stiffness.neighbours(i).is_sorted());
        }
    }

    #[test]
    fn energy_is_the_fine_energy_of_the_prolonged_function() {
        let fine = path(60);
        let coarse = Coarsening::new(&fine, &[1.0; 60]);
        let function: Vec<f64> = (0..coarse.stiffness.size()).map(|i| (i as f64 * 0.7).sin()).collect();
        let prolonged: Vec<f64> = (0..60)
            .map(|i| coarse.prolongation.row(i).iter().map(|&(j, value)| value * function[j as usize]).sum())
            .collect();
        let energy = |matrix: &SymmetricSparse, x: &[f64]| -> f64 {
            (0..x.len()).map(|i| x[i] * matrix.row(i).map(|(j, value)| value * x[j]).sum::<f64>()).sum()
        };
        let (own, expected) = (energy(&coarse.stiffness, &function), energy(&fine, &prolonged));
        assert!((own / expected - 1.0).abs() < 1e-12, "{own} for {expected}");
    }
}
