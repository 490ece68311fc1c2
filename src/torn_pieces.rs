//! Pieces of the surface that a map tears off are mended.
//!
//! The eigenvalues of legs that are nearly alike nearly coincide, so that functions live on single legs, and a map may take a leg for its own
//! mirror image while the body around it goes to the other side: there it is torn. What hangs together is taken for right where
//! it is largest by far; a point of another piece goes to where its distances from what is right are most like its own, as points are found
//! from landmarks (A. Bronstein, M. Bronstein, R. Kimmel, "Generalized multidimensional scaling", 2006, for distances along the surface).

use crate::full_refinement::{MatchTarget, VertexImages, estimate, refine};
use crate::functional_map::project;
use crate::progress::CancelToken;
use crate::refinement::nearest;
use crate::shortest_ways::{EdgeWays, Search};
use crate::spread_points::SpreadPoints;
use crate::threads;
use crate::vertex_rows::Guide;
use crate::{error::Result, mesh::NONE};
use faer::Mat;
use std::ops::ControlFlow;

/// Images of neighbouring points that are farther apart than this, along edges, in sqrt(area), are torn apart.
const TEAR: f64 = 0.1;
/// Share of the area from which on a piece is mended, and up to which: beside one that is larger nothing says which of the two is right.
const LEAST_PIECE: f64 = 0.004;
const MOST_PIECE: f64 = 0.25;
/// Distance from what is torn off, in sqrt(area), from which on the map is trusted.
const TRUSTED: f64 = 0.05;
/// Trusted points whose distances tell where a point belongs, and the fewest among which they are chosen.
const ANCHORS: usize = 32;
const LEAST_TRUSTED: usize = 100;
/// Of what was torn off less than this share may still be, or distances from what is right must differ by less than the other share
/// of what they did.
const TORN_LEFT: f64 = 0.1;
const MISFIT_LEFT: f64 = 0.45;
/// Times as a map is mended.
const ROUNDS: usize = 3;

/// A shell and points of it, whose map may be torn.
pub struct Mender<'a> {
    target: &'a MatchTarget<'a>,
    points: &'a SpreadPoints,
    ways: EdgeWays,
}

/// A functional map, and the images of the points under it.
pub struct PointMap {
    /// Square.
    pub map: Mat<f64>,
    /// Of the points.
    pub images: VertexImages,
}

/// What the largest piece of a map tells about the rest.
struct Anchored {
    /// Points that are torn off.
    torn: Vec<u32>,
    /// Of each of these, and of all vertices as images: roots of the distances from the anchors and from their images.
    own: Mat<f32>,
    theirs: Mat<f32>,
}

impl<'a> Mender<'a> {
    /// O(triangles log degree).
    pub fn new(target: &'a MatchTarget, points: &'a SpreadPoints) -> Mender<'a> {
        Mender { target, points, ways: EdgeWays::new(target.surface) }
    }

    /// `found`, mended where it is torn, as far as `better` holds for the mended map and the one before; as it is if two of its pieces
    /// are so large that either may be right.
    ///
    /// O(points x points nearby) if nothing is torn; else some `ANCHORS` searches over the whole surface more, and an estimate
    /// of the map.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
    pub fn mend(
        &self,
        mut found: PointMap,
        better: impl Fn(&PointMap, &PointMap) -> bool,
        token: &CancelToken,
    ) -> Result<PointMap> {
        for _ in 0..ROUNDS {
            token.check()?;
            let pieces = self.pieces(&found.images);
            if !(LEAST_PIECE..=MOST_PIECE).contains(&pieces.largest_torn()) {
                break;
            }
            let Some(anchored) = self.anchored(&pieces, &found.images) else { break };
            let mended = self.follow(&anchored, &found, token)?;
            let torn_left = self.pieces(&mended.images).torn_off() / pieces.torn_off();
            let misfit = |images| self.misfit(&anchored, images);
            let misfit_left = misfit(&mended.images) / misfit(&found.images);
            let mends =
                torn_left < 1.0 && misfit_left < if torn_left < TORN_LEFT { 1.0 } else { MISFIT_LEFT };
            if !(mends && better(&mended, &found)) {
                break;
            }
            found = mended;
        }
        Ok(found)
    }

    /// What hangs together in the points and in their images.
    fn pieces(&self, images: &VertexImages) -> Pieces {
        let graph = self.points.sources().graph;
        let mut search = Search::new(self.ways.vertex_count());
        let mut pieces = Pieces { of: vec![NONE; graph.count()], shares: Vec::new() };
        for first in 0..graph.count() as u32 {
            if pieces.of[first as usize] != NONE {
                continue;
            }
            let own = pieces.shares.len() as u32;
            let mut share = 0.0;
            let mut open = vec![first];
            pieces.of[first as usize] = own;
            while let Some(point) = open.pop() {
                share += self.points.mass[point as usize];
                let image = images.partners[point as usize];
                for &near in graph.of(point as usize) {
                    if pieces.of[near as usize] == NONE
                        && self.hang_together(&mut search, image, images.partners[near as usize])
                    {
                        pieces.of[near as usize] = own;
                        open.push(near);
                    }
                }
            }
            pieces.shares.push(share);
        }
        let all: f64 = pieces.shares.iter().sum();
        pieces.shares.iter_mut().for_each(|share| *share /= all);
        pieces
    }

    fn hang_together(&self, search: &mut Search, from: u32, to: u32) -> bool {
        let mut found = false;
        search.run(
            &[from],
            TEAR,
            |vertex| self.ways.of(vertex),
            |vertex, _| {
                found = vertex == to;
                if found { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            },
        );
        found
    }

    /// Anchors spread over the trusted part of the largest piece; `None` if that is small.
    fn anchored(&self, pieces: &Pieces, images: &VertexImages) -> Option<Anchored> {
        let (vertices, largest) = (&self.points.vertices, pieces.largest());
        let torn: Vec<u32> =
            (0..).zip(&pieces.of).filter(|(_, piece)| **piece != largest).map(|(point, _)| point).collect();
        let torn_vertices: Vec<u32> = torn.iter().map(|&point| vertices[point as usize]).collect();
        let to_torn = self.ways.distances(&torn_vertices);
        let is_trusted = |point: &usize| {
            let distance = to_torn[vertices[*point] as usize];
            distance > TRUSTED && distance.is_finite()
        };
        let trusted: Vec<usize> = (0..vertices.len()).filter(is_trusted).collect();
        if trusted.len() < LEAST_TRUSTED {
            return None;
        }
        // The first is near what is torn off, each other one as far as can be from those before.
        let to_torn_of = |point: &usize| to_torn[vertices[*point] as usize];
        let mut next = *trusted.iter().min_by(|a, b| to_torn_of(a).total_cmp(&to_torn_of(b)))?;
        let mut to_anchors = vec![f64::INFINITY; self.ways.vertex_count()];
        let (mut own, mut starts) = (Vec::new(), Vec::new());
        for _ in 0..ANCHORS {
            let distances = self.ways.distances(&[vertices[next]]);
            to_anchors.iter_mut().zip(&distances).for_each(|(least, distance)| *least = least.min(*distance));
            own.push(distances);
            starts.push(images.partners[next]);
            let apart = |point: &usize| to_anchors[vertices[*point] as usize];
            next = *trusted.iter().max_by(|a, b| apart(a).total_cmp(&apart(b)))?;
        }
        let theirs = threads::map(self.target.threads(), starts, |start| self.ways.distances(&[start]));
        let own = Mat::from_fn(torn.len(), ANCHORS, |i, k| own[k][torn_vertices[i] as usize].sqrt() as f32);
        let theirs = Mat::from_fn(self.ways.vertex_count(), ANCHORS, |i, k| theirs[k][i].sqrt() as f32);
        Some(Anchored { torn, own, theirs })
    }

    /// The map in which what is torn off goes to where its distances from the anchors are most like its own.
    fn follow(&self, anchored: &Anchored, found: &PointMap, token: &CancelToken) -> Result<PointMap> {
        let mut partners = found.images.partners.clone();
        let images = nearest(anchored.own.as_ref(), anchored.theirs.as_ref());
        for (&point, image) in anchored.torn.iter().zip(images) {
            partners[point as usize] = image;
        }
        let seeds: Vec<(u32, u32)> = (0..).zip(partners.iter().copied()).collect();
        let placed = VertexImages::at_vertices(&self.target.surface.triangles, partners);
        let (points, size) = (self.points.sources(), found.map.nrows());
        let map =
            project(estimate(&points, self.target, &placed.points, size, size), self.target.projection())?;
        let guide = Guide::Eigenfunctions;
        let (map, images) = refine(self.target, &points, map, &seeds, &[size], guide, token)?;
        Ok(PointMap { map, images })
    }

    /// Mean difference of distances of what is torn off, each taken as a root: root mean square over the anchors.
    fn misfit(&self, anchored: &Anchored, images: &VertexImages) -> f64 {
        let (mut sum, mut mass) = (0.0, 0.0);
        for (row, &point) in anchored.torn.iter().enumerate() {
            let image = images.partners[point as usize] as usize;
            let squares: f32 =
                (0..ANCHORS).map(|k| (anchored.own[(row, k)] - anchored.theirs[(image, k)]).powi(2)).sum();
            let own = self.points.mass[point as usize];
            sum += own * f64::from(squares / ANCHORS as f32).sqrt();
            mass += own;
        }
        sum / mass
    }
}

/// Pieces of a map.
struct Pieces {
    /// The piece of each point.
    of: Vec<u32>,
    /// Share of the area of each piece.
    shares: Vec<f64>,
}

impl Pieces {
    fn largest(&self) -> u32 {
        (0..self.shares.len()).max_by(|&a, &b| self.shares[a].total_cmp(&self.shares[b])).unwrap_or(0) as u32
    }

    /// Share of all but the largest.
    fn torn_off(&self) -> f64 {
        1.0 - self.shares[self.largest() as usize]
    }

    /// Share of the largest but one.
    fn largest_torn(&self) -> f64 {
        let largest = self.largest() as usize;
        let others = self.shares.iter().enumerate().filter(|(piece, _)| *piece != largest);
        others.fold(0.0, |most, (_, share)| most.max(*share))
    }
}
