//! Confidence: the probability that a partner lies within 0.05 sqrt(area) of the true mirror image.
//!
//! A logistic model of what can be seen without the truth: how far the vertices around are from the images of
//! their images, how clearly the whole map beats the next distinct one, and how far the heat kernel signatures
//! of partners differ on the whole. The weights are fitted on generated shapes with known truth (`docs/method.md`).

use crate::acceptance::Judgement;
use crate::full_refinement::MatchTarget;
use crate::laplacian::IntrinsicSurface;
use crate::shell_symmetry::ShellSymmetry;
use crate::vertex_rows::{Guide, VertexRows};
use std::ops::Range;

/// Weights of the logistic model: constant, then those of [`Evidence::features`].
const WEIGHTS: [f64; 5] = [-19.4656, -7.2554, -0.7361, 0.9095, -1.3079];
/// Rounds of averaging over neighbours: a vertex is judged by its surroundings.
const SMOOTHING_ROUNDS: usize = 3;

/// What is seen of a finished map without the truth.
pub struct Evidence {
    /// Distance of each vertex from the image of its image, about in sqrt(area).
    pub round_trip: Vec<f64>,
    /// How clearly the whole map beats the next distinct one, 0..=2.
    pub margin: f64,
    /// What the whole map was judged by.
    pub judged: Judgement,
}

impl Evidence {
    /// Gathers the evidence of a shell's map onto itself. O(vertices x eigenfunctions).
    pub fn new(target: &MatchTarget, found: &ShellSymmetry) -> Evidence {
        let columns = target.rows.columns(found.map.nrows(), Guide::Eigenfunctions);
        let images = target.rows_at(&target.rows, &found.images.points);
        let back = target.rows_at(&images, &found.images.points);
        let scale = embedding_scale(target.surface, &target.rows, &columns);
        Evidence {
            round_trip: smoothed(target.surface, round_trips(&target.rows, &back, &columns, &scale)),
            margin: found.margin,
            judged: found.judged,
        }
    }

    /// The columns of the logistic model at a vertex.
    pub fn features(&self, vertex: usize) -> [f64; WEIGHTS.len() - 1] {
        let round_trip = (self.round_trip[vertex] + 0.002).ln();
        let signature_mismatch = (self.judged.signature_mismatch + 0.002).ln();
        [round_trip, round_trip * round_trip, self.margin, signature_mismatch]
    }

    /// Confidence of every vertex, 0..=1.
    pub fn confidence(&self) -> Vec<f32> {
        let of_vertex = |vertex: usize| {
            let terms = self.features(vertex).into_iter().zip(&WEIGHTS[1..]);
            let logit = WEIGHTS[0] + terms.map(|(feature, weight)| feature * weight).sum::<f64>();
            (1.0 / (1.0 + (-logit).exp())) as f32
        };
        (0..self.round_trip.len()).map(of_vertex).collect()
    }
}

/// Averages over the neighbours.
fn smoothed(surface: &IntrinsicSurface, mut values: Vec<f64>) -> Vec<f64> {
    for _ in 0..SMOOTHING_ROUNDS {
        let mean = |vertex: usize| {
            let around = surface.stiffness.neighbours(vertex);
            around.iter().map(|&next| values[next as usize]).sum::<f64>() / around.len() as f64
        };
        values = (0..values.len()).map(mean).collect();
    }
    values
}

/// Distance of every vertex from the image of its image, `back`, about in sqrt(area).
fn round_trips(rows: &VertexRows, back: &VertexRows, columns: &Range<usize>, scale: &[f64]) -> Vec<f64> {
    let distance =
        |vertex: usize| f64::from(rows.distance(vertex, back, vertex, columns)).sqrt() / scale[vertex];
    (0..scale.len()).map(distance).collect()
}

/// Embedding distance per unit of surface distance around each vertex, from its triangles' edges.
fn embedding_scale(surface: &IntrinsicSurface, rows: &VertexRows, columns: &Range<usize>) -> Vec<f64> {
    let count = surface.vertex_count();
    let (mut embedded, mut real) = (vec![0.0; count], vec![0.0; count]);
    for (triangle, lengths) in surface.triangles.iter().zip(&surface.edge_lengths) {
        for corner in 0..3 {
            let (a, b) = (triangle[(corner + 1) % 3] as usize, triangle[(corner + 2) % 3] as usize);
            let distance = f64::from(rows.distance(a, rows, b, columns)).sqrt();
            for vertex in [a, b] {
                embedded[vertex] += distance;
                real[vertex] += lengths[corner];
            }
        }
    }
    let ratio = |(e, r): (f64, f64)| if r > 0.0 && e > 0.0 { e / r } else { 1.0 };
    embedded.into_iter().zip(real).map(ratio).collect()
}
