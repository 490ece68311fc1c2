//! The hosts' tools against truth: a lump whose mesh is mirrored in x, the same lump with one limb posed,
//! and the posed human with its exact table.

mod support;

use intrinsym::mirror::curve_distance::curve_distances;
use intrinsym::mirror::faces::mirror_face_selection;
use intrinsym::mirror::frames::{Frames, carry_displacement};
use intrinsym::mirror::positions::symmetrize;
use intrinsym::mirror::{Merge, Mirroring, mirror_selection, mirror_values};
use intrinsym::{
    CancelToken, Coverage, EdgePoint, Mesh, PolygonMesh, Polyline, Progress, SurfacePoint, Symmetry,
    SymmetryKind,
};
use support::{Vector, creature, creature_truth, distance, dot, example, example_truth, rotated, validated};

/// The exact map of a mesh whose partners are known; sides by the sign of x.
fn exact_symmetry(polygons: &PolygonMesh, partners: &[u32]) -> Symmetry {
    let at =
        |&partner: &u32| Some(SurfacePoint { face: 0, vertices: [partner; 3], barycentric: [1.0, 0.0, 0.0] });
    let side = |(vertex, &partner): (usize, &u32)| match polygons.positions[vertex][0] {
        _ if vertex == partner as usize => 0,
        x => x.signum() as i8,
    };
    Symmetry {
        kind: SymmetryKind::Reflection,
        partner: partners.iter().map(|&partner| partner as i32).collect(),
        surface_point: partners.iter().map(at).collect(),
        confidence: vec![1.0; partners.len()],
        side: partners.iter().enumerate().map(side).collect(),
        fixed_curve: Vec::new(),
        score: -3.0,
        plausibility: 1.0,
        mean_confidence: 1.0,
        exact_share: 1.0,
        coverage: Coverage::default(),
    }
}

struct Lump {
    rest: PolygonMesh,
    mesh: Mesh,
    symmetry: Symmetry,
    partners: Vec<u32>,
}

fn lump() -> Lump {
    let rest = creature(4, 0.0);
    let partners = creature_truth(&rest);
    let symmetry = exact_symmetry(&rest, &partners);
    Lump { mesh: validated(&rest), symmetry, partners, rest }
}

/// The axis of the longest paired limb on the positive side, see `support::creature`.
const LIMB: Vector = [0.889, 0.400, 0.222];
/// How the limb is posed: rotated about this axis.
const POSE_AXIS: Vector = [0.3, -0.2, 1.0];
const POSE_ANGLE: f64 = 1.0;

/// How far along the positive limb a point is: 0 on the body, 1 where the limb moves as a rigid body.
fn along_limb(position: Vector) -> f64 {
    let t = ((dot(position, LIMB) - 1.1) / 0.5).clamp(0.0, 1.0);
    let near_axis = distance(position, LIMB.map(|x| x * dot(position, LIMB))) < 0.9;
    if near_axis { t * t * (3.0 - 2.0 * t) } else { 0.0 }
}

/// The lump with its positive limb turned.
fn posed(rest: &[Vector]) -> Vec<Vector> {
    let base = LIMB.map(|x| 1.1 * x);
    let pose = |&position: &Vector| {
        let lever = [0, 1, 2].map(|axis| position[axis] - base[axis]);
        let turned = rotated(lever, POSE_AXIS, POSE_ANGLE * along_limb(position));
        [0, 1, 2].map(|axis| base[axis] + turned[axis])
    };
    rest.iter().map(pose).collect()
}

fn mirrored([x, y, z]: Vector) -> Vector {
    [-x, y, z]
}

fn assert_near(found: Vector, expected: Vector, tolerance: f64, what: &str) {
    assert!(distance(found, expected) <= tolerance, "{what}: {found:?} instead of {expected:?}");
}

#[test]
fn a_selection_is_mirrored_and_back() {
    let Lump { rest, symmetry, partners, .. } = lump();
    let selected: Vec<bool> =
        rest.positions.iter().map(|position| distance(*position, LIMB.map(|x| 2.2 * x)) < 0.7).collect();
    let count = selected.iter().filter(|&&inside| inside).count();
    assert!(count > 10, "only {count} vertices selected");
    let found = mirror_selection(&symmetry, &selected, 0.5).unwrap();
    for (vertex, &partner) in partners.iter().enumerate() {
        assert_eq!(found[vertex], selected[partner as usize]);
    }
    assert_eq!(mirror_selection(&symmetry, &found, 0.5).unwrap(), selected);
}

#[test]
fn faces_go_to_their_mirrored_faces_and_leave_holes_open() {
    let Lump { rest, mesh, symmetry, partners } = lump();
    let faces: Vec<Vec<u32>> = rest.face_vertices.chunks_exact(3).map(<[u32]>::to_vec).collect();
    let near = |face: &Vec<u32>| {
        face.iter().any(|&vertex| distance(rest.positions[vertex as usize], LIMB.map(|x| 2.2 * x)) < 0.7)
    };
    let mut selected: Vec<bool> = faces.iter().map(near).collect();
    // A hole of one face: all its corners are corners of selected faces.
    let hole = selected.iter().position(|&inside| inside).unwrap();
    selected[hole] = false;
    let found = mirror_face_selection(&mesh, &rest, &symmetry, &selected, 0.5).unwrap();
    let corners = |vertices: Vec<u32>| vertices.into_iter().collect::<std::collections::BTreeSet<u32>>();
    let chosen: std::collections::BTreeSet<_> =
        (0..faces.len()).filter(|&face| found[face]).map(|face| corners(faces[face].clone())).collect();
    let expected: std::collections::BTreeSet<_> = (0..faces.len())
        .filter(|&face| selected[face])
        .map(|face| corners(faces[face].iter().map(|&vertex| partners[vertex as usize]).collect()))
        .collect();
    assert!(expected.len() > 10, "only {} faces selected", expected.len());
    assert_eq!(chosen, expected);
    assert_eq!(mirror_face_selection(&mesh, &rest, &symmetry, &found, 0.5).unwrap(), selected);
}

#[test]
fn faces_without_mirrored_faces_follow_their_vertices() {
    // Two triangles in a square, cut along the diagonal that the mirror image does not have.
    let polygons = support::rectangle(1, 1, [1.0, 1.0]);
    let mesh = validated(&polygons);
    let mut symmetry = exact_symmetry(&polygons, &[1, 0, 3, 2]);
    let all = vec![true; polygons.face_offsets.len() - 1];
    assert_eq!(mirror_face_selection(&mesh, &polygons, &symmetry, &all, 0.0).unwrap(), all);
    let mut one = vec![false; all.len()];
    one[0] = true;
    assert_eq!(
        mirror_face_selection(&mesh, &polygons, &symmetry, &one, 0.0).unwrap(),
        vec![false; all.len()]
    );
    symmetry.confidence[0] = 0.2;
    assert!(!mirror_face_selection(&mesh, &polygons, &symmetry, &all, 0.5).unwrap()[0]);
    assert!(mirror_face_selection(&mesh, &polygons, &symmetry, &all, 1.5).is_err());
}

#[test]
fn distances_from_a_straight_curve_on_a_plane_are_exact() {
    let polygons = support::rectangle(9, 8, [3.0, 2.0]);
    let mesh = validated(&polygons);
    let mut symmetry = exact_symmetry(&polygons, &(0..90).collect::<Vec<u32>>());
    let distances = |symmetry: &Symmetry| curve_distances(&mesh, symmetry, &polygons.positions);
    assert!(distances(&symmetry).iter().all(|distance| distance.is_infinite()));
    // The line x = 1.5 crosses the middle column of squares.
    let crossing = |row: u32| EdgePoint { from: 10 * row + 4, to: 10 * row + 5, t: 0.5 };
    symmetry.fixed_curve = vec![Polyline { points: (0..9).map(crossing).collect(), closed: false }];
    for (position, distance) in polygons.positions.iter().zip(distances(&symmetry)) {
        assert!((distance - (position[0] - 1.5).abs()).abs() < 1e-12, "{distance} at {position:?}");
    }
}

#[test]
fn distances_from_one_point_are_near_the_true_ones_and_never_shorter() {
    let polygons = support::rectangle(40, 40, [1.0, 1.0]);
    let mesh = validated(&polygons);
    let mut symmetry = exact_symmetry(&polygons, &(0..41 * 41).collect::<Vec<u32>>());
    let points = vec![EdgePoint { from: 0, to: 1, t: 0.0 }];
    symmetry.fixed_curve = vec![Polyline { points, closed: false }];
    let found = curve_distances(&mesh, &symmetry, &polygons.positions);
    for (position, distance) in polygons.positions.iter().zip(found) {
        let excess = distance - position[0].hypot(position[1]);
        assert!((-1e-12..0.03).contains(&excess), "{excess} too long at {position:?}");
    }
}

#[test]
fn a_lone_vertex_selects_its_partner_where_the_other_side_is_coarser() {
    // Vertex 0 on a fine side: the coarse side's vertex 3 lies at the middle of 1 and 2.
    let polygons = support::rectangle(1, 1, [1.0, 1.0]);
    let mut symmetry = exact_symmetry(&polygons, &[3, 3, 3, 1]);
    symmetry.surface_point[3] =
        Some(SurfacePoint { face: 0, vertices: [0, 1, 2], barycentric: [0.0, 0.6, 0.4] });
    let found = mirror_selection(&symmetry, &[true, false, false, false], 0.0).unwrap();
    assert_eq!(found, [false, false, false, true]);
    let found = mirror_selection(&symmetry, &[false, true, false, false], 0.0).unwrap();
    assert_eq!(found, [false, false, false, true]);
    symmetry.confidence[0] = 0.2;
    assert_eq!(mirror_selection(&symmetry, &[true, false, false, false], 0.5).unwrap(), [false; 4]);
    assert!(mirror_selection(&symmetry, &[false; 4], 1.5).is_err());
}

#[test]
fn the_winning_side_keeps_its_values_and_the_other_takes_them() {
    let Lump { rest, symmetry, partners, .. } = lump();
    let values: Vec<f64> = rest.positions.iter().flat_map(|&[x, y, z]| [x + 2.0 * y, z * x]).collect();
    for (merge, winner) in [(Merge::PositiveWins, 1), (Merge::NegativeWins, -1)] {
        let found = mirror_values(&symmetry, &values, 2, &Mirroring::whole(merge)).unwrap();
        for (vertex, &partner) in partners.iter().enumerate() {
            let source = if symmetry.side[vertex] == -winner { partner as usize } else { vertex };
            assert_eq!(found[2 * vertex..2 * vertex + 2], values[2 * source..2 * source + 2]);
        }
    }
}

#[test]
fn swap_exchanges_and_average_is_symmetric() {
    let Lump { rest, symmetry, partners, .. } = lump();
    let values: Vec<f64> = rest.positions.iter().map(|&[x, y, _]| x * x + 3.0 * x + y).collect();
    let swapped = mirror_values(&symmetry, &values, 1, &Mirroring::whole(Merge::Swap)).unwrap();
    let average = mirror_values(&symmetry, &values, 1, &Mirroring::whole(Merge::Average)).unwrap();
    for (vertex, &partner) in partners.iter().enumerate() {
        assert_eq!(swapped[vertex], values[partner as usize]);
        assert!((average[vertex] - 0.5 * (values[vertex] + values[partner as usize])).abs() < 1e-12);
    }
}

#[test]
fn confidence_decides_how_much_is_taken() {
    let Lump { rest, mut symmetry, partners, .. } = lump();
    let values: Vec<f64> = rest.positions.iter().map(|position| position[0]).collect();
    symmetry.confidence = (0..partners.len()).map(|vertex| [0.25, 0.5, 1.0][vertex % 3]).collect();
    let soft = Mirroring { merge: Merge::Swap, minimum_confidence: 0.5, weight_by_confidence: true };
    let found = mirror_values(&symmetry, &values, 1, &soft).unwrap();
    for (vertex, &partner) in partners.iter().enumerate() {
        let share = [0.0, 0.5, 1.0][vertex % 3];
        let expected = (1.0 - share) * values[vertex] + share * values[partner as usize];
        assert!((found[vertex] - expected).abs() < 1e-12);
    }
    symmetry.kind = SymmetryKind::HalfTurn;
    let wins = Mirroring::whole(Merge::PositiveWins);
    assert!(mirror_values(&symmetry, &values, 1, &wins).unwrap_err().to_string().contains("no sides"));
}

#[test]
fn frames_at_rest_are_the_mirror_itself() {
    let Lump { rest, mesh, symmetry, .. } = lump();
    for turn in Frames::new(&mesh, &symmetry, &rest.positions).turn {
        let columns = [0, 1, 2].map(|column| [0, 1, 2].map(|row: usize| turn[row][column]));
        assert_near(columns[0], [-1.0, 0.0, 0.0], 1e-9, "x");
        assert_near(columns[1], [0.0, 1.0, 0.0], 1e-9, "y");
        assert_near(columns[2], [0.0, 0.0, 1.0], 1e-9, "z");
    }
}

#[test]
fn small_shells_whose_map_is_noisy_turn_with_the_skin_beneath_them() {
    let (human, partners) = (example("human_shells"), example_truth("human_shells"));
    let (mesh, exact) = (validated(&human), exact_symmetry(&human, &partners));
    let shells = mesh.shells();
    let small = shells.iter().filter(|shell| shell.points.len() < 200).flat_map(|shell| &shell.points);
    let small: Vec<u32> = small.copied().collect();
    // Two of three points go where others do, a few numbers on.
    let mut noisy = partners.clone();
    for at in (0..small.len() - 3).filter(|at| at % 3 > 0) {
        noisy[small[at] as usize] = partners[small[at + 3] as usize];
    }
    let noisy = exact_symmetry(&human, &noisy);
    let turns = |symmetry| Frames::new(&mesh, symmetry, &human.positions).turn;
    let (wanted, found) = (turns(&exact), turns(&noisy));
    let off = |&point: &u32| {
        let (wanted, found) = (wanted[point as usize], found[point as usize]);
        wanted.iter().zip(found).map(|(&a, b)| distance(a, b).powi(2)).sum::<f64>().sqrt()
    };
    let mean = small.iter().map(off).sum::<f64>() / small.len() as f64;
    println!("{} points: off by {mean}", small.len());
    assert!(!small.is_empty() && mean < 0.4, "{} points are off by {mean}", small.len());
}

#[test]
fn a_displacement_is_carried_in_the_limb_s_own_frame() {
    let Lump { rest, mesh, symmetry, partners, .. } = lump();
    let pose = posed(&rest.positions);
    let push = |&[x, y, z]: &Vector| [0.1 * y, 0.05 + 0.1 * z, 0.1 * x];
    // What happens on the negative side, which is at rest.
    let field: Vec<Vector> = rest.positions.iter().map(push).collect();
    let to_positive = Mirroring::whole(Merge::NegativeWins);
    let found = carry_displacement(&mesh, &symmetry, &pose, &field, &to_positive).unwrap();
    let (mut errors, mut plain_errors) = (Vec::new(), 0.0);
    for (vertex, &partner) in partners.iter().enumerate() {
        if symmetry.side[vertex] < 1 {
            assert_eq!(found[vertex], field[vertex]);
        } else if along_limb(rest.positions[vertex]) == 1.0 {
            let plain = mirrored(field[partner as usize]);
            let expected = rotated(plain, POSE_AXIS, POSE_ANGLE);
            errors.push(distance(found[vertex], expected) / dot(expected, expected).sqrt());
            plain_errors += distance(plain, expected) / dot(expected, expected).sqrt();
        }
    }
    let count = errors.len() as f64;
    let (mean, plain) = (errors.iter().sum::<f64>() / count, plain_errors / count);
    let worst = errors.into_iter().fold(0.0, f64::max);
    println!("carried: {count} vertices, mean error {mean}, worst {worst}; by a plane {plain}");
    assert!(count > 20.0 && plain > 0.25, "the test's rigid part has {count} vertices");
    assert!(mean < 0.05 && worst < 0.2, "mean error {mean}, worst {worst} of the displacement");
}

#[test]
fn a_displacement_is_stretched_where_space_is_bent() {
    let Lump { rest, mesh, symmetry, partners, .. } = lump();
    let bent = |[x, y, z]: Vector| {
        let (sine, cosine) = (0.15 * y).sin_cos();
        [(x + 6.0) * cosine, (x + 6.0) * sine, z]
    };
    let push = |[x, y, z]: Vector| [x + 1e-4 * y.cos(), y + 1e-4 * (x + z).sin(), z + 1e-4 * x.cos()];
    let moved = |from: Vector, to: Vector| [0, 1, 2].map(|axis| bent(to)[axis] - bent(from)[axis]);
    let pose: Vec<Vector> = rest.positions.iter().map(|&place| bent(place)).collect();
    let field: Vec<Vector> = rest.positions.iter().map(|&place| moved(place, push(place))).collect();
    let found = carry_displacement(&mesh, &symmetry, &pose, &field, &Mirroring::whole(Merge::Swap)).unwrap();
    let (mut off, mut whole) = (0.0, 0.0);
    for (vertex, &partner) in partners.iter().enumerate() {
        let expected = moved(rest.positions[vertex], mirrored(push(rest.positions[partner as usize])));
        off += distance(found[vertex], expected).powi(2);
        whole += dot(expected, expected);
    }
    let error = f64::sqrt(off / whole);
    println!("bent: error {error}");
    assert!(error < 0.08, "{error} of the displacement");
}

#[test]
fn a_displacement_that_is_exchanged_twice_is_back() {
    let (human, partners) = (example("human"), example_truth("human"));
    let (mesh, symmetry) = (validated(&human), exact_symmetry(&human, &partners));
    let field: Vec<Vector> = human.positions.iter().map(|place| place.map(|x| (5.0 * x).cos())).collect();
    let swap = Mirroring::whole(Merge::Swap);
    let carry =
        |field: &[Vector]| carry_displacement(&mesh, &symmetry, &human.positions, field, &swap).unwrap();
    for (&found, &expected) in carry(&carry(&field)).iter().zip(&field) {
        assert_near(found, expected, 1e-6, "there and back");
    }
}

#[test]
fn what_is_symmetric_stays_in_any_pose() {
    let Lump { rest, mesh, symmetry, .. } = lump();
    let average = Mirroring::whole(Merge::Average);
    let quiet = Progress::default();
    let found = symmetrize(&mesh, &symmetry, &rest.positions, &average, &quiet).unwrap();
    for (&found, &expected) in found.iter().zip(&rest.positions) {
        assert_near(found, expected, 1e-9, "at rest");
    }
    let pose = posed(&rest.positions);
    let found = symmetrize(&mesh, &symmetry, &pose, &Mirroring::whole(Merge::NegativeWins), &quiet).unwrap();
    let moved: Vec<f64> = found.iter().zip(&pose).map(|(&found, &pose)| distance(found, pose)).collect();
    let mean = moved.iter().sum::<f64>() / moved.len() as f64;
    println!("posed: mean move {mean}, most {}", moved.iter().copied().fold(0.0, f64::max));
    assert!(mean < 0.02, "a mean of {mean} on a lump of radius 1");
}

/// The lump with a bump of height 0.2 and width 0.25, upwards near the end of a limb.
fn bumped(rest: &[Vector], limb: Vector) -> Vec<Vector> {
    let top = [2.1 * limb[0], 2.1 * limb[1], 2.1 * limb[2] + 0.3];
    let bump = |&[x, y, z]: &Vector| {
        let away = distance([x, y, z], top) / 0.25;
        [x, y, z + 0.2 * (-away * away).exp()]
    };
    rest.iter().map(bump).collect()
}

#[test]
fn a_bump_appears_on_the_other_limb() {
    let Lump { rest, mesh, symmetry, .. } = lump();
    let sculpted = bumped(&rest.positions, mirrored(LIMB));
    let expected = bumped(&sculpted, LIMB);
    let wins = Mirroring::whole(Merge::NegativeWins);
    let found = symmetrize(&mesh, &symmetry, &sculpted, &wins, &Progress::default()).unwrap();
    let (mut error, mut bump, mut most) = (0.0, 0.0, 0.0f64);
    for vertex in 0..found.len() {
        if symmetry.side[vertex] < 1 {
            assert_eq!(found[vertex], sculpted[vertex], "the winning side moved");
        }
        error += distance(found[vertex], expected[vertex]).powi(2);
        bump += distance(sculpted[vertex], expected[vertex]).powi(2);
        most = most.max(distance(sculpted[vertex], expected[vertex]));
    }
    println!("bump: error {} of {}, highest {most}", (error / bump).sqrt(), bump.sqrt());
    assert!(most > 0.1, "the test's bump is {most} high");
    assert!((error / bump).sqrt() < 0.6, "error {} of the bump", (error / bump).sqrt());
}

#[test]
fn symmetrizing_can_be_cancelled() {
    let Lump { rest, mesh, symmetry, .. } = lump();
    let token = CancelToken::default();
    token.cancel();
    let whole = Mirroring::whole(Merge::Average);
    let result = symmetrize(&mesh, &symmetry, &rest.positions, &whole, &Progress::new(None, token));
    assert!(matches!(result, Err(intrinsym::Error::Cancelled)));
}
