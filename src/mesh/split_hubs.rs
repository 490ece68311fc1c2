//! Vertices of very many triangles as several vertices in one place, for algorithms whose work grows with the square of a degree.

use super::vector::Vector;

/// Most triangles around a vertex.
pub const MOST_AROUND: u32 = 256;

/// A triangle mesh without hubs.
pub struct SplitHubs {
    /// The positions given, then those of the copies of hubs.
    pub positions: Vec<Vector>,
    /// The triangles given: each 256 of a hub have a copy of their own, the first the hub itself.
    pub triangles: Vec<[u32; 3]>,
    /// The vertex that each vertex is a copy of, or itself.
    original: Vec<u32>,
    /// Triangles with two hubs or three.
    between_hubs: usize,
}

impl SplitHubs {
    /// `None` where no vertex is a hub. O(vertices + triangles).
    pub fn new(positions: &[Vector], triangles: &[[u32; 3]]) -> Option<SplitHubs> {
        let mut used = vec![0; positions.len()];
        triangles.as_flattened().iter().for_each(|&corner| used[corner as usize] += 1);
        if used.iter().all(|&triangles| triangles <= MOST_AROUND) {
            return None;
        }
        used.fill(0);
        let mut split = SplitHubs {
            positions: positions.to_vec(),
            triangles: triangles.to_vec(),
            original: (0..positions.len() as u32).collect(),
            between_hubs: 0,
        };
        let mut copy_of: Vec<u32> = split.original.clone();
        for corner in split.triangles.as_flattened_mut() {
            let vertex = *corner as usize;
            if used[vertex] == MOST_AROUND {
                (used[vertex], copy_of[vertex]) = (0, split.original.len() as u32);
                split.original.push(*corner);
                split.positions.push(positions[vertex]);
            }
            used[vertex] += 1;
            *corner = copy_of[vertex];
        }
        let is_hub = |corner: &&u32| copy_of[**corner as usize] != **corner;
        let hubs = triangles.iter().map(|corners| corners.iter().filter(is_hub).count());
        split.between_hubs = hubs.filter(|&hubs| hubs > 1).count();
        Some(split)
    }

    /// Whether hubs are joined by more triangles than one vertex may have, as a fan on one edge is: nothing of that can be split.
    pub fn has_fan(&self) -> bool {
        self.between_hubs > MOST_AROUND as usize
    }

    /// Triangles of the copies as triangles of what they are copies of; those that become lines are left out.
    pub fn joined(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let joined = triangles.iter().map(|corners| corners.map(|corner| self.original[corner as usize]));
        joined.filter(|&[a, b, c]| a != b && b != c && c != a).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_copy_has_few_triangles_and_joins_again() {
        let count = 1000;
        let triangles: Vec<[u32; 3]> = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
        let positions = vec![[0.0; 3]; count as usize + 1];
        let split = SplitHubs::new(&positions, &triangles).unwrap();
        let mut around = vec![0; split.positions.len()];
        split.triangles.as_flattened().iter().for_each(|&corner| around[corner as usize] += 1);
        assert_eq!(
            (around[0], around.len(), around.iter().max()),
            (MOST_AROUND, positions.len() + 3, Some(&MOST_AROUND))
        );
        assert_eq!(split.joined(&split.triangles), triangles);
        assert!(split.joined(&[[0, 1001, 5]]).is_empty() && !split.has_fan());
        let fan: Vec<[u32; 3]> = (2..count).map(|tip| [0, 1, tip]).collect();
        assert!(SplitHubs::new(&positions, &fan).unwrap().has_fan());
        assert!(SplitHubs::new(&positions, &triangles[..MOST_AROUND as usize]).is_none());
    }
}
