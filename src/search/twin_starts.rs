//! Starts of maps from parts of a surface that are likely to be each other's mirror images.
//!
//! What is as far from each part along the surface as its own image is from the part's twin. That parts correspond is the oldest constraint of functional
//! maps (M. Ovsjanikov, M. Ben-Chen, J. Solomon, A. Butscher, L. Guibas, "Functional Maps: A Flexible Representation of Maps Between Shapes", 2012).

use crate::base::error::Result;
use crate::geometry::shortest_paths::EdgeLengths;
use crate::search::candidates::CANDIDATE_SIZE;
use crate::search::functional_map::Projection;
use crate::search::refinement::{SampleRefiner, nearest};
use crate::search::sign_network::SIGNS;
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::sampling::Samples;
use crate::spectral::twin_parts::{MOST_PARTS, TwinParts};
use faer::Mat;

/// Distances of samples from parts, and from their twins in the same order.
pub struct TwinDistances {
    own: Mat<f32>,
    twins: Mat<f32>,
}

impl TwinDistances {
    /// `None` of a surface without parts. O(parts x vertices log vertices).
    pub fn new(surface: &IntrinsicSurface, samples: &Samples) -> Option<TwinDistances> {
        let TwinParts { own, twin } = surface.parts.as_ref()?;
        let edges = EdgeLengths::new(surface.vertex_count(), &surface.triangles, &surface.edge_lengths);
        let (mut members, mut twins) = (vec![Vec::new(); MOST_PARTS], [0; MOST_PARTS]);
        for (vertex, (&part, &twin)) in (0..).zip(own.iter().zip(twin)) {
            members[usize::from(part)].push(vertex);
            twins[usize::from(part)] = usize::from(twin);
        }
        let from: Vec<Vec<f64>> = members.iter().map(|part| edges.distances(part)).collect();
        // A part may have no vertex left on a proxy.
        let is_left = |part: &usize| !members[*part].is_empty() && !members[twins[*part]].is_empty();
        let parts: Vec<usize> = (0..MOST_PARTS).filter(is_left).collect();
        let at = |i: usize, part: usize| from[part][samples.vertices[i] as usize].sqrt() as f32;
        Some(TwinDistances {
            own: Mat::from_fn(samples.count(), parts.len(), |i, k| at(i, parts[k])),
            twins: Mat::from_fn(samples.count(), parts.len(), |i, k| at(i, twins[parts[k]])),
        })
    }

    /// Functional maps of some sizes.
    ///
    /// # Errors
    /// [`crate::Error::Internal`].
    pub fn starts(&self, refiner: &SampleRefiner) -> Result<Vec<Mat<f64>>> {
        let partners = nearest(self.own.as_ref(), self.twins.as_ref());
        let largest = refiner.samples.rows.ncols();
        let start = |size: usize| refiner.estimate(&partners, size.min(largest), Projection::Orthogonal);
        [SIGNS, CANDIDATE_SIZE].into_iter().map(start).collect()
    }
}
