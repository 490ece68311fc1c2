//! Maps found on a simplified mesh and carried back to all vertices.

mod support;

use intrinsym::internals::detect::proxy::Proxy;
use intrinsym::internals::detect::stated_signs;
use intrinsym::internals::geometry::embedded_triangles::TrianglePoint;
use intrinsym::internals::geometry::vertex_map::VertexMap;
use intrinsym::internals::mesh::Shell;
use intrinsym::internals::spectral::eigenbasis::Eigenbasis;
use intrinsym::internals::spectral::laplacian::IntrinsicSurface;
use intrinsym::{Detection, Options, Outcome, Progress, detect};
use std::collections::HashMap;
use support::*;

fn through_proxy(polygons: &intrinsym::PolygonMesh, proxy_vertices: usize) -> Detection {
    let mesh = validated(polygons);
    let options = Options { proxy_vertices, ..Options::default() };
    let found = detect(&mesh, &options, &Progress::default()).unwrap();
    println!("solved on {}: {}", found.report.solved_vertices, found.report.evidence());
    assert_keeps_its_contract(&mesh, &options, &found);
    found
}

fn human_shell() -> Shell {
    validated(&with_random_diagonals(&example("human"))).shells().swap_remove(0)
}

fn at(shell: &Shell, point: &TrianglePoint) -> Vector {
    let corners = shell.triangles[point.triangle as usize].map(|corner| shell.positions[corner as usize]);
    std::array::from_fn(|axis| (0..3).map(|c| f64::from(point.barycentric[c]) * corners[c][axis]).sum())
}

#[test]
fn a_proxy_is_coarser_connected_and_near_the_shell() {
    let fine = human_shell();
    let proxy = Proxy::new(&fine, 3000, 2).unwrap();
    let count = proxy.shell.positions.len();
    assert!((2000..4000).contains(&count), "{count}");
    let mut met = vec![false; count];
    proxy.shell.triangles.as_flattened().iter().for_each(|&vertex| met[vertex as usize] = true);
    assert!(met.iter().all(|met| *met));
    // Coordinates are carried to where the vertices are.
    for axis in 0..3 {
        let own: Vec<f64> = proxy
            .shell
            .points
            .iter()
            .map(|point| fine.positions[fine.points.binary_search(point).unwrap()][axis])
            .collect();
        let carried = proxy.carry_values(&own);
        let worst = carried.iter().zip(&fine.positions).map(|(a, b)| (a - b[axis]).abs()).fold(0.0, f64::max);
        assert!(worst < 0.02, "{worst} sqrt(area) along axis {axis}");
    }
}

#[test]
fn the_identity_on_the_proxy_is_carried_to_the_identity() {
    let fine = human_shell();
    let proxy = Proxy::new(&fine, 3000, 2).unwrap();
    let itself = (0..proxy.shell.positions.len() as u32).collect();
    let carried = proxy.carry_images(&VertexMap::at_vertices(&proxy.shell.triangles, itself));
    let moved = |vertex: usize| distance(at(&fine, &carried.points[vertex]), fine.positions[vertex]);
    let worst = (0..fine.positions.len()).map(moved).fold(0.0, f64::max);
    assert!(worst < 0.02, "{worst} sqrt(area)");
    let kept = (0u32..).zip(&carried.partners).filter(|(vertex, partner)| vertex == *partner).count();
    // Measured: 88 %; the rest lie beside the proxy and go to a neighbour.
    assert!(5 * kept > 4 * fine.positions.len(), "{kept} of {}", fine.positions.len());
}

#[test]
fn a_known_map_is_restricted_to_the_proxy() {
    let polygons = example("human");
    let fine = validated(&polygons).shells().swap_remove(0);
    let proxy = Proxy::new(&fine, 3000, 2).unwrap();
    let partners = example_truth("human");
    let images = proxy.restrict(&partners);
    for (vertex, point) in images.points.iter().enumerate() {
        let own = fine.points.binary_search(&proxy.shell.points[vertex]).unwrap();
        let image = fine.positions[partners[own] as usize];
        let corners = proxy.shell.triangles[point.triangle as usize]
            .map(|corner| fine.points.binary_search(&proxy.shell.points[corner as usize]).unwrap());
        let found: Vector = std::array::from_fn(|axis| {
            (0..3).map(|c| f64::from(point.barycentric[c]) * fine.positions[corners[c]][axis]).sum()
        });
        assert!(distance(found, image) < 0.02, "{vertex}");
    }
}

#[test]
fn no_proxy_where_the_shell_is_coarse_enough() {
    let fine = human_shell();
    assert!(Proxy::new(&fine, fine.points.len(), 1).is_none());
    let found = through_proxy(&example("quadruped"), 15_000);
    assert_eq!(found.report.solved_vertices, found.report.vertices);
}

/// A shell with a long boundary has fewer triangles than a closed one of as many vertices as its proxy.
#[test]
fn a_long_boundary_is_simplified_as_far_as_a_closed_surface() {
    for [columns, rows] in [[1000, 3], [60, 50]] {
        let polygons = rectangle(columns, rows, [4.0, 1.0]);
        let fine = validated(&polygons).shells().swap_remove(0);
        for wanted in [fine.points.len() - 1, fine.points.len() * 9 / 10, fine.points.len() / 2] {
            let Some(proxy) = Proxy::new(&fine, wanted, 1) else { continue };
            let count = proxy.shell.positions.len();
            assert!(count < wanted * 3 / 2, "{count} of {wanted} wanted");
            assert!(2 * count > wanted, "{count} of {wanted} wanted");
        }
        assert!(Proxy::new(&fine, fine.points.len() * 9 / 10, 1).is_some());
    }
}

/// The mesh on which a map that was found will be judged again is a proxy too, of 3,000 vertices.
#[test]
fn a_sheet_hardly_finer_than_the_judging_mesh_is_answered() {
    let mut sheet = rectangle(240, 12, [4.0, 1.0]);
    // A trapezium, twisted about its axis: symmetric along the surface, and no plane mirrors it.
    for [x, y, z] in &mut sheet.positions {
        *y = (*y - 0.5) * (1.0 + 0.3 * *x);
        *z = 0.3 * *x * *y;
    }
    assert!(sheet.positions.len() > 3000 && sheet.face_offsets.len() < 2 * 3000);
    let options = Options { plausibility: 0, ..Options::default() };
    let found = detect(&validated(&sheet), &options, &Progress::default()).unwrap();
    assert_eq!(found.outcome, Outcome::Found);
    assert!(found.judging.is_some());
}

#[test]
fn the_map_is_nearly_as_good_as_without_a_proxy() {
    let mesh = with_random_diagonals(&example("human"));
    let truth = example_truth("human");
    let found = through_proxy(&mesh, 4000);
    assert_eq!(found.outcome, Outcome::Found);
    assert!((3000..5000).contains(&found.report.solved_vertices));
    let best = &found.symmetries[0];
    assert_eq!(best.exact_share, 0.0);
    let (mean, far) = errors(&mesh, &best.partner, &truth);
    // Measured: see the test without a proxy in tests/detection.rs for what it is there.
    assert!(mean < 0.03 && far < 0.1, "{mean} {far}");
    let [curve] = &best.fixed_curve[..] else { panic!("{} curves", best.fixed_curve.len()) };
    assert!(curve.closed);
}

#[test]
fn mirrored_connectivity_is_found_behind_a_proxy() {
    let found = through_proxy(&example("human"), 3000);
    assert_eq!(found.symmetries[0].exact_share, 1.0);
    let wrong = found.symmetries[0].partner.iter().zip(example_truth("human"));
    assert_eq!(wrong.filter(|(partner, truth)| **partner != *truth as i32).count(), 0);
}

#[test]
fn other_shells_are_paired_behind_a_proxy() {
    let polygons = example("human_shells");
    let best = through_proxy(&polygons, 3000).symmetries.swap_remove(0);
    let (mean, far) = errors(&polygons, &best.partner, &example_truth("human_shells"));
    assert!(mean < 0.005 && far < 0.02, "{mean} {far}");
}

#[test]
fn signs_that_are_stated_of_a_mesh_hold_on_its_proxy() {
    let fine = human_shell();
    let polygons = example("human");
    let truth = example_truth("human");
    let progress = Progress::default();
    let own = IntrinsicSurface::new(&fine);
    let own = Eigenbasis::exact(&own, 12, &progress).unwrap();
    assert_eq!(polygons.positions.len(), fine.points.len());
    // How alike a function, given at some vertices of the human, and its mirror image are, -1..=1.
    let parity = |vertices: &[u32], mass: &[f64], functions: &faer::Mat<f64>, j: usize| -> f64 {
        let index: HashMap<u32, usize> = vertices.iter().copied().zip(0..).collect();
        let (mut sum, mut all) = (0.0, 0.0);
        for (i, &vertex) in vertices.iter().enumerate() {
            let mirrored = fine.points.binary_search(&truth[fine.points[vertex as usize] as usize]).unwrap();
            if let Some(&image) = index.get(&(mirrored as u32)) {
                sum += mass[i] * functions[(i, j)] * functions[(image, j)];
                all += mass[i] * functions[(i, j)].powi(2);
            }
        }
        sum / all
    };
    let all: Vec<u32> = (0..fine.points.len() as u32).collect();
    let mass = IntrinsicSurface::new(&fine).lumped_mass;
    let known: Vec<i8> = (0..12).map(|j| parity(&all, &mass, &own.eigenfunctions, j).round() as i8).collect();
    let count = |signs: &[i8]| signs.iter().filter(|sign| **sign != 0).count();
    assert!(known.contains(&1) && known.contains(&-1), "{known:?}");
    // Two functions of nearly the same eigenvalue are mixtures of an even and an odd one.
    assert_eq!(count(&known), 10, "{known:?}");
    let proxy = Proxy::new(&fine, 3000, 1).unwrap();
    let surface = IntrinsicSurface::new(&proxy.shell);
    let basis = Eigenbasis::new(&surface, 40, 1, &progress).unwrap();
    let signs = stated_signs::on_proxy(&fine, &proxy, &surface, &basis, &known, &progress).unwrap();
    assert!(count(&signs) >= 9, "{signs:?}");
    for (j, &sign) in signs.iter().enumerate().filter(|(_, sign)| **sign != 0) {
        let seen = parity(proxy.vertices(), &surface.lumped_mass, &basis.eigenfunctions, j);
        assert!(seen * f64::from(sign) > 0.5, "function {j}: {sign} stated, {seen} seen");
    }
}
