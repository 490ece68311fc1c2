//! Triangles of a mesh: which are around a vertex or behind an edge, and which of their points is nearest.

use crate::geometry::adjacency::Adjacency;
use crate::mesh::NONE;
use crate::mesh::vector::Vector;

/// A point inside a triangle of a shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrianglePoint {
    /// Index of the triangle.
    pub triangle: u32,
    /// Weights of its corners, each in 0..=1, summing to 1.
    pub barycentric: [f32; 3],
}

impl TrianglePoint {
    /// The corner with the largest weight, 0..3; the first of equals.
    #[inline]
    pub fn heaviest(&self) -> usize {
        let weights = self.barycentric;
        (0..3).fold(0, |best, c| if weights[c] > weights[best] { c } else { best })
    }

    /// The value here of a function that is given at the vertices of `triangles` and linear inside them.
    #[inline]
    pub fn interpolate(&self, triangles: &[[u32; 3]], values: &[impl Copy + Into<f64>]) -> f64 {
        let corners = triangles[self.triangle as usize];
        (0..3).map(|k| f64::from(self.barycentric[k]) * values[corners[k] as usize].into()).sum()
    }

    /// The same of vectors.
    #[inline]
    pub fn interpolate_vectors(&self, triangles: &[[u32; 3]], vectors: &[Vector]) -> Vector {
        let corners = triangles[self.triangle as usize].map(|corner| vectors[corner as usize]);
        std::array::from_fn(|axis| (0..3).map(|k| f64::from(self.barycentric[k]) * corners[k][axis]).sum())
    }
}

/// The triangles around each vertex and behind each edge.
pub struct Fans {
    /// The triangles around each vertex.
    pub around: Adjacency,
    /// Of each triangle those behind the edges opposite its corners; [`NONE`] at a boundary.
    pub behind: Vec<[u32; 3]>,
}

impl Fans {
    /// O(triangles).
    pub fn new(vertex_count: usize, triangles: &[[u32; 3]]) -> Fans {
        let around = Adjacency::triangles_around(vertex_count, triangles);
        let mut fans = Fans { around, behind: Vec::with_capacity(triangles.len()) };
        for (index, &[a, b, c]) in (0..).zip(triangles) {
            let behind = |from: u32, to: u32| {
                // Around the end that has fewer, lest hubs cost the square of their degree.
                let (from, to) =
                    if fans.of(to).len() < fans.of(from).len() { (to, from) } else { (from, to) };
                let shared = |other: &&u32| **other != index && triangles[**other as usize].contains(&to);
                fans.of(from).iter().find(shared).copied().unwrap_or(NONE)
            };
            fans.behind.push([behind(b, c), behind(c, a), behind(a, b)]);
        }
        fans
    }

    /// Indices of the triangles around `vertex`, ascending.
    #[inline]
    pub fn of(&self, vertex: u32) -> &[u32] {
        self.around.of(vertex as usize)
    }
}

/// Inner products of a query and a triangle's edges in the embedding, seen from the triangle's first corner.
#[derive(Debug, Clone, Copy)]
pub struct TriangleProducts {
    /// Squared distance of the query.
    pub own: f32,
    /// Of the query with the edges to the second and to the third corner.
    pub along: [f32; 2],
    /// Of the edges: first with itself, first with second, second with itself.
    pub edges: [f32; 3],
}

/// Nearest point of a triangle in any dimension (C. Ericson, "Real-Time Collision Detection", 2005, 5.1.5): weights
/// of the corners and squared distance.
#[inline(always)]
pub fn nearest_in_triangle(products: TriangleProducts) -> ([f32; 3], f32) {
    let TriangleProducts { own, along: [d1, d2], edges: [e11, e12, e22] } = products;
    let squared =
        |s: f32, t: f32| own - 2.0 * (s * d1 + t * d2) + s * s * e11 + 2.0 * s * t * e12 + t * t * e22;
    let determinant = e11 * e22 - e12 * e12;
    if determinant > 1e-12 * e11 * e22 {
        let (s, t) = ((e22 * d1 - e12 * d2) / determinant, (e11 * d2 - e12 * d1) / determinant);
        if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
            // Rounding makes no weight negative.
            return ([(1.0 - s - t).max(0.0), s, t], squared(s, t));
        }
    }
    let ratio = |above: f32, below: f32| if below > 0.0 { (above / below).clamp(0.0, 1.0) } else { 0.0 };
    let along_b = ratio(d1, e11);
    let along_c = ratio(d2, e22);
    let across = ratio(d2 - d1 + e11 - e12, e11 - 2.0 * e12 + e22);
    // On a side the weight of the corner that is not on it is 0, not what rounding leaves: by that it is known for a side.
    let sides = [[1.0 - along_b, along_b, 0.0], [1.0 - along_c, 0.0, along_c], [0.0, 1.0 - across, across]];
    let distances = sides.map(|[_, s, t]| squared(s, t));
    let nearest = (0..3).min_by(|&i, &j| distances[i].total_cmp(&distances[j])).expect("three");
    (sides[nearest], distances[nearest])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a query and the corners (0, 0), (4, 0) and (1, 3).
    fn products_of([x, y]: [f32; 2]) -> TriangleProducts {
        TriangleProducts { own: x * x + y * y, along: [4.0 * x, x + 3.0 * y], edges: [16.0, 4.0, 10.0] }
    }

    #[test]
    fn the_nearest_point_is_inside_on_a_side_or_a_corner() {
        for (query, weights, squared) in [
            // Inside.
            ([1.0, 1.0], [0.5, 1.0 / 6.0, 1.0 / 3.0], 0.0),
            // Beside each side.
            ([2.0, -2.0], [0.5, 0.5, 0.0], 4.0),
            ([-2.5, 2.5], [0.5, 0.0, 0.5], 10.0),
            ([4.0, 3.0], [0.0, 0.5, 0.5], 4.5),
            // Beyond each corner.
            ([-3.0, -1.0], [1.0, 0.0, 0.0], 10.0),
            ([7.0, -1.0], [0.0, 1.0, 0.0], 10.0),
            ([1.0, 5.0], [0.0, 0.0, 1.0], 4.0),
        ] {
            let (found, distance) = nearest_in_triangle(products_of(query));
            let near = |(a, b): (f32, f32)| (a - b).abs() < 1e-5;
            assert!(found.into_iter().zip(weights).all(near), "{query:?}: {found:?}");
            assert!(near((distance, squared)), "{query:?}: {distance}");
        }
    }

    #[test]
    fn a_point_on_a_side_has_no_weight_of_the_other_corner() {
        for step in 1..100 {
            let s = step as f32 / 100.0;
            // Beyond the side from (4, 0) to (1, 3), beyond that from (0, 0) to (1, 3), and below the first.
            let beyond = [[4.0 - 3.0 * s + 2.0, 3.0 * s + 2.0], [s - 3.0, 3.0 * s + 1.0], [4.0 * s, -1.0]];
            let weights = beyond.map(|query| nearest_in_triangle(products_of(query)).0);
            assert_eq!([weights[0][0], weights[1][1], weights[2][2]], [0.0; 3], "{weights:?}");
        }
    }
}
