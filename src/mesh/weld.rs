//! Closes seams: boundary edges between exactly the same two positions become one edge.
//!
//! Only boundary edges take part, so closed shells that merely touch are not glued together; and a whole
//! edge must coincide, so that patches which meet in a point alone are not pinched there.

use super::edges::{EdgeTable, UnionFind};
use super::polygons::Polygons;

/// The lowest vertex that each vertex is joined to (itself for most), or `None` if there is no seam.
pub fn seam_representatives(
    polygons: &Polygons,
    edges: &EdgeTable,
    positions: &[[f64; 3]],
) -> Option<Vec<u32>> {
    let seams = boundary_edges_by_position(polygons, edges, positions);
    let mut sets = UnionFind::new(if seams.is_empty() { 0 } else { positions.len() });
    let mut found = false;
    for pair in seams.windows(2).filter(|pair| pair[0].place == pair[1].place) {
        for end in 0..2 {
            sets.join(pair[0].vertices[end], pair[1].vertices[end]);
            found |= pair[0].vertices[end] != pair[1].vertices[end];
        }
    }
    found.then(|| (0..positions.len() as u32).map(|vertex| sets.find(vertex)).collect())
}

/// A boundary edge, its ends ordered by position.
struct BoundaryEdge {
    /// Keys of the two positions.
    place: [[u64; 3]; 2],
    vertices: [u32; 2],
}

/// The boundary edges of some length, those at the same place next to each other.
fn boundary_edges_by_position(
    polygons: &Polygons,
    edges: &EdgeTable,
    positions: &[[f64; 3]],
) -> Vec<BoundaryEdge> {
    let mut boundary: Vec<BoundaryEdge> = edges
        .edges()
        .filter(|edge| edge.len() == 1)
        .map(|edge| [polygons.corners[edge[0] as usize], edges.head(edge[0])])
        .map(|ends| {
            let mut ends = ends.map(|vertex| (position_key(positions[vertex as usize]), vertex));
            ends.sort_unstable();
            BoundaryEdge { place: ends.map(|end| end.0), vertices: ends.map(|end| end.1) }
        })
        .filter(|edge| edge.place[0] != edge.place[1])
        .collect();
    boundary.sort_unstable_by_key(|edge| (edge.place, edge.vertices));
    boundary
}

/// Equal exactly where positions are equal (the two zeros are), and totally ordered.
fn position_key(position: [f64; 3]) -> [u64; 3] {
    position.map(|coordinate| (coordinate + 0.0).to_bits())
}
