//! A rigid motion, with reflection or without, fitted to how points are mapped and then to the surface they are mapped to.

use crate::mesh::rotation::{
    Matrix, axis_and_angle, nearest_rotation, product, rotation, scaled, transposed, turned,
};
use crate::mesh::vector::{Vector, cross, dot, squared_norm, subtract};

/// Rounds of the robust fit to the map, and the distance, in sqrt(area), at which an image counts half in it.
const ROBUST_ROUNDS: usize = 3;
const ROBUST: f64 = 0.02;
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
#[derive(Clone, Copy)]
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

/// How a motion is brought to the surface.
#[derive(Clone, Copy)]
pub(super) struct Approach {
    pub rounds: usize,
    /// How far the surface may be off, in sqrt(area).
    pub noise: f64,
    /// How far, in sqrt(area), the motion may go where the surface leaves it open.
    pub held: f64,
    /// Whether it may go so far in each round, not in all.
    pub free: bool,
}

impl Place {
    /// A place that has no normal, and where it goes.
    pub fn unoriented(position: Vector, image: Vector, weight: f64) -> Place {
        Place { own: Oriented { position, normal: [0.0; 3] }, image, partner: 0, weight }
    }
}

impl Motion {
    /// The motion nearest to what the map does; images far from it count little.
    pub fn between(places: &[Place], mirrored: bool) -> Motion {
        let mut motion = Motion::nearest(places, mirrored, |place| place.weight);
        for _ in 1..ROBUST_ROUNDS {
            let last = motion;
            motion = Motion::nearest(places, mirrored, |place| {
                let off = squared_norm(subtract(last.of(place.own.position), place.image));
                place.weight / (1.0 + off / (ROBUST * ROBUST))
            });
        }
        motion
    }

    /// The motion nearest to what the map does, each place by a `weight`.
    pub fn nearest(places: &[Place], mirrored: bool, weight: impl Fn(&Place) -> f64) -> Motion {
        let (mut from, mut to, mut all) = ([0.0; 3], [0.0; 3], 0.0);
        let mut products = Matrix::default();
        for place in places {
            let (weight, own, image) = (weight(place), place.own.position, place.image);
            all += weight;
            for row in 0..3 {
                from[row] += weight * own[row];
                to[row] += weight * image[row];
                (0..3).for_each(|column| products[row][column] += weight * image[row] * own[column]);
            }
        }
        let sign = if mirrored { -1.0 } else { 1.0 };
        let entry = |row: usize, column: usize| sign * (products[row][column] - to[row] * from[column] / all);
        let covariance = std::array::from_fn(|row| std::array::from_fn(|column| entry(row, column)));
        let turn = scaled(nearest_rotation(&covariance), sign);
        let from = turned(&turn, from);
        Motion { turn, shift: [0, 1, 2].map(|axis| (to[axis] - from[axis]) / all) }
    }

    /// The motion back.
    pub fn inverse(&self) -> Motion {
        let turn = transposed(&self.turn);
        Motion { turn, shift: turned(&turn, self.shift).map(|x| -x) }
    }

    /// The same in a unit so many times as small.
    pub fn scaled(&self, factor: f64) -> Motion {
        Motion { shift: self.shift.map(|x| factor * x), ..*self }
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

    /// Brings the motion to the surface, which is `nearest` to where it puts each place.
    pub fn settled(
        self,
        places: &[Place],
        nearest: &mut dyn FnMut(usize, Oriented) -> Oriented,
        Approach { rounds, noise, held, free }: Approach,
    ) -> Motion {
        let (spread, mut motion, mut start) = (Spread::of(places), self, self);
        for _ in 0..rounds {
            motion = motion.towards(&start, places, &spread, nearest, [noise, held]);
            if free {
                start = motion;
            }
        }
        motion
    }

    /// Root mean square distance of the places from the tangent planes of the surface `nearest` to them, in sqrt(area); none counts as more
    /// than [`ROBUST`].
    pub fn left(&self, places: &[Place], nearest: &mut dyn FnMut(usize, Oriented) -> Oriented) -> f64 {
        let (mut squares, mut weights) = (0.0, 0.0);
        for (index, place) in places.iter().enumerate() {
            let goal = self.of_oriented(place.own);
            let gap = gap(goal.position, nearest(index, goal)).abs().min(ROBUST);
            squares += place.weight * gap * gap;
            weights += place.weight;
        }
        (squares / weights).sqrt()
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
    /// this one puts `middle`, and shifted by that share of how far apart they put it.
    pub fn part_way(&self, other: &Motion, share: f64, middle: Vector) -> Motion {
        let (axis, angle) = self.turn_to(other);
        let (here, there) = (self.of(middle), other.of(middle));
        let mut way = self.then_turned(&rotation(axis, share * angle), here);
        (0..3).for_each(|k| way.shift[k] += share * (there[k] - here[k]));
        way
    }

    /// Axis and angle, 0 to pi, of the turn from this motion to `other`.
    pub fn turn_to(&self, other: &Motion) -> (Vector, f64) {
        axis_and_angle(&product(&other.turn, &transposed(&self.turn)))
    }

    /// One Gauss-Newton step to the tangent planes of the surface `nearest` to the places, held back towards `start`.
    fn towards(
        &self,
        start: &Motion,
        places: &[Place],
        spread: &Spread,
        nearest: &mut dyn FnMut(usize, Oriented) -> Oriented,
        [noise, held]: [f64; 2],
    ) -> Motion {
        let about = self.of(spread.middle);
        let mut step = Step::default();
        for (index, place) in places.iter().enumerate() {
            let goal = self.of_oriented(place.own);
            let there = nearest(index, goal);
            let (offset, gap) = (subtract(goal.position, about), gap(goal.position, there));
            let facing = dot(there.normal, goal.normal).clamp(0.0, 1.0);
            let outlier = gap / (OUTLIER * noise);
            let weight = INDEPENDENT / spread.weight * place.weight * facing / (1.0 + outlier * outlier);
            step.add(offset, there.normal, gap, weight / (noise * noise));
        }
        step.hold(self, start, spread, 1.0 / (held * held));
        let [turn, shift] = step.solve();
        // The rotation nearest to 1 + [turn]x is about the turn.
        let angle = squared_norm(turn).sqrt();
        let mut motion = match angle > 0.0 {
            true => self.then_turned(&rotation(turn, angle.atan()), about),
            false => *self,
        };
        (0..3).for_each(|axis| motion.shift[axis] += shift[axis]);
        motion
    }
}

/// How some places lie: their weight in all, weighted mean, and second moments about it.
pub(super) struct Spread {
    weight: f64,
    pub middle: Vector,
    pub moments: Matrix,
}

impl Spread {
    pub fn of(places: &[Place]) -> Spread {
        let own = || places.iter().map(|place| (place.own.position, place.weight));
        let (weight, middle) = (own().map(|(_, weight)| weight).sum(), mean(own()));
        let mut moments = Matrix::default();
        for (position, share) in own() {
            let offset = subtract(position, middle);
            for row in 0..3 {
                (0..3)
                    .for_each(|column| moments[row][column] += share / weight * offset[row] * offset[column]);
            }
        }
        Spread { weight, middle, moments }
    }
}

/// Normal equations of a small turn about the middle, and a shift: their lower triangle.
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
            let weighted = weight * row[i];
            self.right[i] -= weighted * gap;
            (0..6).for_each(|j| self.matrix[i][j] += weighted * row[j]);
        }
    }

    /// All places should move from where `motion` puts them to where `start` does.
    fn hold(&mut self, motion: &Motion, start: &Motion, spread: &Spread, weight: f64) {
        let moments =
            |other: &Motion| product(&product(&motion.turn, &spread.moments), &transposed(&other.turn));
        let (own, apart) = (moments(motion), moments(start));
        let strayed = subtract(motion.of(spread.middle), start.of(spread.middle));
        let square = own[0][0] + own[1][1] + own[2][2];
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            self.right[i] += weight * (apart[j][k] - apart[k][j]);
            self.right[3 + i] -= weight * strayed[i];
            (0..3).for_each(|j| self.matrix[i][j] -= weight * own[i][j]);
            self.matrix[i][i] += weight * square;
            self.matrix[3 + i][3 + i] += weight;
        }
    }

    /// The turn and the shift, by Cholesky factorisation. What nothing holds stays 0.
    fn solve(mut self) -> [Vector; 2] {
        for i in 0..6 {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| self.matrix[i][k] * self.matrix[j][k]).sum();
                let rest = self.matrix[i][j] - known;
                self.matrix[i][j] = match i == j {
                    true if rest > 1e-14 * self.matrix[i][i] => rest.sqrt(),
                    true => f64::INFINITY,
                    false => rest / self.matrix[j][j],
                };
            }
            let known: f64 = (0..i).map(|k| self.matrix[i][k] * self.right[k]).sum();
            self.right[i] = (self.right[i] - known) / self.matrix[i][i];
        }
        for i in (0..6).rev() {
            let known: f64 = (i + 1..6).map(|k| self.matrix[k][i] * self.right[k]).sum();
            self.right[i] = (self.right[i] - known) / self.matrix[i][i];
        }
        let [a, b, c, d, e, f] = self.right;
        [[a, b, c], [d, e, f]]
    }
}

/// How far a position is above the tangent plane of a point.
fn gap(position: Vector, there: Oriented) -> f64 {
    dot(there.normal, subtract(position, there.position))
}

/// The mean of some positions with their weights.
pub(super) fn mean(positions: impl Iterator<Item = (Vector, f64)>) -> Vector {
    let (mut sum, mut all) = ([0.0; 3], 0.0);
    for (position, weight) in positions {
        (0..3).for_each(|axis| sum[axis] += weight * position[axis]);
        all += weight;
    }
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

    fn places(own: &[Vector]) -> Vec<Place> {
        let place = |&position: &Vector| Place {
            own: Oriented { position, normal: [0.0, 0.0, 1.0] },
            image: position,
            partner: 0,
            weight: 2.0,
        };
        own.iter().map(place).collect()
    }

    #[test]
    fn places_are_held_as_each_along_its_three_axes() {
        let own = [[1.0, 0.0, 0.2], [0.0, 1.0, -0.4], [0.3, 0.3, 1.0], [-0.6, 0.2, 0.1]];
        let (start, places) = (mirror(), places(&own));
        let motion = start.then_turned(&rotation([0.3, -0.2, 0.7], 0.4), [0.1, 0.5, 0.2]);
        let (mut at_once, mut by_axis) = (Step::default(), Step::default());
        let spread = Spread::of(&places);
        at_once.hold(&motion, &start, &spread, 1.7);
        let middle = motion.of(spread.middle);
        for place in own {
            let (offset, gap) =
                (subtract(motion.of(place), middle), subtract(motion.of(place), start.of(place)));
            for axis in 0..3 {
                let along = std::array::from_fn(|k| f64::from(u8::from(k == axis)));
                by_axis.add(offset, along, gap[axis], 1.7 / 4.0);
            }
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
        assert!((mirror().turn_to(&then).1 - 1.2).abs() < 1e-12);
    }

    #[test]
    fn part_of_the_way_turns_by_part_of_the_angle() {
        let middle = [0.2, 0.5, -0.3];
        let mut other = mirror().then_turned(&rotation([0.0, 0.0, 1.0], 2.8), mirror().of(middle));
        other.shift[2] += 0.4;
        let way = |share| mirror().part_way(&other, share, middle);
        assert!(near(way(0.0).of([1.0, 2.0, 3.0]), mirror().of([1.0, 2.0, 3.0])));
        assert!(near(way(1.0).of([1.0, 2.0, 3.0]), other.of([1.0, 2.0, 3.0])));
        let half = way(0.5);
        assert!((half.of(middle)[2] - mirror().of(middle)[2] - 0.2).abs() < 1e-12);
        assert!((mirror().turn_to(&half).1 - 1.4).abs() < 1e-12, "{}", mirror().turn_to(&half).1);
    }

    #[test]
    fn a_step_solves_its_equations_and_stays_where_nothing_holds_it() {
        let (mut step, turn, shift) = (Step::default(), [0.1, -0.2, 0.05], [0.3, 0.1, -0.7]);
        for offset in [[1.0, 0.0, 0.2], [0.0, 1.0, -0.4], [0.3, 0.3, 1.0]] {
            let moved = cross(turn, offset);
            for axis in 0..3 {
                let along = std::array::from_fn(|k| f64::from(u8::from(k == axis)));
                step.add(offset, along, -moved[axis] - shift[axis], 2.0);
            }
        }
        let [a, b] = step.solve();
        assert!(near(a, turn) && near(b, shift), "{a:?} {b:?}");
        let mut along_x = Step::default();
        along_x.add([0.0; 3], [1.0, 0.0, 0.0], -0.5, 1.0);
        assert_eq!(along_x.solve(), [[0.0; 3], [0.5, 0.0, 0.0]]);
    }
}
