//! Partners of the other shells, once the symmetry of the primary shell is known.
//!
//! A companion shell (an eye, a tooth, a shoe) goes where the surface goes that it sits on. There its mirror image must sit:
//! on itself, or on another shell of the same size, with which it swaps; its points then meet what is nearest.

use crate::base::assignment::assignment;
use crate::base::error::Result;
use crate::base::progress::Progress;
use crate::connectivity::automorphism::{ShellColours, only_twins, shell_colours};
use crate::detect::mirror_plane::MirrorPlane;
use crate::detect::twins::{Lookalikes, lookalikes};
use crate::geometry::surface_walk::SurfaceWalk;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::vector::{Vector, dot, mean, squared_norm, subtract};
use crate::mesh::{Mesh, Shell, UnionFind};
use crate::refine::rigid_parts::{Carrier, cluster_motion};
use crate::search::refinement::nearest;
use faer::Mat;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::collections::BTreeMap;

/// Points of a shell that are compared when shells are paired.
const PAIRING_POINTS: usize = 64;
/// Mean distance, in sqrt(area) of the primary shell, from which on two shells are no partners.
pub const FARTHEST: f32 = 0.06;
/// Share of the confidence in what they sit on that is left to partners so far apart.
const LEAST_TRUST: f32 = 0.65;
/// A shell that lies farther from its mirrored place than this part of its own sqrt(area) is not its own image: its twin may be missing.
const BESIDE: f32 = 0.5;
/// Partners of other connectivity whose areas' ratio has a larger natural logarithm lie within this part of the smaller one's sqrt(area): the grip of a sword is
/// not that of a shield.
const ALIKE: f32 = 0.24;
const LARGER: f32 = 0.22;
/// How far apart, in the smaller one's sqrt(area), partners count as whose areas' ratio has a natural logarithm of 1.
const SIZE: f32 = 2.0;
/// Shells whose mirrored places are so near each other, in the smaller one's sqrt(area), are alike, whatever their connectivity.
const IN_PLACE: f32 = 0.02;
/// How far apart, in the smaller one's sqrt(area), partners of other connectivity count where one of the same is near, as of the links of two fingers.
const UNLIKE: f32 = 0.75;
/// Natural logarithm of the largest ratio of two partners' areas.
pub const AREA_TOLERANCE: f64 = 0.3;
/// Most shells that are assigned together.
const MOST_TOGETHER: usize = 300;

/// The map of one companion shell.
#[derive(Debug, Clone)]
pub struct Companion {
    /// The shell that holds its images.
    pub target: usize,
    /// Images of its points, in the target's local numbering.
    pub images: VertexMap,
    /// Mean distance of the pairing, in sqrt(area) of the primary shell, and difference in size: 0 perfect.
    pub mismatch: f32,
}

impl Companion {
    /// How much of the confidence in what it sits on it keeps: all for a perfect pairing.
    pub fn trust(&self) -> f32 {
        1.0 - (1.0 - LEAST_TRUST) * (self.mismatch / FARTHEST).min(1.0)
    }
}

/// What pairing needs to know of the primary shell and its symmetry.
pub struct Primary<'a> {
    /// Its index among the shells.
    pub index: usize,
    /// The shell, or its proxy.
    pub shell: &'a Shell,
    /// Its map.
    pub carrier: Carrier<'a>,
    /// On which side each of its vertices is: negative, positive, or on neither.
    pub odd: Vec<f64>,
}

/// Finds the partner of every shell but the primary; `None` for those that have none.
///
/// `anchors` are those of [`crate::mesh::anchors`], in the numbering of the primary's `shell`.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn find(
    mesh: &Mesh,
    shells: &[Shell],
    anchors: &[Vec<u32>],
    primary: &Primary,
    progress: &Progress,
) -> Result<Vec<Option<Companion>>> {
    let places = Places::new(mesh, shells, anchors, primary, progress)?;
    paired(mesh, shells, &places, primary.index, progress)
}

/// Leaves shells that are their own without a partner where all that are like them are their own, or have none, and one has none: two that are equal go to each other.
pub fn leave_own(mesh: &Mesh, shells: &[Shell], primary: usize, companions: &mut [Option<Companion>]) {
    let is_own = |(own, companion): (usize, &Option<Companion>)| {
        companion.as_ref().is_some_and(|companion| companion.target == own)
    };
    if !companions.iter().enumerate().any(is_own) {
        return;
    }
    for Lookalikes { shells: set, .. } in lookalikes_among(mesh, shells, primary) {
        let target =
            |&own: &usize| companions.get(own).map(|companion| companion.as_ref().map(|of| of.target));
        let is_alone = |own: &usize| target(own) == Some(None);
        let is_own = |own: &usize| target(own) == Some(Some(*own));
        if set.iter().any(is_alone) && set.iter().all(|own| is_alone(own) || is_own(own)) {
            set.iter().for_each(|&own| companions[own] = None);
        }
    }
}

/// Finds partners of [`lookalikes`] that are as yet all without one, however far apart a pose has put them.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn left_over(
    mesh: &Mesh,
    shells: &[Shell],
    anchors: &[Vec<u32>],
    primary: &Primary,
    progress: &Progress,
) -> Result<Vec<Option<Companion>>> {
    let mut sets = lookalikes_among(mesh, shells, primary.index);
    sets.retain(|set| !set.shells.contains(&usize::MAX));
    let mut companions: Vec<Option<Companion>> = shells.iter().map(|_| None).collect();
    if !sets.is_empty() {
        Places::new(mesh, shells, anchors, primary, progress)?.add_left_over(shells, &sets, &mut companions);
    }
    Ok(companions)
}

/// [`lookalikes`] by their places among `shells`; [`usize::MAX`] are those that are not there by themselves.
fn lookalikes_among(mesh: &Mesh, shells: &[Shell], primary: usize) -> Vec<Lookalikes> {
    let mut local = vec![usize::MAX; mesh.shell_count];
    let others = shells.iter().enumerate().filter(|(own, _)| *own != primary);
    others.for_each(|(own, shell)| local[mesh.shell_of_point[shell.points[0] as usize] as usize] = own);
    let mut sets = lookalikes(&Vec::from_iter(&shell_colours(mesh)), &mesh.shells());
    sets.iter_mut().flat_map(|set| &mut set.shells).for_each(|shell| *shell = local[*shell]);
    sets
}

/// The partner of every shell of a mesh with a mirror plane in space; `None` for those that have none.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn by_plane(
    mesh: &Mesh,
    shells: &[Shell],
    plane: &MirrorPlane,
    progress: &Progress,
) -> Result<Vec<Option<Companion>>> {
    let place = |shell: &Shell| shell.points.iter().map(|&point| mesh.positions[point as usize]).collect();
    let own: Vec<Vec<Vector>> = shells.iter().map(place).collect();
    let image = |points: &Vec<Vector>| points.iter().map(|&point| plane.image(point)).collect();
    let odd = |points: &Vec<Vector>| points.iter().map(|&at| dot(plane.normal, at) - plane.offset).sum();
    let sides = own.iter().map(odd).collect();
    let places = Places { mirrored: own.iter().map(image).collect(), own, sides };
    paired(mesh, shells, &places, usize::MAX, progress)
}

fn paired(
    mesh: &Mesh,
    shells: &[Shell],
    places: &Places,
    primary: usize,
    progress: &Progress,
) -> Result<Vec<Option<Companion>>> {
    let mut companions: Vec<Option<Companion>> = shells.iter().map(|_| None).collect();
    for (first, second, mismatch) in pair_shells(mesh, shells, places, primary, progress)? {
        progress.report("other shells", 0.95)?;
        for (source, target) in [(first, second), (second, first)] {
            if companions[source].is_none() {
                let images = match_shells(shells, places, source, target);
                companions[source] = Some(Companion { target, images, mismatch });
            }
        }
    }
    Ok(companions)
}

/// Per shell, in the unit of the primary shell, where each point is, and where its mirror image should be.
struct Places {
    own: Vec<Vec<Vector>>,
    mirrored: Vec<Vec<Vector>>,
    /// On which side of the symmetry the shell is: negative or positive.
    sides: Vec<f64>,
}

impl Places {
    fn new(
        mesh: &Mesh,
        shells: &[Shell],
        anchors: &[Vec<u32>],
        primary: &Primary,
        progress: &Progress,
    ) -> Result<Places> {
        let shell = primary.shell;
        let origin = mesh.positions[shell.points[0] as usize];
        let place = |&point: &u32| -> Vector {
            let position = mesh.positions[point as usize];
            std::array::from_fn(|j| shell.positions[0][j] + shell.scale * (position[j] - origin[j]))
        };
        // The primary itself has no anchors.
        let of_shell =
            |(other, anchors): (&Shell, &Vec<u32>)| other.points[..anchors.len()].iter().map(place).collect();
        let own: Vec<Vec<Vector>> = shells.iter().zip(anchors).map(of_shell).collect();
        let carried = |(points, anchors): (&Vec<Vector>, &Vec<u32>)| primary.carrier.carried(points, anchors);
        let mut mirrored: Vec<Vec<Vector>> = own.iter().zip(anchors).map(carried).collect();
        cluster_motion::settle(&mut mirrored, &own, primary.carrier.kind, progress)?;
        let odd = |anchors: &Vec<u32>| anchors.iter().map(|&at| primary.odd[at as usize]).sum();
        Ok(Places { mirrored, own, sides: anchors.iter().map(odd).collect() })
    }

    /// Pairs shells of each set that are nearer to each other's mirrored place than to their own, or one of which lies in its own, as a hand before the chest does; gloves always.
    fn add_left_over(mut self, shells: &[Shell], sets: &[Lookalikes], companions: &mut [Option<Companion>]) {
        let middles = |of: &[Vec<Vector>]| -> Vec<Vector> {
            of.iter().map(|points| mean(points.iter().copied())).collect()
        };
        let (goals, own) = (middles(&self.mirrored), middles(&self.own));
        let gap = |a: usize, b: usize| squared_norm(subtract(goals[a], own[b])).sqrt();
        let is_own = |a: usize| gap(a, a) < f64::from(FARTHEST);
        let may_be =
            |a: usize, b: usize| gap(a, b) + gap(b, a) < gap(a, a) + gap(b, b) || is_own(a) || is_own(b);
        let pairs_of = |set: &Lookalikes| -> Vec<(usize, usize)> {
            let all = set.shells.iter().flat_map(|&a| set.shells.iter().map(move |&b| (a, b)));
            all.filter(|&(a, b)| a < b && (set.are_gloves || may_be(a, b))).collect()
        };
        let pairs: Vec<(usize, usize)> = sets.iter().flat_map(pairs_of).collect();
        let gaps: Vec<f64> = pairs.iter().map(|&(a, b)| gap(a, b) + gap(b, a)).collect();
        // No pair of them is too far to be one.
        let unit = f64::from(FARTHEST) / gaps.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let options = pairs.into_iter().zip(gaps).map(|(pair, gap)| (pair, (unit * gap) as f32)).collect();
        for (first, second, _) in involution(&options) {
            for (source, target) in [(first, second), (second, first)] {
                let shift = subtract(own[target], goals[source]);
                let moved = self.mirrored[source].iter_mut();
                moved.for_each(|at| (0..3).for_each(|axis| at[axis] += shift[axis]));
                let images = match_shells(shells, &self, source, target);
                companions[source] = Some(Companion { target, images, mismatch: FARTHEST });
            }
        }
    }

    /// Mean distance from where points of `source` should be to the nearest points of `target`.
    fn mismatch(&self, source: usize, target: usize) -> f32 {
        let goals = picked(&self.mirrored[source]);
        let partners = nearest(rows(&goals).as_ref(), rows(&self.own[target]).as_ref());
        let gap = |(goal, partner): (&Vector, u32)| subtract(self.own[target][partner as usize], *goal);
        let distances = goals.iter().zip(partners).map(|pair| squared_norm(gap(pair)).sqrt());
        (distances.sum::<f64>() / goals.len() as f64) as f32
    }
}

/// Shells by their size and place.
struct SimilarShells {
    /// Logarithm of the area of each shell.
    sizes: Vec<f64>,
    /// Middles of the shells whose sizes are from n to n + 1 times the tolerance, by n.
    trees: BTreeMap<i64, RTree<GeomWithData<Vector, usize>>>,
}

impl SimilarShells {
    /// Shells looked at in each tree: of them about a half are of the size that is wanted.
    const LOOKS: usize = 64;
    /// Shells tried as partners of one.
    const TRIED: usize = 8;

    fn new(shells: &[Shell], middles: &[Vector], others: impl Iterator<Item = usize>) -> SimilarShells {
        let sizes: Vec<f64> = shells.iter().map(|shell| shell.area().max(f64::MIN_POSITIVE).ln()).collect();
        let mut leaves: BTreeMap<i64, Vec<_>> = BTreeMap::new();
        for shell in others {
            let leaf = GeomWithData::new(middles[shell], shell);
            leaves.entry(SimilarShells::class(sizes[shell])).or_default().push(leaf);
        }
        let trees = leaves.into_iter().map(|(class, leaves)| (class, RTree::bulk_load(leaves))).collect();
        SimilarShells { sizes, trees }
    }

    /// The natural logarithm of the ratio of two shells' areas.
    fn differ(&self, source: usize, target: usize) -> f64 {
        (self.sizes[source] - self.sizes[target]).abs()
    }

    fn class(size: f64) -> i64 {
        (size / AREA_TOLERANCE).floor() as i64
    }

    /// Shells as large as `source` whose middles are nearest to `place`, the nearest first. O(log shells).
    fn nearest(&self, source: usize, place: Vector) -> impl Iterator<Item = usize> {
        let is_candidate = |target: usize| (self.sizes[source] - self.sizes[target]).abs() < AREA_TOLERANCE;
        let class = SimilarShells::class(self.sizes[source]);
        let mut near: Vec<(f64, usize)> = Vec::new();
        for (_, tree) in self.trees.range(class - 1..=class + 1) {
            let looks = tree.nearest_neighbor_iter(place).take(SimilarShells::LOOKS);
            let wanted = looks.filter(|leaf| is_candidate(leaf.data)).take(2 * SimilarShells::TRIED);
            near.extend(wanted.map(|leaf| (squared_norm(subtract(place, *leaf.geom())), leaf.data)));
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.into_iter().take(SimilarShells::TRIED).map(|(_, target)| target)
    }
}

/// Pairs of shells (equal where a shell mirrors onto itself) with their mismatch.
///
/// Of lashes, feathers or teeth in a row all are assigned together: if each took what is nearest, a map that is off by half their distance would send each to its twin's
/// neighbour; but then one has nobody left at each end of the row.
fn pair_shells(
    mesh: &Mesh,
    shells: &[Shell],
    places: &Places,
    primary: usize,
    progress: &Progress,
) -> Result<Vec<(usize, usize, f32)>> {
    let middles = |of: &[Vec<Vector>]| -> Vec<Vector> {
        of.iter().map(|points| mean(points.iter().copied())).collect()
    };
    let (mirrored, own) = (middles(&places.mirrored), middles(&places.own));
    let others = (0..shells.len()).filter(|&shell| shell != primary);
    let similar = SimilarShells::new(shells, &own, others.clone());
    let colours = shell_colours(mesh);
    let of_shell = |shell: usize| &colours[mesh.shell_of_point[shells[shell].points[0] as usize] as usize];
    let mut options: BTreeMap<(usize, usize), f32> = BTreeMap::new();
    for source in others {
        progress.report("other shells", 0.95)?;
        let of = |target: usize| {
            let gap = 0.5 * (places.mismatch(source, target) + places.mismatch(target, source));
            let differ = similar.differ(source, target) as f32;
            let size = shells[source].area().min(shells[target].area()).sqrt() as f32;
            let is_same = gap < IN_PLACE * size || of_shell(target).are_like(of_shell(source));
            let is_beside = target == source && gap > BESIDE * size;
            let is_other = differ > ALIKE && gap > LARGER * size && !is_same;
            let is_near = gap.hypot(FARTHEST * differ / AREA_TOLERANCE as f32) < FARTHEST;
            let mismatch = gap.hypot(SIZE * size * differ);
            (is_near && !is_beside && !is_other).then_some((target, mismatch, (!is_same).then_some(size)))
        };
        let near: Vec<(usize, f32, Option<f32>)> =
            similar.nearest(source, mirrored[source]).filter_map(of).collect();
        let any_same = near.iter().any(|&(target, _, unlike)| target != source && unlike.is_none());
        for (target, mismatch, unlike) in near {
            let apart = if any_same { UNLIKE * unlike.unwrap_or(0.0) } else { 0.0 };
            let worst = options.entry((source.min(target), source.max(target))).or_default();
            *worst = worst.max(mismatch.hypot(apart));
        }
    }
    let mut pairs = involution(&options);
    let colours: Vec<&ShellColours> = (0..shells.len()).map(of_shell).collect();
    keep_only_twins(&mut pairs, &colours, |own, twin| {
        let size = shells[own].area().min(shells[twin].area()).sqrt() as f32;
        let are_others = own != primary && twin != primary;
        let are_across = places.sides[own] * places.sides[twin] <= 0.0;
        let are_alike = are_across && similar.differ(own, twin) < AREA_TOLERANCE;
        let may_be = are_others && (are_alike || colours[own].are_gloves(colours[twin]));
        may_be.then_some(IN_PLACE * size)
    });
    Ok(pairs)
}

/// Pairs the only two of their connectivity, though one may be posed apart from the surface that it sits on, or have a neighbour of its twin nearer; not two that are
/// their own images, nor one that lies nearer to its partner than what two that may be twins say is `in_place`: two pouches on one hip may not. Gloves are always.
fn keep_only_twins(
    pairs: &mut Vec<(usize, usize, f32)>,
    colours: &[&ShellColours],
    in_place: impl Fn(usize, usize) -> Option<f32>,
) {
    let mut partner = vec![None; colours.len()];
    for &(a, b, mismatch) in pairs.iter() {
        (partner[a], partner[b]) = (Some((b, mismatch)), Some((a, mismatch)));
    }
    for [own, twin] in only_twins(colours) {
        let are_gloves = colours[own].are_gloves(colours[twin]);
        let Some(least) = in_place(own, twin) else { continue };
        let goes = |shell: usize| partner[shell].map(|(partner, _)| partner);
        let is_placed = |shell: usize| partner[shell].is_some_and(|(_, mismatch)| mismatch < least);
        let are_own = goes(own) == Some(own) && goes(twin) == Some(twin);
        let may_be = are_gloves || !are_own && !is_placed(own) && !is_placed(twin);
        if goes(own) != Some(twin) && may_be {
            pairs.retain(|(a, b, _)| ![own, twin].contains(a) && ![own, twin].contains(b));
            pairs.push((own, twin, FARTHEST));
        }
    }
}

/// The involution whose pairs are of least mismatch in all, squared, where a shell without a partner counts as the farthest: by swarms, the shells that
/// [`pair_shells`] may pair with each other, directly or over others.
fn involution(options: &BTreeMap<(usize, usize), f32>) -> Vec<(usize, usize, f32)> {
    let last = options.keys().map(|&(_, second)| second + 1).max().unwrap_or(0);
    let mut sets = UnionFind::new(last);
    options.keys().for_each(|&(first, second)| sets.join(first as u32, second as u32));
    let mut swarms: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for shell in options.keys().flat_map(|&(first, second)| [first, second]) {
        swarms.entry(sets.find(shell as u32)).or_default().push(shell);
    }
    let mut pairs = Vec::new();
    let mut taken = vec![false; last];
    for mut swarm in swarms.into_values() {
        swarm.sort_unstable();
        swarm.dedup();
        if swarm.len() > MOST_TOGETHER {
            continue;
        }
        let within = |a: usize, b: usize| options.get(&(a.min(b), a.max(b))).copied();
        let partners = assigned(swarm.len(), |i, j| within(swarm[i], swarm[j]));
        for (i, &j) in partners.iter().enumerate().filter(|(i, j)| **j < swarm.len() && *i <= **j) {
            if partners[j] == i
                && let Some(mismatch) = within(swarm[i], swarm[j])
            {
                (taken[swarm[i]], taken[swarm[j]]) = (true, true);
                pairs.push((swarm[i], swarm[j], mismatch));
            }
        }
    }
    // What was sent around in a ring, and larger swarms, the best first.
    let mut left: Vec<(f32, usize, usize)> =
        options.iter().map(|(&(first, second), &mismatch)| (mismatch, first, second)).collect();
    left.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    for (mismatch, first, second) in left {
        if !taken[first] && !taken[second] {
            (taken[first], taken[second]) = (true, true);
            pairs.push((first, second, mismatch));
        }
    }
    pairs.sort_by(|a, b| a.2.total_cmp(&b.2).then((a.0, a.1).cmp(&(b.0, b.1))));
    pairs
}

/// For each of `count` its partner, or a number from `count` on if it has none. O(count^3).
fn assigned(count: usize, mismatch: impl Fn(usize, usize) -> Option<f32>) -> Vec<usize> {
    let square = |mismatch: f32| f64::from(mismatch).powi(2);
    let farthest = square(FARTHEST);
    assignment(count, 2 * count, |i, j| match j < count {
        true => mismatch(i, j).map_or(4.0 * farthest, square),
        false => farthest,
    })
}

/// Images of the points of `source` on `target`: the nearest points to where they should be.
fn match_shells(shells: &[Shell], places: &Places, source: usize, target: usize) -> VertexMap {
    let walk = SurfaceWalk::new(&places.own[target], &shells[target].triangles);
    let leaves = places.own[target].iter().copied().zip(0..);
    let tree = RTree::bulk_load(leaves.map(|(at, local)| GeomWithData::new(at, local)).collect());
    let image = |goal: &Vector| {
        let start: u32 = tree.nearest_neighbor(*goal).expect("a shell has points").data;
        walk.nearest(*goal, start)
    };
    let (partners, points) = places.mirrored[source].iter().map(image).unzip();
    VertexMap { partners, points }
}

/// Some of the points.
fn picked(points: &[Vector]) -> Vec<Vector> {
    points.iter().step_by(points.len().div_ceil(PAIRING_POINTS).max(1)).copied().collect()
}

fn rows(points: &[Vector]) -> Mat<f32> {
    Mat::from_fn(points.len(), 3, |i, j| points[i][j] as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::PolygonMesh;

    /// Blocks: the lowest corner, the size, and by a bit a side along which diagonal that is cut.
    fn blocks(of: &[([f64; 3], f64, u32)]) -> Mesh {
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mut polygons = PolygonMesh { face_offsets: vec![0], ..PolygonMesh::default() };
        for (block, &(middle, size, cuts)) in of.iter().enumerate() {
            let corner =
                |corner: u32| std::array::from_fn(|axis| middle[axis] + size * f64::from(corner >> axis & 1));
            polygons.positions.extend((0..8).map(corner));
            for (side, corners) in sides.iter().enumerate() {
                let [a, b, c, d] = corners.map(|corner| 8 * block as u32 + corner);
                let cut = if cuts >> side & 1 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                for triangle in cut {
                    polygons.face_vertices.extend(triangle);
                    polygons.face_offsets.push(polygons.face_vertices.len() as u32);
                }
            }
        }
        Mesh::new(&polygons, &Limits::default()).expect("a usable mesh")
    }

    /// The block that each block goes to, by the plane between the sides.
    fn targets(mesh: &Mesh, count: usize) -> Vec<Option<usize>> {
        let shells = mesh.shells();
        let plane = MirrorPlane { normal: [1.0, 0.0, 0.0], offset: -mesh.centre[0] / mesh.unit_length };
        let found = by_plane(mesh, &shells, &plane, &Progress::default()).expect("an answer");
        let shell = |block: usize| mesh.shell_of_point[mesh.point_of_vertex[8 * block] as usize] as usize;
        let block = |target: usize| (0..count).find(|&block| shell(block) == target).expect("a block");
        (0..count).map(|own| found[shell(own)].as_ref().map(|companion| block(companion.target))).collect()
    }

    #[test]
    fn a_wheel_goes_across_though_only_the_one_behind_it_is_cut_alike() {
        let wheel = |x: f64, y: f64, cuts| ([x, y, 0.0], 1.0, cuts);
        let mesh =
            blocks(&[wheel(-3.0, 0.0, 0), wheel(-3.0, 4.0, 0), wheel(2.0, 0.0, 7), wheel(2.0, 4.0, 7)]);
        assert_eq!(targets(&mesh, 4), [Some(2), Some(3), Some(0), Some(1)]);
    }

    #[test]
    fn an_arm_in_a_bracer_is_the_partner_of_one_without() {
        let mesh =
            blocks(&[([-2.0, 0.0, 0.0], 1.0, 0), ([0.9, 0.0, 0.0], 1.1, 7), ([-3.0, 6.0, 0.0], 6.0, 0)]);
        assert_eq!(targets(&mesh, 3)[..2], [Some(1), Some(0)]);
    }

    #[test]
    fn a_link_of_a_finger_goes_to_the_one_of_its_connectivity_though_another_lies_nearer() {
        let link = |x: f64, y: f64, cuts| ([x, y, 0.0], 1.0, cuts);
        let mesh = blocks(&[link(-3.0, 0.0, 0), link(2.0, 0.2, 0), link(2.0, -0.1, 7)]);
        assert_eq!(targets(&mesh, 3), [Some(1), Some(0), None]);
    }

    #[test]
    fn the_only_two_of_a_connectivity_are_partners_though_one_lies_elsewhere() {
        let mesh = blocks(&[
            ([-20.0, 0.0, 2.0], 40.0, 0),
            // Mirrors of each other, far from where they should be.
            ([-11.0, 0.0, 0.0], 1.0, 5),
            ([4.0, 9.0, 0.0], 1.0, 10),
            // Nothing like them, beside where the second should be.
            ([10.2, 0.1, 0.0], 1.0, 0),
        ]);
        assert_eq!(targets(&mesh, 4)[1..], [Some(2), Some(1), None]);
    }

    #[test]
    fn the_only_two_of_a_connectivity_on_one_side_are_no_partners() {
        let mesh =
            blocks(&[([-20.0, 0.0, 2.0], 40.0, 0), ([-11.0, 0.0, 0.0], 1.0, 5), ([-4.0, 9.0, 0.0], 1.0, 10)]);
        assert_eq!(targets(&mesh, 3)[1..], [None, None]);
    }

    #[test]
    fn gloves_are_partners_though_each_lies_in_its_own_place_and_other_twins_are_not() {
        let mesh = crate::detect::twins::tests::sheets(&[(false, 1.0), (true, 2.0)]);
        let boxes = blocks(&[([-1.0, 0.0, 0.0], 1.0, 0), ([4.0, 0.0, 0.0], 1.0, 0)]);
        for (mesh, kept) in [(mesh, vec![(0, 1, FARTHEST)]), (boxes, vec![(0, 0, 0.0), (1, 1, 0.0)])] {
            let colours = shell_colours(&mesh);
            let mut pairs = vec![(0, 0, 0.0), (1, 1, 0.0)];
            keep_only_twins(&mut pairs, &colours.iter().collect::<Vec<_>>(), |_, _| Some(0.1));
            assert_eq!(pairs, kept);
        }
    }

    /// Where boxes that a pose has put apart go: those of the shells, by whether a first search has found them to be their own.
    fn left_over_targets(mesh: &Mesh, count: usize, found: &[(usize, usize)]) -> Vec<Option<usize>> {
        let shells = mesh.shells();
        let shell = |block: usize| mesh.shell_of_point[mesh.point_of_vertex[8 * block] as usize] as usize;
        let block = |target: usize| (0..count).find(|&block| shell(block) == target).expect("a block");
        let map = |&(own, target): &(usize, usize)| {
            let images = VertexMap::at_vertices(&shells[shell(own)].triangles, (0..8).collect());
            (shell(own), Companion { target: shell(target), images, mismatch: 0.0 })
        };
        let mut companions: Vec<Option<Companion>> = vec![None; count];
        found.iter().map(map).for_each(|(own, companion)| companions[own] = Some(companion));
        leave_own(mesh, &shells, shell(0), &mut companions);
        let place = |shell: &Shell| shell.points.iter().map(|&at| mesh.positions[at as usize]).collect();
        let own: Vec<Vec<Vector>> = shells.iter().map(place).collect();
        let middle = -mesh.centre[0] / mesh.unit_length;
        let image = |points: &Vec<Vector>| points.iter().map(|&[x, y, z]| [2.0 * middle - x, y, z]).collect();
        let places = Places { mirrored: own.iter().map(image).collect(), own, sides: vec![0.0; count] };
        let mut sets = lookalikes_among(mesh, &shells, shell(0));
        sets.retain(|set| set.shells.iter().all(|&own| own != usize::MAX && companions[own].is_none()));
        places.add_left_over(&shells, &sets, &mut companions);
        let target = |own: usize| companions[shell(own)].as_ref().map(|companion| block(companion.target));
        (0..count).map(target).collect()
    }

    #[test]
    fn equal_shells_that_are_left_over_go_across_and_two_on_one_side_stay_alone() {
        let trunk = ([-20.0, 0.0, 2.0], 40.0, 0);
        // Four legs, each on its own in a stride, and two pouches on one hip.
        let leg = |x: f64, y: f64| ([x, y, 0.0], 1.0, 0);
        let pouch = |y: f64| ([9.0, y, 9.0], 2.0, 0);
        let mesh = blocks(&[
            trunk,
            leg(-11.0, 0.0),
            leg(10.0, 4.0),
            leg(-11.0, 20.0),
            leg(10.0, 26.0),
            pouch(0.0),
            pouch(8.0),
        ]);
        let expected = [None, Some(2), Some(1), Some(4), Some(3), None, None];
        assert_eq!(left_over_targets(&mesh, 7, &[]), expected);
    }

    #[test]
    fn a_hand_before_the_chest_is_not_its_own_if_the_other_has_no_partner() {
        let trunk = ([-20.0, 0.0, 2.0], 40.0, 0);
        let hand = |x: f64, y: f64| ([x, y, 0.0], 1.0, 0);
        let mesh = blocks(&[trunk, hand(-0.5, 0.0), hand(30.0, 9.0)]);
        assert_eq!(left_over_targets(&mesh, 3, &[(1, 1)]), [None, Some(2), Some(1)]);
        // Two buttons, both of them their own.
        let mesh = blocks(&[trunk, hand(-0.5, 0.0), hand(-0.5, 9.0)]);
        assert_eq!(left_over_targets(&mesh, 3, &[(1, 1), (2, 2)]), [None, Some(1), Some(2)]);
    }

    #[test]
    fn what_lies_at_the_mirrored_place_is_the_partner_though_one_beside_it_is_cut_alike() {
        let knob = |x: f64, y: f64, cuts| ([x, y, 0.0], 1.0, cuts);
        let stove = ([-20.0, 0.0, 2.0], 40.0, 0);
        let mesh = blocks(&[
            knob(-11.0, 0.0, 0),
            knob(-11.0, 1.5, 7),
            knob(10.0, 0.0, 7),
            knob(10.0, 1.5, 0),
            stove,
        ]);
        assert_eq!(targets(&mesh, 5), [Some(2), Some(3), Some(0), Some(1), Some(4)]);
    }
}
