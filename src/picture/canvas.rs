//! A canvas on which only what is visible costs time: triangles are drawn from front to back, and whole squares of it in which
//! everything drawn is nearer are passed over (N. Greene, M. Kass, G. Miller, "Hierarchical Z-Buffer Visibility", 1993).

use crate::error::{Error, Result};
use tiny_skia::{Color, Pixmap};

/// Pixels along a side of the smallest square.
const TILE: usize = 8;

/// A corner of a triangle to draw.
#[derive(Debug, Clone, Copy)]
pub struct Corner {
    /// Pixels to the right and down, and the distance towards the eye in pixels.
    pub place: [f32; 3],
    /// Right, up and towards the eye.
    pub normal: [f32; 3],
    /// Red, green and blue, 0..=255, in full light.
    pub colour: [f32; 3],
}

/// A picture with the depth of each pixel.
pub struct Canvas {
    /// What was drawn.
    pub pixmap: Pixmap,
    /// Distance of each pixel towards the eye, in pixels.
    depth: Vec<f32>,
    /// For squares of 8, 16, 32, ... pixels the least of their depths.
    levels: Vec<Level>,
    /// Squares and pixels looked at so far.
    looks: u64,
}

/// Squares of one size, row by row.
struct Level {
    columns: usize,
    rows: usize,
    farthest: Vec<f32>,
}

impl Canvas {
    /// White, and endlessly far away.
    ///
    /// # Errors
    /// [`Error::Internal`] if there is no such canvas.
    pub fn new(width: f64, height: f64) -> Result<Canvas> {
        let mut pixmap = Pixmap::new(width as u32, height as u32)
            .ok_or_else(|| Error::Internal(format!("no canvas of {width} x {height} pixels")))?;
        pixmap.fill(Color::WHITE);
        let (width, height) = (pixmap.width() as usize, pixmap.height() as usize);
        let mut levels = vec![Level::new(width.div_ceil(TILE), height.div_ceil(TILE))];
        while let Some(last) = levels.last().filter(|last| last.columns > 1 || last.rows > 1) {
            levels.push(Level::new(last.columns.div_ceil(2), last.rows.div_ceil(2)));
        }
        Ok(Canvas { pixmap, depth: vec![f32::NEG_INFINITY; width * height], levels, looks: 0 })
    }

    /// Draws triangles, each pixel by the nearest, in the light of `brightness` of a normal.
    pub fn draw(&mut self, mut triangles: Vec<[Corner; 3]>, brightness: impl Fn([f32; 3]) -> f32) {
        let nearest = |corners: &[Corner; 3]| {
            corners.iter().map(|corner| corner.place[2]).fold(f32::NEG_INFINITY, f32::max)
        };
        triangles.sort_by(|a, b| nearest(b).total_cmp(&nearest(a)));
        for corners in &triangles {
            if let Some(triangle) = Triangle::new(corners) {
                self.draw_one(&triangle, &brightness);
            }
        }
    }

    /// Whether nothing was drawn in front of a place.
    pub fn is_visible(&self, [x, y, toward]: [f32; 3]) -> bool {
        let (width, height) = (self.pixmap.width() as usize, self.pixmap.height() as usize);
        let (x, y) = ((x.max(0.0) as usize).min(width - 1), (y.max(0.0) as usize).min(height - 1));
        self.depth[y * width + x] <= toward
    }

    fn draw_one(&mut self, triangle: &Triangle, brightness: &impl Fn([f32; 3]) -> f32) {
        let size = |level: usize| (TILE << level) as f32;
        let [low, high] = triangle.bounds;
        let spans = |level: usize| (0..2).all(|k| high[k] - low[k] <= size(level));
        let level = (0..self.levels.len() - 1).find(|&level| spans(level)).unwrap_or(self.levels.len() - 1);
        let index = |value: f32, count: usize| ((value / size(level)).max(0.0) as usize).min(count - 1);
        let (columns, rows) = (self.levels[level].columns, self.levels[level].rows);
        for row in index(low[1], rows)..=index(high[1], rows) {
            for column in index(low[0], columns)..=index(high[0], columns) {
                self.draw_in(level, column, row, triangle, brightness);
                self.update_above(level, column, row);
            }
        }
    }

    /// Draws what of a triangle lies in a square.
    fn draw_in(
        &mut self,
        level: usize,
        column: usize,
        row: usize,
        triangle: &Triangle,
        brightness: &impl Fn([f32; 3]) -> f32,
    ) {
        self.looks += 1;
        let half = (TILE << level) as f32 / 2.0;
        let middle = [(2 * column + 1) as f32 * half, (2 * row + 1) as f32 * half];
        let at = self.levels[level].at(column, row);
        if triangle.nearest(middle, half) <= self.levels[level].farthest[at] || triangle.misses(middle, half)
        {
            return;
        }
        if level == 0 {
            self.draw_pixels(column, row, triangle, brightness);
        } else {
            for (column, row) in self.levels[level - 1].inside(column, row) {
                self.draw_in(level - 1, column, row, triangle, brightness);
            }
            self.update(level, column, row);
        }
    }

    fn draw_pixels(
        &mut self,
        column: usize,
        row: usize,
        triangle: &Triangle,
        brightness: &impl Fn([f32; 3]) -> f32,
    ) {
        let (width, height) = (self.pixmap.width() as usize, self.pixmap.height() as usize);
        let mut farthest = f32::INFINITY;
        for y in row * TILE..((row + 1) * TILE).min(height) {
            for x in column * TILE..((column + 1) * TILE).min(width) {
                self.looks += 1;
                let pixel = y * width + x;
                if let Some((weights, depth)) = triangle.at([x as f32 + 0.5, y as f32 + 0.5])
                    && depth > self.depth[pixel]
                {
                    self.depth[pixel] = depth;
                    let [red, green, blue] = triangle.colour(weights, brightness);
                    self.pixmap.data_mut()[4 * pixel..4 * pixel + 4]
                        .copy_from_slice(&[red, green, blue, 255]);
                }
                farthest = farthest.min(self.depth[pixel]);
            }
        }
        let at = self.levels[0].at(column, row);
        self.levels[0].farthest[at] = farthest;
    }

    /// Makes a square's least depth that of the squares inside it; whether it has changed.
    fn update(&mut self, level: usize, column: usize, row: usize) -> bool {
        let inside = &self.levels[level - 1];
        let depths = inside.inside(column, row).map(|(column, row)| inside.farthest[inside.at(column, row)]);
        let farthest = depths.fold(f32::INFINITY, f32::min);
        let at = self.levels[level].at(column, row);
        std::mem::replace(&mut self.levels[level].farthest[at], farthest) != farthest
    }

    fn update_above(&mut self, level: usize, column: usize, row: usize) {
        for above in level + 1..self.levels.len() {
            let steps = above - level;
            if !self.update(above, column >> steps, row >> steps) {
                break;
            }
        }
    }
}

impl Level {
    fn new(columns: usize, rows: usize) -> Level {
        Level { columns, rows, farthest: vec![f32::NEG_INFINITY; columns * rows] }
    }

    fn at(&self, column: usize, row: usize) -> usize {
        row * self.columns + column
    }

    /// The squares of this level that lie in one of the next.
    fn inside(&self, column: usize, row: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        let all = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| (2 * column + x, 2 * row + y));
        all.into_iter().filter(move |&(column, row)| column < columns && row < rows)
    }
}

/// A function a x + b y + c of the place.
#[derive(Clone, Copy)]
struct Plane([f32; 3]);

impl Plane {
    fn at(&self, [x, y]: [f32; 2]) -> f32 {
        self.0[0] * x + self.0[1] * y + self.0[2]
    }

    /// The largest value in the square round `middle`.
    fn largest(&self, middle: [f32; 2], half: f32) -> f32 {
        self.at(middle) + half * (self.0[0].abs() + self.0[1].abs())
    }
}

/// A triangle of which some pixels may be drawn.
struct Triangle<'a> {
    corners: &'a [Corner; 3],
    /// The weight of each corner.
    weights: [Plane; 3],
    depth: Plane,
    nearest: f32,
    /// Least and largest coordinates.
    bounds: [[f32; 2]; 2],
}

impl<'a> Triangle<'a> {
    /// `None` if it is seen edge-on.
    fn new(corners: &'a [Corner; 3]) -> Option<Triangle<'a>> {
        let [a, b, c] = corners.map(|corner| corner.place);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        // Relative to the first corner, where the numbers are small.
        let weight = |from: [f32; 3], to: [f32; 3]| {
            let (x, y) = ((from[1] - to[1]) / area, (to[0] - from[0]) / area);
            Plane([x, y, -x * from[0] - y * from[1]])
        };
        let weights = [weight(b, c), weight(c, a), weight(a, b)];
        let mixed = |k: usize| (0..3).map(|i| corners[i].place[2] * weights[i].0[k]).sum();
        let depth = Plane(std::array::from_fn(mixed));
        let all = weights.iter().flat_map(|plane| plane.0).chain(depth.0);
        if !all.fold(0.0, |sum: f32, value| sum + value.abs()).is_finite() {
            return None;
        }
        let fold = |k: usize, pick: fn(f32, f32) -> f32| pick(pick(a[k], b[k]), c[k]);
        Some(Triangle {
            corners,
            weights,
            depth,
            nearest: fold(2, f32::max),
            bounds: [[fold(0, f32::min), fold(1, f32::min)], [fold(0, f32::max), fold(1, f32::max)]],
        })
    }

    /// No less than the depth anywhere in the square round `middle`.
    fn nearest(&self, middle: [f32; 2], half: f32) -> f32 {
        self.depth.largest(middle, half).min(self.nearest)
    }

    /// Whether the square round `middle` surely has nothing of it.
    fn misses(&self, middle: [f32; 2], half: f32) -> bool {
        self.weights.iter().any(|weight| weight.largest(middle, half) < 0.0)
    }

    /// The corners' weights and the depth at a place inside.
    fn at(&self, place: [f32; 2]) -> Option<([f32; 3], f32)> {
        let weights = self.weights.map(|weight| weight.at(place));
        weights
            .iter()
            .all(|&weight| weight >= -1e-4)
            .then(|| (weights, self.depth.at(place).min(self.nearest)))
    }

    fn colour(&self, weights: [f32; 3], brightness: &impl Fn([f32; 3]) -> f32) -> [u8; 3] {
        let mix = |of: fn(&Corner) -> [f32; 3]| -> [f32; 3] {
            std::array::from_fn(|k| (0..3).map(|i| weights[i] * of(&self.corners[i])[k]).sum())
        };
        let light = brightness(mix(|corner| corner.normal));
        mix(|corner| corner.colour).map(|value| (value * light).clamp(0.0, 255.0) as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The halves of a square round `middle`, of one colour.
    fn square(middle: [f32; 2], half: f32, toward: f32, colour: f32) -> [[Corner; 3]; 2] {
        let corner = |x: f32, y: f32| Corner {
            place: [middle[0] + half * x, middle[1] + half * y, toward],
            normal: [0.0, 0.0, 1.0],
            colour: [colour; 3],
        };
        let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        [[a, b, c], [a, c, d]]
    }

    fn red(canvas: &Canvas, x: u32, y: u32) -> u8 {
        canvas.pixmap.pixel(x, y).unwrap().red()
    }

    #[test]
    fn the_nearest_is_seen_whatever_the_order() {
        let squares = [(30.0, 0.0, 90.0), (10.0, 5.0, 200.0), (20.0, 2.0, 120.0)];
        for turn in 0..3 {
            let mut canvas = Canvas::new(100.0, 70.0).unwrap();
            let mut ordered = squares;
            ordered.rotate_left(turn);
            let of = |(half, toward, colour)| square([40.0, 35.0], half, toward, colour);
            canvas.draw(ordered.into_iter().flat_map(of).collect(), |_| 1.0);
            assert_eq!([40, 55, 65, 90].map(|x| red(&canvas, x, 35)), [200, 120, 90, 255]);
            assert!(canvas.is_visible([40.0, 35.0, 5.0]) && !canvas.is_visible([40.0, 35.0, 4.0]));
        }
    }

    #[test]
    fn triangles_that_cross_are_seen_in_parts() {
        let mut canvas = Canvas::new(64.0, 64.0).unwrap();
        let mut tilted = square([32.0, 32.0], 30.0, 0.0, 50.0);
        tilted.as_flattened_mut().iter_mut().for_each(|corner| corner.place[2] = corner.place[0] - 32.0);
        canvas.draw([square([32.0, 32.0], 30.0, 0.0, 150.0), tilted].concat(), |_| 1.0);
        assert_eq!([red(&canvas, 10, 20), red(&canvas, 50, 20)], [150, 50]);
    }

    #[test]
    fn squares_behind_squares_cost_next_to_nothing() {
        let looks = |count: usize| {
            let mut canvas = Canvas::new(600.0, 600.0).unwrap();
            let of = |i: usize| square([300.0, 300.0], 290.0 - 0.02 * i as f32, -(i as f32), 100.0);
            canvas.draw((0..count).flat_map(of).collect(), |_| 1.0);
            canvas.looks
        };
        let (one, many) = (looks(1), looks(5000));
        assert!(many < one + 200 * 5000, "{many} looks, {one} at one square");
    }
}
