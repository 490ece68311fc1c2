//! Surface samples on which candidate maps are cheap: farthest points in the spectral embedding.
//!
//! The embedding `phi_i / sqrt(eigenvalue_i)` is the one of R. M. Rustamov, "Laplace-Beltrami
//! Eigenfunctions for Deformation Invariant Shape Representation", 2007; its distances do not depend
//! on the pose. Each prefix of the samples is itself a farthest-point sampling.

use crate::eigenbasis::Eigenbasis;
use crate::laplacian::IntrinsicSurface;
use faer::Mat;

/// Coordinates of the embedding that spreads the samples.
pub const SPREAD_COORDINATES: usize = 8;
/// Most vertices among which samples are chosen.
const POOL: usize = 30_000;

/// Sampled vertices with their rows of the eigenbasis.
#[derive(Debug, Clone)]
pub struct Samples {
    /// Vertex of each sample.
    pub vertices: Vec<u32>,
    /// samples x count: the eigenfunctions at the samples.
    pub rows: Mat<f64>,
}

impl Samples {
    /// Takes `count` farthest points (or all vertices if there are fewer).
    ///
    /// Cost: O(count x min(vertices, 30,000)).
    pub fn farthest(basis: &Eigenbasis, count: usize) -> Samples {
        let size = basis.eigenfunctions.nrows();
        let pool = pool(size);
        let points = spread_embedding(basis, &pool);
        let vertices = farthest_points(&points, count.min(pool.len())).into_iter().map(|i| pool[i]).collect();
        Samples::at(basis, vertices)
    }

    /// The samples at given vertices.
    pub fn at(basis: &Eigenbasis, vertices: Vec<u32>) -> Samples {
        let functions = &basis.eigenfunctions;
        let rows = Mat::from_fn(vertices.len(), basis.count(), |i, j| functions[(vertices[i] as usize, j)]);
        Samples { vertices, rows }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// The first `count` samples.
    pub fn prefix(&self, count: usize) -> Samples {
        let count = count.min(self.len());
        let rows = self.rows.subrows(0, count).to_owned();
        Samples { vertices: self.vertices[..count].to_vec(), rows }
    }
}

/// Evenly spread vertices drawn in proportion to their area, in a fixed order: `count` of them.
///
/// The golden-ratio sequence along the cumulated mass visits every part of the surface.
pub fn area_weighted_vertices(surface: &IntrinsicSurface, count: usize) -> Vec<u32> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let mut cumulated = Vec::with_capacity(surface.vertex_count());
    let mut total = 0.0;
    for mass in &surface.lumped_mass {
        total += mass;
        cumulated.push(total);
    }
    (0..count)
        .map(|i| {
            let target = (0.5 + i as f64 * GOLDEN).fract() * total;
            cumulated.partition_point(|mass| *mass < target).min(cumulated.len() - 1) as u32
        })
        .collect()
}

/// Samples in the spread embedding, scaled to a root mean square radius of 1.
pub fn spread_rows(samples: &Samples, eigenvalues: &[f64]) -> Vec<[f64; SPREAD_COORDINATES]> {
    let used = eigenvalues.len().min(SPREAD_COORDINATES);
    let coordinate = |i: usize, j: usize| samples.rows[(i, j)] / eigenvalues[j].max(f64::MIN_POSITIVE).sqrt();
    let mut rows: Vec<[f64; SPREAD_COORDINATES]> = (0..samples.len())
        .map(|i| std::array::from_fn(|j| if j < used { coordinate(i, j) } else { 0.0 }))
        .collect();
    let mean = rows.iter().flatten().map(|value| value * value).sum::<f64>() / samples.len() as f64;
    let scale = 1.0 / mean.sqrt().max(f64::MIN_POSITIVE);
    rows.iter_mut().flatten().for_each(|value| *value *= scale);
    rows
}

fn pool(size: usize) -> Vec<u32> {
    let count = size.min(POOL);
    (0..count).map(|i| (i * size / count) as u32).collect()
}

fn spread_embedding(basis: &Eigenbasis, pool: &[u32]) -> Vec<[f32; SPREAD_COORDINATES]> {
    let used = basis.count().min(SPREAD_COORDINATES);
    let coordinate = |vertex: u32, j: usize| {
        let weight = basis.eigenvalues[j].max(f64::MIN_POSITIVE).sqrt();
        (basis.eigenfunctions[(vertex as usize, j)] / weight) as f32
    };
    pool.iter()
        .map(|&vertex| std::array::from_fn(|j| if j < used { coordinate(vertex, j) } else { 0.0 }))
        .collect()
}

fn farthest_points(points: &[[f32; SPREAD_COORDINATES]], count: usize) -> Vec<usize> {
    let distance = |a: &[f32; SPREAD_COORDINATES], b: &[f32; SPREAD_COORDINATES]| {
        a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f32>()
    };
    // The first sample is the point farthest from the embedding's origin: a tip of the shape.
    let origin = [0.0; SPREAD_COORDINATES];
    let mut nearest: Vec<f32> = points.iter().map(|point| distance(point, &origin)).collect();
    let mut chosen = Vec::with_capacity(count);
    for round in 0..count {
        let next = (0..points.len()).fold(0, |best, i| if nearest[i] > nearest[best] { i } else { best });
        chosen.push(next);
        for (point, nearest) in points.iter().zip(&mut nearest) {
            let to_next = distance(point, &points[next]);
            *nearest = if round == 0 { to_next } else { nearest.min(to_next) };
        }
    }
    chosen
}
