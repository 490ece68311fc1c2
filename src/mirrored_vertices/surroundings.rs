//! What is around each point: neighbours, those whom a flip would make neighbours, and directions along the surface.

use crate::adjacency::Adjacency;
use crate::embedded_triangles::Fans;
use crate::mesh::vector::{Vector, cross, squared_norm, subtract};
use crate::mesh::{Mesh, NONE};

/// Triangles around a vertex from which on it is a hub, as the middle of a cap or the pole of a lathe is. Every two points near
/// two hubs would be a pair to vote for, and which of them belong together is seen at no hub.
const HUB: usize = 48;

/// Whether a point has so many triangles around it that it says nothing of those near it.
pub(super) fn is_hub(triangles_around: usize) -> bool {
    triangles_around >= HUB
}

/// What is around the points of a mesh. Hubs have nothing around them, and are around nothing.
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
        let is_ordinary = |point: &u32| !is_hub(fans.of(*point).len());
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
    let mut normals = vec![[0.0; 3]; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|point| mesh.positions[point as usize]);
        let normal = cross(subtract(b, a), subtract(c, a));
        for &point in triangle {
            (0..3).for_each(|axis| normals[point as usize][axis] += normal[axis]);
        }
    }
    let unit = |v: Vector| v.map(|x| x / squared_norm(v).sqrt().max(f64::MIN_POSITIVE));
    let frame = |&normal: &Vector| {
        let smallest = (0..3).min_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
        let axis = std::array::from_fn(|k| f64::from(u8::from(k == smallest)));
        let first = unit(cross(normal, axis));
        [first, unit(cross(normal, first))]
    };
    normals.iter().map(frame).collect()
}
