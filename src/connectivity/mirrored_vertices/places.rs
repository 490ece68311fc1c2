//! Where images are thought to be: the estimate, and after pairing the estimate moved.

use super::percolation::Pairing;
use super::{Estimate, MirroredVertices};
use crate::geometry::adjacency::{Adjacency, downhill};
use crate::geometry::embedded_triangles::{Fans, TrianglePoint};
use crate::geometry::surface_walk::nearest_of;
use crate::mesh::vector::{Vector, squared_norm, subtract};
use crate::mesh::{Mesh, NONE};

/// What is left of a correction one edge farther from a pair.
const DECAY: f64 = 0.9;

/// The place of each point's image.
pub(super) struct Places {
    /// The vertex nearest to it, or [`NONE`].
    pub vertex: Vec<u32>,
    /// Its position.
    pub position: Vec<Vector>,
    /// How far it was moved, if it was.
    moved: Vec<Option<Vector>>,
}

impl Places {
    pub fn new(mesh: &Mesh, estimate: &Estimate) -> Places {
        let position = |point: &TrianglePoint| point.interpolate_vectors(&mesh.triangles, &mesh.positions);
        Places {
            vertex: estimate.partner.to_vec(),
            position: estimate.image.iter().map(position).collect(),
            moved: vec![None; estimate.image.len()],
        }
    }

    /// Sends paired points to their partners, and moves the images of others on their shell as those around them were
    /// moved, less and less with every edge.
    pub fn correct(&mut self, pairing: &Pairing, points: &[u32]) {
        let mut front: Vec<u32> = points.to_vec();
        front.retain(|&point| pairing.image[point as usize] != NONE);
        for &point in &front {
            let image = pairing.image[point as usize];
            let place = pairing.around.mesh.positions[image as usize];
            self.moved[point as usize] = Some(subtract(place, self.position[point as usize]));
            (self.vertex[point as usize], self.position[point as usize]) = (image, place);
        }
        while !front.is_empty() {
            let around = front.iter().flat_map(|&point| pairing.around.edges.of(point as usize));
            let is_next =
                |&point: &u32| self.moved[point as usize].is_none() && self.vertex[point as usize] != NONE;
            let mut next: Vec<u32> = around.copied().filter(is_next).collect();
            next.sort_unstable();
            next.dedup();
            let corrections: Vec<_> =
                next.iter().map(|&point| correction(pairing, &self.moved, point)).collect();
            for (&point, (correction, neighbour)) in next.iter().zip(corrections) {
                self.moved[point as usize] = Some(correction);
                let place = &mut self.position[point as usize];
                (0..3).for_each(|axis| place[axis] += correction[axis]);
                self.vertex[point as usize] = descend(
                    pairing.around.mesh,
                    &pairing.around.edges,
                    self.vertex[neighbour as usize],
                    *place,
                );
            }
            front = next;
        }
    }

    /// The images of `points`, those that are not paired inside triangles.
    pub fn images(&self, pairing: &Pairing, fans: &Fans, points: &[u32]) -> MirroredVertices {
        let (count, mesh) = (self.vertex.len(), pairing.around.mesh);
        let nowhere = TrianglePoint { triangle: 0, barycentric: [1.0, 0.0, 0.0] };
        let mut found = MirroredVertices {
            partner: vec![NONE; count],
            image: vec![nowhere; count],
            paired: vec![false; count],
        };
        for &point in points {
            let vertex = self.vertex[point as usize];
            let paired = pairing.image[point as usize] != NONE;
            let image = match paired {
                true => at_vertex(mesh, fans, vertex),
                false => {
                    let around = fans.of(vertex).iter().copied();
                    nearest_of(self.position[point as usize], &mesh.positions, &mesh.triangles, around).0
                }
            };
            let corners = mesh.triangles[image.triangle as usize];
            found.partner[point as usize] = corners[image.heaviest()];
            found.image[point as usize] = image;
            found.paired[point as usize] = paired;
        }
        found
    }
}

/// Mean correction of the neighbours that have one, decayed, and one of them.
fn correction(pairing: &Pairing, moved: &[Option<Vector>], point: u32) -> (Vector, u32) {
    let (mut sum, mut count, mut neighbour) = ([0.0; 3], 0.0, point);
    for &near in pairing.around.edges.of(point as usize) {
        if let Some(correction) = moved[near as usize] {
            (0..3).for_each(|axis| sum[axis] += correction[axis]);
            (count, neighbour) = (count + 1.0, near);
        }
    }
    (sum.map(|x| DECAY * x / f64::max(count, 1.0)), neighbour)
}

/// The vertex nearest to a position that is reached from `vertex` along edges, always nearer.
pub(super) fn descend(mesh: &Mesh, edges: &Adjacency, vertex: u32, position: Vector) -> u32 {
    let around = |from: u32| edges.of(from as usize).iter().copied();
    let distance = |vertex: u32| squared_norm(subtract(mesh.positions[vertex as usize], position));
    downhill(vertex, around, distance).0
}

/// A vertex as the corner of a triangle.
fn at_vertex(mesh: &Mesh, fans: &Fans, vertex: u32) -> TrianglePoint {
    let triangle = fans.of(vertex)[0];
    let corners = mesh.triangles[triangle as usize];
    TrianglePoint { triangle, barycentric: corners.map(|corner| f32::from(u8::from(corner == vertex))) }
}
