//! Confidence: an estimate, fitted on generated shapes, of the probability that a partner lies within 0.05 sqrt(area) of the true mirror image.
//!
//! A logistic model of what can be seen without the truth: how far the vertices around are from the images of
//! their images and from their own images (a map that hardly moves a region is seldom right there), and how much
//! other candidates for the map, which score little worse, send them elsewhere, there and on the whole. The weights
//! are fitted on generated shapes with known truth (`docs/method.md`).

use crate::geometry::adjacency::nearest_seeds;
use crate::refine::full_refinement::MatchTarget;
use crate::refine::vertex_rows::VertexRows;
use crate::spectral::laplacian::IntrinsicSurface;
use crate::verify::acceptance::probability;
use crate::verify::hypothesis::Hypothesis;
use std::ops::Range;

/// Weights of the logistic model: constant, then those of [`Evidence::features`].
const WEIGHTS: [f64; 5] = [-3.9996, -1.4399, 0.8458, -0.4073, -2.9828];
/// Rounds of averaging over neighbours: a vertex is judged by its surroundings.
const SMOOTHING_ROUNDS: usize = 3;

/// What is seen of a finished map without the truth.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// Distance of each vertex from the image of its image, about in sqrt(area).
    pub round_trip: Vec<f64>,
    /// Distance of each vertex from its image; about in sqrt(area) if small, else less than that.
    pub way: Vec<f64>,
    /// How much speaks for another image of each vertex, 0..=1.
    pub doubt: Vec<f64>,
    /// Mean of the doubts over the shell.
    pub mean_doubt: f64,
}

impl Evidence {
    /// Gathers the evidence of a shell's map onto itself. O(vertices x eigenfunctions).
    pub fn new(target: &MatchTarget, found: &Hypothesis) -> Evidence {
        let columns = target.rows.function_columns(found.map.nrows());
        let images = target.rows_at(&target.rows, &found.images.points);
        let back = target.rows_at(&images, &found.images.points);
        let scale = embedding_scale(target.surface, &target.rows, &columns);
        let distances = |there: &VertexRows| distances(&target.rows, there, &columns, &scale);
        let doubts = found.doubts.iter().map(|(_, doubt)| doubt);
        let smoothed = |values| target.surface.stiffness.averaged(values, SMOOTHING_ROUNDS);
        Evidence {
            round_trip: smoothed(distances(&back)),
            way: smoothed(distances(&images)),
            doubt: smoothed(of_nearest(target.surface, &found.doubts)),
            mean_doubt: doubts.sum::<f64>() / found.doubts.len().max(1) as f64,
        }
    }

    /// The columns of the logistic model at a vertex.
    pub fn features(&self, vertex: usize) -> [f64; WEIGHTS.len() - 1] {
        let distance = |value: f64| (value + 0.002).ln();
        let doubt = (self.doubt[vertex] + 0.01).ln();
        [distance(self.round_trip[vertex]), distance(self.way[vertex]), doubt, self.mean_doubt]
    }

    /// Confidence of every vertex, 0..=1.
    pub fn confidence(&self) -> Vec<f32> {
        let of_vertex = |vertex: usize| probability(&WEIGHTS, &self.features(vertex)) as f32;
        (0..self.round_trip.len()).map(of_vertex).collect()
    }
}

/// The value known at the vertex that is the fewest edges away; 0 if none is known.
fn of_nearest(surface: &IntrinsicSurface, known: &[(u32, f64)]) -> Vec<f64> {
    let seeds: Vec<u32> = known.iter().map(|(vertex, _)| *vertex).collect();
    let around = |vertex: u32| surface.stiffness.neighbours(vertex as usize).iter().copied();
    let nearest = nearest_seeds(surface.vertex_count(), &seeds, around);
    nearest.into_iter().map(|seed| known.get(seed as usize).map_or(0.0, |(_, value)| *value)).collect()
}

/// Distance of every vertex from the point `there`, about in sqrt(area).
fn distances(rows: &VertexRows, there: &VertexRows, columns: &Range<usize>, scale: &[f64]) -> Vec<f64> {
    let distance =
        |vertex: usize| f64::from(rows.distance(vertex, there, vertex, columns)).sqrt() / scale[vertex];
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::{Mesh, PolygonMesh};

    /// A strip of `columns` x 2 vertices, column by column.
    fn strip(columns: u32) -> IntrinsicSurface {
        let polygons = PolygonMesh {
            positions: (0..2 * columns).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.0]).collect(),
            face_offsets: (0..columns).map(|i| 4 * i).collect(),
            face_vertices: (0..columns - 1).flat_map(|i| [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1]).collect(),
        };
        let mesh = Mesh::new(&polygons, &Limits::default()).expect("a usable mesh");
        IntrinsicSurface::new(&mesh.shells()[0])
    }

    #[test]
    fn each_vertex_takes_the_value_of_the_nearest() {
        let values = of_nearest(&strip(6), &[(0, 0.25), (10, 0.75)]);
        assert_eq!([values[0], values[1], values[4]], [0.25; 3]);
        assert_eq!([values[11], values[10], values[8]], [0.75; 3]);
        assert_eq!(of_nearest(&strip(6), &[]), [0.0; 12]);
    }

    #[test]
    fn averages_keep_a_constant_and_spread_a_peak() {
        let smoothed = |values| strip(6).stiffness.averaged(values, SMOOTHING_ROUNDS);
        assert!(smoothed(vec![2.0; 12]).iter().all(|value| (value - 2.0).abs() < 1e-12));
        let mut peak = vec![0.0; 12];
        peak[0] = 1.0;
        let spread = smoothed(peak);
        assert!(spread[0] > spread[4] && spread[4] > 0.0 && spread[10] == 0.0, "{spread:?}");
    }

    #[test]
    fn what_speaks_against_a_vertex_lowers_its_confidence() {
        let sure = Evidence { round_trip: vec![0.001], way: vec![0.05], doubt: vec![0.0], mean_doubt: 0.0 };
        let unsure = [
            Evidence { round_trip: vec![0.05], ..sure.clone() },
            Evidence { way: vec![0.0], ..sure.clone() },
            Evidence { doubt: vec![0.5], ..sure.clone() },
            Evidence { mean_doubt: 0.5, ..sure.clone() },
        ];
        assert!(sure.confidence()[0] > 0.9);
        assert!(unsure.iter().all(|other| other.confidence()[0] < sure.confidence()[0]));
    }
}
