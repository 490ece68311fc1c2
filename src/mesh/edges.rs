//! Edges of polygons, grouped by counting sort: linear time, no hashing.

use super::polygons::{Polygons, bucket};

/// The half-edges of polygons grouped by their undirected edge.
///
/// Half-edge `h` runs from corner `h` to the next corner of the same polygon.
pub struct EdgeTable {
    /// Edge `e` has the half-edges `half_edges[starts[e]..starts[e + 1]]`.
    starts: Vec<u32>,
    half_edges: Vec<u32>,
    /// Vertex at the end of each half-edge.
    heads: Vec<u32>,
}

impl EdgeTable {
    /// Groups the half-edges of `polygons`.
    pub fn new(polygons: &Polygons, vertex_count: usize) -> EdgeTable {
        EdgeTable::of(vertex_count, &polygons.corners, &next_corners(&polygons.offsets))
    }

    /// Groups the half-edges of faces: each has a tail, and a next one.
    pub fn of(vertex_count: usize, tails: &[u32], next: &[u32]) -> EdgeTable {
        let heads: Vec<u32> = next.iter().map(|&corner| tails[corner as usize]).collect();
        let lowest = tails.iter().zip(&heads).map(|(&tail, &head)| tail.min(head));
        let (buckets, mut half_edges) = bucket(lowest, vertex_count);
        let highest = |half_edge: u32| tails[half_edge as usize].max(heads[half_edge as usize]);
        let mut starts = Vec::with_capacity(half_edges.len() / 2 + 1);
        for vertex in 0..vertex_count {
            let (begin, end) = (buckets[vertex] as usize, buckets[vertex + 1] as usize);
            half_edges[begin..end].sort_unstable_by_key(|&half_edge| (highest(half_edge), half_edge));
            for at in begin..end {
                if at == begin || highest(half_edges[at]) != highest(half_edges[at - 1]) {
                    starts.push(at as u32);
                }
            }
        }
        starts.push(half_edges.len() as u32);
        EdgeTable { starts, half_edges, heads }
    }

    /// The half-edges of each edge.
    pub fn edges(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|pair| &self.half_edges[pair[0] as usize..pair[1] as usize])
    }

    /// Vertex at the end of a half-edge.
    pub fn head(&self, half_edge: u32) -> u32 {
        self.heads[half_edge as usize]
    }

    /// Number of edges with more than two half-edges.
    pub fn non_manifold_count(&self) -> usize {
        self.edges().filter(|edge| edge.len() > 2).count()
    }
}

/// Number of vertices whose polygons form more than one fan (are not connected by edges at the vertex).
pub fn non_manifold_vertex_count(polygons: &Polygons, edges: &EdgeTable, vertex_count: usize) -> usize {
    let mut fans = UnionFind::new(polygons.corners.len());
    let next = next_corners(&polygons.offsets);
    for edge in edges.edges() {
        let first = edge[0];
        for &other in &edge[1..] {
            let same_direction = polygons.corners[first as usize] == polygons.corners[other as usize];
            let (tail, head) =
                if same_direction { (other, next[other as usize]) } else { (next[other as usize], other) };
            fans.join(first, tail);
            fans.join(next[first as usize], head);
        }
    }
    let mut fan_of_vertex = vec![u32::MAX; vertex_count];
    let mut non_manifold = vec![false; vertex_count];
    for (corner, &vertex) in polygons.corners.iter().enumerate() {
        let fan = fans.find(corner as u32);
        let known = &mut fan_of_vertex[vertex as usize];
        non_manifold[vertex as usize] |= *known != u32::MAX && *known != fan;
        *known = fan;
    }
    non_manifold.iter().filter(|&&is| is).count()
}

/// The corner after each one in its face; faces are between `offsets`.
pub fn next_corners(offsets: &[u32]) -> Vec<u32> {
    let mut next: Vec<u32> = (1..=*offsets.last().unwrap_or(&0)).collect();
    for face in offsets.windows(2) {
        next[face[1] as usize - 1] = face[0];
    }
    next
}

/// Disjoint sets with path halving; the lowest element represents each set.
pub struct UnionFind(Vec<u32>);

impl UnionFind {
    /// `count` sets of one element.
    pub fn new(count: usize) -> UnionFind {
        UnionFind((0..count as u32).collect())
    }

    /// The lowest element of the set that holds `element`.
    pub fn find(&mut self, mut element: u32) -> u32 {
        while self.0[element as usize] != element {
            let grandparent = self.0[self.0[element as usize] as usize];
            self.0[element as usize] = grandparent;
            element = grandparent;
        }
        element
    }

    /// Joins two sets.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
