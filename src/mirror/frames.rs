//! How directions turn under a symmetry: one orthogonal matrix per point, and displacements carried by it.
//!
//! The map itself says where the neighbours of a point go. The matrix that takes the edges around the
//! image best to the edges around the point, in the least-squares sense, is the local frame's image
//! (O. Sorkine, M. Alexa, "As-Rigid-As-Possible Surface Modeling", 2007, equation 5; the best rotation by
//! quaternions: B. K. P. Horn, "Closed-form solution of absolute orientation using unit quaternions", 1987).
//! A reflection's matrices have determinant -1. We deviate in averaging the edges' covariances over a
//! neighbourhood first: bending finer than that is shape, which a tool mirrors, and coarser bending is pose.

use super::{Mirroring, at};
use crate::base::error::Result;
use crate::base::symmetry_kind::SymmetryKind;
use crate::detect::correspondence::Symmetry;
use crate::mesh::rotation::{Matrix, nearest_rotation, scaled, turned};
use crate::mesh::vector::{Vector, subtract};
use crate::mesh::{Mesh, NONE};

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
