//! Where vertices are mirrored but edges are not: quads that were cut into triangles along any of their diagonals.
//!
//! Which diagonal a program takes hangs on the order of corners, or on which is shorter in a pose, so a mesh modelled
//! symmetrically loses its mirrored connectivity when it is triangulated, and [`crate::automorphism`] has little then. But its
//! vertices are still each other's mirror images. Call two vertices *close* if an edge joins them or the flip of one edge
//! would: the corners of a quad are all close, however it is cut, so the mirror images of joined vertices are close. A pairing
//! with this property is sought near an estimate, as graphs that share most of their edges are matched: by
//! percolation (L. Yartseva, M. Grossglauser, "On the performance of percolation graph matching", 2013; [`percolation`]).
//!
//! It starts where the estimate, moved by about an edge, sends the vertices around one onto vertices, and takes first
//! what fits best: parts that a pose leaves rigid. Between independent triangulations it finds pairs, too, but few that fit so
//! well as those of mirrored vertices. Regular grids fit each other anywhere: starts at one vertex that fit equally well tell them,
//! and pairs that are turned against the estimate, as one grid is against the mirror image of another ([`agreement`]). These
//! three decide. The images of vertices that are not paired are moved as those around them were.

mod agreement;
mod percolation;
mod places;

use crate::adjacency::{Adjacency, nearest_seeds};
use crate::automorphism::Automorphism;
use crate::embedded_triangles::{Fans, TrianglePoint};
use crate::error::Result;
use crate::mesh::vector::{Vector, squared_norm, subtract};
use crate::mesh::{Mesh, NONE};
use crate::progress::Progress;
use crate::symmetry_kind::SymmetryKind;
use agreement::{GOOD, agrees_in_turn, has_enough};
use percolation::{MISFITS, Pairing};
use places::{Places, descend};

/// Shells with fewer vertices have too little to tell a pairing from chance; those with more are not made of quads by hand.
const SMALLEST_SHELL: usize = 24;
const LARGEST_SHELL: usize = 250_000;
/// Regions of a shell that are searched for starts, vertices looked at in each, and starts taken from each.
const REGIONS: usize = 80;
const LOOKS: usize = 16;
const STARTS: usize = 4;
/// Largest share of good trials that fit at another place nearly as well: up to 0.34 on bodies, most on a cube of squares.
const LARGEST_AMBIGUOUS_SHARE: f64 = 0.35;
/// Misfits below this are as good as each other.
const TIE: f64 = 1e-6;
/// Largest mean distance between the moved estimate and vertices, in edges, at a start, and of a vertex that it pairs.
const START_MISS: f64 = 0.2;
const VERTEX_MISS: f64 = 0.3;
/// What moving the estimate by an edge costs a start, in miss: on a grid all fit, and the nearer are likelier.
const SHIFT: f64 = 0.02;
/// A shell of which connectivity pairs such a share is left to it.
const MOSTLY_PAIRED: f64 = 0.98;

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
/// Shells are left out that cannot be oriented, have fewer than 24 or more than 250,000 vertices, or of which `connectivity` pairs
/// as many vertices; and those of which fewer than three of ten vertices fit, or whose grid fits itself at other places as well.
/// `None` if no shell is left. O(points log points).
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn find(
    mesh: &Mesh,
    estimate: Estimate,
    connectivity: Option<&Automorphism>,
    kind: SymmetryKind,
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
            && (SMALLEST_SHELL..=LARGEST_SHELL).contains(&points.len())
            && (known as f64) < MOSTLY_PAIRED * points.len() as f64;
        wanted.then_some((points, known))
    };
    let shells: Vec<_> = shells.into_iter().enumerate().filter_map(open).collect();
    if shells.is_empty() {
        return Ok(None);
    }
    let fans = Fans::new(mesh.positions.len(), &mesh.triangles);
    let (edges, close) = (edges(mesh), close(mesh, &fans));
    let mut is_open = vec![false; mesh.positions.len()];
    shells.iter().flat_map(|(points, _)| points).for_each(|&point| is_open[point as usize] = true);
    let mut pairing = Pairing::new(mesh, &edges, &close, kind, is_open);
    let mut places = Places::new(mesh, &estimate);
    let mut mirrored = Vec::new();
    for (points, known) in &shells {
        // A shell that changes places with an earlier one is paired with it.
        let regions = regions(&pairing, points);
        if points.iter().all(|&point| pairing.image[point as usize] == NONE) {
            pair_shell(&mut pairing, &places, points, &regions, progress)?;
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
    progress: &Progress,
) -> Result<()> {
    let mut tried = trials(pairing, starts(pairing, places, regions), progress)?;
    if tried.iter().all(|trial| trial.misfit > GOOD) || is_ambiguous(&tried) {
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
struct Trial {
    start: Start,
    /// Mean misfit of what grew.
    misfit: f64,
    /// Its ratio to that of another start at the same vertex, the better one for the best: 1 all over a flat grid, which fits
    /// itself anywhere, and small where a place is like no other (as features are matched by D. Lowe, "Distinctive Image
    /// Features from Scale-Invariant Keypoints", 2004).
    ambiguity: f64,
}

/// Whether the shell is a grid that fits itself at many places, so that starts say little about which is the right one.
fn is_ambiguous(tried: &[Trial]) -> bool {
    let good = || tried.iter().filter(|trial| trial.misfit <= GOOD && trial.ambiguity <= 1.0);
    let ambiguous = good().filter(|trial| trial.ambiguity > 0.5).count();
    ambiguous as f64 > LARGEST_AMBIGUOUS_SHARE * good().count() as f64
}

/// Tries starts, those at one vertex after each other: those from which enough grows.
fn trials(pairing: &mut Pairing, starts: Vec<Vec<Start>>, progress: &Progress) -> Result<Vec<Trial>> {
    let mut tried = Vec::new();
    for at_vertex in starts {
        progress.check()?;
        let grown = |start: Start| {
            let misfit = pairing.misfit_from(&start.pairs)?;
            Some(Trial { start, misfit, ambiguity: 0.0 })
        };
        let mut trials: Vec<Trial> = at_vertex.into_iter().filter_map(grown).collect();
        trials.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        let misfits: Vec<f64> = trials.iter().map(|trial| trial.misfit.max(TIE)).collect();
        for (place, trial) in trials.iter_mut().enumerate() {
            let other = if place == 0 { misfits.get(1) } else { misfits.first() };
            trial.ambiguity = other.map_or(0.0, |other| misfits[place] / other);
        }
        tried.extend(trials);
    }
    Ok(tried)
}

/// Points joined by an edge.
fn edges(mesh: &Mesh) -> Adjacency {
    let sides = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    let both = |(a, b): (u32, u32)| [(a, b), (b, a)];
    Adjacency::new(mesh.positions.len(), mesh.triangles.iter().flat_map(sides).flat_map(both))
}

/// Points joined by an edge, or by the edge that would replace the one between two triangles.
fn close(mesh: &Mesh, fans: &Fans) -> Adjacency {
    let pairs = mesh.triangles.iter().zip(&fans.behind).flat_map(|(&triangle, &behind)| {
        (0..3).flat_map(move |k| {
            let across = (behind[k] != NONE).then(|| mesh.triangles[behind[k] as usize]);
            let opposite = across.and_then(|other| other.into_iter().find(|point| !triangle.contains(point)));
            let (corner, next) = (triangle[k], triangle[(k + 1) % 3]);
            let far = opposite.unwrap_or(corner);
            [(corner, next), (next, corner), (corner, far), (far, corner)]
        })
    });
    Adjacency::new(mesh.positions.len(), pairs)
}

/// A vertex around which the moved estimate meets vertices.
struct Start {
    /// Mean distance from them, in edges.
    miss: f64,
    /// The pairs that this gives, the vertex in the middle first.
    pairs: Vec<(u32, u32)>,
}

/// Parts of a shell: the points nearest to seeds that are spread over their numbers.
fn regions(pairing: &Pairing, points: &[u32]) -> Vec<Vec<u32>> {
    let seeds: Vec<u32> = points.iter().copied().step_by(points.len().div_ceil(REGIONS)).collect();
    let around = |point: u32| pairing.edges.of(point as usize).iter().copied();
    let nearest = nearest_seeds(pairing.image.len(), &seeds, around);
    let mut regions = vec![Vec::new(); seeds.len()];
    let reached = points.iter().filter(|&&point| nearest[point as usize] != NONE);
    reached.for_each(|&point| regions[nearest[point as usize] as usize].push(point));
    regions
}

/// The best starts in every region of a shell.
fn starts(pairing: &Pairing, places: &Places, regions: &[Vec<u32>]) -> Vec<Vec<Start>> {
    let mut starts = Vec::new();
    for region in regions {
        let looked_at = region.iter().step_by(region.len().div_ceil(LOOKS));
        let found =
            looked_at.map(|&vertex| starts_at(pairing, places, vertex)).filter(|found| !found.is_empty());
        starts.extend(found.min_by(|a, b| a[0].miss.total_cmp(&b[0].miss)));
    }
    starts
}

/// The best starts at one vertex: the estimate is moved so that it sends the vertex to one near its image.
fn starts_at(pairing: &Pairing, places: &Places, vertex: u32) -> Vec<Start> {
    let mesh = pairing.mesh;
    let at = places.position[vertex as usize];
    let near = pairing.close.of(vertex as usize).iter().filter(|&&near| places.vertex[near as usize] != NONE);
    let around: Vec<_> = near.map(|&near| (near, subtract(places.position[near as usize], at))).collect();
    let middle = places.vertex[vertex as usize];
    let mut found = Vec::new();
    for &centre in pairing.close.of(middle as usize).iter().chain([&middle]) {
        let origin = mesh.positions[centre as usize];
        let edge = pairing.mean_length(centre);
        let mut start = Start { miss: 0.0, pairs: vec![(vertex, centre)] };
        for &(near, offset) in &around {
            let wanted: Vector = std::array::from_fn(|axis| origin[axis] + offset[axis]);
            let image = descend(pairing, centre, wanted);
            let miss = squared_norm(subtract(mesh.positions[image as usize], wanted)).sqrt() / edge;
            start.miss += miss.min(1.0) / around.len() as f64;
            if start.miss >= START_MISS {
                break;
            }
            if miss < VERTEX_MISS {
                start.pairs.push((near, image));
            }
        }
        if start.miss < START_MISS {
            let shift = squared_norm(subtract(origin, at)).sqrt() / edge;
            found.push((start.miss + SHIFT * shift, start));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(STARTS);
    found.into_iter().map(|(_, start)| start).collect()
}
