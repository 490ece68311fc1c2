//! The detector on meshes that are hard for it: hubs, fans, combs, slivers, soups, put together and bent, of 1 to 5,000 vertices.
//!
//! What takes longer than `-timeout` fails the run (`run.sh`).
#![no_main]

use intrinsym::{CancelToken, Options, PolygonMesh, Progress, detect};
use intrinsym_fuzz::hostile::{Numbers, SHAPES};
use intrinsym_fuzz::validated;
use libfuzzer_sys::arbitrary::{self, Arbitrary};

/// Most vertices of all parts together.
const MOST: usize = 5000;

/// A part of a mesh.
#[derive(Debug, Arbitrary)]
struct Part {
    shape: u8,
    vertices: u16,
    /// Moves the part, in quarters of its size.
    shift: [i8; 3],
    /// Whether its first vertex is that of the part before it.
    joined: bool,
}

/// A mesh, and what is asked of it.
#[derive(Debug, Arbitrary)]
struct Case {
    parts: Vec<Part>,
    /// Every vertex is moved at random by up to 2^-n.
    noise: u8,
    seed: u64,
    symmetries: u8,
    effort: u8,
}

fn polygons(case: &Case) -> PolygonMesh {
    let mut all = PolygonMesh { face_offsets: vec![0], ..PolygonMesh::default() };
    for part in case.parts.iter().take(4) {
        let left = MOST.saturating_sub(all.positions.len());
        let wanted = usize::from(part.vertices) % (MOST + 1);
        if left < wanted || wanted == 0 {
            continue;
        }
        let added = SHAPES[part.shape as usize % SHAPES.len()].1(wanted);
        let first = all.positions.len() as u32;
        let corner = |&corner: &u32| if part.joined && corner == 0 { first.saturating_sub(1) } else { first + corner };
        all.face_vertices.extend(added.face_vertices.iter().map(corner));
        let start = all.face_offsets[all.face_offsets.len() - 1];
        all.face_offsets.extend(added.face_offsets[1..].iter().map(|offset| start + offset));
        let moved = |[x, y, z]: [f64; 3]| {
            let [dx, dy, dz] = part.shift.map(|shift| f64::from(shift) / 4.0);
            [x + dx, y + dy, z + dz]
        };
        all.positions.extend(added.positions.into_iter().map(moved));
    }
    let mut numbers = Numbers(case.seed);
    let size = if case.noise == 0 { 0.0 } else { 0.5f64.powi(i32::from(case.noise)) };
    all.positions.as_flattened_mut().iter_mut().for_each(|coordinate| *coordinate += size * numbers.next());
    all
}

libfuzzer_sys::fuzz_target!(|case: Case| {
    let polygons = polygons(&case);
    let Some(mesh) = validated(&polygons) else { return };
    let mut options = Options { symmetries: 1 + usize::from(case.symmetries % 4), ..Options::default() };
    options.set("effort", usize::from(case.effort % 2)).expect("fast or default");
    let found = detect(&mesh, &options, &Progress::new(None, CancelToken::default())).expect("an answer");
    for symmetry in &found.symmetries {
        assert_eq!(symmetry.partner.len(), polygons.positions.len());
        assert!(symmetry.confidence.iter().all(|confidence| (0.0..=1.0).contains(confidence)));
    }
});
