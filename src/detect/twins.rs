//! Which shells may be mirror images of which, before anything is solved: by their connectivity, their size and how far they are from each other.
//!
//! Two shells whose points see each other's mirror image around them, of one size, are twins, hardly by chance. Others may be if they are similar in size, the only two of their numbers also if a pose has changed that. Twins are as far from the twins of others as
//! these are from each other, along the surface: so a sword in one hand, which would be its own mirror image by itself, has none. The involution of the
//! shells that is worth most is sought by single changes, from each of the pairs of a shell that may have several twins.

use crate::connectivity::automorphism::{MANY, ShellColours, only_twins};
use crate::detect::companions::AREA_TOLERANCE;
use crate::mesh::vector::{Vector, dot};
use crate::mesh::{NONE, Shell};
use std::collections::HashMap;

/// What speaks for two shells of one size, where 1 speaks for a shell that is its own image, and by which part more if all their points see each other's mirror image.
const SAME_SIZE: f64 = 2.0;
const DISTINCT: f64 = 0.75;
/// How much less speaks for a shell that is its own image if another is of its size.
const LESS_BESIDE_SIZE: f64 = 0.4;
/// Natural logarithms of ratios of two shells' lengths by area and by extent at which these count as one size by 1 / e. A limb that is bent in one
/// of two twins changes its extent: where the connectivity tells points apart it says nothing, and areas may differ twice as much.
const TOLERANCES: [f64; 2] = [0.045, 0.1];
/// The same by area of shells that are alike to the last, as twins are that were mirrored, and feathers of one wing are not: others are half as similar.
const CLOSE: f64 = 0.016;
/// The same by area of the only two shells of as many points and triangles: a pose that bends a shell changes its area.
const ONLY_COUNTS: f64 = 0.09;
/// How similar twins are that are known, whatever their size, where 1 is the most of others.
const CERTAIN: f64 = 4.0;
/// A change of a distance, in sqrt(area), from which on two pairs exclude each other, and what speaks against a pair that excludes all others.
const APART: f64 = 0.22;
const EXCLUDED: f64 = 3.5;
/// Distance, in sqrt(area), at which another shell says 1 / e of what one nearby does.
const NEARBY: f64 = 0.17;
/// How much the areas of two shells differ that are next to each other among those of one size.
const ONE_SIZE: f64 = 0.01;
/// Pairs of one shell from which twins are sought.
const MOST_STARTS: usize = 12;

/// The likely twin of each shell, itself, or [`NONE`]. `distances` are those of shells, row by row; of pairs that are `known`, the lower number first, it is said whether they
/// are twins. O(shells^3) a change, as many as shells, from each start.
pub fn likely(
    colours: &[&ShellColours],
    shells: &[Shell],
    distances: &[f64],
    known: &HashMap<[usize; 2], bool>,
) -> Vec<u32> {
    let sizes: Vec<[f64; 2]> = shells.iter().map(sizes).collect();
    let weights: Vec<f64> = sizes.iter().map(|size| size[0]).collect();
    let count = shells.len();
    let evidence = evidence(colours, shells, &sizes, known);
    let nearness: Vec<f64> = distances.iter().map(|distance| (-distance / NEARBY).exp()).collect();
    let around = |a: usize| (0..count).map(|b| nearness[a * count + b] * weights[b]).sum::<f64>();
    let around = (0..count).map(around).collect();
    let twins = vec![NONE; count];
    Involution { evidence, weights, distances, nearness, around, twins }.settled()
}

/// Shells that are equal, or each other's mirror image.
#[derive(Debug, Clone, PartialEq)]
pub struct Lookalikes {
    /// Two, or another even number.
    pub shells: Vec<usize>,
    /// Whether they are a thing and its mirror image, which it is not itself, as gloves are.
    pub are_gloves: bool,
}

/// Sets of an even number of shells that have as many points and triangles, and one size; and the only two of a connectivity, whose size a pose may change.
pub fn lookalikes(colours: &[&ShellColours], shells: &[Shell]) -> Vec<Lookalikes> {
    let counts = |shell: usize| counts(&shells[shell]);
    let differ = |a: usize, b: usize| (shells[b].area() / shells[a].area()).ln().abs();
    let mut order: Vec<usize> = (0..shells.len()).collect();
    order.sort_by(|&a, &b| counts(a).cmp(&counts(b)).then(shells[a].area().total_cmp(&shells[b].area())));
    let are_alike = |&a: &usize, &b: &usize| counts(a) == counts(b) && differ(a, b) <= ONE_SIZE;
    let sets = order.chunk_by(are_alike).map(<[usize]>::to_vec);
    let is_one =
        |&[a, b]: &[usize; 2]| differ(a, b) < AREA_TOLERANCE || colours[a].mirrored_in(colours[b]).0 >= MANY;
    let only = only_twins(colours).into_iter().filter(is_one);
    let only = only.map(|pair| Lookalikes {
        shells: pair.into(),
        are_gloves: colours[pair[0]].are_gloves(colours[pair[1]]),
    });
    let sets = sets.filter(|set| set.len() % 2 == 0).map(|shells| Lookalikes { shells, are_gloves: false });
    sets.chain(only).collect()
}

/// Makes a shell that is its own and its only lookalike without a twin each other's; and gloves, whatever they are.
pub fn pair_own(twins: &mut [u32], alike: &[Lookalikes]) {
    for Lookalikes { shells: set, are_gloves } in alike {
        let of =
            |twin: fn(usize) -> u32| Vec::from_iter(set.iter().copied().filter(|&a| twins[a] == twin(a)));
        let pair = match (&of(|a| a as u32)[..], &of(|_| NONE)[..]) {
            ([own], [alone]) => [*own, *alone],
            _ if *are_gloves => [set[0], set[1]],
            _ => continue,
        };
        for [own, twin] in [pair, [pair[1], pair[0]]] {
            if let Some(former) = twins.get_mut(twins[own] as usize) {
                *former = NONE;
            }
            twins[own] = twin as u32;
        }
    }
}

/// What speaks for each pair of shells, row by row.
fn evidence(
    colours: &[&ShellColours],
    shells: &[Shell],
    sizes: &[[f64; 2]],
    known: &HashMap<[usize; 2], bool>,
) -> Vec<f64> {
    let count = sizes.len();
    let mirrored = |pair: usize| match (pair / count, pair % count) {
        (a, b) if a == b => 0.0,
        (a, b) => colours[a].mirrored_in(colours[b]).1,
    };
    let mirrored: Vec<f64> = (0..count * count).map(mirrored).collect();
    let distinct = |a: usize, b: usize| mirrored[a * count + b];
    let are_only = |a: usize, b: usize| {
        let alike = shells.iter().filter(|shell| counts(shell) == counts(&shells[a]));
        counts(&shells[a]) == counts(&shells[b]) && alike.count() == 2
    };
    let similarity = |a: usize, b: usize| {
        if let Some(&are_twins) = known.get(&[a.min(b), a.max(b)]) {
            return if are_twins { CERTAIN } else { 0.0 };
        }
        let [area, extent] = [0, 1].map(|k| (sizes[a][k] / sizes[b][k]).ln());
        let [by_area, by_extent] = [area / TOLERANCES[0], extent / TOLERANCES[1]].map(|ratio| ratio.powi(2));
        let apart = by_area + (1.0 - distinct(a, b)) * by_extent;
        let close = (-(area / CLOSE).powi(2)).exp();
        let similar = (-apart / (1.0 + distinct(a, b)).powi(2)).exp() * 0.5 * (1.0 + close);
        match are_only(a, b) {
            true => similar.max((-(area / ONLY_COUNTS).powi(2)).exp()),
            false => similar,
        }
    };
    let most = |a: usize| (0..count).filter(|&b| b != a).map(|b| similarity(a, b)).fold(0.0, f64::max);
    let of = |a: usize, b: usize| match a == b {
        true => 1.0 - LESS_BESIDE_SIZE * most(a),
        false => SAME_SIZE * (1.0 + DISTINCT * distinct(a, b)) * (2.0 * similarity(a, b) - 1.0),
    };
    (0..count * count).map(|pair| of(pair / count, pair % count)).collect()
}

/// An involution of shells that is being sought.
struct Involution<'a> {
    /// What speaks for each pair.
    evidence: Vec<f64>,
    weights: Vec<f64>,
    distances: &'a [f64],
    /// How much two shells say of each other, and the sum of what all say of each.
    nearness: Vec<f64>,
    around: Vec<f64>,
    twins: Vec<u32>,
}

impl Involution<'_> {
    /// The one of most worth after the best single changes, from no twins, and from each pair of a shell that may have several.
    fn settled(mut self) -> Vec<u32> {
        let mut best = (f64::NEG_INFINITY, Vec::new());
        for start in [None].into_iter().chain(self.rivals().into_iter().map(Some)) {
            self.twins.fill(NONE);
            if let Some([a, b]) = start {
                self.apply(&[(a, b as u32), (b, a as u32)]);
            }
            self.settle();
            let worth = self.worth(&Vec::from_iter(self.twins.iter().copied().enumerate()));
            if worth > best.0 {
                best = (worth, self.twins.clone());
            }
        }
        best.1
    }

    /// The likeliest pairs of the largest shell that may have several twins, as one of the legs of an insect.
    fn rivals(&self) -> Vec<[usize; 2]> {
        let count = self.twins.len();
        let twins_of = |a: usize| {
            let is_likely = |b: &usize| *b != a && self.evidence[a * count + b] > 0.0;
            Vec::from_iter((0..count).filter(is_likely).map(|b| [a, b]))
        };
        let mut pairs = (0..count).map(twins_of).find(|pairs| pairs.len() > 1).unwrap_or_default();
        let evidence = |[a, b]: [usize; 2]| self.evidence[a * count + b];
        pairs.sort_by(|&first, &second| evidence(second).total_cmp(&evidence(first)));
        pairs.truncate(MOST_STARTS);
        pairs
    }

    /// Makes the best single changes, as long as there are some.
    fn settle(&mut self) {
        let count = self.weights.len();
        loop {
            let changes = (0..count).flat_map(|a| (a..count).map(Some).chain([None]).map(move |b| (a, b)));
            let mut best: Option<(f64, Vec<(usize, u32)>)> = None;
            for (a, b) in changes {
                let change = self.change(a, b);
                let gain = self.gain(&change);
                if gain > best.as_ref().map_or(1e-9, |best| best.0) {
                    best = Some((gain, change));
                }
            }
            let Some((_, change)) = best else { return };
            self.apply(&change);
        }
    }

    /// What becomes of `a` and all that it concerns if its twin is `b`, which may be itself, or none.
    fn change(&self, a: usize, b: Option<usize>) -> Vec<(usize, u32)> {
        let former =
            [Some(a), b].into_iter().flatten().map(|own| self.twins[own]).filter(|&twin| twin != NONE);
        let mut change: Vec<(usize, u32)> = former.map(|twin| (twin as usize, NONE)).collect();
        change.push((a, b.map_or(NONE, |b| b as u32)));
        change.extend(b.filter(|&b| b != a).map(|b| (b, a as u32)));
        change.reverse();
        let mut seen = Vec::new();
        change.retain(|&(shell, _)| {
            !seen.contains(&shell) && {
                seen.push(shell);
                true
            }
        });
        change
    }

    fn apply(&mut self, change: &[(usize, u32)]) {
        change.iter().for_each(|&(shell, twin)| self.twins[shell] = twin);
    }

    fn gain(&mut self, change: &[(usize, u32)]) -> f64 {
        let before = self.worth(change);
        let former: Vec<(usize, u32)> = change.iter().map(|&(shell, _)| (shell, self.twins[shell])).collect();
        self.apply(change);
        let after = self.worth(change);
        self.apply(&former);
        after - before
    }

    /// What all that concerns some shells is worth.
    fn worth(&self, of: &[(usize, u32)]) -> f64 {
        let count = self.weights.len();
        let is_of = |shell: usize| of.iter().any(|&(own, _)| own == shell);
        let mut worth = 0.0;
        for &(a, _) in of.iter().filter(|(a, _)| self.twins[*a] != NONE) {
            worth += self.weights[a] * self.evidence[a * count + self.twins[a] as usize];
            for b in (0..count).filter(|&b| self.twins[b] != NONE) {
                let (own, images) = (a * count + b, self.twins[a] as usize * count + self.twins[b] as usize);
                let change = ((self.distances[own] - self.distances[images]) / APART).powi(2).min(1.0);
                let nearness = self.nearness[own].max(self.nearness[images]);
                // What it says of the other, too, unless that has its own turn.
                let said = self.around[a].recip() + if is_of(b) { 0.0 } else { self.around[b].recip() };
                worth -= EXCLUDED * self.weights[a] * self.weights[b] * nearness * change * said;
            }
        }
        worth
    }
}

/// Points and triangles.
pub fn counts(shell: &Shell) -> [usize; 2] {
    [shell.points.len(), shell.triangles.len()]
}

/// Lengths that say how large a shell is, in the unit of the mesh: by its area, and by how far its points are from their mean.
fn sizes(shell: &Shell) -> [f64; 2] {
    let squares: f64 = shell.positions.iter().map(|&position: &Vector| dot(position, position)).sum();
    let extent = (squares / shell.positions.len() as f64).sqrt();
    let unit = shell.scale.max(f64::MIN_POSITIVE).recip();
    [unit, unit * extent]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::connectivity::automorphism::shell_colours;
    use crate::mesh::{Mesh, PolygonMesh};

    /// Sheets of 10 by 10 squares, cut along diagonals that follow no rule, each mirrored or not, and scaled.
    pub fn sheets(of: &[(bool, f64)]) -> Mesh {
        let mut all = PolygonMesh { face_offsets: vec![0], ..PolygonMesh::default() };
        for (copy, &(is_mirrored, scale)) in of.iter().enumerate() {
            let first = all.positions.len() as u32;
            let at = |k: u32| [f64::from(k % 11), f64::from(k / 11), 0.01 * f64::from(k * k % 7)];
            let side = if is_mirrored { -scale } else { scale };
            all.positions.extend(
                (0..121).map(at).map(|[x, y, z]| [side * x + 100.0 * copy as f64, scale * y, scale * z]),
            );
            for square in (0..110u32).filter(|k| k % 11 < 10) {
                let [a, b, c, d] =
                    [square, square + 1, square + 12, square + 11].map(|corner| first + corner);
                let faces = if square * square * 7 % 13 < 6 {
                    [[a, b, c], [a, c, d]]
                } else {
                    [[a, b, d], [b, c, d]]
                };
                for [a, b, c] in faces {
                    all.face_vertices.extend(if is_mirrored { [c, b, a] } else { [a, b, c] });
                    all.face_offsets.push(all.face_vertices.len() as u32);
                }
            }
        }
        Mesh::new(&all, &Limits::default()).expect("a usable mesh")
    }

    #[test]
    fn the_only_two_of_a_connectivity_are_alike_at_any_size_unless_one_is_but_moved() {
        let sets = |of: &[(bool, f64)]| {
            let mesh = sheets(of);
            lookalikes(&Vec::from_iter(&shell_colours(&mesh)), &mesh.shells())
        };
        assert_eq!(sets(&[(false, 1.0), (true, 1.5)]), [Lookalikes { shells: vec![0, 1], are_gloves: true }]);
        assert_eq!(sets(&[(false, 1.0), (false, 1.5)]), []);
        assert_eq!(sets(&[(false, 1.0), (true, 1.5), (true, 2.5)]), []);
    }

    #[test]
    fn a_shell_is_not_its_own_while_the_only_one_like_it_has_no_twin() {
        let mut twins = [1, 0, 2, NONE, 4, NONE, NONE, 7, 8, NONE];
        let sets = [vec![0, 1], vec![2, 3], vec![4, 5, 6, 9], vec![7, 8]];
        pair_own(&mut twins, &sets.map(|shells| Lookalikes { shells, are_gloves: false }));
        assert_eq!(twins, [1, 0, 3, 2, 4, NONE, NONE, 7, 8, NONE]);
        // Gloves leave what they had before.
        let mut twins = [0, 2, 1, 3];
        pair_own(&mut twins, &[Lookalikes { shells: vec![0, 1], are_gloves: true }]);
        assert_eq!(twins, [1, 0, NONE, 3]);
    }

    #[test]
    fn a_pose_may_change_the_size_of_the_only_two_of_as_many_points() {
        // What speaks for the first two as twins, and for the first as its own image.
        let evidence_of = |of: &[(bool, f64)]| {
            let mesh = sheets(of);
            let shells = mesh.shells();
            let sizes: Vec<[f64; 2]> = shells.iter().map(sizes).collect();
            let all = evidence(&Vec::from_iter(&shell_colours(&mesh)), &shells, &sizes, &HashMap::new());
            [all[1], all[0]]
        };
        let [twins, own] = evidence_of(&[(false, 1.04), (false, 1.0)]);
        assert!(twins > 1.0 && own < 0.7, "{twins} {own}");
        let [twins, own] = evidence_of(&[(false, 1.2), (false, 1.0)]);
        assert!(twins < -1.0 && own > 0.9, "{twins} {own}");
        let [twins, own] = evidence_of(&[(false, 1.04), (false, 1.0), (false, 0.5)]);
        assert!(twins < 0.0 && own > 0.7, "{twins} {own}");
    }

    #[test]
    fn legs_in_rows_change_sides_and_not_places_in_the_row() {
        // Two legs on the left, two on the right, and a head.
        let places: [[f64; 2]; 5] = [[-0.3, 0.3], [-0.3, -0.3], [0.3, 0.3], [0.3, -0.3], [0.0, 0.6]];
        let weights = vec![0.2, 0.2, 0.2, 0.2, 0.15];
        let between = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let distances: Vec<f64> = places.iter().flat_map(|&a| places.map(|b| between(a, b))).collect();
        let of = |pair: usize| match (pair / 5, pair % 5) {
            (a, b) if a == b => 1.0,
            (a, b) if a.max(b) == 4 => -SAME_SIZE,
            _ => SAME_SIZE,
        };
        let nearness: Vec<f64> = distances.iter().map(|distance| (-distance / NEARBY).exp()).collect();
        let around = |row: &[f64]| row.iter().zip(&weights).map(|(near, weight)| near * weight).sum();
        let around = nearness.chunks(5).map(around).collect();
        let evidence = (0..25).map(of).collect();
        let twins = vec![NONE; 5];
        let involution = Involution { evidence, weights, distances: &distances, nearness, around, twins };
        assert_eq!(involution.settled(), [2, 3, 0, 1, 4]);
    }
}
