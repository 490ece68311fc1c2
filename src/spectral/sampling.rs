//! Surface samples on which candidate maps are cheap: farthest points in the spectral embedding.
//!
//! The embedding `phi_i / sqrt(eigenvalue_i)` is the one of R. M. Rustamov, "Laplace-Beltrami
//! Eigenfunctions for Deformation Invariant Shape Representation", 2007; its distances do not depend
//! on the pose. Each prefix of the samples is itself a farthest-point sampling.

use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::twin_parts::TwinParts;
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
    /// Their parts, where the surface has parts.
    pub parts: Option<TwinParts>,
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
        Samples { vertices, rows, parts: None }
    }

    /// The same of a surface with parts.
    pub fn with_parts(self, parts: Option<&TwinParts>) -> Samples {
        Samples { parts: parts.map(|parts| parts.at(&self.vertices)), ..self }
    }

    /// Number of samples.
    pub fn count(&self) -> usize {
        self.vertices.len()
    }

    /// The first `count` samples.
    pub fn prefix(&self, count: usize) -> Samples {
        let count = count.min(self.count());
        let rows = self.rows.subrows(0, count).to_owned();
        let all: Vec<u32> = (0..count as u32).collect();
        let parts = self.parts.as_ref().map(|parts| parts.at(&all));
        Samples { vertices: self.vertices[..count].to_vec(), rows, parts }
    }
}

/// Indices of `count` vertices spread in proportion to their area, deterministic.
///
/// Systematic sampling: vertices lie end to end, each as long as its `mass`, and the middle of each of
/// `count` equal parts picks one. Every vertex heavier than a part is picked at least once.
pub fn area_weighted_vertices(mass: &[f64], count: usize) -> Vec<usize> {
    let part = mass.iter().sum::<f64>() / count as f64;
    let mut picked = Vec::with_capacity(count);
    let mut reached = 0.0;
    for (vertex, area) in mass.iter().enumerate() {
        reached += area;
        while picked.len() < count && (picked.len() as f64 + 0.5) * part <= reached {
            picked.push(vertex);
        }
    }
    let last = mass.len().saturating_sub(1);
    picked.resize(if mass.is_empty() { 0 } else { count }, last);
    picked
}

/// Samples in the spread embedding, scaled to a root mean square radius of 1.
pub fn spread_rows(samples: &Samples, eigenvalues: &[f64]) -> Vec<[f64; SPREAD_COORDINATES]> {
    let used = eigenvalues.len().min(SPREAD_COORDINATES);
    let coordinate = |i: usize, j: usize| samples.rows[(i, j)] / eigenvalues[j].max(f64::MIN_POSITIVE).sqrt();
    let mut rows: Vec<[f64; SPREAD_COORDINATES]> = (0..samples.count())
        .map(|i| std::array::from_fn(|j| if j < used { coordinate(i, j) } else { 0.0 }))
        .collect();
    let mean = rows.iter().flatten().map(|value| value * value).sum::<f64>() / samples.count() as f64;
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

/// Coordinates among which farthest points are sought.
pub type Point = [f32; SPREAD_COORDINATES];

/// The points nearer to one chosen point than to any other.
struct Cell {
    centre: usize,
    /// The other points of the cell with their distances from the centre.
    members: Vec<(u32, f32)>,
    /// Place in `members` of the farthest.
    farthest: usize,
}

impl Cell {
    fn new(centre: usize, members: Vec<(u32, f32)>) -> Cell {
        let mut cell = Cell { centre, members, farthest: 0 };
        cell.find_farthest();
        cell
    }

    fn find_farthest(&mut self) {
        let farther = |best: usize, i: usize| {
            // Of equals the first in the pool, whatever the order in the cell.
            let ((a, own), (b, other)) = (self.members[i], self.members[best]);
            if own > other || (own == other && a < b) { i } else { best }
        };
        self.farthest = (0..self.members.len()).fold(0, farther);
    }

    /// Its farthest point and that one's distance.
    fn tip(&self) -> Option<(u32, f32)> {
        self.members.get(self.farthest).copied()
    }
}

/// Indices of `count` points, each the farthest from those before it.
///
/// A new point can only take points from a cell whose centre is nearer to it than twice the cell's radius (triangle
/// inequality), so that most cells need not be looked at.
pub fn farthest_points(points: &[Point], count: usize) -> Vec<usize> {
    let distance = |a: usize, b: usize| squared(&points[a], &points[b]).sqrt();
    // The first sample is the point farthest from the embedding's origin: a tip of the shape.
    let radii: Vec<f32> = points.iter().map(|point| squared(point, &[0.0; SPREAD_COORDINATES])).collect();
    let first = (0..points.len()).fold(0, |best, i| if radii[i] > radii[best] { i } else { best });
    let others = (0..points.len()).filter(|&i| i != first);
    let mut cells = vec![Cell::new(first, others.map(|i| (i as u32, distance(i, first))).collect())];
    while cells.len() < count.min(points.len()) {
        let tips = cells.iter().filter_map(Cell::tip);
        let farther =
            |a: (u32, f32), b: (u32, f32)| if b.1 > a.1 || (b.1 == a.1 && b.0 < a.0) { b } else { a };
        let next = tips.reduce(farther).expect("a point that is not chosen").0 as usize;
        let mut taken = Vec::new();
        for cell in &mut cells {
            let Some((_, radius)) = cell.tip() else { continue };
            // The slack covers rounding: a cell too many does no harm.
            if distance(next, cell.centre) > 2.001 * radius {
                continue;
            }
            let before = cell.members.len();
            cell.members.retain(|&(point, own)| {
                let nearer = distance(point as usize, next);
                let moves = nearer < own || point as usize == next;
                if moves && point as usize != next {
                    taken.push((point, nearer));
                }
                !moves
            });
            if cell.members.len() < before {
                cell.find_farthest();
            }
        }
        cells.push(Cell::new(next, taken));
    }
    cells.iter().map(|cell| cell.centre).collect()
}

fn squared(a: &Point, b: &Point) -> f32 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_weighted_vertices_follow_the_area() {
        let picked = area_weighted_vertices(&[1.0, 3.0, 0.0, 4.0], 8);
        assert_eq!(picked, [0, 1, 1, 1, 3, 3, 3, 3]);
        assert!(area_weighted_vertices(&[], 4).is_empty());
    }

    #[test]
    fn each_point_is_the_farthest_from_those_before_it() {
        let mut random = 1u64;
        let mut coordinate = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (random >> 40) as f32 / (1u64 << 24) as f32
        };
        let points: Vec<Point> = (0..500).map(|_| std::array::from_fn(|_| coordinate())).collect();
        let chosen = farthest_points(&points, 60);
        assert_eq!(chosen.len(), 60);
        for count in 1..60 {
            let nearest = |i: usize| {
                chosen[..count]
                    .iter()
                    .map(|&c| squared(&points[i], &points[c]).sqrt())
                    .fold(f32::MAX, f32::min)
            };
            let farthest = (0..points.len()).map(nearest).fold(0.0, f32::max);
            assert_eq!(nearest(chosen[count]), farthest, "{count}");
        }
        let mut all = farthest_points(&points, 1000);
        all.sort_unstable();
        assert_eq!(all, (0..500).collect::<Vec<_>>());
    }
}
