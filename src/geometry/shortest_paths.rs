//! Shortest paths along edges (E. Dijkstra, "A note on two problems in connexion with graphs", 1959).

use crate::geometry::surface_walk::SurfaceWalk;
use crate::mesh::bucket;
use crate::mesh::vector::{Vector, squared_norm, subtract};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::ControlFlow;

/// A search that can be run many times; it cleans up only where it was.
pub struct PathSearch {
    distance: Vec<f32>,
    touched: Vec<u32>,
    /// The bits of a distance, which is positive, and the vertex: in the order of the distances.
    queue: BinaryHeap<Reverse<u64>>,
}

impl PathSearch {
    /// On `count` vertices.
    pub fn new(count: usize) -> PathSearch {
        PathSearch { distance: vec![f32::INFINITY; count], touched: Vec::new(), queue: BinaryHeap::new() }
    }

    /// Visits the vertices nearer than `radius` to one of `sources` with their distances, the nearest first, until `visit` breaks.
    ///
    /// `edges` gives the neighbours of a vertex and the lengths of the edges to them. O(reached log reached).
    pub fn run<N: IntoIterator<Item = (u32, f64)>>(
        &mut self,
        sources: &[u32],
        radius: f64,
        edges: impl Fn(u32) -> N,
        mut visit: impl FnMut(u32, f64) -> ControlFlow<()>,
    ) {
        for &source in sources {
            self.improve(source, 0.0);
        }
        while let Some(Reverse(entry)) = self.queue.pop() {
            let (distance, vertex) = (f32::from_bits((entry >> 32) as u32), entry as u32);
            if distance > self.distance[vertex as usize] {
                continue;
            }
            let distance = f64::from(distance);
            if visit(vertex, distance).is_break() {
                break;
            }
            for (near, length) in edges(vertex) {
                if distance + length < radius {
                    self.improve(near, (distance + length) as f32);
                }
            }
        }
        self.queue.clear();
        for vertex in self.touched.drain(..) {
            self.distance[vertex as usize] = f32::INFINITY;
        }
    }

    fn improve(&mut self, vertex: u32, distance: f32) {
        let known = &mut self.distance[vertex as usize];
        if distance < *known {
            if known.is_infinite() {
                self.touched.push(vertex);
            }
            *known = distance;
            self.queue.push(Reverse(u64::from(distance.to_bits()) << 32 | u64::from(vertex)));
        }
    }
}

/// The edges of a surface with their lengths.
pub struct EdgeLengths {
    offsets: Vec<u32>,
    ends: Vec<(u32, f64)>,
}

impl EdgeLengths {
    /// Of triangles over `count` vertices whose sides have these lengths, each opposite to its corner. O(triangles log degree).
    pub fn new(count: usize, triangles: &[[u32; 3]], sides: &[[f64; 3]]) -> EdgeLengths {
        let corners = triangles.iter().zip(sides);
        let mut directed: Vec<(u32, u32, f64)> = corners
            .flat_map(|(corners, lengths)| {
                let side = |c: usize| (corners[(c + 1) % 3], corners[(c + 2) % 3], lengths[c]);
                [0, 1, 2].map(side).into_iter().flat_map(|(a, b, length)| [(a, b, length), (b, a, length)])
            })
            .collect();
        directed.sort_unstable_by_key(|&(from, to, _)| (from, to));
        directed.dedup_by_key(|&mut (from, to, _)| (from, to));
        let (offsets, _) = bucket(directed.iter().map(|&(from, ..)| from), count);
        EdgeLengths { offsets, ends: directed.into_iter().map(|(_, to, length)| (to, length)).collect() }
    }

    /// Those of a surface in space. O(vertices).
    pub fn of_walk(walk: &SurfaceWalk, positions: &[Vector]) -> EdgeLengths {
        let (mut offsets, mut ends) = (vec![0], Vec::new());
        for (vertex, &from) in (0..).zip(positions) {
            let length = |to: u32| squared_norm(subtract(positions[to as usize], from)).sqrt();
            ends.extend(walk.around(vertex).map(|to| (to, length(to))));
            offsets.push(ends.len() as u32);
        }
        EdgeLengths { offsets, ends }
    }

    /// The neighbours of a vertex, with the lengths of the edges to them.
    pub fn of(&self, vertex: u32) -> impl Iterator<Item = (u32, f64)> + '_ {
        let vertex = vertex as usize;
        self.ends[self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize].iter().copied()
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Distance of every vertex from the nearest of `sources`; infinite where there is no way.
    pub fn distances(&self, sources: &[u32]) -> Vec<f64> {
        let mut distances = vec![f64::INFINITY; self.vertex_count()];
        PathSearch::new(distances.len()).run(
            sources,
            f64::INFINITY,
            |vertex| self.of(vertex),
            |vertex, distance| {
                distances[vertex as usize] = distance;
                ControlFlow::Continue(())
            },
        );
        distances
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertices in a row, one apart.
    fn row(count: u32) -> impl Fn(u32) -> Vec<(u32, f64)> {
        move |vertex| {
            let before = vertex.checked_sub(1).map(|other| (other, 1.0));
            let after = Some((vertex + 1, 1.0)).filter(|(other, _)| *other < count);
            before.into_iter().chain(after).collect()
        }
    }

    #[test]
    fn a_search_visits_what_is_near_the_nearest_first_and_can_be_run_again() {
        let mut search = PathSearch::new(9);
        for _ in 0..2 {
            let mut visited = Vec::new();
            search.run(&[2, 7], 2.5, row(9), |vertex, distance| {
                visited.push((vertex, distance));
                ControlFlow::Continue(())
            });
            let expected =
                [(2, 0.0), (7, 0.0), (1, 1.0), (3, 1.0), (6, 1.0), (8, 1.0), (0, 2.0), (4, 2.0), (5, 2.0)];
            assert_eq!(visited, expected);
        }
        let mut visited = Vec::new();
        search.run(&[0], 9.0, row(9), |vertex, _| {
            visited.push(vertex);
            if vertex == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!(visited, [0, 1, 2, 3]);
    }
}
