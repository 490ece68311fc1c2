//! The estimated map on the vertices of the half-edge structure, and distances from it counted in edges.

use super::matching::Matching;
use super::shells::Shells;
use crate::mesh::NONE;
use crate::mesh::half_edges::HalfEdges;
use std::cell::RefCell;
use std::ops::Range;

/// Most sampled vertices at which a map is compared with the estimate.
const SAMPLES: usize = 64;
/// Most of the distance across a shell that is accepted.
const SMALL: f64 = 0.33;
/// Least and most vertices visited around one estimate.
const BALL: [f64; 2] = [256.0, 4096.0];

/// What an estimate is relied on for, beside its places: the only bijection onto a shell is accepted, though it is not near.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reliance {
    /// Which other shell is a shell's twin.
    Twins,
    /// Which shell goes where, itself included: an arm may be posed otherwise than what carries it.
    Shells,
}

/// Estimated image and weight of each vertex.
pub(super) struct Estimate {
    /// The estimated partner of the vertex's point, which may have several fans.
    partner: Vec<u32>,
    weight: Vec<f32>,
    reliance: Reliance,
    rings: RefCell<Rings>,
}

/// How far a map is from the estimate at sampled vertices, in edges.
pub(super) struct Distances {
    /// Weighted mean; infinite without any estimate.
    pub mean: f64,
    /// Weighted share of samples within [`tolerance`]; `None` without any estimate.
    pub share_within: Option<f64>,
}

/// Accepted distance in edges on a shell of `vertices` vertices: about 0.05 of the root of its area, and on a small shell, as a box, not from any side to any other.
pub(super) fn tolerance(vertices: usize) -> f64 {
    let across = (vertices as f64).sqrt();
    (2.0 + 0.05 * across).min(SMALL * across)
}

/// Vertices to search on such a shell: about twice as far as [`tolerance`].
fn ball(vertices: usize) -> usize {
    (16.0 * tolerance(vertices).powi(2)).clamp(BALL[0], BALL[1]) as usize
}

impl Estimate {
    /// From points to vertices; partners that no face refers to count as none.
    pub fn new(half_edges: &HalfEdges, estimate: &[u32], confidence: &[f32], reliance: Reliance) -> Self {
        let mut referenced = vec![false; half_edges.point_count];
        half_edges.point_of_vertex.iter().for_each(|&point| referenced[point as usize] = true);
        let partner = |&point: &u32| {
            let partner = estimate[point as usize];
            if referenced.get(partner as usize).is_some_and(|&referenced| referenced) {
                partner
            } else {
                NONE
            }
        };
        let weight = |&point: &u32| confidence[point as usize].clamp(0.001, 1.0);
        Estimate {
            partner: half_edges.point_of_vertex.iter().map(partner).collect(),
            weight: half_edges.point_of_vertex.iter().map(weight).collect(),
            reliance,
            rings: RefCell::new(Rings::new(half_edges.vertex_count())),
        }
    }

    /// Weight of a vertex's estimate, 0 if it has none.
    pub fn weight(&self, vertex: u32) -> f32 {
        if self.partner[vertex as usize] == NONE { 0.0 } else { self.weight[vertex as usize] }
    }

    /// Vertices around the estimated image of `vertex` on a shell of `shell_size` vertices, nearest first.
    pub fn near(&self, half_edges: &HalfEdges, vertex: u32, shell_size: usize) -> Vec<u32> {
        let mut found = Vec::new();
        let partner = self.partner[vertex as usize];
        if partner != NONE {
            self.rings.borrow_mut().visit(
                half_edges,
                fans(half_edges, partner),
                ball(shell_size),
                |near, _| {
                    found.push(near);
                    false
                },
            );
        }
        found
    }

    /// Where most of what is estimated of a `shell` goes, if that is relied on.
    pub fn shell(&self, half_edges: &HalfEdges, shells: &Shells, shell: usize) -> Option<usize> {
        let known = spread(shells.vertices(shell), SAMPLES).filter(|&vertex| self.weight(vertex) > 0.0);
        let there = |vertex: u32| shells.of(fans(half_edges, self.partner[vertex as usize]).start);
        let mut found: Vec<usize> = known.map(there).collect();
        found.sort_unstable();
        let middle = found.get(found.len() / 2).copied().filter(|&middle| match self.reliance {
            Reliance::Twins => middle != shell,
            Reliance::Shells => true,
        });
        middle.filter(|middle| 2 * found.iter().filter(|&shell| shell == middle).count() > found.len())
    }

    /// Compares the images of `vertices` that are paired, on a shell of `shell_size`, with their estimates.
    pub fn distances(&self, matching: &Matching, vertices: &[u32], shell_size: usize) -> Distances {
        let usable =
            |&vertex: &u32| self.weight(vertex) > 0.0 && matching.vertex_image[vertex as usize] != NONE;
        let limit = tolerance(shell_size);
        let (mut total, mut sum, mut within) = (0.0, 0.0, 0.0);
        for vertex in spread(vertices, SAMPLES).filter(usable) {
            let distance = self.distance(matching, vertex, shell_size);
            let weight = f64::from(self.weight(vertex));
            total += weight;
            sum += weight * distance;
            within += if distance <= limit { weight } else { 0.0 };
        }
        if total == 0.0 {
            return Distances { mean: f64::INFINITY, share_within: None };
        }
        Distances { mean: sum / total, share_within: Some(within / total) }
    }

    /// Edges between a vertex's image and its estimate; beyond the ball, twice the distance searched.
    fn distance(&self, matching: &Matching, vertex: u32, shell_size: usize) -> f64 {
        let (image, partner) = (matching.vertex_image[vertex as usize], self.partner[vertex as usize]);
        let (mut reached, mut found) = (0, false);
        let half_edges = matching.half_edges;
        self.rings.borrow_mut().visit(half_edges, image..image + 1, ball(shell_size), |near, distance| {
            reached = distance;
            found = half_edges.point_of_vertex[near as usize] == partner;
            found
        });
        f64::from(if found { reached } else { 2 * reached + 16 })
    }
}

/// The vertices of a point.
fn fans(half_edges: &HalfEdges, point: u32) -> Range<u32> {
    let first = half_edges.point_of_vertex.partition_point(|&other| other < point);
    let fans = half_edges.point_of_vertex[first..].iter().take_while(|&&other| other == point);
    first as u32..(first + fans.count()) as u32
}

/// At most `count` of `items`, evenly spread.
fn spread(items: &[u32], count: usize) -> impl Iterator<Item = u32> + '_ {
    let taken = items.len().min(count);
    (0..taken).map(move |sample| items[sample * items.len() / taken])
}

/// Breadth-first search whose memory is kept between searches.
struct Rings {
    /// Search in which a vertex was last seen.
    seen: Vec<u32>,
    search: u32,
    queue: Vec<(u32, u32)>,
}

impl Rings {
    fn new(vertex_count: usize) -> Self {
        Rings { seen: vec![0; vertex_count], search: 0, queue: Vec::new() }
    }

    /// Visits up to `most` vertices with their distance, until `visit` says that it is done.
    fn visit(
        &mut self,
        half_edges: &HalfEdges,
        starts: Range<u32>,
        most: usize,
        mut visit: impl FnMut(u32, u32) -> bool,
    ) {
        self.search += 1;
        self.queue.clear();
        for start in starts {
            self.seen[start as usize] = self.search;
            self.queue.push((start, 0));
        }
        let mut head = 0;
        while let Some(&(vertex, distance)) = self.queue.get(head) {
            head += 1;
            if visit(vertex, distance) {
                return;
            }
            for half_edge in half_edges.outgoing_of(vertex) {
                if self.queue.len() >= most {
                    break;
                }
                let neighbour = half_edges.to_vertex[half_edge as usize];
                if self.seen[neighbour as usize] != self.search {
                    self.seen[neighbour as usize] = self.search;
                    self.queue.push((neighbour, distance + 1));
                }
            }
        }
    }
}
