//! The pairing under construction: images of half-edges and vertices, grown by walking both sides at once.
//!
//! An image is entered in both directions, so every pairing is its own inverse and injective. A
//! reflection sends half-edge u -> v to one from the image of v to that of u; a half turn keeps the order.

use super::colours::Classes;
use crate::base::symmetry_kind::SymmetryKind;
use crate::mesh::NONE;
use crate::mesh::half_edges::HalfEdges;
use std::collections::VecDeque;

/// A partial pairing, with a log so that failed attempts cost only what they touched.
pub(super) struct Matching<'a> {
    /// The connectivity that is walked.
    pub half_edges: &'a HalfEdges,
    /// Image of each vertex or [`NONE`].
    pub vertex_image: Vec<u32>,
    image: Vec<u32>,
    kind: SymmetryKind,
    half_edge_log: Vec<u32>,
    vertex_log: Vec<u32>,
    refused: Vec<(u32, u32)>,
}

/// A state to go back to.
#[derive(Clone, Copy)]
pub(super) struct Mark {
    half_edges: usize,
    vertices: usize,
    refused: usize,
}

impl<'a> Matching<'a> {
    /// Nothing paired yet.
    pub fn new(half_edges: &'a HalfEdges, kind: SymmetryKind) -> Self {
        Matching {
            half_edges,
            vertex_image: vec![NONE; half_edges.vertex_count()],
            refused: Vec::new(),
            image: vec![NONE; half_edges.count()],
            kind,
            half_edge_log: Vec::new(),
            vertex_log: Vec::new(),
        }
    }

    /// All ways to send `vertex` to `image`, as half-edge pairs that fix everything else.
    pub fn seeds(&self, vertex: u32, image: u32) -> Vec<(u32, u32)> {
        let start = self.half_edges.outgoing[vertex as usize];
        let targets = self.half_edges.outgoing_of(image);
        match self.kind {
            SymmetryKind::Reflection => targets.map(|target| (start, target ^ 1)).collect(),
            SymmetryKind::HalfTurn => {
                targets.filter(|&target| target != start).map(|target| (start, target)).collect()
            }
        }
    }

    /// Pairs the whole shell of `start` from one pair of half-edges; takes all back on a contradiction.
    ///
    /// Each step lowers `budget`; at 0 the walk counts as failed.
    pub fn walk(&mut self, start: u32, target: u32, classes: &Classes, budget: &mut u64) -> bool {
        let mark = self.mark();
        let alike = |vertex: u32, partner: u32| classes.same(vertex, partner);
        let mut paired = self.join(start, target, alike) && self.join(start ^ 1, target ^ 1, alike);
        let mut head = mark.half_edges;
        while let Some(&half_edge) = self.half_edge_log.get(head).filter(|_| paired && *budget > 0) {
            head += 1;
            *budget -= 1;
            let image = self.image[half_edge as usize];
            let (next, previous) = (self.next_image(image), self.previous_image(image));
            paired = self.join(self.half_edges.next[half_edge as usize], next, alike)
                && self.join(self.half_edges.previous[half_edge as usize], previous, alike)
                && self.join(half_edge ^ 1, image ^ 1, alike);
        }
        let complete = paired && head == self.half_edge_log.len();
        if !complete {
            self.rollback(mark);
        }
        complete
    }

    /// Enters one pair of half-edges and of the vertices they point to, if these are `alike` and nothing contradicts.
    fn join(&mut self, half_edge: u32, image: u32, alike: impl Fn(u32, u32) -> bool) -> bool {
        let known = self.image[half_edge as usize];
        if known != NONE || self.image[image as usize] != NONE {
            return known == image;
        }
        let (vertex, partner) = (self.half_edges.to_vertex[half_edge as usize], self.end_image(image));
        let hole = |half_edge: u32| self.half_edges.face[half_edge as usize] == NONE;
        if !alike(vertex, partner) || hole(half_edge) != hole(image) {
            return false;
        }
        self.enter(half_edge, image, vertex, partner)
    }

    /// Pairs faces outwards from one pair of half-edges, stepping over what does not fit.
    ///
    /// A pair of faces fits if degrees and the `colours` of corners agree and nothing paired before
    /// contradicts. Stops after `most` faces. Returns the number of face pairs entered.
    pub fn grow(&mut self, start: u32, target: u32, colours: &[u64], most: usize) -> usize {
        let mut queue = VecDeque::from([(start, target), (start ^ 1, target ^ 1)]);
        let mut entered = 0;
        while let Some((half_edge, image)) = queue.pop_front().filter(|_| entered < most) {
            let holes = [half_edge, image].map(|side| self.half_edges.face[side as usize] == NONE);
            if self.image[half_edge as usize] == image || holes == [true, true] {
                continue;
            }
            if holes == [false, false] && self.enter_face(half_edge, image, colours) {
                entered += 1;
                let around = self.half_edges.loop_of(half_edge);
                queue.extend(around.map(|side| (side ^ 1, self.image[side as usize] ^ 1)));
            } else {
                self.refused.push((half_edge, image));
            }
        }
        entered
    }

    fn enter_face(&mut self, half_edge: u32, image: u32, colours: &[u64]) -> bool {
        let mark = self.mark();
        let alike = |vertex: u32, partner: u32| colours[vertex as usize] == colours[partner as usize];
        let (mut side, mut side_image) = (half_edge, image);
        loop {
            if !self.join(side, side_image, alike) {
                self.rollback(mark);
                return false;
            }
            side = self.half_edges.next[side as usize];
            side_image = self.next_image(side_image);
            if side == half_edge || side_image == image {
                break;
            }
        }
        let degrees_agree = side == half_edge && side_image == image;
        if !degrees_agree {
            self.rollback(mark);
        }
        degrees_agree
    }

    /// Enters a pair of half-edges and of vertices both ways, unless the vertices are paired otherwise.
    fn enter(&mut self, half_edge: u32, image: u32, vertex: u32, partner: u32) -> bool {
        let fits = |known: u32, wanted: u32| known == NONE || known == wanted;
        let (known, known_back) = (self.vertex_image[vertex as usize], self.vertex_image[partner as usize]);
        if !fits(known, partner) || !fits(known_back, vertex) {
            return false;
        }
        if known == NONE {
            self.pair(vertex, partner);
        }
        self.image[half_edge as usize] = image;
        self.image[image as usize] = half_edge;
        self.half_edge_log.push(half_edge);
        true
    }

    /// Image of the half-edge after the one whose image is `image`.
    fn next_image(&self, image: u32) -> u32 {
        match self.kind {
            SymmetryKind::Reflection => self.half_edges.previous[image as usize],
            SymmetryKind::HalfTurn => self.half_edges.next[image as usize],
        }
    }

    fn previous_image(&self, image: u32) -> u32 {
        match self.kind {
            SymmetryKind::Reflection => self.half_edges.next[image as usize],
            SymmetryKind::HalfTurn => self.half_edges.previous[image as usize],
        }
    }

    /// Image of the vertex that the half-edge with image `image` points to.
    fn end_image(&self, image: u32) -> u32 {
        match self.kind {
            SymmetryKind::Reflection => self.half_edges.start_vertex(image),
            SymmetryKind::HalfTurn => self.half_edges.to_vertex[image as usize],
        }
    }

    /// The present state.
    pub fn mark(&self) -> Mark {
        Mark {
            half_edges: self.half_edge_log.len(),
            vertices: self.vertex_log.len(),
            refused: self.refused.len(),
        }
    }

    /// Takes back everything since `mark`.
    pub fn rollback(&mut self, mark: Mark) {
        for half_edge in self.half_edge_log.drain(mark.half_edges..) {
            let image = std::mem::replace(&mut self.image[half_edge as usize], NONE);
            self.image[image as usize] = NONE;
        }
        for vertex in self.vertex_log.drain(mark.vertices..) {
            let image = std::mem::replace(&mut self.vertex_image[vertex as usize], NONE);
            if image != NONE {
                self.vertex_image[image as usize] = NONE;
            }
        }
        self.refused.truncate(mark.refused);
    }

    /// Half-edges across which growing stopped since `mark`, with the images that did not fit.
    pub fn refused_since(&self, mark: Mark) -> &[(u32, u32)] {
        &self.refused[mark.refused..]
    }

    /// Enters a pair of vertices that have none.
    pub fn pair(&mut self, vertex: u32, partner: u32) {
        self.vertex_image[vertex as usize] = partner;
        self.vertex_image[partner as usize] = vertex;
        self.vertex_log.push(vertex);
    }

    /// Forgets the image of a vertex and of its partner.
    pub fn unpair(&mut self, vertex: u32) {
        let image = std::mem::replace(&mut self.vertex_image[vertex as usize], NONE);
        if image != NONE {
            self.vertex_image[image as usize] = NONE;
        }
    }
}
