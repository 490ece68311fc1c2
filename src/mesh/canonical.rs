//! A mesh in a frame and a numbering that depend on its shape alone.
//!
//! Whoever exports a mesh twice may get other numbers, another order of faces, another place, size and direction. Ties, spreads of samples and
//! simplification depend on these, and so would the answer. Points are turned into the frame of their principal axes and numbered along a
//! Z-curve (G. M. Morton, "A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing", 1966), which keeps neighbours near
//! each other in memory, too. Shapes without single principal axes, as a cube, keep the frame that they have.

use super::Mesh;
use super::polygons::sorted_lists;
use super::rotation::{principal_axes, turned};
use super::shells::{EQUAL, partition};
use super::vector::{Vector, cross, dot, subtract, triangle_area};
use std::cmp::Ordering;
use std::ops::Range;

/// Cells of the Z-curve along the longest side of the bounding box, as a power of two.
const BITS: u32 = 21;
/// Positions are rounded to multiples of this, in sqrt(area), so that the rounding errors of another writing are the same numbers: they would grow in the
/// eigenfunctions and in each choice of a nearest vertex.
const GRAIN: f64 = 1.0 / (1 << 28) as f64;

/// A mesh in its own frame and numbering.
pub struct Canonical {
    /// The same mesh; the way back to the caller's vertices and faces is in it.
    pub mesh: Mesh,
    /// The point of the given mesh that each of its points is.
    pub given_points: Vec<u32>,
}

impl Mesh {
    /// This mesh in its own frame and numbering. O(corners log corners).
    pub(crate) fn canonical(&self) -> Canonical {
        let axes = own_axes(&self.positions, &self.triangles);
        let rounded = |x: f64| (x / GRAIN).round() * GRAIN;
        let place = |&position: &Vector| turned(&axes, position).map(rounded);
        let positions: Vec<Vector> = self.positions.iter().map(place).collect();
        let given_points = along_z_curve(&positions);
        let mut new = vec![0; given_points.len()];
        (0..).zip(&given_points).for_each(|(point, &old)| new[old as usize] = point);
        // What looks inwards in that frame is turned over, so that twins of which one was given so look alike.
        let is_mirrored = dot(axes[0], cross(axes[1], axes[2])) < 0.0;
        let inside_out = self.inside_out();
        let turn = |point: u32| is_mirrored != inside_out[self.shell_of_point[point as usize] as usize];
        let ends = |triangle: usize| 3 * triangle..3 * triangle + 3;
        let corners = self.triangles.as_flattened();
        let (triangles, corners) = sorted(corners, self.triangles.len(), ends, &new, turn);
        let ends = |face: usize| self.polygon_offsets[face] as usize..self.polygon_offsets[face + 1] as usize;
        let count = self.face_of_polygon.len();
        let (polygons, polygon_points) = sorted(&self.polygon_points, count, ends, &new, turn);
        let mut polygon_offsets = vec![0];
        for &polygon in &polygons {
            polygon_offsets
                .push(polygon_offsets[polygon_offsets.len() - 1] + ends(polygon as usize).len() as u32);
        }
        let mut mesh = Mesh {
            positions: picked(&positions, &given_points),
            triangles: corners.as_chunks().0.to_vec(),
            face_of_triangle: picked(&self.face_of_triangle, &triangles),
            polygon_offsets,
            polygon_points,
            face_of_polygon: picked(&self.face_of_polygon, &polygons),
            point_of_vertex: self.point_of_vertex.clone(),
            vertex_of_point: picked(&self.vertex_of_point, &given_points),
            shell_of_point: Vec::new(),
            shell_orientable: self.shell_orientable.clone(),
            given_faces: self.given_faces.clone(),
            repairs: self.repairs.clone(),
            ..*self
        };
        for point in mesh.point_of_vertex.iter_mut().filter(|point| **point != super::NONE) {
            *point = new[*point as usize];
        }
        mesh.shell_of_point = partition(&mesh.triangles, &mesh.positions).shell_of_point;
        for (&shell, &old) in mesh.shell_of_point.iter().zip(&given_points) {
            let given = self.shell_of_point[old as usize] as usize;
            mesh.shell_orientable[shell as usize] = self.shell_orientable[given];
        }
        Canonical { mesh, given_points }
    }
}

/// The values at some places.
fn picked<T: Copy>(values: &[T], places: &[u32]) -> Vec<T> {
    places.iter().map(|&place| values[place as usize]).collect()
}

/// Turns a cycle so that the smallest comes first.
fn from_smallest(cycle: &mut [u32]) {
    let smallest = (0..cycle.len()).min_by_key(|&place| cycle[place]).unwrap_or(0);
    cycle.rotate_left(smallest);
}

/// Faces, each between its `ends` among `corners`, over new numbers and turned over if their corners `turn`: their former places in the order of
/// their corners, each from its smallest on, and these. O(points) beyond the faces that start alike.
fn sorted(
    corners: &[u32],
    count: usize,
    ends: impl Fn(usize) -> Range<usize>,
    new: &[u32],
    turn: impl Fn(u32) -> bool,
) -> (Vec<u32>, Vec<u32>) {
    let given = corners;
    let mut corners = picked(new, given);
    for face in 0..count {
        let corners = &mut corners[ends(face)];
        if turn(given[ends(face).start]) {
            corners.reverse();
        }
        from_smallest(corners);
    }
    let list = |face: u32| &corners[ends(face as usize)];
    let order = sorted_lists(new.len(), count, list);
    let sorted = order.iter().flat_map(|&face| list(face)).copied().collect();
    (order, sorted)
}

/// Means over a surface of what triangles have in the mean.
fn mean_over<const N: usize>(
    positions: &[Vector],
    triangles: &[[u32; 3]],
    of_triangle: impl Fn([Vector; 3]) -> [f64; N],
) -> [f64; N] {
    let (mut sums, mut total) = ([0.0; N], 0.0);
    for triangle in triangles {
        let corners @ [a, b, c] = triangle.map(|point| positions[point as usize]);
        let area = triangle_area(a, b, c);
        total += area;
        sums.iter_mut().zip(of_triangle(corners)).for_each(|(sum, value)| *sum += area * value);
    }
    sums.map(|sum| sum / total)
}

/// The principal axes of a surface, the longest first, along each of which the heavier end is ahead, so that they may be a reflection; along an axis about which
/// the surface is balanced the two others decide. O(triangles).
fn own_axes(positions: &[Vector], triangles: &[[u32; 3]]) -> [Vector; 3] {
    const PAIRS: [[usize; 2]; 6] = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]];
    let of_triangle = |corners: [Vector; 3]| -> [f64; 9] {
        let sum: Vector = std::array::from_fn(|k| corners.iter().map(|corner| corner[k]).sum());
        // Of products of two coordinates: those of the sum and of the corners, a twelfth each.
        let product = |[i, j]: [usize; 2]| {
            (sum[i] * sum[j] + corners.iter().map(|corner| corner[i] * corner[j]).sum::<f64>()) / 12.0
        };
        std::array::from_fn(|k| if k < 3 { sum[k] / 3.0 } else { product(PAIRS[k - 3]) })
    };
    let [x, y, z, products @ ..] = mean_over(positions, triangles, of_triangle);
    let mean = [x, y, z];
    let mut moments = [[0.0; 3]; 3];
    for ([i, j], product) in PAIRS.into_iter().zip(products) {
        moments[i][j] = product - mean[i] * mean[j];
        moments[j][i] = moments[i][j];
    }
    let along = |axis: &Vector| dot(*axis, std::array::from_fn(|i| dot(moments[i], *axis)));
    let mut axes = principal_axes(moments);
    axes.sort_by(|a, b| along(b).total_cmp(&along(a)));
    let sizes = axes.map(|axis| along(&axis));
    if (0..2).any(|k| sizes[k + 1] > (1.0 - EQUAL) * sizes[k]) {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    let third_moment = |axis: Vector, corners: &[Vector; 3]| {
        let [x, y, z] = corners.map(|corner| dot(axis, subtract(corner, mean)));
        // A tenth of all products of three.
        (x * x * (x + y + z) + y * y * (y + z) + z * z * (z + y) + x * (y * y + y * z + z * z)) / 10.0
    };
    let skewness: Vector =
        mean_over(positions, triangles, |corners| axes.map(|axis| third_moment(axis, &corners)));
    for k in 0..3 {
        axes[k] = axes[k].map(|x| if skewness[k] < 0.0 { -x } else { x });
    }
    let unbalance = |k: usize| skewness[k].abs() / sizes[0].powf(1.5);
    let third = (0..3).min_by(|&a, &b| unbalance(a).total_cmp(&unbalance(b))).expect("three");
    if unbalance(third) < EQUAL {
        axes[third] = cross(axes[(third + 1) % 3], axes[(third + 2) % 3]);
    }
    axes
}

/// Points sorted along a Z-curve.
fn along_z_curve(positions: &[Vector]) -> Vec<u32> {
    let bound = |start: f64, pick: fn(f64, f64) -> f64| -> Vector {
        std::array::from_fn(|k| positions.iter().fold(start, |bound, at| pick(bound, at[k])))
    };
    let (low, high) = (bound(f64::INFINITY, f64::min), bound(f64::NEG_INFINITY, f64::max));
    let longest = (0..3).map(|k| high[k] - low[k]).fold(f64::MIN_POSITIVE, f64::max);
    let last = f64::from((1u32 << BITS) - 1);
    let code = |at: &Vector| {
        (0..3).fold(0, |code, k| code | spread(((at[k] - low[k]) / longest * last) as u64) << k)
    };
    let mut keyed: Vec<(u64, u32)> = positions.iter().map(code).zip(0..).collect();
    let lexicographic = |a: u32, b: u32| {
        let (a, b) = (positions[a as usize], positions[b as usize]);
        (0..3).map(|k| a[k].total_cmp(&b[k])).fold(Ordering::Equal, Ordering::then)
    };
    keyed.sort_unstable_by(|a, b| a.0.cmp(&b.0).then_with(|| lexicographic(a.1, b.1)).then(a.1.cmp(&b.1)));
    keyed.into_iter().map(|(_, point)| point).collect()
}

/// The lowest [`BITS`] bits of a number, each followed by two zeros.
fn spread(number: u64) -> u64 {
    let mut bits = number & ((1 << BITS) - 1);
    for (shift, mask) in [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        bits = (bits | bits << shift) & mask;
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::PolygonMesh;
    use crate::mesh::rotation::rotation;

    /// Two unlike boxes of quads side by side, and a tetrahedron.
    fn shape() -> PolygonMesh {
        let mut mesh = PolygonMesh { face_offsets: vec![0], ..PolygonMesh::default() };
        let mut add = |corners: Vec<Vector>, faces: &[&[u32]]| {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(corners);
            for face in faces {
                mesh.face_vertices.extend(face.iter().map(|corner| first + corner));
                mesh.face_offsets.push(mesh.face_vertices.len() as u32);
            }
        };
        let cuboid = |low: Vector, size: Vector| {
            (0..8).map(|i| std::array::from_fn(|k| low[k] + size[k] * f64::from(i >> k & 1))).collect()
        };
        let sides: [&[u32]; 6] =
            [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
        add(cuboid([0.0; 3], [3.0, 1.3, 0.7]), &sides);
        add(cuboid([3.5, 0.2, -0.4], [1.0, 2.0, 0.5]), &sides);
        add(
            vec![[5.0, 0.0, 1.0], [6.0, 0.1, 1.0], [5.2, 1.2, 1.1], [5.4, 0.3, 2.0]],
            &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
        );
        mesh
    }

    fn canonical(mesh: &PolygonMesh) -> Canonical {
        Mesh::new(mesh, &Limits::default()).expect("a usable mesh").canonical()
    }

    /// The mesh with vertex 7 i + 3 as vertex i, turned over in x if it is `mirrored`, turned, larger and elsewhere, its faces from last to first.
    fn written_otherwise(given: &PolygonMesh, mirrored: bool) -> PolygonMesh {
        let turn = rotation([0.3, -1.0, 0.5], 2.1);
        let count = given.positions.len();
        let place = |vertex: usize| {
            let [x, y, z] = given.positions[(7 * vertex + 3) % count];
            turned(&turn, [if mirrored { -x } else { x }, y, z]).map(|x| 40.0 * x + 5.0)
        };
        let mut other = PolygonMesh {
            positions: (0..count).map(place).collect(),
            face_offsets: vec![0],
            face_vertices: Vec::new(),
        };
        for ends in given.face_offsets.windows(2).rev() {
            let corners = &given.face_vertices[ends[0] as usize..ends[1] as usize];
            let number = |corner: &u32| {
                (0..count).find(|vertex| (7 * vertex + 3) % count == *corner as usize).unwrap() as u32
            };
            let mut corners: Vec<u32> = corners.iter().map(number).collect();
            corners.rotate_left(1);
            if mirrored {
                corners.reverse();
            }
            other.face_vertices.extend(corners);
            other.face_offsets.push(other.face_vertices.len() as u32);
        }
        other
    }

    #[test]
    fn the_same_shape_is_the_same_mesh_however_it_is_written() {
        let (given, expected) = (shape(), canonical(&shape()).mesh);
        for mirrored in [false, true] {
            let found = canonical(&written_otherwise(&given, mirrored)).mesh;
            assert_eq!(found.polygon_points, expected.polygon_points);
            assert_eq!(found.shell_of_point, expected.shell_of_point);
            let apart = |(a, b): (&Vector, &Vector)| (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max);
            assert!(found.positions.iter().zip(&expected.positions).map(apart).all(|apart| apart < 1e-12));
            let in_first = |&vertex: &u32| (7 * vertex + 3) % given.positions.len() as u32;
            let vertices: Vec<u32> = found.vertex_of_point.iter().map(in_first).collect();
            assert_eq!(vertices, expected.vertex_of_point);
        }
    }

    #[test]
    fn the_way_back_leads_to_the_same_vertices_and_faces() {
        let given = Mesh::new(&shape(), &Limits::default()).unwrap();
        let Canonical { mesh, given_points: old } = given.canonical();
        for (point, &old) in old.iter().enumerate() {
            assert_eq!(mesh.vertex_of_point[point], given.vertex_of_point[old as usize]);
            assert_eq!(mesh.point_of_vertex[mesh.vertex_of_point[point] as usize] as usize, point);
        }
        let corners_of = |mesh: &Mesh, face: u32| {
            let place = mesh.face_of_polygon.iter().position(|&own| own == face).unwrap();
            let ends = mesh.polygon_offsets[place] as usize..mesh.polygon_offsets[place + 1] as usize;
            let mut corners: Vec<u32> =
                mesh.polygon_points[ends].iter().map(|&point| mesh.vertex_of_point[point as usize]).collect();
            from_smallest(&mut corners);
            // A reflected frame turns all of them over.
            if corners[1] > corners[corners.len() - 1] {
                corners[1..].reverse();
            }
            corners
        };
        for face in 0..given.face_count as u32 {
            assert_eq!(corners_of(&mesh, face), corners_of(&given, face));
        }
        let same = |a: u32, b: u32| {
            (given.squared_distance(old[a as usize], old[b as usize]) - mesh.squared_distance(a, b)).abs()
                < 1e-7
        };
        assert!((1..old.len() as u32).all(|point| same(0, point)));
    }

    #[test]
    fn bits_are_spread_to_every_third_place() {
        assert_eq!(spread(0b1011), 0b1_000_001_001);
        assert_eq!(spread((1 << BITS) - 1).count_ones(), BITS);
        assert_eq!(spread(1 << (BITS - 1)), 1 << (3 * (BITS - 1)));
    }
}
