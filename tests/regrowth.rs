//! Maps that grow again, on a posed body whose true map is known.

mod support;

use intrinsym::eigenbasis::Eigenbasis;
use intrinsym::full_refinement::{MatchTarget, VertexImages};
use intrinsym::laplacian::IntrinsicSurface;
use intrinsym::progress::{CancelToken, Progress};
use intrinsym::regrowth::regrow;
use intrinsym::rigid_parts::{PartsEffort, fit};
use intrinsym::surface_walk::SurfaceWalk;
use intrinsym::symmetry_kind::SymmetryKind::Reflection;
use support::*;

/// Angle by which the map turns a shin about the vertical.
const TURN: f64 = 1.0;

#[test]
fn a_shin_that_the_map_turns_about_its_axis_is_turned_back() {
    let (mesh, truth) = (example("human"), example_truth("human"));
    let shell = validated(&mesh).shells().swap_remove(0);
    let places = &shell.positions;
    let true_place = |vertex: u32| places[truth[vertex as usize] as usize];
    // One shin: what lies below the knee, nearer to its own sole than to the other's.
    let height = |vertex: &u32| places[*vertex as usize][2];
    let vertices = 0..places.len() as u32;
    let sole = vertices.clone().min_by(|a, b| height(a).total_cmp(&height(b))).unwrap();
    let is_of_shin = |vertex: &u32| {
        let to = |goal: Vector| distance(places[*vertex as usize], goal);
        height(vertex) < -0.5 && to(places[sole as usize]) < to(true_place(sole))
    };
    let shin: Vec<u32> = vertices.filter(is_of_shin).collect();
    let [x, y] =
        [0, 1].map(|axis| shin.iter().map(|&v| true_place(v)[axis]).sum::<f64>() / shin.len() as f64);
    let mut turned = VertexImages::at_vertices(&shell.triangles, truth.clone());
    let walk = SurfaceWalk::new(places, &shell.triangles);
    for &vertex in &shin {
        let place = true_place(vertex);
        let (dx, dy) = (place[0] - x, place[1] - y);
        let (sin, cos) = TURN.sin_cos();
        let goal = [x + cos * dx - sin * dy, y + sin * dx + cos * dy, place[2]];
        (turned.partners[vertex as usize], turned.points[vertex as usize]) =
            walk.nearest(goal, truth[vertex as usize]);
    }
    let off = |images: &VertexImages| {
        let place = |v: u32| images.points[v as usize].interpolate_vectors(&shell.triangles, places);
        shin.iter().map(|&v| distance(place(v), true_place(v))).sum::<f64>() / shin.len() as f64
    };

    let surface = IntrinsicSurface::with_mean_curvature(&shell);
    let basis = Eigenbasis::new(&surface, 150, 2, &Progress::default()).unwrap();
    let target = MatchTarget::new(&surface, &basis, 2);
    let token = CancelToken::default();
    let effort = PartsEffort::thorough().without_turned();
    let by_parts = fit(&shell, &surface, &turned, Reflection, &effort, 2, &token).unwrap().images;
    let (_, regrown) = regrow(&shell, &target, &by_parts, Reflection, &token).unwrap();
    let [before, by_parts, regrown] = [&turned, &by_parts, &regrown].map(off);
    assert!(shin.len() > 1000 && before > 0.03, "{} {before}", shin.len());
    assert!(regrown < 0.3 * by_parts && regrown < 0.003, "{before} {by_parts} {regrown}");
}
