//! Small holes are filled for the search, and nothing of that is in the result.

mod support;

use intrinsym::internals::base::effort::{Mechanisms, Plan};
use intrinsym::internals::detect::driver::detect_by;
use intrinsym::internals::detect::filled_holes::FilledShell;
use intrinsym::internals::geometry::embedded_triangles::TrianglePoint;
use intrinsym::internals::geometry::vertex_map::VertexMap;
use intrinsym::internals::mesh::Shell;
use intrinsym::{Detection, NONE, Options, Outcome, PolygonMesh, Progress};
use std::collections::{BTreeSet, HashMap};
use support::*;

/// The mesh without the faces that `gone` names.
fn without(mesh: &PolygonMesh, gone: impl Fn(&[u32]) -> bool) -> PolygonMesh {
    let faces: Vec<&[u32]> = mesh.face_vertices.chunks(3).filter(|face| !gone(face)).collect();
    polygon_mesh(&mesh.positions, &faces)
}

/// The largest shell and itself filled.
fn filled(mesh: &PolygonMesh) -> (Shell, Option<FilledShell>) {
    let shell = validated(mesh).shells().swap_remove(0);
    let filled = FilledShell::new(&shell, &[], true);
    (shell, filled)
}

/// Edges that have no second triangle in the other direction.
fn open_edges(triangles: &[[u32; 3]]) -> usize {
    let mut surplus: HashMap<(u32, u32), i32> = HashMap::new();
    for [a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *surplus.entry((*from, *to)).or_default() += 1;
            *surplus.entry((*to, *from)).or_default() -= 1;
        }
    }
    surplus.values().filter(|count| **count > 0).count()
}

#[test]
fn small_holes_are_closed_and_all_else_stays() {
    let sphere = icosphere(3);
    // One triangle; the triangles around a vertex; those around two vertices whose holes touch.
    let single = sphere.face_vertices[..3].to_vec();
    let neighbours = |vertex: u32| -> BTreeSet<u32> {
        sphere.face_vertices.chunks(3).filter(|face| face.contains(&vertex)).flatten().copied().collect()
    };
    let first = neighbours(300);
    let shares_one = |other: &u32| neighbours(*other).intersection(&first).count() == 1;
    let second = (0..sphere.positions.len() as u32).find(shares_one).expect("a vertex two edges away");
    let touching = vec![300, second];
    for (holes, gone) in [(1, single), (1, vec![300]), (2, touching)] {
        let is_gone = |face: &[u32]| match gone.len() {
            3 => face == gone,
            _ => face.iter().any(|vertex| gone.contains(vertex)),
        };
        let (shell, filled) = filled(&without(&sphere, is_gone));
        let filled = filled.expect("holes");
        assert!(open_edges(&shell.triangles) > 0);
        assert_eq!(open_edges(&filled.shell.triangles), 0);
        assert_eq!(filled.hole_count(), holes);
        assert_eq!(filled.shell.points[..shell.points.len()], shell.points);
        assert!(filled.shell.points[shell.points.len()..].iter().all(|&point| point == NONE));
        assert_eq!(filled.shell.triangles[..shell.triangles.len()], shell.triangles);
        let area =
            intrinsym::internals::mesh::vector::point_areas(&filled.shell.positions, &filled.shell.triangles);
        assert!((area.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn closed_surfaces_and_wide_openings_are_left_alone() {
    assert!(filled(&icosphere(3)).1.is_none());
    let half =
        without(&icosphere(3), |face| face.iter().any(|&v| icosphere(3).positions[v as usize][2] < 0.0));
    assert!(filled(&half).1.is_none());
    // Three triangles on one edge.
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
    assert!(filled(&polygon_mesh(&positions, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]])).1.is_none());
}

#[test]
fn an_image_in_a_filling_goes_to_its_rim_and_is_less_trusted() {
    let (shell, filled) = filled(&without(&icosphere(3), |face| face.contains(&300)));
    let filled = filled.expect("a hole");
    let (all, own) = (&filled.shell.triangles, shell.triangles.len());
    let [a, b, middle] = all[own];
    assert_eq!(middle as usize, shell.points.len());
    let at = |triangle: usize, barycentric| TrianglePoint { triangle: triangle as u32, barycentric };
    let points = vec![at(0, [0.5, 0.5, 0.0]), at(own, [0.1, 0.9, 0.0]), at(own, [0.0, 0.0, 1.0])];
    let mut images = VertexMap { partners: vec![all[0][0], b, middle], points };
    let kept = filled.leave_fillings(&mut images);
    assert_eq!((images.partners[0], images.points[0], kept[0]), (all[0][0], at(0, [0.5, 0.5, 0.0]), 1.0));
    assert_eq!(images.partners[1], b);
    for (partner, point) in images.partners.iter().zip(&images.points) {
        assert!((point.triangle as usize) < own);
        assert_eq!(all[point.triangle as usize][point.heaviest()], *partner);
    }
    assert!([a, b].contains(&images.partners[2]) || (images.partners[2] as usize) < shell.points.len());
    assert!(kept[2] < kept[1] && kept[1] < 1.0, "{kept:?}");
}

fn found(polygons: &PolygonMesh) -> Detection {
    let (mesh, options) = (validated(polygons), Options::default());
    // At rest nothing would be searched.
    let mechanisms = Mechanisms { mirror_plane: false, ..Mechanisms::default() };
    let found = detect_by(&mesh, &options, &Plan::of(&options), mechanisms, &Progress::default()).unwrap();
    println!("{} holes: {}", found.report.filled_holes, found.report.evidence());
    assert_keeps_its_contract(&mesh, &options, &found);
    found
}

#[test]
fn a_shape_with_holes_has_the_symmetry_that_it_has_without_them() {
    let whole = creature(4, 0.4);
    let truth = creature_truth(&whole);
    // Around every 40th vertex with positive x: a sixth of that side.
    let is_middle = |v: &u32| v % 40 == 7 && whole.positions[*v as usize][0] > 0.1;
    let torn = without(&whole, |face| face.iter().any(is_middle));
    let found = found(&torn);
    assert_eq!(found.outcome, Outcome::Found);
    assert!(found.report.filled_holes > 20);
    let partner = &found.symmetries[0].partner;
    let unit = validated(&whole).unit_length;
    let mut errors: Vec<f64> = (0..partner.len())
        .filter(|&v| partner[v] >= 0)
        .map(|v| distance(whole.positions[partner[v] as usize], whole.positions[truth[v] as usize]) / unit)
        .collect();
    errors.sort_by(f64::total_cmp);
    let (mean, most) = (errors.iter().sum::<f64>() / errors.len() as f64, errors[errors.len() * 95 / 100]);
    println!("mean error {mean}, 95 % below {most}");
    assert!(mean < 0.01 && most < 0.05, "{mean} {most}");
}
