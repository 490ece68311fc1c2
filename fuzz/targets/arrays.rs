//! Any arrays as a mesh; small ones are detected on.
#![no_main]

use intrinsym::{CancelToken, Options, PolygonMesh, Progress, detect};
use intrinsym_fuzz::validated;
use libfuzzer_sys::arbitrary::{self, Arbitrary};

/// Vertices on a coarse grid, so that coincidences happen, or anywhere; faces name them, or miss.
#[derive(Debug, Arbitrary)]
struct Arrays {
    grid: Vec<[i8; 3]>,
    anywhere: Vec<[f64; 3]>,
    faces: Vec<Vec<u8>>,
}

/// Largest mesh that is detected on: milliseconds.
const FEW: usize = 64;

libfuzzer_sys::fuzz_target!(|arrays: Arrays| {
    let grid = arrays.grid.iter().map(|place| place.map(f64::from));
    let mut polygons = PolygonMesh {
        positions: grid.chain(arrays.anywhere.iter().copied()).collect(),
        face_offsets: vec![0],
        face_vertices: Vec::new(),
    };
    for face in &arrays.faces {
        polygons.face_vertices.extend(face.iter().map(|&vertex| u32::from(vertex)));
        polygons.face_offsets.push(polygons.face_vertices.len() as u32);
    }
    let Some(mesh) = validated(&polygons) else { return };
    if mesh.positions.len() <= FEW && mesh.triangles.len() <= 2 * FEW {
        let options =
            Options { eigenfunctions: 12, samples: 100, beam_width: 1, network: false, ..Options::default() };
        let found = detect(&mesh, &options, &Progress::new(None, CancelToken::default())).expect("an answer");
        for symmetry in &found.symmetries {
            assert_eq!(symmetry.partner.len(), polygons.positions.len());
            assert!(symmetry.confidence.iter().all(|confidence| (0.0..=1.0).contains(confidence)));
        }
    }
});
