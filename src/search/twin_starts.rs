//! Starts of maps from parts of a surface that are likely to be each other's mirror images.
//!
//! What is as far from each part along the surface as its own image is from the part's twin. That parts correspond is the oldest constraint of functional
//! maps (M. Ovsjanikov, M. Ben-Chen, J. Solomon, A. Butscher, L. Guibas, "Functional Maps: A Flexible Representation of Maps Between Shapes", 2012).

use crate::base::error::Result;
use crate::geometry::shortest_paths::EdgeLengths;
use crate::search::functional_map::Projection;
use crate::search::refinement::{SampleRefiner, nearest};
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::sampling::Samples;
use crate::spectral::twin_parts::TwinParts;
use faer::Mat;
use std::collections::BTreeMap;

/// Sizes of the starts.
const SIZES: [usize; 2] = [12, 30];

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
        let mut members: BTreeMap<u8, (Vec<u32>, u8)> = BTreeMap::new();
        for (vertex, (&part, &twin)) in (0..).zip(own.iter().zip(twin)) {
            members.entry(part).or_insert((Vec::new(), twin)).0.push(vertex);
        }
        // A part may have no vertex left on a proxy.
        let pairs: Vec<[u8; 2]> = members
            .iter()
            .map(|(&part, &(_, twin))| [part, twin])
            .filter(|[_, twin]| members.contains_key(twin))
            .collect();
        let from: BTreeMap<u8, Vec<f64>> =
            members.iter().map(|(&part, (vertices, _))| (part, edges.distances(vertices))).collect();
        let at = |i: usize, part: u8| from[&part][samples.vertices[i] as usize].sqrt() as f32;
        Some(TwinDistances {
            own: Mat::from_fn(samples.count(), pairs.len(), |i, k| at(i, pairs[k][0])),
            twins: Mat::from_fn(samples.count(), pairs.len(), |i, k| at(i, pairs[k][1])),
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
        SIZES.into_iter().map(start).collect()
    }
}
