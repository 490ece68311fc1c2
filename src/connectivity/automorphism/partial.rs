//! Pairings of shells whose connectivity is mirrored except at defects: a split edge, a few flipped triangles.
//!
//! Patches grow from the seeds whose surroundings fit best, over all pairs of faces with equal degrees and
//! equal valences at their corners. A false match is easy inside a regular grid, so a patch must pair
//! irregular vertices, must not stop at many contradictions, and must lie near the estimate; all
//! patches together must cover half of the shell and half of its irregular vertices. The ring of
//! faces at each contradiction is dropped.

use super::colours::Classes;
use super::estimate::{self, Estimate};
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
/// A patch as large as this is compared with the estimate before it grows on.
const EARLY_FACES: usize = 50_000;
/// Failed full growths per shell before giving up.
pub(super) const FAILURES: usize = 8;
/// Least number of irregular vertices paired by a patch.
const IRREGULAR: usize = 4;
/// Most contradictions of a patch per paired face.
const CONTRADICTIONS: f64 = 0.25;
/// Least share of a shell and of its irregular vertices to be covered, and of samples near the estimate.
const COVERED: f64 = 0.5;
const NEAR: f64 = 0.7;

/// What the growth reads.
pub(super) struct Context<'a> {
    pub shells: &'a Shells,
    pub estimate: &'a Estimate,
    /// Colours by valence, face degrees and boundary.
    pub valences: &'a [u64],
    /// Classes by surroundings: lookalikes are each other's possible images.
    pub classes: &'a Classes,
}

/// Pairs what it can of the shells in `which`; adds to what `matching` holds.
pub(super) fn match_shells(
    matching: &mut Matching,
    context: &Context,
    which: &[usize],
    progress: &Progress,
) -> Result<()> {
    let is_large = |shell: &&usize| context.shells.vertices(**shell).len() >= SMALLEST_SHELL;
    for &shell in which.iter().filter(is_large) {
        match_shell(matching, context, shell, progress)?;
    }
    Ok(())
}

fn match_shell(matching: &mut Matching, context: &Context, shell: usize, progress: &Progress) -> Result<()> {
    let vertices = context.shells.vertices(shell);
    if !is_repeated(context.classes, vertices, COVERED) {
        return Ok(());
    }
    let regular = most_common_valence(context, vertices);
    let before = matching.mark();
    let mut failures = 0;
    for (vertex, start, target) in seeds(matching, context, vertices, progress)? {
        progress.check()?;
        if failures == FAILURES {
            break;
        }
        if matching.vertex_image[vertex as usize] != NONE {
            continue;
        }
        let mark = matching.mark();
        let mut faces = matching.grow(start, target, context.valences, EARLY_FACES);
        if faces == EARLY_FACES && is_patch_near(matching, context, mark, vertices.len()) {
            matching.rollback(mark);
            faces = matching.grow(start, target, context.valences, usize::MAX);
        }
        if !is_patch_sound(matching, context, mark, faces, regular, vertices.len()) {
            matching.rollback(mark);
            failures += 1;
        }
    }
    drop_rings_at_contradictions(matching, before);
    if !is_shell_covered(matching, context, vertices, regular) {
        matching.rollback(before);
    }
    Ok(())
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

/// Whether the patch lies near the estimate.
fn is_patch_near(matching: &Matching, context: &Context, mark: Mark, shell_size: usize) -> bool {
    let paired = matching.paired_since(mark);
    context.estimate.distances(matching, &paired, shell_size).mean <= estimate::tolerance(shell_size)
}

fn is_patch_sound(
    matching: &Matching,
    context: &Context,
    mark: Mark,
    faces: usize,
    regular: u64,
    shell_size: usize,
) -> bool {
    let paired = matching.paired_since(mark);
    let irregular = paired.iter().filter(|&&vertex| context.valences[vertex as usize] != regular).count();
    let contradictions = contradicted_faces(matching, mark) as f64;
    irregular >= IRREGULAR
        && contradictions <= CONTRADICTIONS * faces as f64
        && is_patch_near(matching, context, mark, shell_size)
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

fn is_shell_covered(matching: &Matching, context: &Context, vertices: &[u32], regular: u64) -> bool {
    let is_paired = |vertex: u32| matching.vertex_image[vertex as usize] != NONE;
    let is_irregular = |vertex: u32| context.valences[vertex as usize] != regular;
    let paired = vertices.iter().filter(|&&vertex| is_paired(vertex)).count();
    let irregular = vertices.iter().filter(|&&vertex| is_irregular(vertex)).count();
    let both = vertices.iter().filter(|&&vertex| is_paired(vertex) && is_irregular(vertex)).count();
    paired as f64 >= COVERED * vertices.len() as f64
        && both >= IRREGULAR
        && both as f64 >= COVERED * irregular as f64
        && context
            .estimate
            .distances(matching, vertices, vertices.len())
            .share_within
            .is_some_and(|share| share >= NEAR)
}
