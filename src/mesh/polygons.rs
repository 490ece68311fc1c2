//! The kept polygons while they are repaired: degenerate and duplicate faces leave here.

use super::{PolygonMesh, RepairReport};

/// Polygons over vertices, each with the caller's face it came from.
#[derive(Debug, Clone, Default)]
pub struct Polygons {
    /// Polygon `p` has the corners `corners[offsets[p]..offsets[p + 1]]`.
    pub offsets: Vec<u32>,
    /// Vertex (later: point) of each corner.
    pub corners: Vec<u32>,
    /// The caller's face of each polygon.
    pub faces: Vec<u32>,
}

impl Polygons {
    /// The caller's faces without repeated corners; degenerate ones are dropped and counted.
    pub fn clean(mesh: &PolygonMesh, repairs: &mut RepairReport) -> Polygons {
        Polygons::given(mesh).without_degenerate(repairs)
    }

    /// The caller's faces as they are.
    pub fn given(mesh: &PolygonMesh) -> Polygons {
        let faces = (0..mesh.face_offsets.len() as u32 - 1).collect();
        Polygons { offsets: mesh.face_offsets.clone(), corners: mesh.face_vertices.clone(), faces }
    }

    /// Number of polygons.
    pub fn len(&self) -> usize {
        self.faces.len()
    }

    /// Corners of one polygon.
    pub fn corners_of(&self, polygon: usize) -> &[u32] {
        &self.corners[self.offsets[polygon] as usize..self.offsets[polygon + 1] as usize]
    }

    /// The polygon of each corner.
    pub fn polygon_of_corner(&self) -> Vec<u32> {
        let mut owner = Vec::with_capacity(self.corners.len());
        for polygon in 0..self.len() {
            owner.resize(self.offsets[polygon + 1] as usize, polygon as u32);
        }
        owner
    }

    /// Drops repeated corners, and polygons with fewer than three distinct corners.
    pub fn without_degenerate(self, repairs: &mut RepairReport) -> Polygons {
        let mut kept = Polygons::with_capacity(self.len(), self.corners.len());
        let mut corners = Vec::new();
        for polygon in 0..self.len() {
            drop_repeated_corners(self.corners_of(polygon), &mut corners);
            if corners.len() < 3 {
                repairs.degenerate_faces += 1;
            } else {
                kept.push(&corners, self.faces[polygon]);
            }
        }
        kept
    }

    /// Drops polygons with the same set of corners as an earlier one. Linear but for the sorting of
    /// the few polygons that share their lowest corner.
    pub fn without_duplicates(self, vertex_count: usize, repairs: &mut RepairReport) -> Polygons {
        let mut sorted = self.clone();
        for pair in self.offsets.windows(2) {
            sorted.corners[pair[0] as usize..pair[1] as usize].sort_unstable();
        }
        let order = sorted_lists(vertex_count, self.len(), |polygon| sorted.corners_of(polygon as usize));
        let mut duplicate = vec![false; self.len()];
        for pair in order.windows(2) {
            let [before, own] = [0, 1].map(|at| sorted.corners_of(pair[at] as usize));
            duplicate[pair[1] as usize] = before == own;
        }
        let count = duplicate.iter().filter(|&&is_duplicate| is_duplicate).count();
        repairs.duplicate_faces += count;
        if count == 0 { self } else { self.retain(|polygon| !duplicate[polygon]) }
    }

    /// The polygons for which `keep` answers true, in their order.
    pub fn retain(&self, keep: impl Fn(usize) -> bool) -> Polygons {
        let mut kept = Polygons::with_capacity(self.len(), self.corners.len());
        for polygon in (0..self.len()).filter(|&polygon| keep(polygon)) {
            kept.push(self.corners_of(polygon), self.faces[polygon]);
        }
        kept
    }

    /// Reverses the corners of one polygon, keeping the first.
    pub fn flip(&mut self, polygon: usize) {
        self.corners[self.offsets[polygon] as usize + 1..self.offsets[polygon + 1] as usize].reverse();
    }

    fn with_capacity(polygons: usize, corners: usize) -> Polygons {
        let mut offsets = Vec::with_capacity(polygons + 1);
        offsets.push(0);
        Polygons { offsets, corners: Vec::with_capacity(corners), faces: Vec::with_capacity(polygons) }
    }

    fn push(&mut self, corners: &[u32], face: u32) {
        self.corners.extend_from_slice(corners);
        self.offsets.push(self.corners.len() as u32);
        self.faces.push(face);
    }
}

/// The places of lists of numbers below `count`, each from its smallest on, in the order of the lists. O(count) beyond the lists that
/// start alike.
pub fn sorted_lists<'a>(count: usize, lists: usize, list: impl Fn(u32) -> &'a [u32]) -> Vec<u32> {
    let (starts, mut order) = bucket((0..lists as u32).map(|place| list(place)[0]), count);
    for ends in starts.windows(2) {
        order[ends[0] as usize..ends[1] as usize]
            .sort_unstable_by(|&a, &b| list(a).cmp(list(b)).then(a.cmp(&b)));
    }
    order
}

/// Counting sort: `(starts, items)` where `items[starts[k]..starts[k + 1]]` are the positions of key `k`
/// in `keys`, rising.
pub fn bucket(keys: impl Iterator<Item = u32> + Clone, key_count: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; key_count + 1];
    for key in keys.clone() {
        starts[key as usize + 1] += 1;
    }
    for key in 0..key_count {
        starts[key + 1] += starts[key];
    }
    let mut next = starts.clone();
    let mut items = vec![0u32; starts[key_count] as usize];
    for (item, key) in keys.enumerate() {
        items[next[key as usize] as usize] = item as u32;
        next[key as usize] += 1;
    }
    (starts, items)
}

/// Writes `corners` to `kept` without consecutive repetitions and without spikes (`a b a`), cyclically.
fn drop_repeated_corners(corners: &[u32], kept: &mut Vec<u32>) {
    kept.clear();
    for &corner in corners {
        match kept.as_slice() {
            [.., last] if *last == corner => {}
            [.., before, _] if *before == corner => {
                kept.pop();
            }
            _ => kept.push(corner),
        }
    }
    let mut start = 0;
    while kept.len() - start >= 2 {
        let (end, spike_at_start) = (kept.len(), kept[start + 1] == kept[kept.len() - 1]);
        if kept[start] == kept[end - 1] || kept[start] == kept[end - 2] {
            kept.pop();
        } else if spike_at_start {
            start += 1;
        } else {
            break;
        }
    }
    kept.drain(..start);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dropped(corners: &[u32]) -> Vec<u32> {
        let mut kept = Vec::new();
        drop_repeated_corners(corners, &mut kept);
        kept
    }

    #[test]
    fn repeated_corners_and_spikes_are_dropped() {
        assert_eq!(dropped(&[0, 1, 2]), [0, 1, 2]);
        assert_eq!(dropped(&[0, 0, 1, 1, 2, 2]), [0, 1, 2]);
        assert_eq!(dropped(&[0, 1, 2, 0]), [0, 1, 2]);
        assert_eq!(dropped(&[0, 1, 2, 3, 2]), [0, 1, 2]);
        assert!(dropped(&[0, 1, 0, 1]).len() < 3);
        assert!(dropped(&[0, 1, 2, 1]).len() < 3);
        assert!(dropped(&[5, 5, 5]).len() < 3);
        assert!(dropped(&[]).is_empty());
    }

    #[test]
    fn a_spike_at_the_start_is_dropped() {
        assert_eq!(dropped(&[9, 0, 1, 2, 0]), [0, 1, 2]);
    }

    #[test]
    fn a_keyhole_polygon_keeps_its_bridge() {
        let keyhole = [0, 1, 2, 3, 0, 4, 5, 6, 7, 4];
        assert_eq!(dropped(&keyhole).len(), 10);
    }
}
