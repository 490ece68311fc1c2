//! `detect_again`: the symmetries of a mesh that was deformed since they were found.
//!
//! A deformation of the same connectivity leaves most pairs as they are, and the map of the earlier shape is nearer to
//! the truth than one that is found anew, or refined on the new shape (`docs/speed.md`). So it is kept as it is, and
//! only judged again, on a simplified mesh and by few eigenfunctions.

use crate::base::effort::{Mechanisms, Plan};
use crate::base::error::{Error, Result};
use crate::base::limits::{check_memory, estimated_memory};
use crate::base::options::Options;
use crate::base::progress::Progress;
use crate::base::threads;
use crate::detect::assembly::mean_over_surface;
use crate::detect::clock::Clock;
use crate::detect::correspondence::Symmetry;
use crate::detect::coverage::Coverage;
use crate::detect::detection::{Detection, Report};
use crate::detect::domain::movement;
use crate::detect::driver::{detect, detect_by};
use crate::detect::judging_mesh::JudgingMesh;
use crate::detect::shell_symmetry::of_images;
use crate::mesh::Mesh;
use crate::refine::full_refinement::MatchTarget;
use crate::search::sign_network::SignNetwork;
use crate::spectral::continuous_family::orbits;
use crate::spectral::laplacian::IntrinsicSurface;
use crate::verify::choose::{rank, retain_symmetries, verdict};
use crate::verify::hypothesis::{Hypothesis, exchanges_sheets};
use crate::verify::outcome::Outcome;
use crate::verify::reason::Reason;
use std::sync::Arc;

/// What is known of an earlier shape: a [`Detection`], or symmetries alone.
#[derive(Debug, Clone, Copy)]
pub struct Previous<'a> {
    /// Its symmetries, the best first.
    pub symmetries: &'a [Symmetry],
    /// The mesh to judge on, which a [`Detection`] passes on; without one, or if it does not fit, one is made.
    pub judging: Option<&'a Arc<JudgingMesh>>,
}

impl<'a> From<&'a Detection> for Previous<'a> {
    fn from(detection: &'a Detection) -> Self {
        Previous { symmetries: &detection.symmetries, judging: detection.judging.as_ref() }
    }
}

impl<'a> From<&'a [Symmetry]> for Previous<'a> {
    fn from(symmetries: &'a [Symmetry]) -> Self {
        Previous { symmetries, judging: None }
    }
}

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
/// [`detect`].
///
/// The result passes on [`Detection::judging`], so hand the whole [`Detection`] in, the newest or the first: a call that
/// finds a fitting one there costs O(vertices), twice as fast as one with symmetries alone, which must simplify the mesh,
/// O(vertices log vertices). The answer depends on the arguments alone. It differs between the two in the numbers by which
/// maps are judged, by less than two poses of a shape do (`docs/speed.md`).
///
/// # Errors
/// [`Error::Option`] if a symmetry has not as many vertices as `mesh`; those of [`detect`].
pub fn detect_again<'a>(
    mesh: &Mesh,
    previous: impl Into<Previous<'a>>,
    options: &Options,
    progress: &Progress,
) -> Result<Detection> {
    let previous = previous.into();
    options.validate()?;
    SignNetwork::own(options)?;
    let vertices = mesh.point_of_vertex.len();
    if let Some(other) = previous.symmetries.iter().find(|symmetry| symmetry.partner.len() != vertices) {
        let message = format!("is of a mesh of {} vertices, this one has {vertices}", other.partner.len());
        return Err(Error::Option { name: "previous", message });
    }
    if previous.symmetries.is_empty() {
        return detect(mesh, options, progress);
    }
    let (mut clock, progress) = (Clock::start(), &progress.within(options.time_limit));
    let again = progress.name_stage(judged(mesh, previous, options, progress, &mut clock))?;
    let seconds = clock.laps;
    if again.outcome != Outcome::None {
        progress.done()?;
        return Ok(Detection { report: Report { seconds, ..again.report }, ..again });
    }
    let mut anew = detect_by(mesh, options, &Plan::of(options), Mechanisms::default(), progress)?;
    anew.report.reasons.push(Reason::NotKept { because: again.report.reasons });
    let spent = seconds.iter().map(|(_, seconds)| seconds).sum();
    anew.report.seconds.insert(0, ("earlier maps".into(), spent));
    Ok(anew)
}

/// `previous` as far as they are symmetries of this shape, as judged on the kept mesh, or on a new one if that does not
/// fit or they fail on it: a mesh that was made for one shape may be a bad one of another.
fn judged(
    mesh: &Mesh,
    previous: Previous,
    options: &Options,
    progress: &Progress,
    clock: &mut Clock,
) -> Result<Detection> {
    if let Some(judging) = previous.judging.filter(|judging| judging.fits(mesh, options)) {
        match keep(mesh, previous.symmetries, judging.clone(), options, progress, clock) {
            Ok(Detection { outcome: Outcome::None, .. }) | Err(Error::Internal(_)) => {}
            settled => return settled,
        }
    }
    let judging = Arc::new(JudgingMesh::new(mesh, options));
    keep(mesh, previous.symmetries, judging, options, progress, clock)
}

/// `previous` as far as they are symmetries of this shape; none if the first is not.
fn keep(
    mesh: &Mesh,
    previous: &[Symmetry],
    judging: Arc<JudgingMesh>,
    options: &Options,
    progress: &Progress,
    clock: &mut Clock,
) -> Result<Detection> {
    let solved = judging.shell(mesh);
    clock.lap("proxy");
    let needed = estimated_memory(mesh.positions.len(), solved.points.len(), options.eigenfunctions);
    check_memory(needed, options.memory)?;
    let surface = IntrinsicSurface::new(&solved);
    clock.lap("laplacian");
    let shell = judging.solve(surface, options, progress)?;
    clock.lap("eigenfunctions");
    let judge = || -> Result<Vec<(Hypothesis, &Symmetry)>> {
        let target = MatchTarget::new(&shell.surface, &shell.basis, options.threads);
        let mut maps = Vec::new();
        for symmetry in previous {
            let Some(images) = judging.images(mesh, &symmetry.partner) else { break };
            maps.push((of_images(&shell, &target, images)?, symmetry));
        }
        Ok(maps)
    };
    let (maps, orbits) = threads::join(options.threads, judge, || orbits(&shell.surface, &shell.basis));
    let mut maps = maps?;
    let least = options.plausibility.max(LEAST);
    let judged = maps.first().map(|(map, _)| map.judged);
    let reason = maps.first().map_or(Reason::NotOntoItself, |(map, _)| verdict(map, least));
    retain_kept(&mut maps, options, least);
    rank(&mut maps, |(map, symmetry)| {
        (symmetry.kind, map.judged.plausibility, exchanges_sheets(movement(&solved, &map.images)))
    });
    let symmetries = maps.iter().map(|(map, symmetry)| judged_again(mesh, symmetry, map)).collect();
    clock.lap("earlier maps");
    let report = Report { judged, reasons: vec![reason], kept: true, ..Report::of(mesh) };
    let again = Detection::new(symmetries, least, report.with_shell(&shell, &orbits));
    Ok(Detection { judging: Some(judging), ..again })
}

/// Leaves the maps that are still symmetries, as many as are asked for; none if the first is none.
fn retain_kept(maps: &mut Vec<(Hypothesis, &Symmetry)>, options: &Options, least: usize) {
    if !maps.first().is_some_and(|(map, symmetry)| is_still(map, symmetry, least)) {
        maps.clear();
    }
    maps.retain(|(map, symmetry)| is_still(map, symmetry, least));
    retain_symmetries(maps, least);
    maps.truncate(options.symmetries);
}

/// Whether `map`, which is `symmetry` on this shape, counts as one of its kind.
fn is_still(map: &Hypothesis, symmetry: &Symmetry, least: usize) -> bool {
    map.judged.accepted(least) && map.score.kind() == Some(symmetry.kind)
}

/// `symmetry` with the numbers that depend on the shape.
fn judged_again(mesh: &Mesh, symmetry: &Symmetry, map: &Hypothesis) -> Symmetry {
    let confidence: Vec<f32> =
        mesh.vertex_of_point.iter().map(|&vertex| symmetry.confidence[vertex as usize]).collect();
    Symmetry {
        score: map.score.total(),
        plausibility: map.judged.plausibility,
        mean_confidence: mean_over_surface(mesh, &confidence),
        coverage: Coverage::of(mesh, &symmetry.partner),
        ..symmetry.clone()
    }
}
