//! Two panels side by side, drawn at twice the size and reduced.

use super::canvas::Canvas;
use super::facets::{self, Placement, Surface, brightness};
use super::view::View;
use intrinsym::Result;
use tiny_skia::{FilterQuality, LineCap, Paint, PathBuilder, Pixmap, PixmapPaint, Stroke, Transform};

/// Largest width of one panel and height of the picture, in pixels.
const PANEL: [f64; 2] = [900.0, 1000.0];
/// Free space round each view, in pixels.
const MARGIN: f64 = 24.0;
/// Drawn this many times larger, then reduced: smooth edges without seams between triangles.
const OVERSAMPLING: f64 = 2.0;
/// Width of the fixed curve, in pixels of the finished picture.
const CURVE_WIDTH: f64 = 3.2;

/// Paints the surface in both views at one scale.
pub fn paint(surface: &Surface, views: &[View; 2]) -> Result<Pixmap> {
    let frames = views.map(|view| Frame::around(surface.outline(&view)));
    let width = frames[0].size[0].max(frames[1].size[0]).max(f64::MIN_POSITIVE);
    let height = frames[0].size[1].max(frames[1].size[1]).max(f64::MIN_POSITIVE);
    let free = [PANEL[0] - 2.0 * MARGIN, PANEL[1] - 2.0 * MARGIN];
    let scale = (free[0] / width).min(free[1] / height);
    let panel =
        [width * scale + 2.0 * MARGIN, height * scale + 2.0 * MARGIN].map(|side| side.ceil().max(64.0));
    let mut large = Canvas::new(2.0 * panel[0] * OVERSAMPLING, panel[1] * OVERSAMPLING)?;
    for (index, (view, frame)) in views.iter().zip(&frames).enumerate() {
        let centre = [panel[0] * (index as f64 + 0.5), panel[1] / 2.0].map(|pixel| pixel * OVERSAMPLING);
        let scale = scale * OVERSAMPLING;
        let origin = [centre[0] - scale * frame.centre[0], centre[1] + scale * frame.centre[1]];
        let (triangles, strokes) = surface.seen(view, &Placement { scale, origin });
        large.draw(&triangles, brightness);
        draw_curve(&strokes, &mut large);
    }
    reduce(&large.pixmap, 2.0 * panel[0], panel[1])
}

/// The rectangle that holds a view.
struct Frame {
    centre: [f64; 2],
    size: [f64; 2],
}

impl Frame {
    fn around(places: impl Iterator<Item = [f64; 2]>) -> Frame {
        let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for place in places {
            low = std::array::from_fn(|k| low[k].min(place[k]));
            high = std::array::from_fn(|k| high[k].max(place[k]));
        }
        Frame {
            centre: std::array::from_fn(|k| (low[k] + high[k]) / 2.0),
            size: std::array::from_fn(|k| high[k] - low[k]),
        }
    }
}

/// Draws the parts of the fixed curve that nothing hides.
fn draw_curve(strokes: &[facets::Stroke], canvas: &mut Canvas) {
    let mut ink = Paint::default();
    ink.set_color_rgba8(20, 20, 24, 255);
    let width = (CURVE_WIDTH * OVERSAMPLING) as f32;
    let pen = Stroke { width, line_cap: LineCap::Round, ..Stroke::default() };
    for stroke in strokes {
        let [[x, y], [to_x, to_y]] = stroke.ends;
        let mut line = PathBuilder::new();
        line.move_to(x, y);
        line.line_to(to_x, to_y);
        if let Some(path) = line.finish().filter(|_| canvas.is_visible(stroke.middle)) {
            canvas.pixmap.stroke_path(&path, &ink, &pen, Transform::identity(), None);
        }
    }
}

fn reduce(large: &Pixmap, width: f64, height: f64) -> Result<Pixmap> {
    let mut small = Canvas::new(width, height)?.pixmap;
    let paint = PixmapPaint { quality: FilterQuality::Bilinear, ..PixmapPaint::default() };
    let factor = (1.0 / OVERSAMPLING) as f32;
    small.draw_pixmap(0, 0, large.as_ref(), &paint, Transform::from_scale(factor, factor), None);
    Ok(small)
}
