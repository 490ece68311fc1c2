//! The last refinement, on all vertices: ZoomOut whose targets are points inside triangles.
//!
//! Vertex targets limit the map to the sampling of the mesh; the nearest point inside a triangle of
//! the embedded mesh does not (D. Ezuz, M. Ben-Chen, "Deblurring and Denoising of Maps between
//! Shapes", 2017, section 4.2).

use crate::base::error::Result;
use crate::base::progress::{CancelToken, Progress};
use crate::geometry::adjacency::Adjacency;
use crate::geometry::embedded_triangles::{Fans, TrianglePoint};
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::NONE;
use crate::refine::mesh_descent::MeshDescent;
use crate::refine::vertex_rows::{Guide, VertexRows};
use crate::search::functional_map::nearest_involution;
use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::laplacian::IntrinsicSurface;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use std::sync::Arc;

/// A shell with what matching on all its vertices needs; clones share it.
#[derive(Clone)]
pub struct MatchTarget<'a> {
    /// The surface.
    pub surface: &'a IntrinsicSurface,
    /// Its eigenbasis.
    pub basis: &'a Eigenbasis,
    /// Its vertices' rows.
    pub rows: Arc<VertexRows>,
    /// The vertices next to each.
    pub graph: Arc<Adjacency>,
    fans: Arc<Fans>,
    threads: usize,
}

impl<'a> MatchTarget<'a> {
    /// O(triangles + vertices x eigenfunctions). Images will be sought on at most `threads` threads.
    pub fn new(surface: &'a IntrinsicSurface, basis: &'a Eigenbasis, threads: usize) -> Self {
        let rows = VertexRows::new(surface, basis);
        let fans = Fans::new(surface.vertex_count(), &surface.triangles);
        let graph = Adjacency::of_vertices(&surface.triangles, &fans.around);
        let (rows, graph, fans) = (Arc::new(rows), Arc::new(graph), Arc::new(fans));
        MatchTarget { surface, basis, rows, graph, fans, threads }
    }

    /// The same for another number of threads.
    pub fn with_threads(&self, threads: usize) -> Self {
        MatchTarget { threads, ..self.clone() }
    }

    /// The images of the vertices under `map` (square), sought from `seeds`: vertices, and others near their images.
    ///
    /// # Errors
    /// Those of [`CancelToken::check`].
    pub fn images(
        &self,
        map: &Mat<f64>,
        seeds: &[(u32, u32)],
        guide: Guide,
        token: &CancelToken,
    ) -> Result<VertexMap> {
        let descent = MeshDescent {
            graph: &self.graph,
            triangles: &self.surface.triangles,
            fans: &self.fans,
            queries: &self.rows.mapped(map),
            targets: &self.rows,
            columns: self.rows.columns(map.ncols(), guide),
            threads: self.threads,
        };
        let answers = descent.run(seeds, token)?;
        Ok(VertexMap {
            partners: answers.iter().map(|answer| answer.vertex).collect(),
            points: answers.iter().map(|answer| answer.point).collect(),
        })
    }

    /// The least-squares map of `size` that sends each vertex to its image, projected to an involution.
    ///
    /// # Errors
    /// [`crate::Error::Internal`] if the projection fails.
    pub fn map_of(&self, images: &[TrianglePoint], size: usize) -> Result<Mat<f64>> {
        let weighted = |(point, mass): (&TrianglePoint, &f64)| {
            (self.corners(point), point.barycentric.map(|weight| weight * *mass as f32))
        };
        let columns = self.rows.function_columns(size);
        let points = images.iter().zip(&self.surface.lumped_mass).map(weighted);
        let pulled = self.rows.combined(points, columns);
        let (from, onto) = (self.rows.functions(size), pulled.functions(size));
        let mut map = Mat::<f32>::zeros(size, size);
        matmul(map.as_mut(), Accum::Replace, from.transpose(), onto, 1.0, Par::Seq);
        let map = Mat::from_fn(size, size, |i, j| f64::from(map[(i, j)]));
        nearest_involution(&map)
    }

    /// What `rows` of the vertices give at `points`.
    pub fn rows_at(&self, rows: &VertexRows, points: &[TrianglePoint]) -> VertexRows {
        let points = points.iter().map(|point| (self.corners(point), point.barycentric));
        rows.combined(points, 0..rows.width())
    }

    /// The corners of `point`'s triangle.
    fn corners(&self, point: &TrianglePoint) -> [u32; 3] {
        self.surface.triangles[point.triangle as usize]
    }
}

/// Refines the map with the given `images` through growing `sizes`.
///
/// Returns the last map and its images. O(vertices x size^2) a step.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn refine(
    shell: &MatchTarget,
    mut images: VertexMap,
    sizes: &[usize],
    guide: Guide,
    progress: &Progress,
) -> Result<(Mat<f64>, VertexMap)> {
    let mut map = Mat::zeros(0, 0);
    for &size in sizes {
        progress.goes_on()?;
        map = shell.map_of(&images.points, size.min(shell.basis.count()))?;
        let seed = |(source, &partner): (u32, &u32)| (source, if partner == NONE { 0 } else { partner });
        let seeds: Vec<(u32, u32)> = (0..).zip(&images.partners).map(seed).collect();
        images = shell.images(&map, &seeds, guide, progress.token())?;
    }
    Ok((map, images))
}
