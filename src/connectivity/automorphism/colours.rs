//! Colours of vertices that no mirroring changes: Weisfeiler and Leman, "The reduction of a graph to
//! canonical form" (1968), on the vertices of a polygon mesh. A colour is a hash of the ring around a
//! vertex as a multiset, so that a neighbourhood and its mirror image agree.

use crate::base::symmetry_kind::SymmetryKind;
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

/// The partner of each vertex that alone sees the mirror image of what its partner alone sees (or, under a half turn, the same), within as few
/// rings as tell both from all others; [`NONE`] for others. O(half-edges + vertices log vertices).
pub(super) fn only_pairs(half_edges: &HalfEdges, valences: &[u64], kind: SymmetryKind) -> Vec<u32> {
    let mut partner = vec![NONE; valences.len()];
    let (mut seen, mut mirrored) = (valences.to_vec(), valences.to_vec());
    for _ in 0..FAR {
        (seen, mirrored) = refined_in_order(half_edges, &seen, &mirrored);
        let classes = Classes::new(&seen);
        let only = |vertex: u32| match kind {
            SymmetryKind::Reflection => classes.only(&seen, mirrored[vertex as usize]),
            SymmetryKind::HalfTurn => match *classes.members(vertex) {
                [first, second] => Some(if first == vertex { second } else { first }),
                _ => None,
            },
        };
        for vertex in 0..valences.len() as u32 {
            let is_free = |vertex: u32| partner[vertex as usize] == NONE;
            if let Some(image) =
                only(vertex).filter(|&image| is_free(vertex) && is_free(image) && only(image) == Some(vertex))
            {
                partner[vertex as usize] = image;
                partner[image as usize] = vertex;
            }
        }
    }
    partner
}

/// One round of colours as seen from outside, and as seen in a mirror: each vertex takes in the colours around it in their order.
fn refined_in_order(half_edges: &HalfEdges, seen: &[u64], mirrored: &[u64]) -> (Vec<u64>, Vec<u64>) {
    let around = |own: &[u64]| own.iter().map(|&colour| hash(colour)).collect::<Vec<_>>();
    let (mut there, mut in_mirror) = (around(seen), around(mirrored));
    for half_edge in 0..half_edges.count() as u32 {
        let before = half_edges.start_vertex(half_edges.previous[half_edge as usize]) as usize;
        let (own, after) =
            (half_edges.start_vertex(half_edge) as usize, half_edges.to_vertex[half_edge as usize] as usize);
        // Whether there is a face, or a hole.
        let between = u64::from(half_edges.face[half_edge as usize] == NONE);
        let pair = |first: u64, second: u64| hash(hash(first) ^ second ^ between);
        there[own] = there[own].wrapping_add(pair(seen[before], seen[after]));
        in_mirror[own] = in_mirror[own].wrapping_add(pair(mirrored[after], mirrored[before]));
    }
    (there, in_mirror)
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

    /// The only vertex with a colour, of the `colours` that were grouped.
    pub fn only(&self, colours: &[u64], colour: u64) -> Option<u32> {
        let first = self.members.partition_point(|&vertex| colours[vertex as usize] < colour);
        match self.members[first..]
            .iter()
            .take(2)
            .filter(|&&vertex| colours[vertex as usize] == colour)
            .collect::<Vec<_>>()[..]
        {
            [&only] => Some(only),
            _ => None,
        }
    }

    /// Whether two vertices have one colour.
    pub fn same(&self, first: u32, second: u32) -> bool {
        self.class_of[first as usize] == self.class_of[second as usize]
    }
}
