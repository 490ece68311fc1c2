//! Where vertices are mirrored but edges are not: quads that were cut into triangles along any of their diagonals.
//!
//! Which diagonal a program takes hangs on the order of corners, or on which is shorter in a pose, so a mesh modelled
//! symmetrically loses its mirrored connectivity when it is triangulated, and [`crate::connectivity::automorphism`] has little then. But its
//! vertices are still each other's mirror images. Call two vertices *close* if an edge joins them or the flip of one edge
//! would: the corners of a quad are all close, however it is cut, so the mirror images of joined vertices are close. A pairing
//! with this property is sought near an estimate, as graphs that share most of their edges are matched: by
//! percolation (L. Yartseva, M. Grossglauser, "On the performance of percolation graph matching", 2013; `percolation`).
//! Where many edges are flipped, flips meet, and images of joined vertices are apart: if the pairing stays small it is tried again
//! with pairs that leave some edges apart.
//!
//! It starts where the estimate, moved by about an edge, sends the vertices around one onto vertices, and takes first
//! what fits best: parts that a pose leaves rigid. Between independent triangulations it finds pairs, too, but few that fit so
//! well as those of mirrored vertices. Regular grids fit each other anywhere: starts at one vertex that fit equally well tell them,
//! and pairs that are turned against the estimate, as one grid is against the mirror image of another (`agreement`). These
//! three decide. The images of vertices that are not paired are moved as those around them were.

mod agreement;
mod percolation;
mod places;
mod starts;
mod surroundings;
mod votes;

use crate::base::error::Result;
use crate::base::progress::{CancelToken, Progress};
use crate::base::symmetry_kind::SymmetryKind;
use crate::base::threads;
use crate::connectivity::automorphism::Automorphism;
use crate::geometry::embedded_triangles::{Fans, TrianglePoint};
use crate::mesh::{Mesh, NONE};
use agreement::{GOOD, agrees_in_turn, count_good, has_enough};
use percolation::{MISFITS, Pairing, SMALLEST_TRIAL};
use places::Places;
use starts::{LOOKED_AT, Regions, Start, starts};
use surroundings::Surroundings;

/// Shells with more vertices are not made of quads by hand.
const LARGEST_SHELL: usize = 250_000;
/// Largest share of good trials that fit at another place nearly as well: up to 0.38 on bodies, 0.49
/// and more on grids of voxels and cubes of squares.
const LARGEST_AMBIGUOUS_SHARE: f64 = 0.42;
/// Misfits below this are as good as each other.
const TIE: f64 = 1e-6;
/// A shell of which less is paired is tried again with pairs that keep fewer edges close: where many edges are flipped, flips meet.
const WELL: f64 = 0.55;
/// The largest share of the edges to paired neighbours that a pair then does not keep close, and how many times as many good pairs
/// that has to give.
const APART: f64 = 0.6;
const BETTER: f64 = 1.3;
/// On a shell of more vertices than are looked at, each so manieth region is tried first, with pairs that keep fewer edges: without a good start there, nothing is mirrored.
const SAMPLED: usize = 4;
/// Shells with at least this part of a mesh's points are tried on several threads: each takes a copy of the pairing, so that there must
/// not be many such shells.
const PART_FOR_THREADS: usize = 8;

/// An estimated map of the points of a mesh.
#[derive(Clone, Copy)]
pub struct Estimate<'a> {
    /// Partner of each point, or [`NONE`].
    pub partner: &'a [u32],
    /// Where the image lies, where there is a partner.
    pub image: &'a [TrianglePoint],
}

/// Images on the shells whose vertices are mirrored.
#[derive(Debug, Clone)]
pub struct MirroredVertices {
    /// Partner of each point; [`NONE`] on other shells.
    pub partner: Vec<u32>,
    /// Where the image lies, where there is a partner.
    pub image: Vec<TrianglePoint>,
    /// Whether the point and its partner are each other's; others have the estimate, moved.
    pub paired: Vec<bool>,
}

/// Pairs mirrored vertices.
///
/// Shells are left out that cannot be oriented, have fewer than 50 or more than 250,000 vertices, or of which `connectivity` pairs
/// as many vertices, and those of which fewer than three of ten vertices fit, or whose grid fits itself at other places as well.
/// `None` if no shell is left. On at most `threads` threads. O(points log points).
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn find(
    mesh: &Mesh,
    estimate: Estimate,
    connectivity: Option<&Automorphism>,
    kind: SymmetryKind,
    threads: usize,
    progress: &Progress,
) -> Result<Option<MirroredVertices>> {
    let by_connectivity =
        |point: u32| connectivity.is_some_and(|found| found.partner[point as usize] != NONE);
    let mut shells = vec![Vec::new(); mesh.shell_count];
    for point in (0..mesh.positions.len() as u32).filter(|&point| estimate.partner[point as usize] != NONE) {
        shells[mesh.shell_of_point[point as usize] as usize].push(point);
    }
    let count_paired = |points: &[u32]| points.iter().filter(|&&point| by_connectivity(point)).count();
    let open = |(shell, points): (usize, Vec<u32>)| {
        let known = count_paired(&points);
        let wanted = mesh.shell_orientable[shell]
            && (SMALLEST_TRIAL..=LARGEST_SHELL).contains(&points.len())
            && known < points.len();
        wanted.then_some((points, known))
    };
    let shells: Vec<_> = shells.into_iter().enumerate().filter_map(open).collect();
    if shells.is_empty() {
        return Ok(None);
    }
    let fans = Fans::new(mesh.positions.len(), &mesh.triangles);
    let around = Surroundings::new(mesh, &fans);
    let regions = Regions::new(&around, shells.iter().map(|(points, _)| points.as_slice()));
    let mut is_open = vec![false; mesh.positions.len()];
    shells.iter().flat_map(|(points, _)| points).for_each(|&point| is_open[point as usize] = true);
    let mut pairing = Pairing::new(&around, kind, is_open);
    let mut places = Places::new(mesh, &estimate);
    let mut mirrored = Vec::new();
    let is_large = |points: &[u32]| PART_FOR_THREADS * points.len() >= mesh.positions.len();
    for (points, known) in &shells {
        // A shell that changes places with an earlier one is paired with it.
        let regions = regions.of(points);
        if points.iter().all(|&point| pairing.image[point as usize] == NONE) {
            let threads = if is_large(points) { threads } else { 1 };
            pair_shell(&mut pairing, &places, points, &regions, threads, progress)?;
            pairing.end_growth();
        }
        let paired = points.iter().filter(|&&point| pairing.image[point as usize] != NONE).count();
        if paired > *known && has_enough(&pairing, points) && agrees_in_turn(&pairing, &places, &regions) {
            places.correct(&pairing, points);
            mirrored.extend(points);
        } else {
            pairing.forget(points);
        }
    }
    Ok((!mirrored.is_empty()).then(|| places.images(&pairing, &fans, &mirrored)))
}

/// Pairs what percolation reaches from the starts on a shell.
fn pair_shell(
    pairing: &mut Pairing,
    places: &Places,
    points: &[u32],
    regions: &[Vec<u32>],
    threads: usize,
    progress: &Progress,
) -> Result<()> {
    let around = pairing.around;
    let starts_in = |some: Vec<&Vec<u32>>| starts(around, places, some, threads);
    if points.len() > LOOKED_AT {
        let some = starts_in(regions.iter().step_by(SAMPLED).collect());
        pairing.start_again(points, APART);
        if !has_good(&trials(pairing, &some, threads, progress.token())?) {
            return Ok(());
        }
    }
    let starts = starts_in(regions.iter().collect());
    pairing.start_again(points, 0.0);
    grow(pairing, &starts, points, threads, progress)?;
    let (strict, good) = (pairing.pairs(points), count_good(pairing, points));
    if strict.len() as f64 >= WELL * points.len() as f64 {
        return Ok(());
    }
    pairing.start_again(points, APART);
    grow(pairing, &starts, points, threads, progress)?;
    let loose = count_good(pairing, points);
    if loose == 0 || (loose as f64) < BETTER * good as f64 {
        pairing.start_again(points, 0.0);
        pairing.enter_all(&strict);
    }
    Ok(())
}

/// Pairs what fits to `starts`, the best first.
fn grow(
    pairing: &mut Pairing,
    starts: &[Vec<Start>],
    points: &[u32],
    threads: usize,
    progress: &Progress,
) -> Result<()> {
    let mut tried = trials(pairing, starts, threads, progress.token())?;
    if !has_good(&tried) || is_ambiguous(&tried) {
        return Ok(());
    }
    tried.sort_by(|a, b| a.ambiguity.total_cmp(&b.ambiguity).then(a.misfit.total_cmp(&b.misfit)));
    for limit in MISFITS {
        progress.check()?;
        if limit > GOOD && !has_enough(pairing, points) {
            return Ok(());
        }
        for trial in tried.iter().filter(|trial| trial.misfit <= limit) {
            if pairing.image[trial.start.pairs[0].0 as usize] == NONE {
                pairing.grow_from(&trial.start.pairs, limit);
            }
        }
        pairing.grow_into(points, limit);
    }
    pairing.drop_contradicted(points);
    Ok(())
}

/// A start from which enough grew when it was tried.
struct Trial<'a> {
    start: &'a Start,
    /// Mean misfit of what grew.
    misfit: f64,
    /// Its ratio to that of another start at the same vertex, the better one for the best: 1 all over a flat grid, which fits
    /// itself anywhere, and small where a place is like no other (as features are matched by D. Lowe, "Distinctive Image
    /// Features from Scale-Invariant Keypoints", 2004).
    ambiguity: f64,
}

/// Whether vertices around any start fit as well as mirrored ones do.
fn has_good(tried: &[Trial]) -> bool {
    tried.iter().any(|trial| trial.misfit <= GOOD)
}

/// Whether the shell is a grid that fits itself at many places, so that starts say little about which is the right one.
fn is_ambiguous(tried: &[Trial]) -> bool {
    let good = || tried.iter().filter(|trial| trial.misfit <= GOOD && trial.ambiguity <= 1.0);
    let ambiguous = good().filter(|trial| trial.ambiguity > 0.5).count();
    ambiguous as f64 > LARGEST_AMBIGUOUS_SHARE * good().count() as f64
}

/// Tries starts, those at one vertex after each other: those from which enough grows.
fn trials<'a>(
    pairing: &mut Pairing,
    starts: &'a [Vec<Start>],
    threads: usize,
    token: &CancelToken,
) -> Result<Vec<Trial<'a>>> {
    let parts = threads::ranges(starts.len(), threads);
    let mut copies: Vec<Pairing> = (1..parts.len()).map(|_| pairing.clone()).collect();
    let pairings = std::iter::once(pairing).chain(&mut copies);
    let try_all = |(pairing, part): (&mut Pairing, std::ops::Range<usize>)| -> Result<Vec<Vec<Trial>>> {
        let try_at = |at_vertex: &'a Vec<Start>| token.check().map(|()| trials_at(pairing, at_vertex));
        starts[part].iter().map(try_at).collect()
    };
    let tried: Result<Vec<_>> =
        threads::map(threads, pairings.zip(parts).collect(), try_all).into_iter().collect();
    Ok(tried?.into_iter().flatten().flatten().collect())
}

/// Tries the starts at one vertex.
fn trials_at<'a>(pairing: &mut Pairing, starts: &'a [Start]) -> Vec<Trial<'a>> {
    let grown = |start: &'a Start| {
        let misfit = pairing.misfit_from(&start.pairs)?;
        Some(Trial { start, misfit, ambiguity: 0.0 })
    };
    let mut trials: Vec<Trial> = starts.iter().filter_map(grown).collect();
    trials.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
    let misfits: Vec<f64> = trials.iter().map(|trial| trial.misfit.max(TIE)).collect();
    for (place, trial) in trials.iter_mut().enumerate() {
        let other = if place == 0 { misfits.get(1) } else { misfits.first() };
        trial.ambiguity = other.map_or(0.0, |other| misfits[place] / other);
    }
    trials
}
