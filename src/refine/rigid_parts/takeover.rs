//! A turned part's motion takes over from the map, as far as the surface around it agrees.
//!
//! Small parts around it are fitted by both motions: those that the new one fits better follow it, those that the old one fits better
//! keep it, and between them, as along a round neck, where both fit, the motions pass into each other by a turn that grows with the way. That must leave the
//! rest of the surface in one piece, since what is turned is the end of a limb, and must make a better map of the surroundings: one that
//! stretches, tears and turns inside out much less of them.

use super::mapped::{Disc, Mapped, Sought};
use super::motion::{Approach, Motion, Oriented, mean};
use super::turned_parts::{BETTER, seeds, settle};
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::base::threads;
use crate::mesh::vector::Vector;

/// Radius of the small parts, in sqrt(area).
pub(super) const SMALL_RADIUS: f64 = 0.1;
/// How far the surroundings reach along edges, in sqrt(area).
const REACH: f64 = 0.4;
/// Points around all in which images are sought.
const SOUGHT_POINTS: usize = 300;
/// How the map's motion of a small part and the new one are brought to the surface.
const OWN: Approach = Approach { rounds: 4, noise: 0.003, held: 0.02, free: true };
const NEW: Approach = Approach { rounds: 2, noise: 0.003, held: 0.01, free: true };
/// A small part follows the motion that leaves this share of what the other one does.
const FOLLOWS: f64 = 0.7;
/// Share of the surface that may be cut off from the rest.
const CUT_OFF: f64 = 0.03;

/// Small parts all over the surface.
pub(super) struct SmallParts<'a> {
    /// Their middles.
    pub middles: &'a [u32],
    /// Points of each that motions are fitted to.
    pub points: usize,
    pub mirrored: bool,
}

/// What the fits say about a small part.
#[derive(Clone, Copy, PartialEq)]
enum Verdict {
    Follows,
    Keeps,
    Either,
}

/// A small part and its two motions.
struct MovingPart {
    disc: Disc,
    /// Mean position.
    centre: Vector,
    own: Motion,
    new: Motion,
    verdict: Verdict,
}

/// What a vertex's small parts say.
#[derive(Clone, Default)]
struct Goal {
    sum: Vector,
    weight: f64,
    /// Weight of the new motion.
    new: f64,
    /// The part that says most, and its weight.
    strongest: Option<(Motion, f64)>,
}

impl SmallParts<'_> {
    /// The parts whose middle is `near`, with what the map's motion and the one that was `found` make of them.
    fn around(
        &self,
        mapped: &Mapped,
        near: &[bool],
        sought: &Sought,
        found: &Motion,
        threads: usize,
        progress: &Progress,
    ) -> Result<Vec<MovingPart>> {
        let middles = self.middles.iter().copied().filter(|&middle| near[middle as usize]);
        let middles: Vec<u32> = middles.collect();
        let discs = mapped.discs_along_edges(&middles, &[SMALL_RADIUS], threads, progress)?;
        let judged = |disc: Disc| {
            let places = mapped.places(&mapped.picked(&disc.members, self.points));
            let own = Motion::between(&places, self.mirrored);
            let partners = places.iter().map(|place| place.partner).collect();
            let new = settle(mapped, *found, &places, seeds(found, &places, sought), NEW);
            let left = new.unlike / settle(mapped, own, &places, partners, OWN).unlike;
            let verdict = match left {
                _ if left < FOLLOWS => Verdict::Follows,
                _ if FOLLOWS * left > 1.0 => Verdict::Keeps,
                _ => Verdict::Either,
            };
            let centre = mean(places.iter().map(|place| (place.own.position, place.weight)));
            MovingPart { disc, centre, own, new: new.motion, verdict }
        };
        Ok(threads::map(threads, discs, judged))
    }
}

/// Maps what a part's new motion fits by it, if that makes a better map of the surroundings of its `middle`.
///
/// # Errors
/// Those of [`Progress::check`].
pub(super) fn take_over(
    mapped: &mut Mapped,
    small: &SmallParts,
    middle: u32,
    found: &Motion,
    threads: usize,
    progress: &Progress,
) -> Result<()> {
    let around = mapped.within(&[middle], REACH);
    let evenly: Vec<(u32, f64)> = around.iter().map(|&(vertex, _)| (vertex, 1.0)).collect();
    let sought = mapped.sought(&mapped.places(&mapped.picked(&evenly, SOUGHT_POINTS)));
    let mut near = vec![false; mapped.areas.len()];
    around.iter().for_each(|&(vertex, _)| near[vertex as usize] = true);
    let parts = small.around(mapped, &near, &sought, found, threads, progress)?;
    let goals = goals(mapped, &parts, &around);
    let region =
        mapped.joined(middle, &mut vec![false; goals.len()], |vertex| goals[vertex as usize].follows());
    if cut_off(mapped, &region) > CUT_OFF {
        return Ok(());
    }
    let changed = mapped.within(&region, SMALL_RADIUS).into_iter().map(|(vertex, _)| vertex);
    let changed: Vec<u32> = changed.filter(|&vertex| goals[vertex as usize].new > 0.0).collect();
    let images = images(mapped, &changed, &goals, &sought, threads);
    let before = mapped.distortion(&near, small.mirrored);
    let former = mapped.replaced(&changed, images);
    if mapped.distortion(&near, small.mirrored) > BETTER * before {
        mapped.replaced(&changed, former);
    }
    Ok(())
}

/// Partners and images of the vertices at their goals.
fn images(
    mapped: &Mapped,
    changed: &[u32],
    goals: &[Goal],
    sought: &Sought,
    threads: usize,
) -> Vec<(u32, Vector)> {
    let at = changed.iter().map(|&vertex| goals[vertex as usize].at(mapped.oriented(vertex)));
    let at: Vec<Oriented> = at.collect();
    let starts = sought.most_alike(at.iter().copied());
    let image = |(goal, start): (Oriented, u32)| {
        let (partner, point) = mapped.walk.nearest(goal.position, mapped.alike(goal, start).0);
        (partner, point.interpolate_vectors(&mapped.shell.triangles, &mapped.shell.positions))
    };
    threads::map(threads, at.into_iter().zip(starts).collect(), image)
}

/// Where the parts' motions, each as far as it takes over, put each vertex.
fn goals(mapped: &Mapped, parts: &[MovingPart], around: &[(u32, f64)]) -> Vec<Goal> {
    let mut goals = vec![Goal::default(); mapped.areas.len()];
    let middles = |verdict: Verdict| {
        parts.iter().filter(move |part| part.verdict == verdict).map(|part| part.disc.middle)
    };
    if middles(Verdict::Follows).next().is_none() {
        return goals;
    }
    let to_new = distances(mapped, middles(Verdict::Follows));
    let rim = around
        .iter()
        .filter(|(_, distance)| *distance > REACH - SMALL_RADIUS / 4.0)
        .map(|&(vertex, _)| vertex);
    let to_old = distances(mapped, middles(Verdict::Keeps).chain(rim));
    for part in parts {
        let [from_old, from_new] = [&to_old, &to_new].map(|way| way[part.disc.middle as usize]);
        let share = match part.verdict {
            Verdict::Follows => 1.0,
            Verdict::Keeps => 0.0,
            Verdict::Either => from_old / (from_old + from_new),
        };
        let motion = part.own.part_way(&part.new, share, part.centre);
        for &(vertex, weight) in &part.disc.members {
            goals[vertex as usize].add(
                motion,
                motion.of(mapped.shell.positions[vertex as usize]),
                weight,
                share,
            );
        }
    }
    goals
}

impl Goal {
    fn add(&mut self, motion: Motion, position: Vector, weight: f64, share: f64) {
        (0..3).for_each(|axis| self.sum[axis] += weight * position[axis]);
        self.weight += weight;
        self.new += weight * share;
        if self.strongest.is_none_or(|(_, strongest)| strongest < weight) {
            self.strongest = Some((motion, weight));
        }
    }

    /// Whether the new motion has more to say than the old one.
    fn follows(&self) -> bool {
        self.new > 0.5 * self.weight
    }

    /// Where the image should lie, and its normal.
    fn at(&self, own: Oriented) -> Oriented {
        let normal = self.strongest.map_or(own.normal, |(motion, _)| motion.of_oriented(own).normal);
        Oriented { position: self.sum.map(|x| x / self.weight), normal }
    }
}

/// Distance of each vertex along edges from the nearest of `sources`; twice the reach where it is more.
fn distances(mapped: &Mapped, sources: impl Iterator<Item = u32>) -> Vec<f64> {
    let mut distances = vec![2.0 * REACH; mapped.areas.len()];
    for (vertex, distance) in mapped.within(&sources.collect::<Vec<u32>>(), 2.0 * REACH) {
        distances[vertex as usize] = distance;
    }
    distances
}

/// Share of the area that hangs together no more with most of the surface once `region` is taken out.
fn cut_off(mapped: &Mapped, region: &[u32]) -> f64 {
    let area =
        |vertices: &[u32]| -> f64 { vertices.iter().map(|&vertex| mapped.areas[vertex as usize]).sum() };
    let mut reached = vec![false; mapped.areas.len()];
    region.iter().for_each(|&vertex| reached[vertex as usize] = true);
    let (mut rest, mut largest) = (0.0, 0.0f64);
    for vertex in 0..mapped.areas.len() as u32 {
        if !reached[vertex as usize] {
            let piece = area(&mapped.joined(vertex, &mut reached, |_| true));
            rest += piece;
            largest = largest.max(piece);
        }
    }
    (rest - largest) / (rest + area(region))
}
