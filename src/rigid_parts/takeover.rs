//! A turned part's motion takes over from the map, as far as the surface around it agrees.
//!
//! Small parts around it are fitted by both motions: those that the new one fits better follow it, those that the old one fits better
//! keep it, and between them, as along a round neck, where both fit, the motions pass into each other by a turn that grows with the way. That must leave the
//! rest of the surface in one piece, since what is turned is the end of a limb, and must make a better map of the surroundings: one that
//! stretches, tears and turns inside out much less of them.

use super::mapped::{Disc, Mapped, Sought};
use super::motion::{Approach, Motion, Oriented, Place, mean};
use super::turned_parts::{seeds, settle};
use crate::embedded_triangles::TrianglePoint;
use crate::error::Result;
use crate::mesh::vector::Vector;
use crate::progress::CancelToken;
use crate::threads;

/// Radius of the small parts along edges, in sqrt(area), and how many they are all over the surface.
const SMALL_RADIUS: f64 = 0.1;
const SMALL_PARTS: usize = 300;
/// How far the surroundings reach along edges, in sqrt(area).
const REACH: f64 = 0.4;
/// Points that a small part's motion is fitted to, and points around all in which images are sought.
const POINTS: usize = 60;
const SOUGHT_POINTS: usize = 300;
const OWN_ROUNDS: usize = 4;
const NEW_ROUNDS: usize = 2;
const OWN: Approach = Approach { lever: SMALL_RADIUS, noise: 0.003, held: 0.02 };
const NEW: Approach = Approach { lever: SMALL_RADIUS, noise: 0.003, held: 0.01 };
/// A small part follows the new motion if that leaves this share of what the old one does, and keeps the old one if the new one leaves
/// this many times as much.
const FOLLOWS: f64 = 0.7;
const KEEPS: f64 = 1.4;
/// The new motion fits a small part if it leaves at most this many times what is usual, or at most this, in sqrt(area), and
/// does not from this many times that.
const FITS: f64 = 2.0;
const SURELY_FITS: f64 = 0.025;
const MISFITS: f64 = 1.25;
/// Share of the surface that may be cut off from the rest.
const CUT_OFF: f64 = 0.03;

/// Where a part is turned.
#[derive(Clone, Copy)]
pub(super) struct Surroundings {
    /// The part's middle.
    pub middle: u32,
    pub mirrored: bool,
    /// What parts that fit leave, in sqrt(area).
    pub usual: f64,
    /// Share of their strain that the new map may leave.
    pub strain_left: f64,
    pub threads: usize,
}

/// Small parts all over the surface, and how the map moves each, once asked for.
pub(super) struct SmallParts {
    discs: Vec<Disc>,
    as_mapped: Vec<Option<SmallPart>>,
}

/// How the map moves a small part.
struct SmallPart {
    places: Vec<Place>,
    /// Mean position.
    centre: Vector,
    motion: Motion,
    /// What it leaves once it is brought to the surface, in sqrt(area).
    left: f64,
}

impl SmallParts {
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(mapped: &Mapped, threads: usize, token: &CancelToken) -> Result<SmallParts> {
        let discs = super::discs(mapped, SMALL_RADIUS, SMALL_PARTS, threads, token)?;
        Ok(SmallParts { as_mapped: discs.iter().map(|_| None).collect(), discs })
    }

    /// The parts whose middle is `near`, each with how the map moves it.
    fn around(
        &mut self,
        mapped: &Mapped,
        near: &[bool],
        mirrored: bool,
        threads: usize,
    ) -> Result<Vec<(&Disc, &SmallPart)>> {
        let is_near = |disc: &Disc| near[disc.middle as usize];
        let missing = |index: &usize| self.as_mapped[*index].is_none() && is_near(&self.discs[*index]);
        let missing = (0..self.discs.len()).filter(missing).collect();
        let fit =
            |index: usize| SmallPart::new(mapped, &self.discs[index], mirrored).map(|part| (index, part));
        for fitted in threads::map(threads, missing, fit) {
            let (index, part) = fitted?;
            self.as_mapped[index] = Some(part);
        }
        let parts = self.discs.iter().zip(&self.as_mapped);
        Ok(parts
            .filter(|(disc, _)| is_near(disc))
            .filter_map(|(disc, part)| Some((disc, part.as_ref()?)))
            .collect())
    }

    /// To be called when the map changes.
    fn forget(&mut self) {
        self.as_mapped.fill_with(|| None);
    }
}

impl SmallPart {
    fn new(mapped: &Mapped, disc: &Disc, mirrored: bool) -> Result<SmallPart> {
        let places = mapped.places(&mapped.picked(&disc.members, POINTS));
        let motion = Motion::between(&places, mirrored);
        let partners = places.iter().map(|place| place.partner).collect();
        let left = settle(mapped, motion, &places, partners, OWN_ROUNDS, OWN)?.unlike;
        let weights: Vec<f64> = places.iter().map(|place| place.weight).collect();
        let centre = mean(places.iter().map(|place| place.own.position), &weights);
        Ok(SmallPart { places, centre, motion, left })
    }
}

/// What the fits say about a small part.
#[derive(Clone, Copy, PartialEq)]
enum Verdict {
    Follows,
    Keeps,
    Either,
}

/// A small part and its two motions.
struct Part<'a> {
    disc: &'a Disc,
    /// Mean position.
    centre: Vector,
    own: Motion,
    new: Motion,
    /// What the new motion leaves as a share of what the own one does.
    left: f64,
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

/// Maps what a part's new motion fits by it, if that makes a better map of the surroundings; returns whether it does.
///
/// # Errors
/// [`crate::Error::Internal`].
pub(super) fn take_over(
    mapped: &mut Mapped,
    small: &mut SmallParts,
    surroundings: Surroundings,
    found: &Motion,
) -> Result<bool> {
    let around = mapped.within(&[surroundings.middle], REACH);
    let evenly: Vec<(u32, f64)> = around.iter().map(|&(vertex, _)| (vertex, 1.0)).collect();
    let sought = mapped.sought(&mapped.places(&mapped.picked(&evenly, SOUGHT_POINTS)));
    let mut near = vec![false; mapped.areas.len()];
    around.iter().for_each(|&(vertex, _)| near[vertex as usize] = true);
    let small_around = small.around(mapped, &near, surroundings.mirrored, surroundings.threads)?;
    let parts = parts(mapped, surroundings, small_around, &sought, found)?;
    let goals = goals(mapped, &parts, &around);
    let region = grown(mapped, surroundings.middle, &goals);
    if cut_off(mapped, &region) > CUT_OFF {
        return Ok(false);
    }
    let images = images(mapped, &mapped.within(&region, SMALL_RADIUS), &goals, &sought, surroundings.threads);
    let before = mapped.strain(&near, surroundings.mirrored);
    let replaced: Vec<_> =
        images.into_iter().map(|(vertex, image)| (vertex, mapped.replace(vertex, image))).collect();
    if mapped.strain(&near, surroundings.mirrored) > surroundings.strain_left * before {
        for (vertex, image) in replaced {
            mapped.replace(vertex, image);
        }
        return Ok(false);
    }
    small.forget();
    Ok(true)
}

/// Images at their goals, of those of the vertices that the new motion has a say in.
fn images(
    mapped: &Mapped,
    vertices: &[(u32, f64)],
    goals: &[Goal],
    sought: &Sought,
    threads: usize,
) -> Vec<(usize, (u32, TrianglePoint))> {
    let changed =
        vertices.iter().map(|&(vertex, _)| vertex).filter(|&vertex| goals[vertex as usize].new > 0.0);
    let changed: Vec<u32> = changed.collect();
    let at: Vec<Oriented> =
        changed.iter().map(|&vertex| goals[vertex as usize].at(mapped.oriented(vertex))).collect();
    let starts = sought.most_alike(&at);
    let image = |index: usize| {
        let start = mapped.alike(at[index], starts[index]).0;
        (changed[index] as usize, mapped.walk.nearest(at[index].position, start))
    };
    threads::map(threads, (0..changed.len()).collect(), image)
}

/// The small parts around, with what both motions make of them.
fn parts<'a>(
    mapped: &Mapped,
    Surroundings { usual, threads, .. }: Surroundings,
    small: Vec<(&'a Disc, &SmallPart)>,
    sought: &Sought,
    found: &Motion,
) -> Result<Vec<Part<'a>>> {
    let judged = |(disc, SmallPart { places, centre, motion, left }): (&'a Disc, &SmallPart)| {
        let new = settle(mapped, *found, places, seeds(found, places, sought), NEW_ROUNDS, NEW)?;
        let fits = (FITS * usual).max(SURELY_FITS);
        let verdict = if new.unlike < FOLLOWS * left && new.unlike < fits {
            Verdict::Follows
        } else if new.unlike > KEEPS * left || new.unlike > MISFITS * fits {
            Verdict::Keeps
        } else {
            Verdict::Either
        };
        Ok(Part { disc, centre: *centre, own: *motion, new: new.motion, left: new.unlike / left, verdict })
    };
    threads::map(threads, small, judged).into_iter().collect()
}

/// Where the parts' motions, each as far as it takes over, put each vertex.
fn goals(mapped: &Mapped, parts: &[Part], around: &[(u32, f64)]) -> Vec<Goal> {
    let mut goals = vec![Goal::default(); mapped.areas.len()];
    let following = parts.iter().filter(|part| part.verdict == Verdict::Follows);
    // All turn the same way around.
    let Some(surest) = following.clone().min_by(|a, b| a.left.total_cmp(&b.left)) else { return goals };
    let axis = surest.own.axis_to(&surest.new);
    let to_new = distances(mapped, following.map(|part| part.disc.middle));
    let keeping = parts.iter().filter(|part| part.verdict == Verdict::Keeps).map(|part| part.disc.middle);
    let rim = around
        .iter()
        .filter(|(_, distance)| *distance > REACH - SMALL_RADIUS / 4.0)
        .map(|&(vertex, _)| vertex);
    let to_old = distances(mapped, keeping.chain(rim));
    for part in parts {
        let [from_old, from_new] = [&to_old, &to_new].map(|way| way[part.disc.middle as usize]);
        let share = match part.verdict {
            Verdict::Follows => 1.0,
            Verdict::Keeps => 0.0,
            Verdict::Either => from_old / (from_old + from_new),
        };
        let motion = part.own.part_way(&part.new, share, part.centre, axis);
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

/// Vertices that follow the new motion and are joined to the middle by others that do.
fn grown(mapped: &Mapped, middle: u32, goals: &[Goal]) -> Vec<u32> {
    let mut reached = vec![false; goals.len()];
    reached[middle as usize] = true;
    joined(mapped, middle, &mut reached, |vertex| goals[vertex as usize].follows())
}

/// Share of the area that hangs together no more with most of the surface once `region` is taken out.
fn cut_off(mapped: &Mapped, region: &[u32]) -> f64 {
    let area =
        |vertices: &[u32]| -> f64 { vertices.iter().map(|&vertex| mapped.areas[vertex as usize]).sum() };
    let mut reached = vec![false; mapped.areas.len()];
    region.iter().for_each(|&vertex| reached[vertex as usize] = true);
    let (mut rest, mut largest) = (0.0, 0.0f64);
    for vertex in 0..mapped.areas.len() as u32 {
        if !std::mem::replace(&mut reached[vertex as usize], true) {
            let piece = area(&joined(mapped, vertex, &mut reached, |_| true));
            rest += piece;
            largest = largest.max(piece);
        }
    }
    (rest - largest) / (rest + area(region))
}

/// `first` and what is joined to it along edges through vertices `through` which that goes and that were not `reached`.
fn joined(mapped: &Mapped, first: u32, reached: &mut [bool], through: impl Fn(u32) -> bool) -> Vec<u32> {
    let mut joined = vec![first];
    let mut next = 0;
    while let Some(&vertex) = joined.get(next) {
        for &near in mapped.graph.of(vertex as usize) {
            if through(near) && !std::mem::replace(&mut reached[near as usize], true) {
                joined.push(near);
            }
        }
        next += 1;
    }
    joined
}
