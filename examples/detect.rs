//! Intrinsym as a library: prints the mirror image of a few vertices of a mesh file.
//!
//! `cargo run --release --example detect examples/human.ply`

use intrinsym::{Limits, Mesh, Options, Progress, detect, io};
use std::path::Path;

fn main() -> intrinsym::Result<()> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "examples/human.ply".into());
    let limits = Limits::default();
    let file = io::read(Path::new(&path), &limits)?;
    let mesh = Mesh::new(&file.polygons, &limits)?;
    let detection = detect(&mesh, &Options::default(), &Progress::default())?;
    println!("{}", detection.report.evidence());
    let Some(symmetry) = detection.symmetries.first() else { return Ok(()) };
    for vertex in (0..symmetry.partner.len()).step_by(symmetry.partner.len().div_ceil(8)) {
        let (partner, confidence) = (symmetry.partner[vertex], symmetry.confidence[vertex]);
        println!("vertex {vertex} mirrors to vertex {partner}, confidence {confidence:.2}");
    }
    Ok(())
}
