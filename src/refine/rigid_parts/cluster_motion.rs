//! Small shells close together, as hair, lashes and teeth on a head, put where they fit as a whole.
//!
//! A round head tells little of its own mirror plane, and a map that is turned by a few degrees sends each card of hair to its twin's neighbour. All of them
//! together know better: a rigid motion puts them on the shells that there are (P. Besl, N. McKay, "A method for registration of 3-D shapes", 1992, from
//! several turns, since each next card is a fit of its own).

use super::motion::{Motion, Place, Spread};
use crate::mesh::rotation::{principal_axes, rotation};
use crate::mesh::vector::{Vector, mean, squared_norm, subtract};
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Radius, in sqrt(area) of the primary shell, of a cluster, which moves together, and the fewest shells that tell how.
const RADIUS: f64 = 0.2;
const FEWEST: usize = 4;
/// Points of each shell, and of a whole cluster, that are compared.
const POINTS: usize = 24;
const MOST_POINTS: usize = 200;
/// Turns, in radians, about each axis that are tried.
const TURNS: [f64; 8] = [-0.8, -0.6, -0.4, -0.2, 0.2, 0.4, 0.6, 0.8];
/// Rounds of the registration.
const ROUNDS: usize = 12;
/// No point counts as farther than this, in sqrt(area), from the shells.
const FARTHEST: f64 = 0.03;
/// A motion must leave this share of the distances that the map leaves; one from a turn lies on the shells but for this distance, in sqrt(area).
const BETTER: f64 = 0.7;
const LIES_ON: f64 = 0.006;

/// Moves where shells should be, `mirrored`, to where they fit on what there is, `own`; both are points by shell, in one unit. O(shells log shells).
pub fn settle(mirrored: &mut [Vec<Vector>], own: &[Vec<Vector>]) {
    let tree = RTree::bulk_load(own.iter().flatten().copied().collect());
    for cluster in clusters(mirrored) {
        let sought: Vec<Vector> = cluster.iter().flat_map(|&shell| some(&mirrored[shell], POINTS)).collect();
        let sought: Vec<Vector> = some(&sought, MOST_POINTS).collect();
        if let Some(motion) = best(&sought, &tree) {
            cluster.iter().for_each(|&shell| mirrored[shell].iter_mut().for_each(|at| *at = motion.of(*at)));
        }
    }
}

fn some(points: &[Vector], count: usize) -> impl Iterator<Item = Vector> {
    points.iter().step_by(points.len().div_ceil(count).max(1)).copied()
}

/// Shells in clusters: one that is in none with all others near it that are in none. O(shells log shells).
fn clusters(shells: &[Vec<Vector>]) -> Vec<Vec<usize>> {
    let leaf = |(shell, points): (usize, &Vec<Vector>)| {
        (!points.is_empty()).then(|| GeomWithData::new(mean(points.iter().copied()), shell))
    };
    let leaves: Vec<GeomWithData<Vector, usize>> = shells.iter().enumerate().filter_map(leaf).collect();
    let tree = RTree::bulk_load(leaves.clone());
    let mut is_free = vec![true; shells.len()];
    let mut clusters = Vec::new();
    for first in leaves {
        if is_free[first.data] {
            let near = tree.locate_within_distance(*first.geom(), RADIUS * RADIUS).map(|leaf| leaf.data);
            let mut cluster: Vec<usize> = near.filter(|&shell| is_free[shell]).collect();
            cluster.iter().for_each(|&shell| is_free[shell] = false);
            cluster.sort_unstable();
            clusters.push(cluster);
        }
    }
    clusters.retain(|cluster| cluster.len() >= FEWEST);
    clusters
}

/// The motion that puts points best on others; `None` if none is much better than to leave them.
fn best(points: &[Vector], tree: &RTree<Vector>) -> Option<Motion> {
    let places: Vec<Place> = points.iter().map(|&at| Place::unoriented(at, at, 1.0)).collect();
    let spread = Spread::of(&places);
    let turned = |axis: Vector, angle| Motion::STILL.then_turned(&rotation(axis, angle), spread.middle);
    let turns =
        principal_axes(spread.moments).into_iter().flat_map(|axis| TURNS.map(|angle| turned(axis, angle)));
    let ended = turns.map(|motion| registered(motion, points, tree, ROUNDS));
    let turned = ended.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let near = registered(Motion::STILL, points, tree, ROUNDS);
    let (left, motion) = if turned.0 < near.0.min(LIES_ON) { turned } else { near };
    (left < BETTER * registered(Motion::STILL, points, tree, 0).0).then_some(motion)
}

/// A motion after some rounds, and the mean distance that it leaves.
fn registered(mut motion: Motion, points: &[Vector], tree: &RTree<Vector>, rounds: usize) -> (f64, Motion) {
    let near = |motion: Motion| {
        points.iter().map(move |&at| {
            let goal = motion.of(at);
            let near = tree.nearest_neighbor(goal).copied().unwrap_or(goal);
            (at, near, squared_norm(subtract(near, goal)).sqrt())
        })
    };
    for _ in 0..rounds {
        let weight = |away: f64| 1.0 / (1.0 + (away / FARTHEST).powi(2));
        let goes = near(motion).map(|(at, near, away)| Place::unoriented(at, near, weight(away)));
        motion = Motion::nearest(&goes.collect::<Vec<Place>>(), false, |place| place.weight);
    }
    let left = near(motion).map(|(.., away)| away.min(FARTHEST)).sum::<f64>();
    (left / points.len() as f64, motion)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twelve cards around a head but for its face, each of nine points, turned by an angle about the head's axis.
    fn cards(angle: f64) -> Vec<Vec<Vector>> {
        let card = |number: u32| -> Vec<Vector> {
            let place = |point: u32| -> Vector {
                let around = angle + 0.4 * f64::from(number) + 0.05 * f64::from(point % 3);
                [0.1 * around.cos(), 0.1 * around.sin(), 0.03 * f64::from(point / 3)]
            };
            (0..9).map(place).collect()
        };
        (0..12).map(card).collect()
    }

    fn farthest(a: &[Vec<Vector>], b: &[Vec<Vector>]) -> f64 {
        let pairs = a.iter().flatten().zip(b.iter().flatten());
        pairs.map(|(a, b)| squared_norm(subtract(*a, *b)).sqrt()).fold(0.0, f64::max)
    }

    #[test]
    fn cards_that_are_turned_by_nearly_one_come_back_onto_their_own() {
        let (own, mut turned) = (cards(0.0), cards(0.35));
        assert!(farthest(&turned, &own) > 0.03);
        settle(&mut turned, &own);
        assert!(farthest(&turned, &own) < 1e-3, "{}", farthest(&turned, &own));
    }

    #[test]
    fn what_lies_well_or_is_of_few_shells_stays() {
        let own = cards(0.0);
        let (mut well, mut few) = (own.clone(), cards(0.35)[..3].to_vec());
        settle(&mut well, &own);
        settle(&mut few, &own[..3]);
        assert!(well == own && few == cards(0.35)[..3]);
    }
}
