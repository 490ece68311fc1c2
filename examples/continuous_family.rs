//! The test for a continuous family of symmetries alone, for measuring it: `evaluation/continuous_family.py` runs this.
//!
//! `cargo run --release --example continuous_family MESH...` writes a line for each mesh: its path, the least gradient
//! of the signatures, the verdict, and the milliseconds of the test after the eigenfunctions.

use intrinsym::internals::spectral::continuous_family::orbits;
use intrinsym::internals::spectral::eigenbasis::Eigenbasis;
use intrinsym::internals::spectral::laplacian::IntrinsicSurface;
use intrinsym::{Limits, Mesh, Options, Progress, io};
use std::path::Path;
use std::time::Instant;

fn main() -> intrinsym::Result<()> {
    for path in std::env::args().skip(1) {
        let (limits, options) = (Limits::default(), Options::default());
        let mesh = Mesh::new(&io::read(Path::new(&path), &limits)?.polygons, &limits)?;
        let surface = IntrinsicSurface::new(&mesh.shells()[0]);
        let basis = Eigenbasis::new(&surface, options.eigenfunctions, 1, &Progress::default())?;
        let start = Instant::now();
        let found = orbits(&surface, &basis);
        let milliseconds = 1e3 * start.elapsed().as_secs_f64();
        let least = found.least_gradient.unwrap_or(f64::NAN);
        println!("{path} {least:.6} {} {milliseconds:.1}", found.continuous);
    }
    Ok(())
}
