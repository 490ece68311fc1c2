//! Whether pairs fit well enough, and are turned as the estimate is, to be mirrored vertices rather than chance.

use super::percolation::Pairing;
use super::places::Places;
use crate::mesh::NONE;
use crate::mesh::vector::{dot, subtract};

/// Largest misfit of a good pair, and least share of the vertices of a shell that have one. Independent
/// triangulations have up to 0.11, grids of voxels 0.18, mirrored vertices 0.39 or more; regular grids of triangles 0.5 to 0.6.
pub(super) const GOOD: f64 = 0.015;
const GOOD_SHARE: f64 = 0.3;
/// Largest median, over good pairs, of the angle (radians) by which the pairs around one are turned against the estimate.
/// Mirrored vertices have up to 2.3 degrees, regular grids 4 to 16.
const LARGEST_TURN: f64 = 3.0 / 180.0 * std::f64::consts::PI;
/// Rounds in which turns are averaged with those of neighbours: the estimate is wavy from vertex to vertex.
const ROUNDS: usize = 40;

/// Whether enough vertices of a shell have a good pair.
pub(super) fn has_enough(pairing: &Pairing, points: &[u32]) -> bool {
    points.iter().filter(|point| is_good(pairing, **point)).count() as f64 >= GOOD_SHARE * points.len() as f64
}

fn is_good(pairing: &Pairing, point: u32) -> bool {
    let image = pairing.image[point as usize];
    image != NONE && pairing.misfit(point, image) <= GOOD
}

/// Whether the good pairs of a shell, of which there is one, are turned as the estimate is. O(points of the mesh).
pub(super) fn agrees_in_turn(pairing: &Pairing, places: &Places, points: &[u32]) -> bool {
    let mut turns = vec![[0.0; 2]; places.position.len()];
    let good: Vec<u32> = points.iter().copied().filter(|&point| is_good(pairing, point)).collect();
    for &point in &good {
        turns[point as usize] = turn(pairing, places, point);
    }
    for _ in 0..ROUNDS {
        let mean = |&point: &u32| {
            let around = pairing.edges.of(point as usize).iter().chain([&point]);
            let sum = around.fold([0.0; 2], |sum, &near| [0, 1].map(|k| sum[k] + turns[near as usize][k]));
            unit(sum)
        };
        let next: Vec<[f64; 2]> = good.iter().map(mean).collect();
        good.iter().zip(next).for_each(|(&point, turn)| turns[point as usize] = turn);
    }
    let angle = |&point: &u32| turns[point as usize][1].atan2(turns[point as usize][0]).abs();
    let mut angles: Vec<f64> = good.iter().map(angle).collect();
    let middle = angles.len() / 2;
    *angles.select_nth_unstable_by(middle, f64::total_cmp).1 <= LARGEST_TURN
}

/// Cosine and sine of the angle, in the tangent plane at its image, by which the pairs around a point are turned against the
/// estimate there.
fn turn(pairing: &Pairing, places: &Places, point: u32) -> [f64; 2] {
    let image = pairing.image[point as usize];
    let along = |offset| pairing.tangents[image as usize].map(|axis| dot(axis, offset));
    let mut sum = [0.0; 2];
    for &near in pairing.close.of(point as usize) {
        let near_image = pairing.image[near as usize];
        if near_image != NONE {
            let estimated = subtract(places.position[near as usize], places.position[point as usize]);
            let ([x, y], [u, v]) = (along(estimated), along(pairing.offset(image, near_image)));
            sum = [sum[0] + x * u + y * v, sum[1] + x * v - y * u];
        }
    }
    unit(sum)
}

/// A vector scaled to length 1; 0 stays 0.
fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let length = x.hypot(y).max(f64::MIN_POSITIVE);
    [x / length, y / length]
}
