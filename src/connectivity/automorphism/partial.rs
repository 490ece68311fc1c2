//! Patches of a shell whose connectivity is mirrored except at defects: a split edge, a few flipped triangles.
//!
//! Patches grow from the seeds whose surroundings fit best, over all pairs of faces with equal degrees and
//! equal valences at their corners. The ring of faces at each contradiction is dropped.

use super::colours::Classes;
use super::estimate::Estimate;
use super::matching::{Mark, Matching};
use super::shells::Shells;
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::mesh::NONE;
use std::collections::HashMap;

/// Smaller shells have too little to tell a partial match from chance.
pub(super) const SMALLEST_SHELL: usize = 24;
/// Seeds per shell.
const SEEDS: usize = 64;
/// Most images tried per seed.
const SEED_IMAGES: usize = 8;
/// Most edges of a vertex at which a patch may start: each is a way to turn it onto its image.
const MOST_TURNS: usize = 64;
/// Faces of the trial around a seed.
pub(super) const TRIAL_FACES: usize = 200;
/// Failed full growths of a shell before giving up.
pub(super) const FAILURES: usize = 8;
/// What the growth reads.
pub(super) struct Context<'a> {
    pub shells: &'a Shells,
    pub estimate: &'a Estimate,
    /// Colours by valence, face degrees and boundary.
    pub valences: &'a [u64],
    /// Classes by surroundings: lookalikes are each other's possible images.
    pub classes: &'a Classes,
}

/// Whether at least such a share of vertices has a lookalike at all; on meshes without mirrored connectivity few do.
pub(super) fn is_repeated(classes: &Classes, vertices: &[u32], share: f64) -> bool {
    let repeated = vertices.iter().filter(|&&vertex| classes.members(vertex).len() > 1).count();
    repeated as f64 >= share * vertices.len() as f64
}

pub(super) fn most_common_valence(context: &Context, vertices: &[u32]) -> u64 {
    let mut counts = HashMap::new();
    for &vertex in vertices {
        *counts.entry(context.valences[vertex as usize]).or_insert(0usize) += 1;
    }
    let (valence, _) = counts.into_iter().max_by_key(|&(valence, count)| (count, valence)).expect("vertices");
    valence
}

/// Vertices with the half-edge pair whose trial growth fits best, best first.
pub(super) fn seeds(
    matching: &mut Matching,
    context: &Context,
    vertices: &[u32],
    progress: &Progress,
) -> Result<Vec<(u32, u32, u32)>> {
    let mut seeds = Vec::new();
    for region in vertices.chunks(vertices.len().div_ceil(SEEDS)) {
        progress.check()?;
        let key = |vertex: u32| {
            let size = context.classes.members(vertex).len();
            (context.estimate.weight(vertex) == 0.0, size == 1, size, -context.estimate.weight(vertex))
        };
        let lower = |&first: &u32, &second: &u32| key(first).partial_cmp(&key(second)).unwrap();
        let half_edges = matching.half_edges;
        let is_hub = |&vertex: &u32| half_edges.outgoing_of(vertex).nth(MOST_TURNS).is_some();
        let vertex = region.iter().copied().filter(|vertex| !is_hub(vertex)).min_by(lower);
        seeds.extend(vertex.and_then(|vertex| best_trial(matching, context, vertex, vertices.len())));
    }
    seeds.sort_by_key(|&(score, ..)| std::cmp::Reverse(score));
    Ok(seeds.into_iter().map(|(_, vertex, start, target)| (vertex, start, target)).collect())
}

fn best_trial(
    matching: &mut Matching,
    context: &Context,
    vertex: u32,
    shell_size: usize,
) -> Option<(usize, u32, u32, u32)> {
    let members = context.classes.members(vertex);
    let near = context.estimate.near(matching.half_edges, vertex, shell_size).into_iter();
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
pub(super) fn score_of_trial(matching: &Matching, mark: Mark, faces: usize) -> usize {
    faces.saturating_sub(2 * contradicted_faces(matching, mark))
}

/// Faces at which growth since `mark` stopped.
pub(super) fn contradicted_faces(matching: &Matching, mark: Mark) -> usize {
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
pub(super) fn drop_rings_at_contradictions(matching: &mut Matching, since: Mark) {
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
