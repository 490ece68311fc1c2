//! `detect`: the only caller of all stages.

use crate::base::effort::{Mechanisms, Plan};
use crate::base::error::{Error, Result};
use crate::base::limits::{check_memory, estimated_memory};
use crate::base::options::Options;
use crate::base::progress::Progress;
use crate::detect::attempt::attempt;
use crate::detect::clock::Clock;
use crate::detect::coverage::partner_point;
use crate::detect::detection::Detection;
use crate::detect::domain::Domain;
use crate::detect::excess::{Excess, paired_rest};
use crate::detect::finishing::Found;
use crate::detect::joined_shells::JoinedShells;
use crate::detect::mirror_plane::MIRRORED;
use crate::detect::question::Question;
use crate::detect::spectrum::Spectrum;
use crate::mesh::vector::{squared_norm, subtract};
use crate::mesh::{Mesh, Shell};
use crate::search::sign_network::SignNetwork;
use crate::verify::hypothesis::exchanges_sheets;
use crate::verify::outcome::{CONFIDENT, Outcome};

/// A mirror plane in space, or one shell's mirrored connectivity, from whose [`Detection::worth`] on it is the answer, and nothing is searched.
const ENOUGH: f64 = 0.9;
/// A plane that mirrors less is not the answer if a symmetry without doubts moves vertices by so many times as much, in the mean square: it exchanges the sides of flat tongs.
const MORE: f64 = 4.0;
/// How often parts without a counterpart are taken away.
const ROUNDS: usize = 3;

/// Finds the intrinsic symmetries of `mesh`.
///
/// A mesh that a plane in space mirrors is answered by that. Else the symmetry is sought on the largest shell, or on the large shells joined where none holds four fifths of
/// the surface and two of them are twins; every other shell is then given its partner.
///
/// # Errors
/// [`crate::Error::Option`], [`crate::Error::Model`], [`crate::Error::Limit`], [`crate::Error::TimeLimit`], [`crate::Error::Cancelled`],
/// [`crate::Error::Internal`].
pub fn detect(mesh: &Mesh, options: &Options, progress: &Progress) -> Result<Detection> {
    options.validate()?;
    SignNetwork::own(options)?; // whether or not this mesh needs it
    detect_by(mesh, options, &Plan::of(options), Mechanisms::default(), &progress.within(options.time_limit))
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
    // What is held where nothing is solved.
    check_memory(estimated_memory(mesh.positions.len(), 0, 0), options.memory)?;
    progress.report("shells", 0.0)?;
    let canonical = mesh.canonical();
    clock.lap("shells");
    let found = Question::new(mesh, &canonical, options, mechanisms, progress, &mut clock)
        .and_then(|question| answer(&question, plans, &mut clock))
        .map(|best| best.without_empty(options.plausibility))
        .and_then(|best| if best.is_out_of_time() { late(best) } else { Ok(best) });
    let mut best = progress.name_stage(found)?;
    progress.done()?;
    best.report.seconds = clock.laps;
    Ok(best)
}

/// What was found until time ended the search: doubtful, or no answer at all.
fn late(best: Detection) -> Result<Detection> {
    if best.symmetries.is_empty() { Err(Error::TimeLimit { stage: "" }) } else { Ok(best.out_of_time()) }
}

/// The mirror plane's answer, or that of a search, if it is worth more and speaks of no less of the surface, or leaves no doubts and moves far more.
fn answer(question: &Question, plans: &[Plan], clock: &mut Clock) -> Result<Detection> {
    let distance = |found: &Detection| moved(question.mesh, found).sqrt();
    let at_rest = question.at_rest()?;
    let moves = at_rest.as_ref().map_or(0.0, distance);
    clock.lap("mirror plane");
    // What is flat lies on its own mirror image.
    match at_rest.filter(|_| moves > MIRRORED) {
        // Hardly anybody asks for an exchange of the sides of a thin sheet, but of a gun it is all there is.
        Some(at_rest) if exchanges_sheets(moves) => {
            let is_other =
                |found: &Detection| found.outcome != Outcome::None && !exchanges_sheets(distance(found));
            match searched(question, plans, clock) {
                Err(Error::TimeLimit { .. }) => late(at_rest),
                Ok(found) if !is_other(&found) => Ok(at_rest),
                found => found,
            }
        }
        Some(at_rest) if at_rest.worth() >= ENOUGH => Ok(at_rest),
        other => {
            let found = searched(question, plans, clock);
            let moves_more = |at_rest: &Detection| {
                found.as_ref().is_ok_and(|found| {
                    found.is_settled() && moved(question.mesh, found) > MORE * moved(question.mesh, at_rest)
                })
            };
            better(other.filter(|at_rest| !moves_more(at_rest)), found, Detection::is_worth_more)
        }
    }
}

/// Mean square distance in space of points from their partners over the surface, in area; a point without a partner does not move.
fn moved(mesh: &Mesh, found: &Detection) -> f64 {
    let square = |(point, area): (usize, f64)| {
        let vertex = mesh.vertex_of_point[point] as usize;
        let partner = partner_point(mesh, found.symmetries[0].partner[vertex]);
        let image = mesh.positions.get(partner as usize).unwrap_or(&mesh.positions[point]);
        area * squared_norm(subtract(*image, mesh.positions[point]))
    };
    mesh.point_areas().into_iter().enumerate().map(square).sum()
}

/// The answer of the largest shell's connectivity, if it says nearly all; or of the joined shells; if that is not found that of the largest one alone, if that is worth more. If
/// all that are joined are their own, the largest one is asked first, and the others only if its map is plausible, but doubtful. What the map of joined shells sees of their twins is searched once more.
fn searched(question: &Question, plans: &[Plan], clock: &mut Clock) -> Result<Detection> {
    // Twins are those of one symmetry, and stated signs those of the largest shell's functions.
    let alone = || JoinedShells::alone(question.mesh.shells());
    let joined = match question.options.asks_for_one() {
        true => JoinedShells::new(question.mesh, None),
        false => alone(),
    };
    if joined.twins.is_empty() {
        return of_parts(question, joined, plans, clock);
    }
    // A body of mirrored connectivity knows better than all that it wears.
    if question.unrivalled.is_some()
        && let Some(exact) = Domain::new(question, &alone()).exact(&joined)?
        && exact.worth() >= ENOUGH
    {
        clock.lap("correspondence");
        return Ok(exact);
    }
    let are_own = joined.twins.iter().all(|[own, twin]| own == twin);
    let (first, second) = if are_own { (alone(), joined) } else { (joined, alone()) };
    let mut found = of_parts(question, first, plans, clock)?;
    if !are_own && let Some(symmetry) = found.symmetries.first() {
        let again = JoinedShells::new(question.mesh, Some(&symmetry.partner));
        if !again.twins.is_empty() {
            let is_better = |again: &Detection, found: &Detection| {
                again.outcome == Outcome::Found || again.is_worth_more(found)
            };
            found = better(Some(found), of_parts(question, again, plans, clock), is_better)?;
        }
    }
    // Joined, any lumps would have a map that sends each to itself.
    let is_plausible = 100.0 * found.plausibility() >= question.options.plausibility as f64;
    if found.outcome == Outcome::Found || are_own && !is_plausible {
        return Ok(found);
    }
    let earlier = Some(found).filter(|found| are_own || found.is_no_chance());
    better(earlier, of_parts(question, second, plans, clock), Detection::is_worth_more)
}

/// The answer of shells; or of what is left of the first without its parts that have no counterpart, if that is much more plausible.
fn of_parts(
    question: &Question,
    mut joined: JoinedShells,
    plans: &[Plan],
    clock: &mut Clock,
) -> Result<Detection> {
    let whole = joined.shells[0].area();
    let paired =
        question.unrivalled.as_ref().filter(|_| question.may_be_partial() && joined.twins.is_empty());
    let rest = paired.and_then(|found| paired_rest(&joined.shells[0], &found.partner));
    if let Some((found, _)) = of_rest(question, &mut joined, Vec::from_iter(rest), None, plans, clock)? {
        return Ok(found.of_rest(joined.shells[0].area() / whole));
    }
    let (mut best, mut rests) = of_shells(question, &joined, plans, None, clock)?;
    for _ in 0..ROUNDS {
        match of_rest(question, &mut joined, rests, Some(&best), &plans[..1], clock) {
            Ok(Some((found, smaller))) => {
                best = found.of_rest(joined.shells[0].area() / whole);
                rests = smaller;
            }
            Ok(None) => break,
            Err(Error::TimeLimit { .. }) => return late(best),
            Err(error) => return Err(error),
        }
    }
    Ok(best)
}

/// The answer of one of the `rests` of the first of some shells, which takes its place there, and the rests of that, if it is much more plausible
/// than the `best` yet, also times the share of the surface that it answers, or leaves no doubts where there is none.
fn of_rest(
    question: &Question,
    joined: &mut JoinedShells,
    rests: Vec<Shell>,
    best: Option<&Detection>,
    plans: &[Plan],
    clock: &mut Clock,
) -> Result<Option<(Detection, Vec<Shell>)>> {
    for rest in rests {
        let whole = std::mem::replace(&mut joined.shells[0], rest);
        let (found, rests) = of_shells(question, joined, plans, best, clock)?;
        // What is cut off is not answered.
        let share = joined.shells[0].area() / whole.area();
        let is_better = |best: &Detection| match best.symmetries.is_empty() {
            true => found.report.judged.is_some_and(|judged| judged.is_sure()),
            false => found.is_much_more_plausible(best) && share * found.plausibility() > best.plausibility(),
        };
        if best.map_or(found.outcome == Outcome::Found, is_better) {
            return Ok(Some((found, rests)));
        }
        joined.shells[0] = whole;
    }
    Ok(None)
}

/// The later of two answers if it is better; the earlier one, as doubtful, if time ended the other.
fn better(
    earlier: Option<Detection>,
    later: Result<Detection>,
    is_better: impl Fn(&Detection, &Detection) -> bool,
) -> Result<Detection> {
    match (earlier, later) {
        (Some(earlier), Err(Error::TimeLimit { .. })) => late(earlier),
        (Some(earlier), Ok(later)) if !is_better(&later, &earlier) => match later.is_out_of_time() {
            true => late(earlier),
            false => Ok(earlier),
        },
        (_, later) => later,
    }
}

/// The answer of exact connectivity, or by the plans in turn until one leaves no doubts; and what may be left of the first shell without parts that have no
/// counterpart, unless the answer is not much more plausible than that of the `whole`.
fn of_shells(
    question: &Question,
    joined: &JoinedShells,
    plans: &[Plan],
    whole: Option<&Detection>,
    clock: &mut Clock,
) -> Result<(Detection, Vec<Shell>)> {
    question.progress.report("holes", 0.03)?;
    let domain = Domain::new(question, joined);
    if let Some(exact) = domain.exact(joined)? {
        clock.lap("correspondence");
        return Ok((exact, Vec::new()));
    }
    let (mut best, mut solved): (Option<Detection>, _) = (None, None);
    // On what is solved.
    let mut known = Found::default();
    for plan in plans {
        let mut follow = || {
            let spectrum = match solved.take().filter(|solved: &Spectrum| solved.serves(plan)) {
                Some(solved) => solved,
                None => {
                    known = Found::default();
                    Spectrum::new(&domain, plan, clock)?
                }
            };
            let found = attempt(&domain, &spectrum, plan, &mut known, clock);
            solved = Some(spectrum);
            found
        };
        let found = match (follow(), best.take()) {
            // What a smaller plan has answered stands.
            (Err(Error::Limit { .. }), Some(best)) => return Ok((best, Vec::new())),
            (Err(Error::TimeLimit { .. }), Some(best)) => return late(best).map(|best| (best, Vec::new())),
            (found, earlier) => {
                best = earlier;
                found?
            }
        };
        let settled = found.is_settled() || plan.search.beam_width > 0 && found.is_hopeless();
        if best.as_ref().is_none_or(|best| found.is_better(best)) {
            best = Some(found);
        }
        if settled {
            break;
        }
    }
    let best = best.expect("a plan");
    // A map that says little tells no parts from others.
    let symmetry = best.symmetries.first().filter(|found| found.mean_confidence >= CONFIDENT);
    let may_be_partial = whole.is_none_or(|whole| best.is_much_more_plausible(whole))
        && question.guesses_parts()
        && joined.twins.is_empty();
    let rests = match solved.filter(|_| may_be_partial) {
        Some(solved) => {
            let excess = Excess::of(&joined.shells[0], domain.searched(), solved.proxy.as_ref());
            match excess.rests(question.mesh, symmetry, !best.is_settled(), question.progress) {
                Err(Error::TimeLimit { .. }) => return late(best).map(|best| (best, Vec::new())),
                rests => rests?,
            }
        }
        None => Vec::new(),
    };
    clock.lap("excess");
    Ok((best, rests))
}
