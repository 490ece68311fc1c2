//! `detect` on the example meshes, whose truth is known, and on meshes with little to detect.

mod support;

use intrinsym::internals::base::effort::Plan;
use intrinsym::internals::base::limits::estimated_memory;
use intrinsym::{
    CancelToken, Detection, Effort, Error, Mesh, NONE, OPTIONS, Options, Outcome, PolygonMesh, Progress,
    Reason, SymmetryKind, detect, detect_again,
};
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::time::{Duration, Instant};
use support::*;

fn detected(mesh: &Mesh, options: &Options) -> Detection {
    let detection = detect(mesh, options, &Progress::default()).unwrap();
    println!("{:?}: {}", detection.outcome, detection.report.evidence());
    for symmetry in &detection.symmetries {
        println!(
            "  {:?} score {:.3}, confidence {:.3}, exact {:.3}, curves {:?}",
            symmetry.kind,
            symmetry.score,
            symmetry.mean_confidence,
            symmetry.exact_share,
            symmetry.fixed_curve.iter().map(|curve| (curve.points.len(), curve.closed)).collect::<Vec<_>>()
        );
    }
    assert_keeps_its_contract(mesh, options, &detection);
    detection
}

fn wrong_partners(partner: &[i32], truth: &[u32]) -> usize {
    partner.iter().zip(truth).filter(|(found, truth)| **found != **truth as i32).count()
}

#[test]
fn the_human_is_mapped_exactly() {
    let found = detected(&validated(&example("human")), &Options::default());
    assert_eq!(found.outcome, Outcome::Found);
    let best = &found.symmetries[0];
    assert!(best.exact_share > 0.999, "{}", best.exact_share);
    assert_eq!(wrong_partners(&best.partner, &example_truth("human")), 0);
    assert!(best.mean_confidence > 0.99, "{}", best.mean_confidence);
}

#[test]
fn the_humans_fixed_curve_is_one_loop_through_its_fixed_vertices_and_parts_its_sides() {
    let polygons = example("human");
    let truth = example_truth("human");
    let best = detected(&validated(&polygons), &Options::default()).symmetries.swap_remove(0);
    let [curve] = &best.fixed_curve[..] else { panic!("{} curves", best.fixed_curve.len()) };
    assert!(curve.closed);
    assert!(curve.points.iter().all(|point| point.from == point.to), "it runs through vertices");
    let met: BTreeSet<u32> = curve.points.iter().map(|point| point.from).collect();
    let fixed: BTreeSet<u32> = (0..truth.len() as u32).filter(|v| truth[*v as usize] == *v).collect();
    assert_eq!((met, curve.points.len()), (fixed.clone(), fixed.len()));
    for (vertex, &partner) in truth.iter().enumerate() {
        assert_eq!(best.side[partner as usize], -best.side[vertex], "{vertex} and its partner {partner}");
        assert_eq!(best.side[vertex] == 0, partner as usize == vertex, "side of {vertex}");
    }
    for corners in polygons.face_offsets.windows(2) {
        let corners = &polygons.face_vertices[corners[0] as usize..corners[1] as usize];
        let sides: BTreeSet<i8> = corners.iter().map(|corner| best.side[*corner as usize]).collect();
        assert!(!(sides.contains(&1) && sides.contains(&-1)), "no face of this mesh lies on both sides");
    }
}

#[test]
fn the_human_without_mirrored_connectivity_is_near_the_truth() {
    let quads = example("human");
    let mesh = with_random_diagonals(&quads);
    let validated_mesh = validated(&mesh);
    let found = detected(&validated_mesh, &Options::default());
    let best = &found.symmetries[0];
    assert_eq!(best.exact_share, 0.0);
    let (mean, far) = errors(&mesh, &best.partner, &example_truth("human"));
    // Measured: 0.0019 and 0.0014; 0.024 and 0.083 without pairing vertices.
    assert!(mean < 0.006 && far < 0.01, "{mean} {far}");
    let exact = best.partner.iter().zip(&example_truth("human")).filter(|(a, b)| **a == **b as i32).count();
    println!("  {exact} of {} have their true partners", best.partner.len());
    assert!(exact * 10 > best.partner.len() * 8);
    let [curve] = &best.fixed_curve[..] else { panic!("{} curves", best.fixed_curve.len()) };
    assert!(curve.closed);
    let sides = true_sides(&quads, &example_truth("human"));
    let agreement: i32 = sides.iter().zip(&best.side).map(|(a, b)| i32::from(a * b)).sum();
    let fixed: Vec<Vector> =
        (0..sides.len()).filter(|v| sides[*v] == 0).map(|v| quads.positions[v]).collect();
    let mut wrong = 0;
    for (vertex, position) in quads.positions.iter().enumerate() {
        if i32::from(sides[vertex] * best.side[vertex]) * agreement.signum() < 0 {
            wrong += 1;
            let away = fixed.iter().map(|at| distance(*at, *position)).fold(f64::MAX, f64::min);
            let away = away / validated_mesh.unit_length;
            assert!(away < 0.05, "{vertex} is on the wrong side, {away} sqrt(area) from the true curve");
        }
    }
    println!("  {wrong} of {} vertices on the wrong side", sides.len());
    // Measured: 0 or 1; 3.4 to 4.1 % without pairing vertices.
    assert!(wrong * 200 < sides.len(), "{wrong} vertices on the wrong side");
}

/// +1 and -1 on the two parts into which the fixed vertices divide the mesh, 0 on them.
fn true_sides(mesh: &PolygonMesh, truth: &[u32]) -> Vec<i8> {
    let fixed = |vertex: u32| truth[vertex as usize] == vertex;
    let mut sides: Vec<i8> =
        (0..truth.len() as u32).map(|vertex| if fixed(vertex) { 0 } else { -1 }).collect();
    let first = sides.iter().position(|side| *side == -1).unwrap();
    sides[first] = 1;
    let mut grows = true;
    while grows {
        grows = false;
        for ends in mesh.face_offsets.windows(2) {
            let corners = &mesh.face_vertices[ends[0] as usize..ends[1] as usize];
            if corners.iter().any(|corner| sides[*corner as usize] == 1) {
                for corner in corners.iter().filter(|corner| !fixed(**corner)) {
                    grows |= sides[*corner as usize] == -1;
                    sides[*corner as usize] = 1;
                }
            }
        }
    }
    assert!(truth.iter().zip(&sides).all(|(partner, side)| sides[*partner as usize] == -side));
    sides
}

#[test]
fn most_vertices_find_their_true_partners_where_edges_are_flipped() {
    let truth = example_truth("human");
    // Measured: 0.90, 0.92 and 0.65; 0.52, 0.49 and 0.43 if pairs must keep all edges close.
    for (every, least) in [(5, 0.8), (4, 0.8), (3, 0.55)] {
        let polygons = with_flipped_edges(&with_random_diagonals(&example("human")), every);
        let found = detected(&validated(&polygons), &Options::default());
        let partners = found.symmetries[0].partner.iter().map(|&partner| partner as u32);
        let right = partners.zip(&truth).filter(|(partner, truth)| partner == *truth).count();
        let share = right as f64 / truth.len() as f64;
        println!("one of {every}: {share}");
        assert!(share > least, "{every} {share}");
    }
}

#[test]
fn the_quadruped_is_near_the_truth() {
    let mesh = example("quadruped");
    let found = detected(&validated(&mesh), &Options::default());
    assert_eq!(found.outcome, Outcome::Found);
    let (mean, far) = errors(&mesh, &found.symmetries[0].partner, &example_truth("quadruped"));
    // Measured: 0.022 and 0.084; an edge is about 0.02 long, and the truth is known to an edge.
    assert!(mean < 0.03 && far < 0.1, "{mean} {far}");
}

#[test]
fn every_shell_of_the_human_maps_to_one_shell_and_back() {
    let polygons = example("human_shells");
    let mesh = validated(&polygons);
    assert_eq!(mesh.shell_count, 10);
    let best = detected(&mesh, &Options::default()).symmetries.swap_remove(0);
    let shell_of = |vertex: u32| mesh.shell_of_point[mesh.point_of_vertex[vertex as usize] as usize];
    let shells_met = |partners: &dyn Fn(u32) -> u32| -> Vec<BTreeSet<u32>> {
        let mut met = vec![BTreeSet::new(); 10];
        for vertex in
            (0..polygons.positions.len() as u32).filter(|v| mesh.point_of_vertex[*v as usize] != NONE)
        {
            met[shell_of(vertex) as usize].insert(shell_of(partners(vertex)));
        }
        met
    };
    assert!(best.partner.iter().all(|partner| *partner >= 0));
    let truth = example_truth("human_shells");
    let found = shells_met(&|vertex| best.partner[vertex as usize] as u32);
    assert_eq!(found, shells_met(&|vertex| truth[vertex as usize]));
    assert!(found.iter().all(|met| met.len() == 1));
    let partner: Vec<u32> = found.iter().map(|met| *met.first().unwrap()).collect();
    assert!((0..10).all(|shell| partner[partner[shell] as usize] as usize == shell));
    println!("{} vertices are not exact", wrong_partners(&best.partner, &truth));
    let (mean, far) = errors(&polygons, &best.partner, &truth);
    assert!(mean < 0.005 && far < 0.02, "{mean} {far}");
}

#[test]
fn an_eye_whose_twin_is_missing_is_no_image_of_itself() {
    let polygons = example("human_shells");
    let (mesh, truth) = (validated(&polygons), example_truth("human_shells"));
    let shell_of = |vertex: u32| mesh.shell_of_point[mesh.point_of_vertex[vertex as usize] as usize];
    // Eyes are the largest shells that go to another one.
    let eye = (0..truth.len() as u32)
        .filter(|&v| shell_of(v) != shell_of(truth[v as usize]))
        .map(shell_of)
        .min()
        .unwrap();
    let faces = polygons
        .face_offsets
        .windows(2)
        .map(|ends| &polygons.face_vertices[ends[0] as usize..ends[1] as usize]);
    let kept: Vec<Vec<u32>> = faces.filter(|face| shell_of(face[0]) != eye).map(<[u32]>::to_vec).collect();
    let found = detect(
        &validated(&polygon_mesh(&polygons.positions, &kept)),
        &Options::default(),
        &Progress::default(),
    );
    let partner = &found.unwrap().symmetries[0].partner;
    let other: Vec<usize> = (0..truth.len()).filter(|&v| shell_of(truth[v]) == eye).collect();
    assert!(other.len() > 50 && other.iter().all(|&v| partner[v] < 0));
    let wrong =
        (0..truth.len()).filter(|&v| shell_of(v as u32) == 0 && partner[v] as u32 != truth[v]).count();
    assert_eq!(wrong, 0, "the body");
}

#[test]
fn small_shells_go_with_the_surface_that_they_sit_on() {
    // Nothing is mirrored exactly: other diagonals left and right, and every vertex off by up to a twentieth of an edge.
    let mut polygons = with_random_diagonals(&example("human_shells"));
    let mut state = 1u32;
    let mut noise = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        0.0014 * (f64::from(state >> 8) / f64::from(1 << 24) - 0.5)
    };
    for position in &mut polygons.positions {
        *position = position.map(|x| x + noise());
    }
    let mesh = validated(&polygons);
    let best = detected(&mesh, &Options::default()).symmetries.swap_remove(0);
    let truth = example_truth("human_shells");
    let body = mesh.shell_of_point[mesh.shells()[0].points[0] as usize];
    let small = |vertex: &usize| mesh.shell_of_point[mesh.point_of_vertex[*vertex] as usize] != body;
    let off = |vertex: usize| {
        let [partner, truth] = [best.partner[vertex] as u32, truth[vertex]];
        distance(polygons.positions[partner as usize], polygons.positions[truth as usize]) / mesh.unit_length
    };
    let errors: Vec<f64> = (0..truth.len()).filter(small).map(off).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    // Measured: 0.0003; an eye is 0.03 across.
    assert!(errors.len() == 756 && mean < 0.002, "{mean} of {}", errors.len());
}

#[test]
fn every_shell_of_the_human_is_mapped_exactly() {
    let mesh = validated(&example("human_shells"));
    let best = detected(&mesh, &Options::default()).symmetries.swap_remove(0);
    assert_eq!(wrong_partners(&best.partner, &example_truth("human_shells")), 0);
}

#[test]
#[ignore = "the antipodal map leaves no point in place, yet a curve is drawn where its odd function jumps"]
fn a_map_without_fixed_points_has_no_fixed_curve() {
    let polygons = icosphere(3);
    let best = detected(&validated(&polygons), &Options::default()).symmetries.swap_remove(0);
    let moved =
        |(from, to): (usize, &i32)| distance(polygons.positions[from], polygons.positions[*to as usize]);
    let least = best.partner.iter().enumerate().map(moved).fold(f64::MAX, f64::min);
    assert!(least < 0.5 || best.fixed_curve.is_empty(), "every vertex moves by {least} radii or more");
}

/// The human, bent beyond isometry.
fn bent_human() -> PolygonMesh {
    let mut polygons = example("human");
    for position in &mut polygons.positions {
        let [x, y, z] = *position;
        *position = [(1.0 + 0.9 * x) * x + 1.5 * z, y + 0.8 * x * x, z * (1.0 + 0.8 * x)];
    }
    polygons
}

#[test]
fn connectivity_that_is_mirrored_but_for_defects_answers_there_too() {
    let whole = bent_human();
    let mut polygons = PolygonMesh { positions: whole.positions.clone(), ..PolygonMesh::default() };
    polygons.face_offsets = vec![0];
    for (face, ends) in whole.face_offsets.windows(2).enumerate() {
        let corners = &whole.face_vertices[ends[0] as usize..ends[1] as usize];
        let cut = face % 1700 == 900 && corners.len() == 4;
        let pieces =
            if cut { vec![vec![0, 1, 2], vec![0, 2, 3]] } else { vec![(0..corners.len()).collect()] };
        for piece in pieces {
            polygons.face_vertices.extend(piece.iter().map(|&corner| corners[corner]));
            polygons.face_offsets.push(polygons.face_vertices.len() as u32);
        }
    }
    assert!(polygons.face_offsets.len() > whole.face_offsets.len() + 5);
    let found = detected(&validated(&polygons), &Options::default());
    println!("{}", found.report.evidence());
    let [symmetry] = &found.symmetries[..] else { panic!("{} symmetries", found.symmetries.len()) };
    let truth = example_truth("human");
    let wrong = symmetry.partner.iter().zip(&truth).filter(|&(&partner, &truth)| partner != truth as i32);
    assert_eq!(wrong.count(), 0);
    assert_eq!(symmetry.exact_share, 0.0);
    assert!(symmetry.mean_confidence > 0.95, "{}", symmetry.mean_confidence);
    let evidence = &found.report.evidence();
    assert!(
        evidence.contains("but for a few defects its connectivity admits one reflection, and that"),
        "{evidence}"
    );
}

#[test]
fn connectivity_that_admits_one_reflection_answers_where_the_shape_is_bent_beyond_isometry() {
    let found = detected(&validated(&bent_human()), &Options::default());
    println!("{}", found.report.evidence());
    let [symmetry] = &found.symmetries[..] else { panic!("{} symmetries", found.symmetries.len()) };
    let truth = example_truth("human");
    assert!(symmetry.partner.iter().zip(&truth).all(|(&partner, &truth)| partner == truth as i32));
    assert_eq!((symmetry.exact_share, symmetry.mean_confidence), (1.0, 1.0));
    assert!(found.report.judged.is_none_or(|judged| !judged.accepted(50)), "the spectral map would do");
    assert!(
        found.report.evidence().contains("connectivity admits one reflection, and that is the answer"),
        "{}",
        found.report.evidence()
    );
}

#[test]
fn a_shape_whose_connectivity_admits_one_plausible_reflection_is_not_searched() {
    let searched = |name, known_signs: &[i8]| {
        let options = Options { known_signs: known_signs.to_vec(), ..Options::default() };
        let found = detected(&validated(&example(name)), &options);
        found.report.seconds.iter().any(|(stage, _)| stage == "candidates")
    };
    assert!(!searched("human", &[]) && !searched("human", &[0, 0]));
    assert!(searched("human", &[0, 1]), "a person's signs ask for the symmetry that has them");
    assert!(
        searched("quadruped", &[[0; 39].as_slice(), &[1]].concat()),
        "more signs than candidates have functions"
    );
    assert!(searched("quadruped", &[]));
}

#[test]
fn connectivity_that_admits_several_reflections_is_no_evidence_against_the_shape() {
    let mut polygons = icosphere(3);
    for position in &mut polygons.positions {
        let [x, y, z] = *position;
        let lump = |centre: Vector, height: f64, width: f64| {
            height * (-support::distance(*position, centre).powi(2) / width).exp()
        };
        let radius = 1.0
            + lump([0.9, 0.1, 0.4], 1.6, 0.05)
            + lump([-0.3, 0.9, 0.3], 1.1, 0.09)
            + lump([0.1, -0.5, -0.85], 2.0, 0.04)
            + lump([-0.6, -0.6, 0.5], 0.7, 0.02)
            + lump([-0.7, 0.2, -0.7], 1.4, 0.12);
        *position = [radius * x, radius * y, radius * z];
    }
    let found = detected(&validated(&polygons), &Options::default());
    assert!(
        found.symmetries.iter().all(|symmetry| symmetry.exact_share == 0.0),
        "{}",
        found.report.evidence()
    );
}

#[test]
fn small_shells_keep_their_sides_beside_a_body_whose_vertices_are_mirrored() {
    let quads = example("human_shells");
    let mesh = validated(&quads);
    let [exact, cut] = [&quads, &with_random_diagonals(&quads)]
        .map(|polygons| detected(&validated(polygons), &Options::default()).symmetries.swap_remove(0).side);
    let product = |vertex: usize| i32::from(exact[vertex] * cut[vertex]);
    let sign = (0..exact.len()).map(product).sum::<i32>().signum();
    let shell = |vertex: usize| mesh.shell_of_point[mesh.point_of_vertex[vertex] as usize];
    let largest = mesh.shells()[0].points[0];
    let small = (0..exact.len()).filter(|&vertex| shell(vertex) != mesh.shell_of_point[largest as usize]);
    let (mut agree, mut all) = (0, 0);
    for vertex in small.filter(|&vertex| product(vertex) != 0) {
        (agree, all) = (agree + i32::from(product(vertex) == sign), all + 1);
    }
    println!("{agree} of {all} agree");
    assert!(all > 300 && agree * 10 > all * 9, "{agree} of {all}");
}

#[test]
fn a_map_that_mirrors_vertices_needs_half_the_plausibility() {
    let certain = Options { plausibility: 100, ..Options::default() };
    let outcome = |mesh: &PolygonMesh| {
        let found = detected(&validated(mesh), &certain);
        assert!(found.report.judged.is_some_and(|judged| judged.accepted(50) && !judged.accepted(100)));
        (found.outcome, found.report.evidence().contains("mirror images near it, and that is the answer"))
    };
    assert_eq!(outcome(&with_random_diagonals(&example("human"))), (Outcome::Found, true));
    assert_eq!(outcome(&example("quadruped")), (Outcome::Doubtful, false));
}

#[test]
fn the_blob_is_not_found_to_have_a_symmetry() {
    let found = detected(&validated(&example("blob")), &Options::default());
    assert_ne!(found.outcome, Outcome::Found);
    assert!(found.symmetries.iter().all(|symmetry| symmetry.plausibility < 0.5), "at most as doubtful");
    assert!(found.report.judged.is_some_and(|judged| !judged.accepted(50)), "{:?}", found.report.judged);
    assert!(found.report.evidence().contains("(accepted from 50 %)"), "{}", found.report.evidence());
    let unchecked =
        detected(&validated(&example("blob")), &Options { plausibility: 0, ..Options::default() });
    assert_eq!(unchecked.symmetries.len(), 1, "the best map is given to who asks for it");
}

#[test]
fn half_turns_whose_parts_do_not_move_are_no_symmetries() {
    let found = detected(&validated(&example("blob")), &Options { symmetries: 8, ..Options::default() });
    let listed: Vec<_> =
        found.symmetries.iter().map(|symmetry| (symmetry.kind, symmetry.mean_confidence)).collect();
    // The best map may be given as doubtful, which is a reflection.
    assert!(
        listed.iter().all(|(kind, _)| *kind == SymmetryKind::Reflection) && listed.len() < 2,
        "{listed:?}"
    );
}

#[test]
fn maps_that_connectivity_makes_one_symmetry_of_are_listed_once() {
    let found = detected(&validated(&example("human")), &Options { symmetries: 8, ..Options::default() });
    let exact: Vec<_> = found.symmetries.iter().filter(|symmetry| symmetry.exact_share == 1.0).collect();
    assert_eq!(exact.len(), 1, "of {}", found.symmetries.len());
}

#[test]
fn the_fixed_curve_of_a_creature_lies_in_its_mirror_plane() {
    for turn in [0.0, 0.4] {
        let polygons = creature(4, turn);
        let mesh = validated(&polygons);
        let best = detected(&mesh, &Options::default()).symmetries.swap_remove(0);
        assert_eq!(best.fixed_curve.len(), 1, "turn {turn}");
        assert!(best.fixed_curve[0].closed);
        let x = |vertex: u32| polygons.positions[vertex as usize][0] / mesh.unit_length;
        for point in &best.fixed_curve[0].points {
            let at = x(point.from) + f64::from(point.t) * (x(point.to) - x(point.from));
            assert!(at.abs() < 0.05, "turn {turn}: {at} sqrt(area) from the mirror plane");
        }
        let vertices = 0..polygons.positions.len() as u32;
        let sign = vertices.clone().map(|v| f64::from(best.side[v as usize]) * x(v)).sum::<f64>().signum();
        for vertex in vertices.filter(|v| x(*v).abs() > 0.05) {
            let side = best.side[vertex as usize];
            assert_eq!(f64::from(side), sign * x(vertex).signum(), "turn {turn}: side of {vertex}");
            assert_eq!(best.side[best.partner[vertex as usize] as usize], -side, "turn {turn}: {vertex}");
        }
    }
}

#[test]
fn small_and_degenerate_meshes_are_answered() {
    let tetrahedron = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let corner = |i: usize| [(i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64];
    let cube: Vec<Vector> = (0..8).map(corner).collect();
    let cube_faces = [[0u32, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut needles = rectangle(3, 40, [1e-4, 1.0]);
    needles.positions[7] = needles.positions[3];
    let meshes = [
        ("tetrahedron", polygon_mesh(&tetrahedron, &[[0u32, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])),
        ("cube", polygon_mesh(&cube, &cube_faces)),
        ("triangle", polygon_mesh(&tetrahedron[..3], &[[0u32, 1, 2]])),
        ("quad", polygon_mesh(&cube[..4], &[[0u32, 1, 3, 2]])),
        ("two triangles apart", polygon_mesh(&cube[..6], &[[0u32, 1, 2], [3, 4, 5]])),
        ("small grid", rectangle(3, 3, [1.0, 1.0])),
        ("grid", rectangle(20, 33, [1.0, 1.3])),
        ("needles", needles),
        ("small sphere", icosphere(1)),
        ("sphere", icosphere(3)),
        ("small creature", creature(1, 0.4)),
    ];
    for (name, mesh) in meshes {
        println!("{name}");
        detected(&validated(&mesh), &Options { symmetries: 4, ..Options::default() });
    }
}

#[test]
fn progress_rises_from_0_to_1_and_names_its_stages() {
    let calls = RefCell::new(Vec::new());
    let callback = |stage: &str, fraction: f64| calls.borrow_mut().push((stage.to_string(), fraction));
    let progress = Progress::new(Some(&callback), CancelToken::default());
    let mesh = validated(&creature(3, 0.4));
    detect(&mesh, &Options::default(), &progress).unwrap();
    let calls = calls.into_inner();
    assert_eq!(calls[0].1, 0.0);
    assert_eq!(calls.last().unwrap().1, 1.0);
    assert!(calls.is_sorted_by(|a, b| a.1 <= b.1), "{calls:?}");
    assert!(calls.iter().all(|(stage, _)| !stage.is_empty()));
    let stages: BTreeSet<&String> = calls.iter().map(|(stage, _)| stage).collect();
    assert!(stages.len() >= 4, "{stages:?}");
    for long in ["refining", "rigid parts", "all vertices", "mirrored vertices"] {
        assert!(stages.contains(&long.to_string()), "{long}: {stages:?}");
    }
}

#[test]
fn long_walks_over_the_connectivity_report_on_the_way() {
    let walks = Cell::new(0);
    let callback = |stage: &str, _: f64| walks.set(walks.get() + usize::from(stage == "connectivity"));
    let progress = Progress::new(Some(&callback), CancelToken::default());
    // It has 60 reflections: each of two searches walks all over it for many of them.
    detect(&validated(&icosphere(3)), &Options::default(), &progress).unwrap();
    assert!(walks.get() > 2, "{}", walks.get());
}

#[test]
fn refinement_and_rigid_parts_report_on_the_way() {
    let (refining, parts) = (Cell::new(0), Cell::new(0));
    let callback = |stage: &str, _: f64| match stage {
        "refining" => refining.set(refining.get() + 1),
        "rigid parts" => parts.set(parts.get() + 1),
        _ => (),
    };
    let progress = Progress::new(Some(&callback), CancelToken::default());
    let options = Options { effort: Effort::Fast, ..Options::default() };
    detect(&validated(&creature(3, 0.4)), &options, &progress).unwrap();
    // Each size of the schedule, and each 32 discs.
    assert!(refining.get() >= 8 && parts.get() >= 16, "{} {}", refining.get(), parts.get());
}

#[test]
fn cancelling_at_any_report_stops_the_call_there() {
    let mesh = validated(&creature(3, 0.4));
    let cancelled_at = |last: usize| {
        let (token, count) = (CancelToken::default(), Cell::new(0));
        let callback = |_: &str, _: f64| {
            count.set(count.get() + 1);
            if count.get() == last {
                token.cancel();
            }
        };
        let progress = Progress::new(Some(&callback), token.clone());
        (detect(&mesh, &Options::default(), &progress), count.get())
    };
    let (complete, reports) = cancelled_at(usize::MAX);
    assert!(complete.is_ok() && reports > 10);
    for last in [1, 2, 3, reports / 3, reports / 2, reports - 2, reports - 1] {
        let (result, count) = cancelled_at(last);
        assert!(matches!(result, Err(Error::Cancelled)), "report {last} of {reports}: {result:?}");
        assert_eq!(count, last, "no report follows the cancellation");
    }
    let token = CancelToken::default();
    token.cancel();
    let result = detect(&mesh, &Options::default(), &Progress::new(None, token));
    assert!(matches!(result, Err(Error::Cancelled)));
}

/// What comes of a detection of the blob that waits at the `last` start of a search for candidates until its time is over.
fn out_of_time_at(last: usize, time_limit: usize, plausibility: usize) -> intrinsym::Result<Detection> {
    let (start, count) = (Instant::now(), Cell::new(0));
    let callback = |stage: &str, _: f64| {
        count.set(count.get() + usize::from(stage == "candidates"));
        let left = Duration::from_secs(time_limit as u64).saturating_sub(start.elapsed());
        if count.get() == last {
            std::thread::sleep(left + Duration::from_millis(10));
        }
    };
    let progress = Progress::new(Some(&callback), CancelToken::default());
    let options = Options { time_limit, plausibility, ..Options::default() };
    detect(&validated(&example("blob")), &options, &progress)
}

#[test]
fn time_that_ends_before_any_answer_is_an_error_that_names_the_stage() {
    let error = out_of_time_at(1, 1, 0).unwrap_err();
    assert!(matches!(error, Error::TimeLimit { stage: "candidates" | "refining" }), "{error}");
}

#[test]
fn time_that_ends_in_a_larger_plan_leaves_the_answer_of_the_smaller_one() {
    let found = out_of_time_at(2, 5, 0).unwrap();
    assert_eq!((found.outcome, found.symmetries.len()), (Outcome::Doubtful, 1));
    assert_eq!(found.report.reasons.iter().filter(|reason| **reason == Reason::TimeLimit).count(), 1);
    assert!(found.report.judged.is_some());
}

#[test]
fn time_that_ends_where_a_smaller_plan_found_nothing_is_no_answer() {
    let found = out_of_time_at(2, 5, 50);
    assert!(
        matches!(found, Err(Error::TimeLimit { stage: "candidates" })),
        "{:?}",
        found.map(|it| it.outcome)
    );
}

#[test]
fn options_outside_their_range_are_refused() {
    let mesh = validated(&icosphere(1));
    // The effort and a yes or no are types of their own, which have no other values.
    let is_count = |name: &str| name != "effort" && name != "network";
    for (index, spec) in OPTIONS.iter().enumerate().filter(|(_, spec)| is_count(spec.name)) {
        let with = |value: usize| {
            let mut values = OPTIONS.map(|spec| spec.default);
            values[index] = value;
            let [
                _,
                symmetries,
                plausibility,
                threads,
                memory,
                time_limit,
                _,
                eigenfunctions,
                samples,
                beam_width,
                proxy_vertices,
            ] = values;
            Options {
                eigenfunctions,
                samples,
                symmetries,
                beam_width,
                plausibility,
                proxy_vertices,
                memory,
                threads,
                time_limit,
                ..Options::default()
            }
        };
        for value in [spec.minimum, spec.default, spec.maximum] {
            assert!(with(value).validate().is_ok(), "{} {value}", spec.name);
        }
        let below = spec.minimum.checked_sub(1).filter(|&below| below != spec.default);
        for value in [spec.maximum + 1, usize::MAX].into_iter().chain(below) {
            let error = detect(&mesh, &with(value), &Progress::default()).unwrap_err();
            assert!(matches!(error, Error::Option { name, .. } if name == spec.name), "{value}: {error}");
            let range = format!("{}..={}", spec.minimum, spec.maximum);
            assert!(error.to_string().contains(&range), "{error}");
        }
    }
}

#[test]
fn a_mesh_that_needs_more_memory_than_allowed_is_refused() {
    let mesh = validated(&example("quadruped"));
    let with = |memory| detect(&mesh, &Options { memory, ..Options::default() }, &Progress::default());
    let points = mesh.positions.len();
    let needed = estimated_memory(points, points, Plan::small().eigenfunctions).div_ceil(1_000_000);
    match with(needed as usize - 1).unwrap_err() {
        Error::Limit { found, limit, .. } => assert_eq!((found, limit), (needed, needed - 1)),
        other => panic!("{other}"),
    }
    assert_eq!(with(needed as usize).unwrap().outcome, Outcome::Found);
    // Connectivity answers, and nothing is solved.
    let human = validated(&example("human"));
    let with = |memory| detect(&human, &Options { memory, ..Options::default() }, &Progress::default());
    assert!(matches!(with(1).unwrap_err(), Error::Limit { limit: 1, .. }));
    assert_eq!(with(100).unwrap().report.solved_vertices, 0);
}

#[test]
fn the_answer_does_not_depend_on_the_threads() {
    let mesh = validated(&example("quadruped"));
    let with =
        |threads| detected(&mesh, &Options { threads, plausibility: 0, ..Options::default() }).symmetries;
    let (one, three) = (with(1), with(3));
    assert!(!one.is_empty());
    assert_eq!(format!("{one:?}"), format!("{three:?}"));
}

#[test]
fn no_more_symmetries_are_returned_than_asked_for() {
    let mesh = validated(&icosphere(3));
    for symmetries in [1, 3] {
        let found = detected(&mesh, &Options { symmetries, ..Options::default() });
        assert!((1..=symmetries).contains(&found.symmetries.len()), "{}", found.symmetries.len());
    }
}

#[test]
fn a_square_has_four_reflections_and_a_half_turn_and_no_more_are_listed() {
    let mesh = validated(&rectangle(24, 24, [1.0, 1.0]));
    let options = Options { symmetries: 16, ..Options::default() };
    let found = detect(&mesh, &options, &Progress::default()).unwrap();
    let kinds: Vec<SymmetryKind> = found.symmetries.iter().map(|symmetry| symmetry.kind).collect();
    let mut expected = vec![SymmetryKind::Reflection; 4];
    expected.push(SymmetryKind::HalfTurn);
    assert_eq!(kinds, expected);
}

#[test]
fn all_nineteen_involutions_of_a_cube_are_listed_and_no_more() {
    let cube = with_random_diagonals(&cube_of_squares(14));
    let options = Options { symmetries: 32, eigenfunctions: 50, ..Options::default() };
    let found = detect(&validated(&cube), &options, &Progress::default()).unwrap().symmetries;
    let count = |kind| found.iter().filter(|symmetry| symmetry.kind == kind).count();
    assert_eq!((count(SymmetryKind::Reflection), count(SymmetryKind::HalfTurn)), (10, 9));
    let group = cube_group();
    let mut listed = BTreeSet::new();
    for symmetry in &found {
        let error = |matrix: &[Vector; 3]| {
            let away = |(&partner, &position): (&i32, &Vector)| {
                distance(cube.positions[partner as usize], matrix.map(|row| dot(row, position)))
            };
            let pairs = symmetry.partner.iter().zip(&cube.positions);
            pairs.map(away).sum::<f64>() / cube.positions.len() as f64
        };
        let errors: Vec<f64> = group.iter().map(error).collect();
        let nearest = (0..group.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap();
        assert!(errors[nearest] < 0.14, "{} beside edges of 0.14", errors[nearest]);
        assert!(listed.insert(nearest), "one is listed twice");
    }
}

/// The 48 matrices that send each axis to an axis.
fn cube_group() -> Vec<[Vector; 3]> {
    let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let signed = |(order, signs): ([usize; 3], usize)| {
        [0, 1, 2].map(|row| {
            let sign = if signs >> row & 1 == 1 { -1.0 } else { 1.0 };
            std::array::from_fn(|column| if order[row] == column { sign } else { 0.0 })
        })
    };
    orders.into_iter().flat_map(|order| (0..8).map(move |signs| (order, signs))).map(signed).collect()
}

/// A bent plate of two sheets whose meshes are the same, its outline mirrored in x, its mesh not.
fn plate() -> PolygonMesh {
    let (columns, rows) = (24, 18);
    let sheet = with_random_diagonals(&PolygonMesh {
        face_offsets: (0..=(columns * rows) as u32).map(|face| 4 * face).collect(),
        face_vertices: (0..rows)
            .flat_map(|j| (0..columns).map(move |i| (i, j)))
            .flat_map(|(i, j)| [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)])
            .map(|(i, j)| (j * (columns + 1) + i) as u32)
            .collect(),
        ..rectangle(columns, rows, [2.0, 1.5])
    });
    let (count, thickness) = (sheet.positions.len() as u32, 0.03);
    let outline = |&[x, y, _]: &Vector| [(x - 1.0) * (0.6 + 0.4 * y), y + 0.3 * (x - 1.0).powi(2)];
    // Rolled about an oblique axis.
    let bent = |[x, y]: [f64; 2], z: f64| {
        let (along, across) = (0.8 * x + 0.6 * y, 0.8 * y - 0.6 * x);
        [(1.0 - z) * along.sin(), across, 1.0 - (1.0 - z) * along.cos()]
    };
    let front = sheet.positions.iter().map(|place| bent(outline(place), 0.0));
    let back = sheet.positions.iter().map(|place| bent(outline(place), thickness));
    let positions: Vec<Vector> = front.chain(back).collect();
    let mut faces: Vec<Vec<u32>> = sheet.face_vertices.chunks(3).map(<[u32]>::to_vec).collect();
    let edges: BTreeSet<(u32, u32)> =
        faces.iter().flat_map(|f| [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])]).collect();
    faces.extend(sheet.face_vertices.chunks(3).map(|f| vec![f[2] + count, f[1] + count, f[0] + count]));
    for &(a, b) in edges.iter().filter(|(a, b)| !edges.contains(&(*b, *a))) {
        faces.extend([vec![b, a, a + count], vec![b, a + count, b + count]]);
    }
    polygon_mesh(&positions, &faces)
}

#[test]
fn a_thin_plate_is_mirrored_in_its_outline_before_its_sheets_are_exchanged() {
    let (polygons, columns) = (plate(), 24);
    let count = polygons.positions.len() / 2;
    let options = Options { symmetries: 2, ..Options::default() };
    let exchanges = |partner: &[i32]| {
        let other_sheet = |v: usize| (v + count) % (2 * count);
        (0..2 * count).filter(|&v| partner[v] as usize == other_sheet(v)).count() as f64 / (2 * count) as f64
    };
    // Vertices of a row are in order, and so are rows: the partner of the k-th is the k-th from the end.
    let truth: Vec<u32> = (0..2 * count as u32)
        .map(|v| {
            v - v % count as u32 + {
                let (row, k) = (v % count as u32 / (columns + 1), v % count as u32 % (columns + 1));
                row * (columns + 1) + columns - k
            }
        })
        .collect();
    for options in [Options::default(), options] {
        let found = detected(&validated(&polygons), &options);
        assert_eq!(found.outcome, Outcome::Found);
        let (mean, _) = errors(&polygons, &found.symmetries[0].partner, &truth);
        assert!(mean < 0.03, "{mean}");
        if let Some(second) = found.symmetries.get(1) {
            assert_eq!(second.kind, SymmetryKind::Reflection);
            assert!(exchanges(&second.partner) > 0.8, "{}", exchanges(&second.partner));
        }
        assert_eq!(
            found.symmetries.iter().filter(|s| s.kind == SymmetryKind::Reflection).count(),
            options.symmetries
        );
        let again = detect_again(&validated(&polygons), &found, &options, &Progress::default()).unwrap();
        let partners = |found: &Detection| -> Vec<Vec<i32>> {
            found.symmetries.iter().map(|symmetry| symmetry.partner.clone()).collect()
        };
        assert!(again.report.kept && partners(&again) == partners(&found));
    }
}

#[test]
fn what_is_thin_but_for_its_handlebars_is_mirrored_across_itself() {
    // A thin scalene triangle, and a bar that crosses it: columns of three and of four corners, from one side to the other.
    let outline = [[0.0, 0.0], [3.0, 0.3], [1.0, 2.0]];
    let bar = [[1.3, 0.7], [1.4, 0.7], [1.4, 0.8], [1.3, 0.8]];
    let half = |corners: &[[f64; 2]], depth: f64| -> Vec<Vector> {
        [-depth, depth].iter().flat_map(|&z| corners.iter().map(move |&[x, y]| [x, y, z])).collect()
    };
    let positions = [half(&outline, 0.025), half(&bar, 0.4)].concat();
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for (first, count) in [(0, 3), (6, 4)] {
        faces.push((0..count).rev().map(|k| first + k).collect());
        faces.push((0..count).map(|k| first + count + k).collect());
        let next = |k: u32| (k + 1) % count;
        faces.extend(
            (0..count).map(|k| [k, next(k), count + next(k), count + k].iter().map(|k| first + k).collect()),
        );
    }
    let found = detected(&validated(&polygon_mesh(&positions, &faces)), &Options::default());
    assert!(matches!(found.report.reasons[..], [Reason::MirrorPlane { .. }]));
    assert_eq!(found.symmetries[0].partner, [3, 4, 5, 0, 1, 2, 10, 11, 12, 13, 6, 7, 8, 9]);
}

/// Flat tongs, whose arms a pose bends by different angles; a rim on the front of both keeps the plane between front and back from mirroring all.
#[test]
fn flat_tongs_go_arm_to_arm_and_not_front_to_back() {
    let mut tongs = geodesic_sphere(16);
    for at in &mut tongs.positions {
        let [along, across, up] = *at;
        let arm = (5.0 * (along.abs() - 0.5)).tanh();
        let rim = if up > 0.0 { 0.03 * (-((along.abs() - 0.55) / 0.28).powi(2)).exp() } else { 0.0 };
        let wave = 0.3 * (7.0 * along + 1.0).sin();
        let [across, up] = [(0.2 - 0.06 * arm) * across * (1.0 + wave), 0.12 * up + rim * up];
        let angle: f64 = if along > 0.0 { 1.2 * along } else { 0.7 * along };
        let radius = if along > 0.0 { 1.2 / 1.2 } else { 1.2 / 0.7 };
        *at = [(radius - across) * angle.sin(), radius - (radius - across) * angle.cos(), up];
    }
    let truth = {
        let own = geodesic_sphere(16).positions;
        let image = |at: &Vector| {
            let apart = |other: &&Vector| distance([-at[0], at[1], at[2]], **other);
            own.iter().enumerate().min_by(|a, b| apart(&a.1).total_cmp(&apart(&b.1))).expect("one").0 as u32
        };
        own.iter().map(image).collect::<Vec<u32>>()
    };
    let mesh = validated(&tongs);
    let found = detected(&mesh, &Options::default());
    let best = &found.symmetries[0];
    let off = |(own, &partner): (usize, &i32)| {
        distance(tongs.positions[partner as usize], tongs.positions[truth[own] as usize])
    };
    let mean = best.partner.iter().enumerate().map(off).sum::<f64>() / truth.len() as f64;
    assert!(mean < 0.05, "{mean}");
}
