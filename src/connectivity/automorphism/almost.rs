//! The only pairing of most of a shell: its connectivity is mirrored but for defects, a split edge or some flipped triangles, and for parts without a counterpart.
//!
//! Patches grow from the seeds whose surroundings fit best, over all pairs of faces with equal degrees and equal valences at their corners. The ring of faces at each
//! contradiction is dropped. The first patch that holds most vertices of the shell, and meets few contradictions, is the pairing; several together are where a cut parts the
//! shell. Where the same vertices can be sent elsewhere and most of the shell follows, too, as in a box with two mirror planes, or in a body whose front is its back but
//! for the nose, shape decides.

use super::colours::Classes;
use super::estimate::Estimate;
use super::matching::{Mark, Matching};
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::geometry::adjacency::LOOKS;
use crate::mesh::NONE;
use std::collections::HashMap;

/// Seeds per shell.
const SEEDS: usize = 64;
/// Most images tried per seed.
const SEED_IMAGES: usize = 8;
/// Faces of the trial around a seed.
const TRIAL_FACES: usize = 200;
/// Failed full growths of a shell before giving up.
const FAILURES: usize = 8;
/// Least share of a shell to be paired.
const COVERED: f64 = 0.6;
/// Vertices that each contradicted face counts for.
const CONTRADICTION: f64 = 4.0;
/// Fewest faces of a patch for each that contradicts it.
const FEW: usize = 8;
/// Most pairings that are looked at.
const MOST_PAIRINGS: usize = 4;
/// Fewest irregular vertices of a shell of which defects may leave some unpaired: fewer have too little to tell a pairing from chance.
const IRREGULAR: usize = 32;
/// Least share of vertices with a lookalike: a defect takes it from all within some rings, and from their partners.
pub(super) const REPEATED: f64 = 0.2;
/// Seeds of which every other image is tried.
const RIVAL_SEEDS: usize = 4;

/// Votes of the vertices that are paired by their neighbours: from the first on down to the second.
const MOST_VOTES: usize = 6;
const LEAST_VOTES: usize = 2;

/// What the growth reads.
pub(super) struct Context<'a> {
    /// The vertices of the shell.
    pub vertices: &'a [u32],
    pub estimate: &'a Estimate,
    /// Colours by valence, face degrees and boundary.
    pub valences: &'a [u64],
    /// Classes by surroundings: lookalikes are each other's possible images.
    pub classes: &'a Classes,
}

/// A pairing, and the pairs of half-edges at which its patches start.
type Pairing<'a> = (Matching<'a>, Vec<(u32, u32)>);

/// Pairs the vertices of a shell that nothing is paired of yet; says whether there is such a pairing. The classes of `context` are those by
/// far surroundings, in which a vertex away from defects has few lookalikes but its partner. Of several pairings it is the one that `agrees`, if no other does.
/// O(size of the shell).
pub(super) fn match_shell(
    matching: &mut Matching,
    context: &Context,
    agrees: impl Fn(&Matching, &[u32]) -> bool,
    progress: &Progress,
) -> Result<bool> {
    if !context.has_irregular() || !context.is_repeated() {
        return Ok(false);
    }
    let seeds = seeds(matching, context, progress)?;
    let mut found = context.pairings(matching, &seeds, progress)?;
    let is_sure = found.len() == 1 && found[0].1.len() == 1;
    found.retain(|(pairing, _)| is_sure || agrees(pairing, context.vertices));
    let [(_, starts)] = &found[..] else { return Ok(false) };
    let before = matching.mark();
    for &(from, to) in starts {
        matching.grow(from, to, context.valences, usize::MAX);
    }
    drop_rings_at_contradictions(matching, before);
    pair_by_neighbours(matching, context.vertices);
    Ok(true)
}

impl Context<'_> {
    /// Whether many vertices have another valence than most have.
    fn has_irregular(&self) -> bool {
        let mut counts = HashMap::new();
        for &vertex in self.vertices {
            *counts.entry(self.valences[vertex as usize]).or_insert(0usize) += 1;
        }
        self.vertices.len() - counts.into_values().max().unwrap_or(0) >= IRREGULAR
    }

    /// Whether enough vertices have a lookalike at all; on meshes without mirrored connectivity few do.
    fn is_repeated(&self) -> bool {
        let has_lookalike = |&&vertex: &&u32| self.classes.members(vertex).len() > 1;
        let repeated = self.vertices.iter().filter(has_lookalike).count();
        repeated as f64 >= REPEATED * self.vertices.len() as f64
    }

    /// Whether what grew since a mark is most of the shell, and met few contradictions for that.
    fn is_nearly_paired(&self, matching: &Matching, since: Mark) -> bool {
        let paired = matching.paired_since(since);
        let against = CONTRADICTION * contradicted_faces(matching, since) as f64;
        paired.len() as f64 - against >= COVERED * self.vertices.len() as f64
    }

    /// The first pairing of nearly all of the shell that starts at one of the seeds, or at several where a cut parts it, and those that send most vertices elsewhere; each with its starts.
    fn pairings<'m>(
        &self,
        matching: &Matching<'m>,
        seeds: &[(u32, u32, u32)],
        progress: &Progress,
    ) -> Result<Vec<Pairing<'m>>> {
        let mut found: Vec<Pairing> = Vec::new();
        let empty = || Matching::new(matching.half_edges, matching.kind());
        let mut trial = empty();
        let start = trial.mark();
        let (mut starts, mut failures) = (Vec::new(), 0);
        for &(vertex, from, to) in seeds {
            progress.check()?;
            if failures == FAILURES {
                break;
            }
            if trial.vertex_image[vertex as usize] != NONE {
                continue;
            }
            let mark = trial.mark();
            let faces = trial.grow(from, to, self.valences, usize::MAX);
            if FEW * contradicted_faces(&trial, mark) > faces {
                trial.rollback(mark);
                failures += 1;
                continue;
            }
            starts.push((from, to));
            if self.is_nearly_paired(&trial, start) {
                found.push((std::mem::replace(&mut trial, empty()), std::mem::take(&mut starts)));
                break;
            }
        }
        trial.rollback(start);
        if found.is_empty() {
            return Ok(found);
        }
        for &(vertex, ..) in seeds.iter().take(RIVAL_SEEDS) {
            for &image in self.classes.members(vertex) {
                progress.check()?;
                for (from, to) in trial.seeds(vertex, image) {
                    if found.len() == MOST_PAIRINGS || found.iter().any(|known| known.0.image_of(from) == to)
                    {
                        continue;
                    }
                    let faces = trial.grow(from, to, self.valences, TRIAL_FACES);
                    let promises = 2 * score_of_trial(&trial, start, faces) >= faces;
                    trial.rollback(start);
                    if !promises {
                        continue;
                    }
                    trial.grow(from, to, self.valences, usize::MAX);
                    let is_new = self.is_nearly_paired(&trial, start)
                        && found.iter().all(|known| self.is_elsewhere(&trial, start, &known.0));
                    if is_new {
                        found.push((std::mem::replace(&mut trial, empty()), vec![(from, to)]));
                    }
                    trial.rollback(start);
                }
            }
        }
        Ok(found)
    }

    /// Whether what is paired since a mark sends as many vertices elsewhere than another pairing does as make half of the shell.
    fn is_elsewhere(&self, matching: &Matching, since: Mark, other: &Matching) -> bool {
        let differs =
            |&&vertex: &&u32| matching.vertex_image[vertex as usize] != other.vertex_image[vertex as usize];
        2 * matching.paired_since(since).iter().filter(differs).count() > self.vertices.len()
    }
}

/// Pairs vertices that are left over with what most of their neighbours' images are next to, those with most votes first, until
/// nothing changes. A vertex that a defect adds has no such partner.
fn pair_by_neighbours(matching: &mut Matching, vertices: &[u32]) {
    let mut left: Vec<u32> = vertices.to_vec();
    let mut least = MOST_VOTES;
    while least >= LEAST_VOTES {
        left.retain(|&vertex| matching.vertex_image[vertex as usize] == NONE);
        let mut changed = false;
        for &vertex in &left {
            let Some(partner) = most_voted(matching, vertex, least) else { continue };
            if most_voted(matching, partner, least) == Some(vertex) {
                matching.pair(vertex, partner);
                changed = true;
            }
        }
        least = if changed { MOST_VOTES } else { least - 1 };
    }
}

/// What is free and next to the images of more of a free vertex's neighbours, `least` or more, than anything else that is free.
fn most_voted(matching: &Matching, vertex: u32, least: usize) -> Option<u32> {
    let around = |vertex: u32| {
        let half_edges = matching.half_edges;
        half_edges.outgoing_of(vertex).map(|half_edge| half_edges.to_vertex[half_edge as usize])
    };
    let is_free = |vertex: u32| matching.vertex_image[vertex as usize] == NONE;
    let images = around(vertex).map(|near| matching.vertex_image[near as usize]);
    let mut votes: Vec<u32> =
        images.filter(|&image| image != NONE).flat_map(around).filter(|&near| is_free(near)).collect();
    votes.sort_unstable();
    let mut counts: Vec<(usize, u32)> =
        votes.chunk_by(|a, b| a == b).map(|same| (same.len(), same[0])).collect();
    counts.sort_unstable();
    let &(most, partner) = counts.last()?;
    let next = counts.iter().rev().nth(1).map_or(0, |&(next, _)| next);
    // One that a defect adds near the fixed curve is next to the images of half of its neighbours.
    let by_most = partner != vertex || 2 * most > around(vertex).count();
    (is_free(vertex) && most >= least && next < most && by_most).then_some(partner)
}

/// Vertices with the half-edge pair whose trial growth fits best, best first.
fn seeds(matching: &mut Matching, context: &Context, progress: &Progress) -> Result<Vec<(u32, u32, u32)>> {
    let mut seeds = Vec::new();
    for region in context.vertices.chunks(context.vertices.len().div_ceil(SEEDS)) {
        progress.check()?;
        let key = |vertex: u32| {
            let size = context.classes.members(vertex).len();
            (context.estimate.weight(vertex) == 0.0, size == 1, size, -context.estimate.weight(vertex))
        };
        let lower = |&first: &u32, &second: &u32| key(first).partial_cmp(&key(second)).unwrap();
        let half_edges = matching.half_edges;
        // Each edge of a vertex is a way to turn it onto its image.
        let is_hub = |&vertex: &u32| half_edges.outgoing_of(vertex).nth(LOOKS).is_some();
        let vertex = region.iter().copied().filter(|vertex| !is_hub(vertex)).min_by(lower);
        seeds.extend(vertex.and_then(|vertex| best_trial(matching, context, vertex)));
    }
    seeds.sort_by_key(|&(score, ..)| std::cmp::Reverse(score));
    Ok(seeds.into_iter().map(|(_, vertex, start, target)| (vertex, start, target)).collect())
}

fn best_trial(matching: &mut Matching, context: &Context, vertex: u32) -> Option<(usize, u32, u32, u32)> {
    let members = context.classes.members(vertex);
    let near = context.estimate.near(matching.half_edges, vertex, context.vertices.len()).into_iter();
    let mut images: Vec<u32> =
        near.filter(|&image| context.classes.same(image, vertex)).take(SEED_IMAGES).collect();
    images.extend(members.iter().copied().filter(|_| members.len() <= 3));
    let mut best: Option<(usize, u32, u32, u32)> = None;
    for (start, target) in images.iter().flat_map(|&image| matching.seeds(vertex, image)).collect::<Vec<_>>()
    {
        let mark = matching.mark();
        let faces = matching.grow(start, target, context.valences, TRIAL_FACES);
        let score = score_of_trial(matching, mark, faces);
        matching.rollback(mark);
        if score > best.map_or(8, |(least, ..)| least) {
            best = Some((score, vertex, start, target));
        }
    }
    best
}

/// What the growth of a number of `faces` since `mark` is worth: those, less two for each that did not fit.
fn score_of_trial(matching: &Matching, mark: Mark, faces: usize) -> usize {
    faces.saturating_sub(2 * contradicted_faces(matching, mark))
}

/// Faces at which growth since `mark` stopped.
fn contradicted_faces(matching: &Matching, mark: Mark) -> usize {
    let mut faces: Vec<u32> = matching
        .refused_since(mark)
        .iter()
        .map(|&(half_edge, _)| matching.half_edges.face[half_edge as usize])
        .collect();
    faces.sort_unstable();
    faces.dedup();
    faces.len()
}

/// Unpairs the corners of faces where growing stopped, and their partners.
fn drop_rings_at_contradictions(matching: &mut Matching, since: Mark) {
    for (half_edge, image) in matching.refused_since(since).to_vec() {
        for side in [half_edge, image] {
            let whole = matching.half_edges.face[side as usize] != NONE;
            let length = if whole { usize::MAX } else { 1 };
            let corners: Vec<u32> = matching.half_edges.loop_of(side).take(length).collect();
            for corner in corners {
                matching.unpair(matching.half_edges.to_vertex[corner as usize]);
                matching.unpair(matching.half_edges.start_vertex(corner));
            }
        }
    }
}
