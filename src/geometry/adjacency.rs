//! Who is next to whom: neighbours of the points of a graph, one list.

use crate::mesh::{NONE, bucket};

/// Triangles or neighbours around a vertex up to which a walk looks at all. At a hub, such as the middle of a cap, it looks at so many, evenly chosen, and
/// goes on from the best of them: a step costs the same at any vertex.
pub const LOOKS: usize = 64;

/// The neighbours of each point of a graph, without the point itself.
#[derive(Debug, Clone, Default)]
pub struct Adjacency {
    offsets: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Adjacency {
    /// From the directed edges of a symmetric relation on `count` points; duplicates and loops are left out.
    /// O(points + edges log degree).
    pub fn new(count: usize, edges: impl Iterator<Item = (u32, u32)> + Clone) -> Adjacency {
        let edges = edges.filter(|(from, to)| from != to);
        let (starts, items) = bucket(edges.clone().map(|(from, _)| from), count);
        let ends: Vec<u32> = edges.map(|(_, to)| to).collect();
        Adjacency::from_rows(count, |point, row| {
            let own = starts[point as usize] as usize..starts[point as usize + 1] as usize;
            row.extend(items[own].iter().map(|&item| ends[item as usize]));
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
        let edges = [(2, 0), (0, 2), (1, 1), (0, 2), (2, 0), (0, 1), (1, 0)];
        let graph = Adjacency::new(4, edges.into_iter());
        let rows: Vec<&[u32]> = (0..graph.count()).map(|point| graph.of(point)).collect();
        assert_eq!(rows, [&[1u32, 2][..], &[0], &[0], &[]]);
        let graph =
            Adjacency::from_rows(3, |point, row| row.extend([2, 1, 2].iter().filter(|&&to| to > point)));
        let rows: Vec<&[u32]> = (0..graph.count()).map(|point| graph.of(point)).collect();
        assert_eq!(rows, [&[1u32, 2][..], &[2], &[]]);
    }
}
