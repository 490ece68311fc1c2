//! Starts of maps from parts of a surface that are likely to be each other's mirror images.
//!
//! What is as far from each part along the surface as its own image is from the part's twin. That parts correspond is the oldest constraint of functional
//! maps (M. Ovsjanikov, M. Ben-Chen, J. Solomon, A. Butscher, L. Guibas, "Functional Maps: A Flexible Representation of Maps Between Shapes", 2012).

use crate::base::error::Result;
use crate::geometry::shortest_paths::EdgeLengths;
use crate::search::functional_map::Projection;
use crate::search::refinement::{SampleRefiner, nearest};
use crate::spectral::laplacian::IntrinsicSurface;
use faer::Mat;

/// Sizes of the starts.
const SIZES: [usize; 3] = [8, 12, 24];

/// Distances of samples from parts, and from their twins in the same order.
pub struct TwinDistances {
    own: Mat<f32>,
    twins: Mat<f32>,
}

impl TwinDistances {
    /// `parts` are vertices of each part, `twins` the index of each one's twin. O(parts x vertices log vertices).
    pub fn new(surface: &IntrinsicSurface, samples: &[u32], parts: &[Vec<u32>], twins: &[usize]) -> TwinDistances {
        let edges = EdgeLengths::new(surface.vertex_count(), &surface.triangles, &surface.edge_lengths);
        let from: Vec<Vec<f64>> = parts.iter().map(|part| edges.distances(part)).collect();
        let at = |i: usize, part: usize| from[part][samples[i] as usize].sqrt() as f32;
        TwinDistances {
            own: Mat::from_fn(samples.len(), parts.len(), at),
            twins: Mat::from_fn(samples.len(), parts.len(), |i, part| at(i, twins[part])),
        }
    }

    /// Functional maps of some sizes.
    ///
    /// # Errors
    /// [`crate::Error::Internal`].
    pub fn starts(&self, refiner: &SampleRefiner) -> Result<Vec<Mat<f64>>> {
        let partners = nearest(self.own.as_ref(), self.twins.as_ref());
        let largest = refiner.samples.rows.ncols();
        let start = |size: usize| refiner.estimate(&partners, size.min(largest), Projection::Orthogonal);
        SIZES.into_iter().map(start).collect()
    }
}
