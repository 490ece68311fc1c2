//! Meshes whose vertices are doubled at seams: faces go to faces in the caller's numbering.

mod support;

use intrinsym::mirror::faces::mirror_face_selection;
use intrinsym::{Options, PolygonMesh, Progress, Symmetry, detect};
use std::collections::{BTreeMap, BTreeSet};
use support::{Vector, creature, distance, polygon_mesh, validated};

/// A symmetric lump, each of whose vertices is doubled so that the faces of each `group` have one of their own; a face is known by its number and its middle.
fn split(group: impl Fn(usize, Vector) -> usize) -> PolygonMesh {
    let whole = creature(4, 0.0);
    let mut number = BTreeMap::new();
    let mut positions = Vec::new();
    let mut corner = |vertex: u32, group: usize| {
        *number.entry((vertex, group)).or_insert_with(|| {
            positions.push(whole.positions[vertex as usize]);
            positions.len() as u32 - 1
        })
    };
    let middle = |face: &[u32]| {
        [0, 1, 2].map(|axis| face.iter().map(|&v| whole.positions[v as usize][axis]).sum::<f64>() / 3.0)
    };
    let faces: Vec<Vec<u32>> = whole
        .face_vertices
        .chunks(3)
        .enumerate()
        .map(|(index, face)| face.iter().map(|&vertex| corner(vertex, group(index, middle(face)))).collect())
        .collect();
    polygon_mesh(&positions, &faces)
}

fn found(polygons: &PolygonMesh) -> Symmetry {
    let mesh = validated(polygons);
    assert!(mesh.repairs.welded_vertices > 0 && mesh.shell_count == 1);
    let symmetry =
        detect(&mesh, &Options::default(), &Progress::default()).unwrap().symmetries.swap_remove(0);
    assert_eq!(symmetry.exact_share, 1.0);
    for (vertex, &partner) in symmetry.partner.iter().enumerate() {
        let ([x, y, z], image) = (polygons.positions[vertex], polygons.positions[partner as usize]);
        assert!(distance([-x, y, z], image) < 1e-6, "{vertex} goes elsewhere");
        let point = symmetry.surface_point[vertex].unwrap();
        let face = &polygons.face_vertices[3 * point.face as usize..][..3];
        let at = point.barycentric.iter().position(|&weight| weight == 1.0).unwrap();
        assert_eq!(point.vertices[at], partner as u32, "the surface point of {vertex} is another vertex");
        assert!(point.vertices.iter().all(|corner| face.contains(corner)), "nor in its face");
    }
    symmetry
}

#[test]
fn where_left_and_right_are_split_alike_faces_go_to_faces_and_partners_are_mutual() {
    type Group = fn(usize, Vector) -> usize;
    let all: Group = |face, _| face;
    let across: Group = |_, [_, y, _]| usize::from(y > 0.1);
    let along: Group =
        |_, [x, y, _]| usize::from(x > 1e-6) + 2 * usize::from(x < -1e-6) + 4 * usize::from(y > 0.1);
    for (name, group) in [("all edges", all), ("across the line", across), ("along the line, too", along)] {
        let polygons = split(group);
        let symmetry = found(&polygons);
        let partner = |vertex: u32| symmetry.partner[vertex as usize] as u32;
        // Some faces of this mesh are turned over.
        let sorted = |mut face: Vec<u32>| {
            face.sort_unstable();
            face
        };
        let faces = || polygons.face_vertices.chunks(3).map(<[u32]>::to_vec);
        let there: BTreeSet<Vec<u32>> = faces().map(sorted).collect();
        let image = |face: Vec<u32>| sorted(face.into_iter().map(partner).collect());
        let lost = faces().filter(|face| !there.contains(&image(face.clone()))).count();
        assert_eq!(lost, 0, "{name}: so many of {} faces go to no face", there.len());
        assert!((0..symmetry.partner.len() as u32).all(|v| partner(partner(v)) == v), "{name}");
    }
}

#[test]
fn where_one_side_alone_is_split_partners_are_at_the_right_places_and_selections_of_faces_arrive() {
    let polygons = split(|_, [x, y, _]| if x > 0.0 && y > 0.1 { 1 } else { 0 });
    let symmetry = found(&polygons);
    let count = polygons.face_offsets.len() - 1;
    let middle = |face: usize| -> Vector {
        let corners = &polygons.face_vertices[3 * face..][..3];
        [0, 1, 2].map(|axis| corners.iter().map(|&v| polygons.positions[v as usize][axis]).sum::<f64>() / 3.0)
    };
    let near = |[x, y, z]: Vector| distance([x, y, z], [0.7, 0.1, 0.3]) < 0.5;
    let selected: Vec<bool> = (0..count).map(|face| near(middle(face))).collect();
    let expected: Vec<bool> = (0..count)
        .map(|face| {
            let [x, y, z] = middle(face);
            near([-x, y, z])
        })
        .collect();
    let mesh = validated(&polygons);
    let mirrored = mirror_face_selection(&mesh, &polygons, &symmetry, &selected, 0.0).unwrap();
    assert!(selected.iter().filter(|&&is_selected| is_selected).count() > 20);
    assert_eq!(mirrored, expected);
    assert_eq!(mirror_face_selection(&mesh, &polygons, &symmetry, &mirrored, 0.0).unwrap(), selected);
}
