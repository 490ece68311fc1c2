//! Shapes with and without a continuous family of symmetries, triangulated without regard to it.

mod support;

use intrinsym::internals::spectral::continuous_family::{Orbits, orbits};
use intrinsym::internals::spectral::eigenbasis::Eigenbasis;
use intrinsym::internals::spectral::laplacian::IntrinsicSurface;
use intrinsym::{Options, Outcome, PolygonMesh, Progress, detect};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use support::{Vector, creature, dot, example, icosphere, polygon_mesh, rectangle, rotated, validated};

fn judged(mesh: &PolygonMesh) -> Orbits {
    let surface = IntrinsicSurface::new(&validated(mesh).shells()[0]);
    let basis = Eigenbasis::new(&surface, 150, 1, &Progress::default()).unwrap();
    orbits(&surface, &basis)
}

#[track_caller]
fn assert_family(name: &str, mesh: &PolygonMesh, expected: bool) {
    let found = judged(mesh);
    println!("{name}: {:?}", found.least_gradient);
    assert_eq!(found.continuous, expected, "{name}: {found:?}");
}

/// A unit icosphere, of which no axis is a coordinate axis, with its points moved.
fn moved_sphere(levels: usize, place: impl Fn(Vector) -> Vector) -> PolygonMesh {
    let mut mesh = icosphere(levels);
    for position in &mut mesh.positions {
        *position = place(rotated(*position, [1.0, 2.0, 3.0], 1.0));
    }
    mesh
}

/// `columns * rows` points of a map of the unit square, whose left and right sides meet, and top and bottom if `closed`.
/// Odd rows are shifted by half a column.
fn rolled(columns: usize, rows: usize, closed: bool, place: impl Fn(f64, f64) -> Vector) -> PolygonMesh {
    let steps = (rows - usize::from(!closed)) as f64;
    let at = |i: usize, j: usize| (j % rows * columns + i % columns) as u32;
    let around = |i: usize, j: usize| (i as f64 + 0.5 * (j % 2) as f64) / columns as f64;
    let points = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let positions: Vec<Vector> = points.map(|(i, j)| place(around(i, j), j as f64 / steps)).collect();
    let mut triangles = Vec::new();
    for j in 0..steps as usize {
        for i in 0..columns {
            // The upper row's neighbours of a point lie at the same index and at the one before or after.
            let (left, right) = if j % 2 == 0 { (i + columns - 1, i) } else { (i, i + 1) };
            triangles.push([at(i, j), at(right, j + 1), at(left, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j), at(right, j + 1)]);
        }
    }
    polygon_mesh(&positions, &triangles)
}

/// A cube of edge 2, each side cut into `parts * parts` squares, in two triangles each.
fn cube(parts: usize) -> PolygonMesh {
    let face = rectangle(parts, parts, [2.0, 2.0]);
    let (mut positions, mut triangles): (Vec<Vector>, Vec<[u32; 3]>) = Default::default();
    let mut known = BTreeMap::new();
    for side in 0..6 {
        let height = if side % 2 == 0 { 1.0 } else { -1.0 };
        let mut at = |corner: u32| {
            let [x, y, _] = face.positions[corner as usize];
            let mut place = [x - 1.0, y - 1.0, height];
            place.rotate_right(side / 2);
            let key = place.map(|coordinate| (coordinate * parts as f64).round() as i64);
            *known.entry(key).or_insert_with(|| {
                positions.push(place);
                positions.len() as u32 - 1
            })
        };
        for corners in face.face_vertices.chunks_exact(3) {
            triangles.push([at(corners[0]), at(corners[1]), at(corners[2])]);
        }
    }
    polygon_mesh(&positions, &triangles)
}

fn torus(u: f64, v: f64) -> Vector {
    let radius = 1.0 + 0.4 * (TAU * v).cos();
    [radius * (TAU * u).cos(), radius * (TAU * u).sin(), 0.4 * (TAU * v).sin()]
}

/// Radius of a vase at the height `z` in -1..=1.
fn vase_radius(z: f64) -> f64 {
    0.6 + 0.2 * (4.0 * z + 1.0).sin() + 0.1 * (7.0 * z).cos()
}

fn bumped(point: Vector, at: Vector, height: f64) -> Vector {
    let away: f64 = (0..3).map(|axis| (point[axis] - at[axis]).powi(2)).sum();
    let size = height * (-away / 0.06).exp() / dot(at, at).sqrt();
    std::array::from_fn(|axis| point[axis] + size * at[axis])
}

#[test]
fn surfaces_of_revolution_have_a_family() {
    assert_family("sphere", &icosphere(4), true);
    assert_family("oblate", &moved_sphere(4, |[x, y, z]| [x, y, 0.5 * z]), true);
    assert_family("prolate", &moved_sphere(4, |[x, y, z]| [x, y, 2.0 * z]), true);
    assert_family("egg", &moved_sphere(4, |[x, y, z]| [x, y, 1.3 * z + 0.3 * z * z]), true);
    let vase = |u: f64, v: f64| {
        let (radius, turn) = (vase_radius(2.0 * v - 1.0), TAU * u);
        [radius * turn.cos(), radius * turn.sin(), 3.0 * v]
    };
    assert_family("vase", &rolled(70, 60, false, vase), true);
    assert_family("torus", &rolled(60, 36, true, torus), true);
    let cylinder = |u: f64, v: f64| [(TAU * u).cos(), (TAU * u).sin(), 3.0 * v];
    assert_family("open cylinder", &rolled(60, 30, false, cylinder), true);
    let annulus = |u: f64, v: f64| [(1.0 + v) * (TAU * u).cos(), (1.0 + v) * (TAU * u).sin(), 0.0];
    assert_family("annulus", &rolled(80, 20, false, annulus), true);
    // What counts is the surface alone: an open tube of any section can be rolled into a cylinder.
    let tube = |u: f64, v: f64| {
        let (side, along) = ((4.0 * u) as usize % 4, (4.0 * u).fract());
        let corners: [[f64; 2]; 4] = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        [from[0] + along * (to[0] - from[0]), from[1] + along * (to[1] - from[1]), 6.0 * v]
    };
    assert_family("open square tube", &rolled(64, 48, false, tube), true);
}

#[test]
fn shapes_with_a_few_symmetries_or_none_have_no_family() {
    assert_family("triaxial", &moved_sphere(4, |[x, y, z]| [x, 0.8 * y, 0.64 * z]), false);
    assert_family("creature", &creature(4, 0.4), false);
    assert_family(
        "two bumps",
        &moved_sphere(4, |p| bumped(bumped(p, [1.0, 0.0, 0.0], 0.3), [0.0, 0.6, 0.8], 0.4)),
        false,
    );
    assert_family(
        "bumped torus",
        &rolled(60, 36, true, |u, v| bumped(torus(u, v), [1.4, 0.0, 0.0], 0.3)),
        false,
    );
    let waves = |[x, y, z]: Vector| {
        let radius = vase_radius(z) * (1.0 + 0.1 * (5.0 * y.atan2(x)).cos());
        [radius * x, radius * y, 1.5 * z]
    };
    assert_family("fluted vase", &moved_sphere(4, waves), false);
    assert_family("cube", &cube(16), false);
    assert_family("cube of few vertices", &cube(1), false);
    assert_family("cube of more vertices", &cube(3), false);
    assert_family("square", &rectangle(24, 24, [1.0, 1.0]), false);
    assert_family("box's side", &rectangle(30, 20, [3.0, 2.0]), false);
    for name in ["human", "quadruped", "blob"] {
        assert_family(name, &example(name), false);
    }
}

#[test]
fn a_ring_of_few_sides_is_a_polygon_and_no_circle() {
    for (sides, expected) in [(3, false), (4, false), (6, false), (8, false), (16, true), (32, true)] {
        // Rings of no more points than sides, not turned against each other.
        let place = |u: f64, v: f64| {
            let (z, turn) = (2.0 * v - 1.0, TAU * (u * sides as f64).floor() / sides as f64);
            [vase_radius(z) * turn.cos(), vase_radius(z) * turn.sin(), 1.5 * z]
        };
        assert_family(&format!("vase of {sides} sides"), &rolled(sides, 24, false, place), expected);
    }
}

#[test]
fn noise_leaves_a_family_one() {
    let mut random = 1u64;
    let mut noise = move || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((random >> 33) as f64 / (1u64 << 31) as f64 - 0.5) * 12f64.sqrt()
    };
    let mut mesh = rolled(90, 54, true, torus);
    let edge = TAU / 90.0;
    for position in &mut mesh.positions {
        *position = position.map(|coordinate| coordinate + 0.04 * edge * noise());
    }
    assert_family("torus with noise of 4 % of an edge", &mesh, true);
}

#[test]
fn the_report_says_so_and_the_map_stays() {
    let mesh = validated(&rolled(48, 24, true, torus));
    let options = Options { symmetries: 3, ..Options::default() };
    let found = detect(&mesh, &options, &Progress::default()).unwrap();
    assert_eq!(found.outcome, Outcome::Found, "{}", found.report.evidence());
    assert!(found.report.continuous_family);
    assert!(found.report.least_signature_gradient.unwrap() < 0.012);
    assert!(
        found.report.evidence().contains("a continuous family of symmetries"),
        "{}",
        found.report.evidence()
    );

    let plain = detect(&validated(&creature(3, 0.4)), &Options::default(), &Progress::default()).unwrap();
    assert!(!plain.report.continuous_family && !plain.report.evidence().contains("continuous"));
}

#[test]
fn a_strip_that_cannot_be_oriented_is_not_judged() {
    let strip = rectangle(60, 6, [6.0, 1.0]);
    let turn = |[x, y, _]: Vector| {
        let (angle, half) = (TAU * x / 6.0, PI * x / 6.0);
        let radius = 1.0 + (y - 0.5) * half.cos();
        [radius * angle.cos(), radius * angle.sin(), (y - 0.5) * half.sin()]
    };
    let mut mesh = strip.clone();
    mesh.positions.iter_mut().for_each(|position| *position = turn(*position));
    // The last column lies on the first, upside down.
    for corner in &mut mesh.face_vertices {
        if *corner % 61 == 60 {
            *corner = (6 - *corner / 61) * 61;
        }
    }
    let found = judged(&mesh);
    assert_eq!((found.least_gradient, found.continuous), (None, false));
}
