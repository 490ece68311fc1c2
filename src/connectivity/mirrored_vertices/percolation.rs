//! Percolation: pairs vote for the pairs around them, and the one with the most votes is next.
//!
//! A vote counts less the more the two lengths differ. A pair is entered only if it keeps the edges to paired neighbours close, all or some of
//! them. Where all must be close contradictions never arise but from the pairs of a start: where two growths do not fit together vertices
//! between them stay free.

use super::surroundings::Surroundings;
use super::votes::Votes;
use crate::base::symmetry_kind::SymmetryKind;
use crate::mesh::NONE;
use crate::mesh::vector::dot;
use std::collections::BinaryHeap;

/// Largest misfits of pairs to those around them, in the order in which they are let in. A turn by a right angle has 1, a stretch
/// to twice the length 0.2, a shear by the angle a about a^2 / 4.
pub(super) const MISFITS: [f64; 5] = [0.003, 0.015, 0.05, 0.12, 0.3];
/// Pairs of the trial from a start, and the fewest that make one: shells with fewer vertices have too little to tell a pairing from chance.
const TRIAL: usize = 120;
pub(super) const SMALLEST_TRIAL: usize = 50;
/// A vote for a pair whose lengths agree, and the difference of logarithms at which it has lost half.
const VOTE: f64 = 16.0;
const STRETCH: f64 = 0.3;
/// Least votes of a pair, about two whole ones.
const LEAST_VOTES: i32 = 27;

/// A pair with its votes when it was entered into a queue: the lower point comes first.
type Ballot = (i32, u32, u32);

/// The pairing under construction, and the votes.
#[derive(Clone)]
pub(super) struct Pairing<'a> {
    /// What is around the points that are paired.
    pub around: &'a Surroundings<'a>,
    kind: SymmetryKind,
    /// Largest share of the edges to paired neighbours that a pair may not keep close.
    apart: f64,
    /// Whether a point may be paired and is not.
    open: Vec<bool>,
    /// Image of each point, or [`NONE`]; its own inverse.
    pub image: Vec<u32>,
    /// Those of pairs that were open when the votes came.
    votes: Votes,
    /// Pairs with enough votes; some are out of date.
    queue: BinaryHeap<Ballot>,
    /// Those that did not fit.
    deferred: Vec<Ballot>,
    /// What is around the point at hand; a list that keeps its room.
    open_near: Vec<OpenNear>,
}

/// An open point close to another one.
#[derive(Clone)]
struct OpenNear {
    point: u32,
    log_length: f64,
    /// Whether an edge joins the two.
    is_edge: bool,
}

impl<'a> Pairing<'a> {
    /// Nothing is paired yet.
    pub fn new(around: &'a Surroundings<'a>, kind: SymmetryKind, open: Vec<bool>) -> Self {
        let count = open.len();
        Pairing {
            around,
            kind,
            apart: 0.0,
            open,
            image: vec![NONE; count],
            votes: Votes::new(count),
            queue: BinaryHeap::new(),
            deferred: Vec::new(),
            open_near: Vec::new(),
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
        for &low in points.iter().filter(|&&point| self.open[point as usize]) {
            let open = self.votes.with(low).filter(|&(high, _)| self.open[high as usize]);
            let ballots = open.map(|(high, votes)| (votes, low, high));
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
        self.forget(&entered);
        self.end_growth();
        enough.then_some(misfit)
    }

    /// Takes back the pairs of `points`, not their votes.
    pub fn forget(&mut self, points: &[u32]) {
        for &point in points {
            let image = self.image[point as usize];
            if image != NONE {
                for end in [point, image] {
                    self.image[end as usize] = NONE;
                    self.open[end as usize] = true;
                }
            }
        }
    }

    /// The pairs of `points`, from both ends.
    pub fn pairs(&self, points: &[u32]) -> Vec<(u32, u32)> {
        let pairs = points.iter().map(|&point| (point, self.image[point as usize]));
        pairs.filter(|&(_, image)| image != NONE).collect()
    }

    /// Takes back the pairs of `points` and all votes; pairs keep all edges but a share `apart` from now on.
    pub fn start_again(&mut self, points: &[u32], apart: f64) {
        self.forget(points);
        self.end_growth();
        self.apart = apart;
    }

    /// Takes back all votes: nothing grows on from what is paired.
    pub fn end_growth(&mut self) {
        self.votes.clear();
        self.queue.clear();
        self.deferred.clear();
    }

    /// Takes back pairs that do not keep edges.
    pub fn drop_contradicted(&mut self, points: &[u32]) {
        let contradicted = |&&point: &&u32| {
            let image = self.image[point as usize];
            image != NONE && !self.keeps_edges(point, image)
        };
        let contradicted: Vec<u32> = points.iter().filter(contradicted).copied().collect();
        self.forget(&contradicted);
    }

    fn is_open(&self, point: u32) -> bool {
        self.open[point as usize]
    }

    /// Enters the pairs whose points are open; the first points of these.
    pub fn enter_all(&mut self, pairs: &[(u32, u32)]) -> Vec<u32> {
        let entered = pairs.iter().filter(|&&(point, image)| self.enter(point, image));
        entered.map(|&(point, _)| point).collect()
    }

    /// Pairs two points, or one with itself, if they are open.
    fn enter(&mut self, a: u32, b: u32) -> bool {
        let open = self.is_open(a) && self.is_open(b);
        if open {
            (self.image[a as usize], self.image[b as usize]) = (b, a);
            (self.open[a as usize], self.open[b as usize]) = (false, false);
            self.vote(a, b);
        }
        open
    }

    /// Adds the votes of a pair for those open pairs that are around it.
    fn vote(&mut self, a: u32, b: u32) {
        self.open_near.clear();
        self.open_near.extend(open_around(self.around, &self.open, b));
        for near_a in open_around(self.around, &self.open, a) {
            for near_b in &self.open_near {
                // The pair of a point with itself counts each of its neighbours' pairs once.
                if a == b && near_a.point > near_b.point || !near_a.is_edge && !near_b.is_edge {
                    continue;
                }
                let stretch = (near_b.log_length - near_a.log_length) / STRETCH;
                let times = if near_a.point == near_b.point && a != b { 2.0 } else { 1.0 };
                let vote = (VOTE * times / (1.0 + stretch * stretch) + 0.5) as i32;
                // Lengths of 0 make this 0, too.
                if vote > 0 {
                    let (low, high) = (near_a.point.min(near_b.point), near_a.point.max(near_b.point));
                    let votes = self.votes.add(low, high, vote);
                    if votes >= LEAST_VOTES {
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
            if !self.is_open(low) || !self.is_open(high) || self.votes.of(low, high) != votes {
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

    /// Whether a pair has a misfit up to `limit` and keeps edges.
    fn fits(&self, a: u32, b: u32, limit: f64) -> bool {
        self.misfit(a, b) <= limit && self.keeps_edges(a, b) && self.keeps_edges(b, a)
    }

    /// Whether the images of all paired neighbours of `point`, but for a share `apart`, are close to `image`.
    fn keeps_edges(&self, point: u32, image: u32) -> bool {
        let close = self.around.close.of(image as usize);
        let most = self.apart * self.images_around(point).count() as f64;
        let mut lost = self.images_around(point).filter(|other| close.binary_search(other).is_err());
        lost.nth(most as usize).is_none()
    }

    /// Images of the paired neighbours of `point`.
    fn images_around(&self, point: u32) -> impl Iterator<Item = u32> + '_ {
        let images = self.around.edges.of(point as usize).iter().map(|&near| self.image[near as usize]);
        images.filter(|&image| image != NONE)
    }

    /// How badly the paired points close to `point` lie as their images do around `image`, turned at will, and mirrored if that is the
    /// kind: 0 for exactly so, 1 for no resemblance.
    pub fn misfit(&self, point: u32, image: u32) -> f64 {
        let [own_axes, axes] = [point, image].map(|at| self.around.tangents[at as usize]);
        let (mut squares, mut products) = (0.0, [0.0, 0.0]);
        for &near in self.around.close.of(point as usize) {
            let near_image = self.image[near as usize];
            if near_image == NONE {
                continue;
            }
            let [own, other] = [self.around.offset(point, near), self.around.offset(image, near_image)];
            let ([x, y], [u, mut v]) =
                (own_axes.map(|axis| dot(axis, own)), axes.map(|axis| dot(axis, other)));
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

/// Open points close to one.
fn open_around<'a>(
    around: &'a Surroundings,
    open: &'a [bool],
    point: u32,
) -> impl Iterator<Item = OpenNear> + 'a {
    let mut edges = around.edges.of(point as usize).iter().peekable();
    around.close.of(point as usize).iter().filter_map(move |near| {
        let is_edge = edges.next_if_eq(&near).is_some();
        let entry = || OpenNear { point: *near, log_length: around.length(point, *near).ln(), is_edge };
        open[*near as usize].then(entry)
    })
}
