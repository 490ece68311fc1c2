//! Half-edge connectivity of polygon meshes, built by OpenMesh (see `cpp/`).
//!
//! OpenMesh is found by pkg-config, or in the folder that the environment variable `OPENMESH_DIR` names, or built from the
//! source that `OPENMESH_SOURCE` names. Every bridged function returns `Result`, because a C++ exception terminates the process
//! elsewhere.
#![allow(unsafe_code)] // The bridge is one of the two places that may.

pub use cxx::Exception;

/// No face, or no half-edge.
pub const NONE: u32 = u32::MAX;

#[cxx::bridge(namespace = "intrinsym")]
mod bridge {
    unsafe extern "C++" {
        include!("openmesh-sys/cpp/half_edges.h");

        type HalfEdgeMesh;

        fn build_half_edge_mesh(
            vertex_count: usize,
            offsets: &[u32],
            vertices: &[u32],
        ) -> Result<UniquePtr<HalfEdgeMesh>>;
        fn half_edge_count(self: &HalfEdgeMesh) -> Result<usize>;
        fn copy_half_edges(
            self: &HalfEdgeMesh,
            to_vertex: &mut [u32],
            next: &mut [u32],
            previous: &mut [u32],
            face: &mut [u32],
        ) -> Result<()>;
        fn copy_outgoing(self: &HalfEdgeMesh, outgoing: &mut [u32]) -> Result<()>;
    }
}

/// Half-edge connectivity as OpenMesh numbers it: `h ^ 1` is the opposite of `h`.
#[derive(Debug, Clone)]
pub struct HalfEdgeArrays {
    /// Vertex a half-edge points to.
    pub to_vertex: Vec<u32>,
    /// Next half-edge around the face or the hole.
    pub next: Vec<u32>,
    /// Previous half-edge around the face or the hole.
    pub previous: Vec<u32>,
    /// Face to the left, or [`NONE`].
    pub face: Vec<u32>,
    /// One outgoing half-edge per vertex, the boundary one if there is one, or [`NONE`].
    pub outgoing: Vec<u32>,
}

/// Builds the connectivity of manifold polygons: face `f` is `vertices[offsets[f]..offsets[f + 1]]`.
///
/// # Errors
/// OpenMesh's reason for polygons that are not manifold.
pub fn half_edge_arrays(
    vertex_count: usize,
    offsets: &[u32],
    vertices: &[u32],
) -> Result<HalfEdgeArrays, Exception> {
    let mesh = bridge::build_half_edge_mesh(vertex_count, offsets, vertices)?;
    let empty = vec![NONE; mesh.half_edge_count()?];
    let mut arrays = HalfEdgeArrays {
        to_vertex: empty.clone(),
        next: empty.clone(),
        previous: empty.clone(),
        face: empty,
        outgoing: vec![NONE; vertex_count],
    };
    mesh.copy_half_edges(&mut arrays.to_vertex, &mut arrays.next, &mut arrays.previous, &mut arrays.face)?;
    mesh.copy_outgoing(&mut arrays.outgoing)?;
    Ok(arrays)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_face_arrives_as_an_error() {
        let missing_vertex = half_edge_arrays(3, &[0, 3], &[0, 1, 7]);
        assert!(matches!(missing_vertex, Err(reason) if reason.what().contains("face 0")));
        assert!(half_edge_arrays(3, &[0, 2], &[0, 1]).is_err());
        assert!(half_edge_arrays(3, &[0, 9], &[0, 1, 2]).is_err());
        assert!(half_edge_arrays(3, &[], &[]).is_err());
    }

    #[test]
    fn one_triangle_has_its_hole_on_the_other_side() {
        let arrays = half_edge_arrays(3, &[0, 3], &[0, 1, 2]).unwrap();
        assert_eq!(arrays.face.iter().filter(|&&face| face == NONE).count(), 3);
        for half_edge in 0..6 {
            assert_eq!(arrays.previous[arrays.next[half_edge] as usize], half_edge as u32);
        }
        assert!(arrays.outgoing.iter().all(|&half_edge| arrays.face[half_edge as usize] == NONE));
    }
}
