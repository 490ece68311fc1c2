//! Rotations of order three or more, which are listed for who asks for them alone.

mod support;

use intrinsym::internals::base::effort::{Mechanisms, Plan};
use intrinsym::internals::detect::driver::detect_by;
use intrinsym::{
    Detection, Effort, Options, PolygonMesh, Progress, Symmetry, SymmetryKind, detect, detect_again, report,
};
use std::f64::consts::TAU;
use support::*;

fn found(polygons: &PolygonMesh, options: &Options) -> Detection {
    let mesh = validated(polygons);
    let found = detect(&mesh, options, &Progress::default()).unwrap();
    println!("{}", found.report.evidence());
    assert_keeps_its_contract(&mesh, options, &found);
    found
}

fn asking(rotations: usize) -> Options {
    Options { rotations, ..Options::default() }
}

fn rotations(found: &Detection) -> Vec<&Symmetry> {
    found.symmetries.iter().filter(|symmetry| symmetry.kind.is_rotation()).collect()
}

/// A lump with arms around the z axis, beside each of them a bump above that no reflection and no half turn of the lump leaves in
/// place, but that about z where the arms are an even number. Its mesh has no symmetry.
fn pinwheel(arms: usize) -> PolygonMesh {
    let limb = |arm: usize, angle: f64, height: f64| {
        let angle = angle + TAU * arm as f64 / arms as f64;
        let length = (1.0 + height * height).sqrt();
        [angle.cos() / length, angle.sin() / length, height / length]
    };
    let bump = |direction: Vector, limb: Vector, size: f64, width: f64| {
        size * (width * (dot(direction, limb) - 1.0)).exp()
    };
    let radius = |direction: Vector| {
        let of_arm = |arm: usize| {
            bump(direction, limb(arm, 0.0, 0.0), 1.4, 22.0) + bump(direction, limb(arm, 0.5, 0.9), 0.6, 26.0)
        };
        1.0 + (0..arms).map(of_arm).sum::<f64>()
    };
    let mut mesh = icosphere(4);
    for position in &mut mesh.positions {
        let direction = rotated(*position, [1.0, 2.0, 3.0], 0.7);
        *position = direction.map(|coordinate| coordinate * radius(direction));
    }
    mesh
}

/// A bar of square section, with diagonals at random.
fn bar() -> PolygonMesh {
    let mut cube = cube_of_squares(14);
    cube.positions.iter_mut().for_each(|position| position[2] *= 1.6);
    with_random_diagonals(&cube)
}

/// The least mean distance of the partners from the images under a rotation about the z axis that generates all those of
/// `order`.
fn error_about_z(polygons: &PolygonMesh, symmetry: &Symmetry, order: usize) -> f64 {
    let generators = (1..order).filter(|&times: &usize| {
        (2..=order).all(|divisor| !times.is_multiple_of(divisor) || !order.is_multiple_of(divisor))
    });
    let error = |times: usize| {
        let angle = TAU * times as f64 / order as f64;
        let away = |(&position, &partner): (&Vector, &i32)| {
            distance(rotated(position, [0.0, 0.0, 1.0], angle), polygons.positions[partner as usize])
        };
        polygons.positions.iter().zip(&symmetry.partner).map(away).sum::<f64>()
            / symmetry.partner.len() as f64
    };
    generators.map(error).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_pinwheel_has_one_rotation_of_as_many_arms() {
    for arms in [3, 6] {
        let polygons = pinwheel(arms);
        let found = found(&polygons, &asking(8));
        let [rotation] = rotations(&found)[..] else { panic!("one of {arms} arms") };
        assert_eq!(rotation.kind, SymmetryKind::Rotation { order: arms });
        let error = error_about_z(&polygons, rotation, arms);
        assert!(error < 0.06, "{error} beside arms of 2.4 from the middle");
        assert!(
            found.report.evidence().contains("a rotation of higher order was found (experimental)"),
            "{}",
            found.report.evidence()
        );
    }
}

#[test]
fn a_square_bar_has_one_rotation_of_order_four_without_sides_or_curve() {
    let polygons = bar();
    let found = found(&polygons, &asking(8));
    assert_eq!(found.symmetries[0].kind, SymmetryKind::Reflection);
    let [rotation] = rotations(&found)[..] else { panic!("one") };
    assert_eq!(rotation.kind, SymmetryKind::Rotation { order: 4 });
    let error = error_about_z(&polygons, rotation, 4);
    assert!(error < 0.1, "{error} beside edges of 0.14");
    assert!(rotation.side.iter().all(|&side| side == 0) && rotation.fixed_curve.is_empty());
    assert_eq!(rotation.exact_share, 0.0);
    let json = report::json(&validated(&polygons), &found, &asking(8)).unwrap();
    assert_eq!(
        (&json["symmetries"][0]["kind"], &json["symmetries"][0]["order"]),
        (&"reflection".into(), &2.into())
    );
    assert_eq!(
        (&json["symmetries"][1]["kind"], &json["symmetries"][1]["order"]),
        (&"rotation".into(), &4.into())
    );
}

#[test]
fn who_does_not_ask_gets_none_and_the_same_besides() {
    let polygons = bar();
    // Rotations are sought by the large plan.
    let thorough = Options { effort: Effort::Thorough, ..Options::default() };
    // Who asks for none, and whose mesh is at rest, gets what a plane in space says.
    let mechanisms = Mechanisms { mirror_plane: false, ..Mechanisms::default() };
    let (mesh, plans) = (validated(&polygons), Plan::of(&thorough));
    let without = detect_by(&mesh, &thorough, &plans, mechanisms, &Progress::default()).unwrap();
    let with = found(&polygons, &asking(2));
    assert!(rotations(&without).is_empty() && !without.report.evidence().contains("rotation"));
    assert_eq!(format!("{:?}", without.symmetries[0]), format!("{:?}", with.symmetries[0]));
    assert!(rotations(&found(&pinwheel(3), &Options::default())).is_empty());
}

#[test]
fn a_bilateral_creature_and_a_sphere_list_none() {
    let creature = found(&creature(4, 0.4), &asking(8));
    assert_eq!(creature.symmetries.len(), 1);
    assert!(creature.report.evidence().ends_with("no rotation of order 3 to 12 was found (experimental)"));
    let sphere = found(&icosphere(4), &asking(8));
    assert!(rotations(&sphere).is_empty());
    assert!(sphere.report.evidence().contains("are not sought in a continuous family"));
}

#[test]
fn the_rotations_do_not_depend_on_the_threads() {
    let with = |threads| found(&pinwheel(4), &Options { threads, ..asking(4) }).symmetries;
    assert_eq!(format!("{:?}", with(1)), format!("{:?}", with(3)));
}

#[test]
fn other_shells_have_no_partner() {
    let mut polygons = pinwheel(3);
    let (large, offset) = (polygons.positions.len(), *polygons.face_offsets.last().unwrap());
    let small = icosphere(2);
    polygons.positions.extend(small.positions.iter().map(|&[x, y, z]| [0.2 * x, 0.2 * y, 0.2 * z + 1.6]));
    polygons.face_offsets.extend(small.face_offsets[1..].iter().map(|end| end + offset));
    polygons.face_vertices.extend(small.face_vertices.iter().map(|vertex| vertex + large as u32));
    let found = found(&polygons, &asking(1));
    let [rotation] = rotations(&found)[..] else { panic!("one") };
    assert!(rotation.partner[..large].iter().all(|&partner| (0..large as i32).contains(&partner)));
    assert!(rotation.partner[large..].iter().all(|&partner| partner == -1));
}

#[test]
fn a_rotation_is_kept_while_the_shape_is_deformed_and_asked_for() {
    let polygons = pinwheel(5);
    let first = found(&polygons, &asking(1));
    let mut moved = polygons.clone();
    moved.positions.iter_mut().for_each(|[x, y, z]| *z += 0.05 * (*x * *x + *y * *y));
    let mesh = validated(&moved);
    let second = detect_again(&mesh, &first, &asking(1), &Progress::default()).unwrap();
    assert_keeps_its_contract(&mesh, &asking(1), &second);
    assert!(second.report.kept, "{}", second.report.evidence());
    let ([before], [after]) = (&rotations(&first)[..], &rotations(&second)[..]) else { panic!("one each") };
    assert_eq!((after.kind, &after.partner), (before.kind, &before.partner));
    let without = detect_again(&mesh, &first, &Options::default(), &Progress::default()).unwrap();
    assert!(rotations(&without).is_empty());
}
