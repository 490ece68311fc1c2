//! A rigid motion, with reflection or without, fitted to how points are mapped and then to the surface they are mapped to.

use crate::dense::{cholesky_solve, gram_cholesky};
use crate::error::Result;
use crate::mesh::rotation::{
    Matrix, axis_and_angle, nearest_rotation, product, rotation, scaled, transposed, turned,
};
use crate::mesh::vector::{Vector, cross, dot, squared_norm, subtract};
use faer::Mat;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Rounds of the robust fit to the map, and the distance, in sqrt(area), at which an image counts half in it.
const ROBUST_ROUNDS: usize = 3;
const ROBUST: f64 = 0.02;
/// Rounds of the fit to the surface.
const SURFACE_ROUNDS: usize = 5;
/// How far, in sqrt(area), the map is off where the surface leaves a motion open.
const MAP_ERROR: f64 = 0.01;
/// How many of a part's points tell something of their own.
const INDEPENDENT: f64 = 30.0;
/// A point counts half at this many times the distance of interest from the surface.
const OUTLIER: f64 = 2.5;

/// A point of the surface with its unit normal.
#[derive(Clone, Copy)]
pub(super) struct Oriented {
    pub position: Vector,
    pub normal: Vector,
}

/// A point of a part and its image under the map.
pub(super) struct Place {
    pub own: Oriented,
    pub image: Vector,
    /// A vertex near the image.
    pub partner: u32,
    pub weight: f64,
}

/// `x -> turn x + shift`.
#[derive(Clone, Copy)]
pub(super) struct Motion {
    pub turn: Matrix,
    pub shift: Vector,
}

/// A motion fitted to the surface, and what is left.
pub(super) struct Fit {
    /// The motion fitted to the map.
    pub start: Motion,
    /// The motion fitted to the surface.
    pub motion: Motion,
    /// Root mean square distance of the points from the surface, in sqrt(area).
    pub left: f64,
}

impl Motion {
    /// The motion nearest to what the map does; images far from it count little.
    pub fn between(places: &[Place], mirrored: bool) -> Motion {
        let mut weights: Vec<f64> = places.iter().map(|place| place.weight).collect();
        let mut motion = Motion::nearest(places, &weights, mirrored);
        for _ in 1..ROBUST_ROUNDS {
            for (weight, place) in weights.iter_mut().zip(places) {
                let off = squared_norm(subtract(motion.of(place.own.position), place.image));
                *weight = place.weight / (1.0 + off / (ROBUST * ROBUST));
            }
            motion = Motion::nearest(places, &weights, mirrored);
        }
        motion
    }

    fn nearest(places: &[Place], weights: &[f64], mirrored: bool) -> Motion {
        let middle = mean(places.iter().map(|place| place.own.position), weights);
        let image_middle = mean(places.iter().map(|place| place.image), weights);
        let mut covariance = Matrix::default();
        for (place, weight) in places.iter().zip(weights) {
            let (from, to) = (subtract(place.own.position, middle), subtract(place.image, image_middle));
            for row in 0..3 {
                (0..3).for_each(|column| covariance[row][column] += weight * to[row] * from[column]);
            }
        }
        let sign = if mirrored { -1.0 } else { 1.0 };
        let turn = scaled(nearest_rotation(&scaled(covariance, sign)), sign);
        Motion { turn, shift: subtract(image_middle, turned(&turn, middle)) }
    }

    /// Where a point goes.
    pub fn of(&self, position: Vector) -> Vector {
        let turned = turned(&self.turn, position);
        std::array::from_fn(|axis| turned[axis] + self.shift[axis])
    }

    /// Where a point of the surface goes, and its normal.
    pub fn of_oriented(&self, own: Oriented) -> Oriented {
        Oriented { position: self.of(own.position), normal: turned(&self.turn, own.normal) }
    }

    /// Fits the motion to the surface, of which `alike` gives the vertex most like a point, sought from another vertex.
    /// `noise` is how far the surface may be off.
    pub fn onto(
        self,
        places: &[Place],
        radius: f64,
        noise: f64,
        alike: impl Fn(Oriented, u32) -> (u32, Oriented),
    ) -> Result<Fit> {
        let mut motion = self;
        let mut near: Vec<u32> = places.iter().map(|place| place.partner).collect();
        let step = Approach { lever: radius, noise, held: MAP_ERROR };
        for _ in 0..SURFACE_ROUNDS {
            motion = motion.towards(&self, places, &mut near, step, &alike)?;
        }
        let (mut squares, mut weights) = (0.0, 0.0);
        for (place, near) in places.iter().zip(near) {
            let goal = motion.of_oriented(place.own);
            let gap = gap(goal.position, alike(goal, near).1);
            squares += place.weight * gap * gap;
            weights += place.weight;
        }
        Ok(Fit { start: self, motion, left: (squares / weights).sqrt() })
    }

    /// Brings the motion to the surface wherever that leads, held back only in each step. `near` are vertices to seek from.
    pub fn settled(
        mut self,
        places: &[Place],
        near: &mut [u32],
        rounds: usize,
        step: Approach,
        alike: impl Fn(Oriented, u32) -> (u32, Oriented),
    ) -> Result<Motion> {
        for _ in 0..rounds {
            let start = self;
            self = self.towards(&start, places, near, step, &alike)?;
        }
        Ok(self)
    }

    /// First this motion, then a rotation about a point.
    pub fn then_turned(&self, rotation: &Matrix, about: Vector) -> Motion {
        let shift = turned(rotation, subtract(self.shift, about));
        Motion {
            turn: product(rotation, &self.turn),
            shift: std::array::from_fn(|axis| shift[axis] + about[axis]),
        }
    }

    /// The motion a share of the way from this one to `other`: turned by that share of the angle between them about where
    /// this one puts `middle`, and shifted by that share of how far apart they put it. About `along` the angle is -90 to 270
    /// degrees, so that motions side by side turn the same way.
    pub fn part_way(&self, other: &Motion, share: f64, middle: Vector, along: Vector) -> Motion {
        let between = product(&other.turn, &transposed(&self.turn));
        let (axis, angle) = axis_and_angle(&between);
        let (axis, angle) = if dot(axis, along) < 0.0 { (axis.map(|x| -x), -angle) } else { (axis, angle) };
        let angle = if angle < -FRAC_PI_2 { angle + TAU } else { angle };
        let (here, there) = (self.of(middle), other.of(middle));
        let mut way = self.then_turned(&rotation(axis, share * angle), here);
        (0..3).for_each(|k| way.shift[k] += share * (there[k] - here[k]));
        way
    }

    /// The angle of the turn from this motion to `other`, 0 to pi.
    pub fn angle_to(&self, other: &Motion) -> f64 {
        axis_and_angle(&product(&other.turn, &transposed(&self.turn))).1
    }

    /// The axis of the turn from this motion to `other`.
    pub fn axis_to(&self, other: &Motion) -> Vector {
        axis_and_angle(&product(&other.turn, &transposed(&self.turn))).0
    }

    /// One Gauss-Newton step to the tangent planes of the vertices most like the points, held back towards `start`.
    fn towards(
        &self,
        start: &Motion,
        places: &[Place],
        near: &mut [u32],
        Approach { lever, noise, held }: Approach,
        alike: impl Fn(Oriented, u32) -> (u32, Oriented),
    ) -> Result<Motion> {
        let all: f64 = places.iter().map(|place| place.weight).sum();
        let weights: Vec<f64> = places.iter().map(|place| place.weight).collect();
        let middle = mean(places.iter().map(|place| self.of(place.own.position)), &weights);
        let mut normal_equations = Step::default();
        for (place, near) in places.iter().zip(near) {
            let goal = self.of_oriented(place.own);
            let (vertex, there) = alike(goal, *near);
            *near = vertex;
            let offset = subtract(goal.position, middle).map(|x| x / lever);
            let gap = gap(goal.position, there);
            let facing = dot(there.normal, goal.normal).clamp(0.0, 1.0);
            let outlier = gap / (OUTLIER * noise);
            let weight = INDEPENDENT / all * place.weight * facing / (1.0 + outlier * outlier);
            normal_equations.add(offset, there.normal, gap, weight / (noise * noise));
            let strayed = subtract(goal.position, start.of(place.own.position));
            normal_equations.hold(offset, strayed, place.weight / all / (held * held));
        }
        let [turn, shift] = normal_equations.solve()?;
        let [x, y, z] = turn.map(|angle| angle / lever);
        let turn = nearest_rotation(&[[1.0, -z, y], [z, 1.0, -x], [-y, x, 1.0]]);
        let from_middle = turned(&turn, subtract(self.shift, middle));
        Ok(Motion {
            turn: product(&turn, &self.turn),
            shift: std::array::from_fn(|axis| from_middle[axis] + middle[axis] + shift[axis]),
        })
    }
}

/// How a motion is brought to the surface.
#[derive(Clone, Copy)]
pub(super) struct Approach {
    /// What a turn of one radian counts as, a distance in sqrt(area).
    pub lever: f64,
    /// How far the surface may be off, in sqrt(area).
    pub noise: f64,
    /// How far, in sqrt(area), the motion may go where the surface leaves it open.
    pub held: f64,
}

/// Normal equations of a small turn about the middle, in units of the lever, and a shift.
#[derive(Default)]
struct Step {
    matrix: [[f64; 6]; 6],
    right: [f64; 6],
}

impl Step {
    /// A point at `offset` from the middle should move along `direction` by `-gap`.
    fn add(&mut self, offset: Vector, direction: Vector, gap: f64, weight: f64) {
        let ([a, b, c], [d, e, f]) = (cross(offset, direction), direction);
        let row = [a, b, c, d, e, f];
        for i in 0..6 {
            self.right[i] -= weight * gap * row[i];
            (0..6).for_each(|j| self.matrix[i][j] += weight * row[i] * row[j]);
        }
    }

    /// A point at `offset` from the middle should move by `-gap`: [`Step::add`] along all three axes.
    fn hold(&mut self, offset: Vector, gap: Vector, weight: f64) {
        let ([x, y, z], torque) = (offset, cross(offset, gap));
        let square = squared_norm(offset);
        for i in 0..3 {
            self.right[i] -= weight * torque[i];
            self.right[3 + i] -= weight * gap[i];
            self.matrix[i][i] += weight * square;
            self.matrix[3 + i][3 + i] += weight;
            (0..3).for_each(|j| self.matrix[i][j] -= weight * offset[i] * offset[j]);
        }
        let across = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
        for (i, row) in across.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                self.matrix[i][3 + j] += weight * value;
                self.matrix[3 + j][i] += weight * value;
            }
        }
    }

    /// The turn and the shift.
    fn solve(&self) -> Result<[Vector; 2]> {
        let lower = gram_cholesky(Mat::from_fn(6, 6, |i, j| self.matrix[i][j]).as_ref())?;
        let mut step = Mat::from_fn(6, 1, |i, _| self.right[i]);
        cholesky_solve(lower.as_ref(), step.as_mut());
        Ok([0, 3].map(|first| std::array::from_fn(|axis| step[(first + axis, 0)])))
    }
}

/// How far a position is above the tangent plane of a point.
fn gap(position: Vector, there: Oriented) -> f64 {
    dot(there.normal, subtract(position, there.position))
}

pub(super) fn mean(positions: impl Iterator<Item = Vector>, weights: &[f64]) -> Vector {
    let mut sum = [0.0; 3];
    for (position, weight) in positions.zip(weights) {
        (0..3).for_each(|axis| sum[axis] += weight * position[axis]);
    }
    let all: f64 = weights.iter().sum();
    sum.map(|x| x / all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Vector, b: Vector) -> bool {
        squared_norm(subtract(a, b)) < 1e-20
    }

    /// Mirrors in x.
    fn mirror() -> Motion {
        Motion { turn: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], shift: [0.1, 0.0, 0.3] }
    }

    #[test]
    fn a_point_is_held_as_along_its_three_axes() {
        let (offset, gap) = ([0.3, -0.7, 1.1], [0.2, 0.5, -0.4]);
        let (mut at_once, mut by_axis) = (Step::default(), Step::default());
        at_once.hold(offset, gap, 1.7);
        for axis in 0..3 {
            let along = std::array::from_fn(|k| f64::from(u8::from(k == axis)));
            by_axis.add(offset, along, gap[axis], 1.7);
        }
        let same = |a: &[f64; 6], b: &[f64; 6]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(same(&at_once.right, &by_axis.right));
        assert!(at_once.matrix.iter().zip(&by_axis.matrix).all(|(a, b)| same(a, b)));
    }

    #[test]
    fn a_motion_turned_about_a_point_keeps_it() {
        let about = mirror().of([0.4, -0.2, 0.7]);
        let then = mirror().then_turned(&rotation([0.0, 0.0, 1.0], 1.2), about);
        assert!(near(then.of([0.4, -0.2, 0.7]), about));
        assert!((mirror().angle_to(&then) - 1.2).abs() < 1e-12);
    }

    #[test]
    fn part_of_the_way_turns_by_part_of_the_angle_and_the_way_asked_for() {
        let middle = [0.2, 0.5, -0.3];
        let mut other = mirror().then_turned(&rotation([0.0, 0.0, 1.0], 2.8), mirror().of(middle));
        other.shift[2] += 0.4;
        for along in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]] {
            let way = |share| mirror().part_way(&other, share, middle, along);
            assert!(near(way(0.0).of([1.0, 2.0, 3.0]), mirror().of([1.0, 2.0, 3.0])));
            assert!(near(way(1.0).of([1.0, 2.0, 3.0]), other.of([1.0, 2.0, 3.0])));
            let half = way(0.5);
            assert!((half.of(middle)[2] - mirror().of(middle)[2] - 0.2).abs() < 1e-12);
            // 2.8 radians against the axis are 2 pi - 2.8 along it.
            let expected = if along[2] > 0.0 { 1.4 } else { FRAC_PI_2 * 2.0 - 1.4 };
            assert!((mirror().angle_to(&half) - expected).abs() < 1e-12, "{}", mirror().angle_to(&half));
        }
    }
}
