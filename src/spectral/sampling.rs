//! Surface samples on which candidate maps are cheap: farthest points in the spectral embedding.
//!
//! The embedding `phi_i / sqrt(eigenvalue_i)` is the one of R. M. Rustamov, "Laplace-Beltrami
//! Eigenfunctions for Deformation Invariant Shape Representation", 2007; its distances do not depend
//! on the pose. Each prefix of the samples is itself a farthest-point sampling.

use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::twin_parts::TwinParts;
use faer::{Mat, MatRef};
use pulp::{Arch, Simd, WithSimd};

/// Coordinates of the embedding that spreads the samples.
pub const SPREAD_COORDINATES: usize = 8;

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
    /// Takes `count` farthest points (or all vertices if there are fewer). O(count x vertices) at most.
    pub fn farthest(basis: &Eigenbasis, count: usize) -> Samples {
        let points = spread(basis.eigenfunctions.as_ref(), &basis.eigenvalues);
        let points: Vec<Point> = points.iter().map(|point| point.map(|x| x as f32)).collect();
        let vertices = farthest_points(&points, count).into_iter().map(|vertex| vertex as u32).collect();
        Samples::at(basis, vertices)
    }

    /// The samples at given vertices.
    pub fn at(basis: &Eigenbasis, vertices: Vec<u32>) -> Samples {
        let rows = basis.at(&vertices, basis.count()).eigenfunctions;
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

/// Rows of eigenfunctions in the spread embedding.
fn spread(rows: MatRef<f64>, eigenvalues: &[f64]) -> Vec<[f64; SPREAD_COORDINATES]> {
    let used = eigenvalues.len().min(SPREAD_COORDINATES);
    let coordinate = |i: usize, j: usize| rows[(i, j)] / eigenvalues[j].max(f64::MIN_POSITIVE).sqrt();
    let row = |i: usize| std::array::from_fn(|j| if j < used { coordinate(i, j) } else { 0.0 });
    (0..rows.nrows()).map(row).collect()
}

/// Samples in the spread embedding, scaled to a root mean square radius of 1.
pub fn spread_rows(samples: &Samples, eigenvalues: &[f64]) -> Vec<[f64; SPREAD_COORDINATES]> {
    let mut rows = spread(samples.rows.as_ref(), eigenvalues);
    let mean = rows.iter().flatten().map(|value| value * value).sum::<f64>() / samples.count() as f64;
    let scale = 1.0 / mean.sqrt().max(f64::MIN_POSITIVE);
    rows.iter_mut().flatten().for_each(|value| *value *= scale);
    rows
}

/// Coordinates among which farthest points are sought.
pub type Point = [f32; SPREAD_COORDINATES];

/// Indices of `count` points, or of all, each the farthest from those before it, of equals the first. O(points x count).
pub fn farthest_points(points: &[Point], count: usize) -> Vec<usize> {
    let columns: [Vec<f32>; SPREAD_COORDINATES] =
        std::array::from_fn(|j| points.iter().map(|point| point[j]).collect());
    // The first sample is the point farthest from the embedding's origin: a tip of the shape.
    let mut away: Vec<f32> = points.iter().map(|point| squared(point, &[0.0; SPREAD_COORDINATES])).collect();
    let mut chosen = Vec::with_capacity(count);
    while chosen.len() < count.min(points.len()) {
        let most = away.iter().fold(f32::NEG_INFINITY, |most, &away| if away > most { away } else { most });
        let next = away.iter().position(|&away| away == most).unwrap_or(0);
        if chosen.is_empty() {
            away.fill(f32::INFINITY);
        }
        chosen.push(next);
        Arch::new().dispatch(Nearer { columns: &columns, newest: &points[next], away: &mut away });
        // Points in one place are chosen once each.
        away[next] = f32::NEG_INFINITY;
    }
    chosen
}

/// Squared distances of points, by columns, from the nearest chosen one, with a new one, summed as by [`squared`]; compiled for each instruction set.
struct Nearer<'a> {
    columns: &'a [Vec<f32>; SPREAD_COORDINATES],
    newest: &'a Point,
    away: &'a mut [f32],
}

impl WithSimd for Nearer<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let count = self.away.len();
        let [a, b, c, d, e, f, g, h] = self.columns.each_ref().map(|column| &column[..count]);
        let [p, q, r, s, t, u, v, w] = *self.newest;
        for i in 0..count {
            let [a, b, c, d] = [a[i] - p, b[i] - q, c[i] - r, d[i] - s];
            let [e, f, g, h] = [e[i] - t, f[i] - u, g[i] - v, h[i] - w];
            let even = (a * a + e * e) + (c * c + g * g);
            let odd = (b * b + f * f) + (d * d + h * h);
            let square = even + odd;
            self.away[i] = if square < self.away[i] { square } else { self.away[i] };
        }
    }
}

/// Four sums side by side, for the vector units.
#[inline]
pub fn squared(a: &Point, b: &Point) -> f32 {
    let square = |i: usize| (a[i] - b[i]) * (a[i] - b[i]);
    let sums: [f32; 4] = std::array::from_fn(|i| square(i) + square(i + 4));
    (sums[0] + sums[2]) + (sums[1] + sums[3])
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
