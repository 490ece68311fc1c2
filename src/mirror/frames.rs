//! How directions turn under a symmetry: one orthogonal matrix per point. Displacements are carried by it, and stretched.
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
//! A displacement is stretched with the surface, where one linear map explains most of the stretch. A bend of the space around a
//! head stretches neighbouring edges alike, and what is displaced there with them. A rig stretches the skin of a joint unevenly,
//! and turns what is displaced there. A ridge regression gives the difference of a turned edge and its image by their sum. Its
//! matrix f is multiplied by `2 R^2 - 1`, the share of the difference that it explains less the share that it leaves, and left out
//! where that is negative. The stretch is Cayley's transform, `(1 - f)^-1 (1 + f)` (A. Cayley, "Sur quelques propriétés des
//! déterminants gauches", 1846): f is reversed where edges and images are exchanged, and that gives the inverse. Radius and
//! rule were chosen on the heads and bumps of `docs/blender_table.md`.

use super::{Mirroring, at};
use crate::base::error::Result;
use crate::base::symmetry_kind::SymmetryKind;
use crate::detect::correspondence::Symmetry;
use crate::geometry::adjacency::Adjacency;
use crate::mesh::rotation::{Matrix, inverse, nearest_rotation, product, scaled, transposed, turned};
use crate::mesh::vector::{Vector, squared_norm, subtract};
use crate::mesh::{Mesh, NONE};
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Radius of the neighbourhood over which the covariances are averaged, in sqrt(area).
///
/// A wider one takes more of a wide dent for shape, and more of a bent joint too: on the posed human, with one
/// side winning, 0.03 leaves 0.46 of dents 0.1 wide and moves the body without dents by 0.006 (root mean
/// square, sqrt(area)), 0.06 leaves 0.35 and moves it by 0.008.
const RADIUS: f64 = 0.03;
/// The same for the stretch. A wider one tells joints better, and takes less of a bend. Near the mirror line of the posed human there
/// is no stretch; with 0.03 there is.
const STRETCH_RADIUS: f64 = 0.045;
/// Ridge of the stretch's regression, as a share of the trace: a flat neighbourhood is not stretched across.
const RIDGE: f64 = 0.01;
/// The largest norm of the regression's matrix: it stretches to three times the length.
const MOST_STRETCH: f64 = 0.5;
/// Most rounds of averaging over neighbours; each widens the radius by about an edge in the root.
const MOST_ROUNDS: f64 = 100.0;
/// Terms of less than this share of the first are left out of the averaging's series.
const LEAST_TERM: f64 = 1e-3;
/// An image is a vertex if its weight is more than this.
const WHOLE: f32 = 0.999;

const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Second moments of the sums s of turned edges and their images, and of the changes c: `c s^T`, the upper triangle of `s s^T`,
/// and c's squares. In single precision they fill one line of a processor's cache.
type Moments = [f32; 16];

/// What is averaged over neighbours.
trait Sum: Copy + Default {
    fn add(&mut self, value: &Self, weight: f64);
}

impl Sum for Matrix {
    fn add(&mut self, value: &Self, weight: f64) {
        for (sum, value) in self.as_flattened_mut().iter_mut().zip(value.as_flattened()) {
            *sum += weight * value;
        }
    }
}

impl Sum for Moments {
    fn add(&mut self, value: &Self, weight: f64) {
        for (sum, value) in self.iter_mut().zip(value) {
            *sum += weight as f32 * value;
        }
    }
}

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
        Frames { turn: Neighbourhoods::new(mesh, symmetry, positions).turns(symmetry.kind) }
    }
}

/// The edges around each point of a pose, and their images.
struct Neighbourhoods<'a> {
    mesh: &'a Mesh,
    graph: Adjacency,
    pairs: Vec<u32>,
    beneath: Vec<u32>,
    own: Vec<Vector>,
    image: Vec<Option<Vector>>,
}

impl<'a> Neighbourhoods<'a> {
    fn new(mesh: &'a Mesh, symmetry: &Symmetry, positions: &[Vector]) -> Self {
        let own: Vec<Vector> =
            mesh.vertex_of_point.iter().map(|&vertex| positions[vertex as usize]).collect();
        let around = Adjacency::triangles_around(own.len(), &mesh.triangles);
        let graph = Adjacency::of_vertices(&mesh.triangles, &around);
        let pairs = pairs(mesh, symmetry);
        let beneath = beneath(mesh, &pairs);
        Neighbourhoods { mesh, graph, pairs, beneath, own, image: images(mesh, symmetry, positions) }
    }

    /// Orthogonal matrix of each point.
    fn turns(&self, kind: SymmetryKind) -> Vec<Matrix> {
        let sign = if kind == SymmetryKind::Reflection { -1.0 } else { 1.0 };
        let covariance = self.averaged(RADIUS, |_, edge, image| edge.map(|x| image.map(|y| x * y)));
        let turn = |(&own, &other): (&Matrix, &u32)| {
            let mut both = own;
            if other != NONE {
                both.add(&transposed(&covariance[other as usize]), 1.0);
            }
            scaled(nearest_rotation(&scaled(both, sign)), sign)
        };
        covariance.iter().zip(&self.pairs).map(turn).collect()
    }

    /// Matrix of each point that turns and stretches.
    fn maps(&self, kind: SymmetryKind) -> Vec<Matrix> {
        let turns = self.turns(kind);
        // Single precision has a smaller range.
        let unit = self.own.as_flattened().iter().fold(0.0f64, |most, x| most.max(x.abs())).recip();
        let moments = self.averaged(STRETCH_RADIUS, |point, edge, image| {
            let edge = turned(&transposed(&turns[point]), edge);
            let [x, y, z] = [0, 1, 2].map(|axis| unit * (edge[axis] + image[axis]));
            let [a, b, c] = subtract(edge, image).map(|value| unit * value);
            let squares = a * a + b * b + c * c;
            let changes = [a * x, a * y, a * z, b * x, b * y, b * z, c * x, c * y, c * z];
            let sums = [x * x, x * y, x * z, y * y, y * z, z * z, squares];
            std::array::from_fn(|k| if k < 9 { changes[k] as f32 } else { sums[k - 9] as f32 })
        });
        let map = |(point, turn): (usize, &Matrix)| {
            let (mut sums, mut changes, mut squares) = split(&moments[point]);
            let other = self.pairs[point];
            if other != NONE {
                let other = split(&moments[other as usize]);
                let here = |matrix: &Matrix| product(&product(&transposed(turn), matrix), turn);
                sums.add(&here(&other.0), 1.0);
                changes.add(&here(&other.1), -1.0);
                squares += other.2;
            }
            product(turn, &stretch(&sums, &changes, squares))
        };
        turns.iter().enumerate().map(map).collect()
    }

    /// Sums of `value(point, edge, image)` over the edges around each point whose two ends have images, averaged over a neighbourhood.
    fn averaged<T: Sum>(&self, radius: f64, value: impl Fn(usize, Vector, Vector) -> T) -> Vec<T> {
        let sum = |point: usize| {
            let mut sum = T::default();
            let Some(centre) = self.image[point] else { return sum };
            for &next in self.graph.of(point) {
                let Some(end) = self.image[next as usize] else { continue };
                let edge = subtract(self.own[next as usize], self.own[point]);
                sum.add(&value(point, edge, subtract(end, centre)), 1.0);
            }
            sum
        };
        let sums = (0..self.own.len()).map(sum).collect();
        averaged(&self.graph, &self.beneath, sums, rounds(self.mesh, radius))
    }
}

/// The matrices `s s^T` and `c s^T`, and the sum of c's squares.
fn split(moments: &Moments) -> (Matrix, Matrix, f64) {
    let [a, b, c, d, e, f, g, h, i, xx, xy, xz, yy, yz, zz, squares] = moments.map(f64::from);
    ([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], [[a, b, c], [d, e, f], [g, h, i]], squares)
}

/// The stretch that takes images of edges to turned edges, by the share of their change that it explains less the share that it leaves.
fn stretch(sums: &Matrix, changes: &Matrix, squares: f64) -> Matrix {
    let fitted = product(changes, &inverse(&plus(sums, RIDGE * trace(sums))));
    let share = 2.0 * inner(&fitted, changes) / squares - 1.0;
    if share > 0.0 {
        let size = inner(&fitted, &fitted).sqrt();
        let fitted = scaled(fitted, -share.min(MOST_STRETCH / size));
        // (1 - f)^-1 (1 + f) = 2 (1 - f)^-1 - 1.
        plus(&scaled(inverse(&plus(&fitted, 1.0)), 2.0), -1.0)
    } else {
        IDENTITY
    }
}

/// Carries a displacement field across the map: what happens at the image happens here, turned and stretched with the surface.
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
    let maps = Neighbourhoods::new(mesh, symmetry, positions).maps(symmetry.kind);
    let mut carried = displacements.to_vec();
    for (vertex, share) in shares.into_iter().enumerate().filter(|(_, share)| *share > 0.0) {
        let point = mesh.point_of_vertex[vertex];
        let Some(image) = symmetry.surface_point[vertex].filter(|_| point != NONE) else { continue };
        let there = [0, 1, 2].map(|axis| at(&image, displacements.as_flattened(), 3, axis));
        let here = turned(&maps[point as usize], there);
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
    let (largest, others): (Vec<usize>, Vec<usize>) =
        (0..pairs.len()).partition(|&point| mesh.shell_of_point[point] == 0);
    let alone: Vec<usize> = others.into_iter().filter(|&point| pairs[point] == NONE).collect();
    if alone.is_empty() {
        return found;
    }
    let leaf = |point: usize| GeomWithData::new(mesh.positions[point], point as u32);
    let tree = RTree::bulk_load(largest.into_iter().map(leaf).collect());
    for point in alone {
        let place = mesh.positions[point];
        let below = tree.nearest_neighbor(place).expect("the largest shell has points");
        if squared_norm(subtract(place, *below.geom())) < RADIUS * RADIUS {
            found[point] = below.data;
        }
    }
    found
}

/// Rounds of averaging that reach a radius: a random walk of n edges of length h goes `h sqrt(n)` far.
fn rounds(mesh: &Mesh, radius: f64) -> usize {
    let squared: f64 = mesh
        .triangles
        .iter()
        .map(|&[a, b, _]| {
            let edge = subtract(mesh.positions[a as usize], mesh.positions[b as usize]);
            edge.iter().map(|x| x * x).sum::<f64>()
        })
        .sum();
    let mean = squared / mesh.triangles.len() as f64;
    if mean > 0.0 { (radius * radius / mean).ceil().min(MOST_ROUNDS) as usize } else { 0 }
}

/// The values after `rounds` rounds of averaging over each point, its neighbours and what is beneath it, up to some [`LEAST_TERM`].
///
/// `x^n = sum over k of P(|Y| = k) T_k(x)`, where Y is the end of a walk of n steps of 1 or -1 and T_k a Chebyshev polynomial, of which those
/// below about `4 sqrt(n)` count (S. Sachdeva, N. Vishnoi, "Faster Algorithms via Approximation Theory", 2014, section 3); x is the averaging.
fn averaged<T: Sum>(graph: &Adjacency, beneath: &[u32], values: Vec<T>, rounds: usize) -> Vec<T> {
    let terms = terms(rounds);
    let mut sum: Vec<T> = values.iter().map(|value| weighted(value, terms[0])).collect();
    let mut now: Vec<T> = (0..values.len()).map(|point| mean(graph, beneath, point, &values)).collect();
    let mut last = values;
    for &term in &terms[1..] {
        for (point, last) in last.iter_mut().enumerate() {
            sum[point].add(&now[point], term);
            let mut next = weighted(&mean(graph, beneath, point, &now), 2.0);
            next.add(last, -1.0);
            *last = next;
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
fn mean<T: Sum>(graph: &Adjacency, beneath: &[u32], point: usize, values: &[T]) -> T {
    let around = graph.of(point);
    let (mut sum, mut count) = (values[point], around.len() + 1);
    around.iter().for_each(|&next| sum.add(&values[next as usize], 1.0));
    if beneath[point] != NONE {
        sum.add(&values[beneath[point] as usize], 1.0);
        count += 1;
    }
    weighted(&sum, 1.0 / count as f64)
}

fn weighted<T: Sum>(value: &T, weight: f64) -> T {
    let mut sum = T::default();
    sum.add(value, weight);
    sum
}

/// The sum of the products of two matrices' entries.
fn inner(first: &Matrix, second: &Matrix) -> f64 {
    first.as_flattened().iter().zip(second.as_flattened()).map(|(a, b)| a * b).sum()
}

fn trace(matrix: &Matrix) -> f64 {
    inner(matrix, &IDENTITY)
}

/// `matrix + diagonal * 1`.
fn plus(matrix: &Matrix, diagonal: f64) -> Matrix {
    let mut sum = *matrix;
    sum.add(&IDENTITY, diagonal);
    sum
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
