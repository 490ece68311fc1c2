//! What is around each point: neighbours, those whom a flip would make neighbours, and directions along the surface.

use crate::geometry::adjacency::{Adjacency, LOOKS};
use crate::geometry::embedded_triangles::Fans;
use crate::mesh::vector::{Vector, cross, squared_norm, subtract, summed_normals, unit};
use crate::mesh::{Mesh, NONE};

/// What is around the points of a mesh. Hubs, as the middle of a cap or the pole of a lathe, have nothing around them, and are around nothing: every two points near
/// two hubs would be a pair to vote for, and which of them belong together is seen at no hub.
pub(super) struct Surroundings<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Points joined by an edge.
    pub edges: Adjacency,
    /// Points joined by an edge or by one flip.
    pub close: Adjacency,
    /// Two orthonormal directions along the surface at each point.
    pub tangents: Vec<[Vector; 2]>,
}

impl<'a> Surroundings<'a> {
    /// O(points + triangles log degree).
    pub fn new(mesh: &'a Mesh, fans: &Fans) -> Self {
        let count = mesh.positions.len();
        let is_ordinary = |point: &u32| fans.of(*point).len() <= LOOKS;
        let around = |point: u32| fans.of(point).iter().filter(move |_| is_ordinary(&point));
        let edges = Adjacency::from_rows(count, |point, row| {
            for &triangle in around(point) {
                let corners = mesh.triangles[triangle as usize];
                row.extend(corners.into_iter().filter(|&corner| corner != point).filter(is_ordinary));
            }
        });
        let close = Adjacency::from_rows(count, |point, row| {
            let flipped = around(point).filter_map(|&triangle| across(mesh, fans, triangle, point));
            row.extend(edges.of(point as usize).iter().copied().chain(flipped.filter(is_ordinary)));
        });
        Surroundings { mesh, edges, close, tangents: tangents(mesh) }
    }

    /// Mean length from a point to those close to it.
    pub fn mean_length(&self, point: u32) -> f64 {
        let near = self.close.of(point as usize);
        near.iter().map(|&other| self.length(point, other)).sum::<f64>() / near.len().max(1) as f64
    }

    /// The distance of two points.
    pub fn length(&self, a: u32, b: u32) -> f64 {
        squared_norm(self.offset(a, b)).sqrt()
    }

    /// The vector from one point to another.
    pub fn offset(&self, from: u32, to: u32) -> Vector {
        subtract(self.mesh.positions[to as usize], self.mesh.positions[from as usize])
    }
}

/// The point to which the flip of the edge opposite `corner` would join it. An edge of more than two triangles is flipped between
/// two of them that are behind it for each other.
fn across(mesh: &Mesh, fans: &Fans, triangle: u32, corner: u32) -> Option<u32> {
    let corners = mesh.triangles[triangle as usize];
    let opposite = corners.iter().position(|&other| other == corner)?;
    let behind = fans.behind[triangle as usize][opposite];
    let beyond = if behind == NONE { return None } else { mesh.triangles[behind as usize] };
    let far = beyond.iter().position(|point| !corners.contains(point))?;
    (fans.behind[behind as usize][far] == triangle).then_some(beyond[far])
}

/// Two orthonormal directions in the tangent plane of each point.
fn tangents(mesh: &Mesh) -> Vec<[Vector; 2]> {
    let frame = |&normal: &Vector| {
        let smallest = (0..3).min_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
        let axis = std::array::from_fn(|k| f64::from(u8::from(k == smallest)));
        let first = unit(cross(normal, axis));
        [first, unit(cross(normal, first))]
    };
    summed_normals(&mesh.positions, &mesh.triangles).iter().map(frame).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::PolygonMesh;

    /// A cone of `count` triangles around its tip.
    fn cone(count: u32) -> Mesh {
        let angle = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(count);
        let rim = (0..count).map(|i| [angle(i).cos(), angle(i).sin(), 0.0]);
        let polygons = PolygonMesh {
            positions: std::iter::once([0.0, 0.0, 1.0]).chain(rim).collect(),
            face_offsets: (0..=count).map(|face| 3 * face).collect(),
            face_vertices: (0..count).flat_map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect(),
        };
        Mesh::new(&polygons, &Limits::default()).unwrap()
    }

    /// The votes of a pair are as many as the points close to one times those close to the other.
    #[test]
    fn a_hub_has_no_votes_and_leaves_no_more_to_others_whatever_its_degree() {
        let most_close = |count: u32| {
            let mesh = cone(count);
            let around = Surroundings::new(&mesh, &Fans::new(mesh.positions.len(), &mesh.triangles));
            (0..mesh.positions.len()).map(|point| around.close.of(point).len()).max().unwrap()
        };
        assert_eq!(most_close(LOOKS as u32), LOOKS);
        assert_eq!([LOOKS as u32 + 1, 1000, 20_000].map(most_close), [4, 4, 4]);
    }
}
