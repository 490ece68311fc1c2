//! Shells that are there twice in one place, face by face: a copy left behind, or the other side of a sheet. They become one, so that none of them
//! takes the other for its mirror image.

use super::edges::UnionFind;
use super::polygons::{Polygons, bucket};
use super::vector::{Vector, mean, squared_norm, subtract};
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Largest distance of a corner from that of a copy, as a share of the shortest edge. Copies are mostly moved by nothing, and up to .06 against flicker.
const REACH: f64 = 1.0 / 16.0;
/// Most shells at a place that are looked at.
const CROWD: usize = 32;

/// Patches of polygons that share vertices. Those that only meet on seams are shells of their own here.
struct Patches<'a> {
    polygons: &'a Polygons,
    positions: &'a [Vector],
    /// The polygons of each.
    starts: Vec<u32>,
    order: Vec<u32>,
}

/// What a copy of a patch has in common with it.
struct Outline {
    polygons: usize,
    corners: usize,
    middle: Vector,
    /// How far a copy's corners are, at most.
    reach: f64,
}

/// Pairs of vertices of a shell and of a copy of it. O(corners) for one shell, O(corners log corners) for more.
pub fn copied_vertices(polygons: &Polygons, positions: &[Vector]) -> Vec<[u32; 2]> {
    let patches = Patches::new(polygons, positions);
    let count = patches.starts.len() - 1;
    if count < 2 {
        return Vec::new();
    }
    let outlines: Vec<Outline> = (0..count).map(|patch| patches.outline(patch)).collect();
    let leaves = outlines.iter().enumerate().map(|(patch, outline)| GeomWithData::new(outline.middle, patch));
    let middles = RTree::bulk_load(leaves.collect());
    let mut is_copy = vec![false; count];
    let mut pairs = Vec::new();
    for (patch, own) in outlines.iter().enumerate() {
        if is_copy[patch] {
            continue;
        }
        let is_like = |&other: &usize| {
            let there = &outlines[other];
            other > patch && !is_copy[other] && (own.polygons, own.corners) == (there.polygons, there.corners)
        };
        let near = middles.locate_within_distance(own.middle, own.reach * own.reach).map(|there| there.data);
        let mut near: Vec<usize> = near.filter(is_like).take(CROWD).collect();
        if near.is_empty() {
            continue;
        }
        near.sort_unstable();
        let polygons = RTree::bulk_load(patches.of(patch).iter().map(|&own| patches.placed(own)).collect());
        for other in near {
            if let Some(copied) = patches.copied(other, &polygons, own.reach) {
                is_copy[other] = true;
                pairs.extend(copied);
            }
        }
    }
    pairs
}

impl<'a> Patches<'a> {
    fn new(polygons: &'a Polygons, positions: &'a [Vector]) -> Self {
        let mut sets = UnionFind::new(positions.len());
        for polygon in 0..polygons.len() {
            let corners = polygons.corners_of(polygon);
            corners.iter().for_each(|&corner| sets.join(corners[0], corner));
        }
        let lowest = |polygon: usize| sets.find(polygons.corners_of(polygon)[0]);
        let lowest: Vec<u32> = (0..polygons.len()).map(lowest).collect();
        let (mut starts, order) = bucket(lowest.into_iter(), positions.len());
        starts.dedup();
        Patches { polygons, positions, starts, order }
    }

    fn of(&self, patch: usize) -> &[u32] {
        &self.order[self.starts[patch] as usize..self.starts[patch + 1] as usize]
    }

    fn corners(&self, polygon: u32) -> &[u32] {
        self.polygons.corners_of(polygon as usize)
    }

    fn at(&self, corner: u32) -> Vector {
        self.positions[corner as usize]
    }

    /// Squared distance of two vertices.
    fn apart(&self, a: u32, b: u32) -> f64 {
        squared_norm(subtract(self.at(a), self.at(b)))
    }

    fn outline(&self, patch: usize) -> Outline {
        let corners = || self.of(patch).iter().flat_map(|&polygon| self.corners(polygon)).copied();
        let edges = self.of(patch).iter().flat_map(|&polygon| {
            let corners = self.corners(polygon);
            corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&a, &b)| self.apart(a, b))
        });
        let shortest = edges.filter(|&square| square > 0.0).fold(f64::INFINITY, f64::min).sqrt();
        Outline {
            polygons: self.of(patch).len(),
            corners: corners().count(),
            middle: mean(corners().map(|corner| self.at(corner))),
            reach: if shortest.is_finite() { REACH * shortest } else { 0.0 },
        }
    }

    /// A polygon at its middle.
    fn placed(&self, polygon: u32) -> GeomWithData<Vector, u32> {
        GeomWithData::new(mean(self.corners(polygon).iter().map(|&corner| self.at(corner))), polygon)
    }

    /// Each corner of a patch with that of the polygons of which it is a copy, if it is.
    fn copied(
        &self,
        patch: usize,
        of: &RTree<GeomWithData<Vector, u32>>,
        reach: f64,
    ) -> Option<Vec<[u32; 2]>> {
        let (mut pairs, mut taken) = (Vec::new(), Vec::new());
        for &polygon in self.of(patch) {
            let there = of.nearest_neighbor(*self.placed(polygon).geom())?.data;
            let (own, others) = (self.corners(polygon), self.corners(there));
            if own.len() != others.len() {
                return None;
            }
            for &corner in own {
                let away = |other: &&u32| self.apart(corner, **other);
                let nearest = *others.iter().min_by(|a, b| away(a).total_cmp(&away(b)))?;
                if self.apart(corner, nearest) > reach * reach {
                    return None;
                }
                pairs.push([nearest, corner]);
            }
            taken.push(there);
        }
        taken.sort_unstable();
        taken.dedup();
        (taken.len() == self.of(patch).len()).then_some(pairs)
    }
}
