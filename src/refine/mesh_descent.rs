//! Nearest points of a mesh in the spectral embedding, by descent along the mesh.
//!
//! Images of neighbouring vertices are near each other, so a vertex starts from its own image under a similar map, or
//! from the best of its neighbours' answers, and walks downhill along edges: linear in the vertices, where a search among
//! all of them is quadratic. From there it walks on from triangle to triangle as long as their points get nearer. It can
//! stop in a local minimum; one sweep over the neighbours' answers repairs nearly all of those. Nothing depends on how
//! vertices are numbered: a walk from the one triangle that holds the image would, where that lies on a side.

use crate::base::error::Result;
use crate::base::progress::CancelToken;
use crate::base::threads;
use crate::geometry::adjacency::{Adjacency, some};
use crate::geometry::embedded_triangles::{Fans, TrianglePoint, TriangleProducts, nearest_in_triangle};
use crate::mesh::NONE;
use crate::refine::vertex_rows::{SquaredDistance, VertexRows, products};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// Sources for which a thread is started, and after which a cancel is looked for.
const LEAST_PER_THREAD: usize = 1000;

/// What is nearest to a source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Nearest vertex, or [`NONE`].
    pub vertex: u32,
    /// Squared distance of that vertex.
    vertex_distance: f32,
    /// Nearest point.
    pub point: TrianglePoint,
    /// Its squared distance.
    distance: f32,
}

const UNREACHED: Answer = Answer {
    vertex: NONE,
    vertex_distance: f32::MAX,
    point: TrianglePoint { triangle: 0, barycentric: [1.0, 0.0, 0.0] },
    distance: f32::MAX,
};

/// Nearest point of every source by descent along the mesh.
pub struct MeshDescent<'a> {
    /// Adjacency of the mesh, whose vertices are the sources, too.
    pub graph: &'a Adjacency,
    /// Its triangles.
    pub triangles: &'a [[u32; 3]],
    /// Those around each vertex and behind each edge.
    pub fans: &'a Fans,
    /// Images of the sources under the map.
    pub queries: &'a VertexRows,
    /// The target vertices' rows.
    pub targets: &'a VertexRows,
    /// Columns of the rows in which distances are measured.
    pub columns: Range<usize>,
    /// Threads to use at most.
    pub threads: usize,
}

impl MeshDescent<'_> {
    /// Searches from seeds (source, target vertex near the truth), at least one per connected part, on to sources without a seed, breadth first. Then
    /// each source also tries its neighbours' answers.
    ///
    /// Sources not reached from a seed keep [`NONE`].
    ///
    /// # Errors
    /// Those of [`CancelToken::check`].
    pub fn run(&self, seeds: &[(u32, u32)], token: &CancelToken) -> Result<Vec<Answer>> {
        let mut answers = vec![UNREACHED; self.graph.count()];
        let mut queued = vec![false; self.graph.count()];
        let mut front: Vec<u32> = seeds.iter().map(|seed| seed.0).collect();
        front.iter().for_each(|&source| queued[source as usize] = true);
        let mut found = self.in_parallel(seeds.len(), token, |range| Task::Descend(&seeds[range]))?;
        while !front.is_empty() {
            let mut next = Vec::new();
            for (&source, answer) in front.iter().zip(found) {
                answers[source as usize] = answer;
                let is_new = |to: &u32| !std::mem::replace(&mut queued[*to as usize], true);
                next.extend(self.graph.of(source as usize).iter().copied().filter(is_new));
            }
            found = self.in_parallel(next.len(), token, |range| Task::Sweep(&next[range], &answers))?;
            front = next;
        }
        let all: Vec<u32> = (0..answers.len() as u32).collect();
        self.in_parallel(all.len(), token, |range| Task::Sweep(&all[range], &answers))
    }

    /// The answers of `0..count` in order.
    fn in_parallel<'b>(
        &self,
        count: usize,
        token: &CancelToken,
        task: impl Fn(Range<usize>) -> Task<'b> + Sync,
    ) -> Result<Vec<Answer>> {
        let threads = self.threads.min(count / LEAST_PER_THREAD).max(1);
        let ranges = threads::ranges(count, (4 * threads).max(count / LEAST_PER_THREAD));
        let parts = threads::map(threads, ranges, |range| {
            token.check()?;
            Ok(Arch::new().dispatch(Work { descent: self, task: task(range) }))
        });
        let parts = parts.into_iter().collect::<Result<Vec<Vec<Answer>>>>()?;
        Ok(parts.into_iter().flatten().collect())
    }
}

enum Task<'a> {
    /// Descend from each pair (source, guess).
    Descend(&'a [(u32, u32)]),
    /// Try the neighbours' answers, as they were before, of some sources.
    Sweep(&'a [u32], &'a [Answer]),
}

/// A task as an operation that is compiled for each instruction set and chosen at run time.
struct Work<'a> {
    descent: &'a MeshDescent<'a>,
    task: Task<'a>,
}

impl WithSimd for Work<'_> {
    type Output = Vec<Answer>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<Answer> {
        let search = Descent { simd, of: self.descent };
        // Loops: a closure would be compiled apart, for any processor.
        let mut answers = Vec::new();
        match self.task {
            Task::Descend(pairs) => {
                for &(source, guess) in pairs {
                    answers.push(search.near_vertex(source as usize, guess));
                }
            }
            Task::Sweep(sources, before) => {
                for &source in sources {
                    answers.push(search.best_of_neighbours(source as usize, before));
                }
            }
        }
        answers
    }
}

/// The search of one source at a time.
struct Descent<'a, S> {
    simd: S,
    of: &'a MeshDescent<'a>,
}

impl<S: Simd> Descent<'_, S> {
    /// The source's answer, or where the nearest of its neighbours' answers leads if that is nearer.
    ///
    /// An answer next to the source's own is not tried.
    #[inline(always)]
    fn best_of_neighbours(&self, source: usize, answers: &[Answer]) -> Answer {
        let own = answers[source];
        let (mut nearest, mut distance) = (own.vertex, own.vertex_distance);
        for neighbour in some(self.of.graph.of(source)) {
            let guess = answers[neighbour as usize].vertex;
            if guess == NONE || guess == nearest || guess == own.vertex {
                continue;
            }
            let next =
                own.vertex != NONE && self.of.graph.of(own.vertex as usize).binary_search(&guess).is_ok();
            let other = if next { f32::MAX } else { self.distance(source, guess) };
            if other < distance {
                (nearest, distance) = (guess, other);
            }
        }
        if nearest == own.vertex { own } else { self.near_vertex(source, nearest) }
    }

    /// Where the walk from the vertex ends to which the descent from `guess` leads.
    #[inline(always)]
    fn near_vertex(&self, source: usize, guess: u32) -> Answer {
        let (vertex, distance) = self.descend(source, guess, self.distance(source, guess));
        self.around_vertex(source, vertex, distance)
    }

    /// Where the walk from the triangles around `vertex` ends.
    #[inline(always)]
    fn around_vertex(&self, source: usize, vertex: u32, distance: f32) -> Answer {
        let answer = self.walk(source, self.nearest_around(source, vertex, UNREACHED));
        if distance < answer.vertex_distance {
            return Answer { vertex, vertex_distance: distance, ..answer };
        }
        answer
    }

    /// A vertex that is as near as all its neighbours, at a hub as some of them, and its squared distance; `distance` is the squared one of `guess`.
    #[inline(always)]
    fn descend(&self, source: usize, guess: u32, mut distance: f32) -> (u32, f32) {
        let mut current = guess;
        loop {
            let start = current;
            for next in some(self.of.graph.of(start as usize)) {
                let candidate = self.distance(source, next);
                if candidate < distance {
                    (current, distance) = (next, candidate);
                }
            }
            if current == start {
                return (current, distance);
            }
        }
    }

    /// From triangle to triangle as long as the nearest point gets nearer: over the edge that the point lies on, or
    /// to those around its corner.
    #[inline(always)]
    fn walk(&self, source: usize, start: Answer) -> Answer {
        let mut best = start;
        loop {
            let (triangle, weights) = (best.point.triangle as usize, best.point.barycentric);
            let mut found = best;
            for corner in 0..3 {
                if weights[corner] == 1.0 {
                    found = self.nearest_around(source, self.of.triangles[triangle][corner], found);
                } else if weights[corner] == 0.0
                    && weights[(corner + 1) % 3] < 1.0
                    && weights[(corner + 2) % 3] < 1.0
                    && self.of.fans.behind[triangle][corner] != NONE
                {
                    let other = self.nearest_in(source, self.of.fans.behind[triangle][corner]);
                    found = if other.distance < found.distance { other } else { found };
                }
            }
            if found.distance >= best.distance {
                return best;
            }
            best = found;
        }
    }

    /// The nearest of `best` and what the triangles around `vertex` hold.
    #[inline(always)]
    fn nearest_around(&self, source: usize, vertex: u32, best: Answer) -> Answer {
        let mut best = best;
        for triangle in some(self.of.fans.of(vertex)) {
            let other = self.nearest_in(source, triangle);
            best = if other.distance < best.distance { other } else { best };
        }
        best
    }

    /// The point of a triangle that is nearest to the source, and the nearest corner.
    #[inline(always)]
    fn nearest_in(&self, source: usize, triangle: u32) -> Answer {
        let [a, b, c] = self.of.triangles[triangle as usize];
        let corners = [
            self.columns(self.of.targets, a),
            self.columns(self.of.targets, b),
            self.columns(self.of.targets, c),
        ];
        let products = products(self.simd, self.columns(self.of.queries, source as u32), corners);
        let (barycentric, distance) = nearest_in_triangle(products);
        let TriangleProducts { own, along, edges } = products;
        let (to_b, to_c) = (own - 2.0 * along[0] + edges[0], own - 2.0 * along[1] + edges[2]);
        let (vertex, vertex_distance) = if own <= to_b && own <= to_c {
            (a, own)
        } else if to_b <= to_c {
            (b, to_b)
        } else {
            (c, to_c)
        };
        Answer { vertex, vertex_distance, point: TrianglePoint { triangle, barycentric }, distance }
    }

    #[inline(always)]
    fn distance(&self, source: usize, vertex: u32) -> f32 {
        let left = self.columns(self.of.queries, source as u32);
        let right = self.columns(self.of.targets, vertex);
        SquaredDistance { left, right }.with_simd(self.simd)
    }

    #[inline(always)]
    fn columns<'b>(&self, rows: &'b VertexRows, row: u32) -> &'b [f32] {
        &rows.row(row as usize)[self.of.columns.clone()]
    }
}
