//! Parts that a pose has turned far about their joint, as a head that looks over its shoulder.
//!
//! The surface alone hardly tells how far a round neck is turned, and the map takes such a head for one that looks ahead: under it, no
//! rigid motion brings the head back onto the surface. From motions that are turned against it all around, as P. Besl and N. McKay
//! start theirs ("A method for registration of 3-D shapes", 1992, section IV), one may. What it fits is then mapped by it.

use super::mapped::Mapped;
use super::motion::{Approach, Motion, Place, mean};
use super::unturned::{Surroundings, take_over};
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
/// Those of the first look at a turned motion.
const FEW_POINTS: usize = 40;
const FEW_ROUNDS: usize = 3;
/// Turns about each axis that are tried, and how many of them are fitted with all points.
const TURNS: usize = 12;
const FITTED_TURNS: usize = 4;
/// Turns nearer than this, in radians, count as one.
const SAME_TURN: f64 = 0.5;
/// A part fits badly from this many times what is usual, and never below this, in sqrt(area).
const BAD: f64 = 2.0;
const LEAST_BAD: f64 = 0.015;
/// A turned motion fits well up to this many times what is usual, or up to this, in sqrt(area).
const GOOD: f64 = 2.0;
const SURELY_GOOD: f64 = 0.02;
/// It must leave this share of what the map's leaves.
const BETTER: f64 = 0.45;
/// Turned motions that leave up to this many times the least are as good as it: the one that turns least is taken.
const AS_GOOD: f64 = 1.3;
const COARSE: Approach = Approach { lever: 0.2, noise: 0.008, held: 0.05 };
const FINE: Approach = Approach { lever: 0.2, noise: 0.003, held: 0.02 };

/// A motion brought to the surface, and how unlike the surface is there, in sqrt(area): root mean square over the points.
pub(super) struct Settled {
    pub motion: Motion,
    pub unlike: f64,
}

/// What is within a radius of a vertex.
#[derive(Clone, Copy)]
struct Disc {
    middle: u32,
    radius: f64,
}

/// A part and a motion turned against the map's that fits it.
struct Turned {
    at: Disc,
    /// How much less the motion leaves, squared.
    gain: f64,
    found: Settled,
}

/// Maps parts by turned motions where these fit and the map's do not. `middles` are vertices spread evenly, coarsely at first.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub(super) fn right(
    mapped: &mut Mapped,
    middles: &[u32],
    mirrored: bool,
    threads: usize,
    token: &CancelToken,
) -> Result<()> {
    let screened = |disc: Disc| {
        token.check()?;
        Ok((disc, as_mapped(mapped, disc, mirrored)?))
    };
    let large = &middles[..PARTS.min(middles.len())];
    let discs = RADII.iter().flat_map(|&radius| large.iter().map(move |&middle| Disc { middle, radius }));
    let own = threads::map(threads, discs.collect(), screened).into_iter().collect::<Result<Vec<_>>>()?;
    let usual = usual(&own);
    let bad = own.into_iter().filter(|(_, own)| own.unlike > (BAD * usual).max(LEAST_BAD));
    let search = |(at, own): (Disc, Settled)| {
        token.check()?;
        let found = turned(mapped, at, &own, mirrored)?;
        let good = found.filter(|found| found.unlike < (GOOD * usual).max(SURELY_GOOD));
        Ok(good.map(|found| Turned { at, gain: own.unlike.powi(2) - found.unlike.powi(2), found }))
    };
    let found = threads::map(threads, bad.collect(), search).into_iter().collect::<Result<Vec<_>>>()?;
    let mut found: Vec<Turned> = found.into_iter().flatten().collect();
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    for Turned { at, found, .. } in found {
        token.check()?;
        // Another part may have brought this one along.
        let own = as_mapped(mapped, at, mirrored)?;
        if found.unlike < BETTER * own.unlike {
            let surroundings = Surroundings { middle: at.middle, middles, mirrored, usual, threads };
            take_over(mapped, surroundings, &own, &found)?;
        }
    }
    Ok(())
}

/// What parts that fit leave: a tenth leave less.
fn usual(own: &[(Disc, Settled)]) -> f64 {
    let mut unlike: Vec<f64> = own.iter().map(|(_, own)| own.unlike).collect();
    unlike.sort_by(f64::total_cmp);
    unlike[unlike.len() / 10]
}

/// The motion of the map itself.
fn as_mapped(mapped: &Mapped, disc: Disc, mirrored: bool) -> Result<Settled> {
    let places = mapped.places(&mapped.members(disc.middle, disc.radius), POINTS);
    let near = places.iter().map(|place| place.partner).collect();
    settle(mapped, Motion::between(&places, mirrored), &places, near, ROUNDS, COARSE)
}

/// The turned motion that fits best, if it fits much better than the map's.
fn turned(mapped: &Mapped, disc: Disc, own: &Settled, mirrored: bool) -> Result<Option<Settled>> {
    let members = mapped.members(disc.middle, disc.radius);
    let (places, few) = (mapped.places(&members, POINTS), mapped.places(&members, FEW_POINTS));
    let images: Vec<u32> = places.iter().map(|place| place.partner).collect();
    let start = Motion::between(&places, mirrored);
    let from = |motion: Motion, places: &[Place], rounds: usize, step: Approach| {
        let near = seeds(mapped, &motion, places, &images);
        settle(mapped, motion, places, near, rounds, step)
    };
    let looks = turns(&start, &places).into_iter().map(|motion| from(motion, &few, FEW_ROUNDS, COARSE));
    let mut looks = looks.collect::<Result<Vec<Settled>>>()?;
    looks.sort_by(|a, b| a.unlike.total_cmp(&b.unlike));
    let mut apart: Vec<Motion> = Vec::new();
    for look in looks {
        if apart.iter().all(|other| other.angle_to(&look.motion) > SAME_TURN) {
            apart.push(look.motion);
        }
    }
    let fitted = apart.into_iter().take(FITTED_TURNS).map(|motion| from(motion, &places, ROUNDS, COARSE));
    let fitted = fitted.collect::<Result<Vec<Settled>>>()?;
    let least = fitted.iter().fold(f64::INFINITY, |least, fit| least.min(fit.unlike));
    if least > BETTER * own.unlike {
        return Ok(None);
    }
    let turn = |fit: &Settled| start.angle_to(&fit.motion);
    let as_good = fitted.into_iter().filter(|fit| fit.unlike <= AS_GOOD * least);
    let best = as_good.min_by(|a, b| turn(a).total_cmp(&turn(b)));
    best.map(|best| from(best.motion, &places, ROUNDS, FINE)).transpose()
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

/// For each place the one of `vertices` most like where the motion puts it.
pub(super) fn seeds(mapped: &Mapped, motion: &Motion, places: &[Place], vertices: &[u32]) -> Vec<u32> {
    places.iter().map(|place| mapped.most_alike(motion.of_oriented(place.own), vertices)).collect()
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
    let (mut squares, mut weights) = (0.0, 0.0);
    for (place, near) in places.iter().zip(near) {
        let goal = motion.of_oriented(place.own);
        squares += place.weight * mapped.unlike_near(goal, mapped.alike(goal, near).0);
        weights += place.weight;
    }
    Ok(Settled { motion, unlike: (squares / weights).sqrt() })
}
