//! Parts without a counterpart have no partner, and the map of the rest is right.

mod support;

use intrinsym::internals::base::effort::{Mechanisms, Plan};
use intrinsym::internals::detect::driver::detect_by;
use intrinsym::{CancelToken, Detection, Error, Options, Outcome, PolygonMesh, Progress, Reason, detect};
use std::cell::Cell;
use std::time::Duration;
use support::*;

/// The longest limb of [`creature`] on the side of positive x.
const LIMB: [f64; 3] = [0.89, 0.4, 0.22];
/// How far out along the limb it is drawn out to a rod: its tip is at 2.6.
const ROD: f64 = 1.8;

/// The answer with or without parts left out; no plane in space, since at rest nothing would be searched.
fn found(polygons: &PolygonMesh, excess: bool) -> Detection {
    let (mesh, options) = (validated(polygons), Options::default());
    let mechanisms = Mechanisms { mirror_plane: false, excess, ..Mechanisms::default() };
    let found = detect_by(&mesh, &options, &Plan::of(&options), mechanisms, &Progress::default()).unwrap();
    println!("{}", found.report.evidence());
    assert_keeps_its_contract(&mesh, &options, &found);
    found
}

/// Share of some vertices that have a partner, and the mean error of the others in sqrt(area).
fn judged(
    polygons: &PolygonMesh,
    found: &Detection,
    truth: &[u32],
    lacks: impl Fn(usize) -> bool,
) -> (f64, f64) {
    let partner = &found.symmetries[0].partner;
    let (without, with): (Vec<usize>, Vec<usize>) = (0..partner.len()).partition(|&v| lacks(v));
    let paired = without.iter().filter(|&&v| partner[v] >= 0).count() as f64 / without.len() as f64;
    let unit = validated(polygons).unit_length;
    let errors: Vec<f64> = with
        .iter()
        .filter(|&&v| partner[v] >= 0)
        .map(|&v| {
            distance(polygons.positions[partner[v] as usize], polygons.positions[truth[v] as usize]) / unit
        })
        .collect();
    assert!(errors.len() > with.len() * 9 / 10, "{} of {} are paired", errors.len(), with.len());
    (paired, errors.iter().sum::<f64>() / errors.len() as f64)
}

/// A creature the end of whose limb is drawn out to a rod, `1 + by` times as long as the end.
fn armed(whole: &PolygonMesh, by: f64) -> PolygonMesh {
    let mut armed = whole.clone();
    for position in &mut armed.positions {
        let beyond = dot(*position, LIMB) - ROD;
        if beyond > 0.0 {
            *position = std::array::from_fn(|axis| position[axis] + by * beyond * LIMB[axis]);
        }
    }
    armed
}

#[test]
fn what_sticks_out_of_a_hand_has_no_partner() {
    let whole = creature(5, 0.4);
    let truth = creature_truth(&whole);
    let armed = armed(&whole, 1.5);
    let lacks = |v: usize| dot(armed.positions[v], LIMB) > ROD + 1.2;
    let (with, without) = (found(&armed, true), found(&armed, false));
    assert_eq!(with.outcome, Outcome::Found);
    assert!(with.symmetries[0].plausibility > without.symmetries[0].plausibility);
    let (paired, error) = judged(&armed, &with, &truth, lacks);
    let (paired_before, _) = judged(&armed, &without, &truth, lacks);
    assert!(paired < 0.3 && paired_before > 0.9, "{paired_before} {paired}");
    assert!(error < 0.01, "{error}");
}

#[test]
fn a_limb_that_is_longer_than_its_twin_is_shortened_where_the_whole_has_no_map() {
    let whole = creature(5, 0.4);
    let truth = creature_truth(&whole);
    let armed = armed(&whole, 3.0);
    let lacks = |v: usize| dot(armed.positions[v], LIMB) > ROD + 2.4;
    assert_eq!(found(&armed, false).outcome, Outcome::None);
    let found = found(&armed, true);
    assert_eq!(found.outcome, Outcome::Found);
    let (paired, error) = judged(&armed, &found, &truth, lacks);
    assert!(paired == 0.0 && error < 0.01, "{paired} {error}");
}

/// What comes of a detection that a callback interrupts once, when parts without a counterpart are sought first; and how many reports follow.
fn interrupted(seconds: usize, interrupt: impl Fn(&CancelToken)) -> (intrinsym::Result<Detection>, usize) {
    let (mesh, token) = (validated(&armed(&creature(4, 0.4), 1.5)), CancelToken::default());
    let after = Cell::new(None);
    let callback = |stage: &str, _: f64| match after.get() {
        Some(count) => after.set(Some(count + 1)),
        None if stage == "parts without a counterpart" => {
            interrupt(&token);
            after.set(Some(0));
        }
        None => {}
    };
    let progress = Progress::new(Some(&callback), token.clone());
    let options = Options { time_limit: seconds, ..Options::default() };
    let result = detect(&mesh, &options, &progress);
    (result, after.get().expect("parts are sought"))
}

#[test]
fn a_cancel_and_the_end_of_time_stop_the_search_for_parts() {
    let (result, reports) = interrupted(0, CancelToken::cancel);
    assert!(matches!(result, Err(Error::Cancelled)) && reports == 0, "{result:?} {reports}");
    let (result, reports) = interrupted(8, |_| std::thread::sleep(Duration::from_secs(8)));
    let found = result.unwrap();
    assert!(found.report.reasons.contains(&Reason::TimeLimit) && found.outcome != Outcome::Found);
    assert_eq!(reports, 1, "the end alone is reported");
}

/// The posed human without the faces within `reach` of its vertex that is farthest along x, a fingertip.
fn without_a_hand(whole: &PolygonMesh, reach: f64) -> (PolygonMesh, u32) {
    let x = |vertex: &u32| whole.positions[*vertex as usize][0];
    let tip = (0..whole.positions.len() as u32).max_by(|a, b| x(a).total_cmp(&x(b))).unwrap();
    let is_near = |&v: &u32| distance(whole.positions[v as usize], whole.positions[tip as usize]) < reach;
    let face = |face: &[u32]| whole.face_vertices[face[0] as usize..face[1] as usize].to_vec();
    let faces = whole.face_offsets.windows(2).map(face).filter(|face| !face.iter().any(is_near));
    (polygon_mesh(&whole.positions, &faces.collect::<Vec<_>>()), tip)
}

#[test]
fn the_hand_whose_twin_is_cut_off_has_no_partner_where_the_rest_is_mirrored() {
    let (whole, truth) = (example("human"), example_truth("human"));
    let (cut, tip) = without_a_hand(&whole, 0.2);
    let other = whole.positions[truth[tip as usize] as usize];
    let lacks = |v: usize| distance(whole.positions[v], other) < 0.15;
    let found = found(&cut, true);
    let partner = &found.symmetries[0].partner;
    let of_hand: Vec<usize> = (0..partner.len()).filter(|&v| lacks(v)).collect();
    assert!(of_hand.len() > 1000 && of_hand.iter().all(|&v| partner[v] < 0));
    let paired: Vec<usize> = (0..partner.len()).filter(|&v| partner[v] >= 0).collect();
    let wrong = paired.iter().filter(|&&v| partner[v] as u32 != truth[v]);
    let off =
        wrong.map(|&v| distance(whole.positions[partner[v] as usize], whole.positions[truth[v] as usize]));
    let off: Vec<f64> = off.collect();
    println!("{} paired, off by {off:?}", paired.len());
    assert!(paired.len() > 10_000 && off.len() < 50 && off.iter().all(|&off| off < 0.05));
}

#[test]
fn a_whole_body_is_left_whole() {
    let whole = creature(4, 0.4);
    let (with, without) = (found(&whole, true), found(&whole, false));
    assert_eq!(with.symmetries[0].partner, without.symmetries[0].partner);
    assert_eq!(with.symmetries[0].coverage.shells_alone, 0);
}
