//! Confidence: the probability that a partner lies within 0.05 sqrt(area) of the true mirror image.
//!
//! A logistic model of what can be seen without the truth: how far the vertex is from the image of its image,
//! how far its heat kernel signature is from its image's, and how clearly the whole map beats the next
//! distinct one. The weights are fitted on generated shapes with known truth (`docs/method.md`).

use crate::eigenbasis::Eigenbasis;
use crate::full_refinement::{MatchTarget, TrianglePoint, VertexImages};
use crate::laplacian::IntrinsicSurface;

/// Weights of the logistic model: constant, ln(round trip), ln(signature mismatch), margin.
const WEIGHTS: [f64; 4] = [-1.8365, -0.1986, -0.3476, 1.1833];
/// Added before each of the logarithms.
const FLOORS: [f64; 2] = [0.002, 0.02];

/// Confidence of every vertex, 0..=1, from its [`round_trips`] and its [`crate::signature::mismatch`], for a
/// map that beats the next one by `margin` (0..=2).
pub fn confidence(round_trips: &[f64], mismatch: &[f64], margin: f64) -> Vec<f32> {
    let of_vertex = |(round_trip, mismatch): (&f64, &f64)| {
        let local = WEIGHTS[1] * (round_trip + FLOORS[0]).ln() + WEIGHTS[2] * (mismatch + FLOORS[1]).ln();
        (1.0 / (1.0 + (-(WEIGHTS[0] + local + WEIGHTS[3] * margin)).exp())) as f32
    };
    round_trips.iter().zip(mismatch).map(of_vertex).collect()
}

/// Distance of every vertex from the image of its image in the embedding of the first `size` eigenfunctions, about
/// in sqrt(area), for a shell that is mapped onto itself. O(vertices x size).
pub fn round_trips(target: &MatchTarget, size: usize, images: &VertexImages) -> Vec<f64> {
    let stretch = embedding_stretch(target.surface, target.basis, size);
    let functions = target.basis.eigenfunctions.as_ref();
    let round_trip = |vertex: usize| {
        let there = images.points[vertex];
        let corners = target.surface.triangles[there.triangle as usize];
        let mut squared = 0.0;
        for j in 0..size {
            let back: f64 = (0..3)
                .map(|c| {
                    f64::from(there.barycentric[c]) * value(target, &images.points[corners[c] as usize], j)
                })
                .sum();
            squared += (back - functions[(vertex, j)]).powi(2);
        }
        squared.sqrt() / stretch[vertex]
    };
    (0..images.points.len()).map(round_trip).collect()
}

fn value(target: &MatchTarget, point: &TrianglePoint, function: usize) -> f64 {
    let column = target.basis.eigenfunctions.col_as_slice(function);
    let corners = target.surface.triangles[point.triangle as usize];
    (0..3).map(|c| f64::from(point.barycentric[c]) * column[corners[c] as usize]).sum()
}

/// Embedding distance per unit of surface distance around each vertex, from its triangles' edges.
fn embedding_stretch(surface: &IntrinsicSurface, basis: &Eigenbasis, size: usize) -> Vec<f64> {
    let count = surface.vertex_count();
    let (mut embedded, mut real) = (vec![0.0; count], vec![0.0; count]);
    for (triangle, lengths) in surface.triangles.iter().zip(&surface.edge_lengths) {
        for corner in 0..3 {
            let (a, b) = (triangle[(corner + 1) % 3] as usize, triangle[(corner + 2) % 3] as usize);
            let squared: f64 = (0..size)
                .map(|j| {
                    let column = basis.eigenfunctions.col_as_slice(j);
                    (column[a] - column[b]).powi(2)
                })
                .sum();
            for vertex in [a, b] {
                embedded[vertex] += squared.sqrt();
                real[vertex] += lengths[corner];
            }
        }
    }
    let ratio = |(e, r): (f64, f64)| if r > 0.0 && e > 0.0 { e / r } else { 1.0 };
    embedded.into_iter().zip(real).map(ratio).collect()
}
