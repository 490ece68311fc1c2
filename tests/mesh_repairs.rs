//! Each repair of `Mesh::new` on the smallest mesh that needs it.

use intrinsym::{Error, Limits, Mesh, NONE, PolygonMesh, RepairReport};

fn polygons(positions: &[[f64; 3]], faces: &[&[u32]]) -> PolygonMesh {
    let mut mesh =
        PolygonMesh { positions: positions.to_vec(), face_offsets: vec![0], face_vertices: Vec::new() };
    for face in faces {
        mesh.face_vertices.extend_from_slice(face);
        mesh.face_offsets.push(mesh.face_vertices.len() as u32);
    }
    mesh
}

fn validated(positions: &[[f64; 3]], faces: &[&[u32]]) -> Mesh {
    Mesh::new(&polygons(positions, faces), &Limits::default()).expect("a usable mesh")
}

const TETRAHEDRON: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const TETRAHEDRON_FACES: [&[u32]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]];

fn directed_edges(mesh: &Mesh) -> Vec<(u32, u32)> {
    let mut edges: Vec<_> = mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    edges.sort_unstable();
    edges
}

#[test]
fn a_clean_mesh_is_left_alone_but_normalised() {
    let mesh = validated(&TETRAHEDRON, &TETRAHEDRON_FACES);
    assert_eq!(mesh.repairs, RepairReport::default());
    assert_eq!(mesh.triangles, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    assert_eq!(mesh.point_of_vertex, [0, 1, 2, 3]);
    assert_eq!(mesh.face_of_triangle, [0, 1, 2, 3]);
    let area = 1.5 + 0.75f64.sqrt();
    assert!((mesh.unit_length - area.sqrt()).abs() < 1e-14);
    assert!(mesh.centre.iter().all(|coordinate| (coordinate - 0.25).abs() < 1e-15));
    for (point, original) in mesh.positions.iter().zip(TETRAHEDRON) {
        for axis in 0..3 {
            let back = mesh.centre[axis] + point[axis] * mesh.unit_length;
            assert!((back - original[axis]).abs() < 1e-14);
        }
    }
}

#[test]
fn unreferenced_vertices_get_no_point_and_do_not_count_for_the_frame() {
    let mut positions = vec![[1e300, 0.0, 0.0]];
    positions.extend(TETRAHEDRON);
    let faces: Vec<Vec<u32>> = TETRAHEDRON_FACES.iter().map(|f| f.iter().map(|v| v + 1).collect()).collect();
    let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    let mesh = validated(&positions, &faces);
    assert_eq!(mesh.repairs, RepairReport { unreferenced_vertices: 1, ..Default::default() });
    assert_eq!(mesh.point_of_vertex, [NONE, 0, 1, 2, 3]);
    assert_eq!(mesh.vertex_of_point, [1, 2, 3, 4]);
    assert_eq!(mesh.positions, validated(&TETRAHEDRON, &TETRAHEDRON_FACES).positions);
}

#[test]
fn degenerate_and_duplicate_faces_are_dropped() {
    let mut faces = TETRAHEDRON_FACES.to_vec();
    let extra: [&[u32]; 5] = [&[0, 0, 1], &[1], &[], &[1, 0, 2], &[3, 1, 2]];
    faces.extend(extra);
    let mesh = validated(&TETRAHEDRON, &faces);
    assert_eq!(mesh.repairs, RepairReport { degenerate_faces: 3, duplicate_faces: 2, ..Default::default() });
    assert_eq!((mesh.triangles.len(), mesh.face_count), (4, 9));
}

#[test]
fn a_reversed_face_is_turned_to_the_majority() {
    let mut faces = TETRAHEDRON_FACES.to_vec();
    faces[3] = &[0, 2, 3];
    let mesh = validated(&TETRAHEDRON, &faces);
    assert_eq!(mesh.repairs, RepairReport { flipped_faces: 1, ..Default::default() });
    let edges = directed_edges(&mesh);
    assert!(edges.windows(2).all(|pair| pair[0] != pair[1]));
    assert_eq!(mesh.polygon_points[9..12], [0, 3, 2]);
}

#[test]
fn a_moebius_band_is_kept_and_said_not_to_be_orientable() {
    let count = 10u32;
    let mut positions = Vec::new();
    for step in 0..count {
        let angle = std::f64::consts::TAU * f64::from(step) / f64::from(count);
        for side in [-0.4, 0.4] {
            let radius = 2.0 + side * (angle / 2.0).cos();
            positions.push([radius * angle.cos(), radius * angle.sin(), side * (angle / 2.0).sin()]);
        }
    }
    let faces: Vec<[u32; 4]> = (0..count)
        .map(|step| {
            let (a, b) = (2 * step, 2 * step + 1);
            if step + 1 < count { [a, b, b + 2, a + 2] } else { [a, b, 0, 1] }
        })
        .collect();
    let faces: Vec<&[u32]> = faces.iter().map(<[u32; 4]>::as_slice).collect();
    let mesh = validated(&positions, &faces);
    assert_eq!(mesh.shell_orientable, [false]);
    assert_eq!(mesh.repairs, RepairReport::default());
    assert!(!mesh.shells()[0].orientable);
}

#[test]
fn non_manifold_edges_and_vertices_are_kept() {
    let positions = [
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, -1.0, 0.0],
        [5.0, 0.0, 0.0],
        [5.0, 1.0, 0.0],
    ];
    let mesh = validated(&positions, &[&[0, 1, 2], &[0, 1, 3], &[0, 1, 4], &[2, 5, 6]]);
    let expected = RepairReport { non_manifold_edges: 1, non_manifold_vertices: 1, ..Default::default() };
    assert_eq!(mesh.repairs, expected);
    assert_eq!((mesh.triangles.len(), mesh.shell_count), (4, 1));
}

#[test]
fn a_seam_is_welded() {
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, -0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, -0.0],
    ];
    let mesh = validated(&positions, &[&[0, 1, 2], &[3, 4, 5]]);
    assert_eq!(mesh.repairs, RepairReport { welded_vertices: 2, ..Default::default() });
    assert_eq!(mesh.point_of_vertex, [0, 1, 2, 1, 3, 2]);
    assert_eq!(mesh.vertex_of_point, [0, 1, 2, 4]);
    assert_eq!(mesh.shell_count, 1);
}

/// A tube of quads, cut open along one side and across the middle, each part of which has vertices of its own; every vertex is moved by up to `noise`
/// mean edges.
fn cut_tube(noise: f64) -> Mesh {
    const AROUND: u32 = 12;
    const ALONG: u32 = 5;
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    let mut random = 1u64;
    let mut moved = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        noise * ((random >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
    };
    for half in 0..2 {
        let first = positions.len() as u32;
        for row in 0..=ALONG {
            for column in 0..=AROUND {
                let angle = std::f64::consts::TAU * f64::from(column % AROUND) / f64::from(AROUND);
                let height = 0.5 * f64::from(half * ALONG + row);
                positions
                    .push([angle.cos(), angle.sin(), height].map(|coordinate| coordinate + 0.5 * moved()));
                if row > 0 && column > 0 {
                    let corner = first + row * (AROUND + 1) + column;
                    faces.push([corner - AROUND - 2, corner - AROUND - 1, corner, corner - 1]);
                }
            }
        }
    }
    validated(&positions, &faces.iter().map(<[u32; 4]>::as_slice).collect::<Vec<_>>())
}

#[test]
fn seams_are_welded_through_noise_and_not_across_a_gap() {
    let exact = cut_tube(0.0);
    assert_eq!((exact.shell_count, exact.repairs.welded_vertices), (1, 2 * 6 + 12));
    for noise in [1e-12, 1e-6, 1e-5] {
        let noisy = cut_tube(noise);
        assert_eq!(noisy.point_of_vertex, exact.point_of_vertex, "noise of {noise}");
        assert_eq!(noisy.repairs, exact.repairs);
    }
    assert_eq!(cut_tube(0.01).repairs.welded_vertices, 0);
}

#[test]
fn what_lies_near_and_apart_is_not_welded() {
    // Two triangles on one line, the second `gap` away, folded over the first by `fold`.
    let hinge = |gap: f64, fold: f64| {
        let tip = [0.5, fold.cos(), fold.sin()];
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.0, 0.0, gap], [1.0, 0.0, gap], tip];
        validated(&positions, &[&[0, 1, 2], &[4, 3, 5]]).repairs.welded_vertices
    };
    let flat = std::f64::consts::PI;
    assert_eq!([0.0, 1e-5].map(|gap| hinge(gap, flat)), [2, 2]);
    assert_eq!(hinge(1e-3, flat), 0, "a real gap");
    assert_eq!([0.3, 0.1].map(|fold| hinge(1e-5, fold)), [2, 0], "sheets over each other");

    // As near as noise would be on the whole mesh, but not beside edges so short.
    let small = |gap: f64| {
        let positions = [
            [0.0, 0.0, 0.0],
            [1e-3, 0.0, 0.0],
            [5e-4, 1e-3, 0.0],
            [0.0, 0.0, gap],
            [1e-3, 0.0, gap],
            [5e-4, -1e-3, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, 0.0, 0.0],
        ];
        validated(&positions, &[&[0, 1, 2], &[4, 3, 5], &[2, 6, 7]]).repairs.welded_vertices
    };
    assert_eq!([1e-6, 1e-5].map(small), [2, 0]);

    // Three edges in one place are joined if that is exactly so.
    let three = |gap: f64| {
        let leaf = |k: u32| {
            let angle = 2.0 * f64::from(k);
            let near = gap * f64::from(k);
            [[near, 0.0, 0.0], [1.0, near, 0.0], [0.5, angle.cos(), angle.sin()]]
        };
        let positions: Vec<[f64; 3]> = (0..3).flat_map(leaf).collect();
        validated(&positions, &[&[0, 1, 2], &[3, 4, 5], &[6, 7, 8]]).repairs.welded_vertices
    };
    assert_eq!([0.0, 1e-6].map(three), [4, 0]);

    // A polygon's own edges.
    let slit = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 2.0, 0.0], [1e-5, 1e-5, 0.0], [1.0, 1.0, 0.5]];
    assert_eq!(validated(&slit, &[&[0, 1, 2, 3, 4]]).repairs.welded_vertices, 0);
}

#[test]
fn patches_that_meet_in_a_point_are_not_welded() {
    let positions = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
    ];
    let mesh = validated(&positions, &[&[0, 1, 2], &[3, 4, 5]]);
    assert_eq!(mesh.repairs, RepairReport::default());
    assert_eq!(mesh.shell_count, 2);
}

#[test]
fn both_sides_of_a_doubled_sheet_become_one() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let positions: Vec<[f64; 3]> = square.into_iter().chain(square).collect();
    let mesh = validated(&positions, &[&[0, 1, 2, 3], &[7, 6, 5, 4]]);
    assert_eq!(mesh.repairs, RepairReport { welded_vertices: 4, duplicate_faces: 1, ..Default::default() });
    assert_eq!(mesh.point_of_vertex, [0, 1, 2, 3, 0, 1, 2, 3]);
}

#[test]
fn a_copy_of_a_shell_in_its_place_becomes_one_with_it() {
    let mut positions = TETRAHEDRON.to_vec();
    positions.extend([2, 3, 0, 1].map(|vertex| TETRAHEDRON[vertex]));
    let mut faces: Vec<Vec<u32>> = TETRAHEDRON_FACES.iter().map(|face| face.to_vec()).collect();
    faces.extend(TETRAHEDRON_FACES.iter().rev().map(|face| face.iter().map(|v| (v + 2) % 4 + 4).collect()));
    let validated = |positions: &[[f64; 3]], faces: &[Vec<u32>]| {
        validated(positions, &faces.iter().map(Vec::as_slice).collect::<Vec<_>>())
    };
    let mesh = validated(&positions, &faces);
    assert_eq!(mesh.repairs, RepairReport { welded_vertices: 4, duplicate_faces: 4, ..Default::default() });
    assert_eq!(mesh.point_of_vertex, [0, 1, 2, 3, 2, 3, 0, 1]);
    assert_eq!((mesh.shell_count, mesh.triangles.len()), (1, 4));

    let moved = |by: f64| {
        let copy = positions[4..].iter().map(|at| at.map(|coordinate| coordinate + by));
        validated(&[&positions[..4], &copy.collect::<Vec<_>>()].concat(), &faces)
    };
    assert_eq!(moved(0.01).point_of_vertex, mesh.point_of_vertex, "against flicker");
    assert_eq!(moved(0.1).repairs, RepairReport::default(), "a layer of its own");
    assert_eq!(validated(&positions, &faces[..7]).repairs, RepairReport::default(), "not all of it");
}

#[test]
fn touching_closed_shells_are_not_welded() {
    let mut positions = TETRAHEDRON.to_vec();
    positions.extend(TETRAHEDRON.map(|p| p.map(|coordinate| -coordinate)));
    let mut faces: Vec<Vec<u32>> = TETRAHEDRON_FACES.iter().map(|face| face.to_vec()).collect();
    faces.extend(TETRAHEDRON_FACES.iter().map(|face| face.iter().rev().map(|v| v + 4).collect()));
    let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    let mesh = validated(&positions, &faces);
    assert_eq!(mesh.repairs, RepairReport::default());
    assert_eq!(mesh.shell_count, 2);
}

#[test]
fn zero_area_faces_are_kept() {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0]];
    let mesh = validated(&positions, &[&[0, 1, 2], &[0, 3, 1]]);
    assert_eq!(mesh.repairs, RepairReport { zero_area_faces: 1, ..Default::default() });
    assert_eq!(mesh.triangles.len(), 2);
}

#[test]
fn shells_come_by_falling_area_each_scaled_to_its_own() {
    let mut positions: Vec<[f64; 3]> = TETRAHEDRON.to_vec();
    positions.extend(TETRAHEDRON.map(|p| [3.0 * p[0] + 10.0, 3.0 * p[1], 3.0 * p[2]]));
    let mut faces: Vec<Vec<u32>> = TETRAHEDRON_FACES.iter().map(|face| face.to_vec()).collect();
    faces.extend(TETRAHEDRON_FACES.iter().map(|face| face.iter().map(|v| v + 4).collect()));
    let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
    let mesh = validated(&positions, &faces);
    let shells = mesh.shells();
    assert_eq!(shells.len(), 2);
    assert_eq!((&shells[0].points[..], &shells[1].points[..]), (&[4, 5, 6, 7][..], &[0, 1, 2, 3][..]));
    assert_eq!(shells[0].triangle_of_local, [4, 5, 6, 7]);
    assert_eq!(shells[0].triangles, shells[1].triangles);
    assert!((shells[0].area() - 0.9).abs() < 1e-12 && (shells[1].area() - 0.1).abs() < 1e-12);
    for (a, b) in shells[0].positions.iter().zip(&shells[1].positions) {
        assert!((0..3).all(|axis| (a[axis] - b[axis]).abs() < 1e-12));
    }
}

#[test]
fn limits_hold_for_vertices_faces_and_triangles() {
    let mesh = polygons(&TETRAHEDRON, &[&[0, 1, 2, 3]]);
    let refused = |vertices, faces| {
        let limits = Limits { vertices, faces, ..Limits::default() };
        matches!(Mesh::new(&mesh, &limits), Err(Error::Limit { .. }))
    };
    assert!(refused(3, 10));
    assert!(refused(4, 1));
    assert!(!refused(4, 2));
}

#[test]
fn malformed_offsets_are_named() {
    let message = |offsets: &[u32]| {
        let mesh = PolygonMesh {
            positions: TETRAHEDRON.to_vec(),
            face_offsets: offsets.to_vec(),
            face_vertices: vec![0, 1, 2, 0, 2, 3],
        };
        Mesh::new(&mesh, &Limits::default()).expect_err("a refusal").to_string()
    };
    assert!(message(&[1, 3, 6]).contains("the face offsets start at 1 instead of 0"));
    assert!(message(&[0, 4, 3, 6]).contains("the face offsets decrease after face 1, from 4 to 3"));
    assert!(message(&[0, 3]).contains("the last face offset is 3 but there are 6 face corners"));
    assert!(message(&[0]).contains("it has no faces"));
    assert!(message(&[]).contains("it has no faces"));
}
