//! How directions turn under a symmetry: one orthogonal matrix per point, and displacements carried by it.
//!
//! The map itself says where the neighbours of a point go. The matrix that takes the edges around the
//! image best to the edges around the point, in the least-squares sense, is the local frame's image
//! (O. Sorkine, M. Alexa, "As-Rigid-As-Possible Surface Modeling", 2007, equation 5; the best rotation by
//! quaternions: B. K. P. Horn, "Closed-form solution of absolute orientation using unit quaternions", 1987).
//! A reflection's matrices have determinant -1. We deviate in averaging the edges' covariances over a
//! neighbourhood first: bending finer than that is shape, which a tool mirrors, and coarser bending is pose.
//! Where two points are each other's images, one's matrix is the other's inverse: the covariances of both are one's
//! and the other's transpose, and are added, as diagonals of faces need not be mirrored. On a small shell, as an eyelash,
//! points without such a pair average over the largest shell beneath them, too: alone they would follow the map's noise.
//!
//! A matrix turns and does not stretch. A rig moves the skin of a joint apart, yet turns what is displaced there.

use super::{Mirroring, at};
use crate::base::error::Result;
use crate::base::symmetry_kind::SymmetryKind;
use crate::detect::correspondence::Symmetry;
use crate::geometry::adjacency::Adjacency;
use crate::mesh::rotation::{Matrix, nearest_rotation, scaled, transposed, turned};
use crate::mesh::vector::{Vector, squared_norm, subtract};
use crate::mesh::{Mesh, NONE, anchors};

/// Radius of the neighbourhood over which the covariances are averaged, in sqrt(area).
///
/// A wider one takes more of a wide dent for shape, and more of a bent joint too: on the posed human, with one
/// side winning, 0.03 leaves 0.46 of dents 0.1 wide and moves the body without dents by 0.006 (root mean
/// square, sqrt(area)), 0.06 leaves 0.35 and moves it by 0.008.
const RADIUS: f64 = 0.03;
/// Most rounds of averaging over neighbours; each widens the radius by about an edge in the root.
const MOST_ROUNDS: f64 = 100.0;
/// Terms of less than this share of the first are left out of the averaging's series.
const LEAST_TERM: f64 = 1e-3;
/// An image is a vertex if its weight is more than this.
const WHOLE: f32 = 0.999;

/// How directions at the image of each point turn into directions at the point.
#[derive(Debug, Clone)]
pub struct Frames {
    /// Orthogonal matrix of each point of the mesh, with the determinant of the symmetry's kind.
    pub turn: Vec<Matrix>,
}

impl Frames {
    /// Fits the matrices to `positions`, one per caller's vertex: those of the mesh, or of another pose.
    ///
    /// Time O(edges * sqrt(rounds)), at most 100 rounds. A point without image gets the identity (negated for a
    /// reflection).
    pub fn new(mesh: &Mesh, symmetry: &Symmetry, positions: &[Vector]) -> Frames {
        let own: Vec<Vector> =
            mesh.vertex_of_point.iter().map(|&vertex| positions[vertex as usize]).collect();
        let image = images(mesh, symmetry, positions);
        let around = Adjacency::triangles_around(own.len(), &mesh.triangles);
        let graph = Adjacency::of_vertices(&mesh.triangles, &around);
        let covariance =
            (0..own.len()).map(|point| edges_covariance(point, graph.of(point), &own, &image)).collect();
        let pairs = pairs(mesh, symmetry);
        let covariance = averaged(&graph, &beneath(mesh, &pairs), covariance, rounds(mesh));
        let covariance = mutual(&pairs, covariance);
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

/// The image of each point, where it is a point whose image is this one; [`NONE`] elsewhere.
fn pairs(mesh: &Mesh, symmetry: &Symmetry) -> Vec<u32> {
    let image = |point: usize| {
        let there = symmetry.surface_point[mesh.vertex_of_point[point] as usize]?;
        let corner = there.barycentric.iter().position(|&weight| weight > WHOLE)?;
        Some(mesh.point_of_vertex[there.vertices[corner] as usize]).filter(|&image| image != NONE)
    };
    let pair = |point: usize| image(point).filter(|&other| image(other as usize) == Some(point as u32));
    (0..mesh.positions.len()).map(|point| pair(point).unwrap_or(NONE)).collect()
}

/// The nearest point of the largest shell beneath each point of another one without a pair, if it is within [`RADIUS`]; [`NONE`] elsewhere.
fn beneath(mesh: &Mesh, pairs: &[u32]) -> Vec<u32> {
    let mut found = vec![NONE; pairs.len()];
    if mesh.shell_count == 1 || !pairs.contains(&NONE) {
        return found;
    }
    let shells = mesh.shells();
    for (shell, anchors) in shells.iter().zip(anchors(mesh, &shells, 0)) {
        for (&point, anchor) in shell.points.iter().zip(anchors) {
            let below = shells[0].points[anchor as usize];
            let off = subtract(mesh.positions[point as usize], mesh.positions[below as usize]);
            if pairs[point as usize] == NONE && squared_norm(off) < RADIUS * RADIUS {
                found[point as usize] = below;
            }
        }
    }
    found
}

/// The sums of each covariance and the transposed one of its image, where two points are each other's images.
fn mutual(pairs: &[u32], covariance: Vec<Matrix>) -> Vec<Matrix> {
    let both = |(&own, &other): (&Matrix, &u32)| {
        let mut sum = own;
        if other != NONE {
            add(&mut sum, &transposed(&covariance[other as usize]), 1.0);
        }
        sum
    };
    covariance.iter().zip(pairs).map(both).collect()
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

/// The values after `rounds` rounds of averaging over each point, its neighbours and what is beneath it, up to some [`LEAST_TERM`].
///
/// `x^n = sum over k of P(|Y| = k) T_k(x)`, where Y is the end of a walk of n steps of 1 or -1 and T_k a Chebyshev polynomial, of which those
/// below about `4 sqrt(n)` count (S. Sachdeva, N. Vishnoi, "Faster Algorithms via Approximation Theory", 2014, section 3); x is the averaging.
fn averaged(graph: &Adjacency, beneath: &[u32], values: Vec<Matrix>, rounds: usize) -> Vec<Matrix> {
    let terms = terms(rounds);
    let mut sum: Vec<Matrix> = values.iter().map(|value| scaled(*value, terms[0])).collect();
    let mut now: Vec<Matrix> = (0..values.len()).map(|point| mean(graph, beneath, point, &values)).collect();
    let mut last = values;
    for &term in &terms[1..] {
        for (point, last) in last.iter_mut().enumerate() {
            add(&mut sum[point], &now[point], term);
            let next = scaled(mean(graph, beneath, point, &now), 2.0);
            *last = std::array::from_fn(|row| subtract(next[row], last[row]));
        }
        std::mem::swap(&mut last, &mut now);
    }
    sum
}

/// Weights of the Chebyshev polynomials in x^n, as far as they count, scaled to a sum of 1.
fn terms(n: usize) -> Vec<f64> {
    let mut terms = vec![0.0; n % 2];
    let (mut term, mut k) = (1.0, n % 2);
    while term >= LEAST_TERM {
        terms.extend([if k == 0 { 0.5 * term } else { term }, 0.0]);
        term *= (n - k) as f64 / (n + k + 2) as f64;
        k += 2;
    }
    terms.pop();
    let sum: f64 = terms.iter().sum();
    terms.into_iter().map(|term| term / sum).collect()
}

/// Mean over a point, its neighbours and what is beneath it.
fn mean(graph: &Adjacency, beneath: &[u32], point: usize, values: &[Matrix]) -> Matrix {
    let around = graph.of(point);
    let (mut sum, mut count) = (values[point], around.len() + 1);
    around.iter().for_each(|&next| add(&mut sum, &values[next as usize], 1.0));
    if beneath[point] != NONE {
        add(&mut sum, &values[beneath[point] as usize], 1.0);
        count += 1;
    }
    scaled(sum, 1.0 / count as f64)
}

fn add(sum: &mut Matrix, value: &Matrix, weight: f64) {
    for (sum, value) in sum.as_flattened_mut().iter_mut().zip(value.as_flattened()) {
        *sum += weight * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of 30 points with 15 chords.
    fn ring() -> Adjacency {
        let chords = (0..15u32).map(|i| (i, (7 * i + 4) % 30));
        let edges = (0..30u32).map(|i| (i, (i + 1) % 30)).chain(chords);
        let flat: Vec<[u32; 3]> = edges.map(|(a, b)| [a, b, b]).collect();
        Adjacency::of_vertices(&flat, &Adjacency::triangles_around(30, &flat))
    }

    #[test]
    fn the_series_is_what_round_after_round_gives() {
        let (graph, none) = (ring(), [NONE; 30]);
        let start: Vec<Matrix> =
            (0..30).map(|i| [[f64::from(i * i % 11), f64::from(i % 3), 1.0]; 3]).collect();
        for rounds in [0, 1, 2, 7, 20, 51, 100] {
            let mut stepped = start.clone();
            for _ in 0..rounds {
                stepped = (0..30).map(|point| mean(&graph, &none, point, &stepped)).collect();
            }
            let series = averaged(&graph, &none, start.clone(), rounds);
            let off = |(a, b): (&f64, &f64)| (a - b).abs();
            let off =
                series.as_flattened().iter().flatten().zip(stepped.as_flattened().iter().flatten()).map(off);
            let most = off.fold(0.0, f64::max);
            assert!(most < 0.005, "{rounds}: {most}");
            // What is the same everywhere stays.
            assert!(series.iter().all(|matrix| (matrix[0][2] - 1.0).abs() < 1e-12));
        }
        assert_eq!(terms(100).len(), 37);
    }
}
