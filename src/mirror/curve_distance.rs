//! Distance to the fixed curve along the surface: fast marching.
//!
//! R. Kimmel, J. A. Sethian, "Computing geodesic paths on manifolds", 1998. A triangle's third corner takes
//! the shortest of the straight paths through the opposite edge, along which the distance is linear. We deviate
//! in not splitting obtuse triangles: there the path along an edge may be taken, which is a little longer.

use crate::detect::correspondence::{EdgePoint, Symmetry};
use crate::geometry::adjacency::Adjacency;
use crate::mesh::vector::{Vector, dot, subtract};
use crate::mesh::{Mesh, NONE};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Distance of the caller's vertices from the fixed curve, in the unit of `positions`.
///
/// `positions` has one entry per caller's vertex. Infinite where the curve cannot be reached: on other shells,
/// at vertices that no face uses, and everywhere if there is no curve. O(n log n) for n vertices.
///
/// # Panics
/// If `positions` has not one entry per vertex.
pub fn curve_distances(mesh: &Mesh, symmetry: &Symmetry, positions: &[Vector]) -> Vec<f64> {
    assert_eq!(positions.len(), mesh.point_of_vertex.len());
    let mut front = Front::new(mesh, positions);
    for line in &symmetry.fixed_curve {
        let closing = line.points.first().filter(|_| line.closed);
        let next = line.points.iter().skip(1).chain(closing).chain(line.points.last());
        line.points.iter().zip(next).for_each(|(start, end)| front.start(start, end));
    }
    front.march();
    let of_vertex = |&point: &u32| if point == NONE { f64::INFINITY } else { front.distance[point as usize] };
    mesh.point_of_vertex.iter().map(of_vertex).collect()
}

/// A distance in the queue; all are positive, so their bits are in their order.
type Entry = Reverse<(u64, u32)>;

struct Front<'a> {
    mesh: &'a Mesh,
    positions: Vec<Vector>,
    /// The triangles around each point.
    around: Adjacency,
    distance: Vec<f64>,
    queue: BinaryHeap<Entry>,
}

impl<'a> Front<'a> {
    fn new(mesh: &'a Mesh, positions: &[Vector]) -> Front<'a> {
        Front {
            mesh,
            positions: mesh.vertex_of_point.iter().map(|&vertex| positions[vertex as usize]).collect(),
            around: Adjacency::triangles_around(mesh.positions.len(), &mesh.triangles),
            distance: vec![f64::INFINITY; mesh.positions.len()],
            queue: BinaryHeap::new(),
        }
    }

    fn improve(&mut self, point: u32, distance: f64) {
        if distance < self.distance[point as usize] {
            self.distance[point as usize] = distance;
            self.queue.push(Reverse((distance.to_bits(), point)));
        }
    }

    /// Sets the ends of the edges that a piece of the curve joins.
    fn start(&mut self, start: &EdgePoint, end: &EdgePoint) {
        let ends = [start, end].map(|crossing| {
            [crossing.from, crossing.to].map(|vertex| self.mesh.point_of_vertex[vertex as usize])
        });
        if ends.as_flattened().contains(&NONE) {
            return;
        }
        let place = |edge: [u32; 2], t: f32| {
            let [a, b] = edge.map(|point| self.positions[point as usize]);
            [0, 1, 2].map(|axis| a[axis] + f64::from(t) * (b[axis] - a[axis]))
        };
        let segment = [place(ends[0], start.t), place(ends[1], end.t)];
        for &point in ends.as_flattened() {
            let distance = distance_to_segment(self.positions[point as usize], segment);
            self.improve(point, distance);
        }
    }

    fn march(&mut self) {
        while let Some(Reverse((bits, point))) = self.queue.pop() {
            if f64::from_bits(bits) > self.distance[point as usize] {
                continue;
            }
            for index in 0..self.around.of(point as usize).len() {
                let triangle = self.mesh.triangles[self.around.of(point as usize)[index] as usize];
                for other in triangle.into_iter().filter(|&other| other != point) {
                    let third = triangle.into_iter().find(|&third| third != point && third != other);
                    self.pass(point, other, third.unwrap_or(point));
                }
            }
        }
    }

    /// Improves `target` by paths that leave the edge from `near` to `far`.
    fn pass(&mut self, near: u32, target: u32, far: u32) {
        let [at_near, at_far] = [near, far].map(|point| self.distance[point as usize]);
        let [a, b, c] = [near, far, target].map(|point| self.positions[point as usize]);
        let (edge, side) = (subtract(b, a), subtract(c, a));
        let (length, along_edge) = (dot(edge, edge).sqrt(), dot(side, side).sqrt());
        let mut best = at_near + along_edge;
        let slope = (at_far - at_near) / length;
        if slope.abs() < 1.0 {
            let x = dot(side, edge) / length;
            let height = (along_edge * along_edge - x * x).max(0.0).sqrt();
            let leaves = x - slope * height / (1.0 - slope * slope).sqrt();
            if (0.0..=length).contains(&leaves) {
                best = best.min(at_near + slope * leaves + (x - leaves).hypot(height));
            }
        }
        self.improve(target, best);
    }
}

fn distance_to_segment(point: Vector, [start, end]: [Vector; 2]) -> f64 {
    let (along, lever) = (subtract(end, start), subtract(point, start));
    let squared = dot(along, along);
    let t = if squared > 0.0 { (dot(lever, along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    let gap = [0, 1, 2].map(|axis| lever[axis] - t * along[axis]);
    dot(gap, gap).sqrt()
}
