//! Small shells close together, as hair, lashes and teeth on a head, put where they fit as a whole.
//!
//! A round head tells little of its own mirror plane: a map may turn it by a right angle, and then sends each card of hair to another one's twin. All of them
//! together know better: one rigid motion puts them on the shells that there are (P. Besl, N. McKay, "A method for registration of 3-D shapes", 1992), from
//! many turns, since each next card is a fit of its own: roughly their middles, then their points.

use super::motion::{Motion, Place, Spread};
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::mesh::rotation::{principal_axes, rotation, turned};
use crate::mesh::vector::{Vector, mean, squared_norm, subtract};
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Radius, in sqrt(area) of the primary shell, of a cluster, which moves together, and the fewest shells that tell how.
const RADIUS: f64 = 0.2;
const FEWEST: usize = 4;
/// Points of each shell, and of a whole cluster, and middles of its shells, that are compared.
const POINTS: usize = 24;
const MOST_POINTS: usize = 200;
const MIDDLES: usize = 100;
/// Turns about each axis that are tried: their distance, in radians, and how many to each side.
const STEP: f64 = 0.1;
const TURNS: i32 = 15;
/// Rounds of the registration of middles and of points, and the turns of which the points are registered.
const MIDDLE_ROUNDS: usize = 6;
const ROUNDS: usize = 12;
const FOLLOWED: usize = 10;
/// No point counts as farther than this, in sqrt(area), from the shells.
const FARTHEST: f64 = 0.03;
/// A motion must leave this share of the distances that the map leaves. One from a turn leaves less than this, and less by so much than the motion nearest
/// to the map: a ring of cards lies on itself in many ways. Both in sqrt(area).
const BETTER: f64 = 0.7;
const LIES_ON: f64 = 0.006;
const GAIN: f64 = 0.001;
/// A cluster whose middle the map moves by more than this, in sqrt(area), does not come back onto itself.
const AWAY: f64 = 0.5 * RADIUS;

/// Moves where shells should be, `mirrored` by a map of a `kind`, to where they fit on what there is, `own`; both are points by shell, in one unit. O(shells log shells).
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn settle(
    mirrored: &mut [Vec<Vector>],
    own: &[Vec<Vector>],
    kind: SymmetryKind,
    progress: &Progress,
) -> Result<()> {
    let middles = own.iter().filter(|points| !points.is_empty()).map(|points| mean(points.iter().copied()));
    let is_mirrored = kind == SymmetryKind::Reflection;
    let [middles, points] = [middles.collect(), own.iter().flatten().copied().collect()]
        .map(|points| Shells { tree: RTree::bulk_load(points), is_mirrored });
    for cluster in clusters(mirrored) {
        let middle = |&shell: &usize| {
            let [from, to] = [&own[shell], &mirrored[shell]].map(|points| mean(points.iter().copied()));
            Place::unoriented(from, to, 1.0)
        };
        let of_shell = |&shell: &usize| {
            let goes = some(&own[shell], POINTS).zip(some(&mirrored[shell], POINTS));
            goes.map(|(from, to)| Place::unoriented(from, to, 1.0))
        };
        let places = [cluster.iter().map(middle).collect(), cluster.iter().flat_map(of_shell).collect()];
        if let Some(motion) = best([&middles, &points], places, progress)? {
            for shell in cluster {
                mirrored[shell] = own[shell].iter().map(|&at| motion.of(at)).collect();
            }
        }
    }
    Ok(())
}

/// Some of a list, from all over it.
fn some<T: Copy>(all: &[T], count: usize) -> impl Iterator<Item = T> {
    all.iter().step_by(all.len().div_ceil(count).max(1)).copied()
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

/// The motion of a cluster's middles and points that lies best on those of all shells; `None` if none is much better than their map.
fn best(
    [middles, points]: [&Shells; 2],
    [few, many]: [Vec<Place>; 2],
    progress: &Progress,
) -> Result<Option<Motion>> {
    let (few, many) = (Vec::from_iter(some(&few, MIDDLES)), Vec::from_iter(some(&many, MOST_POINTS)));
    let spread = Spread::of(&many);
    let map = Motion::between(&many, middles.is_mirrored);
    let about = map.of(spread.middle);
    let mut roughly: Vec<(f64, Motion)> = Vec::new();
    for axis in principal_axes(spread.moments) {
        progress.goes_on()?;
        let start = |turn| map.then_turned(&rotation(turned(&map.turn, axis), STEP * f64::from(turn)), about);
        roughly.extend((-TURNS..=TURNS).map(|turn| middles.registered(start(turn), &few, MIDDLE_ROUNDS)));
    }
    progress.goes_on()?;
    roughly.sort_by(|a, b| a.0.total_cmp(&b.0));
    let finely =
        roughly.into_iter().take(FOLLOWED).map(|(_, motion)| points.registered(motion, &many, ROUNDS));
    let turned = finely.min_by(|a, b| a.0.total_cmp(&b.0)).expect("some turns");
    let near = points.registered(map, &many, ROUNDS);
    let (left, motion) = if turned.0 < LIES_ON.min(near.0 - GAIN) { turned } else { near };
    let apart = |a, b| squared_norm(subtract(a, b));
    let there = motion.of(spread.middle);
    // What the map sends away, as a glove to the other hand, has its twins there or none.
    let comes_back =
        apart(about, spread.middle) > AWAY * AWAY && apart(there, spread.middle) < apart(there, about);
    Ok((!comes_back && left < BETTER * points.left(&many, |place| place.image)).then_some(motion))
}

/// Points of all shells, or their middles.
struct Shells {
    tree: RTree<Vector>,
    is_mirrored: bool,
}

impl Shells {
    /// A motion after some rounds, and the mean distance that it leaves.
    fn registered(&self, mut motion: Motion, places: &[Place], rounds: usize) -> (f64, Motion) {
        for _ in 0..rounds {
            let to_nearest = |place: &Place| {
                let (near, away) = self.nearest(motion.of(place.own.position));
                Place::unoriented(place.own.position, near, 1.0 / (1.0 + (away / FARTHEST).powi(2)))
            };
            let goes: Vec<Place> = places.iter().map(to_nearest).collect();
            motion = Motion::nearest(&goes, self.is_mirrored, |place| place.weight);
        }
        (self.left(places, |place| motion.of(place.own.position)), motion)
    }

    /// The mean distance of places' goals from the shells.
    fn left(&self, places: &[Place], goal: impl Fn(&Place) -> Vector) -> f64 {
        let sum: f64 = places.iter().map(|place| self.nearest(goal(place)).1.min(FARTHEST)).sum();
        sum / places.len() as f64
    }

    fn nearest(&self, goal: Vector) -> (Vector, f64) {
        let near = self.tree.nearest_neighbor(goal).copied().unwrap_or(goal);
        (near, squared_norm(subtract(near, goal)).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twelve cards around a head but for its face, each of nine points, and their mirror images, turned by an angle about the head's axis.
    fn cards(angle: f64) -> [Vec<Vec<Vector>>; 2] {
        let card = |number: u32, image: &dyn Fn(f64) -> f64| -> Vec<Vector> {
            let place = |point: u32| -> Vector {
                let around = image(0.4 * f64::from(number) + 0.05 * f64::from(point % 3));
                [0.1 * around.cos(), 0.1 * around.sin(), 0.03 * f64::from(point / 3)]
            };
            (0..9).map(place).collect()
        };
        let mirrored = move |around: f64| angle + 4.5 - around;
        [&(|around| around) as &dyn Fn(f64) -> f64, &mirrored]
            .map(|image| (0..12).map(|number| card(number, image)).collect())
    }

    /// The farthest that the cards' images are from their twins, the first one's image from the last one.
    fn farthest([own, mirrored]: &[Vec<Vec<Vector>>; 2]) -> f64 {
        let away = |(twin, image): (&Vec<Vector>, &Vec<Vector>)| {
            (0..9)
                .map(|point| squared_norm(subtract(twin[point / 3 * 3 + 2 - point % 3], image[point])).sqrt())
                .fold(0.0, f64::max)
        };
        own.iter().rev().zip(mirrored).map(away).fold(0.0, f64::max)
    }

    #[test]
    fn cards_that_are_turned_by_nearly_one_or_by_several_come_onto_their_twins() {
        for angle in [0.35, -1.3] {
            let mut cards = cards(angle);
            assert!(farthest(&cards) > 0.03);
            let [own, mirrored] = &mut cards;
            settle(mirrored, own, SymmetryKind::Reflection, &Progress::default()).unwrap();
            assert!(farthest(&cards) < 1e-3, "{angle}: {}", farthest(&cards));
        }
    }

    #[test]
    fn what_the_map_sends_to_the_other_side_does_not_come_back() {
        let [own, mut away] = cards(0.35);
        away.iter_mut().flatten().for_each(|at| at[0] += 0.3);
        let before = away.clone();
        settle(&mut away, &own, SymmetryKind::Reflection, &Progress::default()).unwrap();
        assert!(away == before);
    }

    #[test]
    fn what_lies_well_or_is_of_few_shells_stays() {
        let ([own, mut well], [few, mut turned]) = (cards(0.0), cards(0.35).map(|cards| cards[..3].to_vec()));
        let before = (well.clone(), turned.clone());
        settle(&mut well, &own, SymmetryKind::Reflection, &Progress::default()).unwrap();
        settle(&mut turned, &few, SymmetryKind::Reflection, &Progress::default()).unwrap();
        assert!((well, turned) == before);
    }
}
