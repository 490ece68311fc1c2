//! Where points beside a shell go, as eyes, teeth and clothes do: with the surface that they sit on.
//!
//! A rigid motion fitted to how a whole region is mapped averages out what the map is off by at each vertex of it, and it says where
//! the room around the surface goes, too.

use super::mapped::{Disc, Mapped};
use super::motion::Motion;
use crate::base::symmetry_kind::SymmetryKind;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::Shell;
use crate::mesh::vector::Vector;

/// Radius, in sqrt(area), of the regions whose motions carry points.
const RADIUS: f64 = 0.12;
/// A region of fewer vertices, as on a coarse mesh, says little of a turn, and is made larger.
const LEAST_VERTICES: usize = 16;
/// From here on a region is the whole of a small piece of the shell.
const LARGEST_RADIUS: f64 = 2.0;
/// What a region says where its weight is this or more is enough: no other is sought there.
const SAID: f64 = 0.5;

/// A shell and its map, which carry what sits on the shell.
pub struct Carrier<'a> {
    mapped: Mapped<'a>,
    /// Of the map.
    pub kind: SymmetryKind,
}

impl<'a> Carrier<'a> {
    /// `images` are those of the shell's vertices. O(vertices).
    pub fn new(shell: &'a Shell, images: &VertexMap, kind: SymmetryKind) -> Carrier<'a> {
        Carrier { mapped: Mapped::new(shell, images), kind }
    }

    /// Where `points` go, each of which sits on the vertex of the shell that `anchors` names; all in the shell's unit.
    ///
    /// O(points x regions), of which there are as many as it takes to cover the anchors.
    pub fn carried(&self, points: &[Vector], anchors: &[u32]) -> Vec<Vector> {
        let mut sums = vec![([0.0; 3], 0.0); points.len()];
        let mut weight_at = vec![0.0; self.mapped.areas.len()];
        for index in 0..anchors.len() {
            if sums[index].1 >= SAID {
                continue;
            }
            let disc = self.region(anchors[index]);
            let places = self.mapped.places(&self.mapped.by_area(&disc.members));
            let motion = Motion::between(&places, self.kind == SymmetryKind::Reflection);
            disc.members.iter().for_each(|&(vertex, weight)| weight_at[vertex as usize] = weight);
            for ((sum, all), (point, &anchor)) in sums.iter_mut().zip(points.iter().zip(anchors)) {
                let weight = weight_at[anchor as usize];
                if weight > 0.0 {
                    let image = motion.of(*point);
                    (0..3).for_each(|axis| sum[axis] += weight * image[axis]);
                    *all += weight;
                }
            }
            disc.members.iter().for_each(|&(vertex, _)| weight_at[vertex as usize] = 0.0);
        }
        sums.into_iter().map(|(sum, all)| sum.map(|x| x / all)).collect()
    }

    fn region(&self, middle: u32) -> Disc {
        let (mut radius, mut reached) = (RADIUS, vec![false; self.mapped.areas.len()]);
        loop {
            let disc = self.mapped.disc(middle, radius, &mut reached);
            if disc.members.len() >= LEAST_VERTICES || radius > LARGEST_RADIUS {
                return disc;
            }
            radius *= 1.5;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::vector::{squared_norm, subtract};
    use crate::mesh::{Mesh, PolygonMesh};
    use crate::refine::rigid_parts::strip;

    /// A strip bent like an S along its length.
    fn bent_strip() -> Shell {
        strip(|column, row| {
            let x = f64::from(column) / 20.0 - 1.0;
            [x, f64::from(row) / 20.0, 0.1 * (x * x * x - x)]
        })
    }

    #[test]
    fn what_sits_on_a_surface_is_turned_with_it_even_if_single_images_are_off() {
        let shell = bent_strip();
        // A half turn about the strip's middle takes its ends to each other and its upper side to its lower one.
        let turned = |local: usize| {
            let point = shell.points[local];
            let image = 5 * (40 - point / 5) + point % 5;
            // Every third image is a row off.
            if point.is_multiple_of(3) { 5 * (image / 5) + (image + 1) % 5 } else { image }
        };
        let local = |point: u32| shell.points.iter().position(|&own| own == point).expect("a point") as u32;
        let partners = (0..shell.points.len()).map(|index| local(turned(index))).collect();
        let images = VertexMap::at_vertices(&shell.triangles, partners);
        let carrier = Carrier::new(&shell, &images, SymmetryKind::HalfTurn);
        for point in [7, 52, 102, 157, 197] {
            let (anchor, opposite) = (local(point), local(5 * (40 - point / 5) + point % 5));
            let above = |anchor: u32, height: f64| {
                let [x, y, z] = shell.positions[anchor as usize];
                [x, y, z + height]
            };
            let carried = carrier.carried(&[above(anchor, 0.05)], &[anchor])[0];
            let off = squared_norm(subtract(carried, above(opposite, -0.05))).sqrt();
            assert!(off < 0.03, "{point}: {off}");
        }
    }

    /// Joined shells may be pieces of one.
    #[test]
    fn a_piece_of_few_vertices_beside_a_large_one_ends_its_region() {
        let mut shell = bent_strip();
        let first = shell.positions.len() as u32;
        shell.positions.extend([[0.0, 0.0, 0.5], [0.1, 0.0, 0.5], [0.0, 0.1, 0.5]]);
        shell.points.extend([first, first + 1, first + 2]);
        shell.triangles.push([first, first + 1, first + 2]);
        shell.triangle_of_local.push(shell.triangles.len() as u32 - 1);
        let images = VertexMap::at_vertices(&shell.triangles, (0..first + 3).collect());
        let carrier = Carrier::new(&shell, &images, SymmetryKind::HalfTurn);
        assert_eq!(carrier.region(first).members.len(), 3);
    }

    #[test]
    fn a_coarse_shell_carries_by_larger_regions() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [1.0, 1.0, 0.0], [0.0, 1.0, 0.1]];
        let polygons = PolygonMesh {
            positions: corners.to_vec(),
            face_offsets: vec![0, 3, 6],
            face_vertices: vec![0, 1, 2, 0, 2, 3],
        };
        let shell = Mesh::new(&polygons, &Limits::default()).expect("a usable mesh").shells().swap_remove(0);
        let images = VertexMap::at_vertices(&shell.triangles, vec![0, 3, 2, 1]);
        let carrier = Carrier::new(&shell, &images, SymmetryKind::Reflection);
        let [a, b] = [1, 3].map(|vertex: usize| shell.positions[vertex]);
        let carried = carrier.carried(&[[a[0], a[1], a[2] + 0.2]], &[1])[0];
        assert!(squared_norm(subtract(carried, [b[0], b[1], b[2] + 0.2])) < 1e-12, "{carried:?}");
    }
}
