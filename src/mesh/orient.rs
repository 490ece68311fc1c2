//! Consistent orientation: breadth first over the edges that exactly two polygons share.

use super::edges::EdgeTable;
use super::polygons::Polygons;
use std::collections::VecDeque;

/// What [`orientation`] decides, per polygon.
pub struct Orientation {
    /// Whether the polygon must be reversed to agree with its neighbours.
    pub flip: Vec<bool>,
    /// Whether the polygon's patch cannot be oriented (such a patch is left as it was given).
    pub conflicting: Vec<bool>,
}

/// Orients each patch (polygons connected over manifold edges) as the majority of its area was given.
pub fn orientation(polygons: &Polygons, edges: &EdgeTable, areas: &[f64]) -> Orientation {
    let neighbours = Neighbours::new(polygons, edges);
    let mut orientation =
        Orientation { flip: vec![false; polygons.len()], conflicting: vec![false; polygons.len()] };
    let mut visited = vec![false; polygons.len()];
    for seed in 0..polygons.len() {
        if !visited[seed] {
            let (patch, consistent) = neighbours.spread(seed, &mut visited, &mut orientation.flip);
            settle(&patch, consistent, areas, &mut orientation);
        }
    }
    orientation
}

/// Keeps the orientation of the majority, or marks the patch as conflicting.
fn settle(patch: &[u32], consistent: bool, areas: &[f64], orientation: &mut Orientation) {
    let mut area = [0.0; 2];
    let mut count = [0usize; 2];
    for &polygon in patch {
        let side = usize::from(orientation.flip[polygon as usize]);
        area[side] += areas[polygon as usize];
        count[side] += 1;
    }
    let tie = (area[0] - area[1]).abs() <= 1e-9 * (area[0] + area[1]);
    let invert = if tie { count[1] > count[0] } else { area[1] > area[0] };
    for &polygon in patch {
        let polygon = polygon as usize;
        orientation.conflicting[polygon] = !consistent;
        orientation.flip[polygon] = consistent && orientation.flip[polygon] != invert;
    }
}

/// Neighbour of each half-edge across a manifold edge, and whether the two run the same way.
struct Neighbours<'a> {
    polygons: &'a Polygons,
    polygon_across: Vec<u32>,
    same_direction: Vec<bool>,
}

impl<'a> Neighbours<'a> {
    fn new(polygons: &'a Polygons, edges: &EdgeTable) -> Neighbours<'a> {
        let owner = polygons.polygon_of_corner();
        let mut polygon_across = vec![u32::MAX; polygons.corners.len()];
        let mut same_direction = vec![false; polygons.corners.len()];
        for edge in edges.edges().filter(|edge| edge.len() == 2) {
            let (a, b) = (edge[0] as usize, edge[1] as usize);
            (polygon_across[a], polygon_across[b]) = (owner[b], owner[a]);
            same_direction[a] = polygons.corners[a] == polygons.corners[b];
            same_direction[b] = same_direction[a];
        }
        Neighbours { polygons, polygon_across, same_direction }
    }

    /// Visits the patch of `seed`, setting `flip` relative to it; false if two ways disagree.
    fn spread(&self, seed: usize, visited: &mut [bool], flip: &mut [bool]) -> (Vec<u32>, bool) {
        let mut patch = Vec::new();
        let mut consistent = true;
        let mut queue = VecDeque::from([seed as u32]);
        visited[seed] = true;
        while let Some(polygon) = queue.pop_front() {
            patch.push(polygon);
            let polygon = polygon as usize;
            for half_edge in self.polygons.offsets[polygon]..self.polygons.offsets[polygon + 1] {
                let across = self.polygon_across[half_edge as usize] as usize;
                if across == u32::MAX as usize {
                    continue;
                }
                let wanted = flip[polygon] != self.same_direction[half_edge as usize];
                if visited[across] {
                    consistent &= flip[across] == wanted;
                } else {
                    visited[across] = true;
                    flip[across] = wanted;
                    queue.push_back(across as u32);
                }
            }
        }
        (patch, consistent)
    }
}
