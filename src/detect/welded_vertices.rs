//! Which of the caller's vertices a point is, where it is several.
//!
//! Importers and exporters double vertices at seams, and a detection works on places. The faces say which vertex is meant: the
//! corner of a face goes to the corner of its mirror image. So faces go to faces in the caller's numbering, too.

use crate::base::symmetry_kind::SymmetryKind;
use crate::detect::correspondence::SurfacePoint;
use crate::geometry::embedded_triangles::TrianglePoint;
use crate::mesh::{Mesh, NONE, bucket};

/// How corners are compared: by so many of their points, and whether the other way round than the map goes. A face that goes to a face
/// says the most; one that was turned over may be meant, or one cut along another diagonal, of which an edge says it.
const BY: [(usize, bool); 3] = [(3, false), (3, true), (2, false)];

/// Most faces at one side of an edge that are looked at.
const CROWD: usize = 32;

/// Moves the `partners` of the caller's vertices at welded points to the vertices that the faces say, for a map of points to their `images`.
///
/// Vertices whose faces correspond are each other's partners. Where left and right are not split alike, several have one partner. A vertex
/// of which no face says anything keeps the one that it has. O(corners), and the logarithm of how many are at a welded point.
pub fn choose_by_faces(mesh: &Mesh, images: &[u32], kind: SymmetryKind, partners: &mut [i32]) {
    let corners = WeldedCorners::new(mesh);
    let image = |point: u32| if point == NONE { NONE } else { images[point as usize] };
    let mut is_open = vec![true; partners.len()];
    for (points, otherwise) in BY {
        let reverses = (kind == SymmetryKind::Reflection) != otherwise;
        for mutual in [true, false] {
            for corner in 0..corners.vertex.len() {
                let vertex = corners.vertex[corner];
                if !is_open[vertex as usize] {
                    continue;
                }
                let at = corners.at[corner];
                let [to, after, behind] = [at, corners.next[corner], corners.before[corner]].map(image);
                let wanted = if reverses { [to, behind, after] } else { [to, after, behind] };
                let is_free = |other: u32| !mutual || is_open[other as usize];
                let Some(other) = corners.find(wanted, points, is_free) else { continue };
                if !mutual {
                    partners[vertex as usize] = other as i32;
                    is_open[vertex as usize] = false;
                } else if image(to) == at {
                    for [own, other] in [[vertex, other], [other, vertex]] {
                        partners[own as usize] = other as i32;
                        is_open[own as usize] = false;
                    }
                }
            }
        }
    }
}

/// The corners of the caller's faces at points that are several vertices.
#[derive(Default)]
struct WeldedCorners {
    /// The point of each, the one after it in its face and the one before it, and its vertex.
    at: Vec<u32>,
    next: Vec<u32>,
    before: Vec<u32>,
    vertex: Vec<u32>,
    /// Those at a point: `(next, corner)` sorted, from `starts[point]` to `starts[point + 1]`.
    starts: Vec<u32>,
    sorted: Vec<(u32, u32)>,
}

impl WeldedCorners {
    fn new(mesh: &Mesh) -> WeldedCorners {
        let mut found = WeldedCorners::default();
        let Some(faces) = &mesh.given_faces else { return found };
        let mut is_welded = vec![false; mesh.point_count()];
        for (&point, vertex) in mesh.point_of_vertex.iter().zip(0..).filter(|(point, _)| **point != NONE) {
            is_welded[point as usize] |= mesh.vertex_of_point[point as usize] != vertex;
        }
        for face in 0..faces.len() {
            let vertices = faces.corners_of(face);
            let point = |place: usize| mesh.point_of_vertex[vertices[place % vertices.len()] as usize];
            for (place, &vertex) in vertices.iter().enumerate() {
                let at = point(place);
                if at != NONE && is_welded[at as usize] {
                    found.at.push(at);
                    found.next.push(point(place + 1));
                    found.before.push(point(place + vertices.len() - 1));
                    found.vertex.push(vertex);
                }
            }
        }
        let (starts, order) = bucket(found.at.iter().copied(), mesh.point_count());
        found.sorted = order.iter().map(|&corner| (found.next[corner as usize], corner)).collect();
        for ends in starts.windows(2) {
            found.sorted[ends[0] as usize..ends[1] as usize].sort_unstable();
        }
        found.starts = starts;
        found
    }

    /// The vertex at the first corner with these points, or with the first two of them, whose vertex may be taken.
    fn find(&self, [at, next, before]: [u32; 3], points: usize, may_be: impl Fn(u32) -> bool) -> Option<u32> {
        if at == NONE || next == NONE {
            return None;
        }
        let there = &self.sorted[self.starts[at as usize] as usize..self.starts[at as usize + 1] as usize];
        let first = there.partition_point(|corner| corner.0 < next);
        let alike = there[first..].iter().take(CROWD).filter(|corner| corner.0 == next);
        let alike = alike.map(|corner| corner.1 as usize);
        let alike = alike.filter(|&corner| points < 3 || self.before[corner] == before);
        alike.map(|corner| self.vertex[corner]).find(|&vertex| may_be(vertex))
    }
}

/// The triangles over the caller's vertices.
pub struct OwnCorners {
    /// Of each triangle those of its face.
    vertices: Vec<[u32; 3]>,
    /// A triangle with each vertex, or [`NONE`].
    triangle_of: Vec<u32>,
}

impl OwnCorners {
    /// O(corners).
    pub fn new(mesh: &Mesh) -> OwnCorners {
        let mut vertex_at = mesh.vertex_of_point.clone();
        let mut vertices = vec![[0; 3]; mesh.triangles.len()];
        let (starts, order) = bucket(mesh.face_of_triangle.iter().copied(), mesh.face_count);
        for (face, ends) in starts.windows(2).enumerate().filter(|(_, ends)| ends[0] < ends[1]) {
            let corners = mesh.given_faces.as_ref().map_or(&[][..], |faces| faces.corners_of(face));
            for &vertex in corners.iter().filter(|&&vertex| mesh.point_of_vertex[vertex as usize] != NONE) {
                vertex_at[mesh.point_of_vertex[vertex as usize] as usize] = vertex;
            }
            for &triangle in &order[ends[0] as usize..ends[1] as usize] {
                vertices[triangle as usize] =
                    mesh.triangles[triangle as usize].map(|point| vertex_at[point as usize]);
            }
        }
        let mut triangle_of = vec![NONE; mesh.point_of_vertex.len()];
        for (triangle, corners) in (0..).zip(&vertices) {
            corners.iter().for_each(|&vertex| triangle_of[vertex as usize] = triangle);
        }
        OwnCorners { vertices, triangle_of }
    }

    /// A point of the surface over the caller's vertices; one that is a vertex lies in a face of the `partner`.
    pub fn surface_point(&self, mesh: &Mesh, image: &TrianglePoint, partner: u32) -> SurfacePoint {
        let at = |triangle: u32, barycentric: [f32; 3]| SurfacePoint {
            face: mesh.face_of_triangle[triangle as usize],
            vertices: self.vertices[triangle as usize],
            barycentric,
        };
        let own = at(image.triangle, image.barycentric);
        let (vertex, triangle) = (own.vertices[image.heaviest()], self.triangle_of[partner as usize]);
        let is_there = mesh.point_of_vertex[vertex as usize] == mesh.point_of_vertex[partner as usize];
        if image.barycentric[image.heaviest()] < 1.0 || vertex == partner || !is_there || triangle == NONE {
            return own;
        }
        at(triangle, self.vertices[triangle as usize].map(|vertex| if vertex == partner { 1.0 } else { 0.0 }))
    }
}
