//! Each stage of a detection by itself, by mesh size, with confidence intervals: criterion. One thread.
//!
//!     make bench-stages
//!     BENCH_FREQUENCIES="10 35" cargo bench --profile release --features criterion --bench by_stage -- eigenfunctions
//!
//! Frequencies f are those of the creature of the tests on geodesic spheres of `10 f^2 + 2` vertices, 10 and 35 by
//! default. A stage is called again and again on the same input, so that caches and allocator are warm; freeing its result
//! is not timed. Whole detections as a user meets them (the first in its process, two threads, the
//! same connectivity again, peak memory, peers) are measured by `benches/stages.rs` and `benches/compare.py`.

mod floors;
mod machine;
#[path = "../../tests/support/mod.rs"]
mod support;

use criterion::{BatchSize, BenchmarkId, Criterion, SamplingMode};
use floors::Floors;
use intrinsym::internals::base::effort::Plan;
use intrinsym::internals::connectivity::automorphism::{Connectivity, Reliance};
use intrinsym::internals::connectivity::mirrored_vertices;
use intrinsym::internals::detect::assembly::{PointMap, Summary, symmetry};
use intrinsym::internals::detect::fixed_curve::{odd_function, zero_set};
use intrinsym::internals::detect::proxy::Proxy;
use intrinsym::internals::detect::shell_symmetry::{PreparedShell, candidates, finish, signs};
use intrinsym::internals::geometry::vertex_map::VertexMap;
use intrinsym::internals::mesh::Shell;
use intrinsym::internals::mesh::half_edges::HalfEdges;
use intrinsym::internals::refine::full_refinement::MatchTarget;
use intrinsym::internals::refine::rigid_parts;
use intrinsym::internals::search::candidates::{Hints, Tried};
use intrinsym::internals::spectral::continuous_family::orbits;
use intrinsym::internals::spectral::displacement::mean_displacement;
use intrinsym::internals::spectral::eigenbasis::Eigenbasis;
use intrinsym::internals::spectral::laplacian::IntrinsicSurface;
use intrinsym::internals::spectral::sampling::Samples;
use intrinsym::internals::spectral::signature;
use intrinsym::internals::verify::confidence::Evidence;
use intrinsym::internals::verify::hypothesis::Hypothesis;
use intrinsym::{Limits, Mesh, Options, Progress, SymmetryKind, detect};
use std::time::Duration;

/// The size whose distance to the floor is counted.
const COUNTED: usize = 12_252;

fn main() {
    let settings = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(50))
        .measurement_time(Duration::from_millis(500))
        .nresamples(10_000);
    let mut criterion = settings.without_plots().configure_from_args();
    machine::measure(&mut criterion);
    let frequencies = std::env::var("BENCH_FREQUENCIES").unwrap_or("10 35".into());
    for frequency in frequencies.split_whitespace() {
        measure(&mut criterion, frequency.parse().expect("a frequency"));
    }
    criterion.final_summary();
}

/// Times stages on one mesh.
struct Timer<'a> {
    criterion: &'a mut Criterion,
    vertices: usize,
}

impl Timer<'_> {
    fn time<R>(&mut self, stage: &str, routine: impl Fn() -> R) {
        self.time_with(stage, || (), |()| routine());
    }

    /// Every call gets an input of its own, made by `setup`, which is not timed.
    fn time_with<I, R>(&mut self, stage: &str, setup: impl Fn() -> I, routine: impl Fn(I) -> R) {
        let mut group = self.criterion.benchmark_group(stage);
        group.sampling_mode(SamplingMode::Flat);
        group.bench_function(BenchmarkId::from_parameter(self.vertices), |bencher| {
            bencher.iter_batched(&setup, &routine, BatchSize::PerIteration);
        });
    }
}

fn measure(criterion: &mut Criterion, frequency: u32) {
    let (options, plan) = (Options { threads: 1, ..Options::default() }, Plan::small());
    let (limits, quiet) = (Limits::default(), Progress::default());
    let polygons = support::twisted_creature(frequency);
    let mut timer = Timer { criterion, vertices: polygons.positions.len() };
    timer.time("mesh", || Mesh::new(&polygons, &limits));
    let mesh = Mesh::new(&polygons, &limits).expect("a usable mesh");
    let connectivity = time_connectivity(&mut timer, &mesh);
    let shells = mesh.shells();
    let new_proxy = || Proxy::new(&shells[0], plan.proxy_vertices, options.threads);
    let proxy = new_proxy();
    if proxy.is_some() {
        timer.time("proxy", new_proxy);
    }
    let solved = proxy.as_ref().map_or(&shells[0], |proxy| &proxy.shell);
    let shell = time_eigenfunctions(&mut timer, solved, &plan);
    timer.time("match target", || MatchTarget::new(&shell.surface, &shell.basis, options.threads));
    let target = MatchTarget::new(&shell.surface, &shell.basis, options.threads);
    let found = time_search(&mut timer, &shell, &target, &plan, &options);
    let (surface, kind) = (&shell.surface, SymmetryKind::Reflection);
    let fit = || rigid_parts::fit(solved, surface, &found.images, kind, &plan.parts, options.threads, &quiet);
    timer.time("rigid parts", fit);
    let found = Hypothesis { images: fit().expect("images").images, ..found.clone() };
    timer.time("confidence", || Evidence::new(&target, &found).confidence());
    let confidence = Evidence::new(&target, &found).confidence();
    timer.time("sides", || odd_function(&shell.surface, &shell.basis, &found.images));
    let odd = odd_function(&shell.surface, &shell.basis, &found.images);
    let carry = |proxy: Option<&Proxy>| carried(&mesh, &shells[0], proxy, &found.images, &confidence, &odd);
    if proxy.is_some() {
        // A new one each time: it remembers where the vertices lie on it.
        timer.time_with("way back", new_proxy, |proxy| carry(proxy.as_ref()));
    }
    let map = carry(proxy.as_ref());
    timer.time("mirrored connectivity", || {
        connectivity.find(&map.partner, &map.confidence, Reliance::Shells, SymmetryKind::Reflection, &quiet)
    });
    let estimate = || mirrored_vertices::Estimate { partner: &map.partner, image: &map.image };
    let find = || {
        let kind = SymmetryKind::Reflection;
        mirrored_vertices::find(&mesh, estimate(), None, kind, options.threads, &quiet)
    };
    timer.time("mirrored vertices", find);
    timer.time("fixed curve", || zero_set(&mesh.triangles, &map.odd));
    let curve = zero_set(&mesh.triangles, &map.odd);
    let summary = || Summary {
        kind: SymmetryKind::Reflection,
        score: found.score.total(),
        plausibility: found.judged.plausibility,
    };
    timer.time_with("correspondence", || curve.clone(), |curve| symmetry(&mesh, &map, curve, summary()));
    timer.time("detect", || detect(&mesh, &options, &quiet));
    if timer.vertices == COUNTED {
        Floors::of(&polygons, &mesh, &shell, &found.images).write();
    }
}

/// All that needs no positions: half-edges, colours, and the search for a reflection without an estimate.
fn time_connectivity(timer: &mut Timer, mesh: &Mesh) -> Connectivity {
    let connect = || HalfEdges::new(mesh.positions.len(), &mesh.polygon_offsets, &mesh.polygon_points);
    timer.time("half-edges", connect);
    let half_edges = connect().expect("half-edges");
    timer.time_with("colours", || half_edges.clone(), |half_edges| Connectivity::new(half_edges, 0, |_| 0.0));
    let quiet = Progress::default();
    let fresh = || Connectivity::new(half_edges.clone(), 0, |_| 0.0);
    timer.time_with("lone reflection", fresh, |mut connectivity| {
        connectivity.find_unrivalled(|_| true, &quiet)
    });
    // The later search knows what this one found.
    let mut connectivity = fresh();
    connectivity.find_unrivalled(|_| true, &quiet).expect("a search");
    connectivity
}

/// From the shell that is solved to its samples.
fn time_eigenfunctions(timer: &mut Timer, solved: &Shell, plan: &Plan) -> PreparedShell {
    timer.time("Laplacian", || IntrinsicSurface::with_mean_curvature(solved));
    let surface = IntrinsicSurface::with_mean_curvature(solved);
    let quiet = Progress::default();
    let solve = || Eigenbasis::new(&surface, plan.eigenfunctions, 1, &quiet);
    timer.time("eigenfunctions", solve);
    let basis = solve().expect("eigenfunctions");
    timer.time("samples", || Samples::farthest(&basis, plan.samples));
    let samples = Samples::farthest(&basis, plan.samples);
    timer.time("continuous family", || orbits(&surface, &basis));
    PreparedShell::new(surface, basis, samples).unwrap()
}

/// From the signs to the map of all vertices of the shell that is solved, and its verdict.
fn time_search(
    timer: &mut Timer,
    shell: &PreparedShell,
    target: &MatchTarget,
    plan: &Plan,
    options: &Options,
) -> Hypothesis {
    let quiet = Progress::default();
    timer.time("sign network", || signs(&shell.surface, &shell.basis, options, &[]));
    let signs = signs(&shell.surface, &shell.basis, options, &[]).expect("signs");
    let hints = Hints { signs: &signs, twins: None };
    let search = || candidates(shell, &hints, &plan.search, options, &mut Tried::default(), &quiet);
    timer.time("candidates", search);
    let best = &search().expect("candidates")[0];
    timer.time("refinement", || finish(shell, target, best, plan, 0, &quiet));
    let found = finish(shell, target, best, plan, 0, &quiet).expect("a map");
    let (basis, mass) = (&shell.basis, &shell.surface.lumped_mass);
    timer.time("verdict", || {
        let mismatch = signature::mismatch(&shell.surface, basis, &found.images);
        (signature::mean(mass, mismatch.into_iter()), mean_displacement(basis, mass, &found.images.partners))
    });
    found
}

/// Images, confidence and odd function at the mesh's points: as they are, or carried back from the proxy.
fn carried(
    mesh: &Mesh,
    shell: &Shell,
    proxy: Option<&Proxy>,
    images: &VertexMap,
    confidence: &[f32],
    odd: &[f64],
) -> PointMap {
    let mut points = PointMap::empty(mesh);
    if let Some(proxy) = proxy {
        let confidence: Vec<f32> =
            proxy.carry_values(confidence).into_iter().map(|value| value as f32).collect();
        points.insert(shell, shell, &proxy.carry_images(images), &confidence);
        points.insert_odd(shell, &proxy.carry_odd(odd));
    } else {
        points.insert(shell, shell, images, confidence);
        points.insert_odd(shell, odd);
    }
    points
}
