//! The last refinement, on all vertices: ZoomOut whose targets are points inside triangles.
//!
//! Vertex targets limit the map to the sampling of the mesh; the nearest point inside a triangle of
//! the embedded mesh does not (D. Ezuz, M. Ben-Chen, "Deblurring and Denoising of Maps between
//! Shapes", 2017, section 4.2). All vertices with their masses replace the samples of `refinement`.

use crate::eigenbasis::Eigenbasis;
use crate::error::Result;
use crate::functional_map::{Projection, project};
use crate::laplacian::IntrinsicSurface;
use crate::mesh_descent::{MeshDescent, VertexRows};
use crate::progress::Progress;
use crate::refinement::embed;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use std::collections::HashMap;

/// Weight of the mean curvature beside the eigenfunctions, whose squares have mean 1 each (`docs/method.md`).
const CURVATURE_WEIGHT: f64 = 8.0;

/// A point inside a triangle of a shell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrianglePoint {
    /// Index of the triangle.
    pub triangle: u32,
    /// Weights of its corners, each in 0..=1, summing to 1.
    pub barycentric: [f32; 3],
}

/// A shell with what matching on all its vertices needs.
pub struct MatchTarget<'a> {
    /// The surface.
    pub surface: &'a IntrinsicSurface,
    /// Its eigenbasis.
    pub basis: &'a Eigenbasis,
    /// The eigenfunctions in single precision, which matching needs no more than.
    functions: Mat<f32>,
    triangle_offsets: Vec<u32>,
    triangles_of_vertex: Vec<u32>,
}

/// Images of all vertices of a source shell on a target shell.
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
}

impl<'a> MatchTarget<'a> {
    /// O(triangles + vertices x eigenfunctions).
    pub fn new(surface: &'a IntrinsicSurface, basis: &'a Eigenbasis) -> Self {
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
        let exact = &basis.eigenfunctions;
        let functions = Mat::from_fn(exact.nrows(), exact.ncols(), |i, j| exact[(i, j)] as f32);
        MatchTarget { surface, basis, functions, triangle_offsets, triangles_of_vertex }
    }

    fn triangles_of(&self, vertex: u32) -> &[u32] {
        let start = self.triangle_offsets[vertex as usize] as usize;
        &self.triangles_of_vertex[start..self.triangle_offsets[vertex as usize + 1] as usize]
    }

    /// The images of all vertices of `source` under `map` (source size x target size).
    ///
    /// `seeds` are pairs (source vertex, target vertex) near the truth, at least one per connected part.
    pub fn images(&self, source: &MatchTarget, map: &Mat<f64>, seeds: &[(u32, u32)]) -> VertexImages {
        self.images_by(source, map, seeds, &[])
    }

    /// The same by eigenfunctions and the columns of `curvature`, which source and target share.
    fn images_by(
        &self,
        source: &MatchTarget,
        map: &Mat<f64>,
        seeds: &[(u32, u32)],
        curvature: &[Vec<f64>],
    ) -> VertexImages {
        let mapped = embed(source.functions.subcols(0, map.nrows()), map);
        let rows =
            |functions: MatRef<f32>| VertexRows::new(functions, map.ncols(), curvature, CURVATURE_WEIGHT);
        let queries = rows(mapped.as_ref());
        let targets = rows(self.functions.as_ref());
        let descent = MeshDescent { graph: &self.surface.stiffness, queries: &queries, targets: &targets };
        let partners = descent.run(&source.surface.stiffness, seeds, 2);
        let edges = self.squared_edges(&targets);
        let nearest = |(vertex, &partner)| {
            self.nearest_point(|corner| queries.distance(vertex, &targets, corner as usize), &edges, partner)
        };
        let points = partners.iter().enumerate().map(nearest).collect();
        VertexImages { partners, points }
    }

    /// Squared lengths in `rows` of the edges opposite each triangle's corners.
    fn squared_edges(&self, rows: &VertexRows) -> Vec<[f32; 3]> {
        let between = |a: u32, b: u32| rows.distance(a as usize, rows, b as usize);
        let of_triangle = |&[a, b, c]: &[u32; 3]| [between(b, c), between(c, a), between(a, b)];
        self.surface.triangles.iter().map(of_triangle).collect()
    }

    /// Nearest point among the triangles around `start`, walking on while it improves: `squared_distance` is that
    /// of the query to a vertex, `edges` are squared lengths.
    fn nearest_point(
        &self,
        squared_distance: impl Fn(u32) -> f32,
        edges: &[[f32; 3]],
        start: u32,
    ) -> TrianglePoint {
        let mut best = (TrianglePoint { triangle: 0, barycentric: [1.0, 0.0, 0.0] }, f32::MAX);
        let mut visited = start;
        for _ in 0..3 {
            for &triangle in self.triangles_of(visited) {
                let to_corners = self.surface.triangles[triangle as usize].map(&squared_distance);
                let (barycentric, squared) = nearest_in_triangle(to_corners, edges[triangle as usize]);
                if squared < best.1 {
                    best = (TrianglePoint { triangle, barycentric }, squared);
                }
            }
            let heaviest = self.heaviest_corner(&best.0);
            if heaviest == visited {
                break;
            }
            visited = heaviest;
        }
        best.0
    }

    /// The leading `size` eigenfunctions, a row a vertex.
    pub fn rows(&self, size: usize) -> VertexRows {
        VertexRows::new(self.functions.as_ref(), size, &[], 0.0)
    }

    /// What `rows` of the vertices give at `points`.
    pub fn rows_at(&self, rows: &VertexRows, points: &[TrianglePoint]) -> VertexRows {
        let corners = |point: &TrianglePoint| self.surface.triangles[point.triangle as usize];
        rows.combined(points.iter().map(|point| (corners(point), point.barycentric)))
    }

    /// The corner of `point`'s triangle with the largest weight.
    pub fn heaviest_corner(&self, point: &TrianglePoint) -> u32 {
        let weights = point.barycentric;
        let corner = (0..3).fold(0, |best, c| if weights[c] > weights[best] { c } else { best });
        self.surface.triangles[point.triangle as usize][corner]
    }
}

/// Nearest point of a triangle in any dimension (C. Ericson, "Real-Time Collision Detection", 2005, 5.1.5) and
/// its squared distance, from the squared distances to the corners and the squared lengths of the opposite edges.
fn nearest_in_triangle([own, to_b, to_c]: [f32; 3], [bc, e22, e11]: [f32; 3]) -> ([f32; 3], f32) {
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

/// Refines `map` (square, an involution) on all vertices of one shell through growing `sizes`, guided by
/// `curvature` beside the eigenfunctions unless that is empty.
///
/// Returns the last map and the images under it. O(vertices x size^2) a step.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn refine(
    shell: &MatchTarget,
    mut map: Mat<f64>,
    seeds: &[(u32, u32)],
    sizes: &[usize],
    curvature: &[Vec<f64>],
    progress: &Progress,
) -> Result<(Mat<f64>, VertexImages)> {
    let mut images = shell.images_by(shell, &map, seeds, curvature);
    for (step, &size) in sizes.iter().enumerate() {
        progress.report("refining on all vertices", 0.75 + 0.2 * step as f64 / sizes.len() as f64)?;
        let size = size.min(shell.basis.count());
        map = project(estimate(shell, shell, &images.points, size, size), Projection::Involution)?;
        let seeds: Vec<(u32, u32)> =
            images.partners.iter().enumerate().map(|(i, p)| (i as u32, *p)).collect();
        images = shell.images_by(shell, &map, &seeds, curvature);
    }
    Ok((map, images))
}

/// `source^T mass (target at points)`: the least-squares map, since the source basis is orthonormal.
pub fn estimate(
    source: &MatchTarget,
    target: &MatchTarget,
    points: &[TrianglePoint],
    source_size: usize,
    target_size: usize,
) -> Mat<f64> {
    let mut pulled = Mat::<f32>::zeros(points.len(), target_size);
    for j in 0..target_size {
        let column = target.functions.col_as_slice(j);
        for (i, value) in pulled.col_as_slice_mut(j).iter_mut().enumerate() {
            let corners = target.surface.triangles[points[i].triangle as usize];
            let weighted = |c: usize| points[i].barycentric[c] * column[corners[c] as usize];
            *value = (weighted(0) + weighted(1) + weighted(2)) * source.surface.lumped_mass[i] as f32;
        }
    }
    let functions = source.functions.subcols(0, source_size);
    let mut map = Mat::<f32>::zeros(source_size, target_size);
    matmul(map.as_mut(), Accum::Replace, functions.transpose(), pulled.as_ref(), 1.0, Par::Seq);
    Mat::from_fn(source_size, target_size, |i, j| f64::from(map[(i, j)]))
}
