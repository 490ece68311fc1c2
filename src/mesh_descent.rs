//! Nearest neighbours of all vertices in the spectral embedding, by descent along the mesh.
//!
//! Images of neighbouring vertices are near each other, so a vertex starts from its neighbour's
//! answer and walks downhill along edges: linear in the vertices, where a search among all of them
//! is quadratic. The walk can stop in a local minimum; sweeps over the neighbours' answers repair
//! nearly all of those.

use crate::adjacency::Adjacency;
use crate::mesh::NONE;
use crate::vertex_rows::VertexRows;
use std::ops::Range;

/// Nearest target of every vertex by descent along the mesh.
pub struct MeshDescent<'a> {
    /// Adjacency of the target mesh.
    pub graph: &'a Adjacency,
    /// Images of the vertices under the map.
    pub queries: &'a VertexRows,
    /// The vertices' own rows.
    pub targets: &'a VertexRows,
    /// Columns of the rows in which distances are measured.
    pub columns: Range<usize>,
}

impl MeshDescent<'_> {
    /// From `seeds` (vertex, guess) breadth first over the mesh, then `sweeps` rounds in which each
    /// vertex also tries its neighbours' answers. About 25 distances a vertex.
    ///
    /// Vertices not reached from a seed keep [`NONE`].
    pub fn run(&self, sources: &Adjacency, seeds: &[(u32, u32)], sweeps: usize) -> Vec<u32> {
        let count = sources.count();
        let mut partner = vec![NONE; count];
        let mut reached = vec![f32::MAX; count];
        let mut queue = Vec::with_capacity(count);
        for &(vertex, guess) in seeds {
            if partner[vertex as usize] == NONE {
                (partner[vertex as usize], reached[vertex as usize]) = self.descend(vertex as usize, guess);
                queue.push(vertex);
            }
        }
        let mut head = 0;
        while head < queue.len() {
            let from = queue[head] as usize;
            head += 1;
            for &to in sources.of(from) {
                let to_index = to as usize;
                if partner[to_index] == NONE {
                    (partner[to_index], reached[to_index]) = self.descend(to_index, partner[from]);
                    queue.push(to);
                }
            }
        }
        for sweep in 0..sweeps {
            for step in 0..count {
                let vertex = if sweep % 2 == 0 { step } else { count - 1 - step };
                self.try_neighbours(sources, vertex, &mut partner, &mut reached);
            }
        }
        partner
    }

    fn try_neighbours(&self, sources: &Adjacency, vertex: usize, partner: &mut [u32], reached: &mut [f32]) {
        for &neighbour in sources.of(vertex) {
            let guess = partner[neighbour as usize];
            if guess == NONE || guess == partner[vertex] {
                continue;
            }
            if self.distance(vertex, guess) < reached[vertex] {
                (partner[vertex], reached[vertex]) = self.descend(vertex, guess);
            }
        }
    }

    fn descend(&self, vertex: usize, guess: u32) -> (u32, f32) {
        let mut current = guess;
        let mut distance = self.distance(vertex, guess);
        loop {
            let start = current;
            for &next in self.graph.of(start as usize) {
                let candidate = self.distance(vertex, next);
                if candidate < distance {
                    (current, distance) = (next, candidate);
                }
            }
            if current == start {
                return (current, distance);
            }
        }
    }
    fn distance(&self, vertex: usize, target: u32) -> f32 {
        self.queries.distance(vertex, self.targets, target as usize, &self.columns)
    }
}
