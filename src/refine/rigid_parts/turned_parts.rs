//! Parts that a pose has turned far about their joint, as a head that looks over its shoulder.
//!
//! The surface alone hardly tells how far a round neck is turned, and the map takes such a head for one that looks ahead: under it, no
//! rigid motion brings the head back onto the surface. From motions that are turned against it all around, as P. Besl and N. McKay
//! start theirs ("A method for registration of 3-D shapes", 1992, section IV), one may. What it fits is then mapped by it.

use super::mapped::{Disc, Mapped, Sought};
use super::motion::{Approach, Motion, Oriented, Place, Spread};
use super::takeover::{SmallParts, take_over};
use crate::base::effort::TurnedEffort;
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::base::threads;
use crate::mesh::rotation::{principal_axes, rotation, turned as turned_by};
use crate::mesh::vector::{Vector, squared_norm, subtract};
use std::f64::consts::PI;

/// Radii of the parts along edges, in sqrt(area); they are larger than those the finished map follows.
const RADII: [f64; 2] = [0.2, 0.15];
/// How a motion is brought to the surface: all the way, and roughly, by each so manieth point.
const WHOLLY: Approach = Approach { rounds: 5, noise: 0.008, held: 0.05, free: true };
const ROUGHLY: Approach = Approach { rounds: 3, ..WHOLLY };
/// Not at all: all turns are judged as they are, by the vertices alone, and this many times those to be fitted are followed.
const GLANCE: Approach = Approach { rounds: 0, ..WHOLLY };
const FOLLOWED: usize = 4;
/// The best is fitted once more, finely.
const FINELY: Approach = Approach { noise: 0.003, held: 0.02, ..WHOLLY };
const ROUGH_STEP: usize = 3;
/// Turns nearer than this, in radians, count as one.
const SAME_TURN: f64 = 0.5;
/// Share of a part's points that may misfit: mouths and eye sockets, and the neck where a head is turned.
const MISFITTING: f64 = 0.3;
/// A part that leaves more than this, in sqrt(area), fits badly.
const BAD: f64 = 0.01;
/// A turned motion must leave no more than this share of what the map's leaves, and the map by it of the distortion of its surroundings.
pub(super) const BETTER: f64 = 0.85;

/// A part: some of its vertices, each standing for the same area, with their weights.
struct TurnedPart {
    middle: u32,
    picked: Vec<(u32, f64)>,
    /// The map's motion, roughly brought to the surface.
    own: Settled,
}

/// A motion brought to the surface, and how unlike the surface is there, in sqrt(area): root mean square over the points that fit best.
#[derive(Clone, Copy)]
pub(super) struct Settled {
    pub motion: Motion,
    pub unlike: f64,
}

/// Maps parts by turned motions where these fit and the map's do not. `middles` are spread over the surface.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(super) fn map_turned(
    mapped: &mut Mapped,
    middles: &[u32],
    effort: &TurnedEffort,
    mirrored: bool,
    threads: usize,
    progress: &Progress,
) -> Result<()> {
    let some = |count: usize| &middles[..count.min(middles.len())];
    let discs = mapped.discs_along_edges(some(effort.parts), &RADII, threads, progress)?;
    let token = progress.token();
    let screen = |disc: Disc| {
        token.check()?;
        let picked = mapped.picked(&disc.members, effort.points);
        let own = as_mapped(mapped, &few(&picked), mirrored, ROUGHLY);
        Ok(TurnedPart { middle: disc.middle, picked, own })
    };
    let mut parts = threads::map(threads, discs, screen).into_iter().collect::<Result<Vec<TurnedPart>>>()?;
    parts.retain(|part| part.own.unlike > BAD);
    parts.sort_by(|a, b| b.own.unlike.total_cmp(&a.own.unlike));
    parts.truncate(effort.most);
    let search = |part: TurnedPart| {
        token.check()?;
        Ok(turned(mapped, &part, effort, mirrored).map(|found| (part, found)))
    };
    let found = threads::map(threads, parts, search).into_iter().collect::<Result<Vec<_>>>()?;
    let mut found: Vec<(TurnedPart, Settled)> = found.into_iter().flatten().collect();
    let left = |(part, found): &(TurnedPart, Settled)| found.unlike / part.own.unlike;
    found.sort_by(|a, b| left(a).total_cmp(&left(b)));
    let small = SmallParts { middles: some(effort.small), points: effort.points / ROUGH_STEP, mirrored };
    // Where the middles of parts are that were tried.
    let mut tried: Vec<Vector> = Vec::new();
    for (part, found) in found {
        token.check()?;
        let middle = mapped.shell.positions[part.middle as usize];
        let covers = |other: &Vector| squared_norm(subtract(*other, middle)).sqrt() < RADII[0];
        if tried.iter().any(covers) {
            continue;
        }
        tried.push(middle);
        take_over(mapped, &small, part.middle, &found.motion, threads, progress)?;
    }
    Ok(())
}

/// The motion of the map itself, brought to the surface.
fn as_mapped(mapped: &Mapped, picked: &[(u32, f64)], mirrored: bool, approach: Approach) -> Settled {
    let places = mapped.places(picked);
    let near = places.iter().map(|place| place.partner).collect();
    settle(mapped, Motion::between(&places, mirrored), &places, near, approach)
}

/// Some of the points.
fn few(picked: &[(u32, f64)]) -> Vec<(u32, f64)> {
    picked.iter().step_by(ROUGH_STEP).copied().collect()
}

/// The turned motion that fits best, if it fits much better than the map's.
fn turned(mapped: &Mapped, part: &TurnedPart, effort: &TurnedEffort, mirrored: bool) -> Option<Settled> {
    let places = mapped.places(&part.picked);
    let sought = mapped.sought(&places);
    let few = mapped.places(&few(&part.picked));
    let from = |motion: Motion, places: &[Place], approach: Approach| {
        settle(mapped, motion, places, seeds(&motion, places, &sought), approach)
    };
    let start = Motion::between(&places, mirrored);
    let mut rough: Vec<Settled> =
        turns(&start, &places, effort.turns).into_iter().map(|turn| from(turn, &few, GLANCE)).collect();
    rough.sort_by(|a, b| a.unlike.total_cmp(&b.unlike));
    let glanced = rough.into_iter().take(FOLLOWED * effort.fitted);
    let mut rough: Vec<Settled> = glanced.map(|turn| from(turn.motion, &few, ROUGHLY)).collect();
    rough.sort_by(|a, b| a.unlike.total_cmp(&b.unlike));
    if rough.first().is_none_or(|best| best.unlike > part.own.unlike) {
        return None;
    }
    let mut apart: Vec<Motion> = Vec::new();
    for Settled { motion, .. } in rough {
        if apart.len() < effort.fitted && apart.iter().all(|other| other.turn_to(&motion).1 > SAME_TURN) {
            apart.push(motion);
        }
    }
    let own = as_mapped(mapped, &part.picked, mirrored, WHOLLY);
    let fitted = apart.into_iter().map(|motion| from(motion, &places, WHOLLY));
    let best = fitted.min_by(|a, b| a.unlike.total_cmp(&b.unlike))?;
    let best = from(best.motion, &places, FINELY);
    (best.unlike < BETTER * own.unlike).then_some(best)
}

/// A motion turned about where it puts the part's middle, all around each of the image's principal axes.
fn turns(start: &Motion, places: &[Place], count: usize) -> Vec<Motion> {
    let spread = Spread::of(places);
    let about = start.of(spread.middle);
    let angles = (1..count).map(|turn| 2.0 * PI * turn as f64 / count as f64);
    let axes = principal_axes(spread.moments).map(|axis| turned_by(&start.turn, axis));
    let rotations = axes.into_iter().flat_map(|axis| angles.clone().map(move |angle| rotation(axis, angle)));
    rotations.map(|rotation| start.then_turned(&rotation, about)).collect()
}

/// For each place the one of the sought vertices most like where the motion puts it.
pub(super) fn seeds(motion: &Motion, places: &[Place], sought: &Sought) -> Vec<u32> {
    sought.most_alike(places.iter().map(|place| motion.of_oriented(place.own)))
}

/// Brings a motion to the surface, sought from the vertices `near` the places' images.
pub(super) fn settle(
    mapped: &Mapped,
    start: Motion,
    places: &[Place],
    mut near: Vec<u32>,
    approach: Approach,
) -> Settled {
    let motion = start.settled(places, &mut mapped.surface_from(&mut near), approach);
    let unlike = |goal: Oriented, near: u32| {
        let (near, unlike) = mapped.alike(goal, near);
        if approach.rounds == 0 { f64::from(unlike) } else { mapped.unlike_beside(goal, near) }
    };
    Settled { motion, unlike: left(&motion, places, &near, unlike) }
}

/// Root mean square, over the places that fit best, of how unlike the surface is where the motion puts them; `unlike` gives it squared.
fn left(motion: &Motion, places: &[Place], near: &[u32], unlike: impl Fn(Oriented, u32) -> f64) -> f64 {
    let squared =
        |(place, &near): (&Place, &u32)| (unlike(motion.of_oriented(place.own), near), place.weight);
    let mut places: Vec<(f64, f64)> = places.iter().zip(near).map(squared).collect();
    places.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let counted = (1.0 - MISFITTING) * places.iter().map(|(_, weight)| weight).sum::<f64>();
    let (mut squares, mut weights) = (0.0, 0.0);
    for (square, weight) in places {
        let weight = weight.min(counted - weights);
        squares += weight * square;
        weights += weight;
    }
    (squares / weights).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is left where the places, all of one weight, are as unlike as `unlike` says.
    fn left_of(unlike: &[f64]) -> f64 {
        let still = Motion { turn: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], shift: [0.0; 3] };
        let place = |partner: usize| Place {
            own: Oriented { position: [0.0; 3], normal: [0.0, 0.0, 1.0] },
            image: [0.0; 3],
            partner: partner as u32,
            weight: 2.0,
        };
        let places: Vec<Place> = (0..unlike.len()).map(place).collect();
        let near: Vec<u32> = places.iter().map(|place| place.partner).collect();
        left(&still, &places, &near, |_, vertex| unlike[vertex as usize].powi(2))
    }

    #[test]
    fn three_points_of_ten_may_misfit_wherever_they_are() {
        assert!(left_of(&[0.5, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0]) < 1e-9);
        // Of a fourth one all counts: a seventh of what counts.
        let four = left_of(&[0.5, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0]);
        assert!((four - 0.5 / 7f64.sqrt()).abs() < 1e-9, "{four}");
        assert!((left_of(&[0.02; 10]) - 0.02).abs() < 1e-9);
        // Of two, 1.4 count: the worse one with 0.4.
        assert!((left_of(&[0.0, 0.1]) - 0.1 * (0.4f64 / 1.4).sqrt()).abs() < 1e-9);
    }
}
