//! One plan followed on a domain: candidates, finished maps, and the choice among them.

use crate::base::effort::Plan;
use crate::base::error::Result;
use crate::base::symmetry_kind::SymmetryKind;
use crate::connectivity::automorphism::Automorphism;
use crate::detect::assembler::Assembler;
use crate::detect::clock::Clock;
use crate::detect::correspondence::Symmetry;
use crate::detect::detection::{Detection, Report};
use crate::detect::domain::Domain;
use crate::detect::filled_holes::FilledShell;
use crate::detect::finishing::{Found, finish_best};
use crate::detect::joined_shells::JoinedShells;
use crate::detect::judging_mesh::JudgingMesh;
use crate::detect::question::Question;
use crate::detect::shell_symmetry::{candidates, of_images};
use crate::detect::spectrum::Spectrum;
use crate::search::candidates::Hints;
use crate::verify::choose::{Choice, Maps, OneReflection, choose};
use crate::verify::hypothesis::Hypothesis;
use crate::verify::reason::Reason;
use std::sync::Arc;

/// A reflection that the connectivity alone admits and that is as plausible as this, in percent, needs no search.
const CERTAIN: usize = 80;

/// A plan on what is solved for it.
struct Attempt<'a> {
    domain: &'a Domain<'a>,
    spectrum: &'a Spectrum<'a>,
    assembler: Assembler<'a>,
}

/// The answer by a plan on what is solved for it. What an earlier plan has `found` there is not sought again.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn attempt<'a>(
    domain: &'a Domain<'a>,
    spectrum: &'a Spectrum<'a>,
    plan: &'a Plan,
    found: &mut Found,
    clock: &mut Clock,
) -> Result<Detection> {
    let Question { options, progress, .. } = *domain.question;
    let proxy = spectrum.proxy.as_ref();
    let gatherer = domain.gatherer(proxy);
    let assembler = Assembler::new(gatherer, domain.filled.as_ref(), &spectrum.shell, proxy, plan, options);
    let attempt = Attempt { domain, spectrum, assembler };
    let one = attempt.one_reflection()?;
    let maps = match one.as_ref().filter(|map| attempt.is_certain(map)) {
        Some(map) => vec![(attempt.with_parts(map.clone())?, SymmetryKind::Reflection)],
        None => attempt.searched(found, clock)?,
    };
    clock.lap("refinement");
    let mirrors_vertices =
        |map: &Hypothesis, kind| attempt.assembler.mirrors_vertices(map, kind, options.threads, progress);
    let has_defects = domain.question.unrivalled.as_ref().is_some_and(Automorphism::has_defects);
    let one = one.map(|map| OneReflection { map: || attempt.with_parts(map), has_defects });
    let mut choice = choose(maps, one, mirrors_vertices, (options.plausibility, options.symmetries))?;
    if spectrum.orbits.continuous && !choice.maps.is_empty() {
        choice.reasons.push(Reason::ContinuousFamily { listed: choice.maps.len() });
    }
    let answer = attempt.answer(choice)?;
    clock.lap("correspondence");
    Ok(answer)
}

impl Attempt<'_> {
    /// Candidates found and finished.
    fn searched(&self, Found { tried, finished }: &mut Found, clock: &mut Clock) -> Result<Maps> {
        let Question { options, progress, .. } = *self.domain.question;
        let Spectrum { shell, signs, twins, .. } = self.spectrum;
        let hints = Hints { signs, twins: twins.as_ref() };
        let found = candidates(shell, &hints, &self.assembler.plan.search, options, tried, progress)?;
        clock.lap("candidates");
        finish_best(&self.assembler, &found, finished, options, progress)
    }

    /// The map of the only reflection that the connectivity admits.
    fn one_reflection(&self) -> Result<Option<Hypothesis>> {
        let assembler = &self.assembler;
        let unrivalled = self.domain.question.unrivalled.as_ref();
        let Some(images) = unrivalled.and_then(|found| assembler.images_of_all(found)) else {
            return Ok(None);
        };
        of_images(assembler.shell, &assembler.target, images).map(Some)
    }

    /// Whether that needs no search. Whoever states signs asks for the symmetry that has them.
    fn is_certain(&self, map: &Hypothesis) -> bool {
        let any_will_do = self.domain.question.options.asks_for_one();
        any_will_do && map.judged.accepted(CERTAIN) && !self.assembler.exchanges_sheets(map)
    }

    fn with_parts(&self, reflection: Hypothesis) -> Result<Hypothesis> {
        let Question { options, progress, .. } = *self.domain.question;
        self.assembler.with_parts(reflection, SymmetryKind::Reflection, options.threads, progress)
    }

    /// The choice on the caller's mesh, and what the next call on the same connectivity needs.
    fn answer(&self, choice: Choice) -> Result<Detection> {
        let Domain { joined: JoinedShells { shells, .. }, filled, question } = self.domain;
        let Question { mesh, options, progress, .. } = **question;
        let Spectrum { shell, orbits, signs, proxy, .. } = self.spectrum;
        let assembled = choice
            .maps
            .iter()
            .map(|(map, kind)| self.assembler.assemble(map, *kind, options.threads, progress));
        let mut symmetries = assembled.collect::<Result<Vec<Symmetry>>>()?;
        // A judging mesh has no fillings; `detect_again` makes its own of the mesh as it is.
        let judging = match choice.maps.is_empty() || filled.is_some() {
            true => None,
            false => {
                let Question { given, given_points, .. } = **question;
                JudgingMesh::of_solved(given, given_points, &shells[0], proxy.as_ref(), shell, options)
            }
        };
        drop_repeated(&mut symmetries);
        let filled_holes = filled.as_ref().map_or(0, FilledShell::hole_count);
        let (judged, asked, reasons) = (choice.judged(), choice.asked, choice.reasons);
        let report = Report { filled_holes, signs: signs.clone(), judged, reasons, ..Report::of(mesh) };
        let answer = Detection::new(symmetries, asked, report.with_shell(shell, orbits));
        Ok(Detection { judging: judging.map(Arc::new), ..answer })
    }
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
