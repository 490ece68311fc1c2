//! Heat kernel signatures, and how far those of a point and its image differ.
//!
//! `h_t(x) = sum_j exp(-lambda_j t) phi_j(x)^2` does not change under isometries and does not care which
//! eigenfunctions of a repeated eigenvalue were taken (J. Sun, M. Ovsjanikov, L. Guibas, "A Concise and
//! Provably Informative Multi-Scale Signature Based on Heat Diffusion", 2009). No map is made from it, so it
//! is evidence of its own: a map that commutes well with the Laplacian but pairs a thin limb with a thick one
//! shows here.

use crate::geometry::embedded_triangles::TrianglePoint;
use crate::geometry::vertex_map::VertexMap;
use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::laplacian::IntrinsicSurface;
use faer::{MatRef, RowRef};

/// Times at which heat is looked at.
const TIMES: usize = 12;
/// The first and the last of them, in units of the surface's area; the others lie between in equal ratios.
/// Heat spreads over about the width of a limb in the first and over a whole limb in the last.
const TIME_RANGE: [f64; 2] = [0.002, 0.05];

/// `ln h_t` of a vertex at each time.
type Signature = [f64; TIMES];

/// Difference of the signatures of each vertex and its image, in units of the signatures' mean deviation over the
/// whole surface: 0 for an isometry, about 1 for a random map. O(vertices x eigenfunctions).
pub fn mismatch(surface: &IntrinsicSurface, basis: &Eigenbasis, images: &VertexMap) -> Vec<f64> {
    let signatures = signatures(basis);
    let deviation = mean_deviation(&surface.lumped_mass, &signatures);
    let difference = |own: &Signature, point: &TrianglePoint| {
        let corners = surface.triangles[point.triangle as usize].map(|corner| &signatures[corner as usize]);
        let at_image = |t: usize| -> f64 {
            corners.iter().zip(point.barycentric).map(|(corner, weight)| f64::from(weight) * corner[t]).sum()
        };
        let relative = |t: usize| (own[t] - at_image(t)).abs() / deviation[t];
        (0..TIMES).filter(|&t| deviation[t] > 0.0).map(relative).sum::<f64>() / TIMES as f64
    };
    signatures.iter().zip(&images.points).map(|(own, point)| difference(own, point)).collect()
}

/// Mean of values that stand for `areas`.
pub fn mean(areas: &[f64], values: impl Iterator<Item = f64>) -> f64 {
    values.zip(areas).map(|(value, area)| value * area).sum::<f64>() / areas.iter().sum::<f64>()
}

/// Signatures of all vertices.
fn signatures(basis: &Eigenbasis) -> Vec<Signature> {
    let [first, last] = TIME_RANGE;
    let time = |t: usize| first * (last / first).powf(t as f64 / (TIMES - 1) as f64);
    let decay = |eigenvalue: &f64| -> Signature { std::array::from_fn(|t| (-eigenvalue * time(t)).exp()) };
    let decays: Vec<Signature> = basis.eigenvalues.iter().map(decay).collect();
    logarithms(basis.eigenfunctions.as_ref(), &decays)
}

/// `ln(1 + sum_j weights[j] phi_j(x)^2)` of each vertex x: the constant function of a surface of unit area adds 1 to a signature,
/// and its logarithm is never below 0.
pub fn logarithms<const N: usize>(functions: MatRef<f64>, weights: &[[f64; N]]) -> Vec<[f64; N]> {
    let logarithm = |row: RowRef<f64>| {
        let mut sums = [1.0; N];
        for (value, weights) in row.iter().zip(weights) {
            sums.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * (value * value));
        }
        sums.map(f64::ln)
    };
    functions.row_iter().map(logarithm).collect()
}

/// About the mean, of each time.
fn mean_deviation(areas: &[f64], signatures: &[Signature]) -> Signature {
    std::array::from_fn(|t| {
        let at = || signatures.iter().map(|signature| signature[t]);
        let centre = mean(areas, at());
        mean(areas, at().map(|value| (value - centre).abs()))
    })
}
