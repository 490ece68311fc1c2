//! Pairing of mirrored vertices where edges are not mirrored, on meshes whose true map is known.

mod support;

use intrinsym::SymmetryKind::{HalfTurn, Reflection};
use intrinsym::internals::connectivity::automorphism::Automorphism;
use intrinsym::internals::connectivity::mirrored_vertices::{Estimate, MirroredVertices, find};
use intrinsym::internals::geometry::embedded_triangles::{Fans, TrianglePoint};
use intrinsym::{CancelToken, Error, Mesh, NONE, PolygonMesh, Progress, SymmetryKind};
use support::*;

/// A map of the points of a mesh.
struct Map {
    partner: Vec<u32>,
    image: Vec<TrianglePoint>,
}

impl Map {
    /// Sends each point half an edge away from where `truth`, a map of vertices, sends it, always in one direction.
    fn near(mesh: &Mesh, truth: &[u32]) -> Map {
        let fans = Fans::new(mesh.positions.len(), &mesh.triangles);
        let along = |point: u32| dot(mesh.positions[point as usize], [0.6, 0.48, 0.64]);
        let image = |point: u32| {
            let vertex = mesh.vertex_of_point[point as usize];
            let target = mesh.point_of_vertex[truth[vertex as usize] as usize];
            let height =
                |triangle: &u32| mesh.triangles[*triangle as usize].iter().map(|&corner| along(corner)).sum();
            let highest = fans.of(target).iter().max_by(|a, b| f64::total_cmp(&height(a), &height(b)));
            let triangle = *highest.expect("every point has a triangle");
            let weight = |corner: u32| if corner == target { 0.5 } else { 0.25 };
            TrianglePoint { triangle, barycentric: mesh.triangles[triangle as usize].map(weight) }
        };
        let image: Vec<TrianglePoint> = (0..mesh.positions.len() as u32).map(image).collect();
        let heaviest = |inside: &TrianglePoint| mesh.triangles[inside.triangle as usize][inside.heaviest()];
        Map { partner: image.iter().map(heaviest).collect(), image }
    }

    fn paired(
        &self,
        mesh: &Mesh,
        known: Option<&Automorphism>,
        kind: SymmetryKind,
    ) -> Option<MirroredVertices> {
        let found = self.paired_on(1, mesh, known, kind);
        if let Some(found) = &found {
            assert_keeps_its_contract(mesh, found);
        }
        found
    }

    fn paired_on(
        &self,
        threads: usize,
        mesh: &Mesh,
        known: Option<&Automorphism>,
        kind: SymmetryKind,
    ) -> Option<MirroredVertices> {
        let estimate = Estimate { partner: &self.partner, image: &self.image };
        find(mesh, estimate, known, kind, threads, &Progress::default()).unwrap()
    }
}

fn assert_keeps_its_contract(mesh: &Mesh, found: &MirroredVertices) {
    for (point, &partner) in found.partner.iter().enumerate() {
        if partner == NONE {
            assert!(!found.paired[point]);
            continue;
        }
        let image = found.image[point];
        assert_eq!(mesh.triangles[image.triangle as usize][image.heaviest()], partner);
        assert!((image.barycentric.iter().sum::<f32>() - 1.0).abs() < 1e-5);
        if found.paired[point] {
            assert_eq!(found.partner[partner as usize], point as u32, "pairs are each other's");
            assert!(found.paired[partner as usize]);
            assert_eq!(image.barycentric[image.heaviest()], 1.0, "the image is the vertex itself");
        }
    }
}

/// Shares of all vertices that are paired, and that are paired with the true partner.
fn shares(mesh: &Mesh, truth: &[u32], found: &MirroredVertices) -> (f64, f64) {
    let is_right = |&point: &usize| {
        let partner = mesh.vertex_of_point[found.partner[point] as usize];
        partner == truth[mesh.vertex_of_point[point] as usize]
    };
    let paired: Vec<usize> = (0..found.paired.len()).filter(|&point| found.paired[point]).collect();
    let right = paired.iter().copied().filter(is_right).count();
    let count = found.paired.len() as f64;
    println!("{} of {count} paired, {right} of them right", paired.len());
    (paired.len() as f64 / count, right as f64 / count)
}

/// A hilly sheet of `2 half + 1` by `2 half + 1` vertices with quads cut at random; `height` is a function of two
/// coordinates from -1 to 1. Row by row.
fn sheet(half: i32, height: impl Fn(f64, f64) -> f64) -> PolygonMesh {
    let side = (2 * half + 1) as u32;
    let steps = || (-half..=half).map(move |step| f64::from(step) / f64::from(half));
    let positions: Vec<Vector> =
        steps().flat_map(|y| steps().map(move |x| [x, y])).map(|[x, y]| [x, y, height(x, y)]).collect();
    let corners = |at: u32| [at, at + 1, at + side + 1, at + side];
    let quads: Vec<[u32; 4]> =
        (0..side - 1).flat_map(|row| (0..side - 1).map(move |column| corners(row * side + column))).collect();
    with_random_diagonals(&polygon_mesh(&positions, &quads))
}

/// Hills of unlike heights and widths, without any symmetry.
fn hills(x: f64, y: f64) -> f64 {
    let hill = |at: [f64; 2], width: f64| (-width * ((x - at[0]).powi(2) + (y - at[1]).powi(2))).exp();
    0.7 * hill([0.4, 0.5], 9.0) + 0.9 * hill([0.6, -0.4], 6.0) - 0.5 * hill([-0.2, -0.5], 12.0)
        + 0.3 * hill([-0.6, 0.3], 5.0)
}

#[test]
fn nearly_all_vertices_of_quads_cut_at_random_are_paired_with_the_right_ones() {
    let mesh = validated(&with_random_diagonals(&example("human")));
    let truth = example_truth("human");
    let map = Map::near(&mesh, &truth);
    let found = map.paired(&mesh, None, Reflection).unwrap();
    let (paired, right) = shares(&mesh, &truth, &found);
    assert!(paired > 0.95 && right > 0.95, "{paired} {right}");
    for threads in [2, 5, 64] {
        let again = map.paired_on(threads, &mesh, None, Reflection).unwrap();
        assert_eq!((&found.partner, &found.image), (&again.partner, &again.image), "{threads} threads");
    }
}

#[test]
fn vertices_that_are_not_mirrored_are_not_paired() {
    let quadruped = validated(&example("quadruped"));
    assert!(
        Map::near(&quadruped, &example_truth("quadruped")).paired(&quadruped, None, Reflection).is_none()
    );
    // Regular grids of triangles fit each other anywhere.
    for turn in [0.35, 0.7, 1.3, 2.2] {
        let creature = creature(5, turn);
        let truth = creature_truth(&creature);
        let mesh = validated(&creature);
        assert!(Map::near(&mesh, &truth).paired(&mesh, None, Reflection).is_none(), "{turn}");
    }
}

#[test]
fn the_identity_is_no_reflection() {
    let mesh = validated(&sheet(20, hills));
    let identity: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    assert!(Map::near(&mesh, &identity).paired(&mesh, None, Reflection).is_none());
}

#[test]
fn half_turns_pair_vertices_without_mirroring() {
    let mesh = validated(&sheet(20, |x, y| hills(x, y) + hills(-x, -y)));
    let truth: Vec<u32> = (0..mesh.positions.len() as u32).rev().collect();
    let map = Map::near(&mesh, &truth);
    let (_, right) = shares(&mesh, &truth, &map.paired(&mesh, None, HalfTurn).unwrap());
    assert!(right > 0.9, "{right}");
    assert!(map.paired(&mesh, None, Reflection).is_none(), "it is no reflection");
}

#[test]
fn shells_that_change_places_are_paired_with_each_other() {
    let [left, right] = [-1.0, 1.0].map(|side| sheet(16, move |x, y| hills(side * x, y)));
    let count = left.positions.len() as u32;
    let moved = right.positions.iter().map(|&[x, y, z]| [x + 5.0, y, z]);
    let positions: Vec<Vector> = left.positions.iter().copied().chain(moved).collect();
    let shifted = right.face_vertices.iter().map(|vertex| vertex + count);
    let corners: Vec<u32> = left.face_vertices.iter().copied().chain(shifted).collect();
    let mesh = validated(&polygon_mesh(&positions, &corners.chunks(3).collect::<Vec<_>>()));
    // Rows of 33 vertices run the other way on the other shell.
    let mirrored = |vertex: u32| vertex / 33 * 33 + 32 - vertex % 33;
    let truth: Vec<u32> =
        (0..2 * count).map(|v| if v < count { mirrored(v) + count } else { mirrored(v - count) }).collect();
    let found = Map::near(&mesh, &truth).paired(&mesh, None, Reflection).unwrap();
    let (_, right) = shares(&mesh, &truth, &found);
    assert!(right > 0.9, "{right}");
}

#[test]
fn shells_that_connectivity_pairs_and_tiny_ones_are_left_alone() {
    let mirrored =
        |side: i32| move |v: u32| v / side as u32 * side as u32 + side as u32 - 1 - v % side as u32;
    let even = |x: f64, y: f64| hills(x, y) + hills(-x, y);
    let mesh = validated(&sheet(16, even));
    let truth: Vec<u32> = (0..33 * 33).map(mirrored(33)).collect();
    let map = Map::near(&mesh, &truth);
    assert!(map.paired(&mesh, None, Reflection).is_some());
    let known = |count: usize| {
        let partner = (0..truth.len()).map(|point| if point < count { truth[point] } else { NONE }).collect();
        let no = vec![false; truth.len()];
        Automorphism { partner, exact: no.clone(), covered: count, complete: false, unrivalled: no }
    };
    assert!(map.paired(&mesh, Some(&known(33 * 33)), Reflection).is_none());
    assert!(map.paired(&mesh, Some(&known(33 * 10)), Reflection).is_some());
    let tiny = validated(&sheet(2, even));
    let truth: Vec<u32> = (0..25).map(mirrored(5)).collect();
    assert!(Map::near(&tiny, &truth).paired(&tiny, None, Reflection).is_none());
}

#[test]
fn points_without_a_partner_stay_without() {
    let mesh = validated(&with_random_diagonals(&example("human")));
    let mut map = Map::near(&mesh, &example_truth("human"));
    map.partner.fill(NONE);
    assert!(map.paired(&mesh, None, Reflection).is_none());
}

#[test]
fn it_can_be_cancelled() {
    let mesh = validated(&with_random_diagonals(&example("human")));
    let map = Map::near(&mesh, &example_truth("human"));
    let token = CancelToken::default();
    token.cancel();
    let progress = Progress::new(None, token);
    let estimate = Estimate { partner: &map.partner, image: &map.image };
    assert!(matches!(find(&mesh, estimate, None, Reflection, 2, &progress), Err(Error::Cancelled)));
}
