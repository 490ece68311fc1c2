//! Where the surface around a vertex has kept its shape, space says more than the surface alone.
//!
//! A pose bends few places; between them hands, heads and thighs stay as they are. The map of some hundred eigenfunctions is
//! right to about a percent of the surface's size. A rigid motion (with reflection), fitted to how it moves a whole part, averages that
//! error out, and is then fitted to the surface itself: each point comes to lie on the tangent plane of the vertex most
//! like it in place and normal (Y. Chen, G. Medioni, "Object modelling by registration of multiple range images", 1992). What the surface leaves
//! open, as a slide along a limb, stays as the map says. Parts overlap; each vertex follows those it is in, the more the better
//! they fit, but not those that the others contradict. So a vertex that the map tears from its surroundings comes back.
//!
//! Where a joint bends, no rigid part fits; there the motions around pass into each other, and the map has most to say. That is how this differs from fitting the whole
//! surface as rigidly as possible, which drifts there (`docs/notebook/2026-11-25-method.md`).

mod blending;
mod carrier;
pub mod cluster_motion;
mod mapped;
mod motion;
mod scatter;
mod takeover;
mod turned_parts;
mod whole_shells;

pub use carrier::Carrier;
pub use whole_shells::{Hint, WholeShell, carried};

use crate::base::effort::PartsEffort;
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::base::symmetry_kind::SymmetryKind;
use crate::base::threads;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::Shell;
use crate::mesh::vector::{Vector, quantile, squared_norm, subtract};
use crate::spectral::laplacian::IntrinsicSurface;
use mapped::{Disc, Mapped};
use motion::{Approach, Motion};

/// Radii of the parts, in sqrt(area), in each pass; their middles are spread over the shell.
const RADII: [f64; 2] = [0.16, 0.08];
/// Distance of interest from the surface, in sqrt(area), in a motion's fit, and how far the map is off where the surface leaves the
/// motion open.
const NOISE: f64 = 0.0015;
const MAP_ERROR: f64 = 0.01;
/// A motion that leaves the surface by this much, in sqrt(area), counts half.
const TRUSTED: f64 = 0.004;
/// One that starts this far from what the others agree on counts a quarter there.
const STRAY: f64 = 0.05;
/// Vertices of a part that are compared at most. A proxy has fewer; what cannot be simplified may have all in each part.
const MOST_PLACES: usize = 2000;
/// Weight of the map itself.
const MAP_WEIGHT: f64 = 0.02;
/// Share of the surface on which the parts' disagreement is judged: joints and holes have the rest. The median tells a plate with hills from a flat
/// one less well (`docs/method.md`).
const MOST: f64 = 0.85;

/// The vertices around one, how much it counts at each, and the motion that mirrors them.
struct Part<'a> {
    disc: &'a Disc,
    /// The motion fitted to the map.
    start: Motion,
    /// The motion fitted to the surface.
    motion: Motion,
    /// More the nearer it comes to the surface, 0..=1.
    trust: f64,
}

/// What the rigid parts of a map say of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigidity {
    /// How far from their mean the parts around a point put it, in sqrt(area): root mean square over the parts; on [`MOST`] of the surface it is no more. Small
    /// if the map is nearly a rigid motion almost everywhere.
    pub disagreement: f64,
    /// Share of the surface that the images of the vertices, moved by the parts, leave empty beyond what those of an isometry would;
    /// 0..=0.04.
    pub scatter: f64,
}

/// Images that follow the rigid parts of a shell.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// Images of the vertices.
    pub images: VertexMap,
    /// What the parts say of the map; `None` if nothing was fitted.
    pub rigidity: Option<Rigidity>,
}

/// Moves the images of an oriented shell's vertices to where the rigid parts put them.
///
/// `surface` is that of the shell. Images of a shell that is not oriented, or has no area, stay. O(vertices log vertices), with some
/// ten to thirty parts at each vertex, and a sparse factorisation in each pass. Turned parts take longest on a map that is no symmetry.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn fit(
    shell: &Shell,
    surface: &IntrinsicSurface,
    images: &VertexMap,
    kind: SymmetryKind,
    effort: &PartsEffort,
    threads: usize,
    progress: &Progress,
) -> Result<Fitted> {
    if !shell.orientable || shell.scale == 0.0 {
        return Ok(Fitted { images: images.clone(), rigidity: None });
    }
    let mirrored = kind == SymmetryKind::Reflection;
    let mut mapped = Mapped::new(shell, images);
    let turned = effort.turned.as_ref();
    let counts = turned.map_or([0; 2], |turned| [turned.parts, turned.small]);
    let most = counts.into_iter().chain(effort.passes).max();
    let middles = mapped.spread(most.unwrap_or(0));
    if let Some(turned) = turned {
        turned_parts::map_turned(&mut mapped, &middles, turned, mirrored, threads, progress)?;
    }
    let mut disagreement = None;
    for (radius, count) in RADII.into_iter().zip(effort.passes) {
        let discs =
            mapped.discs_along_edges(&middles[..count.min(middles.len())], &[radius], threads, progress)?;
        let parts = parts(&mapped, &discs, effort, mirrored, threads, progress)?;
        let agreed = agreed(&mapped, &parts);
        disagreement = disagreement.or_else(|| Some(disagreement_on_most(&mapped, &parts, &agreed)));
        let goals = blending::goals(&mapped, surface, &parts, &agreed)?;
        mapped.move_to(goals, threads);
        progress.goes_on()?;
    }
    let rigidity =
        disagreement.map(|disagreement| Rigidity { disagreement, scatter: scatter::scatter(&mapped) });
    Ok(Fitted { images: mapped.on_surface(threads), rigidity })
}

/// The parts of a shell, and how each moves.
fn parts<'a>(
    mapped: &Mapped,
    discs: &'a [Disc],
    effort: &PartsEffort,
    mirrored: bool,
    threads: usize,
    progress: &Progress,
) -> Result<Vec<Part<'a>>> {
    let approach = Approach { rounds: effort.rounds, noise: NOISE, held: MAP_ERROR, free: false };
    let token = progress.token();
    let part = |disc: &'a Disc| {
        token.check()?;
        let places = match disc.members.len() > MOST_PLACES {
            true => mapped.places(&mapped.picked(&disc.members, MOST_PLACES)),
            false => mapped.places(&mapped.by_area(&disc.members)),
        };
        let start = Motion::between(&places, mirrored);
        let mut near: Vec<u32> = places.iter().map(|place| place.partner).collect();
        let mut nearest = mapped.surface_from(&mut near);
        let motion = start.settled(&places, &mut nearest, approach);
        let trust = 1.0 / (1.0 + (motion.left(&places, &mut nearest) / TRUSTED).powi(4));
        Ok(Part { disc, start, motion, trust })
    };
    threads::map(threads, discs.iter().collect(), part).into_iter().collect()
}

impl Part<'_> {
    /// The vertices, and how much the part says of each; where it starts far from what is `agreed` it says little.
    fn says<'a>(
        &'a self,
        mapped: &'a Mapped,
        agreed: Option<&'a [Goal]>,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        self.disc.members.iter().map(move |&(vertex, weight)| {
            let start = self.start.of(mapped.shell.positions[vertex as usize]);
            let apart = |agreed: &[Goal]| subtract(start, agreed[vertex as usize].place);
            let stray = agreed.map_or(0.0, |agreed| squared_norm(apart(agreed)) / (STRAY * STRAY));
            (vertex as usize, self.trust * weight / (1.0 + stray).powi(2))
        })
    }
}

/// What the parts around a vertex and the map say of its image.
struct Goal {
    /// Where it should lie.
    place: Vector,
    /// Root mean square distance of the places where the parts put it from their mean.
    disagreement: f64,
}

/// Where each vertex's parts put its image: the mean of what they say, and a little of the map.
fn agreed(mapped: &Mapped, parts: &[Part]) -> Vec<Goal> {
    mean(mapped, parts, None, |part| part.start)
}

/// The mean over each vertex's parts of where one of its motions puts it.
fn mean(
    mapped: &Mapped,
    parts: &[Part],
    agreed: Option<&[Goal]>,
    motion: impl Fn(&Part) -> Motion,
) -> Vec<Goal> {
    // Offsets from the map's image, their squared lengths, and weights, all summed.
    let mut sums = vec![([0.0; 3], 0.0, 0.0); mapped.images.len()];
    for part in parts {
        let motion = motion(part);
        for (vertex, weight) in part.says(mapped, agreed) {
            let offset = subtract(motion.of(mapped.shell.positions[vertex]), mapped.images[vertex]);
            let (sum, squares, all) = &mut sums[vertex];
            (0..3).for_each(|axis| sum[axis] += weight * offset[axis]);
            *squares += weight * squared_norm(offset);
            *all += weight;
        }
    }
    let goal = |((sum, squares, all), image): ((Vector, f64, f64), &Vector)| Goal {
        place: [0, 1, 2].map(|axis| image[axis] + sum[axis] / (all + MAP_WEIGHT)),
        disagreement: match all > 0.0 {
            true => (squares / all - squared_norm(sum) / (all * all)).max(0.0).sqrt(),
            false => 0.0,
        },
    };
    sums.into_iter().zip(&mapped.images).map(goal).collect()
}

/// [`MOST`] of the area disagrees by no more than that.
fn disagreement_on_most(mapped: &Mapped, parts: &[Part], agreed: &[Goal]) -> f64 {
    let goals = mean(mapped, parts, Some(agreed), |part| part.motion);
    let mut of_area: Vec<(f64, f64)> =
        goals.iter().map(|goal| goal.disagreement).zip(mapped.areas.iter().copied()).collect();
    of_area.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    quantile(&of_area, MOST).unwrap_or(0.0)
}

/// A strip of 41 x 5 vertices, column by column, for tests; `at` places them.
#[cfg(test)]
fn strip(at: impl Fn(u32, u32) -> Vector) -> Shell {
    let squares = (0..40).flat_map(|column| (0..4).map(move |row| 5 * column + row));
    let polygons = crate::mesh::PolygonMesh {
        positions: (0..5 * 41).map(|i| at(i / 5, i % 5)).collect(),
        face_offsets: (0..=4 * 40).map(|face| 4 * face).collect(),
        face_vertices: squares.flat_map(|i| [i, i + 5, i + 6, i + 1]).collect(),
    };
    let mesh =
        crate::mesh::Mesh::new(&polygons, &crate::base::limits::Limits::default()).expect("a usable mesh");
    mesh.shells().swap_remove(0)
}
