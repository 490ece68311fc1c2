//! A picture of a symmetry: the mesh from two opposite sides, pairs in matching colours, the fixed curve drawn.
//!
//! Triangles and pieces of the curve are sorted by depth and painted from back to front (M. E. Newell,
//! R. G. Newell, T. L. Sancha, "A solution to the hidden surface problem", 1972, without its splitting of
//! overlapping polygons: large triangles are divided instead).

mod facets;
mod paint;
mod view;

pub use view::Up;

use crate::base::error::{Error, Result};
use crate::detect::correspondence::Symmetry;
use crate::mesh::Mesh;
use facets::Surface;
use view::View;

/// The picture as a PNG file's bytes: two views side by side, at most 1800 x 1000 pixels.
///
/// Cost: O(n log n) in the triangles; about 0.3 s for 50,000 vertices.
///
/// # Errors
/// [`Error::Internal`] if the PNG cannot be encoded.
pub fn png(mesh: &Mesh, symmetry: &Symmetry, up: Up) -> Result<Vec<u8>> {
    let surface = Surface::new(mesh, symmetry);
    let views = View::front_and_back(mesh, symmetry, up);
    let pixmap = paint::paint(&surface, &views)?;
    pixmap.encode_png().map_err(|error| Error::Internal(format!("the picture cannot be encoded: {error}")))
}
