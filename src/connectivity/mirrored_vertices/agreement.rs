//! Whether pairs fit well enough, and are turned as the estimate is, to be mirrored vertices rather than chance.

use super::percolation::Pairing;
use super::places::Places;
use crate::mesh::NONE;
use crate::mesh::vector::{dot, subtract};

/// Largest misfit of a good pair, and least share of the vertices of a shell that have one. Independent
/// triangulations have up to 0.11, grids of voxels 0.18, mirrored vertices 0.34 or more; regular grids of triangles 0.5 to 0.6.
pub(super) const GOOD: f64 = 0.015;
const GOOD_SHARE: f64 = 0.3;
/// Largest turns (degrees) of the given percents of the good pairs against the estimate.
const LARGEST_TURNS: [(usize, f64); 2] = [(50, 2.8), (75, 5.0)];

/// Whether enough vertices of a shell have a good pair.
pub(super) fn has_enough(pairing: &Pairing, points: &[u32]) -> bool {
    count_good(pairing, points) as f64 >= GOOD_SHARE * points.len() as f64
}

/// How many of the points have a good pair.
pub(super) fn count_good(pairing: &Pairing, points: &[u32]) -> usize {
    points.iter().filter(|point| is_good(pairing, **point)).count()
}

fn is_good(pairing: &Pairing, point: u32) -> bool {
    let image = pairing.image[point as usize];
    image != NONE && pairing.misfit(point, image) <= GOOD
}

/// Whether the good pairs of a shell, of which there is one, are turned as the estimate is. The estimate is wavy from vertex
/// to vertex, so turns are averaged over each of its `regions`.
pub(super) fn agrees_in_turn(pairing: &Pairing, places: &Places, regions: &[Vec<u32>]) -> bool {
    let mut angles = Vec::new();
    for region in regions {
        let good = region.iter().filter(|point| is_good(pairing, **point));
        let (mut count, mut sum) = (0, [0.0; 2]);
        for &point in good {
            let turn = turn(pairing, places, point);
            (count, sum) = (count + 1, [sum[0] + turn[0], sum[1] + turn[1]]);
        }
        angles.extend(std::iter::repeat_n(sum[1].atan2(sum[0]).abs(), count));
    }
    let quantile = |share: usize, angles: &mut Vec<f64>| {
        let place = angles.len() * share / 100;
        *angles.select_nth_unstable_by(place, f64::total_cmp).1
    };
    LARGEST_TURNS.iter().all(|&(share, largest)| quantile(share, &mut angles).to_degrees() <= largest)
}

/// Cosine and sine of the angle, in the tangent plane at its image, by which the pairs around a point are turned against the
/// estimate there.
fn turn(pairing: &Pairing, places: &Places, point: u32) -> [f64; 2] {
    let image = pairing.image[point as usize];
    let along = |offset| pairing.around.tangents[image as usize].map(|axis| dot(axis, offset));
    let mut sum = [0.0; 2];
    for &near in pairing.around.close.of(point as usize) {
        let near_image = pairing.image[near as usize];
        if near_image != NONE {
            let estimated = subtract(places.position[near as usize], places.position[point as usize]);
            let ([x, y], [u, v]) = (along(estimated), along(pairing.around.offset(image, near_image)));
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
