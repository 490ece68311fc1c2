//! The last refinement, on all vertices: ZoomOut whose targets are points inside triangles.
//!
//! Vertex targets limit the map to the sampling of the mesh; the nearest point inside a triangle of
//! the embedded mesh does not (D. Ezuz, M. Ben-Chen, "Deblurring and Denoising of Maps between
//! Shapes", 2017, section 4.2). The points whose images are sought are all vertices, or the few of
//! [`crate::spread_points`], with their masses.

use crate::adjacency::Adjacency;
use crate::dense::cholesky_solve;
use crate::eigenbasis::Eigenbasis;
use crate::error::Result;
use crate::functional_map::{Projection, project};
use crate::laplacian::IntrinsicSurface;
use crate::mesh_descent::MeshDescent;
use crate::progress::Progress;
use crate::threads;
use crate::vertex_rows::{Guide, VertexRows};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use std::collections::HashMap;
use std::ops::Range;

/// A point inside a triangle of a shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrianglePoint {
    /// Index of the triangle.
    pub triangle: u32,
    /// Weights of its corners, each in 0..=1, summing to 1.
    pub barycentric: [f32; 3],
}

impl TrianglePoint {
    /// The corner with the largest weight, 0..=2; the first of equals.
    pub fn heaviest(&self) -> usize {
        let weights = self.barycentric;
        (0..3).fold(0, |best, corner| if weights[corner] > weights[best] { corner } else { best })
    }
}

/// A shell with what matching on all its vertices needs.
pub struct MatchTarget<'a> {
    /// The surface.
    pub surface: &'a IntrinsicSurface,
    /// Its eigenbasis.
    pub basis: &'a Eigenbasis,
    /// Its vertices' rows.
    pub rows: VertexRows,
    graph: Adjacency,
    triangle_offsets: Vec<u32>,
    triangles_of_vertex: Vec<u32>,
    threads: usize,
}

/// Points of a shell whose images are sought, each with what matching and estimation need of it.
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    /// Their rows.
    pub rows: &'a VertexRows,
    /// Area that each point stands for.
    pub mass: &'a [f64],
    /// Which points are next to each other.
    pub graph: &'a Adjacency,
    /// Cholesky factor of `functions^T mass functions`; none where that is the identity.
    pub gram: Option<MatRef<'a, f64>>,
}

/// Images of the vertices of a source shell, or of some points of it, on a target shell.
#[derive(Debug, Clone)]
pub struct VertexImages {
    /// Nearest target vertex.
    pub partners: Vec<u32>,
    /// Nearest point of the target.
    pub points: Vec<TrianglePoint>,
}

impl VertexImages {
    /// Images that are vertices: `partners[v]` is that of v, a corner of some of the `triangles`. O(both).
    pub fn at_vertices(triangles: &[[u32; 3]], partners: Vec<u32>) -> VertexImages {
        let mut corner_of = HashMap::new();
        for (index, triangle) in triangles.iter().enumerate() {
            for (corner, &vertex) in triangle.iter().enumerate() {
                corner_of.insert(vertex, (index as u32, corner));
            }
        }
        let point = |vertex: &u32| {
            let (triangle, corner) = corner_of[vertex];
            TrianglePoint {
                triangle,
                barycentric: std::array::from_fn(|c| if c == corner { 1.0 } else { 0.0 }),
            }
        };
        VertexImages { points: partners.iter().map(point).collect(), partners }
    }

    /// Each point with its partner, to start from.
    pub fn seeds(&self) -> Vec<(u32, u32)> {
        (0..).zip(self.partners.iter().copied()).collect()
    }
}

impl<'a> MatchTarget<'a> {
    /// O(triangles + vertices x eigenfunctions). Images will be sought on at most `threads` threads.
    pub fn new(surface: &'a IntrinsicSurface, basis: &'a Eigenbasis, threads: usize) -> Self {
        let mut triangle_offsets = vec![0u32; surface.vertex_count() + 1];
        for vertex in surface.triangles.iter().flatten() {
            triangle_offsets[*vertex as usize + 1] += 1;
        }
        for i in 0..surface.vertex_count() {
            triangle_offsets[i + 1] += triangle_offsets[i];
        }
        let mut next = triangle_offsets.clone();
        let mut triangles_of_vertex = vec![0; 3 * surface.triangles.len()];
        for (index, triangle) in surface.triangles.iter().enumerate() {
            for &vertex in triangle {
                triangles_of_vertex[next[vertex as usize] as usize] = index as u32;
                next[vertex as usize] += 1;
            }
        }
        let rows = VertexRows::new(surface, basis);
        let sides = |&[a, b, c]: &[u32; 3]| [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)];
        let graph = Adjacency::new(surface.vertex_count(), surface.triangles.iter().flat_map(sides));
        MatchTarget { surface, basis, rows, graph, triangle_offsets, triangles_of_vertex, threads }
    }

    /// All vertices.
    pub fn vertices(&self) -> Sources<'_> {
        Sources { rows: &self.rows, mass: &self.surface.lumped_mass, graph: &self.graph, gram: None }
    }

    fn triangles_of(&self, vertex: u32) -> &[u32] {
        let start = self.triangle_offsets[vertex as usize] as usize;
        &self.triangles_of_vertex[start..self.triangle_offsets[vertex as usize + 1] as usize]
    }

    /// The images of `source` under `map` (source size x target size).
    ///
    /// `seeds` are pairs (point of the source, target vertex) near the truth, at least one per connected part.
    pub fn images(
        &self,
        source: &Sources,
        map: &Mat<f64>,
        seeds: &[(u32, u32)],
        guide: Guide,
    ) -> VertexImages {
        let queries = source.rows.mapped(map);
        let columns = self.rows.columns(map.ncols(), guide);
        let (targets, threads) = (&self.rows, self.threads);
        let descent =
            MeshDescent { graph: &self.graph, queries: &queries, targets, columns: columns.clone(), threads };
        let partners = descent.run(source.graph, seeds, 2);
        let points = threads::map(threads, threads::ranges(partners.len(), threads), |range| {
            let mut search = PointSearch::new(self, &queries, columns.clone());
            range.map(|point| search.nearest(point, partners[point])).collect::<Vec<_>>()
        });
        VertexImages { points: points.into_iter().flatten().collect(), partners }
    }

    /// What `rows` of the vertices give at `points`.
    pub fn rows_at(&self, rows: &VertexRows, points: &[TrianglePoint]) -> VertexRows {
        rows.combined(points.iter().map(|point| (self.corners(point), point.barycentric)))
    }

    /// The corners of `point`'s triangle.
    fn corners(&self, point: &TrianglePoint) -> [u32; 3] {
        self.surface.triangles[point.triangle as usize]
    }

    /// The corner of `point`'s triangle with the largest weight.
    pub fn heaviest_corner(&self, point: &TrianglePoint) -> u32 {
        self.corners(point)[point.heaviest()]
    }
}

/// Nearest points inside triangles of the target.
struct PointSearch<'a> {
    target: &'a MatchTarget<'a>,
    queries: &'a VertexRows,
    columns: Range<usize>,
    /// Squared lengths of the edges opposite each triangle's corners; not a number until they are needed.
    edges: Vec<[f32; 3]>,
    /// Vertices near the present query with their squared distances from it.
    distances: Vec<(u32, f32)>,
}

impl<'a> PointSearch<'a> {
    fn new(target: &'a MatchTarget<'a>, queries: &'a VertexRows, columns: Range<usize>) -> Self {
        let edges = vec![[f32::NAN; 3]; target.surface.triangles.len()];
        PointSearch { target, queries, columns, edges, distances: Vec::new() }
    }

    /// Nearest to row `query` among the triangles around `start`, walking on while it improves.
    fn nearest(&mut self, query: usize, start: u32) -> TrianglePoint {
        self.distances.clear();
        let mut best = (TrianglePoint { triangle: 0, barycentric: [1.0, 0.0, 0.0] }, f32::MAX);
        let mut visited = start;
        for _ in 0..3 {
            for &triangle in self.target.triangles_of(visited) {
                let corners = self.target.surface.triangles[triangle as usize];
                let to_corners = corners.map(|corner| self.distance(query, corner));
                let (barycentric, squared) = nearest_in_triangle(to_corners, self.edges_of(triangle));
                if squared < best.1 {
                    best = (TrianglePoint { triangle, barycentric }, squared);
                }
            }
            let heaviest = self.target.heaviest_corner(&best.0);
            if heaviest == visited {
                break;
            }
            visited = heaviest;
        }
        best.0
    }

    fn distance(&mut self, query: usize, vertex: u32) -> f32 {
        if let Some(&(_, known)) = self.distances.iter().find(|(other, _)| *other == vertex) {
            return known;
        }
        let distance = self.queries.distance(query, &self.target.rows, vertex as usize, &self.columns);
        self.distances.push((vertex, distance));
        distance
    }

    fn edges_of(&mut self, triangle: u32) -> [f32; 3] {
        let edges = &mut self.edges[triangle as usize];
        if edges[0].is_nan() {
            let rows = &self.target.rows;
            let between = |a: u32, b: u32| rows.distance(a as usize, rows, b as usize, &self.columns);
            let [a, b, c] = self.target.surface.triangles[triangle as usize];
            *edges = [between(b, c), between(c, a), between(a, b)];
        }
        *edges
    }
}

/// Nearest point of a triangle in any dimension (C. Ericson, "Real-Time Collision Detection", 2005, 5.1.5) and
/// its squared distance, from the squared distances to the corners and the squared lengths of the opposite edges.
pub fn nearest_in_triangle([own, to_b, to_c]: [f32; 3], [bc, e22, e11]: [f32; 3]) -> ([f32; 3], f32) {
    // Inner products of a -> query with a -> b and a -> c, and of these two.
    let (d1, d2) = (0.5 * (e11 + own - to_b), 0.5 * (e22 + own - to_c));
    let e12 = 0.5 * (e11 + e22 - bc);
    let squared =
        |s: f32, t: f32| own - 2.0 * (s * d1 + t * d2) + s * s * e11 + 2.0 * s * t * e12 + t * t * e22;
    let determinant = e11 * e22 - e12 * e12;
    if determinant > 1e-12 * e11 * e22 {
        let (s, t) = ((e22 * d1 - e12 * d2) / determinant, (e11 * d2 - e12 * d1) / determinant);
        if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
            return (weights(s, t), squared(s, t));
        }
    }
    let ratio = |above: f32, below: f32| if below > 0.0 { (above / below).clamp(0.0, 1.0) } else { 0.0 };
    let along_b = ratio(d1, e11);
    let along_c = ratio(d2, e22);
    let across = ratio(d2 - d1 + e11 - e12, e11 - 2.0 * e12 + e22);
    let edges = [(along_b, 0.0), (0.0, along_c), (1.0 - across, across)];
    let (s, t) =
        edges.into_iter().min_by(|x, y| squared(x.0, x.1).total_cmp(&squared(y.0, y.1))).expect("three");
    (weights(s, t), squared(s, t))
}

/// Barycentric weights of `a + s (b - a) + t (c - a)`; rounding makes none of them negative.
fn weights(s: f32, t: f32) -> [f32; 3] {
    [(1.0 - s - t).max(0.0), s, t]
}

/// Refines `map` (square, an involution) on `points` of the shell through growing `sizes`.
///
/// Returns the last map and the images of the points under it. O(points x size^2) a step.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn refine(
    shell: &MatchTarget,
    points: &Sources,
    mut map: Mat<f64>,
    seeds: &[(u32, u32)],
    sizes: &[usize],
    guide: Guide,
    progress: &Progress,
) -> Result<(Mat<f64>, VertexImages)> {
    let mut images = shell.images(points, &map, seeds, guide);
    for (step, &size) in sizes.iter().enumerate() {
        progress.report("refining", 0.75 + 0.2 * step as f64 / sizes.len() as f64)?;
        let size = size.min(shell.basis.count());
        map = project(estimate(points, shell, &images.points, size, size), Projection::Involution)?;
        images = shell.images(points, &map, &images.seeds(), guide);
    }
    Ok((map, images))
}

/// The least-squares map that sends each point of `source` to its image.
pub fn estimate(
    source: &Sources,
    target: &MatchTarget,
    images: &[TrianglePoint],
    source_size: usize,
    target_size: usize,
) -> Mat<f64> {
    let mut pulled = target.rows_at(&target.rows, images);
    pulled.scale_rows(source.mass);
    let (from, onto) = (source.rows.functions(source_size), pulled.functions(target_size));
    let mut single = Mat::<f32>::zeros(source_size, target_size);
    matmul(single.as_mut(), Accum::Replace, from.transpose(), onto, 1.0, Par::Seq);
    let mut map = Mat::from_fn(source_size, target_size, |i, j| f64::from(single[(i, j)]));
    if let Some(lower) = source.gram {
        cholesky_solve(lower.submatrix(0, 0, source_size, source_size), map.as_mut());
    }
    map
}
