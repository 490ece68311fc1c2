//! Confidence: the probability that a partner lies within 0.05 sqrt(area) of the true mirror image.
//!
//! A logistic model of what can be seen without the truth: how well the vertex's embedded image is
//! met, how far the vertex is from the image of its image, and how clearly the whole map beats the
//! next distinct one. The weights are fitted on generated shapes with known truth (`docs/method.md`).

use crate::eigenbasis::Eigenbasis;
use crate::full_refinement::{MatchTarget, TrianglePoint, VertexImages};
use crate::laplacian::IntrinsicSurface;

/// What the model sees of one vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Distance between the embedded image and the point it was matched to, about in sqrt(area).
    pub residual: f64,
    /// Distance between the vertex and the image of its image, about in sqrt(area).
    pub cycle: f64,
}

/// Weights of the logistic model: constant, ln(residual), ln(cycle), margin.
const WEIGHTS: [f64; 4] = [-2.8436, -0.1561, -0.3748, 1.5342];
/// Added before each logarithm.
const FLOOR: f64 = 0.002;

/// Confidence of every vertex, 0..=1, for a map that beats the next one by `margin` (0..=2).
pub fn confidence(evidence: &[Evidence], margin: f64) -> Vec<f32> {
    evidence
        .iter()
        .map(|seen| {
            let local = WEIGHTS[1] * (seen.residual + FLOOR).ln() + WEIGHTS[2] * (seen.cycle + FLOOR).ln();
            (1.0 / (1.0 + (-(WEIGHTS[0] + local + WEIGHTS[3] * margin)).exp())) as f32
        })
        .collect()
}

/// Evidence of every vertex of a shell that is mapped onto itself. O(vertices x size).
pub fn evidence(target: &MatchTarget, size: usize, images: &VertexImages) -> Vec<Evidence> {
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
    (0..images.partners.len())
        .map(|vertex| Evidence {
            residual: f64::from(images.residuals[vertex]) / stretch[images.partners[vertex] as usize],
            cycle: round_trip(vertex),
        })
        .collect()
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
