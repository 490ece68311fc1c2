//! `detect`: the only caller of all stages.

use crate::base::effort::{Mechanisms, Plan};
use crate::base::error::{Error, Result};
use crate::base::options::Options;
use crate::base::progress::Progress;
use crate::detect::attempt::attempt;
use crate::detect::clock::Clock;
use crate::detect::detection::Detection;
use crate::detect::domain::Domain;
use crate::detect::joined_shells::JoinedShells;
use crate::detect::question::Question;
use crate::detect::spectrum::Spectrum;
use crate::mesh::Mesh;

/// A mirror plane in space from whose [`Detection::worth`] on it is the answer, and nothing is searched.
const AT_REST: f64 = 0.9;

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
    let question = Question::new(mesh, options, mechanisms, progress, &mut clock)?;
    let at_rest = question.at_rest()?;
    clock.lap("mirror plane");
    let mut best = match at_rest {
        Some(at_rest) if at_rest.worth() >= AT_REST => at_rest,
        other => {
            let found = searched(&question, plans, &mut clock)?;
            other.filter(|at_rest| at_rest.worth() > found.worth()).unwrap_or(found)
        }
    };
    progress.report("done", 1.0)?;
    best.report.seconds = clock.laps;
    Ok(best.without_empty(options.plausibility))
}

/// The answer of the joined shells; if it leaves doubts that of the largest one alone, if that leaves fewer.
fn searched(question: &Question, plans: &[Plan], clock: &mut Clock) -> Result<Detection> {
    // Twins are those of one symmetry, and stated signs those of the largest shell's functions.
    let joined = match question.options.asks_for_one() {
        true => JoinedShells::new(question.mesh, question.mesh.shells()),
        false => JoinedShells::alone(question.mesh.shells()),
    };
    let is_alone = joined.twins.is_empty();
    let found = of_shells(question, &joined, plans, clock)?;
    if is_alone || found.is_settled() {
        return Ok(found);
    }
    let alone = JoinedShells::alone(question.mesh.shells());
    let other = of_shells(question, &alone, plans, clock)?;
    Ok(if other.worth() > found.worth() { other } else { found })
}

/// The answer of exact connectivity, or by the plans in turn until one leaves no doubts.
fn of_shells(
    question: &Question,
    joined: &JoinedShells,
    plans: &[Plan],
    clock: &mut Clock,
) -> Result<Detection> {
    let domain = Domain::new(question, joined);
    if let Some(exact) = domain.exact()? {
        clock.lap("correspondence");
        return Ok(exact);
    }
    let (mut best, mut solved): (Option<Detection>, Option<Spectrum>) = (None, None);
    // Maps finished on what is solved.
    let mut finished = Vec::new();
    for plan in plans {
        let spectrum = match solved.take().filter(|solved| solved.serves(plan)) {
            Some(solved) => solved,
            None => match Spectrum::new(&domain, plan, clock) {
                // What a smaller plan has answered stands.
                Err(Error::Limit { .. }) if best.is_some() => break,
                solved => {
                    finished.clear();
                    solved?
                }
            },
        };
        let found = attempt(&domain, &spectrum, plan, &mut finished, clock)?;
        solved = Some(spectrum);
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
