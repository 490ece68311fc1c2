//! The point of a triangle surface nearest to a point in space, sought by walking from a vertex nearby.
//!
//! Where a tree would find the nearest point of the whole surface, a walk stays on the sheet it starts on: a
//! hand that touches a hip is not taken for it.

use crate::geometry::adjacency::{Adjacency, LOOKS, downhill, some};
use crate::geometry::embedded_triangles::{TrianglePoint, TriangleProducts, nearest_in_triangle};
use crate::mesh::NONE;
use crate::mesh::vector::{Vector, dot, squared_norm, subtract};

/// A triangle surface to walk on.
#[derive(Debug)]
pub struct SurfaceWalk<'a> {
    positions: &'a [Vector],
    triangles: &'a [[u32; 3]],
    graph: Adjacency,
    triangles_around: Adjacency,
}

impl<'a> SurfaceWalk<'a> {
    /// O(vertices + triangles).
    pub fn new(positions: &'a [Vector], triangles: &'a [[u32; 3]]) -> SurfaceWalk<'a> {
        let triangles_around = Adjacency::triangles_around(positions.len(), triangles);
        let graph = Adjacency::of_vertices(triangles, &triangles_around);
        SurfaceWalk { positions, triangles, graph, triangles_around }
    }

    /// The neighbours of `vertex`, ascending.
    pub fn around(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        self.graph.of(vertex as usize).iter().copied()
    }

    /// Those to which a walk looks on: all but at hubs.
    pub fn ahead(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        some(self.graph.of(vertex as usize))
    }

    /// The one of two vertices that is nearer to `query`, the first if they are equally near.
    pub fn nearer(&self, query: Vector, first: u32, second: u32) -> u32 {
        if self.distance(query, second) < self.distance(query, first) { second } else { first }
    }

    /// The vertex that [`Self::nearest_vertex`] finds, and the nearest point of the triangles around it.
    pub fn nearest(&self, query: Vector, start: u32) -> (u32, TrianglePoint) {
        let vertex = self.nearest_vertex(query, start);
        (vertex, self.nearest_beside(query, vertex))
    }

    /// Downhill from `start` along edges to a vertex that is nearer to `query` than its neighbours.
    pub fn nearest_vertex(&self, query: Vector, start: u32) -> u32 {
        self.nearest_vertex_but(NONE, query, start)
    }

    /// The same without stepping on the vertex `barred`.
    fn nearest_vertex_but(&self, barred: u32, query: Vector, start: u32) -> u32 {
        let ahead = |from: u32| self.ahead(from).filter(move |&next| next != barred);
        downhill(start, ahead, |vertex| self.distance(query, vertex)).0
    }

    /// The nearest point of the triangles around `vertex`; at a hub, of those around the neighbour to which a walk round it leads.
    pub fn nearest_beside(&self, query: Vector, vertex: u32) -> TrianglePoint {
        let best = self.nearest_around(query, vertex);
        if self.triangles_of(vertex).len() <= LOOKS {
            return best.0;
        }
        let corners = self.triangles[best.0.triangle as usize].into_iter().filter(|&corner| corner != vertex);
        let start = corners.reduce(|first, second| self.nearer(query, first, second)).unwrap_or(vertex);
        let beside = self.nearest_vertex_but(vertex, query, start);
        let other = self.nearest_around(query, beside);
        if other.1 < best.1 { other.0 } else { best.0 }
    }

    fn nearest_around(&self, query: Vector, vertex: u32) -> (TrianglePoint, f32) {
        nearest_of(query, self.positions, self.triangles, some(self.triangles_of(vertex)))
    }

    fn distance(&self, query: Vector, vertex: u32) -> f64 {
        squared_norm(subtract(query, self.positions[vertex as usize]))
    }

    fn triangles_of(&self, vertex: u32) -> &[u32] {
        self.triangles_around.of(vertex as usize)
    }
}

/// The point of some `triangles` over `positions` that is nearest to `query`, the first of equals, and its squared distance.
pub fn nearest_of(
    query: Vector,
    positions: &[Vector],
    triangles: &[[u32; 3]],
    looked_at: impl Iterator<Item = u32>,
) -> (TrianglePoint, f32) {
    let mut best = (TrianglePoint { triangle: 0, barycentric: [1.0, 0.0, 0.0] }, f32::MAX);
    for triangle in looked_at {
        let [a, b, c] = triangles[triangle as usize].map(|corner| positions[corner as usize]);
        let [to_query, to_b, to_c] = [query, b, c].map(|place| subtract(place, a));
        let product = |p: Vector, q: Vector| dot(p, q) as f32;
        let (barycentric, squared) = nearest_in_triangle(TriangleProducts {
            own: product(to_query, to_query),
            along: [product(to_query, to_b), product(to_query, to_c)],
            edges: [product(to_b, to_b), product(to_b, to_c), product(to_c, to_c)],
        });
        if squared < best.1 {
            best = (TrianglePoint { triangle, barycentric }, squared);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_triangles_as_near_the_first_is_the_answer() {
        let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
        let triangles = [[0, 1, 2], [1, 0, 3]];
        for order in [[0, 1], [1, 0]] {
            let (point, squared) = nearest_of([0.25, 0.0, 2.0], &positions, &triangles, order.into_iter());
            assert_eq!((point.triangle, squared), (order[0], 4.0));
        }
    }

    #[test]
    fn a_walk_ends_at_the_nearest_point_of_a_plane() {
        let side = 12u32;
        let positions: Vec<Vector> =
            (0..side * side).map(|i| [f64::from(i % side), f64::from(i / side), 0.0]).collect();
        let squares = (0..side - 1).flat_map(|y| (0..side - 1).map(move |x| y * side + x));
        let triangles: Vec<[u32; 3]> =
            squares.flat_map(|i| [[i, i + 1, i + side], [i + 1, i + side + 1, i + side]]).collect();
        let walk = SurfaceWalk::new(&positions, &triangles);
        for query in [[3.2, 7.1, 0.5], [10.9, 0.4, -2.0], [0.25, 0.25, 0.0]] {
            let (vertex, point) = walk.nearest(query, side * side - 1);
            let rounded = query.map(f64::round);
            assert_eq!(positions[vertex as usize][..2], rounded[..2]);
            for axis in 0..2 {
                let at: f64 = triangles[point.triangle as usize]
                    .iter()
                    .zip(point.barycentric)
                    .map(|(&corner, weight)| f64::from(weight) * positions[corner as usize][axis])
                    .sum();
                assert!((at - query[axis]).abs() < 1e-5, "{query:?}: {point:?}");
            }
        }
    }

    #[test]
    fn the_point_beside_a_hub_is_found_without_looking_at_all_its_triangles() {
        let count = 200u32;
        let rim = (0..count).map(|i| f64::from(i) * std::f64::consts::TAU / f64::from(count));
        let positions: Vec<Vector> =
            [[0.0; 3]].into_iter().chain(rim.map(|angle| [angle.cos(), angle.sin(), 0.0])).collect();
        let triangles: Vec<[u32; 3]> = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
        let walk = SurfaceWalk::new(&positions, &triangles);
        assert!(walk.ahead(0).count() <= LOOKS && walk.around(0).count() == 200);
        for angle in [0.1, 2.0, 4.4f64] {
            let below = [0.3 * angle.cos(), 0.3 * angle.sin(), 0.0];
            let point = walk.nearest_beside([below[0], below[1], 0.1], 0);
            let found = point.interpolate_vectors(&triangles, &positions);
            // A triangle is 0.009 wide there.
            assert!(squared_norm(subtract(found, below)).sqrt() < 5e-4, "{point:?}");
        }
    }
}
