//! How directions turn under a symmetry: one orthogonal matrix per point, and displacements carried by it.
//!
//! The map itself says where the neighbours of a point go. The matrix that takes the edges around the
//! image best to the edges around the point, in the least-squares sense, is the local frame's image
//! (O. Sorkine, M. Alexa, "As-Rigid-As-Possible Surface Modeling", 2007, equation 5; the best rotation by
//! quaternions: B. K. P. Horn, "Closed-form solution of absolute orientation using unit quaternions", 1987).
//! A reflection's matrices have determinant -1. We deviate in averaging the edges' covariances over a
//! neighbourhood first: bending finer than that is shape, which a tool mirrors, and coarser bending is pose.

use super::{Mirroring, at};
use crate::correspondence::Symmetry;
use crate::error::Result;
use crate::mesh::vector::{Vector, subtract};
use crate::mesh::{Mesh, NONE};
use crate::symmetry_kind::SymmetryKind;

/// A 3 x 3 matrix by rows.
pub type Matrix = [[f64; 3]; 3];

/// Radius of the neighbourhood over which the covariances are averaged, in sqrt(area).
///
/// A wider one takes more of a wide dent for shape, and more of a bent joint too: on the posed human, with one
/// side winning, 0.03 leaves 0.46 of dents 0.1 wide and moves the body without dents by 0.006 (root mean
/// square, sqrt(area)), 0.06 leaves 0.35 and moves it by 0.008.
const RADIUS: f64 = 0.03;
/// Most rounds of averaging over neighbours; each widens the radius by about an edge in the root.
const MOST_ROUNDS: f64 = 100.0;

/// How directions at the image of each point turn into directions at the point.
#[derive(Debug, Clone)]
pub struct Frames {
    /// Orthogonal matrix of each point of the mesh, with the determinant of the symmetry's kind.
    pub turn: Vec<Matrix>,
}

impl Frames {
    /// Fits the matrices to `positions`, one per caller's vertex: those of the mesh, or of another pose.
    ///
    /// Time O(edges * rounds), at most 100 rounds. A point without image gets the identity (negated for a
    /// reflection).
    pub fn new(mesh: &Mesh, symmetry: &Symmetry, positions: &[Vector]) -> Frames {
        let own: Vec<Vector> =
            mesh.vertex_of_point.iter().map(|&vertex| positions[vertex as usize]).collect();
        let image = images(mesh, symmetry, positions);
        let (offsets, neighbours) = neighbours(mesh);
        let around = |point: usize| &neighbours[offsets[point] as usize..offsets[point + 1] as usize];
        let mut covariance: Vec<Matrix> =
            (0..own.len()).map(|point| edges_covariance(point, around(point), &own, &image)).collect();
        for _ in 0..rounds(mesh) {
            covariance = (0..own.len()).map(|point| mean(point, around(point), &covariance)).collect();
        }
        let sign = if symmetry.kind == SymmetryKind::Reflection { -1.0 } else { 1.0 };
        let fit = |matrix: Matrix| scaled(nearest_rotation(&scaled(matrix, sign)), sign);
        Frames { turn: covariance.into_iter().map(fit).collect() }
    }
}

/// Carries a displacement field across the map: what happens at the image happens here, in local frames.
///
/// `displacements` has one vector per caller's vertex, in any unit; `positions` is the shape that is
/// displaced, in the pose it is in. Values are merged with the old ones as `mirroring` says.
///
/// # Errors
/// As [`Mirroring::shares`].
///
/// # Panics
/// If an array has not one entry per vertex.
pub fn carry_displacement(
    mesh: &Mesh,
    symmetry: &Symmetry,
    positions: &[Vector],
    displacements: &[Vector],
    mirroring: &Mirroring,
) -> Result<Vec<Vector>> {
    assert_eq!(positions.len(), symmetry.partner.len());
    assert_eq!(displacements.len(), symmetry.partner.len());
    let shares = mirroring.shares(symmetry)?;
    let frames = Frames::new(mesh, symmetry, positions);
    let mut carried = displacements.to_vec();
    for (vertex, share) in shares.into_iter().enumerate().filter(|(_, share)| *share > 0.0) {
        let point = mesh.point_of_vertex[vertex];
        let Some(image) = symmetry.surface_point[vertex].filter(|_| point != NONE) else { continue };
        let there = [0, 1, 2].map(|axis| at(&image, displacements.as_flattened(), 3, axis));
        let here = turned(&frames.turn[point as usize], there);
        carried[vertex] = [0, 1, 2].map(|axis| super::blend(carried[vertex][axis], here[axis], share));
    }
    Ok(carried)
}

/// Position of the image of each point; `None` without one.
pub(super) fn images(mesh: &Mesh, symmetry: &Symmetry, positions: &[Vector]) -> Vec<Option<Vector>> {
    let flat = positions.as_flattened();
    let image = |&vertex: &u32| {
        let point = symmetry.surface_point[vertex as usize].as_ref()?;
        Some([0, 1, 2].map(|axis| at(point, flat, 3, axis)))
    };
    mesh.vertex_of_point.iter().map(image).collect()
}

/// Points that share a triangle's edge with each point, each once: offsets and points.
fn neighbours(mesh: &Mesh) -> (Vec<u32>, Vec<u32>) {
    let ends = |[a, b, c]: &[u32; 3]| [(*a, *b), (*b, *a), (*b, *c), (*c, *b), (*c, *a), (*a, *c)];
    let mut edges: Vec<(u32, u32)> = mesh.triangles.iter().flat_map(ends).collect();
    edges.sort_unstable();
    edges.dedup();
    let mut offsets = vec![0u32; mesh.positions.len() + 1];
    for &(from, _) in &edges {
        offsets[from as usize + 1] += 1;
    }
    for point in 0..mesh.positions.len() {
        offsets[point + 1] += offsets[point];
    }
    (offsets, edges.into_iter().map(|(_, to)| to).collect())
}

/// `sum of edge * (image edge)^T` over the edges whose two ends have images.
fn edges_covariance(point: usize, around: &[u32], own: &[Vector], image: &[Option<Vector>]) -> Matrix {
    let mut sum = Matrix::default();
    let Some(centre) = image[point] else { return sum };
    for &next in around {
        let Some(end) = image[next as usize] else { continue };
        let (edge, image_edge) = (subtract(own[next as usize], own[point]), subtract(end, centre));
        for row in 0..3 {
            for column in 0..3 {
                sum[row][column] += edge[row] * image_edge[column];
            }
        }
    }
    sum
}

/// Rounds of averaging that reach [`RADIUS`]: a random walk of n edges of length h goes `h sqrt(n)` far.
fn rounds(mesh: &Mesh) -> usize {
    let squared: f64 = mesh
        .triangles
        .iter()
        .map(|&[a, b, _]| {
            let edge = subtract(mesh.positions[a as usize], mesh.positions[b as usize]);
            edge.iter().map(|x| x * x).sum::<f64>()
        })
        .sum();
    let mean = squared / mesh.triangles.len() as f64;
    if mean > 0.0 { (RADIUS * RADIUS / mean).ceil().min(MOST_ROUNDS) as usize } else { 0 }
}

/// Mean over a point and its neighbours.
fn mean(point: usize, around: &[u32], values: &[Matrix]) -> Matrix {
    let mut sum = values[point];
    for &next in around {
        for row in 0..3 {
            for column in 0..3 {
                sum[row][column] += values[next as usize][row][column];
            }
        }
    }
    scaled(sum, 1.0 / (around.len() + 1) as f64)
}

fn scaled(matrix: Matrix, factor: f64) -> Matrix {
    matrix.map(|row| row.map(|value| value * factor))
}

/// `matrix * vector`.
pub(super) fn turned(matrix: &Matrix, vector: Vector) -> Vector {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// The rotation R that maximises `trace(R^T matrix)`: Horn's largest eigenvector of a 4 x 4 matrix.
fn nearest_rotation(matrix: &Matrix) -> Matrix {
    let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = *matrix;
    let symmetric = [
        [xx + yy + zz, zy - yz, xz - zx, yx - xy],
        [zy - yz, xx - yy - zz, xy + yx, xz + zx],
        [xz - zx, xy + yx, yy - xx - zz, yz + zy],
        [yx - xy, xz + zx, yz + zy, zz - xx - yy],
    ];
    let [w, x, y, z] = leading_eigenvector(symmetric);
    [
        [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
}

/// Unit eigenvector of the largest eigenvalue of a symmetric matrix, by cyclic Jacobi rotations.
fn leading_eigenvector(mut matrix: [[f64; 4]; 4]) -> [f64; 4] {
    let mut vectors: [[f64; 4]; 4] =
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    let size = matrix.iter().flatten().fold(0.0f64, |largest, value| largest.max(value.abs()));
    for _ in 0..12 {
        let off: f64 =
            (0..4).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| matrix[i][j].abs()).sum();
        if off <= 1e-15 * size {
            break;
        }
        for p in 0..3 {
            for q in p + 1..4 {
                rotate(&mut matrix, &mut vectors, p, q);
            }
        }
    }
    let largest = (1..4).fold(0, |best, i| if matrix[i][i] > matrix[best][best] { i } else { best });
    std::array::from_fn(|row| vectors[row][largest])
}

/// One Jacobi rotation that makes `matrix[p][q]` zero.
fn rotate(matrix: &mut [[f64; 4]; 4], vectors: &mut [[f64; 4]; 4], p: usize, q: usize) {
    if matrix[p][q] == 0.0 {
        return;
    }
    let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * matrix[p][q]);
    let tangent = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = tangent * cosine;
    for row in matrix.iter_mut() {
        (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
    }
    for k in 0..4 {
        (matrix[p][k], matrix[q][k]) =
            (cosine * matrix[p][k] - sine * matrix[q][k], sine * matrix[p][k] + cosine * matrix[q][k]);
    }
    for row in vectors.iter_mut() {
        (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rotation about an axis through the origin by Rodrigues' formula.
    fn rotation(axis: Vector, angle: f64) -> Matrix {
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [x, y, z] = axis.map(|coordinate| coordinate / length);
        let (s, c) = angle.sin_cos();
        let t = 1.0 - c;
        [
            [c + t * x * x, t * x * y - s * z, t * x * z + s * y],
            [t * x * y + s * z, c + t * y * y, t * y * z - s * x],
            [t * x * z - s * y, t * y * z + s * x, c + t * z * z],
        ]
    }

    #[test]
    fn a_rotation_is_its_own_nearest_one() {
        for (axis, angle) in [([1.0, 0.0, 0.0], 0.0), ([1.0, 2.0, 3.0], 1.0), ([0.3, -1.0, 0.1], 3.1)] {
            let expected = rotation(axis, angle);
            let found = nearest_rotation(&scaled(expected, 7.5));
            for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((a - b).abs() < 1e-12, "{found:?} instead of {expected:?}");
            }
        }
    }

    #[test]
    fn edges_in_a_plane_give_the_rotation_of_the_plane() {
        let expected = rotation([1.0, -2.0, 0.5], 0.7);
        let edges = [[1.0, 0.0, 0.0], [0.3, 1.0, 0.0], [-1.0, 0.4, 0.0]];
        let mut covariance = Matrix::default();
        for edge in edges {
            let image = turned(&expected, edge);
            for row in 0..3 {
                for column in 0..3 {
                    covariance[row][column] += image[row] * edge[column];
                }
            }
        }
        let found = nearest_rotation(&covariance);
        for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((a - b).abs() < 1e-12, "{found:?} instead of {expected:?}");
        }
    }
}
