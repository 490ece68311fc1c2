//! Parts of a shell that have no counterpart: a sword in one hand, a bag on it, the forearm whose twin is cut off.
//!
//! Such a part bends the eigenfunctions of the whole surface, and the map with them. Shortest paths between other places hardly know of it. So parts
//! are guessed from these, and the symmetry is sought again on the rest: a part and its map are found in turn, as partial functional maps do (E. Rodola,
//! L. Cosmo, M. Bronstein, A. Torsello, D. Cremers, "Partial Functional Correspondence", 2017). The guesses are ours.

use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::detect::correspondence::Symmetry;
use crate::detect::coverage::partner_point;
use crate::detect::proxy::{Proxy, TOO_FINE};
use crate::geometry::adjacency::nearest_seeds;
use crate::geometry::shortest_paths::EdgeLengths;
use crate::geometry::surface_walk::SurfaceWalk;
use crate::mesh::vector::{point_areas, quantile, triangle_area};
use crate::mesh::{Mesh, NONE, Shell, partition};
use crate::search::extrema_starts::extrema;
use crate::spectral::sampling::area_weighted_vertices;

/// Vertices of the surface along which distances are measured.
const COARSE: usize = 1000;
/// Places that are looked at, and those from which their distances are measured.
const PLACES: usize = 250;
const ANCHORS: usize = 24;
/// Two distances are compared by their difference over their sum and this length, in sqrt(area); at most by the second.
const SHORT: f64 = 0.15;
const MOST: f64 = 0.4;
/// Anchors that differ by this from the others hardly count, once they have lost their weight in some rounds.
const DIFFERENT: f64 = 0.12;
const ROUNDS: usize = 10;
/// A place that differs by less from its image is not looked at.
const AGREES: f64 = 0.04;
/// A place sticks out if it does by this length, in sqrt(area), and differs so much less from an image that is nearer.
const LENGTH: f64 = 0.06;
const GAIN: f64 = 0.01;
/// Limbs may be twins if one is longer by a length that is the same from all other ends but for this, in sqrt(area).
const ALIKE: f64 = 0.035;
/// Most limbs that are shortened.
const LIMBS: usize = 2;
/// Rings of vertices around a defect that a pairing leaves out, though they have counterparts.
const RINGS: usize = 3;
/// Pieces that a pairing leaves out on both sides are counterparts if one has at least this share of the area of the other.
const ALIKE_AREA: f64 = 0.2;
/// Least area of a part, and least of the rest, by their share of the shell.
const LEAST: f64 = 0.01;
const REST: f64 = 0.5;

/// Guesses of what is left of a shell without its parts that have no counterpart.
pub struct Excess<'a> {
    /// The shell; the searched one begins with its vertices.
    shell: &'a Shell,
    /// The solved shell, and the searched one's vertices there if it is a proxy.
    solved: &'a Shell,
    proxy: Option<&'a Proxy<'a>>,
    /// A coarse shell of that.
    coarse: Option<Proxy<'a>>,
}

impl<'a> Excess<'a> {
    /// Of a shell that was searched, its holes filled or not, on a `proxy` if there is one. O(vertices log vertices) of what was solved.
    pub fn of(shell: &'a Shell, searched: &'a Shell, proxy: Option<&'a Proxy<'a>>) -> Excess<'a> {
        let solved = proxy.map_or(searched, |proxy| &proxy.shell);
        Excess { shell, solved, proxy, coarse: Proxy::new(solved, COARSE, 1) }
    }

    /// The shell without its places that stick out under a `symmetry` of the mesh; then, if `limbs` are asked for, each time without the end of one that may be longer than its twin.
    ///
    /// A place sticks out if its distances from many others agree with those of no image, but with those of one that is nearer to all by one
    /// length. Some 60 searches over 1,000 vertices.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`], [`crate::Error::TimeLimit`].
    pub fn rests(
        &self,
        mesh: &Mesh,
        symmetry: Option<&Symmetry>,
        limbs: bool,
        progress: &Progress,
    ) -> Result<Vec<Shell>> {
        progress.report("parts without a counterpart", 0.985)?;
        let coarse = self.coarse.as_ref().map_or(self.solved, |coarse| &coarse.shell);
        // What cannot be simplified is left whole.
        if coarse.points.len() > TOO_FINE * COARSE {
            return Ok(Vec::new());
        }
        // Nothing sticks out where all are their own images.
        let image = |(own, &point): (usize, &u32)| match symmetry {
            None => Some(own),
            Some(symmetry) => {
                let vertex = mesh.vertex_of_point.get(point as usize)?;
                let image = partner_point(mesh, symmetry.partner[*vertex as usize]);
                Some(self.coarse_vertex(self.shell.points.binary_search(&image).ok()?))
            }
        };
        let images: Vec<Option<usize>> = coarse.points.iter().enumerate().map(image).collect();
        let walk = SurfaceWalk::new(&coarse.positions, &coarse.triangles);
        let edges = EdgeLengths::of_walk(&walk, &coarse.positions);
        let Some(distances) = Distances::new(coarse, &edges, &images) else { return Ok(Vec::new()) };
        let mut parts = vec![distances.sticking_out(&walk, &images, progress)?];
        if limbs {
            parts.extend(longer_limbs(&edges, &distances.averages()));
        }
        Ok(parts.iter().filter_map(|part| self.without(part)).collect())
    }

    /// That beside a vertex of the shell.
    fn coarse_vertex(&self, own: usize) -> usize {
        [self.proxy, self.coarse.as_ref()]
            .into_iter()
            .flatten()
            .fold(own, |vertex, proxy| proxy.nearest_by_edges()[vertex] as usize)
    }

    /// The rest of the shell without what `is_part`.
    fn without(&self, is_part: &[bool]) -> Option<Shell> {
        let are_large =
            |pieces: &[Vec<u32>]| pieces.iter().map(|piece| area(self.shell, piece) >= LEAST).collect();
        rest(self.shell, |own| is_part[self.coarse_vertex(own)], are_large)
    }
}

/// What is left of a shell without the parts whose vertices a pairing by connectivity leaves out. Around a defect a few rings are left out, and where two
/// counterparts are triangulated otherwise both are: these stay.
pub fn paired_rest(shell: &Shell, partner: &[u32]) -> Option<Shell> {
    let is_left_out: Vec<bool> = shell.points.iter().map(|&point| partner[point as usize] == NONE).collect();
    let mut is_deep = is_left_out.clone();
    for _ in 0..RINGS {
        let before = is_deep.clone();
        for triangle in &shell.triangles {
            if triangle.iter().any(|&corner| !before[corner as usize]) {
                triangle.iter().for_each(|&corner| is_deep[corner as usize] = false);
            }
        }
    }
    let corners =
        |piece: &[u32]| -> Vec<u32> { piece.iter().flat_map(|&own| shell.triangles[own as usize]).collect() };
    let goes = |pieces: &[Vec<u32>]| -> Vec<bool> {
        let mut piece_of = vec![NONE; is_left_out.len()];
        for (piece, index) in pieces.iter().zip(0..) {
            corners(piece).into_iter().for_each(|corner| piece_of[corner as usize] = index);
        }
        // The piece that most of the border goes to.
        let counterpart = |piece: &[u32]| {
            let mut counts = vec![0; pieces.len()];
            for corner in corners(piece).into_iter().filter(|&corner| !is_left_out[corner as usize]) {
                let image = shell.points.binary_search(&partner[shell.points[corner as usize] as usize]);
                let there = image.map_or(NONE, |image| piece_of[image]);
                if there != NONE {
                    counts[there as usize] += 1;
                }
            }
            (0..pieces.len()).filter(|&index| counts[index] > 0).max_by_key(|&index| counts[index])
        };
        let has_counterpart = |piece: &[u32]| {
            let ratio = |other: usize| area(shell, &pieces[other]) / area(shell, piece);
            counterpart(piece).is_some_and(|other| (ALIKE_AREA..ALIKE_AREA.recip()).contains(&ratio(other)))
        };
        let is_deep = |piece: &[u32]| corners(piece).into_iter().any(|corner| is_deep[corner as usize]);
        pieces.iter().map(|piece| is_deep(piece) && !has_counterpart(piece)).collect()
    };
    rest(shell, |own| is_left_out[own], goes)
}

/// The largest connected rest of a shell without the pieces of what `is_part` that go; `None` if none goes, or too much.
fn rest(
    shell: &Shell,
    is_part: impl Fn(usize) -> bool,
    goes: impl Fn(&[Vec<u32>]) -> Vec<bool>,
) -> Option<Shell> {
    let triangles = &shell.triangles;
    let touches = |own: &u32| triangles[*own as usize].iter().any(|&at| is_part(at as usize));
    let (parts, mut kept): (Vec<u32>, Vec<u32>) = (0..triangles.len() as u32).partition(touches);
    let pieces = connected(shell, parts);
    let goes = goes(&pieces);
    kept.extend(pieces.iter().zip(&goes).filter(|(_, goes)| !**goes).flat_map(|(piece, _)| piece));
    kept.sort_unstable();
    let rest = connected(shell, kept).into_iter().next().filter(|rest| area(shell, rest) >= REST)?;
    if !goes.contains(&true) {
        return None;
    }
    let corners: Vec<[u32; 3]> = rest.iter().map(|&own| triangles[own as usize]).collect();
    let triangle_of_local = rest.iter().map(|&own| shell.triangle_of_local[own as usize]).collect();
    Some(Shell { triangle_of_local, ..shell.with_triangles(&corners).0 })
}

/// The area of some triangles of a shell.
fn area(shell: &Shell, triangles: &[u32]) -> f64 {
    let corners =
        triangles.iter().map(|&own| shell.triangles[own as usize].map(|at| shell.positions[at as usize]));
    corners.map(|[a, b, c]| triangle_area(a, b, c)).sum()
}

/// The connected pieces of some triangles of a shell, by falling area.
fn connected(shell: &Shell, triangles: Vec<u32>) -> Vec<Vec<u32>> {
    let corners: Vec<[u32; 3]> = triangles.iter().map(|&own| shell.triangles[own as usize]).collect();
    let pieces = partition(&corners, &shell.positions);
    let mut found = vec![Vec::new(); pieces.count];
    for (own, [corner, ..]) in triangles.into_iter().zip(corners) {
        found[pieces.shell_of_point[corner as usize] as usize].push(own);
    }
    found
}

/// Distances of a surface's vertices from anchors, and from the images of these.
struct Distances {
    places: Vec<usize>,
    from_anchors: Vec<Vec<f64>>,
    from_images: Vec<Vec<f64>>,
    /// How well each anchor agrees with the others; they sum to 1.
    weights: Vec<f64>,
}

impl Distances {
    /// From places that have `images`, each the farthest from those before it. `None` if there are too few.
    fn new(shell: &Shell, edges: &EdgeLengths, images: &[Option<usize>]) -> Option<Distances> {
        let mut places = area_weighted_vertices(&point_areas(&shell.positions, &shell.triangles), PLACES);
        places.dedup();
        let from = |vertex: usize| edges.distances(&[vertex as u32]);
        let (mut anchors, mut from_anchors, mut from_images) = (Vec::new(), Vec::new(), Vec::new());
        let mut nearest = vec![f64::MAX; images.len()];
        while anchors.len() < ANCHORS {
            let wanted = |place: &&usize| images[**place].is_some() && nearest[**place] > 0.0;
            let &farthest =
                places.iter().filter(wanted).max_by(|&&a, &&b| nearest[a].total_cmp(&nearest[b]))?;
            let image = images[farthest]?;
            from_anchors.push(from(farthest));
            from_images.push(from(image));
            anchors.push((farthest, image));
            nearest.iter_mut().zip(&from_anchors[anchors.len() - 1]).for_each(|(a, b)| *a = a.min(*b));
        }
        let mut all =
            Distances { places, from_anchors, from_images, weights: vec![1.0 / ANCHORS as f64; ANCHORS] };
        for _ in 0..ROUNDS {
            let weight = |&(anchor, image): &(usize, usize)| {
                (-(all.difference(anchor, image, 0.0) / DIFFERENT).powi(2)).exp()
            };
            let weights: Vec<f64> = anchors.iter().map(weight).collect();
            let sum: f64 = weights.iter().sum();
            all.weights = weights.into_iter().map(|weight| weight / sum).collect();
        }
        Some(all)
    }

    /// Mean distance of each vertex from the anchors.
    fn averages(&self) -> Vec<f64> {
        let sum = |vertex: usize| self.from_anchors.iter().map(|from| from[vertex]).sum::<f64>();
        (0..self.from_anchors[0].len()).map(|vertex| sum(vertex) / ANCHORS as f64).collect()
    }

    /// Distances of a place from the anchors beside those of an image from their images, with the anchors' weights.
    fn pairs(&self, place: usize, image: usize) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        (0..ANCHORS).map(move |k| (self.from_anchors[k][place], self.from_images[k][image], self.weights[k]))
    }

    /// How much a place differs from an image that is `nearer` to everything by that length.
    fn difference(&self, place: usize, image: usize, nearer: f64) -> f64 {
        let of = |(own, other, weight): (f64, f64, f64)| {
            weight * ((own - other - nearer).abs() / (own + other + SHORT)).min(MOST)
        };
        self.pairs(place, image).map(of).sum()
    }

    /// By how much an image is nearer: the weighted median, at least 0.
    fn nearer(&self, place: usize, image: usize) -> f64 {
        let mut lengths: Vec<(f64, f64)> =
            self.pairs(place, image).map(|(own, other, weight)| (own - other, weight)).collect();
        lengths.sort_by(|a, b| a.0.total_cmp(&b.0));
        quantile(&lengths, 0.5).map_or(0.0, |length| length.max(0.0))
    }

    /// Whether the place beside each vertex sticks out.
    fn sticking_out(
        &self,
        walk: &SurfaceWalk,
        images: &[Option<usize>],
        progress: &Progress,
    ) -> Result<Vec<bool>> {
        let sticks_out = |&place: &usize| -> Result<bool> {
            progress.check()?;
            if images[place].is_none_or(|image| self.difference(place, image, 0.0) < AGREES) {
                return Ok(false);
            }
            let as_far = self.places.iter().map(|&image| self.difference(place, image, 0.0));
            let least = as_far.fold(f64::MAX, f64::min);
            let nearer = self.places.iter().map(|&image| {
                let length = self.nearer(place, image);
                (self.difference(place, image, length), length)
            });
            let best = nearer.min_by(|a, b| a.0.total_cmp(&b.0));
            Ok(best.is_some_and(|(difference, length)| length > LENGTH && difference < least - GAIN))
        };
        let of_places: Vec<bool> = self.places.iter().map(sticks_out).collect::<Result<_>>()?;
        let seeds: Vec<u32> = self.places.iter().map(|&place| place as u32).collect();
        let nearest = nearest_seeds(images.len(), &seeds, |vertex| walk.around(vertex));
        Ok(nearest.into_iter().map(|place| place != NONE && of_places[place as usize]).collect())
    }
}

/// The ends by which limbs are longer than others that may be their twins, first those that are longer by more than they misfit.
///
/// Two limbs may be twins if their tips' distances from all other tips differ by one length, and no other tip is like either.
fn longer_limbs(edges: &EdgeLengths, averages: &[f64]) -> Vec<Vec<bool>> {
    let tips = extrema(edges, averages);
    let from: Vec<Vec<f64>> = tips.iter().map(|&tip| edges.distances(&[tip])).collect();
    let others = |a: usize, b: usize| {
        let others = (0..tips.len()).filter(move |&k| k != a && k != b);
        sorted(others.map(|k| from[a][tips[k] as usize]))
    };
    // By how much the first is longer than the second, and how much that differs between the others.
    let longer = |a: usize, b: usize| {
        let lengths = sorted(others(a, b).into_iter().zip(others(b, a)).map(|(own, other)| own - other));
        let middle = lengths.len() / 2;
        let length = if lengths.len() % 2 == 1 {
            lengths[middle]
        } else {
            0.5 * (lengths[middle - 1] + lengths[middle])
        };
        let misfit = lengths.iter().map(|other| (other - length).abs()).sum::<f64>() / lengths.len() as f64;
        (length, misfit)
    };
    let count = tips.len();
    if count < 4 {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (a, b) in (0..count).flat_map(|a| (0..count).map(move |b| (a, b))).filter(|(a, b)| a != b) {
        let (length, misfit) = longer(a, b);
        let is_twin = |a: usize, b: usize| {
            let (length, misfit) = longer(a, b);
            length.abs() < LENGTH && misfit < ALIKE
        };
        let has_other = || (0..count).any(|k| k != a && k != b && (is_twin(a, k) || is_twin(b, k)));
        if length > LENGTH && misfit < ALIKE && length < from[a][tips[b] as usize] && !has_other() {
            found.push((misfit / length, a, length));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let end = |(_, own, length): (f64, usize, f64)| from[own].iter().map(|&away| away < length).collect();
    found.into_iter().take(LIMBS).map(end).collect()
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}
