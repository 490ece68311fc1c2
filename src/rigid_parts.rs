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
//! surface as rigidly as possible, which drifts there (`docs/method.md`).

mod blending;
mod carrier;
mod mapped;
mod motion;
mod scatter;
mod takeover;
mod turned_parts;

pub use carrier::Carrier;

use crate::acceptance::Rigidity;
use crate::embedded_triangles::TrianglePoint;
use crate::error::Result;
use crate::full_refinement::VertexImages;
use crate::laplacian::IntrinsicSurface;
use crate::mesh::Shell;
use crate::mesh::vector::{Vector, squared_norm, subtract};
use crate::progress::CancelToken;
use crate::symmetry_kind::SymmetryKind;
use crate::threads;
use mapped::{Disc, Mapped};
use motion::{Fit, Motion};
use std::ops::Range;

/// Radius of the parts along edges, in sqrt(area), and how many they are, in each pass; their middles are spread over the shell.
const PASSES: [(f64, usize); 2] = [(0.16, 200), (0.08, 400)];
/// Points of a part that its motion is fitted to.
const FITTED_POINTS: usize = 80;
/// Distance of interest from the surface, in sqrt(area), in a motion's fit.
const LEAVE: f64 = 0.0015;
/// A motion that leaves the surface by this much, in sqrt(area), counts half.
const TRUSTED: f64 = 0.004;
/// One that starts this far from what the others agree on counts a quarter there.
const STRAY: f64 = 0.05;
/// Rounds in which the parts around a vertex agree.
const AGREEING_ROUNDS: usize = 2;
/// Weight of the map itself.
const MAP_WEIGHT: f64 = 0.02;
/// Vertices that one thread takes at a time.
const CHUNK: usize = 2048;

/// The vertices around one, how much it counts at each, and the motion that mirrors them.
struct Part<'a> {
    disc: &'a Disc,
    fit: Fit,
}

/// Images that follow the rigid parts of a shell.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// Images of the vertices.
    pub images: VertexImages,
    /// What the parts say of the map; `None` if nothing was fitted.
    pub rigidity: Option<Rigidity>,
}

/// Moves the images of an oriented shell's vertices to where the rigid parts put them.
///
/// `surface` is that of the shell; parts that a pose has turned far are sought if `turned`, which takes longer than all else, most of all
/// on a map that is no symmetry. Images of a shell that is not oriented, or has no area, stay. O(vertices log vertices), with some
/// ten to thirty parts at each vertex, and a sparse factorisation in each pass.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn fit(
    shell: &Shell,
    surface: &IntrinsicSurface,
    images: &VertexImages,
    kind: SymmetryKind,
    turned: bool,
    threads: usize,
    token: &CancelToken,
) -> Result<Fitted> {
    if !shell.orientable || shell.scale == 0.0 {
        return Ok(Fitted { images: images.clone(), rigidity: None });
    }
    let mirrored = kind == SymmetryKind::Reflection;
    let mut mapped = Mapped::new(shell, images.clone());
    if turned {
        turned_parts::right(&mut mapped, mirrored, threads, token)?;
    }
    let analysis = surface.analysis()?;
    let mut disagreement = None;
    for (radius, count) in PASSES {
        let discs = discs(&mapped, radius, count, threads, token)?;
        let parts = parts(&mapped, &discs, radius, mirrored, threads, token)?;
        let agreed = agreed(&mapped, &parts);
        disagreement = disagreement.or_else(|| Some(median_disagreement(&mapped, &parts, &agreed)));
        let goals = blending::goals(&mapped, surface, analysis, &parts, &agreed)?;
        let project = |range: Range<usize>| -> Vec<(u32, TrianglePoint)> {
            range.map(|vertex| mapped.nearest(vertex, goals[vertex])).collect()
        };
        let ranges = threads::ranges(goals.len(), goals.len().div_ceil(CHUNK));
        let (partners, points) = threads::map(threads, ranges, project).into_iter().flatten().unzip();
        mapped.replace_all(VertexImages { partners, points });
    }
    let rigidity =
        disagreement.map(|disagreement| Rigidity { disagreement, scatter: scatter::scatter(&mapped) });
    Ok(Fitted { images: mapped.found, rigidity })
}

/// Discs spread over the shell.
fn discs(
    mapped: &Mapped,
    radius: f64,
    count: usize,
    threads: usize,
    token: &CancelToken,
) -> Result<Vec<Disc>> {
    let disc = |middle: u32| token.check().map(|()| mapped.disc(middle, radius));
    threads::map(threads, mapped.spread(count), disc).into_iter().collect()
}

/// The parts of a shell, and how each moves.
fn parts<'a>(
    mapped: &Mapped,
    discs: &'a [Disc],
    radius: f64,
    mirrored: bool,
    threads: usize,
    token: &CancelToken,
) -> Result<Vec<Part<'a>>> {
    let part = |disc: &'a Disc| {
        token.check()?;
        let places = mapped.places(&mapped.picked(&disc.members, FITTED_POINTS));
        let start = Motion::between(&places, mirrored);
        let fit = start.onto(&places, radius, LEAVE, |goal, start| mapped.alike(goal, start))?;
        Ok(Part { disc, fit })
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
        let trust = 1.0 / (1.0 + (self.fit.left / TRUSTED).powi(4));
        self.disc.members.iter().map(move |&(vertex, weight)| {
            let start = self.fit.start.of(mapped.shell.positions[vertex as usize]);
            let apart = |agreed: &[Goal]| subtract(start, agreed[vertex as usize].place);
            let stray = agreed.map_or(0.0, |agreed| squared_norm(apart(agreed)) / (STRAY * STRAY));
            (vertex as usize, trust * weight / (1.0 + stray).powi(2))
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

/// Where most of each vertex's parts put its image: the mean of what they say, but for those that the others contradict, and a
/// little of the map.
fn agreed(mapped: &Mapped, parts: &[Part]) -> Vec<Goal> {
    let start = |fit: &Fit, position| fit.start.of(position);
    let mut agreed = mean(mapped, parts, None, start);
    for _ in 0..AGREEING_ROUNDS {
        agreed = mean(mapped, parts, Some(&agreed), start);
    }
    agreed
}

/// The mean over each vertex's parts of where `place` puts it.
fn mean(
    mapped: &Mapped,
    parts: &[Part],
    agreed: Option<&[Goal]>,
    place: impl Fn(&Fit, Vector) -> Vector,
) -> Vec<Goal> {
    // Offsets from the map's image, their squared lengths, and weights, all summed.
    let mut sums = vec![([0.0; 3], 0.0, 0.0); mapped.images.len()];
    for part in parts {
        for (vertex, weight) in part.says(mapped, agreed) {
            let offset = subtract(place(&part.fit, mapped.shell.positions[vertex]), mapped.images[vertex]);
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

/// Half of the area disagrees by no more than that.
fn median_disagreement(mapped: &Mapped, parts: &[Part], agreed: &[Goal]) -> f64 {
    let goals = mean(mapped, parts, Some(agreed), |fit, position| fit.motion.of(position));
    let mut of_area: Vec<(f64, f64)> =
        goals.iter().map(|goal| goal.disagreement).zip(mapped.areas.iter().copied()).collect();
    of_area.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let half = 0.5 * mapped.areas.iter().sum::<f64>();
    let mut below = 0.0;
    let median = of_area.iter().find(|(_, area)| {
        below += area;
        below >= half
    });
    median.map_or(0.0, |(disagreement, _)| *disagreement)
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
    let mesh = crate::mesh::Mesh::new(&polygons, &crate::limits::Limits::default()).expect("a usable mesh");
    mesh.shells().swap_remove(0)
}
