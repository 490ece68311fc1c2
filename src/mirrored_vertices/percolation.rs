//! Percolation: pairs vote for the pairs around them, and the one with the most votes is next.
//!
//! A vote counts less the more the two lengths differ. A pair is entered only if it keeps all edges to paired neighbours close, and if
//! nothing else that is free fits better to where these neighbours lie. Contradictions never arise then but from the pairs of a start:
//! where two growths do not fit together vertices between them stay free.

use crate::adjacency::Adjacency;
use crate::mesh::vector::{Vector, cross, dot, squared_norm, subtract};
use crate::mesh::{Mesh, NONE};
use crate::symmetry_kind::SymmetryKind;
use std::collections::BinaryHeap;

/// Largest misfits of pairs to those around them, in the order in which they are let in. A turn by a right angle has 1, a stretch
/// to twice the length 0.2, a shear by the angle a about a^2 / 4.
pub(super) const MISFITS: [f64; 5] = [0.003, 0.015, 0.05, 0.12, 0.3];
/// Pairs of the trial from a start, and the fewest that make one.
const TRIAL: usize = 120;
const SMALLEST_TRIAL: usize = 50;
/// A vote for a pair whose lengths agree, and the difference of logarithms at which it has lost half.
const VOTE: f64 = 16.0;
const STRETCH: f64 = 0.3;
/// Least votes of a pair, about two whole ones.
const LEAST_VOTES: i32 = 27;

/// A pair with its votes when it was entered into a queue: the lower point comes first.
type Ballot = (i32, u32, u32);

/// The pairing under construction, and the votes.
pub(super) struct Pairing<'a> {
    /// The mesh whose points are paired.
    pub mesh: &'a Mesh,
    /// Points joined by an edge.
    pub edges: &'a Adjacency,
    /// Points joined by an edge or by one flip.
    pub close: &'a Adjacency,
    kind: SymmetryKind,
    /// Two orthonormal directions along the surface at each point.
    pub tangents: Vec<[Vector; 2]>,
    /// Whether a point may be paired and is not.
    open: Vec<bool>,
    /// Image of each point, or [`NONE`]; its own inverse.
    pub image: Vec<u32>,
    /// Per lower point of a pair the higher ones and their votes.
    votes: Vec<Vec<(u32, i32)>>,
    /// Pairs with enough votes; some are out of date.
    queue: BinaryHeap<Ballot>,
    /// Those that did not fit.
    deferred: Vec<Ballot>,
}

impl<'a> Pairing<'a> {
    /// Nothing is paired yet.
    pub fn new(
        mesh: &'a Mesh,
        edges: &'a Adjacency,
        close: &'a Adjacency,
        kind: SymmetryKind,
        open: Vec<bool>,
    ) -> Self {
        let count = mesh.positions.len();
        Pairing {
            mesh,
            edges,
            close,
            kind,
            tangents: tangents(mesh),
            open,
            image: vec![NONE; count],
            votes: vec![Vec::new(); count],
            queue: BinaryHeap::new(),
            deferred: Vec::new(),
        }
    }

    /// Grows from the pairs of a start as far as pairs fit to `limit`.
    pub fn grow_from(&mut self, start: &[(u32, u32)], limit: f64) {
        self.enter_all(start);
        self.percolate(limit, usize::MAX);
        self.queue.clear();
        self.deferred.clear();
    }

    /// Grows on from all pairs around `points`.
    pub fn grow_into(&mut self, points: &[u32], limit: f64) {
        for &low in points {
            let ballots = self.votes[low as usize].iter().map(|&(high, votes)| (votes, low, high));
            self.queue.extend(ballots.filter(|&(votes, ..)| votes >= LEAST_VOTES));
        }
        self.percolate(limit, usize::MAX);
        self.deferred.clear();
    }

    /// Mean misfit of what grows from the pairs of a start, which is taken back; `None` if that is little.
    pub fn misfit_from(&mut self, start: &[(u32, u32)]) -> Option<f64> {
        let mut entered = self.enter_all(start);
        for limit in MISFITS {
            let deferred = std::mem::take(&mut self.deferred);
            self.queue.extend(deferred);
            entered.extend(self.percolate(limit, TRIAL.saturating_sub(entered.len())));
        }
        let misfits = entered.iter().map(|&point| self.misfit(point, self.image[point as usize]));
        let misfit = misfits.sum::<f64>() / entered.len() as f64;
        let enough = entered.len() >= SMALLEST_TRIAL;
        self.undo_trial(&entered);
        self.queue.clear();
        self.deferred.clear();
        enough.then_some(misfit)
    }

    /// Takes back all pairs, those of `points`, and all votes, which all are theirs: faster than vote by vote.
    fn undo_trial(&mut self, points: &[u32]) {
        for &point in points {
            for end in [point, self.image[point as usize]] {
                self.image[end as usize] = NONE;
                self.open[end as usize] = true;
                let close = self.close;
                close.of(end as usize).iter().for_each(|&near| self.votes[near as usize].clear());
            }
        }
    }

    /// Takes back the pairs of `points`.
    pub fn forget(&mut self, points: &[u32]) {
        for &point in points {
            let image = self.image[point as usize];
            if image != NONE {
                self.vote(point, image, -1);
                for end in [point, image] {
                    self.image[end as usize] = NONE;
                    self.open[end as usize] = true;
                }
            }
        }
    }

    /// Takes back pairs that do not keep all edges to paired neighbours close.
    pub fn drop_contradicted(&mut self, points: &[u32]) {
        let contradicted = |&&point: &&u32| {
            let image = self.image[point as usize];
            image != NONE && !self.keeps_edges(point, image)
        };
        let contradicted: Vec<u32> = points.iter().filter(contradicted).copied().collect();
        self.forget(&contradicted);
    }

    /// Mean length from a point to those close to it.
    pub fn mean_length(&self, point: u32) -> f64 {
        let near = self.close.of(point as usize);
        near.iter().map(|&other| self.length(point, other)).sum::<f64>() / near.len().max(1) as f64
    }

    fn length(&self, a: u32, b: u32) -> f64 {
        squared_norm(self.offset(a, b)).sqrt()
    }

    /// The vector from one point to another.
    pub fn offset(&self, from: u32, to: u32) -> Vector {
        subtract(self.mesh.positions[to as usize], self.mesh.positions[from as usize])
    }

    fn is_open(&self, point: u32) -> bool {
        self.open[point as usize]
    }

    /// Enters the pairs whose points are open; the first points of these.
    fn enter_all(&mut self, pairs: &[(u32, u32)]) -> Vec<u32> {
        let entered = pairs.iter().filter(|&&(point, image)| self.enter(point, image));
        entered.map(|&(point, _)| point).collect()
    }

    /// Pairs two points, or one with itself, if they are open.
    fn enter(&mut self, a: u32, b: u32) -> bool {
        let open = self.is_open(a) && self.is_open(b);
        if open {
            (self.image[a as usize], self.image[b as usize]) = (b, a);
            (self.open[a as usize], self.open[b as usize]) = (false, false);
            self.vote(a, b, 1);
        }
        open
    }

    /// Points close to one, with the logarithm of the distance and whether an edge joins them.
    fn around(&self, point: u32) -> Vec<(u32, f64, bool)> {
        let edges = self.edges.of(point as usize);
        let close = self.close.of(point as usize).iter();
        let entry = |&near: &u32| (near, self.length(point, near).ln(), edges.binary_search(&near).is_ok());
        close.map(entry).collect()
    }

    /// Adds the votes of a pair for those around it, or takes them back (`sign` is -1).
    fn vote(&mut self, a: u32, b: u32, sign: i32) {
        let around_b = self.around(b);
        for (near_a, length_a, is_edge_a) in self.around(a) {
            for &(near_b, length_b, is_edge_b) in &around_b {
                // The pair of a point with itself counts each of its neighbours' pairs once.
                if a == b && near_a > near_b || !is_edge_a && !is_edge_b {
                    continue;
                }
                let stretch = (length_b - length_a) / STRETCH;
                let times = if near_a == near_b && a != b { 2.0 } else { 1.0 };
                let vote = (VOTE * times / (1.0 + stretch * stretch) + 0.5) as i32;
                // Lengths of 0 make this 0, too.
                if vote > 0 {
                    let (low, high) = (near_a.min(near_b), near_a.max(near_b));
                    let votes = add(&mut self.votes[low as usize], high, sign * vote);
                    if sign > 0 && votes >= LEAST_VOTES && self.is_open(low) && self.is_open(high) {
                        self.queue.push((votes, low, high));
                    }
                }
            }
        }
    }

    /// Enters what has most votes and fits, until `most` pairs are entered or none is left; the lower points of these.
    fn percolate(&mut self, limit: f64, most: usize) -> Vec<u32> {
        let mut entered = Vec::new();
        while entered.len() < most {
            let Some(ballot) = self.queue.pop() else { break };
            let (votes, low, high) = ballot;
            let list = &self.votes[low as usize];
            let is_current = list.iter().any(|&(other, now)| other == high && now == votes);
            if !is_current || !self.is_open(low) || !self.is_open(high) {
                continue;
            }
            if self.fits(low, high, limit) && self.enter(low, high) {
                entered.push(low);
            } else {
                self.deferred.push(ballot);
            }
        }
        entered
    }

    fn fits(&self, a: u32, b: u32, limit: f64) -> bool {
        let misfit = self.misfit(a, b);
        misfit <= limit
            && self.keeps_edges(a, b)
            && self.keeps_edges(b, a)
            && !self.has_rival(a, b, misfit)
            && !self.has_rival(b, a, misfit)
    }

    /// Whether the images of all paired neighbours of `point` are close to `image`.
    fn keeps_edges(&self, point: u32, image: u32) -> bool {
        let close = self.close.of(image as usize);
        self.images_around(point).all(|other| close.binary_search(&other).is_ok())
    }

    /// Whether another open point fits better as the image of `point`.
    fn has_rival(&self, point: u32, image: u32, misfit: f64) -> bool {
        let around = self.images_around(point).flat_map(|other| self.close.of(other as usize));
        let mut rivals: Vec<u32> =
            around.copied().filter(|&rival| rival != image && self.is_open(rival)).collect();
        rivals.sort_unstable();
        rivals.dedup();
        rivals.into_iter().any(|rival| self.misfit(point, rival) < misfit)
    }

    /// Images of the paired neighbours of `point`.
    fn images_around(&self, point: u32) -> impl Iterator<Item = u32> + '_ {
        let images = self.edges.of(point as usize).iter().map(|&near| self.image[near as usize]);
        images.filter(|&image| image != NONE)
    }

    /// How badly the paired points close to `a` lie as their images do around `b`, turned at will, and mirrored if that is the
    /// kind: 0 for exactly so, 1 for no resemblance.
    pub fn misfit(&self, a: u32, b: u32) -> f64 {
        let along = |from: u32, to: u32| {
            let offset = self.offset(from, to);
            self.tangents[from as usize].map(|axis| dot(axis, offset))
        };
        let (mut squares, mut products) = (0.0, [0.0, 0.0]);
        for &near in self.close.of(a as usize) {
            let image = self.image[near as usize];
            if image == NONE {
                continue;
            }
            let ([x, y], [u, mut v]) = (along(a, near), along(b, image));
            if self.kind == SymmetryKind::Reflection {
                v = -v;
            }
            squares += x * x + y * y + u * u + v * v;
            products[0] += x * u + y * v;
            products[1] += y * u - x * v;
        }
        let length = (products[0] * products[0] + products[1] * products[1]).sqrt();
        1.0 - 2.0 * length / f64::max(squares, f64::MIN_POSITIVE)
    }
}

/// Adds `value` to the entry of `key`, which may be new; the sum.
fn add(list: &mut Vec<(u32, i32)>, key: u32, value: i32) -> i32 {
    let at = list.iter().position(|&(other, _)| other == key).unwrap_or_else(|| {
        list.push((key, 0));
        list.len() - 1
    });
    list[at].1 += value;
    list[at].1
}

/// Two orthonormal directions in the tangent plane of each point.
fn tangents(mesh: &Mesh) -> Vec<[Vector; 2]> {
    let mut normals = vec![[0.0; 3]; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|point| mesh.positions[point as usize]);
        let normal = cross(subtract(b, a), subtract(c, a));
        for &point in triangle {
            (0..3).for_each(|axis| normals[point as usize][axis] += normal[axis]);
        }
    }
    let unit = |v: Vector| v.map(|x| x / squared_norm(v).sqrt().max(f64::MIN_POSITIVE));
    let frame = |&normal: &Vector| {
        let smallest = (0..3).min_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
        let axis = std::array::from_fn(|k| f64::from(u8::from(k == smallest)));
        let first = unit(cross(normal, axis));
        [first, unit(cross(normal, first))]
    };
    normals.iter().map(frame).collect()
}
