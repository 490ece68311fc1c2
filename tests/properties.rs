//! What must not change the map: numbering, face order, rigid motion, scale, mirroring of the input,
//! signs of eigenfunctions, threads. And T after T is near the identity.
//!
//! Rounding differs between two such inputs, so partners may differ where two vertices are about as near:
//! maps are compared by the distance along edges between the partners, in sqrt(area).

mod support;

use intrinsym::internals::base::effort::Plan;
use intrinsym::internals::detect::shell_symmetry;
use intrinsym::internals::detect::shell_symmetry::PreparedShell;
use intrinsym::internals::refine::full_refinement::MatchTarget;
use intrinsym::internals::search::candidates::{Candidate, Hints, Tried};
use intrinsym::internals::spectral::eigenbasis::Eigenbasis;
use intrinsym::internals::spectral::laplacian::IntrinsicSurface;
use intrinsym::internals::spectral::sampling::Samples;
use intrinsym::{Options, Outcome, PolygonMesh, Progress, detect};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::sync::LazyLock;
use support::*;

/// Few cases, the same in every run.
fn few(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(7), failure_persistence: None, ..Default::default() }
}

/// The best map of `mesh`, which must have one.
fn best_map(mesh: &PolygonMesh) -> Vec<u32> {
    let (mesh, options) = (validated(mesh), Options::default());
    let found = detect(&mesh, &options, &Progress::default()).unwrap();
    assert_keeps_its_contract(&mesh, &options, &found);
    assert_eq!(found.outcome, Outcome::Found, "{}", found.report.evidence());
    found.symmetries[0].partner.iter().map(|partner| *partner as u32).collect()
}

static SMALL_CREATURES_MAP: LazyLock<Vec<u32>> = LazyLock::new(|| best_map(&small_creature()));
static QUADRUPEDS_MAP: LazyLock<Vec<u32>> = LazyLock::new(|| best_map(&example("quadruped")));

/// Mean and largest distance between the two partners of each vertex.
fn apart(mesh: &PolygonMesh, first: &[u32], second: &[u32]) -> (f64, f64) {
    let roads = Roads::new(mesh);
    let distances: Vec<f64> = first.iter().zip(second).map(|(&a, &b)| roads.distance(a, b)).collect();
    let found =
        (distances.iter().sum::<f64>() / first.len() as f64, distances.into_iter().fold(0.0, f64::max));
    println!("mean {:.5}, largest {:.4}", found.0, found.1);
    found
}

/// A change of the input that the map must not follow.
#[derive(Debug, Clone)]
struct Change {
    shuffle: u64,
    axis: Vector,
    angle: f64,
    offset: Vector,
    scale: f64,
    mirrored: bool,
}

fn changes() -> impl Strategy<Value = Change> {
    let axis = [0.1..1.0f64, 0.1..1.0f64, 0.1..1.0f64];
    let offset = [-9.0..9.0f64, -9.0..9.0f64, -9.0..9.0f64];
    (any::<u64>(), axis, -3.0..3.0f64, offset, -6.0..6.0f64, any::<bool>()).prop_map(
        |(shuffle, axis, angle, offset, power, mirrored)| Change {
            shuffle,
            axis,
            angle,
            offset,
            scale: 10f64.powf(power),
            mirrored,
        },
    )
}

impl Change {
    const NONE: Change =
        Change { shuffle: 0, axis: [1.0; 3], angle: 0.0, offset: [0.0; 3], scale: 1.0, mirrored: false };

    /// The changed mesh and the new number of each vertex. A `shuffle` of 0 keeps the order.
    fn apply(&self, mesh: &PolygonMesh) -> (PolygonMesh, Vec<u32>) {
        let new_of_old = self.order(mesh.positions.len());
        let mut positions = vec![[0.0; 3]; new_of_old.len()];
        for (position, &new) in mesh.positions.iter().zip(&new_of_old) {
            positions[new as usize] = self.moved(*position);
        }
        let faces: Vec<Vec<u32>> = mesh
            .face_offsets
            .windows(2)
            .map(|ends| &mesh.face_vertices[ends[0] as usize..ends[1] as usize])
            .map(|corners| corners.iter().map(|corner| new_of_old[*corner as usize]).collect())
            .collect();
        let mut shuffled = faces.clone();
        for (face, new) in faces.into_iter().zip(self.order(shuffled.len())) {
            shuffled[new as usize] = face;
            let turn = new as usize % 3 * usize::from(self.shuffle != 0);
            shuffled[new as usize].rotate_left(turn);
        }
        (polygon_mesh(&positions, &shuffled), new_of_old)
    }

    fn moved(&self, position: Vector) -> Vector {
        let [x, y, z] = position;
        let turned = rotated([if self.mirrored { -x } else { x }, y, z], self.axis, self.angle);
        [0, 1, 2].map(|i| self.scale * (turned[i] + self.offset[i]))
    }

    /// A permutation by Fisher and Yates.
    fn order(&self, count: usize) -> Vec<u32> {
        let mut order: Vec<u32> = (0..count as u32).collect();
        let mut state = self.shuffle;
        for last in (1..count).rev().filter(|_| self.shuffle != 0) {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            order.swap(last, (state >> 33) as usize % (last + 1));
        }
        order
    }

    /// The map of the changed mesh, in the numbering of `mesh`.
    fn map_of_changed(&self, mesh: &PolygonMesh) -> Vec<u32> {
        let (changed, new_of_old) = self.apply(mesh);
        let mut old_of_new = new_of_old.clone();
        for (old, &new) in new_of_old.iter().enumerate() {
            old_of_new[new as usize] = old as u32;
        }
        let map = best_map(&changed);
        new_of_old.iter().map(|&new| old_of_new[map[new as usize] as usize]).collect()
    }
}

/// Its connectivity is not mirrored, so that the spectral map is all there is. (The sphere it is made of
/// has symmetries of its own, which must not be taken for the creature's.)
fn small_creature() -> PolygonMesh {
    creature(3, 0.4)
}

proptest! {
    #![proptest_config(few(4))]

    #[test]
    fn a_small_creature_keeps_its_map(change in changes()) {
        let mesh = small_creature();
        let (mean, largest) = apart(&mesh, &SMALL_CREATURES_MAP, &change.map_of_changed(&mesh));
        prop_assert!(mean < 0.002 && largest < 0.2, "{mean} {largest}");
    }

    #[test]
    fn a_mirrored_mesh_keeps_its_exact_map(change in changes()) {
        let mesh = creature(2, 0.0);
        let map = change.map_of_changed(&mesh);
        prop_assert_eq!(map, creature_truth(&mesh));
    }
}

proptest! {
    #![proptest_config(few(2))]

    #[test]
    fn the_quadruped_keeps_its_map(change in changes()) {
        let mesh = example("quadruped");
        let (mean, largest) = apart(&mesh, &QUADRUPEDS_MAP, &change.map_of_changed(&mesh));
        prop_assert!(mean < 0.002 && largest < 0.2, "{mean} {largest}");
    }
}

#[test]
fn tiny_and_huge_meshes_have_the_same_map() {
    let mesh = small_creature();
    let map = best_map(&mesh);
    for scale in [1e-6, 1e6, 0.5] {
        let (mean, largest) = apart(&mesh, &map, &Change { scale, ..Change::NONE }.map_of_changed(&mesh));
        assert!(mean < 0.002 && largest < 0.2, "{scale}: {mean} {largest}");
    }
}

#[test]
fn the_mirrored_mesh_has_the_same_map_whichever_way_its_faces_turn() {
    let mesh = small_creature();
    let map = best_map(&mesh);
    let mirrored = Change { mirrored: true, ..Change::NONE };
    let (mean, largest) = apart(&mesh, &map, &mirrored.map_of_changed(&mesh));
    assert!(mean < 0.002 && largest < 0.2, "{mean} {largest}");
    let mut inside_out = mesh.clone();
    inside_out.face_vertices.reverse();
    let (mean, largest) = apart(&mesh, &map, &best_map(&inside_out));
    assert!(mean < 0.002 && largest < 0.2, "{mean} {largest}");
}

#[test]
fn the_map_of_the_map_is_near_the_identity() {
    for mesh in [small_creature(), creature(4, 0.7), example("quadruped")] {
        let map = best_map(&mesh);
        let twice: Vec<u32> = map.iter().map(|partner| map[*partner as usize]).collect();
        let itself: Vec<u32> = (0..map.len() as u32).collect();
        let (mean, _) = apart(&mesh, &itself, &twice);
        assert!(mean < 0.02, "{mean}");
    }
}

#[test]
fn the_creatures_map_is_near_its_mirror_image_and_not_a_symmetry_of_the_sphere() {
    for (levels, turn) in [(3, 0.4), (4, 0.7)] {
        let mesh = creature(levels, turn);
        let (mean, largest) = apart(&mesh, &best_map(&mesh), &creature_truth(&mesh));
        assert!(mean < 0.015 && largest < 0.3, "{levels} {turn}: {mean} {largest}");
    }
}

#[test]
fn the_same_input_gives_the_same_bits_on_any_thread() {
    let mesh = validated(&small_creature());
    let run = || {
        let found = detect(&mesh, &Options::default(), &Progress::default()).unwrap();
        let best = &found.symmetries[0];
        let confidence: Vec<u32> = best.confidence.iter().map(|value| value.to_bits()).collect();
        let eigenvalues: Vec<u64> = found.report.eigenvalues.iter().map(|value| value.to_bits()).collect();
        (best.partner.clone(), confidence, best.side.clone(), best.score.to_bits(), eigenvalues)
    };
    let alone = run();
    std::thread::scope(|scope| {
        let threads = [scope.spawn(run), scope.spawn(run), scope.spawn(run)];
        assert!(threads.into_iter().all(|thread| thread.join().unwrap() == alone));
    });
}

/// The best candidate and the final partners with the eigenfunctions of `shell` multiplied by `signs`.
fn with_signs(shell: &mut PreparedShell, signs: &[bool]) -> (Candidate, Vec<u32>) {
    let functions = &mut shell.basis.eigenfunctions;
    for (column, _) in signs.iter().enumerate().filter(|(_, flipped)| **flipped) {
        functions.col_as_slice_mut(column).iter_mut().for_each(|value| *value = -*value);
    }
    let samples = Samples::at(&shell.basis, shell.sampled().to_vec());
    let shell = &PreparedShell::new(shell.surface.clone(), shell.basis.clone(), samples).unwrap();
    let (options, plan, progress) = (Options::default(), Plan::small(), Progress::default());
    let predicted = shell_symmetry::signs(&shell.surface, &shell.basis, &options, &[]).unwrap();
    let best = shell_symmetry::candidates(
        shell,
        &Hints { signs: &predicted, twins: None },
        &plan.search,
        &options,
        &mut Tried::default(),
        &progress,
    )
    .unwrap()
    .swap_remove(0);
    let target = MatchTarget::new(&shell.surface, &shell.basis, 1);
    let partners =
        shell_symmetry::finish(shell, &target, &best, &plan, 0, &progress).unwrap().images.partners;
    (best, partners)
}

fn prepared(mesh: &PolygonMesh) -> PreparedShell {
    let surface = IntrinsicSurface::with_mean_curvature(&validated(mesh).shells()[0]);
    let plan = Plan::small();
    let basis = Eigenbasis::new(&surface, plan.eigenfunctions, 1, &Progress::default()).unwrap();
    let samples = Samples::farthest(&basis, plan.samples);
    PreparedShell::new(surface, basis, samples).unwrap()
}

proptest! {
    #![proptest_config(few(4))]

    #[test]
    fn flipped_signs_of_eigenfunctions_leave_the_map(signs in prop::collection::vec(any::<bool>(), 50)) {
        let mut shell = prepared(&small_creature());
        let (plain, partners) = with_signs(&mut shell, &[]);
        let (flipped, flipped_partners) = with_signs(&mut shell, &signs);
        prop_assert!((plain.score.total() - flipped.score.total()).abs() < 1e-3);
        prop_assert_eq!(plain.partners, flipped.partners);
        let differ = partners.iter().zip(&flipped_partners).filter(|(a, b)| a != b).count();
        prop_assert!(differ * 200 <= partners.len(), "{} of {} differ", differ, partners.len());
    }
}
