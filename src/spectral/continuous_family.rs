//! Whether a surface has a continuous family of isometries, as a sphere, a torus or a vase has.
//!
//! A family moves each point along a curve, its orbit (the flow of a Killing vector field: M. Ben-Chen, A. Butscher,
//! J. Solomon, L. Guibas, "On Discrete Killing Vector Fields and Patterns on Surfaces", 2010), and whatever does not
//! change under isometries is constant there. So are heat kernel signatures, at all times at once (J. Sun,
//! M. Ovsjanikov, L. Guibas, "A Concise and Provably Informative Multi-Scale Signature Based on Heat Diffusion",
//! 2009): their gradients are parallel wherever there is a family, and almost nowhere where there is none.
//!
//! With the singular values `s1 >= s2` of the differential of the signatures, `s1^2 + s2^2` is the sum of the squared
//! gradients and `(s1 s2)^2` that of the squared brackets `n . (grad h_a x grad h_b)` of all pairs. The integral of a
//! bracket over the triangles around a vertex depends on the values around them alone, so that it feels the
//! triangulation much less than a gradient does.

use crate::spectral::dense::product;
use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::signature::{logarithms, mean};
use faer::{Mat, MatRef};

/// Times of the signatures, in units of the surface's area, in equal ratios.
const TIMES: [f64; 4] = [0.003, 0.0077, 0.0196, 0.05];
const PAIRS: usize = TIMES.len() * (TIMES.len() - 1) / 2;
/// For how long heat diffuses to smooth the signatures.
const SMOOTHING: f64 = 0.0005;
/// Share of the eigenpairs that is used: the last ones are the least accurate.
const ACCURATE: f64 = 0.8;
/// A surface whose [`least_gradient`] is below this has a family (`docs/method.md`).
const THRESHOLD: f64 = 0.012;
/// The squared gradient counts as at least this share of its mean.
const FLAT: f64 = 0.05;
/// Fewer vertices say too little.
const LEAST_VERTICES: usize = 24;
/// Fewer eigenfunctions as well, unless there are no more.
const LEAST_EIGENFUNCTIONS: usize = 50;
/// Curvature that counts as concentrated in a point, in radians: as in the corners of a prism of ten sides.
const CONE_POINT: f64 = 0.6;
/// As many points a family can leave in place.
const FIXED_POINTS: usize = 2;
/// From this number of sides on a polygon is as good as a circle.
const ROUND: usize = 12;
/// Coarser meshes than this are looked at for polygons.
const COARSE: usize = 2000;
/// Signatures that differ by less than this share of their deviation are equal.
const EQUAL: f64 = 0.01;

/// `ln h_t` of a vertex at each time.
type Signature = [f64; TIMES.len()];

/// What was measured, and the verdict.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbits {
    /// `least_gradient`; `None` if the surface cannot be oriented.
    pub least_gradient: Option<f64>,
    /// Whether there is a family.
    pub continuous: bool,
}

/// Looks for a family. O(vertices x eigenfunctions).
pub fn orbits(surface: &IntrinsicSurface, basis: &Eigenbasis) -> Orbits {
    let enough = basis.count() >= LEAST_EIGENFUNCTIONS.min(surface.vertex_count().saturating_sub(1));
    if !surface.orientable || basis.count() == 0 {
        return Orbits { least_gradient: None, continuous: false };
    }
    let basis = Lowest::of(basis);
    let weights = |eigenvalue: &f64| TIMES.map(|time| basis.weight(*eigenvalue, time));
    let weights: Vec<Signature> = basis.eigenvalues.iter().map(weights).collect();
    let signatures = logarithms(basis.eigenfunctions, &weights);
    let least_gradient = least_gradient(surface, &basis, &signatures);
    let continuous = least_gradient < THRESHOLD
        && surface.vertex_count() >= LEAST_VERTICES
        && enough
        && cone_points(surface) <= FIXED_POINTS
        && !is_polygonal(surface, &signatures);
    Orbits { least_gradient: Some(least_gradient), continuous }
}

/// The eigenpairs that are used.
struct Lowest<'a> {
    eigenvalues: &'a [f64],
    eigenfunctions: MatRef<'a, f64>,
}

impl Lowest<'_> {
    fn of(basis: &Eigenbasis) -> Lowest<'_> {
        let count = (ACCURATE * basis.count() as f64).ceil() as usize;
        Lowest {
            eigenvalues: &basis.eigenvalues[..count],
            eigenfunctions: basis.eigenfunctions.subcols(0, count),
        }
    }

    /// How much of a function is left after heat has diffused for `time`. It falls to 0 at the last one, so that it does
    /// not matter where a group of equal eigenvalues is cut.
    fn weight(&self, eigenvalue: f64, time: f64) -> f64 {
        let last = self.eigenvalues.last().copied().unwrap_or_default().max(f64::MIN_POSITIVE);
        (-eigenvalue * time).exp() * (1.0 - eigenvalue / last)
    }

    /// Each with its place.
    fn eigenvalues(&self) -> impl Iterator<Item = (usize, f64)> {
        self.eigenvalues.iter().copied().enumerate()
    }
}

/// Root mean square over the surface of the signatures' rate of change in the direction in which they change least, per
/// sqrt(area): 0 if the surface has a family.
fn least_gradient(surface: &IntrinsicSurface, basis: &Lowest, signatures: &[Signature]) -> f64 {
    let mass = &surface.lumped_mass;
    let weighted = Mat::from_fn(mass.len(), TIMES.len(), |v, t| mass[v] * signatures[v][t]);
    let integrals = gradient_products(surface, &diffused(basis, &weighted, SMOOTHING));
    let flat = FLAT * integrals.col_as_slice(PAIRS).iter().sum::<f64>();
    let least = |v: usize| {
        let brackets: f64 = (0..PAIRS).map(|pair| integrals[(v, pair)].powi(2)).sum();
        brackets / integrals[(v, PAIRS)].max(flat * mass[v]).max(f64::MIN_POSITIVE)
    };
    (0..mass.len()).map(least).sum::<f64>().sqrt()
}

/// The densities whose integrals over the vertices' areas are given, each column after heat has diffused for `time`.
fn diffused(basis: &Lowest, integrals: &Mat<f64>, time: f64) -> Mat<f64> {
    let mut coefficients = product(basis.eigenfunctions.transpose(), integrals.as_ref());
    for (j, eigenvalue) in basis.eigenvalues() {
        let weight = basis.weight(eigenvalue, time);
        (0..integrals.ncols()).for_each(|column| coefficients[(j, column)] *= weight);
    }
    let mut densities = product(basis.eigenfunctions, coefficients.as_ref());
    for column in 0..integrals.ncols() {
        let mean: f64 = integrals.col_as_slice(column).iter().sum();
        densities.col_as_slice_mut(column).iter_mut().for_each(|value| *value += mean);
    }
    densities
}

/// Integrals over each vertex's area of the brackets of all pairs of columns, and of the sum of their squared gradients
/// in a last column; all for the mean over the times.
fn gradient_products(surface: &IntrinsicSurface, values: &Mat<f64>) -> Mat<f64> {
    let mut integrals = Mat::zeros(values.nrows(), PAIRS + 1);
    let count = TIMES.len() as f64;
    for triangle in &surface.triangles {
        let [a, b, c] = triangle.map(|corner| corner as usize);
        let way =
            |to: usize| -> [f64; TIMES.len()] { std::array::from_fn(|t| values[(to, t)] - values[(a, t)]) };
        let (first, second) = (way(b), way(c));
        let pairs = (0..TIMES.len()).flat_map(|s| (0..s).map(move |t| (s, t)));
        for (pair, (s, t)) in pairs.enumerate() {
            let bracket = (first[s] * second[t] - second[s] * first[t]) / 2.0;
            for corner in [a, b, c] {
                integrals[(corner, pair)] += bracket / (3.0 * count);
            }
        }
    }
    for v in 0..values.nrows() {
        for (other, weight) in surface.stiffness.row(v) {
            let squares: f64 = (0..TIMES.len()).map(|t| (values[(v, t)] - values[(other, t)]).powi(2)).sum();
            integrals[(v, PAIRS)] -= weight * squares / (2.0 * count);
        }
    }
    integrals
}

/// Vertices inside the surface, without their likes beside them, that hold much curvature. A family leaves at most two
/// points in place, and no other can be a cone's tip.
fn cone_points(surface: &IntrinsicSurface) -> usize {
    let mut angles = vec![0.0; surface.vertex_count()];
    let mut triangles = vec![0usize; surface.vertex_count()];
    for (triangle, lengths) in surface.triangles.iter().zip(&surface.edge_lengths) {
        for corner in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|next| lengths[(corner + next) % 3]);
            let cosine = (b * b + c * c - a * a) / (2.0 * b * c);
            angles[triangle[corner] as usize] += cosine.clamp(-1.0, 1.0).acos();
            triangles[triangle[corner] as usize] += 1;
        }
    }
    let is_inside = |v: usize| triangles[v] == surface.stiffness.neighbours(v).len() - 1;
    let flat = |v: usize| if is_inside(v) { std::f64::consts::TAU } else { std::f64::consts::PI };
    let curvature: Vec<f64> = (0..angles.len()).map(|v| flat(v) - angles[v]).collect();
    // On a rough edge much curvature lies beside as much of the other sign.
    let around = |v: usize| -> f64 {
        surface.stiffness.neighbours(v).iter().map(|&other| curvature[other as usize]).sum()
    };
    let is_cone_point = |&v: &usize| is_inside(v) && curvature[v] > CONE_POINT && around(v) > CONE_POINT;
    (0..angles.len()).filter(is_cone_point).count()
}

/// Whether a coarse mesh consists of rings of few vertices, so that its signatures cannot tell a polygon from a circle.
fn is_polygonal(surface: &IntrinsicSurface, signatures: &[Signature]) -> bool {
    let vertices = surface.vertex_count();
    if vertices > COARSE {
        return false;
    }
    let deviation = mean_deviation(&surface.lumped_mass, signatures);
    let equal = |a: usize, b: usize| {
        (0..TIMES.len()).all(|t| (signatures[a][t] - signatures[b][t]).abs() < EQUAL * (deviation + 0.1))
    };
    let mut sizes = vec![0usize; vertices];
    let mut ring_of = vec![usize::MAX; vertices];
    for start in 0..vertices {
        if ring_of[start] != usize::MAX {
            continue;
        }
        ring_of[start] = start;
        let mut waiting = vec![start];
        while let Some(vertex) = waiting.pop() {
            sizes[start] += 1;
            for &next in surface.stiffness.neighbours(vertex) {
                if ring_of[next as usize] == usize::MAX && equal(vertex, next as usize) {
                    ring_of[next as usize] = start;
                    waiting.push(next as usize);
                }
            }
        }
    }
    let mut sides: Vec<usize> = ring_of.iter().map(|&ring| sizes[ring]).collect();
    let (_, middle, _) = sides.select_nth_unstable(vertices / 2);
    (3..ROUND).contains(middle)
}

/// Root mean square over the surface and all times.
fn mean_deviation(mass: &[f64], signatures: &[Signature]) -> f64 {
    let variance = |t: usize| {
        let at = || signatures.iter().map(|signature| signature[t]);
        let centre = mean(mass, at());
        mean(mass, at().map(|value| (value - centre).powi(2)))
    };
    ((0..TIMES.len()).map(variance).sum::<f64>() / TIMES.len() as f64).sqrt()
}
