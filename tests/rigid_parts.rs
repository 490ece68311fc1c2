//! The fit of the map's rigid parts to the surface, on shapes whose true map is known.

mod support;

use intrinsym::SymmetryKind::{HalfTurn, Reflection};
use intrinsym::internals::base::effort::PartsEffort;
use intrinsym::internals::geometry::surface_walk::SurfaceWalk;
use intrinsym::internals::geometry::vertex_map::VertexMap;
use intrinsym::internals::mesh::Shell;
use intrinsym::internals::refine::rigid_parts::{Fitted, fit};
use intrinsym::internals::spectral::laplacian::IntrinsicSurface;
use intrinsym::{CancelToken, Error, PolygonMesh, Progress, SymmetryKind};
use support::*;

/// The largest shell of a mesh whose points are its vertices.
fn shell(mesh: &PolygonMesh) -> Shell {
    let shell = validated(mesh).shells().swap_remove(0);
    assert_eq!(shell.positions.len(), mesh.positions.len());
    shell
}

/// Sends each vertex to the point of the surface nearest to where `truth` sends it, moved.
fn moved(shell: &Shell, truth: &[u32], offset: impl Fn(Vector) -> Vector) -> VertexMap {
    let walk = SurfaceWalk::new(&shell.positions, &shell.triangles);
    let image = |&vertex: &u32| {
        let position = shell.positions[vertex as usize];
        let offset = offset(position);
        walk.nearest([0, 1, 2].map(|axis| position[axis] + offset[axis]), vertex)
    };
    let (partners, points) = truth.iter().map(image).unzip();
    VertexMap { partners, points }
}

/// A displacement that changes from place to place.
fn waves(size: f64) -> impl Fn(Vector) -> Vector {
    move |[x, y, z]| [(23.0 * y).sin(), (19.0 * z).sin(), (21.0 * x).sin()].map(|value| size * value)
}

/// Distance of each image from the true one, in sqrt(area).
fn off_each(shell: &Shell, images: &VertexMap, truth: &[u32]) -> Vec<f64> {
    let position = |coordinates: &[Vector], corners: [u32; 3], weights: [f32; 3]| -> Vector {
        let at = |axis: usize| {
            (0..3).map(|k| f64::from(weights[k]) * coordinates[corners[k] as usize][axis]).sum::<f64>()
        };
        [at(0), at(1), at(2)]
    };
    (images.points.iter().zip(truth))
        .map(|(point, &vertex)| {
            let corners = shell.triangles[point.triangle as usize];
            let image = position(&shell.positions, corners, point.barycentric);
            distance(image, shell.positions[vertex as usize])
        })
        .collect()
}

/// The mean of that.
fn off(shell: &Shell, images: &VertexMap, truth: &[u32]) -> f64 {
    let errors = off_each(shell, images, truth);
    errors.iter().sum::<f64>() / errors.len() as f64
}

fn fitted_on(threads: usize, shell: &Shell, images: &VertexMap, kind: SymmetryKind) -> Fitted {
    let (surface, effort) = (IntrinsicSurface::new(shell), PartsEffort::default());
    fit(shell, &surface, images, kind, &effort, threads, &Progress::default()).unwrap()
}

fn fitted(shell: &Shell, images: &VertexMap, kind: SymmetryKind) -> VertexMap {
    fitted_on(2, shell, images, kind).images
}

/// A sphere with bumps that a half turn about z keeps and no reflection does, and that half turn.
fn turned_sphere() -> (PolygonMesh, Vec<u32>) {
    let mut mesh = icosphere(4);
    let turned = |[x, y, z]: Vector| [-x, -y, z];
    let nearest = |goal: Vector| {
        let apart = |&(_, position): &(u32, &Vector)| distance(*position, goal);
        (0..).zip(&mesh.positions).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap().0
    };
    let truth = mesh.positions.iter().map(|&position| nearest(turned(position))).collect();
    for position in &mut mesh.positions {
        let [x, y, z] = *position;
        let radius = 1.0 + 0.3 * x * y + 0.2 * z * (x * x + 2.0 * y * y) + 0.15 * (6.0 * x * y).sin() * z;
        *position = [x, y, z].map(|coordinate| radius * coordinate);
    }
    (mesh, truth)
}

#[test]
fn a_posed_body_is_mapped_more_exactly() {
    let (mesh, truth) = (example("human"), example_truth("human"));
    let shell = shell(&mesh);
    let images = moved(&shell, &truth, waves(0.01));
    let before = off(&shell, &images, &truth);
    let after = off(&shell, &fitted(&shell, &images, Reflection), &truth);
    assert!(before > 0.007, "{before}");
    assert!(after < 0.4 * before, "{before} {after}");
}

#[test]
fn an_exact_map_of_a_posed_body_hardly_moves() {
    let (mesh, truth) = (example("human"), example_truth("human"));
    let shell = shell(&mesh);
    let after = off(&shell, &fitted(&shell, &moved(&shell, &truth, |_| [0.0; 3]), Reflection), &truth);
    // A quarter of an edge.
    assert!(after < 0.002, "{after}");
}

#[test]
fn a_half_turn_is_fitted_without_mirroring() {
    let (mesh, truth) = turned_sphere();
    let shell = shell(&mesh);
    let images = moved(&shell, &truth, waves(0.01));
    let before = off(&shell, &images, &truth);
    let after = off(&shell, &fitted(&shell, &images, HalfTurn), &truth);
    // Round places let it slide.
    assert!(before > 0.006 && after < 0.6 * before, "{before} {after}");
    // As a reflection no part fits.
    let as_reflection = off(&shell, &fitted(&shell, &images, Reflection), &truth);
    assert!(as_reflection > 0.8 * before, "{before} {as_reflection}");
}

#[test]
fn most_vertices_torn_from_those_around_them_are_brought_back() {
    let (mesh, truth) = (example("human"), example_truth("human"));
    let shell = shell(&mesh);
    let mut images = moved(&shell, &truth, waves(0.005));
    let torn: Vec<usize> = (0..truth.len()).step_by(97).collect();
    for &vertex in &torn {
        let other = (vertex + truth.len() / 2) % truth.len();
        images.partners[vertex] = images.partners[other];
        images.points[vertex] = images.points[other];
    }
    let far = |images: &VertexMap| {
        let errors = off_each(&shell, images, &truth);
        torn.iter().filter(|&&vertex| errors[vertex] > 0.05).count() as f64 / torn.len() as f64
    };
    assert!(far(&images) > 0.85, "{}", far(&images));
    // The others are where no part fits, as at a bent joint.
    let left = far(&fitted(&shell, &images, Reflection));
    assert!(left < 0.5, "{left}");
}

/// A bust: a broad body with a belly, a round neck, a head with a nose and ears. And its mirror images in x.
fn bust() -> (PolygonMesh, Vec<u32>) {
    let mut mesh = icosphere(5);
    let mirrored = creature_truth(&mesh);
    let bump = |at: Vector, middle: Vector, width: f64| (-(distance(at, middle) / width).powi(2)).exp();
    for position in &mut mesh.positions {
        let at @ [x, y, z] = *position;
        let girth =
            0.3 + 0.6 * (-((z + 0.55) / 0.35).powi(2)).exp() + 0.35 * (-((z - 0.8) / 0.15).powi(2)).exp();
        let ears = bump(at, [0.5, -0.2, 0.84], 0.15) - bump(at, [-0.5, -0.2, 0.84], 0.15);
        let nose = bump(at, [0.0, 0.6, 0.8], 0.2);
        let belly = bump(at, [0.0, 0.8, -0.6], 0.4);
        *position = [1.3 * girth * x + 0.3 * ears, girth * y + 0.3 * nose + 0.4 * belly, 2.0 * z];
    }
    (mesh, mirrored)
}

/// How far up the bust's neck a position is: 0 on the body, 1 on the head.
fn up_the_neck(shell: &Shell) -> impl Fn(Vector) -> f64 {
    let heights = || shell.positions.iter().map(|position| position[2]);
    let (top, bottom) = (heights().fold(f64::MIN, f64::max), heights().fold(f64::MAX, f64::min));
    move |position: Vector| {
        let share = (((position[2] - bottom) / (top - bottom) - 0.6) / 0.15).clamp(0.0, 1.0);
        share * share * (3.0 - 2.0 * share)
    }
}

/// The displacement that turns the bust's head by an angle, and its neck by a part of it.
fn head_turned(shell: &Shell, angle: f64) -> impl Fn(Vector) -> Vector {
    let up = up_the_neck(shell);
    move |position: Vector| {
        let turned = rotated(position, [0.0, 0.0, 1.0], angle * up(position));
        [0, 1, 2].map(|axis| turned[axis] - position[axis])
    }
}

#[test]
fn a_head_mapped_as_if_it_were_turned_is_found() {
    let (mesh, truth) = bust();
    let shell = shell(&mesh);
    for degrees in [-120.0f64, 60.0, 170.0] {
        let images = moved(&shell, &truth, head_turned(&shell, degrees.to_radians()));
        let before = off(&shell, &images, &truth);
        let after = off(&shell, &fitted(&shell, &images, Reflection), &truth);
        assert!(before > 0.02 && after < 0.1 * before, "{degrees}: {before} {after}");
    }
}

#[test]
fn a_head_that_is_not_mirrored_is_found() {
    let (mesh, truth) = bust();
    let shell = shell(&mesh);
    // The head's images are where they were, so the map folds in the neck.
    let up = up_the_neck(&shell);
    let images = moved(&shell, &truth, |image| [-2.0 * up(image) * image[0], 0.0, 0.0]);
    let before = off(&shell, &images, &truth);
    let after = off(&shell, &fitted(&shell, &images, Reflection), &truth);
    assert!(before > 0.04 && after < 0.1 * before, "{before} {after}");
}

#[test]
fn turned_heads_are_left_alone_where_nobody_asks_for_them() {
    let (mesh, truth) = bust();
    let shell = shell(&mesh);
    let images = moved(&shell, &truth, head_turned(&shell, 1.2));
    let surface = IntrinsicSurface::new(&shell);
    let off_if = |turned: bool| {
        let effort = PartsEffort::default();
        let effort = if turned { effort } else { effort.without_turned() };
        let found = fit(&shell, &surface, &images, Reflection, &effort, 2, &Progress::default()).unwrap();
        off(&shell, &found.images, &truth)
    };
    assert!(off_if(false) > 5.0 * off_if(true), "{} {}", off_if(false), off_if(true));
}

#[test]
fn parts_disagree_where_the_sides_differ() {
    let rigidity = |mesh: &PolygonMesh, truth: &[u32], kind| {
        let shell = shell(mesh);
        let images = moved(&shell, truth, |_| [0.0; 3]);
        fitted_on(2, &shell, &images, kind).rigidity.unwrap()
    };
    let (mesh, truth) = bust();
    let same = rigidity(&mesh, &truth, Reflection);
    assert!(same.disagreement < 1e-4 && same.scatter == 0.0, "{same:?}");
    // One side is swollen here and sunken there.
    let mut uneven = mesh.clone();
    for position in uneven.positions.iter_mut().filter(|position| position[0] > 0.0) {
        let wave = 1.0 + 0.3 * position[0] * (5.0 * position[2]).sin();
        *position = position.map(|coordinate| wave * coordinate);
    }
    let differing = rigidity(&uneven, &truth, Reflection);
    assert!(differing.disagreement > 0.02, "{differing:?}");
    // A pose bends some places; and a half turn moves no part as a reflection does.
    let (posed, truth) = (example("human"), example_truth("human"));
    let (bent, turned) = (rigidity(&posed, &truth, Reflection), rigidity(&posed, &truth, HalfTurn));
    assert!(bent.disagreement < 0.02 && turned.disagreement > 2.0 * bent.disagreement, "{bent:?}");
    assert!(bent.scatter == 0.0, "{bent:?}");
}

#[test]
fn threads_change_nothing() {
    let (mesh, truth) = (example("quadruped"), example_truth("quadruped"));
    let shell = shell(&mesh);
    let images = moved(&shell, &truth, waves(0.01));
    let on = |threads| fitted_on(threads, &shell, &images, Reflection);
    let alone = on(1);
    for threads in [2, 5, 64] {
        let found = on(threads);
        assert_eq!(alone.images.partners, found.images.partners);
        assert_eq!(alone.images.points, found.images.points);
        assert_eq!(alone.rigidity, found.rigidity);
    }
}

#[test]
fn a_surface_without_two_sides_keeps_its_map() {
    let mut mesh = rectangle(40, 5, [8.0, 1.0]);
    // The last column becomes the first one, upside down.
    let turned = |vertex: u32| if vertex % 41 == 40 { (5 - vertex / 41) * 41 } else { vertex };
    for corner in &mut mesh.face_vertices {
        *corner = turned(*corner);
    }
    let mesh = validated(&mesh);
    let shell = mesh.shells().swap_remove(0);
    assert!(!shell.orientable);
    let truth: Vec<u32> = (0..shell.positions.len() as u32).rev().collect();
    let images = moved(&shell, &truth, waves(0.05));
    let found = fitted(&shell, &images, Reflection);
    assert_eq!((found.partners, found.points), (images.partners.clone(), images.points.clone()));
    assert_eq!(fitted_on(2, &shell, &images, Reflection).rigidity, None);
}

#[test]
fn tiny_and_coarse_shells_are_survived() {
    for mesh in [icosphere(0), icosphere(1), rectangle(2, 2, [1.0, 1.0])] {
        let shell = shell(&mesh);
        let truth: Vec<u32> = (0..shell.positions.len() as u32).rev().collect();
        let found = fitted(&shell, &moved(&shell, &truth, |_| [0.0; 3]), Reflection);
        assert_eq!(found.points.len(), truth.len());
        let weights = found.points.iter().flat_map(|point| point.barycentric);
        assert!(weights.into_iter().all(|weight| (-1e-6..=1.0 + 1e-6).contains(&weight)));
    }
}

#[test]
fn it_can_be_cancelled() {
    let (mesh, truth) = (example("quadruped"), example_truth("quadruped"));
    let shell = shell(&mesh);
    let token = CancelToken::default();
    token.cancel();
    let (surface, images) = (IntrinsicSurface::new(&shell), moved(&shell, &truth, |_| [0.0; 3]));
    let found =
        fit(&shell, &surface, &images, Reflection, &PartsEffort::default(), 2, &Progress::new(None, token));
    assert!(matches!(found, Err(Error::Cancelled)));
}
