//! A picture of a symmetry: the mesh from two opposite sides, pairs in matching colours, the fixed curve drawn.
//!
//! Only what is visible is drawn (`canvas`); the curve is drawn over it where nothing hides it.

mod canvas;
mod facets;
mod paint;
mod view;

pub use view::Up;

use facets::Surface;
use intrinsym::{Error, Mesh, Result, Symmetry};
use tiny_skia::Pixmap;
use view::View;

/// What the bytes of every picture hold near their start.
pub const PNG_MARK: &str = "tEXtSoftware\0Intrinsym";

/// The picture as a PNG file's bytes: two views side by side, at most 1800 x 1000 pixels.
///
/// Cost: O(n log n) in the triangles, and the pixels of what is visible.
///
/// # Errors
/// [`Error::Internal`] if the PNG cannot be encoded.
pub fn png(mesh: &Mesh, symmetry: &Symmetry, up: Up) -> Result<Vec<u8>> {
    let surface = Surface::new(mesh, symmetry);
    let views = View::front_and_back(mesh, symmetry, up);
    let pixmap = paint::paint(&surface, &views)?;
    let failed = |error| Error::Internal(format!("the picture cannot be encoded: {error}"));
    encode(&pixmap).map_err(failed)
}

/// An opaque picture as a PNG file's bytes, with a mark of this program.
fn encode(pixmap: &Pixmap) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixmap.width(), pixmap.height());
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.add_text_chunk("Software".into(), "Intrinsym".into())?;
    encoder.write_header()?.write_image_data(pixmap.data())?;
    Ok(bytes)
}
