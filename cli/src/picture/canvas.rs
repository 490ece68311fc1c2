//! A canvas on which only what is visible costs time: a square of it is divided, and of each part is forgotten what lies behind a
//! triangle that covers the part (J. E. Warnock, "A hidden surface algorithm for computer generated halftone pictures", 1969).

use intrinsym::{Error, Result};
use tiny_skia::{Color, Pixmap};

/// Pixels along a side of the smallest square.
const TILE: usize = 2;
/// Pixels along a side of the largest square, and most triangles in it, of which each pixel is looked at at once.
const SMALL: usize = 16;
const FEW: usize = 3;
/// Weights no less than this below 0 count as inside, so that no gap shows between neighbours.
const INSIDE: f32 = 1e-4;
/// Pixels by which one of two surfaces must be farther away to be seen behind the other: they may be the same one.
const APART: f32 = 0.01;

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
    /// Triangles looked at so far in squares and at pixels.
    looks: u64,
}

/// A part of the canvas: its first column and row, and pixels along its sides.
#[derive(Clone, Copy)]
struct Square {
    column: usize,
    row: usize,
    size: usize,
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
        let pixels = pixmap.width() as usize * pixmap.height() as usize;
        Ok(Canvas { pixmap, depth: vec![f32::NEG_INFINITY; pixels], looks: 0 })
    }

    /// Draws triangles, each pixel by the nearest, in the light of `brightness` of a normal.
    pub fn draw(&mut self, triangles: &[[Corner; 3]], brightness: impl Fn([f32; 3]) -> f32) {
        let size = (self.pixmap.width().max(self.pixmap.height()) as usize).next_power_of_two().max(TILE);
        let triangles: Vec<Triangle> = triangles.iter().filter_map(Triangle::new).collect();
        self.draw_in(Square { column: 0, row: 0, size }, triangles.iter().collect(), &brightness);
    }

    /// Whether nothing was drawn in front of a place.
    pub fn is_visible(&self, [x, y, toward]: [f32; 3]) -> bool {
        let (width, height) = self.size();
        let (x, y) = ((x.max(0.0) as usize).min(width - 1), (y.max(0.0) as usize).min(height - 1));
        self.depth[y * width + x] <= toward
    }

    fn size(&self) -> (usize, usize) {
        (self.pixmap.width() as usize, self.pixmap.height() as usize)
    }

    /// Draws what of some triangles is visible in a square.
    fn draw_in(
        &mut self,
        square: Square,
        mut triangles: Vec<&Triangle>,
        brightness: &impl Fn([f32; 3]) -> f32,
    ) {
        let (width, height) = self.size();
        if square.column >= width || square.row >= height {
            return;
        }
        self.looks += triangles.len() as u64;
        let (middle, half) = square.middle();
        triangles.retain(|triangle| !triangle.misses(middle, half));
        let covering = triangles.iter().filter(|triangle| triangle.covers(middle, half)).copied();
        let nearest = covering.max_by(|a, b| a.depth.at(middle).total_cmp(&b.depth.at(middle)));
        if let Some(nearest) = nearest {
            let is_it = |triangle: &Triangle| std::ptr::eq(triangle, nearest);
            triangles.retain(|triangle| is_it(triangle) || !triangle.is_behind(nearest, middle, half));
        }
        if square.size == TILE || square.size <= SMALL && triangles.len() <= FEW {
            triangles.iter().for_each(|triangle| self.draw_pixels(square, triangle, brightness));
        } else if !triangles.is_empty() {
            square.quarters().into_iter().for_each(|part| self.draw_in(part, triangles.clone(), brightness));
        }
    }

    fn draw_pixels(&mut self, square: Square, triangle: &Triangle, brightness: &impl Fn([f32; 3]) -> f32) {
        let (width, height) = self.size();
        for y in square.row..(square.row + square.size).min(height) {
            for x in square.column..(square.column + square.size).min(width) {
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
            }
        }
    }
}

impl Square {
    /// Its middle, and half the length of its sides.
    fn middle(self) -> ([f32; 2], f32) {
        let half = self.size as f32 / 2.0;
        ([self.column as f32 + half, self.row as f32 + half], half)
    }

    fn quarters(self) -> [Square; 4] {
        let size = self.size / 2;
        [(0, 0), (size, 0), (0, size), (size, size)].map(|(right, down)| Square {
            column: self.column + right,
            row: self.row + down,
            size,
        })
    }
}

/// A function a x + b y + c of the place.
#[derive(Clone, Copy)]
struct Plane([f32; 3]);

impl Plane {
    fn at(&self, [x, y]: [f32; 2]) -> f32 {
        self.0[0] * x + self.0[1] * y + self.0[2]
    }

    /// How much its values in the square round a place differ from that in the middle at most.
    fn variation(&self, half: f32) -> f32 {
        half * (self.0[0].abs() + self.0[1].abs())
    }
}

/// A triangle of which some pixels may be drawn.
struct Triangle<'a> {
    corners: &'a [Corner; 3],
    /// The weight of each corner.
    weights: [Plane; 3],
    depth: Plane,
    /// Depth of the nearest corner.
    nearest: f32,
}

impl<'a> Triangle<'a> {
    /// `None` if it is seen edge-on, or lies between the middles of pixels.
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
        let is_between = |k: usize| (fold(k, f32::min) - 0.51).ceil() > (fold(k, f32::max) - 0.49).floor();
        let nearest = fold(2, f32::max);
        (!is_between(0) && !is_between(1)).then_some(Triangle { corners, weights, depth, nearest })
    }

    /// Whether the square round `middle` surely has nothing of it.
    fn misses(&self, middle: [f32; 2], half: f32) -> bool {
        self.weights.iter().any(|weight| weight.at(middle) + weight.variation(half) < -INSIDE)
    }

    /// Whether it fills the square round `middle`.
    fn covers(&self, middle: [f32; 2], half: f32) -> bool {
        self.weights.iter().all(|weight| weight.at(middle) - weight.variation(half) >= 0.0)
    }

    /// Whether its plane is behind that of another one in the whole square round `middle`.
    fn is_behind(&self, other: &Triangle, middle: [f32; 2], half: f32) -> bool {
        let ahead = Plane(std::array::from_fn(|k| other.depth.0[k] - self.depth.0[k]));
        let distance = other.depth.at(middle) - self.depth.at(middle);
        distance - ahead.variation(half) >= -APART
    }

    /// The corners' weights and the depth at a place inside.
    fn at(&self, place: [f32; 2]) -> Option<([f32; 3], f32)> {
        let weights = self.weights.map(|weight| weight.at(place));
        weights
            .iter()
            .all(|&weight| weight >= -INSIDE)
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
            canvas.draw(&ordered.into_iter().flat_map(of).collect::<Vec<_>>(), |_| 1.0);
            assert_eq!([40, 55, 65, 90].map(|x| red(&canvas, x, 35)), [200, 120, 90, 255]);
            assert!(canvas.is_visible([40.0, 35.0, 5.0]) && !canvas.is_visible([40.0, 35.0, 4.0]));
        }
    }

    #[test]
    fn triangles_that_cross_are_seen_in_parts() {
        let mut canvas = Canvas::new(64.0, 64.0).unwrap();
        let mut tilted = square([32.0, 32.0], 30.0, 0.0, 50.0);
        tilted.as_flattened_mut().iter_mut().for_each(|corner| corner.place[2] = corner.place[0] - 32.0);
        canvas.draw(&[square([32.0, 32.0], 30.0, 0.0, 150.0), tilted].concat(), |_| 1.0);
        assert_eq!([red(&canvas, 10, 20), red(&canvas, 50, 20)], [150, 50]);
    }

    /// Tilted, so that the larger ones behind have the nearest corners.
    #[test]
    fn squares_behind_squares_cost_a_tenth_of_what_drawing_them_would() {
        let looks = |count: usize| {
            let mut canvas = Canvas::new(600.0, 600.0).unwrap();
            let of = |i: usize| {
                let mut square = square([300.0, 300.0], 290.0 - 0.02 * (count - i) as f32, 0.0, 100.0);
                let corners = square.as_flattened_mut().iter_mut();
                corners.for_each(|corner| corner.place[2] = corner.place[0] - 0.03 * i as f32);
                square
            };
            canvas.draw(&(0..count).flat_map(of).collect::<Vec<_>>(), |_| 1.0);
            canvas.looks
        };
        let (one, many) = (looks(1), looks(5000));
        // Were all drawn, they would cost 5000 times as much as one.
        assert!(many < 500 * one, "{many} looks, {one} at one square");
    }
}
