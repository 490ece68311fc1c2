//! Laplacian and eigenbasis against truth that is not ours: closed forms, and SciPy on an example mesh.

mod support;

use faer::Mat;
use intrinsym::internals::spectral::dense::product;
use intrinsym::internals::spectral::eigenbasis::Eigenbasis;
use intrinsym::internals::spectral::laplacian::IntrinsicSurface;
use intrinsym::{CancelToken, Error, PolygonMesh, Progress};
use std::cell::{Cell, RefCell};
use std::f64::consts::PI;
use support::{creature, example, icosphere, rectangle, validated};

fn solve(mesh: &PolygonMesh, count: usize) -> (IntrinsicSurface, Eigenbasis) {
    let surface = IntrinsicSurface::new(&validated(mesh).shells()[0]);
    let basis = Eigenbasis::exact(&surface, count, &Progress::default()).unwrap();
    (surface, basis)
}

fn assert_near(found: &[f64], expected: &[f64], relative: f64) {
    assert!(found.len() >= expected.len(), "{} of {} eigenvalues", found.len(), expected.len());
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found / expected - 1.0).abs() < relative, "{index}: {found} for {expected}");
    }
}

/// `left^T mass right`.
fn mass_products(surface: &IntrinsicSurface, left: &Mat<f64>, right: &Mat<f64>) -> Mat<f64> {
    let weighted = Mat::from_fn(right.nrows(), right.ncols(), |i, j| surface.lumped_mass[i] * right[(i, j)]);
    product(left.transpose(), weighted.as_ref())
}

#[test]
fn a_sphere_has_its_eigenvalues_with_their_multiplicities() {
    let (_, basis) = solve(&icosphere(4), 24);
    let level = |l: usize| vec![4.0 * PI * (l * (l + 1)) as f64; 2 * l + 1];
    let expected: Vec<f64> = (1..=4).flat_map(level).collect();
    assert_near(&basis.eigenvalues, &expected, 0.01);
}

#[test]
fn a_rectangle_has_its_closed_form_with_a_free_boundary() {
    let [width, height] = [1.0, 1.7];
    let (_, basis) = solve(&rectangle(40, 68, [width, height]), 20);
    let value =
        |m: usize, n: usize| PI * PI * ((m * m) as f64 / width.powi(2) + (n * n) as f64 / height.powi(2));
    let mut expected: Vec<f64> =
        (0..12).flat_map(|m| (0..12).map(move |n| width * height * value(m, n))).collect();
    expected.sort_by(f64::total_cmp);
    assert_near(&basis.eigenvalues, &expected[1..=20], 0.01);
}

#[test]
fn the_quadruped_has_the_eigenvalues_that_scipy_finds() {
    let golden: serde_json::Value =
        serde_json::from_str(include_str!("data/golden/quadruped_eigenvalues.json")).unwrap();
    let expected: Vec<f64> =
        golden["eigenvalues"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
    let mesh = example("quadruped");
    assert_eq!(golden["vertices"].as_u64().unwrap() as usize, mesh.positions.len());
    assert_eq!(expected.len(), 50);
    // Mollification adds up to 1e-5 of the mean edge length to every edge.
    assert_near(&solve(&mesh, 50).1.eigenvalues, &expected, 1e-4);
}

#[test]
fn eigenfunctions_are_orthonormal_in_the_lumped_mass_and_solve_the_equation() {
    let mut meshes = [icosphere(3), rectangle(12, 30, [0.1, 3.0]), creature(3, 0.4), example("quadruped")];
    meshes[2].positions.iter_mut().flatten().for_each(|coordinate| *coordinate *= 1e-7);
    for (index, mesh) in meshes.iter().enumerate() {
        let (surface, basis) = solve(mesh, 40);
        assert!((surface.lumped_mass.iter().sum::<f64>() - 1.0).abs() < 1e-3, "mesh {index}");
        let gram = mass_products(&surface, &basis.eigenfunctions, &basis.eigenfunctions);
        let constant = Mat::from_fn(surface.vertex_count(), 1, |_, _| 1.0);
        let means = mass_products(&surface, &constant, &basis.eigenfunctions);
        for i in 0..40 {
            assert!(means[(0, i)].abs() < 1e-6, "mesh {index}: mean {} of {i}", means[(0, i)]);
            for j in 0..40 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((gram[(i, j)] - expected).abs() < 1e-9, "mesh {index}: {i} {j} {}", gram[(i, j)]);
            }
        }
        assert!(basis.eigenvalues.is_sorted());
        let residuals = basis.residuals(&surface);
        assert_eq!(residuals.len(), 40);
        assert!(residuals.iter().all(|residual| *residual < 1e-5), "{residuals:?}");
    }
}

#[test]
fn the_dense_and_the_lanczos_solver_agree() {
    let mesh = creature(3, 0.4);
    let (surface, lanczos) = solve(&mesh, 30);
    // So many eigenpairs of 642 vertices are left to the dense solver.
    let (_, dense) = solve(&mesh, 620);
    assert_eq!((lanczos.count(), dense.count()), (30, 620));
    assert_near(&lanczos.eigenvalues, &dense.eigenvalues[..30], 1e-9);
    let overlaps = mass_products(&surface, &lanczos.eigenfunctions, &dense.eigenfunctions);
    for i in 0..30 {
        assert!((overlaps[(i, i)].abs() - 1.0).abs() < 1e-6, "function {i}: {}", overlaps[(i, i)]);
    }
}

#[test]
fn the_basis_for_maps_is_orthonormal_and_near_the_full_one() {
    // Of the quadruped's coarsest operator one block of vectors is left, and 16 functions are carried along for 12.
    let shapes =
        [(creature(5, 0.4), 50), (example("human"), 100), (creature(5, 0.4), 12), (example("quadruped"), 12)];
    for (mesh, count) in shapes {
        let (surface, full) = solve(&mesh, count);
        let basis = Eigenbasis::new(&surface, count, 2, &Progress::default()).unwrap();
        assert_eq!(basis.count(), count);
        let gram = mass_products(&surface, &basis.eigenfunctions, &basis.eigenfunctions);
        let overlaps = mass_products(&surface, &full.eigenfunctions, &basis.eigenfunctions);
        for i in 0..count {
            let (found, expected) = (basis.eigenvalues[i], full.eigenvalues[i]);
            let most = if i < count / 2 { 1e-5 } else { 2e-2 };
            // Ritz values lie above the eigenvalues.
            assert!((-1e-7..most).contains(&(found / expected - 1.0)), "{i}: {found} for {expected}");
            for j in 0..count {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((gram[(i, j)] - expected).abs() < 1e-9, "{i} {j} {}", gram[(i, j)]);
            }
            let within: f64 = (0..count).map(|j| overlaps[(j, i)].powi(2)).sum();
            assert!(i >= count / 2 || within > 0.9999, "{i}: {within} within the exact span");
        }
    }
}

#[test]
fn a_vertex_with_thousands_of_neighbours_needs_no_coarse_start() {
    let rim = 4000;
    let angle = |i: usize| 2.0 * PI * i as f64 / rim as f64;
    let mut positions = vec![[0.0; 3]];
    positions.extend((0..rim).map(|i| [angle(i).cos(), angle(i).sin(), 0.0]));
    let faces: Vec<[u32; 3]> = (0..rim).map(|i| [0, 1 + i as u32, 1 + ((i + 1) % rim) as u32]).collect();
    let (surface, full) = solve(&support::polygon_mesh(&positions, &faces), 50);
    let basis = Eigenbasis::new(&surface, 50, 1, &Progress::default()).unwrap();
    assert_near(&basis.eigenvalues, &full.eigenvalues, 1e-3);
}

#[test]
fn no_more_eigenpairs_are_given_than_there_are() {
    let tetrahedron = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mesh = support::polygon_mesh(&tetrahedron, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    assert_eq!(solve(&mesh, 50).1.count(), 3);
}

#[test]
fn eigen_answers_in_the_callers_numbering_and_leaves_other_shells_out() {
    let mut mesh = icosphere(2);
    let first = mesh.positions.len();
    mesh.positions.extend([[9.0, 0.0, 0.0], [9.1, 0.0, 0.0], [9.0, 0.1, 0.0], [7.0, 7.0, 7.0]]);
    mesh.face_vertices.extend([first as u32, first as u32 + 1, first as u32 + 2]);
    mesh.face_offsets.push(mesh.face_vertices.len() as u32);
    let eigen = intrinsym::eigen(&validated(&mesh), 8, &Progress::default()).unwrap();
    assert_eq!(eigen.eigenfunctions.len(), 8 * mesh.positions.len());
    assert!(eigen.eigenfunctions[..8 * first].iter().all(|value| value.is_finite()));
    assert!(eigen.eigenfunctions[8 * first..].iter().all(|value| value.is_nan()));
    assert!(eigen.lumped_mass[first..].iter().all(|mass| *mass == 0.0));
    for j in 0..8 {
        let squares = (0..first).map(|i| eigen.lumped_mass[i] * eigen.eigenfunctions[8 * i + j].powi(2));
        assert!((squares.sum::<f64>() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn eigen_can_be_cancelled_from_its_first_step_on() {
    let mesh = validated(&icosphere(3));
    let cancelled_at = |last: usize| {
        let (token, reports) = (CancelToken::default(), Cell::new(0));
        let count = |_: &str, _: f64| {
            reports.set(reports.get() + 1);
            if reports.get() == last {
                token.cancel();
            }
        };
        let found = intrinsym::eigen(&mesh, 8, &Progress::new(Some(&count), token.clone()));
        (found.map(|_| ()), reports.get())
    };
    // Before the shells, the Laplacian, the factor's structure, and the factor.
    for last in 1..=4 {
        assert!(matches!(cancelled_at(last), (Err(Error::Cancelled), reports) if reports == last));
    }
    let mut stages = Vec::new();
    let stage = RefCell::new(&mut stages);
    let note = |name: &str, _: f64| stage.borrow_mut().push(name.to_string());
    intrinsym::eigen(&mesh, 8, &Progress::new(Some(&note), CancelToken::default())).unwrap();
    assert_eq!(stages[..4], ["shells", "laplacian", "eigenfunctions", "eigenfunctions"]);
}
