//! Properties of reading and validating: no bytes make a reader panic, and neither numbering, scale nor
//! position change what is found.

use intrinsym::{Limits, Mesh, NONE, PolygonMesh, io};
use proptest::prelude::*;
use std::path::Path;

const SEEDS: [(&str, &[u8]); 7] = [
    (
        "a.ply",
        b"ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty double y\nproperty int z\n\
          element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n4 0 1 2 3\n",
    ),
    (
        "b.ply",
        b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\nproperty short z\n\
          element face 1\nproperty list uchar uchar vertex_index\nend_header\n\0\0\0\0\x01\0\0\0\0\x01\x01\0\x03\0\x01\x02",
    ),
    (
        "c.ply",
        b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\nproperty short z\n\
          element tristrips 1\nproperty list int uchar vertex_index\nend_header\n\0\0\0\0\x01\0\0\0\0\x01\x01\0\0\0\0\x03\0\x01\x02",
    ),
    ("d.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0 # c\nv 1 1 1\nvn 0 0 1\nf 1 2 3\nf -1//1 -2//1 \\\n -3//1\nl 1 2\n"),
    ("e.off", b"COFF\n4 2 0\n0 0 0 1 1 1\n1 0 0\n0 1 0\n1 1 1\n3 0 1 2\n4 0 1 3 2 255 0 0\n"),
    ("f.stl", b"solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"),
    ("g.gltf", include_bytes!("data/bad/seam_and_skin.gltf")),
];

/// Reads bytes as a file and validates what comes out; only panics and hangs can fail.
fn swallow(name: &str, bytes: &[u8]) {
    let limits = Limits { vertices: 10_000, faces: 10_000, file_bytes: 1 << 20 };
    if let Ok(file) = io::parse(Path::new(name), bytes, &limits)
        && let Ok(mesh) = Mesh::new(&file.polygons, &limits)
    {
        check_invariants(&file.polygons, &mesh);
    }
}

/// What the documentation of [`Mesh`] promises.
fn check_invariants(given: &PolygonMesh, mesh: &Mesh) {
    let points = mesh.positions.len() as u32;
    assert!(mesh.positions.as_flattened().iter().all(|coordinate| coordinate.is_finite()));
    assert_eq!(mesh.point_of_vertex.len(), given.positions.len());
    assert!(mesh.point_of_vertex.iter().all(|&point| point == NONE || point < points));
    for (point, &vertex) in mesh.vertex_of_point.iter().enumerate() {
        assert_eq!(mesh.point_of_vertex[vertex as usize], point as u32);
        assert!(mesh.point_of_vertex[..vertex as usize].iter().all(|&other| other != point as u32));
    }
    let mut used = vec![false; points as usize];
    for &[a, b, c] in &mesh.triangles {
        assert!(a != b && b != c && c != a);
        [a, b, c].iter().for_each(|&point| used[point as usize] = true);
    }
    assert!(used.iter().all(|&is_used| is_used));
    assert_eq!(mesh.polygon_offsets.len(), mesh.face_of_polygon.len() + 1);
    assert!((mesh.shells().iter().map(|shell| shell.area()).sum::<f64>() - 1.0).abs() < 1e-6);
}

fn mutated() -> impl Strategy<Value = (usize, Vec<u8>)> {
    let edit = (any::<prop::sample::Index>(), any::<u8>(), 0..4u8);
    (0..SEEDS.len(), prop::collection::vec(edit, 1..6)).prop_map(|(seed, edits)| {
        let mut bytes = SEEDS[seed].1.to_vec();
        for (index, value, kind) in edits {
            if bytes.is_empty() {
                break;
            }
            let at = index.index(bytes.len());
            match kind {
                0 => bytes[at] = value,
                1 => bytes.insert(at, b"0123456789-. \n"[usize::from(value) % 14]),
                2 => bytes.truncate(at),
                _ => {
                    bytes.remove(at);
                }
            }
        }
        (seed, bytes)
    })
}

/// Small meshes with all that needs repair: few vertices on few positions, so that things coincide.
fn soup() -> impl Strategy<Value = PolygonMesh> {
    let grid = prop::sample::select(vec![0.0, 0.0, 1.0, 2.0, 0.5]);
    let positions = prop::collection::vec([grid.clone(), grid.clone(), grid], 4..10);
    let faces = prop::collection::vec(prop::collection::vec(any::<prop::sample::Index>(), 1..6), 1..12);
    (positions, faces).prop_map(|(positions, faces)| {
        let count = positions.len();
        let faces: Vec<Vec<u32>> =
            faces.iter().map(|face| face.iter().map(|corner| corner.index(count) as u32).collect()).collect();
        polygons(positions, &faces)
    })
}

fn polygons(positions: Vec<[f64; 3]>, faces: &[Vec<u32>]) -> PolygonMesh {
    let mut mesh = PolygonMesh { positions, face_offsets: vec![0], face_vertices: Vec::new() };
    for face in faces {
        mesh.face_vertices.extend(face);
        mesh.face_offsets.push(mesh.face_vertices.len() as u32);
    }
    mesh
}

fn faces_of(mesh: &PolygonMesh) -> Vec<Vec<u32>> {
    let corners = |pair: &[u32]| mesh.face_vertices[pair[0] as usize..pair[1] as usize].to_vec();
    mesh.face_offsets.windows(2).map(corners).collect()
}

/// The surface of a bumpy box, all of whose repairs are none.
fn ball() -> PolygonMesh {
    let (rings, segments) = (7u32, 9u32);
    let mut positions = vec![[0.0, 0.0, 1.0]];
    for ring in 1..rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for segment in 0..segments {
            let turn = std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
            let radius = 1.0 + 0.2 * (3.0 * turn).sin() * polar.sin();
            positions.push([
                radius * polar.sin() * turn.cos(),
                radius * polar.sin() * turn.sin(),
                polar.cos(),
            ]);
        }
    }
    positions.push([0.0, 0.0, -1.0]);
    let at = |ring: u32, segment: u32| 1 + (ring - 1) * segments + segment % segments;
    let last = positions.len() as u32 - 1;
    let mut faces = Vec::new();
    for segment in 0..segments {
        faces.push(vec![0, at(1, segment), at(1, segment + 1)]);
        faces.push(vec![last, at(rings - 1, segment + 1), at(rings - 1, segment)]);
        for ring in 1..rings - 1 {
            faces.push(vec![
                at(ring, segment),
                at(ring + 1, segment),
                at(ring + 1, segment + 1),
                at(ring, segment + 1),
            ]);
        }
    }
    polygons(positions, &faces)
}

fn validated(mesh: &PolygonMesh) -> Mesh {
    Mesh::new(mesh, &Limits::default()).expect("a usable mesh")
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(seed in 0..SEEDS.len(), bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        swallow(SEEDS[seed].0, &bytes);
    }

    #[test]
    fn mutated_files_never_panic((seed, bytes) in mutated()) {
        swallow(SEEDS[seed].0, &bytes);
    }

    #[test]
    fn any_polygons_are_validated_or_refused(mesh in soup()) {
        if let Ok(valid) = Mesh::new(&mesh, &Limits::default()) {
            check_invariants(&mesh, &valid);
        }
    }

    #[test]
    fn renumbering_changes_no_repair(mesh in soup(), vertex_keys in prop::array::uniform10(any::<u64>()), turn in 0..12usize) {
        let count = mesh.positions.len();
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by_key(|&vertex| vertex_keys[vertex]);
        let mut new_index = vec![0u32; count];
        order.iter().enumerate().for_each(|(new, &old)| new_index[old] = new as u32);
        let positions = order.iter().map(|&old| mesh.positions[old]).collect();
        let mut faces: Vec<Vec<u32>> =
            faces_of(&mesh).iter().map(|face| face.iter().map(|&v| new_index[v as usize]).collect()).collect();
        // Of duplicate faces the first is kept, so their order may decide on the repairs after that.
        let original = Mesh::new(&mesh, &Limits::default());
        if original.as_ref().is_ok_and(|original| original.repairs.duplicate_faces == 0) {
            let turn = turn % faces.len();
            faces.rotate_left(turn);
        }
        let renumbered = polygons(positions, &faces);
        match (original, Mesh::new(&renumbered, &Limits::default())) {
            (Ok(a), Ok(b)) => {
                prop_assert_eq!(&a.repairs, &b.repairs);
                prop_assert_eq!(a.shell_count, b.shell_count);
            }
            (a, b) => prop_assert_eq!(a.is_ok(), b.is_ok()),
        }
    }

    #[test]
    fn scale_and_position_change_nothing(exponent in -9..10i32, offset in prop::array::uniform3(-10.0..10.0f64)) {
        let (ball, scale) = (ball(), 10f64.powi(exponent));
        let mut moved = ball.clone();
        for position in &mut moved.positions {
            *position = [0, 1, 2].map(|axis| (position[axis] + offset[axis]) * scale);
        }
        let (a, b) = (validated(&ball), validated(&moved));
        prop_assert_eq!(&a.triangles, &b.triangles);
        prop_assert_eq!(&a.repairs, &b.repairs);
        for (p, q) in a.positions.as_flattened().iter().zip(b.positions.as_flattened()) {
            prop_assert!((p - q).abs() < 1e-12, "{} {}", p, q);
        }
        prop_assert!((b.unit_length / scale / a.unit_length - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_ball_far_from_the_origin_is_the_same_ball() {
    let mut far = ball();
    far.positions.iter_mut().for_each(|position| *position = position.map(|coordinate| coordinate + 1e9));
    let (near, far) = (validated(&ball()), validated(&far));
    // A coordinate near 1e9 is a multiple of 1.2e-7: that is all that is lost.
    for (p, q) in near.positions.as_flattened().iter().zip(far.positions.as_flattened()) {
        assert!((p - q).abs() < 2e-7, "{p} {q}");
    }
}
