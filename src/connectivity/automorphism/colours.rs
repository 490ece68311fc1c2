//! Colours of vertices that no mirroring changes: Weisfeiler and Leman, "The reduction of a graph to
//! canonical form" (1968), on the vertices of a polygon mesh. A colour is a hash of the ring around a
//! vertex as a multiset, so that a neighbourhood and its mirror image agree.

use crate::mesh::NONE;
use crate::mesh::half_edges::HalfEdges;

/// Rounds of colours, beside the first: vertices alike within as many rings share a colour.
const FAR: usize = 6;

/// Colours of all vertices at two ranges.
pub(super) struct Colours {
    /// Valence, face degrees and boundary.
    pub valences: Vec<u64>,
    /// The surroundings that tell most irregular vertices apart.
    pub far: Vec<u64>,
}

impl Colours {
    /// Refines round by round; cost O(half-edges) each.
    pub fn new(half_edges: &HalfEdges) -> Self {
        let sides = hashed_sides(half_edges);
        let valences = refined(half_edges, &sides, &vec![0; half_edges.vertex_count()]);
        let far = (0..FAR).fold(valences.clone(), |colours, _| refined(half_edges, &sides, &colours));
        Colours { valences, far }
    }
}

/// Per edge, a hash of the degrees of the two faces beside it, in no order.
fn hashed_sides(half_edges: &HalfEdges) -> Vec<u64> {
    let degrees = face_degrees(half_edges);
    let degree = |face: u32| if face == NONE { 0 } else { u64::from(degrees[face as usize]) };
    let beside = half_edges.face.chunks_exact(2);
    beside.map(|faces| hash(hash(degree(faces[0])).wrapping_add(hash(degree(faces[1]))))).collect()
}

/// One round: each vertex takes in the colours around it and the faces between.
fn refined(half_edges: &HalfEdges, sides: &[u64], colours: &[u64]) -> Vec<u64> {
    let mut rings = vec![0u64; colours.len()];
    for (ends, sides) in half_edges.to_vertex.chunks_exact(2).zip(sides) {
        let (to, from) = (ends[0] as usize, ends[1] as usize);
        rings[from] = rings[from].wrapping_add(hash(colours[to] ^ sides));
        rings[to] = rings[to].wrapping_add(hash(colours[from] ^ sides));
    }
    for (ring, colour) in rings.iter_mut().zip(colours) {
        *ring = hash(colour.rotate_left(17) ^ *ring);
    }
    rings
}

fn face_degrees(half_edges: &HalfEdges) -> Vec<u32> {
    let faces = half_edges.face.iter().filter(|&&face| face != NONE);
    let mut degrees = vec![0; faces.clone().max().map_or(0, |&face| face as usize + 1)];
    for &face in faces {
        degrees[face as usize] += 1;
    }
    degrees
}

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014).
pub fn hash(value: u64) -> u64 {
    let value = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}

/// Vertices grouped by colour.
pub(super) struct Classes {
    class_of: Vec<u32>,
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Classes {
    /// Groups by equal colour; members of a class rise.
    pub fn new(colours: &[u64]) -> Self {
        let mut members: Vec<u32> = (0..colours.len() as u32).collect();
        members.sort_unstable_by_key(|&vertex| (colours[vertex as usize], vertex));
        let mut class_of = vec![0; colours.len()];
        let mut starts = Vec::new();
        for (position, &vertex) in members.iter().enumerate() {
            let first = position == 0 || colours[members[position - 1] as usize] != colours[vertex as usize];
            if first {
                starts.push(position as u32);
            }
            class_of[vertex as usize] = starts.len() as u32 - 1;
        }
        starts.push(members.len() as u32);
        Classes { class_of, starts, members }
    }

    /// All vertices of the class of `vertex`, itself included.
    pub fn members(&self, vertex: u32) -> &[u32] {
        let class = self.class_of[vertex as usize] as usize;
        &self.members[self.starts[class] as usize..self.starts[class + 1] as usize]
    }

    /// Whether two vertices have one colour.
    pub fn same(&self, first: u32, second: u32) -> bool {
        self.class_of[first as usize] == self.class_of[second as usize]
    }
}
