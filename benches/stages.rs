//! Times of whole detections and peak memory for one mesh, as JSON on standard output: cold, by threads, and again on the
//! same connectivity. Stages by themselves, with confidence intervals, are measured by `benches/by_stage`.
//!
//!     cargo bench --profile release --bench stages -- MESH [--repeats 5] [--eigenfunctions 150] [--threads 1]
//!         [--proxy-vertices 6000] [--write PREFIX]
//!
//! MESH is a file, or a number f: the creature of the tests on a geodesic sphere of `10 f^2 + 2` vertices, twisted, its left
//! and right triangulated differently. The first run is the process's first (cold). Then as many times `detect_again` on a
//! stretched mesh of the same connectivity: `again_stored` from symmetries alone, `again` from the detection. `--write` also leaves the mesh as
//! raw little-endian arrays for `compare.py`: PREFIX.positions (f64) and PREFIX.triangles (u32).
//! `make bench` runs all sizes, each in a process of its own, so that the peak is that size's.

#[path = "../tests/support/mod.rs"]
mod support;

use intrinsym::internals::base::effort::Plan;
use intrinsym::internals::base::limits::estimated_memory;
use intrinsym::{
    Detection, Limits, Mesh, Options, PolygonMesh, Previous, Progress, detect, detect_again, io,
};
use serde_json::{Value, json};
use std::path::Path;

struct Arguments {
    mesh: String,
    repeats: usize,
    eigenfunctions: usize,
    threads: usize,
    proxy_vertices: usize,
    write: Option<String>,
}

fn main() {
    let Some(arguments) = arguments() else { return };
    let polygons = polygon_mesh(&arguments.mesh);
    let mesh = Mesh::new(&polygons, &Limits::default()).expect("a usable mesh");
    if let Some(prefix) = &arguments.write {
        write_raw(&mesh, prefix);
    }
    let Arguments { eigenfunctions, threads, proxy_vertices, .. } = arguments;
    let options = Options { eigenfunctions, threads, proxy_vertices, ..Options::default() };
    let mut previous: Option<Detection> = None;
    let mut runs = Vec::new();
    for _ in 0..arguments.repeats {
        // Not part of the peak.
        drop(previous.take());
        let found = detect(&mesh, &options, &Progress::default()).expect("a detection");
        runs.push(numbers(&found));
        previous = Some(found);
    }
    let peak = peak_memory();
    let moved = Mesh::new(&stretched(polygons), &Limits::default()).expect("a usable mesh");
    let found = previous.expect("at least one run");
    // Symmetries alone, as of a map that was stored; then what the detection leaves as well.
    let stored = || run_again(&moved, found.symmetries.as_slice().into(), &options);
    let again_stored: Vec<Value> = (0..arguments.repeats).map(|_| stored()).collect();
    let again: Vec<Value> =
        (0..arguments.repeats).map(|_| run_again(&moved, (&found).into(), &options)).collect();
    let solved = runs.first().and_then(|run| run["solved_vertices"].as_u64()).unwrap_or_default() as usize;
    let report = json!({
        "mesh": arguments.mesh,
        "vertices": mesh.positions.len(),
        "triangles": mesh.triangles.len(),
        "eigenfunctions": arguments.eigenfunctions,
        "threads": arguments.threads,
        "peak_memory_bytes": peak,
        "estimated_memory_bytes": estimated_memory(mesh.positions.len(), solved, Plan::of(&options)[0].eigenfunctions),
        "runs": runs,
        "again_stored": again_stored,
        "again": again,
    });
    println!("{report}");
}

/// `None` if nothing is asked for: `cargo test --all-targets` calls a bench without arguments of ours.
fn arguments() -> Option<Arguments> {
    let Options { eigenfunctions, proxy_vertices, .. } = Options::default();
    let mut found = Arguments {
        mesh: String::new(),
        repeats: 5,
        eigenfunctions,
        threads: 1,
        proxy_vertices,
        write: None,
    };
    let mut rest = std::env::args().skip(1);
    while let Some(argument) = rest.next() {
        let mut value = || rest.next().unwrap_or_else(|| panic!("{argument} needs a value"));
        match argument.as_str() {
            "--bench" => {}
            "--repeats" => found.repeats = value().parse().expect("a number of repeats"),
            "--eigenfunctions" => found.eigenfunctions = value().parse().expect("a number of eigenfunctions"),
            "--threads" => found.threads = value().parse().expect("a number of threads"),
            "--proxy-vertices" => found.proxy_vertices = value().parse().expect("a number of vertices"),
            "--write" => found.write = Some(value()),
            other if other.starts_with("--") => return None,
            mesh => found.mesh = mesh.into(),
        }
    }
    (!found.mesh.is_empty()).then_some(found)
}

fn polygon_mesh(name: &str) -> PolygonMesh {
    match name.parse() {
        Ok(frequency) => support::twisted_creature(frequency),
        Err(_) => io::read(Path::new(name), &Limits::default()).expect("a readable mesh").polygons,
    }
}

/// A shape of the same connectivity, as after an edit.
fn stretched(mut polygons: PolygonMesh) -> PolygonMesh {
    polygons.positions.iter_mut().for_each(|position| position[1] *= 1.1);
    polygons
}

fn run_again(mesh: &Mesh, previous: Previous, options: &Options) -> Value {
    numbers(&detect_again(mesh, previous, options, &Progress::default()).expect("a detection"))
}

/// Wall seconds of each stage, and what was found.
fn numbers(found: &Detection) -> Value {
    json!({
        "seconds": found.report.seconds,
        "solved_vertices": found.report.solved_vertices,
        "plausibility": found.report.judged.map(|judged| judged.plausibility),
        "symmetries": found.symmetries.len(),
        "kept": found.report.kept,
    })
}

/// High-water mark of the resident set; `null` where the system does not say.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(1024 * line.split_whitespace().nth(1)?.parse::<u64>().ok()?)
}

fn write_raw(mesh: &Mesh, prefix: &str) {
    let positions: Vec<u8> = mesh.positions.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    let triangles: Vec<u8> = mesh.triangles.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    std::fs::write(format!("{prefix}.positions"), positions).expect("positions written");
    std::fs::write(format!("{prefix}.triangles"), triangles).expect("triangles written");
}
