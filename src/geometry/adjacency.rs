//! Who is next to whom: neighbours of the points of a graph, one list.

use crate::mesh::{NONE, bucket};

/// Triangles or neighbours around a vertex up to which a walk looks at all. At a hub, such as the middle of a cap, it looks at so many, evenly chosen, and
/// goes on from the best of them: a step costs the same at any vertex.
pub const LOOKS: usize = 64;

/// The neighbours of each point of a graph, without the point itself; or the triangles around each.
#[derive(Debug, Clone, Default)]
pub struct Adjacency {
    offsets: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Adjacency {
    /// The triangles around each of `count` vertices. O(vertices + triangles).
    pub fn triangles_around(count: usize, triangles: &[[u32; 3]]) -> Adjacency {
        let (offsets, corners) = bucket(triangles.as_flattened().iter().copied(), count);
        Adjacency { offsets, neighbours: corners.into_iter().map(|corner| corner / 3).collect() }
    }

    /// The vertices that share one of `triangles` with each, by the triangles `around` it. O(vertices + triangles log degree).
    pub fn of_vertices(triangles: &[[u32; 3]], around: &Adjacency) -> Adjacency {
        Adjacency::from_rows(around.count(), |vertex, row| {
            let corners =
                around.of(vertex as usize).iter().flat_map(|&triangle| triangles[triangle as usize]);
            row.extend(corners.filter(|&corner| corner != vertex));
        })
    }

    /// From the neighbours of each of `count` points, which `fill` adds to an empty list; duplicates are left out.
    /// O(points + neighbours log degree).
    pub fn from_rows(count: usize, mut fill: impl FnMut(u32, &mut Vec<u32>)) -> Adjacency {
        let mut found = Adjacency { offsets: vec![0], neighbours: Vec::new() };
        let mut row = Vec::new();
        for point in 0..count as u32 {
            row.clear();
            fill(point, &mut row);
            row.sort_unstable();
            row.dedup();
            found.neighbours.extend_from_slice(&row);
            found.offsets.push(found.neighbours.len() as u32);
        }
        found.neighbours.shrink_to_fit();
        found
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Neighbours of a point, ascending.
    pub fn of(&self, point: usize) -> &[u32] {
        &self.neighbours[self.offsets[point] as usize..self.offsets[point + 1] as usize]
    }
}

/// At most [`LOOKS`] of what is around a vertex.
#[inline(always)]
pub fn some(all: &[u32]) -> impl Iterator<Item = u32> + '_ {
    all.iter().copied().step_by(all.len().div_ceil(LOOKS).max(1))
}

/// From a point to whichever of those `around` is nearest, as long as these get nearer: where that ends, and its distance.
pub fn downhill<N: IntoIterator<Item = u32>, D: PartialOrd>(
    start: u32,
    around: impl Fn(u32) -> N,
    distance: impl Fn(u32) -> D,
) -> (u32, D) {
    let (mut best, mut least) = (start, distance(start));
    loop {
        let from = best;
        for near in around(from) {
            let there = distance(near);
            if there < least {
                (best, least) = (near, there);
            }
        }
        if best == from {
            return (best, least);
        }
    }
}

/// For each of `count` points the index of the seed that is the fewest steps away; [`NONE`] where none can be reached.
///
/// `neighbours` may name a point more than once. O(points + steps).
pub fn nearest_seeds<N: IntoIterator<Item = u32>>(
    count: usize,
    seeds: &[u32],
    neighbours: impl Fn(u32) -> N,
) -> Vec<u32> {
    let mut nearest = vec![NONE; count];
    let mut queue = seeds.to_vec();
    for (index, &seed) in seeds.iter().enumerate() {
        nearest[seed as usize] = index as u32;
    }
    let mut head = 0;
    while head < queue.len() {
        let from = queue[head];
        head += 1;
        for to in neighbours(from) {
            if nearest[to as usize] == NONE {
                nearest[to as usize] = nearest[from as usize];
                queue.push(to);
            }
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_and_duplicates_are_left_out() {
        let triangles = [[2, 0, 2], [0, 2, 1], [0, 1, 0]];
        let graph = Adjacency::of_vertices(&triangles, &Adjacency::triangles_around(4, &triangles));
        let rows: Vec<&[u32]> = (0..graph.count()).map(|point| graph.of(point)).collect();
        assert_eq!(rows, [&[1u32, 2][..], &[0, 2], &[0, 1], &[]]);
        let graph =
            Adjacency::from_rows(3, |point, row| row.extend([2, 1, 2].iter().filter(|&&to| to > point)));
        let rows: Vec<&[u32]> = (0..graph.count()).map(|point| graph.of(point)).collect();
        assert_eq!(rows, [&[1u32, 2][..], &[2], &[]]);
    }
}
