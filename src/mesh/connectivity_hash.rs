//! A hash of who is joined with whom, so that a stored map is known to be stale.
//!
//! FNV-1a with 64 bits: G. Fowler, L. C. Noll, K.-P. Vo, RFC 9923. It guards against accidents, not attacks.

use super::{Mesh, PolygonMesh};

const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// The hash of: number of vertices and of faces (64 bits each), then all face offsets and all corners (32 bits
/// each), little-endian. Positions do not count. O(corners).
pub fn connectivity_hash(mesh: &PolygonMesh) -> u64 {
    let counts = [mesh.positions.len() as u64, mesh.face_offsets.len().saturating_sub(1) as u64];
    let counts = counts.into_iter().flat_map(u64::to_le_bytes);
    let indices = mesh.face_offsets.iter().chain(&mesh.face_vertices).flat_map(|index| index.to_le_bytes());
    counts.chain(indices).fold(OFFSET_BASIS, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
}

impl Mesh {
    /// The same of the validated polygons, with the point of each caller's vertex; word by word, so not the same value.
    pub fn connectivity_hash(&self) -> u64 {
        let counts = [self.positions.len() as u32, self.point_of_vertex.len() as u32];
        let indices = self.point_of_vertex.iter().chain(&self.polygon_offsets).chain(&self.polygon_points);
        let words = counts.iter().chain(indices);
        words.fold(OFFSET_BASIS, |hash, &word| (hash ^ u64::from(word)).wrapping_mul(PRIME))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> PolygonMesh {
        let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        PolygonMesh { positions, face_offsets: vec![0, 3], face_vertices: vec![0, 1, 2] }
    }

    #[test]
    fn the_hash_follows_connectivity_and_nothing_else() {
        let hash = connectivity_hash(&triangle());
        // Computed by an independent FNV-1a over the same bytes (Python).
        assert_eq!(hash, EXPECTED);
        let mut moved = triangle();
        moved.positions[0] = [5.0, 5.0, 5.0];
        assert_eq!(connectivity_hash(&moved), hash);
        let mut turned = triangle();
        turned.face_vertices = vec![1, 2, 0];
        assert_ne!(connectivity_hash(&turned), hash);
        let mut lonely = triangle();
        lonely.positions.push([1.0; 3]);
        assert_ne!(connectivity_hash(&lonely), hash);
    }

    const EXPECTED: u64 = 0xb413_afe9_c21f_0af7;
}
