//! Parts that a pose has turned far about their joint, as a head that looks over its shoulder.
//!
//! The surface alone hardly tells how far a round neck is turned, and the map takes such a head for one that looks ahead: under it, no
//! rigid motion brings the head back onto the surface. From motions that are turned against it all around, as P. Besl and N. McKay
//! start theirs ("A method for registration of 3-D shapes", 1992, section IV), one may. What it fits is then mapped by it.

use super::mapped::{Mapped, Sought};
use super::motion::{Approach, Motion, Oriented, Place, mean};
use super::takeover::{SmallParts, Surroundings, take_over};
use crate::error::Result;
use crate::mesh::rotation::{Matrix, principal_axes, rotation};
use crate::mesh::vector::{Vector, subtract};
use crate::progress::CancelToken;
use crate::threads;
use std::f64::consts::PI;

/// Parts of each size, fewer and larger than those the finished map follows.
const PARTS: usize = 70;
/// Their radii along edges, in sqrt(area).
const RADII: [f64; 2] = [0.2, 0.15];
/// Points of a part that a motion is fitted to, and rounds of the fit.
const POINTS: usize = 100;
const ROUNDS: usize = 8;
/// A quick fit is to each so manieth of these points, in so many rounds.
const QUICK_STEP: usize = 3;
const QUICK_ROUNDS: usize = 3;
/// Turns about each axis that are tried.
const TURNS: usize = 12;
/// Quick fits of turned motions: after so many rounds, this many of the best are left.
const LEFT: [(usize, usize); 2] = [(2, 20), (3, 12)];
/// The best must leave no more than this share of what a quick fit of the map's motion does.
const PROMISING: f64 = 1.1;
/// Turns nearer than this, in radians, count as one, and this many are fitted with all points.
const SAME_TURN: f64 = 0.5;
const FITTED_TURNS: usize = 4;
/// Share of a part's points that may misfit: mouths and eye sockets, and the neck where a head is turned.
const MISFITTING: f64 = 0.3;
/// A part fits badly from this many times what is usual, and never below this, in sqrt(area).
const BAD: f64 = 2.0;
const LEAST_BAD: f64 = 0.01;
/// A turned motion fits well up to this many times what is usual, or up to this, in sqrt(area).
const GOOD: f64 = 4.0;
const SURELY_GOOD: f64 = 0.02;
/// It must leave no more than this share of what the map's leaves.
const BETTER: f64 = 0.85;
/// One that leaves less than this share is far better.
const FAR_BETTER: f64 = 0.45;
/// Share of the strain of its surroundings that the map with a far better motion may leave, and with another.
const STRAIN_LEFT: [f64; 2] = [0.87, 0.8];
/// Turned motions that leave up to this many times the least are as good as it: the one that turns least is taken.
const AS_GOOD: f64 = 1.3;
const COARSE: Approach = Approach { lever: 0.2, noise: 0.008, held: 0.05 };
const FINE: Approach = Approach { lever: 0.2, noise: 0.003, held: 0.02 };

/// A motion brought to the surface, and how unlike the surface is there, in sqrt(area): root mean square over the points that fit best.
pub(super) struct Settled {
    pub motion: Motion,
    pub unlike: f64,
}

/// A part: some of its vertices, each standing for the same area, with their weights.
struct Part {
    middle: u32,
    picked: Vec<(u32, f64)>,
}

/// A part and a motion turned against the map's that fits it.
struct Turned {
    part: Part,
    /// What the map's motion leaves.
    own: f64,
    found: Settled,
}

/// Maps parts by turned motions where these fit and the map's do not.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub(super) fn right(mapped: &mut Mapped, mirrored: bool, threads: usize, token: &CancelToken) -> Result<()> {
    let screened = |(middle, radius): (u32, f64)| {
        token.check()?;
        let part = Part { middle, picked: mapped.picked(&mapped.disc(middle, radius).members, POINTS) };
        let quick = as_mapped(mapped, &few(&part.picked), QUICK_ROUNDS, mirrored)?;
        let own = match quick.unlike > LEAST_BAD {
            true => as_mapped(mapped, &part.picked, ROUNDS, mirrored)?,
            false => quick,
        };
        Ok((part, own))
    };
    let middles = mapped.spread(PARTS);
    let all = RADII.iter().flat_map(|&radius| middles.iter().map(move |&middle| (middle, radius))).collect();
    let own = threads::map(threads, all, screened).into_iter().collect::<Result<Vec<_>>>()?;
    let usual = usual(&own);
    let bad = own.into_iter().filter(|(_, own)| own.unlike > (BAD * usual).max(LEAST_BAD));
    let search = |(part, own): (Part, Settled)| {
        token.check()?;
        let found = turned(mapped, &part, &own, mirrored)?;
        let good = found.filter(|found| found.unlike < (GOOD * usual).max(SURELY_GOOD));
        Ok(good.map(|found| Turned { part, own: own.unlike, found }))
    };
    let found = threads::map(threads, bad.collect(), search).into_iter().collect::<Result<Vec<_>>>()?;
    let mut found: Vec<Turned> = found.into_iter().flatten().collect();
    let left = |turned: &Turned| turned.found.unlike / turned.own;
    found.sort_by(|a, b| left(a).total_cmp(&left(b)));
    if found.is_empty() {
        return Ok(());
    }
    let mut small = SmallParts::new(mapped, threads, token)?;
    let mut changed = false;
    for Turned { part, mut own, found } in found {
        token.check()?;
        if changed {
            // Another part may have brought this one along.
            own = as_mapped(mapped, &part.picked, ROUNDS, mirrored)?.unlike;
        }
        if found.unlike < BETTER * own {
            let strain_left = if found.unlike < FAR_BETTER * own { STRAIN_LEFT[0] } else { STRAIN_LEFT[1] };
            let surroundings = Surroundings { middle: part.middle, mirrored, usual, strain_left, threads };
            changed |= take_over(mapped, &mut small, surroundings, &found.motion)?;
        }
    }
    Ok(())
}

/// Those that a quick fit is to.
fn few(picked: &[(u32, f64)]) -> Vec<(u32, f64)> {
    picked.iter().step_by(QUICK_STEP).copied().collect()
}

/// What parts that fit leave: a tenth leave less.
fn usual(own: &[(Part, Settled)]) -> f64 {
    let mut unlike: Vec<f64> = own.iter().map(|(_, own)| own.unlike).collect();
    unlike.sort_by(f64::total_cmp);
    unlike[unlike.len() / 10]
}

/// The motion of the map itself, brought to the surface.
fn as_mapped(mapped: &Mapped, picked: &[(u32, f64)], rounds: usize, mirrored: bool) -> Result<Settled> {
    let places = mapped.places(picked);
    let near = places.iter().map(|place| place.partner).collect();
    settle(mapped, Motion::between(&places, mirrored), &places, near, rounds, COARSE)
}

/// The turned motion that fits best, if it fits much better than the map's.
fn turned(mapped: &Mapped, part: &Part, own: &Settled, mirrored: bool) -> Result<Option<Settled>> {
    let places = mapped.places(&part.picked);
    let sought = mapped.sought(&places);
    let start = Motion::between(&places, mirrored);
    let few = mapped.places(&few(&part.picked));
    let mut apart: Vec<Motion> = Vec::new();
    for motion in promising(mapped, &few, &sought, turns(&start, &places), &own.motion)? {
        if apart.iter().all(|other| other.angle_to(&motion) > SAME_TURN) {
            apart.push(motion);
        }
    }
    let from = |motion: Motion, step: Approach| {
        settle(mapped, motion, &places, seeds(&motion, &places, &sought), ROUNDS, step)
    };
    let fitted = apart.into_iter().take(FITTED_TURNS).map(|motion| from(motion, COARSE));
    let fitted = fitted.collect::<Result<Vec<Settled>>>()?;
    let least = fitted.iter().fold(f64::INFINITY, |least, fit| least.min(fit.unlike));
    let turn = |fit: &Settled| start.angle_to(&fit.motion);
    let as_good = fitted.into_iter().filter(|fit| fit.unlike <= AS_GOOD * least);
    let best = as_good.min_by(|a, b| turn(a).total_cmp(&turn(b)));
    best.filter(|_| least <= BETTER * own.unlike).map(|best| from(best.motion, FINE)).transpose()
}

/// Those of `motions` that quick fits bring nearest the surface, the best first; none if `own` comes nearer.
fn promising(
    mapped: &Mapped,
    places: &[Place],
    sought: &Sought,
    motions: Vec<Motion>,
    own: &Motion,
) -> Result<Vec<Motion>> {
    let unlike = |motion: &Motion, near: &[u32]| {
        left(motion, places, near, |goal, near| mapped.unlike_vertex(goal, mapped.alike(goal, near).0))
    };
    let seeded = |motion: Motion| (motion, seeds(&motion, places, sought));
    let mut motions: Vec<(Motion, Vec<u32>)> = motions.into_iter().map(seeded).collect();
    let mut least = f64::INFINITY;
    for (rounds, kept) in LEFT {
        let fit = |(motion, mut near): (Motion, Vec<u32>)| -> Result<(f64, Motion, Vec<u32>)> {
            let alike = |goal, start| mapped.alike(goal, start);
            let motion = motion.settled(places, &mut near, rounds, COARSE, alike)?;
            Ok((unlike(&motion, &near), motion, near))
        };
        let mut fitted = motions.into_iter().map(fit).collect::<Result<Vec<_>>>()?;
        fitted.sort_by(|(a, ..), (b, ..)| a.total_cmp(b));
        least = fitted[0].0;
        motions = fitted.into_iter().take(kept).map(|(_, motion, near)| (motion, near)).collect();
    }
    let near: Vec<u32> = places.iter().map(|place| place.partner).collect();
    Ok(match least < PROMISING * unlike(own, &near) {
        true => motions.into_iter().map(|(motion, _)| motion).collect(),
        false => Vec::new(),
    })
}

/// A motion turned about where it puts the part's middle, all around each of the image's principal axes.
fn turns(start: &Motion, places: &[Place]) -> Vec<Motion> {
    let weights: Vec<f64> = places.iter().map(|place| place.weight).collect();
    let images: Vec<Vector> = places.iter().map(|place| start.of(place.own.position)).collect();
    let about = mean(images.iter().copied(), &weights);
    let mut moments = Matrix::default();
    for (image, weight) in images.iter().zip(&weights) {
        let offset = subtract(*image, about);
        for row in 0..3 {
            (0..3).for_each(|column| moments[row][column] += weight * offset[row] * offset[column]);
        }
    }
    let angles = (1..TURNS).map(|turn| 2.0 * PI * turn as f64 / TURNS as f64);
    let rotations = principal_axes(moments)
        .into_iter()
        .flat_map(|axis| angles.clone().map(move |angle| rotation(axis, angle)));
    rotations.map(|rotation| start.then_turned(&rotation, about)).collect()
}

/// For each place the one of the sought vertices most like where the motion puts it.
pub(super) fn seeds(motion: &Motion, places: &[Place], sought: &Sought) -> Vec<u32> {
    let goals: Vec<Oriented> = places.iter().map(|place| motion.of_oriented(place.own)).collect();
    sought.most_alike(&goals)
}

/// Brings a motion to the surface, sought from the vertices `near` the places' images.
pub(super) fn settle(
    mapped: &Mapped,
    start: Motion,
    places: &[Place],
    mut near: Vec<u32>,
    rounds: usize,
    step: Approach,
) -> Result<Settled> {
    let motion = start.settled(places, &mut near, rounds, step, |goal, start| mapped.alike(goal, start))?;
    let unlike =
        left(&motion, places, &near, |goal, near| mapped.unlike_near(goal, mapped.alike(goal, near).0));
    Ok(Settled { motion, unlike })
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
