//! Closes seams: boundary edges in the same place become one edge.
//!
//! Only boundary edges take part, so closed shells that merely touch are not glued together; and a whole edge must coincide, so that
//! patches which meet in a point alone are not pinched there. Edges in exactly the same place are joined, however many. Two that are as near
//! as rounding and noise leave them are joined if no third one is there and their polygons continue each other: sheets that lie over
//! each other stay apart.

use super::edges::{EdgeTable, UnionFind};
use super::polygons::Polygons;
use super::vector::{Vector, dot, mean, squared_norm, subtract};
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::collections::HashSet;

/// Largest distance between ends that are joined: as a share of the shortest edge at any of them, and in halves of the mesh's box.
const REACH: f64 = 1.0 / 256.0;
const NOISE: f64 = 1.0 / 16384.0;
/// Cosine of the angle between two polygons at an edge from which on they lie over each other.
const FOLDED: f64 = 0.98;
/// Most edges at a place that are looked at: where there are more nothing is nearly in one place.
const CROWD: usize = 32;

/// The sets of vertices that are joined, or `None` if there is no seam. O(corners + boundary edges log boundary edges).
pub fn seams(polygons: &Polygons, edges: &EdgeTable, positions: &[Vector]) -> Option<UnionFind> {
    let boundary = boundary_edges_by_position(polygons, edges, positions);
    let (mut exact, mut lone) = (Vec::new(), Vec::new());
    for there in boundary.chunk_by(|a, b| a.place == b.place) {
        match there {
            [edge] => lone.push(edge.half_edge),
            _ => exact.extend(
                there
                    .windows(2)
                    .flat_map(|pair| [0, 1].map(|end| [pair[0].vertices[end], pair[1].vertices[end]])),
            ),
        }
    }
    let mut near = Lips::new(polygons, edges, positions, &lone).joins();
    let mut sets = joined(positions.len(), &[&exact, &near])?;
    if !near.is_empty() {
        let folded = polygons_on_themselves(polygons, &mut sets);
        near.retain(|pair| !folded.contains(&sets.find(pair[0])));
        sets = joined(positions.len(), &[&exact, &near])?;
    }
    Some(sets)
}

/// The sets that these pairs make of all vertices; `None` if no two vertices are joined.
pub fn joined(count: usize, pairs: &[&[[u32; 2]]]) -> Option<UnionFind> {
    let pairs = || pairs.iter().copied().flatten().filter(|[a, b]| a != b);
    pairs().next()?;
    let mut sets = UnionFind::new(count);
    pairs().for_each(|&[a, b]| sets.join(a, b));
    Some(sets)
}

/// The sets that hold two corners of one polygon.
fn polygons_on_themselves(polygons: &Polygons, sets: &mut UnionFind) -> HashSet<u32> {
    let mut corners = Vec::new();
    let mut found = HashSet::new();
    for polygon in 0..polygons.len() {
        corners.clear();
        corners.extend(polygons.corners_of(polygon).iter().map(|&corner| sets.find(corner)));
        corners.sort_unstable();
        found.extend(corners.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]));
    }
    found
}

/// A boundary edge, its ends ordered by position.
struct BoundaryEdge {
    /// Keys of the two positions.
    place: [[u64; 3]; 2],
    vertices: [u32; 2],
    half_edge: u32,
}

/// The boundary edges of some length, those at the same place next to each other.
fn boundary_edges_by_position(
    polygons: &Polygons,
    edges: &EdgeTable,
    positions: &[Vector],
) -> Vec<BoundaryEdge> {
    let mut boundary: Vec<BoundaryEdge> = edges
        .edges()
        .filter(|edge| edge.len() == 1)
        .map(|edge| {
            let ends = [polygons.corners[edge[0] as usize], edges.head(edge[0])];
            let mut ends = ends.map(|vertex| (position_key(positions[vertex as usize]), vertex));
            ends.sort_unstable();
            BoundaryEdge { place: ends.map(|end| end.0), vertices: ends.map(|end| end.1), half_edge: edge[0] }
        })
        .filter(|edge| edge.place[0] != edge.place[1])
        .collect();
    boundary.sort_unstable_by_key(|edge| (edge.place, edge.vertices));
    boundary
}

/// Equal exactly where positions are equal (the two zeros are), and totally ordered.
fn position_key(position: Vector) -> [u64; 3] {
    position.map(|coordinate| (coordinate + 0.0).to_bits())
}

/// Boundary edges that no other edge lies on exactly.
struct Lips<'a> {
    positions: &'a [Vector],
    lips: Vec<Lip>,
    /// Their middles, each with its lip.
    middles: RTree<GeomWithData<Vector, usize>>,
}

/// One of them.
struct Lip {
    ends: [u32; 2],
    polygon: usize,
    /// The corner of the polygon after the edge.
    next: u32,
    middle: Vector,
    /// Distance within which the ends of another are its own.
    reach: f64,
}

impl<'a> Lips<'a> {
    fn new(polygons: &Polygons, edges: &EdgeTable, positions: &'a [Vector], half_edges: &[u32]) -> Lips<'a> {
        let shortest =
            if half_edges.is_empty() { Vec::new() } else { shortest_edges(polygons, edges, positions) };
        let lip = |&half_edge: &u32| {
            let ends = [polygons.corners[half_edge as usize], edges.head(half_edge)];
            let polygon = polygons.offsets.partition_point(|&offset| offset <= half_edge) - 1;
            let corners = polygons.corners_of(polygon);
            let place = (half_edge - polygons.offsets[polygon]) as usize;
            let [a, b] = ends.map(|end| shortest[end as usize]);
            Lip {
                ends,
                polygon,
                next: corners[(place + 2) % corners.len()],
                middle: mean(ends.map(|end| positions[end as usize])),
                reach: (REACH * a.min(b)).min(NOISE),
            }
        };
        let lips: Vec<Lip> = half_edges.iter().map(lip).collect();
        let middle = |(index, lip): (usize, &Lip)| GeomWithData::new(lip.middle, index);
        let middles = RTree::bulk_load(lips.iter().enumerate().map(middle).collect());
        Lips { positions, lips, middles }
    }

    /// Pairs of vertices that become one.
    fn joins(&self) -> Vec<[u32; 2]> {
        let partners: Vec<Option<usize>> = (0..self.lips.len()).map(|lip| self.partner(lip)).collect();
        let pairs = partners.iter().enumerate().filter_map(|(lip, partner)| Some((lip, (*partner)?)));
        pairs
            .filter(|&(lip, partner)| lip < partner && partners[partner] == Some(lip))
            .filter_map(|(lip, partner)| Some((self.lips[lip].ends, self.facing(lip, partner)?)))
            .flat_map(|([a, b], [c, d])| [[a, c], [b, d]])
            .collect()
    }

    /// The only lip in the place of another, if it continues that one's polygon.
    fn partner(&self, lip: usize) -> Option<usize> {
        let Lip { middle, reach, .. } = self.lips[lip];
        let mut found = None;
        for (looked_at, there) in self.middles.locate_within_distance(middle, reach * reach).enumerate() {
            let is_facing = there.data != lip && self.facing(lip, there.data).is_some();
            if looked_at > CROWD || (is_facing && found.replace(there.data).is_some()) {
                return None;
            }
        }
        found.filter(|&other| self.continues(lip, other))
    }

    /// The ends of `other` that lie at those of `lip`.
    fn facing(&self, lip: usize, other: usize) -> Option<[u32; 2]> {
        let (own, other) = (&self.lips[lip], &self.lips[other]);
        let reach = own.reach.min(other.reach);
        let [a, b] = other.ends;
        let is_near = |ends: &[u32; 2]| {
            own.ends.iter().zip(ends).all(|(&end, &there)| {
                let apart = subtract(self.positions[end as usize], self.positions[there as usize]);
                squared_norm(apart) <= reach * reach
            })
        };
        [[b, a], [a, b]].into_iter().find(is_near)
    }

    /// Whether two lips' polygons are different ones that do not lie over each other.
    fn continues(&self, lip: usize, other: usize) -> bool {
        let (own, other) = (&self.lips[lip], &self.lips[other]);
        let [a, b] = own.ends.map(|end| self.positions[end as usize]);
        let along = subtract(b, a);
        let inward = |of: &Lip| {
            let to = subtract(self.positions[of.next as usize], of.middle);
            let share = dot(to, along) / squared_norm(along);
            [0, 1, 2].map(|axis| to[axis] - share * along[axis])
        };
        let (u, v) = (inward(own), inward(other));
        own.polygon != other.polygon && dot(u, v) < FOLDED * (squared_norm(u) * squared_norm(v)).sqrt()
    }
}

/// The length of the shortest edge at each vertex.
fn shortest_edges(polygons: &Polygons, edges: &EdgeTable, positions: &[Vector]) -> Vec<f64> {
    let mut shortest = vec![f64::INFINITY; positions.len()];
    for (half_edge, &tail) in polygons.corners.iter().enumerate() {
        let head = edges.head(half_edge as u32);
        let length = squared_norm(subtract(positions[head as usize], positions[tail as usize])).sqrt();
        for end in [tail, head] {
            shortest[end as usize] = shortest[end as usize].min(length);
        }
    }
    shortest
}
