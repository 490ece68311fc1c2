//! `detect`: the only caller of all stages.

use crate::base::effort::{Mechanisms, Plan};
use crate::base::error::{Error, Result};
use crate::base::limits::{check_memory, estimated_memory};
use crate::base::options::Options;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::base::threads;
use crate::connectivity::automorphism::{Automorphism, Connectivity, LengthChange};
use crate::detect::assembler::{Assembler, Gatherer};
use crate::detect::companions;
use crate::detect::correspondence::Symmetry;
use crate::detect::detection::{Clock, about_family, about_rotations, conclusion, verdict};
pub use crate::detect::detection::{Detection, Outcome, Report};
use crate::detect::filled_holes::FilledShell;
use crate::detect::finishing::{Finished, finish_best};
use crate::detect::joined_shells::JoinedShells;
use crate::detect::judging_mesh::JudgingMesh;
use crate::detect::mirror_plane::MirrorPlane;
use crate::detect::proxy::Proxy;
use crate::detect::rotations;
use crate::detect::shell_symmetry::{PreparedShell, candidates, of_images, signs};
use crate::detect::stated_signs;
use crate::mesh::vector::{Vector, point_areas, squared_norm, subtract};
use crate::mesh::{Mesh, NONE, Shell};
use crate::search::candidates::{GAP, Hints};
use crate::search::sign_network::SignPrediction;
use crate::search::twin_starts::TwinDistances;
use crate::spectral::continuous_family::{Orbits, orbits};
use crate::spectral::eigenbasis::{Accuracy, Eigenbasis};
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::sampling::Samples;
use crate::spectral::twin_parts::TwinParts;
use crate::verify::acceptance::doubt;
use crate::verify::hypothesis::Hypothesis;
use crate::verify::hypothesis::exchanges_sheets;
use crate::verify::outcome::outcome;
use std::sync::Arc;

/// A reflection that the connectivity alone admits and that is as plausible as this, in percent, needs no search.
const CERTAIN: usize = 90;
/// An answer whose plausibility times mean confidence is at least this leaves no doubts. On generated shapes 0.6 gives the same errors
/// for a fifth less time, but it let a wrong map of remeshed TOSCA pass (`docs/results.md`).
const SETTLED: f64 = 0.75;
/// The same product from which on a mirror plane in space is the answer, and nothing is searched.
const AT_REST: f64 = 0.9;
/// What is asked of the plausibility of a map for which the connectivity or the vertices speak, in percent.
const ANY: usize = 0;
/// A wide search whose best map is less plausible than this ends with "none".
const HOPELESS: f64 = 0.01;

/// Finds the intrinsic symmetries of `mesh`.
///
/// A mesh that a plane in space mirrors is answered by that. Else the symmetry is sought on the largest shell, or on the large shells joined where no shell holds most of
/// the surface; every other shell is then given its partner.
///
/// # Errors
/// [`crate::Error::Option`], [`crate::Error::Limit`], [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn detect(mesh: &Mesh, options: &Options, progress: &Progress) -> Result<Detection> {
    options.validate()?;
    detect_by(mesh, options, &Plan::of(options), Mechanisms::default(), progress)
}

/// [`detect`] by plans of the caller's own, in turn until an answer leaves no doubts, and by some mechanisms alone: for measuring.
///
/// # Errors
/// Those of [`detect`].
pub fn detect_by(
    mesh: &Mesh,
    options: &Options,
    plans: &[Plan],
    mechanisms: Mechanisms,
    progress: &Progress,
) -> Result<Detection> {
    let mut clock = Clock::start();
    progress.report("shells", 0.0)?;
    progress.report("connectivity", 0.01)?;
    let (connectivity, unrivalled) = match mechanisms.connectivity {
        true => connectivity(mesh, progress)?,
        false => (None, None),
    };
    clock.lap("connectivity");
    let about = About { mesh, connectivity, unrivalled, mechanisms, options, progress };
    let at_rest = about.at_rest()?;
    clock.lap("mirror plane");
    let mut best = match at_rest {
        Some(at_rest) if at_rest.worth() >= AT_REST => at_rest,
        other => {
            let found = about.searched(plans, &mut clock)?;
            other.filter(|at_rest| at_rest.worth() > found.worth()).unwrap_or(found)
        }
    };
    progress.report("done", 1.0)?;
    best.report.seconds = clock.laps;
    Ok(best.without_empty(options.plausibility))
}

/// What is known of a mesh before its shells are joined.
struct About<'a> {
    mesh: &'a Mesh,
    /// `None` where it is not mirrored.
    connectivity: Option<Connectivity>,
    /// The only reflection that the connectivity admits.
    unrivalled: Option<Automorphism>,
    mechanisms: Mechanisms,
    options: &'a Options,
    progress: &'a Progress<'a>,
}

impl About<'_> {
    /// The answer where a plane in space mirrors the mesh, as it does what is not posed yet: nothing is solved then.
    fn at_rest(&self) -> Result<Option<Detection>> {
        let About { mesh, options, progress, .. } = *self;
        let wanted = self.mechanisms.mirror_plane && options.asks_for_one();
        progress.report("mirror plane", 0.02)?;
        let Some(plane) = wanted.then(|| MirrorPlane::of(mesh)).flatten() else { return Ok(None) };
        let shells = mesh.shells();
        let companions = companions::by_plane(mesh, &shells, &plane, progress)?;
        let vertices = self.mechanisms.mirrored_vertices;
        let gatherer = Gatherer::new(mesh, &shells, None, self.connectivity.as_ref(), vertices);
        let found = gatherer.by_plane(&plane, &companions, options.threads, progress)?;
        Ok(found.map(|(symmetry, share)| {
            let symmetries = vec![symmetry];
            let (outcome, doubts) = conclusion(&symmetries, options.plausibility);
            let evidence = format!("a plane in space mirrors {:.0} % of the surface{doubts}", 100.0 * share);
            let report = Report { evidence, ..Report::of(mesh) };
            Detection { outcome, symmetries, report, judging: None }
        }))
    }

    /// The answer of the joined shells; if it leaves doubts that of the largest one alone, if that leaves fewer.
    fn searched(&self, plans: &[Plan], clock: &mut Clock) -> Result<Detection> {
        // Twins are those of one symmetry, and stated signs those of the largest shell's functions.
        let joined = match self.options.asks_for_one() {
            true => JoinedShells::new(self.mesh, self.mesh.shells()),
            false => JoinedShells::alone(self.mesh.shells()),
        };
        let is_alone = joined.twins.is_empty();
        let found = self.of_shells(&joined, plans, clock)?;
        if is_alone || found.is_settled() {
            return Ok(found);
        }
        let alone = JoinedShells::alone(self.mesh.shells());
        let other = self.of_shells(&alone, plans, clock)?;
        Ok(if other.worth() > found.worth() { other } else { found })
    }

    fn of_shells(&self, joined: &JoinedShells, plans: &[Plan], clock: &mut Clock) -> Result<Detection> {
        // Who states signs means those of the functions that the mesh has as it is.
        let fills = self.mechanisms.filled_holes && !self.options.states_signs();
        let filled = FilledShell::new(&joined.shells[0], &joined.joints, fills);
        let case =
            Case { about: self, shells: &joined.shells, filled: filled.as_ref(), twins: &joined.twins };
        if let Some(exact) = case.exact()? {
            clock.lap("correspondence");
            return Ok(exact);
        }
        let (mut best, mut solved): (Option<Detection>, _) = (None, None);
        // Maps finished on what is solved.
        let mut finished = Vec::new();
        for plan in plans {
            let kept = solved.take().filter(|kept: &Solved| kept.serves(plan));
            let current = match kept {
                Some(kept) => kept,
                None => match case.solve(plan, clock) {
                    // What a smaller plan has answered stands.
                    Err(Error::Limit { .. }) if best.is_some() => break,
                    solved => {
                        finished.clear();
                        solved?
                    }
                },
            };
            let found = case.attempt(plan, &current, &mut finished, clock)?;
            solved = Some(current);
            let settled = found.is_settled() || plan.search.beam_width > 0 && found.is_hopeless();
            if best.as_ref().is_none_or(|best| found.is_better(best)) {
                best = Some(found);
            }
            if settled {
                break;
            }
        }
        Ok(best.expect("a plan"))
    }
}

impl Detection {
    /// Whether no larger plan needs to be followed.
    fn is_settled(&self) -> bool {
        let is_sure = |best: &Symmetry| best.plausibility * best.mean_confidence >= SETTLED;
        self.outcome == Outcome::Found && self.symmetries.first().is_some_and(is_sure)
    }

    /// Whether a larger plan would find nothing either.
    fn is_hopeless(&self) -> bool {
        self.report.judged.is_none_or(|judged| judged.plausibility < HOPELESS)
    }

    /// How much of the surface is answered, and how surely.
    fn worth(&self) -> f64 {
        self.symmetries.first().map_or(0.0, |best| best.plausibility * best.mean_confidence)
    }

    /// Whether this answer, by a larger plan, takes the place of an earlier one.
    fn is_better(&self, earlier: &Detection) -> bool {
        let doubts = |detection: &Detection| {
            detection.symmetries.first().map_or(f64::INFINITY, |best| doubt(best.plausibility))
        };
        (self.outcome, doubts(self)) <= (earlier.outcome, doubts(earlier))
    }
}

/// A mesh with the shell on which its symmetries are sought.
struct Case<'a> {
    about: &'a About<'a>,
    /// That shell, joined of several or the largest one, and the others.
    shells: &'a [Shell],
    /// The first of those, its holes filled, if it has some.
    filled: Option<&'a FilledShell>,
    /// The shells that are joined to the first of those, and their likely twins.
    twins: &'a [[u32; 2]],
}

/// The searched shell or its proxy with all that does not depend on the search.
struct Solved<'a> {
    /// The plan for which it was made.
    plan: Plan,
    proxy: Option<Proxy<'a>>,
    shell: PreparedShell,
    signs: Vec<SignPrediction>,
    orbits: Orbits,
    twins: Option<TwinDistances>,
}

/// Maps of the searched shell, the best first.
type Maps = Vec<(Hypothesis, SymmetryKind)>;

impl Solved<'_> {
    /// Whether it, and what was finished on it, would be the same by another plan: one that differs in the search alone.
    fn serves(&self, plan: &Plan) -> bool {
        Plan { search: plan.search.clone(), ..self.plan.clone() } == *plan
    }
}

impl<'a> Case<'a> {
    /// The answer where the connectivity of the searched shell admits one reflection and the shape agrees with it: nothing is solved then.
    fn exact(&self) -> Result<Option<Detection>> {
        let Case { shells, about: About { mesh, options, progress, .. }, .. } = *self;
        let wanted = options.asks_for_one();
        let Some(found) = self.about.unrivalled.as_ref().filter(|found| wanted && !found.has_defects())
        else {
            return Ok(None);
        };
        let found = found.within(&shells[0].points);
        progress.report("lengths", 0.03)?;
        let (Some(partners), Some(change)) =
            (shells[0].numbered(&found.partner), LengthChange::of(mesh, &found))
        else {
            return Ok(None);
        };
        if !change.agrees() || exchanges_sheets(mean_distance(&shells[0], &partners)) {
            return Ok(None);
        }
        let gatherer = self.gatherer(None);
        let symmetry = gatherer.exact(&found, partners, options.threads, progress)?;
        let mut evidence = format!(
            "the connectivity of the largest part admits one reflection, and lengths agree with it: edges and their images differ by {:.1} % in the median",
            100.0 * change.median
        );
        let symmetries = vec![symmetry];
        let (outcome, doubts) = conclusion(&symmetries, ANY);
        evidence += &doubts;
        let report = Report { evidence, ..Report::of(mesh) };
        Ok(Some(Detection { outcome, symmetries, report, judging: None }))
    }

    fn gatherer(&self, proxy: Option<&Proxy>) -> Gatherer<'_> {
        let mirrored_vertices = self.about.mechanisms.mirrored_vertices;
        Gatherer::new(
            self.about.mesh,
            self.shells,
            proxy,
            self.about.connectivity.as_ref(),
            mirrored_vertices,
        )
    }

    /// Simplifies and solves the searched shell.
    fn solve(&self, plan: &Plan, clock: &mut Clock) -> Result<Solved<'a>> {
        let About { mesh, options, progress, .. } = *self.about;
        let largest = self.filled.map_or(&self.shells[0], |filled| &filled.shell);
        let proxy = Proxy::new(largest, plan.proxy_vertices, options.threads);
        clock.lap("proxy");
        let solved = proxy.as_ref().map_or(largest, |proxy| &proxy.shell);
        let needed = estimated_memory(mesh.positions.len(), solved.points.len(), plan.eigenfunctions);
        check_memory(needed, options.memory)?;
        let mut surface = match self.about.mechanisms.curvature {
            true => IntrinsicSurface::with_mean_curvature(solved),
            false => IntrinsicSurface::new(solved),
        };
        surface.parts = self.parts(solved);
        clock.lap("laplacian");
        let basis = Eigenbasis::new(&surface, plan.eigenfunctions, options.threads, progress)?;
        clock.lap("eigenfunctions");
        let known = match &proxy {
            Some(proxy) if options.states_signs() => {
                let known = &options.known_signs;
                stated_signs::on_proxy(&self.shells[0], proxy, &surface, &basis, known, progress)?
            }
            _ => options.known_signs.clone(),
        };
        let (samples, (orbits, signs)) = threads::join(
            options.threads,
            || Samples::farthest(&basis, plan.samples).with_parts(surface.parts.as_ref()),
            || (orbits(&surface, &basis), signs(&surface, &basis, options, &known)),
        );
        clock.lap("samples, signs");
        let twins = TwinDistances::new(&surface, &samples);
        let shell = PreparedShell { surface, basis, samples };
        Ok(Solved { twins, plan: plan.clone(), proxy, shell, signs: signs?, orbits })
    }

    /// The joined shell that each vertex of the solved one lies on, and its likely twin; what fills a hole goes with what is beside it.
    fn parts(&self, solved: &Shell) -> Option<TwinParts> {
        if self.twins.is_empty() {
            return None;
        }
        let mut part_of = vec![NONE; solved.points.len()];
        for (part, &point) in part_of.iter_mut().zip(&solved.points).filter(|(_, point)| **point != NONE) {
            let shell = self.about.mesh.shell_of_point[point as usize];
            *part = self.place(shell).expect("a joined shell");
        }
        for triangle in &solved.triangles {
            let known = triangle.iter().map(|&corner| part_of[corner as usize]).find(|&part| part != NONE);
            for &corner in triangle.iter().filter(|_| known.is_some()) {
                let part = &mut part_of[corner as usize];
                *part = if *part == NONE { known.unwrap_or(0) } else { *part };
            }
        }
        let twin = |part: &u32| self.place(self.twins[*part as usize][1]).expect("a joined shell") as u8;
        Some(TwinParts {
            twin: part_of.iter().map(twin).collect(),
            own: part_of.iter().map(|&part| part as u8).collect(),
        })
    }

    /// Where a shell stands among the joined ones.
    fn place(&self, shell: u32) -> Option<u32> {
        self.twins.iter().position(|&[own, _]| own == shell).map(|place| place as u32)
    }

    /// Follows a plan.
    fn attempt(
        &self,
        plan: &Plan,
        solved: &Solved,
        finished: &mut Vec<Finished>,
        clock: &mut Clock,
    ) -> Result<Detection> {
        let About { mesh, options, progress, .. } = *self.about;
        let proxy = solved.proxy.as_ref();
        let assembler =
            Assembler::new(self.gatherer(proxy), self.filled, &solved.shell, proxy, plan, options);
        let mirrored = self.mirrored(&assembler)?;
        let mut maps = match mirrored.as_ref().filter(|map| self.is_certain(map)) {
            Some(map) => vec![self.as_reflection(&assembler, map.clone())?],
            None => {
                let found = candidates(
                    &solved.shell,
                    &Hints { signs: &solved.signs, twins: solved.twins.as_ref() },
                    &plan.search,
                    options,
                    progress,
                )?;
                clock.lap("candidates");
                finish_best(&assembler, &found, finished, options, progress)?
            }
        };
        clock.lap("refinement");
        let (judged, mut evidence) = verdict(maps.first().map(|(map, _)| map), options.plausibility);
        let best = maps.first().cloned();
        retain_symmetries(&mut maps, options.plausibility);
        maps.truncate(options.symmetries);
        let mut asked = options.plausibility;
        if let Some(map) = mirrored {
            evidence += match self.about.unrivalled.as_ref().is_some_and(Automorphism::has_defects) {
                true => "; but for a few defects its connectivity admits one reflection",
                false => "; its connectivity admits one reflection",
            };
            if maps.is_empty() {
                evidence += ", and that is the answer";
                asked = ANY;
                maps.push(self.as_reflection(&assembler, map)?);
            }
        }
        // One that is refused, but not by far.
        let nearly = |(map, _): &(Hypothesis, _)| map.judged.accepted(options.plausibility.div_ceil(2));
        if let Some((map, kind)) = best.clone().filter(nearly).filter(|_| maps.is_empty())
            && assembler.mirrors_vertices(&map, kind, options.threads, progress)?
        {
            evidence += "; but vertices are each other's mirror images near it, and that is the answer";
            asked = ANY;
            maps.push((map, kind));
        }
        if options.rotations > 0 {
            evidence += &self.add_rotations(&mut maps, &assembler, plan, solved)?;
            clock.lap("rotations");
        }
        if maps.is_empty() {
            let is_given =
                |map: &Hypothesis| outcome(map.judged.plausibility, asked, 1.0, 1.0) != Outcome::None;
            maps.extend(best.filter(|(map, _)| is_given(map)));
        }
        if solved.orbits.continuous {
            evidence += about_family(maps.len());
        }
        let (symmetries, judging) = self.assembled(&maps, &assembler, solved)?;
        clock.lap("correspondence");
        let (outcome, doubts) = conclusion(&symmetries, asked);
        evidence += &doubts;
        let filled_holes = self.filled.map_or(0, FilledShell::hole_count);
        let signs = solved.signs.clone();
        let report = Report { filled_holes, signs, judged, evidence, ..Report::of(mesh) };
        let report = report.with_shell(&solved.shell, &solved.orbits);
        Ok(Detection { outcome, symmetries, report, judging })
    }

    /// The map of the only reflection that the connectivity admits.
    fn mirrored(&self, assembler: &Assembler) -> Result<Option<Hypothesis>> {
        let images = self.about.unrivalled.as_ref().and_then(|found| assembler.images_of_all(found));
        let map = images.map(|images| of_images(assembler.shell, &assembler.target, images)).transpose()?;
        Ok(map.map(|map| Hypothesis { moved: assembler.moved(&map.images), ..map }))
    }

    /// Whether it needs no search. Whoever states signs asks for the symmetry that has them.
    fn is_certain(&self, map: &Hypothesis) -> bool {
        let any_will_do = self.about.options.symmetries == 1 && !self.about.options.states_signs();
        any_will_do && map.judged.accepted(CERTAIN) && !map.exchanges_sheets()
    }

    fn as_reflection(&self, assembler: &Assembler, map: Hypothesis) -> Result<(Hypothesis, SymmetryKind)> {
        let (kind, token) = (SymmetryKind::Reflection, self.about.progress.token());
        Ok((assembler.with_parts(map, kind, self.about.options.threads, token)?, kind))
    }

    /// Adds rotations of order three or more; gives what is said of them.
    fn add_rotations(
        &self,
        maps: &mut Maps,
        assembler: &Assembler,
        plan: &Plan,
        solved: &Solved,
    ) -> Result<String> {
        let (options, progress, listed) = (self.about.options, self.about.progress, maps.len());
        if !solved.orbits.continuous {
            let found = rotations::find(&solved.shell, &assembler.target, maps, plan, options, progress)?;
            for (map, kind) in found {
                let map = assembler.with_parts(map, kind, options.threads, progress.token())?;
                if map.judged.accepted(options.plausibility) {
                    maps.push((map, kind));
                }
            }
        }
        Ok(about_rotations(maps.len() - listed, solved.orbits.continuous))
    }

    /// The symmetries of the caller's mesh, and what the next call on the same connectivity needs.
    fn assembled(
        &self,
        maps: &Maps,
        assembler: &Assembler,
        solved: &Solved,
    ) -> Result<(Vec<Symmetry>, Option<Arc<JudgingMesh>>)> {
        let Case { shells, filled, about: About { mesh, options, progress, .. }, .. } = *self;
        let assembled =
            maps.iter().map(|(map, kind)| assembler.assemble(map, *kind, options.threads, progress));
        let mut symmetries = assembled.collect::<Result<Vec<Symmetry>>>()?;
        // A judging mesh has no fillings; `detect_again` makes its own of the mesh as it is.
        let judging = match maps.is_empty() || filled.is_some() {
            true => None,
            false => JudgingMesh::of_solved(mesh, &shells[0], solved.proxy.as_ref(), &solved.shell, options),
        };
        drop_repeated(&mut symmetries);
        Ok((symmetries, judging.map(Arc::new)))
    }
}

/// The connectivity where it is mirrored, and the only reflection that it admits if there is just one: all that needs no positions.
fn connectivity(mesh: &Mesh, progress: &Progress) -> Result<(Option<Connectivity>, Option<Automorphism>)> {
    let Some(mut connectivity) = Connectivity::of(mesh)? else { return Ok((None, None)) };
    let unrivalled = connectivity.find_unrivalled(progress)?;
    Ok((Some(connectivity), unrivalled))
}

/// Mean distance of a shell's vertices from their partners, in sqrt(area).
fn mean_distance(shell: &Shell, partners: &[u32]) -> f64 {
    let areas = point_areas(&shell.positions, &shell.triangles);
    let moved = |(place, &partner): (&Vector, &u32)| {
        squared_norm(subtract(*place, shell.positions[partner as usize])).sqrt()
    };
    let sum: f64 = shell.positions.iter().zip(partners).map(moved).zip(&areas).map(|(m, a)| m * a).sum();
    sum / areas.iter().sum::<f64>()
}

/// Leaves the maps that count as symmetries from `least` percent on: none, or the first and those not much worse than
/// the best.
pub(crate) fn retain_symmetries<T>(maps: &mut Vec<(Hypothesis, T)>, least: usize) {
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
