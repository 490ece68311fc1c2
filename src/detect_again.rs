//! `detect_again`: the symmetries of a mesh that was deformed since they were found.
//!
//! A deformation of the same connectivity leaves most pairs as they are, and the map of the earlier shape is nearer to
//! the truth than one that is found anew, or refined on the new shape (`docs/speed.md`). So it is kept as it is, and
//! only judged again, on a simplified mesh and by few eigenfunctions.

use crate::assembly::mean_over_surface;
use crate::continuous_family::orbits;
use crate::correspondence::Symmetry;
use crate::error::{Error, Result};
use crate::full_refinement::{MatchTarget, VertexImages};
use crate::laplacian::IntrinsicSurface;
use crate::limits::{check_memory, estimated_memory};
use crate::mesh::{Mesh, NONE, Shell};
use crate::options::Options;
use crate::pipeline::{Clock, Detection, Outcome, Report, detect, retain_symmetries, verdict};
use crate::progress::Progress;
use crate::proxy::Proxy;
use crate::shell_symmetry::{PreparedShell, ShellSymmetry, of_images};

/// Vertices of the simplified mesh on which earlier maps are judged.
const JUDGED_VERTICES: usize = 3000;
/// Eigenfunctions by which they are: as many as a search's maps have when their signatures are compared.
const JUDGED_EIGENFUNCTIONS: usize = 50;
/// Samples on which they are scored: as many as candidates are.
const JUDGED_SAMPLES: usize = 500;
/// Least plausibility, in percent, of a map that is kept, even for who accepts any map that a search finds.
const LEAST: usize = 50;

/// Finds the intrinsic symmetries of `mesh`, starting from `previous`: those of a mesh with the same connectivity
/// and other positions ([`crate::mesh::connectivity_hash`] tells).
///
/// If the first of them is still a symmetry, by [`Options::plausibility`] and more likely than not, it is kept, with
/// all others that still are: partners, surface points, confidences, sides and fixed curves stay as they were, scores
/// and the report are new, and [`Report::kept`] says so. Otherwise, or without any, this is [`detect`], and the report
/// says why.
///
/// What is kept knows nothing of vertices that were slid along the surface, on one side alone: after that call
/// [`detect`]. Cost of keeping: O(vertices log vertices), less than a tenth of a search.
///
/// # Errors
/// [`Error::Option`] if a symmetry has not as many vertices as `mesh`; those of [`detect`].
pub fn detect_again(
    mesh: &Mesh,
    previous: &[Symmetry],
    options: &Options,
    progress: &Progress,
) -> Result<Detection> {
    options.validate()?;
    let vertices = mesh.point_of_vertex.len();
    if let Some(other) = previous.iter().find(|symmetry| symmetry.partner.len() != vertices) {
        let message = format!("is of a mesh of {} vertices, this one has {vertices}", other.partner.len());
        return Err(Error::Option { name: "previous", message });
    }
    if previous.is_empty() {
        return detect(mesh, options, progress);
    }
    let again = keep(mesh, previous, options, progress)?;
    if again.outcome == Outcome::Found {
        progress.report("done", 1.0)?;
        return Ok(again);
    }
    let mut anew = detect(mesh, options, progress)?;
    anew.report.evidence += &format!("; an earlier shape's map was not kept: {}", again.report.evidence);
    let spent = again.report.seconds.iter().map(|(_, seconds)| seconds).sum();
    anew.report.seconds.insert(0, ("earlier maps".into(), spent));
    Ok(anew)
}

/// `previous` as far as they are symmetries of this shape; none if the first is not.
fn keep(mesh: &Mesh, previous: &[Symmetry], options: &Options, progress: &Progress) -> Result<Detection> {
    let mut clock = Clock::start();
    let shells = mesh.shells();
    let proxy = Proxy::new(&shells[0], options.proxy_vertices.min(JUDGED_VERTICES), options.threads);
    let solved = proxy.as_ref().map_or(&shells[0], |proxy| &proxy.shell);
    clock.lap("proxy");
    let eigenfunctions = options.eigenfunctions.min(JUDGED_EIGENFUNCTIONS);
    let needed = estimated_memory(mesh.positions.len(), solved.points.len(), eigenfunctions);
    check_memory(needed, options.memory)?;
    let surface = IntrinsicSurface::new(solved);
    clock.lap("laplacian");
    let samples = options.samples.min(JUDGED_SAMPLES);
    let shell =
        PreparedShell::new(surface, &Options { eigenfunctions, samples, ..options.clone() }, progress)?;
    let orbits = orbits(&shell.surface, &shell.basis);
    clock.lap("eigenfunctions");
    let target = MatchTarget::new(&shell.surface, &shell.basis, options.threads);
    let mut maps: Vec<(ShellSymmetry, &Symmetry)> = Vec::new();
    for symmetry in previous {
        let Some(partners) = partners_on(&shells[0], mesh, symmetry) else { break };
        let images = match &proxy {
            Some(proxy) => proxy.restrict(&partners),
            None => VertexImages::at_vertices(&solved.triangles, partners),
        };
        maps.push((of_images(&shell, &target, images)?, symmetry));
    }
    let least = options.plausibility.max(LEAST);
    let (judged, evidence) = match maps.first() {
        Some((map, _)) => verdict(Some(map), least),
        None => (None, "it does not map the largest shell onto itself".into()),
    };
    if maps.first().is_some_and(|(map, symmetry)| is_still(map, symmetry, least)) {
        maps.retain(|(map, symmetry)| is_still(map, symmetry, least));
        retain_symmetries(&mut maps, least);
        maps.truncate(options.symmetries);
    } else {
        maps.clear();
    }
    let mut symmetries: Vec<Symmetry> =
        maps.iter().map(|(map, symmetry)| judged_again(mesh, symmetry, map)).collect();
    symmetries.sort_by(|a, b| a.kind.cmp(&b.kind).then(a.score.total_cmp(&b.score)));
    clock.lap("earlier maps");
    let outcome = if symmetries.is_empty() { Outcome::None } else { Outcome::Found };
    let report = Report { judged, evidence, kept: true, seconds: clock.laps, ..Report::of(mesh) };
    Ok(Detection { outcome, symmetries, report: report.with_shell(&shell, &orbits) })
}

/// Whether `map`, which is `symmetry` on this shape, counts as one of its kind.
fn is_still(map: &ShellSymmetry, symmetry: &Symmetry, least: usize) -> bool {
    map.judged.accepted(least) && map.score.kind() == Some(symmetry.kind)
}

/// The partners of the shell's vertices; `None` if one of them is not on the shell.
fn partners_on(shell: &Shell, mesh: &Mesh, symmetry: &Symmetry) -> Option<Vec<u32>> {
    let mut local = vec![NONE; mesh.positions.len()];
    for (index, &point) in shell.points.iter().enumerate() {
        local[point as usize] = index as u32;
    }
    let partner = |&point: &u32| {
        let partner = symmetry.partner[mesh.vertex_of_point[point as usize] as usize];
        let point = *mesh.point_of_vertex.get(usize::try_from(partner).ok()?)?;
        local.get(point as usize).copied().filter(|&index| index != NONE)
    };
    shell.points.iter().map(partner).collect()
}

/// `symmetry` with the numbers that depend on the shape.
fn judged_again(mesh: &Mesh, symmetry: &Symmetry, map: &ShellSymmetry) -> Symmetry {
    let confidence: Vec<f32> =
        mesh.vertex_of_point.iter().map(|&vertex| symmetry.confidence[vertex as usize]).collect();
    Symmetry {
        score: map.score.total(),
        mean_confidence: mean_over_surface(mesh, &confidence),
        ..symmetry.clone()
    }
}
