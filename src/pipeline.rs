//! `detect`: the only caller of all stages.

use crate::acceptance::Judgement;
use crate::assembler::Assembler;
use crate::automorphism::{Automorphism, Connectivity};
use crate::candidates::GAP;
use crate::continuous_family::{Orbits, orbits};
use crate::correspondence::Symmetry;
use crate::eigenbasis::{Accuracy, Eigenbasis};
use crate::error::Result;
use crate::filled_holes::FilledShell;
use crate::finishing::finish_best;
use crate::judging_mesh::JudgingMesh;
use crate::laplacian::IntrinsicSurface;
use crate::limits::{check_memory, estimated_memory};
use crate::mesh::half_edges::HalfEdges;
use crate::mesh::{Mesh, NONE, RepairReport};
use crate::options::Options;
use crate::progress::{CancelToken, Progress};
use crate::proxy::Proxy;
use crate::rotations;
use crate::sampling::Samples;
use crate::shell_symmetry::{PreparedShell, ShellSymmetry, candidates, of_images, signs};
use crate::sign_network::SignPrediction;
use crate::stated_signs;
use crate::symmetry_kind::SymmetryKind;
use crate::threads;
use std::sync::Arc;
use std::time::Instant;

/// A reflection that the connectivity alone admits and that is as plausible as this, in percent, needs no search.
const CERTAIN: usize = 90;

/// Said of a shell that has one.
const FAMILY: &str = "; the shape has a continuous family of symmetries, as a sphere or a vase has";

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// At least one symmetry.
    Found,
    /// No map came near to a symmetry; the report holds the evidence.
    None,
}

/// Numbers behind the outcome.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Report {
    /// Vertices of the caller's mesh.
    pub vertices: usize,
    /// Faces of the caller's mesh.
    pub faces: usize,
    /// Shells (connected components).
    pub shells: usize,
    /// Small holes of the largest shell that were filled for the search; nothing of them is in the result.
    pub filled_holes: usize,
    /// Vertices on which the map was sought: those of the largest shell and of what fills its holes, or of its proxy.
    pub solved_vertices: usize,
    /// What was repaired.
    pub repairs: RepairReport,
    /// Eigenvalues of the largest shell, its holes filled, scaled to unit area, the constant function's zero left out.
    pub eigenvalues: Vec<f64>,
    /// Parity of the first eigenfunctions of the largest shell, its holes filled, or its proxy as the sign network sees it, overruled by what the caller
    /// states; empty without both.
    pub signs: Vec<SignPrediction>,
    /// How the best finished map was judged, accepted or not; `None` if no candidate reverses orientation.
    pub judged: Option<Judgement>,
    /// Whether the largest shell has infinitely many symmetries, as a sphere, a torus or a vase has: the one given is
    /// then an arbitrary one of them.
    pub continuous_family: bool,
    /// What that is judged by: 0 for such a shell, large for others (`docs/method.md`); `None` if it cannot be oriented.
    pub least_signature_gradient: Option<f64>,
    /// Whether the symmetries are those of an earlier shape, kept by [`crate::detect_again`].
    pub kept: bool,
    /// One sentence that says why the outcome is what it is.
    pub evidence: String,
    /// Seconds of wall time by stage, in order.
    pub seconds: Vec<(String, f64)>,
}

impl Report {
    /// Of a mesh on which nothing was sought yet.
    pub fn of(mesh: &Mesh) -> Report {
        Report {
            vertices: mesh.point_of_vertex.len(),
            faces: mesh.face_count,
            shells: mesh.shell_count,
            filled_holes: 0,
            solved_vertices: 0,
            repairs: mesh.repairs.clone(),
            eigenvalues: Vec::new(),
            signs: Vec::new(),
            judged: None,
            continuous_family: false,
            least_signature_gradient: None,
            kept: false,
            evidence: String::new(),
            seconds: Vec::new(),
        }
    }

    /// Enters what was seen of the shell on which maps were sought.
    pub(crate) fn with_shell(self, shell: &PreparedShell, orbits: &Orbits) -> Report {
        Report {
            solved_vertices: shell.surface.vertex_count(),
            eigenvalues: shell.basis.eigenvalues.clone(),
            continuous_family: orbits.continuous,
            least_signature_gradient: orbits.least_gradient,
            ..self
        }
    }
}

/// The outcome, the symmetries found (empty if none) and the evidence.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Detection {
    /// Found or none.
    pub outcome: Outcome,
    /// At most `options.symmetries`: reflections, best first, then half turns, best first: those of a plausibility of 0.95 or more
    /// by their scores, then the others by their plausibilities; reflections that exchange the sides of a thin sheet come behind those
    /// of a plausibility of 0.5 or more. Then at most `options.rotations` rotations of order three or more (EXPERIMENTAL), one of each cyclic group: those of highest order first, then the best.
    pub symmetries: Vec<Symmetry>,
    /// Numbers behind the outcome.
    pub report: Report,
    /// What [`crate::detect_again`] needs of the connectivity; `None` where that is not known yet.
    #[serde(skip)]
    pub judging: Option<Arc<JudgingMesh>>,
}

/// Finds the intrinsic symmetries of `mesh`.
///
/// The symmetry is sought on the largest shell; every other shell is then given its partner.
///
/// # Errors
/// [`crate::Error::Option`], [`crate::Error::Limit`], [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn detect(mesh: &Mesh, options: &Options, progress: &Progress) -> Result<Detection> {
    options.validate()?;
    let mut clock = Clock::start();
    progress.report("shells", 0.0)?;
    let shells = mesh.shells();
    let token = progress.token().clone();
    // Who states signs means those of the functions that the mesh has as it is.
    let filled = if options.states_signs() { None } else { FilledShell::new(&shells[0]) };
    let largest = filled.as_ref().map_or(&shells[0], |filled| &filled.shell);
    let solvable = || -> Result<(Option<Proxy>, IntrinsicSurface)> {
        let proxy = Proxy::new(largest, options.proxy_vertices, options.threads);
        clock.lap("proxy");
        let solved = proxy.as_ref().map_or(largest, |proxy| &proxy.shell);
        let needed = estimated_memory(mesh.positions.len(), solved.points.len(), options.eigenfunctions);
        check_memory(needed, options.memory)?;
        let surface = IntrinsicSurface::with_mean_curvature(solved);
        clock.lap("laplacian");
        Ok((proxy, surface))
    };
    let (solvable, connectivity) = threads::join(options.threads, solvable, || connectivity(mesh, token));
    let (proxy, surface) = solvable?;
    let (connectivity, unrivalled) = connectivity?;
    clock.lap("half-edges");
    let basis = Eigenbasis::new(&surface, options.eigenfunctions, options.threads, progress)?;
    clock.lap("eigenfunctions");
    let known = match &proxy {
        Some(proxy) if options.states_signs() => {
            stated_signs::on_proxy(&shells[0], proxy, &surface, &basis, &options.known_signs, progress)?
        }
        _ => options.known_signs.clone(),
    };
    let (samples, (orbits, signs)) = threads::join(
        options.threads,
        || Samples::farthest(&basis, options.samples),
        || (orbits(&surface, &basis), signs(&surface, &basis, options, &known)),
    );
    let (shell, signs) = (PreparedShell { surface, basis, samples }, signs?);
    clock.lap("samples, signs");
    let assembler =
        Assembler::new(mesh, &shells, filled.as_ref(), &shell, proxy.as_ref(), connectivity, options);
    let defects = unrivalled.as_ref().is_some_and(Automorphism::has_defects);
    let mirrored = unrivalled.and_then(|found| assembler.images_of_all(&found));
    let mirrored = mirrored.map(|images| of_images(&shell, &assembler.target, images)).transpose()?;
    let mirrored = mirrored.map(|map| ShellSymmetry { moved: assembler.moved(&map.images), ..map });
    clock.lap("connectivity");
    // Whoever states signs asks for the symmetry that has them.
    let any_will_do = options.symmetries == 1 && !options.states_signs();
    let is_certain = |map: &&ShellSymmetry| map.judged.accepted(CERTAIN) && !map.exchanges_sheets();
    let certain = mirrored.as_ref().filter(|map| any_will_do && is_certain(map));
    let mut maps = match certain {
        Some(map) => vec![(
            assembler.with_parts(map.clone(), SymmetryKind::Reflection, options.threads, progress.token())?,
            SymmetryKind::Reflection,
        )],
        None => {
            let found = candidates(&shell, &signs, options.symmetries, options, progress)?;
            clock.lap("candidates");
            let found = finish_best(&assembler, &found, options, progress)?;
            clock.lap("refinement");
            found
        }
    };
    let (judged, mut evidence) = verdict(maps.first().map(|(map, _)| map), options.plausibility);
    let best = maps.first().cloned();
    retain_symmetries(&mut maps, options.plausibility);
    maps.truncate(options.symmetries);
    if let Some(map) = mirrored {
        evidence += match defects {
            true => "; but for a few defects its connectivity admits one reflection",
            false => "; its connectivity admits one reflection",
        };
        if maps.is_empty() {
            evidence += ", and that is the answer";
            maps.push((
                assembler.with_parts(map, SymmetryKind::Reflection, options.threads, progress.token())?,
                SymmetryKind::Reflection,
            ));
        }
    }
    // One that is refused, but not by far.
    let nearly = |(map, _): &(ShellSymmetry, _)| map.judged.accepted(options.plausibility.div_ceil(2));
    if let Some((map, kind)) = best.filter(nearly).filter(|_| maps.is_empty())
        && assembler.mirrors_vertices(&map, kind, options.threads, progress)?
    {
        evidence += "; but vertices are each other's mirror images near it, and that is the answer";
        maps.push((map, kind));
    }
    if orbits.continuous {
        evidence += FAMILY;
        evidence += match maps.len() {
            0 => "",
            1 => ": the one given is an arbitrary one of them",
            _ => ": those given are arbitrary ones of them",
        };
    }
    if options.rotations > 0 {
        let listed = maps.len();
        if !orbits.continuous {
            for (map, kind) in rotations::find(&shell, &assembler.target, &maps, options, progress)? {
                let map = assembler.with_parts(map, kind, options.threads, progress.token())?;
                if map.judged.accepted(options.plausibility) {
                    maps.push((map, kind));
                }
            }
            clock.lap("rotations");
        }
        evidence += &about_rotations(maps.len() - listed, orbits.continuous);
    }
    // A judging mesh has no fillings; `detect_again` makes its own of the mesh as it is.
    let judging = || match maps.is_empty() || filled.is_some() {
        true => None,
        false => JudgingMesh::of_solved(mesh, &shells[0], proxy.as_ref(), &shell, options).map(Arc::new),
    };
    // From a proxy images are carried back on all threads; otherwise one of them is the judging mesh's.
    let (at_once, own) = match proxy.is_some() {
        true => (1, options.threads),
        false => (options.threads, options.threads.saturating_sub(1)),
    };
    let assembled = || -> Result<Vec<Symmetry>> {
        maps.iter().map(|(map, kind)| assembler.assemble(map, *kind, own, progress)).collect()
    };
    let (symmetries, judging) = threads::join(at_once, assembled, judging);
    let mut symmetries = symmetries?;
    drop_repeated(&mut symmetries);
    clock.lap("correspondence");
    progress.report("done", 1.0)?;
    let outcome = if symmetries.is_empty() { Outcome::None } else { Outcome::Found };
    let filled_holes = filled.as_ref().map_or(0, FilledShell::hole_count);
    let report = Report { filled_holes, signs, judged, evidence, seconds: clock.laps, ..Report::of(mesh) };
    let report = report.with_shell(&shell, &orbits);
    Ok(Detection { outcome, symmetries, report, judging })
}

/// The connectivity, and the only reflection that it admits if there is just one: all that needs no positions.
fn connectivity(mesh: &Mesh, token: CancelToken) -> Result<(Connectivity, Option<Automorphism>)> {
    let half_edges = HalfEdges::new(mesh.positions.len(), &mesh.polygon_offsets, &mesh.polygon_points)?;
    let mut connectivity = Connectivity::new(half_edges);
    let unrivalled = connectivity.find_unrivalled(&Progress::new(None, token))?;
    Ok((connectivity, unrivalled))
}

/// How the best map was judged, and that in words.
pub(crate) fn verdict(best: Option<&ShellSymmetry>, least: usize) -> (Option<Judgement>, String) {
    match best {
        Some(map) => (Some(map.judged), sentence(map, least)),
        None => (None, "no candidate map reverses orientation".into()),
    }
}

/// Leaves the maps that count as symmetries from `least` percent on: none, or the first and those not much worse than
/// the best.
pub(crate) fn retain_symmetries<T>(maps: &mut Vec<(ShellSymmetry, T)>, least: usize) {
    maps.retain(|(map, _)| map.judged.accepted(least));
    let best = maps.iter().map(|(map, _)| map.judged.isometry_score).fold(f64::INFINITY, f64::min);
    let mut first = true;
    maps.retain(|(map, _)| std::mem::take(&mut first) || map.judged.isometry_score < best + GAP);
}

/// Leaves the first of those with the same partners: connectivity may make one symmetry of two maps.
fn drop_repeated(symmetries: &mut Vec<Symmetry>) {
    let mut own = 0;
    while own < symmetries.len() {
        if symmetries[..own].iter().any(|other| other.partner == symmetries[own].partner) {
            symmetries.remove(own);
        } else {
            own += 1;
        }
    }
}

/// What is said to who asks for rotations of order three or more, of which `listed` were found.
fn about_rotations(listed: usize, continuous: bool) -> String {
    match (listed, continuous) {
        (_, true) => {
            "; rotations of higher order (experimental) are not sought in a continuous family".into()
        }
        (0, _) => "; no rotation of order 3 to 12 was found (experimental)".into(),
        (1, _) => "; a rotation of higher order was found (experimental)".into(),
        _ => format!("; {listed} rotations of higher order were found (experimental)"),
    }
}

fn sentence(map: &ShellSymmetry, least: usize) -> String {
    let parts = match map.judged.disagreement.zip(map.judged.scatter) {
        Some((apart, scatter)) => {
            format!(
                ", rigid parts of it put a point {apart:.4} sqrt(area) apart, images leave {:.1} % of the surface empty beyond what is usual",
                100.0 * scatter
            )
        }
        None => String::new(),
    };
    format!(
        "the best map is a symmetry with a plausibility of {:.0} % (accepted from {least} %): heat kernel \
         signatures of partners differ by {:.3}, score {:.2}, orientation correlation {:+.2} (-1 for a \
         reflection), {:.0} % of the samples hardly move{parts}",
        100.0 * map.judged.plausibility,
        map.judged.signature_mismatch,
        map.score.total(),
        map.score.orientation,
        100.0 * map.score.fixed
    )
}

/// Wall time by stage.
pub(crate) struct Clock {
    last: Instant,
    pub(crate) laps: Vec<(String, f64)>,
}

impl Clock {
    pub(crate) fn start() -> Clock {
        Clock { last: Instant::now(), laps: Vec::new() }
    }

    pub(crate) fn lap(&mut self, stage: &str) {
        let now = Instant::now();
        self.laps.push((stage.into(), (now - self.last).as_secs_f64()));
        self.last = now;
    }
}

/// The lowest eigenpairs of a whole mesh, for training and curiosity.
#[derive(Debug, Clone)]
pub struct Eigen {
    /// Ascending, the constant function left out; units of 1 / area of the largest shell.
    pub eigenvalues: Vec<f64>,
    /// Caller's vertices x count, row by row; NaN where the vertex is not on the largest shell.
    pub eigenfunctions: Vec<f64>,
    /// Lumped mass of each caller's vertex, summing to 1 over the largest shell's points; 0 elsewhere.
    pub lumped_mass: Vec<f64>,
    /// Relative residual of each pair.
    pub residuals: Vec<f64>,
}

/// Computes the `count` lowest non-constant eigenpairs of the largest shell.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn eigen(mesh: &Mesh, count: usize, progress: &Progress) -> Result<Eigen> {
    let shells = mesh.shells();
    let surface = IntrinsicSurface::new(&shells[0]);
    let basis = Eigenbasis::with_accuracy(&surface, count, Accuracy::Full, 1, progress)?;
    let mut local = vec![NONE; mesh.positions.len()];
    for (index, &point) in shells[0].points.iter().enumerate() {
        local[point as usize] = index as u32;
    }
    let vertices = mesh.point_of_vertex.len();
    let mut eigenfunctions = vec![f64::NAN; vertices * basis.count()];
    let mut lumped_mass = vec![0.0; vertices];
    for (vertex, &point) in mesh.point_of_vertex.iter().enumerate() {
        if point == NONE || local[point as usize] == NONE {
            continue;
        }
        let row = local[point as usize] as usize;
        for j in 0..basis.count() {
            eigenfunctions[vertex * basis.count() + j] = basis.eigenfunctions[(row, j)];
        }
        if mesh.vertex_of_point[point as usize] == vertex as u32 {
            lumped_mass[vertex] = surface.lumped_mass[row];
        }
    }
    progress.report("done", 1.0)?;
    Ok(Eigen { eigenvalues: basis.eigenvalues, eigenfunctions, lumped_mass, residuals: basis.residuals })
}
