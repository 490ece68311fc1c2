//! The only pairing of most of a shell: its connectivity is mirrored but for defects, a split edge or some flipped triangles, and for parts without a counterpart.
//!
//! Patches grow from pairs of vertices that alone see each other's mirror image, those with most such pairs around them first, over all pairs of faces with equal degrees and
//! equal valences at their corners. The first patch that pairs most vertices of the shell as most of their neighbours is the pairing; several together are where a cut parts
//! the shell. What is left over is paired by its neighbours, and what most of its neighbours do not follow is dropped. Where the same vertices can be sent elsewhere and most
//! of the shell follows, too, as in a box with two mirror planes, or in a body whose front is its back but for the nose, shape decides.

use super::colours::{Classes, only_pairs};
use super::matching::{Mark, Matching};
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::geometry::adjacency::LOOKS;
use crate::mesh::NONE;
use crate::mesh::edges::UnionFind;
use crate::mesh::half_edges::HalfEdges;
use std::collections::HashMap;

/// Faces of the trial around a seed of a rival.
const TRIAL_FACES: usize = 200;
/// Failed full growths of a shell before giving up.
const FAILURES: usize = 8;
/// Least share of a shell to be paired.
const COVERED: f64 = 0.6;
/// Fewest faces of a patch for each that contradicts it.
const FEW: usize = 8;
/// A pairing is a rival if it holds this part of what the best one holds.
const RIVAL: f64 = 0.9;
/// Most pairings that are looked at.
const MOST_PAIRINGS: usize = 4;
/// Fewest irregular vertices of a shell of which defects may leave some unpaired: fewer have too little to tell a pairing from chance. So
/// many vertices without another lookalike than their image tell a bijection, too.
pub(super) const IRREGULAR: usize = 32;
/// Least share of vertices with a lookalike: a defect takes it from all within some rings, and from their partners.
pub(super) const REPEATED: f64 = 0.2;
/// Vertices of which every image is tried.
const RIVAL_SEEDS: usize = 4;

/// Votes of the vertices that are paired by their neighbours: from the first on down to the second.
const MOST_VOTES: usize = 6;
const LEAST_VOTES: usize = 2;

/// Pairs of vertices that alone see each other's mirror image, and most of whose neighbours' pairs are neighbours, too.
pub(super) struct Seeds {
    /// A half-edge of each such vertex, to another one, and its image; [`NONE`] for other vertices.
    starts: Vec<[u32; 2]>,
    /// By vertex, how many others its neighbours and theirs lead to.
    sizes: Vec<u32>,
}

impl Seeds {
    /// Those of all shells. O(half-edges + vertices log vertices).
    pub fn new(half_edges: &HalfEdges, valences: &[u64], kind: SymmetryKind) -> Seeds {
        let partner = only_pairs(half_edges, valences, kind);
        let mut starts = vec![[NONE; 2]; partner.len()];
        let mut patches = UnionFind::new(partner.len());
        for vertex in (0..partner.len() as u32).filter(|&vertex| partner[vertex as usize] != NONE) {
            let image_of = |start: u32| {
                let wanted = partner[half_edges.to_vertex[start as usize] as usize];
                let mut there = half_edges.outgoing_of(partner[vertex as usize]);
                (wanted != NONE).then(|| there.find(|&there| half_edges.to_vertex[there as usize] == wanted))
            };
            let around = half_edges.outgoing_of(vertex).take(LOOKS);
            let images: Vec<(u32, Option<u32>)> =
                around.filter_map(|start| Some((start, image_of(start)?))).collect();
            let agreeing = || images.iter().filter_map(|&(start, there)| Some((start, there?)));
            if 2 * agreeing().count() <= images.len() {
                continue;
            }
            agreeing().for_each(|(start, _)| patches.join(vertex, half_edges.to_vertex[start as usize]));
            starts[vertex as usize] = agreeing().next().map_or([NONE; 2], |(start, there)| match kind {
                SymmetryKind::Reflection => [start, there ^ 1],
                SymmetryKind::HalfTurn => [start, there],
            });
        }
        let mut counts = vec![0; partner.len()];
        let patches: Vec<u32> = (0..partner.len() as u32).map(|vertex| patches.find(vertex)).collect();
        patches.iter().for_each(|&patch| counts[patch as usize] += 1);
        Seeds { starts, sizes: patches.iter().map(|&patch| counts[patch as usize]).collect() }
    }

    /// Those of a shell, of the largest patch first.
    fn of(&self, vertices: &[u32]) -> Vec<(u32, [u32; 2])> {
        let known = |&&vertex: &&u32| self.starts[vertex as usize][0] != NONE;
        let mut found: Vec<u32> = vertices.iter().filter(known).copied().collect();
        found.sort_by_key(|&vertex| std::cmp::Reverse(self.sizes[vertex as usize]));
        found.into_iter().map(|vertex| (vertex, self.starts[vertex as usize])).collect()
    }
}

/// What the growth reads.
pub(super) struct Context<'a> {
    /// The vertices of the shell.
    pub vertices: &'a [u32],
    /// Where growth starts.
    pub seeds: &'a Seeds,
    /// Colours by valence, face degrees and boundary.
    pub valences: &'a [u64],
    /// Classes by surroundings: lookalikes are each other's possible images.
    pub classes: &'a Classes,
}

/// A pairing of most of a shell.
struct Pairing {
    /// The image of each vertex.
    images: Vec<u32>,
    /// The pairs of half-edges at which its patches start.
    starts: Vec<[u32; 2]>,
    /// How many vertices it pairs as most of their neighbours.
    held: usize,
}

/// Pairs the vertices of a shell that nothing is paired of yet; says whether there is such a pairing. Of several, or of one in patches, it is
/// the one that `agrees`, if no other does. O(size of the shell).
pub(super) fn match_shell(
    matching: &mut Matching,
    context: &Context,
    agrees: impl Fn(&Matching, &[u32]) -> bool,
    progress: &Progress,
) -> Result<bool> {
    if !context.has_irregular() {
        return Ok(false);
    }
    let before = matching.mark();
    let mut found = context.pairings(matching, progress)?;
    let is_sure = found.len() == 1 && found[0].starts.len() == 1;
    let grow = |matching: &mut Matching, starts: &[[u32; 2]]| {
        for &[from, to] in starts {
            matching.grow(from, to, context.valences, usize::MAX);
        }
    };
    found.retain(|pairing| {
        is_sure || {
            grow(matching, &pairing.starts);
            let agrees = agrees(matching, context.vertices);
            matching.rollback(before);
            agrees
        }
    });
    let [pairing] = &found[..] else { return Ok(false) };
    grow(matching, &pairing.starts);
    pair_by_neighbours(matching, context.vertices);
    drop_loose(matching, context.vertices);
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

    /// How many vertices are paired as most of their neighbours are; `None` if these are not most of the shell.
    fn held(&self, matching: &Matching) -> Option<usize> {
        let holds =
            |vertex: &&u32| matching.vertex_image[**vertex as usize] != NONE && !is_loose(matching, **vertex);
        let held = self.vertices.iter().filter(holds).count();
        (held as f64 >= COVERED * self.vertices.len() as f64).then_some(held)
    }

    /// The first pairing of nearly all of the shell that starts at one of the seeds, or at several where a cut parts it, and those that send most vertices elsewhere; each with its starts.
    fn pairings(&self, matching: &mut Matching, progress: &Progress) -> Result<Vec<Pairing>> {
        let mut found: Vec<Pairing> = Vec::new();
        let before = matching.mark();
        let (mut starts, mut failures) = (Vec::new(), 0);
        for (vertex, [from, to]) in self.seeds.of(self.vertices) {
            progress.check()?;
            if failures == FAILURES {
                break;
            }
            if matching.vertex_image[vertex as usize] != NONE {
                continue;
            }
            let mark = matching.mark();
            let faces = matching.grow(from, to, self.valences, usize::MAX);
            if FEW * contradicted_faces(matching, mark) > faces {
                matching.rollback(mark);
                failures += 1;
                continue;
            }
            starts.push([from, to]);
            if let Some(held) = self.held(matching) {
                found.push(Pairing { images: matching.vertex_image.clone(), starts, held });
                break;
            }
        }
        matching.rollback(before);
        for vertex in self.rivals() {
            for &image in self.classes.members(vertex) {
                progress.check()?;
                for (from, to) in matching.seeds(vertex, image) {
                    let faces = matching.grow(from, to, self.valences, TRIAL_FACES);
                    let promises = faces >= 4 * contradicted_faces(matching, before);
                    matching.rollback(before);
                    if !promises || found.len() == MOST_PAIRINGS {
                        continue;
                    }
                    matching.grow(from, to, self.valences, usize::MAX);
                    let is_new = |known: &Pairing| self.is_elsewhere(matching, &known.images);
                    if let Some(held) = self.held(matching).filter(|_| found.iter().all(is_new)) {
                        let (images, starts) = (matching.vertex_image.clone(), vec![[from, to]]);
                        found.push(Pairing { images, starts, held });
                    }
                    matching.rollback(before);
                }
            }
        }
        let most = found.iter().map(|pairing| pairing.held).max().unwrap_or(0) as f64;
        found.retain(|pairing| pairing.held as f64 >= RIVAL * most);
        Ok(found)
    }

    /// Vertices with the fewest lookalikes, some, each from another region of the shell.
    fn rivals(&self) -> impl Iterator<Item = u32> {
        let regions = self.vertices.chunks(self.vertices.len().div_ceil(RIVAL_SEEDS));
        let count = |vertex: &u32| self.classes.members(*vertex).len();
        regions.filter_map(move |region| {
            region.iter().copied().filter(move |vertex| count(vertex) > 1).min_by_key(count)
        })
    }

    /// Whether a matching sends so many vertices elsewhere than another pairing does as make half of the shell.
    fn is_elsewhere(&self, matching: &Matching, known: &[u32]) -> bool {
        let differs = |vertex: &&u32| {
            let image = matching.vertex_image[**vertex as usize];
            image != NONE && image != known[**vertex as usize]
        };
        2 * self.vertices.iter().filter(differs).count() > self.vertices.len()
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

/// Unpairs vertices that are loose, again and again: what has no mirror image is grown into from a side, and is lost again from its corners. What surrounds a gap has
/// most of its neighbours.
fn drop_loose(matching: &mut Matching, vertices: &[u32]) {
    let mut left = vertices.to_vec();
    while !left.is_empty() {
        let image = |vertex: u32| matching.vertex_image[vertex as usize];
        let loose = left.iter().filter(|&&vertex| image(vertex) != NONE && is_loose(matching, vertex));
        let loose: Vec<[u32; 2]> = loose.map(|&vertex| [vertex, image(vertex)]).collect();
        loose.iter().for_each(|&[vertex, _]| matching.unpair(vertex));
        left = loose.into_iter().flatten().flat_map(|vertex| around(matching, vertex)).collect();
        left.sort_unstable();
        left.dedup();
    }
}

/// Whether the images of half of a paired vertex's neighbours, or more, are not next to its own.
fn is_loose(matching: &Matching, vertex: u32) -> bool {
    let image = |vertex: u32| matching.vertex_image[vertex as usize];
    let follows = |&near: &u32| {
        image(near) != NONE && around(matching, image(near)).any(|there| there == image(vertex))
    };
    2 * around(matching, vertex).filter(follows).count() <= around(matching, vertex).count()
}

/// The neighbours of a vertex.
fn around<'a>(matching: &Matching<'a>, vertex: u32) -> impl Iterator<Item = u32> + use<'a> {
    let half_edges = matching.half_edges;
    half_edges.outgoing_of(vertex).map(|half_edge| half_edges.to_vertex[half_edge as usize])
}

/// What is free and next to the images of more of a free vertex's neighbours, `least` or more, than anything else that is free.
fn most_voted(matching: &Matching, vertex: u32, least: usize) -> Option<u32> {
    let around = |vertex: u32| around(matching, vertex);
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
