//! Nearest neighbours of all vertices in the spectral embedding, by descent along the mesh.
//!
//! Images of neighbouring vertices are near each other, so a vertex starts from its neighbour's
//! answer and walks downhill along edges: linear in the vertices, where a search among all of them
//! is quadratic. The walk can stop in a local minimum; sweeps over the neighbours' answers repair
//! nearly all of those.

use crate::laplacian::SymmetricSparse;
use crate::mesh::NONE;
use faer::MatRef;

/// Values that are worked on at once; rows are padded to whole lanes with zeros.
const LANES: usize = 8;

/// The eigenfunctions of all vertices in single precision, one padded row a vertex.
pub struct VertexRows {
    values: Vec<f32>,
    stride: usize,
}

impl VertexRows {
    /// The leading `size` columns of `functions`, then the `further` columns times `weight`.
    pub fn new(functions: MatRef<f32>, size: usize, further: &[Vec<f64>], weight: f64) -> VertexRows {
        let stride = (size + further.len()).next_multiple_of(LANES);
        let mut values = vec![0.0; functions.nrows() * stride];
        for j in 0..size {
            for (i, row) in values.chunks_exact_mut(stride).enumerate() {
                row[j] = functions[(i, j)];
            }
        }
        for (column, j) in further.iter().zip(size..) {
            for (row, value) in values.chunks_exact_mut(stride).zip(column) {
                row[j] = (weight * value) as f32;
            }
        }
        VertexRows { values, stride }
    }

    /// At each of `points` (three rows and their weights) the weighted sum of the rows.
    pub fn combined(&self, points: impl ExactSizeIterator<Item = ([u32; 3], [f32; 3])>) -> VertexRows {
        let mut values = vec![0.0; points.len() * self.stride];
        for (out, (corners, weights)) in values.chunks_exact_mut(self.stride).zip(points) {
            for (corner, weight) in corners.into_iter().zip(weights) {
                for (out, value) in out.iter_mut().zip(self.row(corner as usize)) {
                    *out += weight * value;
                }
            }
        }
        VertexRows { values, stride: self.stride }
    }

    /// One padded row.
    pub fn row(&self, vertex: usize) -> &[f32] {
        &self.values[vertex * self.stride..(vertex + 1) * self.stride]
    }

    /// Squared distance of a row here to a row there.
    pub fn distance(&self, vertex: usize, other: &VertexRows, target: usize) -> f32 {
        let (left, _) = self.row(vertex).as_chunks::<LANES>();
        let (right, _) = other.row(target).as_chunks::<LANES>();
        let mut lanes = [0f32; LANES];
        for (a, b) in left.iter().zip(right) {
            for lane in 0..LANES {
                let difference = a[lane] - b[lane];
                lanes[lane] += difference * difference;
            }
        }
        lanes.iter().sum()
    }
}

/// Nearest target of every vertex by descent along the mesh.
pub struct MeshDescent<'a> {
    /// Adjacency of the target mesh.
    pub graph: &'a SymmetricSparse,
    /// Images of the vertices under the map.
    pub queries: &'a VertexRows,
    /// The vertices' own rows.
    pub targets: &'a VertexRows,
}

impl MeshDescent<'_> {
    /// From `seeds` (vertex, guess) breadth first over the mesh, then `sweeps` rounds in which each
    /// vertex also tries its neighbours' answers. About 25 distances a vertex.
    ///
    /// Vertices not reached from a seed keep [`NONE`].
    pub fn run(&self, source_graph: &SymmetricSparse, seeds: &[(u32, u32)], sweeps: usize) -> Vec<u32> {
        let count = source_graph.size();
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
            for &to in source_graph.neighbours(from) {
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
                self.try_neighbours(source_graph, vertex, &mut partner, &mut reached);
            }
        }
        partner
    }

    fn try_neighbours(
        &self,
        graph: &SymmetricSparse,
        vertex: usize,
        partner: &mut [u32],
        reached: &mut [f32],
    ) {
        for &neighbour in graph.neighbours(vertex) {
            let guess = partner[neighbour as usize];
            if guess == NONE || guess == partner[vertex] {
                continue;
            }
            if self.queries.distance(vertex, self.targets, guess as usize) < reached[vertex] {
                (partner[vertex], reached[vertex]) = self.descend(vertex, guess);
            }
        }
    }

    fn descend(&self, vertex: usize, guess: u32) -> (u32, f32) {
        let mut current = guess;
        let mut distance = self.queries.distance(vertex, self.targets, guess as usize);
        loop {
            let start = current;
            for &next in self.graph.neighbours(start as usize) {
                let candidate = self.queries.distance(vertex, self.targets, next as usize);
                if candidate < distance {
                    (current, distance) = (next, candidate);
                }
            }
            if current == start {
                return (current, distance);
            }
        }
    }
}
