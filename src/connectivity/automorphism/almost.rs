//! The only pairing of a shell whose connectivity is mirrored but for a few defects, where no estimate helps.
//!
//! Seeds are those of [`super::partial`], in classes of at most three vertices. The first patch that holds nearly all
//! vertices of the shell, and most of its irregular ones, is the pairing; none is where the same vertices can be sent elsewhere and nearly all
//! of the shell follows, too, as in a box with two mirror planes.

use super::matching::{Mark, Matching};
use super::partial::{
    Context, FAILURES, SMALLEST_SHELL, TRIAL_FACES, drop_rings_at_contradictions, is_repeated,
    most_common_valence, score_of_trial, seeds,
};
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::mesh::NONE;

/// Least share of a shell, and of its irregular vertices, to be paired: a defect makes some of these.
const COVERED: f64 = 0.9;
const COVERED_IRREGULAR: f64 = 0.7;
/// Fewest irregular vertices of a shell of which defects may leave some unpaired.
const IRREGULAR: usize = 32;
/// Least share of vertices with a lookalike: a defect takes it from all within some rings, and from their partners.
pub(super) const REPEATED: f64 = 0.2;
/// Seeds of which every other image is tried.
const RIVAL_SEEDS: usize = 4;

/// Votes of the vertices that are paired by their neighbours: from the first on down to the second.
const MOST_VOTES: usize = 6;
const LEAST_VOTES: usize = 2;

/// A shell, and which of its vertices are irregular.
struct Shell<'a> {
    context: &'a Context<'a>,
    vertices: &'a [u32],
    regular: u64,
    irregular: usize,
}

/// Pairs the vertices of a shell that nothing is paired of yet; says whether there is such a pairing. The classes of `context` are those by
/// far surroundings, in which a vertex away from defects has few lookalikes but its partner. O(size of the shell).
pub(super) fn match_shell(
    matching: &mut Matching,
    context: &Context,
    shell: usize,
    progress: &Progress,
) -> Result<bool> {
    let shell = Shell::new(context, shell);
    let (vertices, irregular) = (shell.vertices, shell.irregular);
    if vertices.len() < SMALLEST_SHELL
        || irregular < IRREGULAR
        || !is_repeated(context.classes, vertices, REPEATED)
    {
        return Ok(false);
    }
    let seeds = seeds(matching, context, vertices, progress)?;
    let before = matching.mark();
    for &(_, start, target) in seeds.iter().take(FAILURES) {
        progress.check()?;
        matching.grow(start, target, context.valences, usize::MAX);
        if shell.is_nearly_paired(matching, before) {
            if shell.has_rival(matching, &seeds, progress)? {
                break;
            }
            drop_rings_at_contradictions(matching, before);
            pair_by_neighbours(matching, vertices);
            return Ok(true);
        }
        matching.rollback(before);
    }
    matching.rollback(before);
    Ok(false)
}

impl<'a> Shell<'a> {
    fn new(context: &'a Context, shell: usize) -> Self {
        let vertices = context.shells.vertices(shell);
        let regular = most_common_valence(context, vertices);
        let irregular =
            vertices.iter().filter(|&&vertex| context.valences[vertex as usize] != regular).count();
        Shell { context, vertices, regular, irregular }
    }

    fn is_nearly_paired(&self, matching: &Matching, since: Mark) -> bool {
        let paired = matching.paired_since(since);
        let is_irregular = |&&vertex: &&u32| self.context.valences[vertex as usize] != self.regular;
        let irregular = paired.iter().filter(is_irregular).count();
        paired.len() as f64 >= COVERED * self.vertices.len() as f64
            && irregular as f64 >= COVERED_IRREGULAR * self.irregular as f64
    }

    /// Whether nearly all of the shell can be paired in another way, too, that starts at one of the seeds.
    fn has_rival(&self, matching: &Matching, seeds: &[(u32, u32, u32)], progress: &Progress) -> Result<bool> {
        let mut other = Matching::new(matching.half_edges, matching.kind());
        let start = other.mark();
        for &(vertex, ..) in seeds.iter().take(RIVAL_SEEDS) {
            for &image in self.context.classes.members(vertex) {
                progress.check()?;
                for (half_edge, target) in other.seeds(vertex, image) {
                    if matching.image_of(half_edge) == target {
                        continue;
                    }
                    let faces = other.grow(half_edge, target, self.context.valences, TRIAL_FACES);
                    let promises = 2 * score_of_trial(&other, start, faces) >= faces;
                    other.rollback(start);
                    if !promises {
                        continue;
                    }
                    other.grow(half_edge, target, self.context.valences, usize::MAX);
                    let differs = |&&vertex: &&u32| {
                        other.vertex_image[vertex as usize] != matching.vertex_image[vertex as usize]
                    };
                    let elsewhere = other.paired_since(start).iter().filter(differs).count();
                    if self.is_nearly_paired(&other, start) && 2 * elsewhere > self.vertices.len() {
                        return Ok(true);
                    }
                    other.rollback(start);
                }
            }
        }
        Ok(false)
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
