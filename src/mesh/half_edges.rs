//! Half-edge connectivity of the polygons, for the traversals that need topology.
//!
//! Built by OpenMesh ([`openmesh_sys`]) from polygons that are made manifold first (`super::fans`),
//! so that no file is refused for one bad edge. The structure is that of Botsch, Steinberg, Bischoff and
//! Kobbelt, "OpenMesh: a generic and efficient polygon mesh data structure" (2002). Memory is linear:
//! about 36 bytes per half-edge while it is built, 16 afterwards.

use super::{NONE, fans};
use crate::base::error::{Error, Result};

/// Half-edges of a manifold polygon mesh with boundary, as flat arrays.
///
/// `h ^ 1` is the opposite of half-edge `h`. Vertices are the fans of the given points: a point where
/// several fans meet has several vertices, one that no face refers to has none.
#[derive(Debug, Clone)]
pub struct HalfEdges {
    /// Vertex each half-edge points to.
    pub to_vertex: Vec<u32>,
    /// Next half-edge around the face or, on the boundary, around the hole.
    pub next: Vec<u32>,
    /// Previous half-edge around the face or the hole.
    pub previous: Vec<u32>,
    /// Face on the left, numbered as given, or [`NONE`] on the boundary.
    pub face: Vec<u32>,
    /// One outgoing half-edge per vertex, the boundary one where there is a boundary.
    pub outgoing: Vec<u32>,
    /// Given point of each vertex, rising.
    pub point_of_vertex: Vec<u32>,
    /// Number of points given.
    pub point_count: usize,
}

impl HalfEdges {
    /// Connects polygons over `point_count` points: face `f` is `points[offsets[f]..offsets[f + 1]]`.
    ///
    /// Non-manifold edges are cut and non-manifold points split. Cost O(corners). `Mesh::polygon_offsets` and
    /// `Mesh::polygon_points` are the intended input.
    ///
    /// # Errors
    /// [`Error::Internal`] if the offsets do not rise, a face has fewer than three corners or a corner
    /// is not a point: a validated mesh has none of these.
    pub fn new(point_count: usize, offsets: &[u32], points: &[u32]) -> Result<HalfEdges> {
        check(point_count, offsets, points)?;
        let fans = fans::split(point_count, offsets, points);
        let arrays = openmesh_sys::half_edge_arrays(fans.point_of_vertex.len(), offsets, &fans.corner_vertex)
            .map_err(|reason| Error::Internal(format!("half-edge bridge: {reason}")))?;
        Ok(HalfEdges {
            to_vertex: arrays.to_vertex,
            next: arrays.next,
            previous: arrays.previous,
            face: arrays.face,
            outgoing: arrays.outgoing,
            point_of_vertex: fans.point_of_vertex,
            point_count,
        })
    }

    /// Number of half-edges, twice that of edges.
    pub fn count(&self) -> usize {
        self.to_vertex.len()
    }

    /// Number of vertices: the fans of the given points.
    pub fn vertex_count(&self) -> usize {
        self.outgoing.len()
    }

    /// Vertex that half-edge `half_edge` starts from.
    pub fn start_vertex(&self, half_edge: u32) -> u32 {
        self.to_vertex[(half_edge ^ 1) as usize]
    }

    /// Half-edges that leave `vertex`, clockwise.
    pub fn outgoing_of(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.outgoing[vertex as usize];
        let turn = move |&half_edge: &u32| {
            let following = self.next[(half_edge ^ 1) as usize];
            (following != first).then_some(following)
        };
        std::iter::successors(Some(first), turn)
    }

    /// Half-edges around the face or hole on the left of `half_edge`, starting with it.
    pub fn loop_of(&self, half_edge: u32) -> impl Iterator<Item = u32> + '_ {
        let turn = move |&current: &u32| {
            let following = self.next[current as usize];
            (following != half_edge).then_some(following)
        };
        std::iter::successors(Some(half_edge), turn)
    }
}

fn check(point_count: usize, offsets: &[u32], points: &[u32]) -> Result<()> {
    let refuse = |reason: String| Err(Error::Internal(format!("half-edges: {reason}")));
    if offsets.first() != Some(&0) || offsets.last().map(|&last| last as usize) != Some(points.len()) {
        return refuse("the face offsets do not span the corners".into());
    }
    if let Some(face) = offsets.windows(2).position(|pair| pair[1] < pair[0].saturating_add(3)) {
        return refuse(format!("face {face} has fewer than three corners"));
    }
    if let Some(corner) = points.iter().position(|&point| point as usize >= point_count || point == NONE) {
        return refuse(format!("corner {corner} refers to a missing point"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn polygons(faces: &[&[u32]]) -> (Vec<u32>, Vec<u32>) {
        let mut offsets = vec![0];
        for face in faces {
            offsets.push(offsets[offsets.len() - 1] + face.len() as u32);
        }
        (offsets, faces.concat())
    }

    fn connect(point_count: usize, faces: &[&[u32]]) -> HalfEdges {
        let (offsets, points) = polygons(faces);
        HalfEdges::new(point_count, &offsets, &points).unwrap()
    }

    /// Every invariant of the structure, and that the faces are those given.
    fn assert_consistent(half_edges: &HalfEdges, offsets: &[u32], points: &[u32]) {
        let point = |half_edge: u32| half_edges.point_of_vertex[half_edges.start_vertex(half_edge) as usize];
        for half_edge in 0..half_edges.count() as u32 {
            let next = half_edges.next[half_edge as usize];
            assert_eq!(half_edges.previous[next as usize], half_edge);
            assert_eq!(half_edges.start_vertex(next), half_edges.to_vertex[half_edge as usize]);
            assert_eq!(half_edges.face[next as usize], half_edges.face[half_edge as usize]);
            assert!(
                half_edges.outgoing_of(half_edges.start_vertex(half_edge)).any(|other| other == half_edge)
            );
            let face = half_edges.face[half_edge as usize];
            if face != NONE {
                let given = &points[offsets[face as usize] as usize..offsets[face as usize + 1] as usize];
                let start = given.iter().position(|&corner| corner == point(half_edge)).unwrap();
                let found: Vec<u32> = half_edges.loop_of(half_edge).map(point).collect();
                let rotations = given.iter().filter(|&&corner| corner == given[start]).count();
                assert_eq!(found.len(), given.len());
                assert!(rotations > 1 || found == [&given[start..], &given[..start]].concat());
            }
        }
        assert_eq!(half_edges.face.iter().filter(|&&face| face != NONE).count(), points.len());
    }

    #[test]
    fn two_quads_share_an_edge_and_a_boundary() {
        let (offsets, points) = polygons(&[&[0, 1, 2, 3], &[3, 2, 4, 5]]);
        let half_edges = HalfEdges::new(7, &offsets, &points).unwrap();
        assert_eq!((half_edges.count(), half_edges.vertex_count()), (14, 6));
        assert_eq!(half_edges.point_of_vertex, [0, 1, 2, 3, 4, 5]);
        let boundary = (0..14).find(|&half_edge| half_edges.face[half_edge as usize] == NONE).unwrap();
        assert_eq!(half_edges.loop_of(boundary).count(), 6);
        assert_consistent(&half_edges, &offsets, &points);
    }

    #[test]
    fn a_bow_tie_point_becomes_two_vertices() {
        let half_edges = connect(5, &[&[0, 1, 2], &[0, 3, 4]]);
        assert_eq!(half_edges.point_of_vertex, [0, 0, 1, 2, 3, 4]);
    }

    #[test]
    fn three_faces_on_an_edge_are_cut_apart() {
        let half_edges = connect(5, &[&[0, 1, 2], &[1, 0, 3], &[0, 1, 4]]);
        assert_eq!(half_edges.vertex_count(), 9);
    }

    #[test]
    fn a_moebius_band_and_a_repeated_corner_are_accepted() {
        let band: [&[u32]; 3] = [&[0, 1, 3, 2], &[2, 3, 5, 4], &[4, 5, 0, 1]];
        let (offsets, points) = polygons(&band);
        assert_consistent(&HalfEdges::new(6, &offsets, &points).unwrap(), &offsets, &points);
        let half_edges = connect(4, &[&[0, 1, 2, 1], &[1, 0, 3]]);
        assert_eq!(half_edges.face.iter().filter(|&&face| face != NONE).count(), 7);
    }

    #[test]
    fn bad_arrays_are_refused_before_the_bridge() {
        assert!(HalfEdges::new(3, &[0, 3], &[0, 1, 3]).is_err());
        assert!(HalfEdges::new(3, &[0, 2], &[0, 1]).is_err());
        assert!(HalfEdges::new(3, &[0, 3, 2], &[0, 1]).is_err());
        assert!(HalfEdges::new(3, &[], &[]).is_err());
        assert!(HalfEdges::new(0, &[0], &[]).unwrap().count() == 0);
    }

    proptest! {
        #[test]
        fn any_polygon_soup_becomes_manifold(
            faces in prop::collection::vec(prop::collection::vec(0u32..8, 3..6), 0..14)
        ) {
            let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
            let (offsets, points) = polygons(&faces);
            let half_edges = HalfEdges::new(8, &offsets, &points).unwrap();
            assert_consistent(&half_edges, &offsets, &points);
        }
    }
}
