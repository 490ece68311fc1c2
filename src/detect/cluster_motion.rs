//! Small shells close together, as hair, lashes and teeth on a head, put where they fit as a whole.
//!
//! A round head tells little of its own mirror plane, and a map that is turned by a few degrees sends each card of hair to its twin's neighbour. All of them
//! together know better: a rigid motion puts them on the shells that there are (P. Besl, N. McKay, "A method for registration of 3-D shapes", 1992, from
//! several turns, since each next card is a fit of its own).

use crate::mesh::rotation::{Matrix, nearest_rotation, principal_axes, rotation, turned};
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

/// A turn about a point, and then a shift.
#[derive(Clone, Copy)]
struct Motion {
    turn: Matrix,
    from: Vector,
    to: Vector,
}

impl Motion {
    fn of(&self, at: Vector) -> Vector {
        let turned = turned(&self.turn, subtract(at, self.from));
        std::array::from_fn(|axis| turned[axis] + self.to[axis])
    }
}

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
    let middle = mean(points.iter().copied());
    let offsets: Vec<Vector> = points.iter().map(|&at| subtract(at, middle)).collect();
    let axes = principal_axes(products(&offsets, &offsets, &vec![1.0; offsets.len()]));
    let still = Motion { turn: rotation(axes[0], 0.0), from: middle, to: middle };
    let turns =
        axes.iter().flat_map(|&axis| TURNS.map(|angle| Motion { turn: rotation(axis, angle), ..still }));
    let ended = turns.map(|motion| registered(motion, points, tree, ROUNDS));
    let turned = ended.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let near = registered(still, points, tree, ROUNDS);
    let (left, motion) = if turned.0 < near.0.min(LIES_ON) { turned } else { near };
    (left < BETTER * registered(still, points, tree, 0).0).then_some(motion)
}

/// A motion after some rounds, and the mean distance that it leaves.
fn registered(mut motion: Motion, points: &[Vector], tree: &RTree<Vector>, rounds: usize) -> (f64, Motion) {
    let near = |motion: &Motion| -> Vec<(Vector, f64)> {
        let near = |&at: &Vector| {
            let goal = motion.of(at);
            let near = tree.nearest_neighbor(goal).copied().unwrap_or(goal);
            (near, squared_norm(subtract(near, goal)).sqrt())
        };
        points.iter().map(near).collect()
    };
    for _ in 0..rounds {
        let near = near(&motion);
        let weights: Vec<f64> =
            near.iter().map(|(_, away)| 1.0 / (1.0 + (away / FARTHEST).powi(2))).collect();
        let all: f64 = weights.iter().sum();
        let middle = |place: &dyn Fn(usize) -> Vector| -> Vector {
            let sum = |axis: usize| (0..weights.len()).map(|i| weights[i] * place(i)[axis]).sum::<f64>();
            std::array::from_fn(|axis| sum(axis) / all)
        };
        let (from, to) = (middle(&|i| points[i]), middle(&|i| near[i].0));
        let own: Vec<Vector> = points.iter().map(|&at| subtract(at, from)).collect();
        let there: Vec<Vector> = near.iter().map(|&(at, _)| subtract(at, to)).collect();
        motion = Motion { turn: nearest_rotation(&products(&there, &own, &weights)), from, to };
    }
    let left = near(&motion).iter().map(|(_, away)| away.min(FARTHEST)).sum::<f64>();
    (left / points.len() as f64, motion)
}

/// The sum of `weight a b^T`.
fn products(a: &[Vector], b: &[Vector], weights: &[f64]) -> Matrix {
    let mut sum = Matrix::default();
    for ((a, b), weight) in a.iter().zip(b).zip(weights) {
        for row in 0..3 {
            (0..3).for_each(|column| sum[row][column] += weight * a[row] * b[column]);
        }
    }
    sum
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
