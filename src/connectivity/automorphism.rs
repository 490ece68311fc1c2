//! Where connectivity is mirrored: the exact bijection, by half-edge traversal.
//!
//! A reflection of a manifold mesh is fixed by the image of one half-edge: walking both sides at once,
//! forwards on one and backwards on the other, gives the image of every other half-edge or a
//! contradiction. Blender's topology mirror (`editmesh`'s `EditMeshSymmetryHelper` and
//! `mesh_mirror` with topology) rests on the same idea but hashes neighbourhoods and gives up at the first
//! defect; the walk itself is the classical test for isomorphism of embedded graphs (Weinberg, "A simple
//! and efficient algorithm for determining isomorphism of planar triply connected graphs", 1966).
//!
//! 1. Vertices are coloured by a few rounds of Weisfeiler-Lehman refinement (`colours`), blind to
//!    orientation. A shell's rarest colour gives few seeds, so the search needs no estimate.
//! 2. Each seed is walked over its whole shell (`matching`); a walk that ends without contradiction is
//!    an exact bijection, its own inverse. Seeds are ordered, and rival bijections judged, by the estimate.
//! 3. Where no walk ends, patches are grown around the defects, without parts that have no counterpart (`almost`).
//!
//! Before all that a test on the polygons alone leaves out the shells that cannot be mirrored (`lookalikes`): of independent
//! triangulations no half-edges are made. Where the only bijection changes no lengths it is the answer ([`LengthChange`]).
//!
//! Shells may map to themselves or swap. Polygons are walked, not triangles: quads are often mirrored
//! where their triangulation is not. Cost O(size) per seed with a bound on all walks together; memory O(size).

mod almost;
mod colours;
mod estimate;
mod length_change;
mod lookalikes;
mod matching;
mod shells;

use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::mesh::half_edges::HalfEdges;
use crate::mesh::{Mesh, NONE};
use almost::{Context, Seeds};
pub(crate) use colours::hash;
use colours::{Classes, Colours};
pub use estimate::Reliance;
use estimate::{Distances, Estimate};
pub use length_change::LengthChange;
pub use lookalikes::{MANY, ShellColours, only_twins, shell_colours};
use matching::Matching;
use shells::Shells;
use std::cell::LazyCell;

/// Most vertices tried as the image of one pivot.
const PIVOT_IMAGES: usize = 64;
/// All walks together visit at most this many times the half-edges of the mesh.
const WALKS: u64 = 24;
/// A bijection this close to the estimate (mean distance in edges) ends the search for a closer one.
const CLOSE: f64 = 0.25;
/// The only bijection of the main shell is accepted against the estimate if this share of it agrees: an
/// estimate that swaps the legs is overruled, one of another symmetry is not.
const NOT_REFUTED: f64 = 0.3;

/// A self-inverse pairing of points that the connectivity proves or, in part, supports.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Automorphism {
    /// The partner of each point, itself on the fixed curve, [`NONE`] where not covered.
    pub partner: Vec<u32>,
    /// Whether a point's pair belongs to a bijection of its whole shell.
    pub exact: Vec<bool>,
    /// Number of points with a partner.
    pub covered: usize,
    /// Whether every shell is mapped by a bijection of the whole of it.
    pub complete: bool,
    /// Whether a point's pair belongs to the only bijection that the connectivity of the main shell admits, to one of a shell many of whose vertices have no other
    /// lookalike, or to the only pairing of six tenths of a shell's vertices. Shape can say nothing against it: no mesh is so by chance.
    pub unrivalled: Vec<bool>,
}

impl Automorphism {
    /// Whether the pairing changes the lengths of edges as little as an isometry does. O(1) beyond some thousand faces.
    pub fn keeps_lengths(&self, mesh: &Mesh) -> bool {
        LengthChange::of(mesh, self).is_some_and(|change| change.agrees())
    }

    /// What it says of some `points`, without the others.
    pub fn within(&self, points: &[u32]) -> Automorphism {
        let none = self.partner.len();
        let mut kept = Automorphism {
            partner: vec![NONE; none],
            exact: vec![false; none],
            covered: 0,
            complete: false,
            unrivalled: vec![false; none],
        };
        for point in points.iter().map(|&point| point as usize).filter(|&point| self.partner[point] != NONE) {
            kept.partner[point] = self.partner[point];
            kept.exact[point] = self.exact[point];
            kept.unrivalled[point] = self.unrivalled[point];
            kept.covered += 1;
        }
        kept
    }

    /// Whether an unrivalled pairing is not a bijection of its whole shell.
    pub fn has_defects(&self) -> bool {
        self.unrivalled.iter().zip(&self.exact).any(|(&unrivalled, &exact)| unrivalled && !exact)
    }
}

/// The connectivity of a mesh, prepared for searches.
pub struct Connectivity {
    half_edges: HalfEdges,
    shells: Shells,
    colours: Colours,
    classes: Classes,
    reflections: Bijections,
    /// Whether the mesh has shells that are left out.
    in_part: bool,
}

/// How many bijections the main shell, which has most of the mesh, has, as far as it is known.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Bijections {
    Unknown,
    None,
    Several,
}

impl Connectivity {
    /// That of the shells of a mesh on which it may be mirrored; `None` if there are none, as on independent triangulations:
    /// nothing is searched then, and no half-edges are made. O(corners + points log points).
    ///
    /// # Errors
    /// Those of [`HalfEdges::new`].
    pub fn of(mesh: &Mesh) -> Result<Option<Connectivity>> {
        let wanted = lookalikes::shells_with_lookalikes(mesh);
        if !wanted.contains(&true) {
            return Ok(None);
        }
        let (mut offsets, mut points) = (vec![0], Vec::new());
        for face in mesh.polygon_offsets.windows(2) {
            let corners = &mesh.polygon_points[face[0] as usize..face[1] as usize];
            if wanted[mesh.shell_of_point[corners[0] as usize] as usize] {
                points.extend_from_slice(corners);
                offsets.push(points.len() as u32);
            }
        }
        let left_out = mesh.shell_of_point.iter().filter(|&&shell| !wanted[shell as usize]).count();
        let half_edges = HalfEdges::new(mesh.point_count(), &offsets, &points)?;
        let areas = mesh.point_areas();
        let area: f64 = areas.iter().sum();
        Ok(Some(Connectivity::new(half_edges, left_out, |point| areas[point as usize] / area)))
    }

    /// Colours the vertices of a mesh of which so many are left out, and a point has such a share of the surface. O(half-edges + vertices log vertices).
    pub fn new(half_edges: HalfEdges, left_out: usize, area_share: impl Fn(u32) -> f64) -> Connectivity {
        let colours = Colours::new(&half_edges);
        let classes = Classes::new(&colours.far);
        let shells = Shells::new(&half_edges, left_out, area_share);
        let in_part = left_out > 0;
        Connectivity { half_edges, shells, colours, classes, reflections: Bijections::Unknown, in_part }
    }

    /// Finds the only reflection of the main shell that its connectivity admits, but for a few defects and parts without a counterpart; no estimate is needed. Of several
    /// with these it is the one that `agrees`. That there is none, or more than one, is remembered for later searches.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn find_unrivalled(
        &mut self,
        agrees: impl Fn(&Automorphism) -> bool,
        progress: &Progress,
    ) -> Result<Option<Automorphism>> {
        self.reflections = Bijections::Unknown;
        let points = self.half_edges.point_count;
        let (estimate, confidence) = (vec![NONE; points], vec![0.0; points]);
        let estimate = Estimate::new(&self.half_edges, &estimate, &confidence, Reliance::Twins);
        let agrees = |matching: &Matching, _: &[u32]| {
            let images = &matching.vertex_image;
            by_points(&self.half_edges, images, &vec![false; images.len()])
                .is_some_and(|found| agrees(&found))
        };
        let (found, bijections) = self.search(&estimate, SymmetryKind::Reflection, agrees, progress)?;
        self.reflections = bijections;
        Ok(found)
    }

    /// Finds the pairing by connectivity that agrees best with an estimate.
    ///
    /// `estimate` holds the estimated partner of each point or [`NONE`], `confidence` a weight in 0..=1; both
    /// have one entry per point. A bijection of a whole shell is accepted if its mean distance from the
    /// estimate is a small number of edges; on the main shell also if the connectivity
    /// admits no other and a third of the estimate agrees, or there is none. So is a pairing of most of that shell, or of most of another one with what the estimate says is
    /// its twin. What else is accepted `reliance` says. `None` if no shell has any.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    ///
    /// # Panics
    /// If `estimate` or `confidence` is shorter than the number of points.
    pub fn find(
        &self,
        estimate: &[u32],
        confidence: &[f32],
        reliance: Reliance,
        kind: SymmetryKind,
        progress: &Progress,
    ) -> Result<Option<Automorphism>> {
        let estimate = Estimate::new(&self.half_edges, estimate, confidence, reliance);
        let is_near = |matching: &Matching, shell: &[u32]| {
            estimate.distances(matching, shell, shell.len()).mean <= estimate::tolerance(shell.len())
        };
        Ok(self.search(&estimate, kind, is_near, progress)?.0)
    }

    /// That, and how many bijections the main shell has. Of several pairings of a shell but for its defects it is the one that `agrees`.
    fn search(
        &self,
        estimate: &Estimate,
        kind: SymmetryKind,
        agrees: impl Fn(&Matching, &[u32]) -> bool,
        progress: &Progress,
    ) -> Result<(Option<Automorphism>, Bijections)> {
        let (half_edges, shells) = (&self.half_edges, &self.shells);
        let mut matching = Matching::new(half_edges, kind);
        let known = if kind == SymmetryKind::Reflection { self.reflections } else { Bijections::Unknown };
        let matched = match_whole_shells(&mut matching, shells, &self.classes, estimate, known, progress)?;
        let bijections = matched.bijections;
        let exact: Vec<bool> = matching.vertex_image.iter().map(|&image| image != NONE).collect();
        let mut unrivalled = matched.unrivalled;
        let seeds = LazyCell::new(|| Seeds::new(half_edges, &self.colours.valences, kind));
        for shell in matched.defective {
            let twin = estimate.shell(half_edges, shells, shell);
            if (shells.is_main(shell) || twin.is_some())
                && self.match_defective(&mut matching, estimate, (shell, twin, &seeds), &agrees, progress)?
            {
                unrivalled.push(shell);
            }
        }
        let mut found = by_points(half_edges, &matching.vertex_image, &exact);
        if let Some(found) = &mut found {
            found.complete &= !self.in_part;
            for &vertex in unrivalled.iter().flat_map(|&shell| shells.vertices(shell)) {
                let point = half_edges.point_of_vertex[vertex as usize];
                let image = found.partner[point as usize];
                if image != NONE {
                    (found.unrivalled[point as usize], found.unrivalled[image as usize]) = (true, true);
                }
            }
        }
        Ok((found, bijections))
    }

    /// Pairs most of a shell, which has no bijection, around its defects; says whether that has no rival and may stand against the estimate. Another
    /// shell than the main one goes to its `twin`.
    fn match_defective(
        &self,
        matching: &mut Matching,
        estimate: &Estimate,
        (shell, twin, seeds): (usize, Option<usize>, &Seeds),
        agrees: impl Fn(&Matching, &[u32]) -> bool,
        progress: &Progress,
    ) -> Result<bool> {
        let (mark, vertices) = (matching.mark(), self.shells.vertices(shell));
        let valences = &self.colours.valences;
        let context = Context { vertices, seeds, valences, classes: &self.classes };
        let is_free = |&vertex: &u32| matching.vertex_image[vertex as usize] == NONE;
        let is_only = vertices.iter().all(is_free)
            && almost::match_shell(matching, &context, agrees, progress)?
            && match self.shells.is_main(shell) {
                true => is_not_refuted(&estimate.distances(matching, vertices, vertices.len())),
                false => {
                    let images = vertices.iter().map(|&vertex| matching.vertex_image[vertex as usize]);
                    images.filter(|&image| image != NONE).all(|image| Some(self.shells.of(image)) == twin)
                }
            };
        if !is_only {
            matching.rollback(mark);
        }
        Ok(is_only)
    }
}

/// What walking whole shells gave.
struct WholeShells {
    /// Shells that have no bijection.
    defective: Vec<usize>,
    /// The main shell, if its bijection is the only one; others many of whose vertices are like no other than their image.
    unrivalled: Vec<usize>,
    /// How many bijections the main shell has.
    bijections: Bijections,
}

/// Whether an only bijection may stand against the estimate.
fn is_not_refuted(distances: &Distances) -> bool {
    distances.share_within.is_none_or(|share| share >= NOT_REFUTED)
}

/// The verdict on one shell.
enum Whole {
    None,
    Refused,
    Bijection,
    OnlyBijection,
}

/// How the bijections of one shell are sought.
struct WholeShellSearch<'a> {
    shells: &'a Shells,
    classes: &'a Classes,
    estimate: &'a Estimate,
    /// Steps that are left.
    budget: u64,
    /// What is known, and then found, of the main shell.
    bijections: Bijections,
}

/// Maps what it can shell by shell, largest first.
fn match_whole_shells(
    matching: &mut Matching,
    shells: &Shells,
    classes: &Classes,
    estimate: &Estimate,
    bijections: Bijections,
    progress: &Progress,
) -> Result<WholeShells> {
    let budget = WALKS * matching.half_edges.count() as u64;
    let mut search = WholeShellSearch { shells, classes, estimate, budget, bijections };
    let (mut defective, mut unrivalled) = (Vec::new(), Vec::new());
    for shell in shells.by_size() {
        progress.check()?;
        if matching.vertex_image[shells.vertices(shell)[0] as usize] != NONE {
            continue;
        }
        match search.match_whole_shell(matching, shell, progress)? {
            Whole::None => defective.push(shell),
            Whole::Bijection if has_only_partners(matching, shells.vertices(shell), classes) => {
                unrivalled.push(shell);
            }
            Whole::Refused | Whole::Bijection => {}
            Whole::OnlyBijection => unrivalled.push(shell),
        }
    }
    Ok(WholeShells { defective, unrivalled, bijections: search.bijections })
}

/// Whether many vertices of a shell have no other lookalike than their image: hardly any shell is so by chance.
fn has_only_partners(matching: &Matching, vertices: &[u32], classes: &Classes) -> bool {
    let is_only = |&&vertex: &&u32| {
        let image = matching.vertex_image[vertex as usize];
        image != vertex && classes.members(vertex).len() == 2 && classes.same(vertex, image)
    };
    vertices.iter().filter(is_only).count() >= almost::IRREGULAR
}

impl WholeShellSearch<'_> {
    fn match_whole_shell(
        &mut self,
        matching: &mut Matching,
        shell: usize,
        progress: &Progress,
    ) -> Result<Whole> {
        let vertices = self.shells.vertices(shell);
        let main = self.shells.is_main(shell);
        if main && self.bijections == Bijections::None {
            return Ok(Whole::None);
        }
        let pivot = pivot(vertices, self.classes, self.estimate);
        let PivotImages { near, far, exhaustive } =
            images_of_pivot(matching, self.shells, self.classes, self.estimate, pivot);
        let seeds = |images: &[u32]| -> Vec<_> {
            images.iter().flat_map(|&image| matching.seeds(pivot, image)).collect()
        };
        let (near, far) = (seeds(&near), seeds(&far));
        let mark = matching.mark();
        let mut best: Option<(Distances, u32, u32)> = None;
        // One onto the shell where the estimate takes this one, and how many there are.
        let estimated = self.estimate.shell(matching.half_edges, self.shells, shell);
        let (mut there, mut count_there) = (None, 0);
        let mut found = if main && self.bijections == Bijections::Several { 2 } else { 0 };
        let mut told = self.budget;
        for (tried, &(start, target)) in near.iter().chain(&far).enumerate() {
            progress.check()?;
            // Each time the walks have visited as much as the whole mesh.
            if told - self.budget >= matching.half_edges.count() as u64 {
                told = self.budget;
                progress.goes_on()?;
            }
            // The main shell's rivals are worth knowing: one that is found at all. Then only what may be close is.
            let close = best.as_ref().is_some_and(|(distances, ..)| distances.mean <= CLOSE);
            let rivalled = !main || found > 1;
            if rivalled && close || main && rivalled && tried >= near.len() {
                break;
            }
            if matching.walk(start, target, self.classes, &mut self.budget) {
                found += 1;
                if Some(self.shells.of(matching.half_edges.to_vertex[target as usize])) == estimated {
                    (there, count_there) = (Some((start, target)), count_there + 1);
                }
                let distances = self.estimate.distances(matching, vertices, vertices.len());
                if best.as_ref().is_none_or(|(least, ..)| distances.mean < least.mean) {
                    best = Some((distances, start, target));
                }
                matching.rollback(mark);
            }
        }
        let all_tried = exhaustive && self.budget > 0;
        if main {
            self.bijections = match found {
                0 if all_tried => Bijections::None,
                0 | 1 => Bijections::Unknown,
                _ => Bijections::Several,
            };
        }
        let Some((distances, start, target)) = best else {
            // A main shell with bijections far from the estimate has no defects.
            return Ok(if found > 1 { Whole::Refused } else { Whole::None });
        };
        let unrivalled = main && found == 1 && all_tried;
        let near = distances.mean <= estimate::tolerance(vertices.len());
        let (start, target) = match there {
            _ if near || unrivalled && is_not_refuted(&distances) => (start, target),
            // An arm may be posed otherwise than what carries it.
            Some(only) if !main && all_tried && count_there == 1 => only,
            _ => return Ok(Whole::Refused),
        };
        Ok(match matching.walk(start, target, self.classes, &mut { u64::MAX }) {
            false => Whole::Refused,
            true if unrivalled => Whole::OnlyBijection,
            true => Whole::Bijection,
        })
    }
}

/// The vertex with the fewest possible images; of those, one with the surest estimate.
fn pivot(vertices: &[u32], classes: &Classes, estimate: &Estimate) -> u32 {
    let key = |vertex: u32| (classes.members(vertex).len(), -estimate.weight(vertex));
    let lower = |&first: &u32, &second: &u32| key(first).partial_cmp(&key(second)).unwrap();
    vertices.iter().copied().min_by(lower).expect("a shell has vertices")
}

/// Possible images of a pivot.
struct PivotImages {
    /// Those around its estimate, nearest first.
    near: Vec<u32>,
    /// The others, unless they are too many.
    far: Vec<u32>,
    /// Whether these are all.
    exhaustive: bool,
}

fn images_of_pivot(
    matching: &Matching,
    shells: &Shells,
    classes: &Classes,
    estimate: &Estimate,
    pivot: u32,
) -> PivotImages {
    let size = shells.size_at(pivot);
    let free =
        |&vertex: &u32| matching.vertex_image[vertex as usize] == NONE && shells.size_at(vertex) == size;
    let members = classes.members(pivot);
    let near = estimate.near(matching.half_edges, pivot, size);
    let near: Vec<u32> = near
        .into_iter()
        .filter(|&vertex| classes.same(vertex, pivot))
        .filter(free)
        .take(PIVOT_IMAGES)
        .collect();
    let exhaustive = members.len() <= PIVOT_IMAGES;
    let others = members.iter().copied().filter(|vertex| !near.contains(vertex)).filter(free);
    let far = if exhaustive { others.collect() } else { Vec::new() };
    PivotImages { near, far, exhaustive }
}

/// From vertices (fans) to points: a point is covered if all its mapped fans agree and its partner's do.
fn by_points(half_edges: &HalfEdges, vertex_image: &[u32], exact: &[bool]) -> Option<Automorphism> {
    const SEVERAL: u32 = NONE - 1;
    let mut partner = vec![NONE; half_edges.point_count];
    let mut exact_point = vec![true; half_edges.point_count];
    let mut complete = true;
    for (vertex, &point) in half_edges.point_of_vertex.iter().enumerate() {
        exact_point[point as usize] &= exact[vertex];
        complete &= exact[vertex];
        if vertex_image[vertex] != NONE {
            let image = half_edges.point_of_vertex[vertex_image[vertex] as usize];
            let known = &mut partner[point as usize];
            *known = if *known == NONE || *known == image { image } else { SEVERAL };
        }
    }
    let mutual = |point: usize| {
        let image = partner[point];
        image < SEVERAL && partner[image as usize] == point as u32
    };
    let covered_points: Vec<bool> = (0..partner.len()).map(mutual).collect();
    for (point, &covered) in covered_points.iter().enumerate() {
        complete &= covered || partner[point] == NONE;
        exact_point[point] &= covered;
        if !covered {
            partner[point] = NONE;
        }
    }
    let covered = covered_points.iter().filter(|&&covered| covered).count();
    let unrivalled = vec![false; partner.len()];
    (covered > 0).then_some(Automorphism { partner, exact: exact_point, covered, complete, unrivalled })
}
