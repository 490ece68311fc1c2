//! Few points of a shell that stand for all of it while a map is refined.
//!
//! A functional map has far fewer unknowns than a fine mesh has vertices, so some thousand points determine it as
//! well as all vertices do (R. Magnet, M. Ovsjanikov, "Scalable and Efficient Functional Map Computations on
//! Dense Meshes", 2023, for the sampling of large meshes; S. Melzi et al., "ZoomOut", 2019, section 4.3). Targets
//! remain all points of the surface.

use crate::adjacency::{Adjacency, nearest_seeds};
use crate::dense::{gram_cholesky, product};
use crate::error::Result;
use crate::full_refinement::{MatchTarget, Sources};
use crate::sampling::area_weighted_vertices;
use crate::vertex_rows::VertexRows;
use faer::Mat;

/// Points spread over a shell in proportion to area; each stands for the vertices nearest to it along edges.
pub struct SpreadPoints {
    /// Their vertices, ascending.
    pub vertices: Vec<u32>,
    /// Area that each stands for.
    pub mass: Vec<f64>,
    rows: VertexRows,
    graph: Adjacency,
    gram: Mat<f64>,
    /// For each vertex the point that stands for it.
    nearest: Vec<u32>,
}

impl SpreadPoints {
    /// About `count` points of a connected shell, for maps of at most `size`. O(vertices + count x size^2).
    ///
    /// # Errors
    /// [`crate::Error::Internal`] if the eigenfunctions are not finite.
    pub fn new(shell: &MatchTarget, count: usize, size: usize) -> Result<SpreadPoints> {
        let surface = shell.surface;
        let mut vertices: Vec<u32> = area_weighted_vertices(&surface.lumped_mass, count)
            .into_iter()
            .map(|vertex| vertex as u32)
            .collect();
        vertices.dedup();
        let everywhere = shell.vertices();
        let around = |vertex: u32| everywhere.graph.of(vertex as usize).iter().copied();
        let nearest = nearest_seeds(surface.vertex_count(), &vertices, around);
        let mut mass = vec![0.0; vertices.len()];
        for (point, own) in nearest.iter().zip(&surface.lumped_mass) {
            mass[*point as usize] += own;
        }
        let across = (0..surface.vertex_count() as u32).flat_map(|vertex| {
            let point = |vertex: u32| nearest[vertex as usize];
            everywhere.graph.of(vertex as usize).iter().map(move |&next| (point(vertex), point(next)))
        });
        let graph = Adjacency::new(vertices.len(), across);
        let functions = shell.basis.eigenfunctions.subcols(0, size);
        let value = |i: usize, j: usize| functions[(vertices[i] as usize, j)];
        let rooted = Mat::from_fn(vertices.len(), functions.ncols(), |i, j| mass[i].sqrt() * value(i, j));
        let gram = gram_cholesky(product(rooted.transpose(), rooted.as_ref()).as_ref())?;
        Ok(SpreadPoints { rows: shell.rows.at(&vertices), vertices, mass, graph, gram, nearest })
    }

    /// The points that stand for some `vertices`, with the `images` of these: a start for all points.
    pub fn seeds(&self, vertices: &[u32], images: impl Iterator<Item = u32>) -> Vec<(u32, u32)> {
        vertices.iter().map(|vertex| self.nearest[*vertex as usize]).zip(images).collect()
    }

    /// The points as those whose images are sought.
    pub fn sources(&self) -> Sources<'_> {
        Sources { rows: &self.rows, mass: &self.mass, graph: &self.graph, gram: Some(self.gram.as_ref()) }
    }
}
