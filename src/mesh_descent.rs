//! Nearest neighbours of all vertices in the spectral embedding, by descent along the mesh.
//!
//! Images of neighbouring vertices are near each other, so a vertex starts from its neighbour's
//! answer and walks downhill along edges: linear in the vertices, where a search among all of them
//! is quadratic. The walk can stop in a local minimum; sweeps over the neighbours' answers repair
//! nearly all of those.

use crate::adjacency::Adjacency;
use crate::mesh::NONE;
use crate::threads;
use crate::vertex_rows::VertexRows;
use std::ops::Range;

/// Work for which a thread is started.
const LEAST_PER_THREAD: usize = 500;

/// A target vertex and its squared distance.
type Answer = (u32, f32);

const UNREACHED: Answer = (NONE, f32::MAX);

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
    /// Threads to use at most.
    pub threads: usize,
}

impl MeshDescent<'_> {
    /// From `seeds` (vertex, guess) breadth first over the mesh, then `sweeps` rounds in which each
    /// vertex also tries its neighbours' answers of the round before. About 25 distances a vertex.
    ///
    /// Vertices not reached from a seed keep [`NONE`].
    pub fn run(&self, sources: &Adjacency, seeds: &[(u32, u32)], sweeps: usize) -> Vec<u32> {
        let mut answers = vec![UNREACHED; sources.count()];
        let mut front = Vec::with_capacity(seeds.len());
        let mut queued = vec![false; sources.count()];
        for &(vertex, guess) in seeds {
            if !std::mem::replace(&mut queued[vertex as usize], true) {
                front.push((vertex, guess));
            }
        }
        while !front.is_empty() {
            let found = self.in_parallel(front.len(), |i| self.descend(front[i].0 as usize, front[i].1));
            let mut next = Vec::new();
            for (&(vertex, _), answer) in front.iter().zip(found) {
                answers[vertex as usize] = answer;
                for &to in sources.of(vertex as usize) {
                    if !std::mem::replace(&mut queued[to as usize], true) {
                        next.push((to, answer.0));
                    }
                }
            }
            front = next;
        }
        for _ in 0..sweeps {
            answers =
                self.in_parallel(answers.len(), |vertex| self.best_of_neighbours(sources, vertex, &answers));
        }
        answers.into_iter().map(|(partner, _)| partner).collect()
    }

    /// `work` of `0..count` in order.
    fn in_parallel<R: Send>(&self, count: usize, work: impl Fn(usize) -> R + Sync) -> Vec<R> {
        let threads = self.threads.min(count / LEAST_PER_THREAD).max(1);
        let parts = threads::map(threads, threads::ranges(count, 4 * threads), |range| {
            range.map(&work).collect::<Vec<R>>()
        });
        parts.into_iter().flatten().collect()
    }

    /// The vertex's answer, or where its neighbours' answers lead if that is nearer.
    fn best_of_neighbours(&self, sources: &Adjacency, vertex: usize, answers: &[Answer]) -> Answer {
        let mut best = answers[vertex];
        for &neighbour in sources.of(vertex) {
            let guess = answers[neighbour as usize].0;
            if guess != NONE && guess != best.0 && self.distance(vertex, guess) < best.1 {
                best = self.descend(vertex, guess);
            }
        }
        best
    }

    fn descend(&self, vertex: usize, guess: u32) -> Answer {
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
