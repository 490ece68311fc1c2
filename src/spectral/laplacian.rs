//! Cotangent stiffness, lumped mass and mean curvature of one shell. The search sees nothing else of the shape; rigid parts see its
//! positions again.
//!
//! Weights from edge lengths: A. I. Bobenko, B. A. Springborn, "A discrete Laplace-Beltrami operator
//! for simplicial surfaces", 2007. Slivers are made harmless by intrinsic mollification: N. Sharp,
//! K. Crane, "A Laplacian for Nonmanifold Triangle Meshes", 2020, section 4.5: one small length,
//! added to all edges, makes every triangle inequality strict. Non-manifold edges need no care: each
//! triangle adds its own positive semi-definite element.

mod mean_curvature;

use crate::base::error::Result;
use crate::mesh::{Shell, bucket};
use crate::spectral::sparse_cholesky::Analysis;
pub use crate::spectral::symmetric_sparse::SymmetricSparse;
use crate::spectral::twin_parts::TwinParts;
use std::sync::{Arc, OnceLock};

/// Relative slack of the mollified triangle inequalities, in mean edge lengths.
const MOLLIFICATION: f64 = 1e-5;

/// One shell without its positions: what the later stages know of the surface.
///
/// Lengths are in units in which the shell's area is 1.
#[derive(Debug, Clone)]
pub struct IntrinsicSurface {
    /// Triangles over the shell's vertices, consistently oriented if `orientable`.
    pub triangles: Vec<[u32; 3]>,
    /// `edge_lengths[t][c]` is the mollified length of the edge opposite corner `c` of triangle `t`.
    pub edge_lengths: Vec<[f64; 3]>,
    /// Cotangent stiffness matrix: positive semi-definite, rows sum to 0.
    pub stiffness: SymmetricSparse,
    /// Lumped (barycentric) mass of each vertex; they sum to about 1.
    pub lumped_mass: Vec<f64>,
    /// Diffused mean curvature of each vertex, one column a time of diffusion; none where it has no sign, and
    /// unless it was asked for.
    ///
    /// Each column has mean 0; the squares of all columns together have mean 1. All else here is intrinsic.
    pub mean_curvature: Vec<Vec<f64>>,
    /// Parts that go to each other; `None` of a surface of one piece.
    pub parts: Option<TwinParts>,
    /// Whether "clockwise" means the same on the whole shell.
    pub orientable: bool,
    /// Made when it is first asked for.
    analysis: OnceLock<Arc<Analysis>>,
}

impl IntrinsicSurface {
    /// Builds the operators of `shell` in O(vertices + triangles).
    pub fn new(shell: &Shell) -> IntrinsicSurface {
        let edge_lengths = mollified_edge_lengths(&shell.positions, &shell.triangles);
        let count = shell.positions.len();
        let mut lumped_mass = vec![0.0; count];
        let mut elements = Vec::with_capacity(shell.triangles.len());
        for (triangle, lengths) in shell.triangles.iter().zip(&edge_lengths) {
            let area = triangle_area(*lengths);
            for &vertex in triangle {
                lumped_mass[vertex as usize] += area / 3.0;
            }
            elements.push(half_cotangents(*lengths, area));
        }
        let mean = lumped_mass.iter().sum::<f64>() / count as f64;
        for mass in &mut lumped_mass {
            *mass = mass.max(1e-9 * mean);
        }
        let stiffness = assemble(count, &shell.triangles, &elements);
        IntrinsicSurface {
            triangles: shell.triangles.clone(),
            edge_lengths,
            mean_curvature: Vec::new(),
            parts: None,
            stiffness,
            lumped_mass,
            orientable: shell.orientable,
            analysis: OnceLock::new(),
        }
    }

    /// [`IntrinsicSurface::new`], and the mean curvature, which costs at most 200 times O(vertices) more.
    pub fn with_mean_curvature(shell: &Shell) -> IntrinsicSurface {
        let mut surface = IntrinsicSurface::new(shell);
        surface.mean_curvature = mean_curvature::channels(shell, &surface.stiffness, &surface.lumped_mass);
        surface
    }

    /// The order in which the stiffness and all matrices of its sparsity are factorised, made once.
    ///
    /// # Errors
    /// [`crate::Error::Internal`] if the factor has too many entries for 32-bit indices.
    pub fn analysis(&self) -> Result<&Arc<Analysis>> {
        if self.analysis.get().is_none() {
            self.set_analysis(&Arc::new(Analysis::new(&self.stiffness)?));
        }
        Ok(self.analysis.get().expect("it was made"))
    }

    /// Solves `(stiffness + diagonal) x = right` for the columns of `right`. One sparse factorisation.
    ///
    /// # Errors
    /// [`crate::Error::Internal`] if it breaks down.
    pub fn solve<const N: usize>(&self, diagonal: &[f64], right: &[[f64; N]]) -> Result<Vec<[f64; N]>> {
        self.analysis()?.solve(&self.stiffness, diagonal, right)
    }

    /// Takes over the analysis of another shape of the same connectivity, if there is none yet.
    pub(crate) fn set_analysis(&self, analysis: &Arc<Analysis>) {
        self.analysis.get_or_init(|| analysis.clone());
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.lumped_mass.len()
    }
}

fn mollified_edge_lengths(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<[f64; 3]> {
    let length = |a: u32, b: u32| {
        let (p, q) = (positions[a as usize], positions[b as usize]);
        (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>().sqrt()
    };
    let mut lengths: Vec<[f64; 3]> =
        triangles.iter().map(|&[a, b, c]| [length(b, c), length(c, a), length(a, b)]).collect();
    let mean = lengths.iter().flatten().sum::<f64>() / (3 * lengths.len()).max(1) as f64;
    let slack = |[a, b, c]: [f64; 3]| (a + b - c).min(b + c - a).min(c + a - b);
    let missing = lengths.iter().map(|l| MOLLIFICATION * mean - slack(*l)).fold(0.0, f64::max);
    for length in lengths.iter_mut().flatten() {
        *length += missing;
    }
    lengths
}

/// Kahan's stable form of Heron's formula.
pub(crate) fn triangle_area(lengths: [f64; 3]) -> f64 {
    let mut sorted = lengths;
    sorted.sort_by(|x, y| y.total_cmp(x));
    let [a, b, c] = sorted;
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    0.25 * product.max(0.0).sqrt()
}

/// Half the cotangent of the angle at each corner.
fn half_cotangents([a, b, c]: [f64; 3], area: f64) -> [f64; 3] {
    let (a2, b2, c2) = (a * a, b * b, c * c);
    let scale = 1.0 / (8.0 * area);
    [(b2 + c2 - a2) * scale, (c2 + a2 - b2) * scale, (a2 + b2 - c2) * scale]
}

fn assemble(count: usize, triangles: &[[u32; 3]], elements: &[[f64; 3]]) -> SymmetricSparse {
    // Two slots of rows for each corner of a triangle, before duplicates are merged.
    let slots = |(triangle, weights): (&[u32; 3], &[f64; 3])| {
        let ends = |corner: usize| (triangle[(corner + 1) % 3], triangle[(corner + 2) % 3], weights[corner]);
        [0, 1, 2].map(ends).into_iter().flat_map(|(i, j, weight)| [(i, (j, weight)), (j, (i, weight))])
    };
    let slots: Vec<(u32, (u32, f64))> = triangles.iter().zip(elements).flat_map(slots).collect();
    let (offsets, places) = bucket(slots.iter().map(|slot| slot.0), count);
    let mut matrix = SymmetricSparse { row_offsets: vec![0], ..Default::default() };
    let mut row: Vec<(u32, f64)> = Vec::new();
    for i in 0..count {
        let places = &places[offsets[i] as usize..offsets[i + 1] as usize];
        row.clear();
        row.extend(places.iter().map(|&place| slots[place as usize].1));
        row.sort_by_key(|slot| slot.0);
        push_row(&mut matrix, i as u32, &row);
    }
    matrix
}

/// Appends row `i`: off-diagonal weights merged and negated, the diagonal their sum.
fn push_row(matrix: &mut SymmetricSparse, i: u32, sorted_slots: &[(u32, f64)]) {
    let start = matrix.columns.len();
    let mut diagonal = 0.0;
    let mut diagonal_at = None;
    for &(column, weight) in sorted_slots {
        diagonal += weight;
        if matrix.columns.len() > start && matrix.columns.last() == Some(&column) {
            *matrix.values.last_mut().expect("a row entry") -= weight;
            continue;
        }
        if column > i && diagonal_at.is_none() {
            diagonal_at = Some(matrix.columns.len());
            matrix.columns.push(i);
            matrix.values.push(0.0);
        }
        matrix.columns.push(column);
        matrix.values.push(-weight);
    }
    let at = diagonal_at.unwrap_or_else(|| {
        matrix.columns.push(i);
        matrix.values.push(0.0);
        matrix.columns.len() - 1
    });
    matrix.values[at] = diagonal;
    matrix.row_offsets.push(matrix.columns.len() as u32);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_triangle_has_its_closed_form() {
        // Legs 1 and 1: cotangents 0, 1, 1 at the right angle and the two others.
        let lengths = [2f64.sqrt(), 1.0, 1.0];
        let area = triangle_area(lengths);
        assert!((area - 0.5).abs() < 1e-15);
        let weights = half_cotangents(lengths, area);
        for (weight, expected) in weights.iter().zip([0.0, 0.5, 0.5]) {
            assert!((weight - expected).abs() < 1e-15, "{weights:?}");
        }
    }

    #[test]
    fn mollification_makes_a_needle_a_triangle() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.5, 1.0, 0.0]];
        let lengths = mollified_edge_lengths(&positions, &[[0, 1, 2], [0, 1, 3]]);
        assert!(lengths.iter().all(|l| triangle_area(*l) > 0.0));
    }
}
