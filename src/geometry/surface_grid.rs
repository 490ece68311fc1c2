//! Places spread over a surface, at most one in each cell of a grid.

use crate::mesh::vector::{Vector, squared_norm, subtract};
use std::collections::HashSet;

/// Most places on the longest edge of a triangle.
const MOST_PLACES: usize = 64;

/// A place on a surface, and the corners of its triangle, the nearest first.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Where it is.
    pub at: Vector,
    /// Points of the surface.
    pub corners: [u32; 3],
}

/// Places on triangles over `positions`, about `spacing` from each other. O(triangles + area / spacing^2).
pub fn places<'a>(
    positions: &[Vector],
    triangles: impl IntoIterator<Item = &'a [u32; 3]>,
    spacing: f64,
) -> Vec<Place> {
    let (mut cells, mut places) = (HashSet::new(), Vec::new());
    for &corners in triangles {
        let ends = corners.map(|point| positions[point as usize]);
        let length = |a: usize, b: usize| squared_norm(subtract(ends[a], ends[b])).sqrt();
        let longest = length(0, 1).max(length(1, 2)).max(length(2, 0));
        let steps = ((longest / spacing).ceil() as usize).clamp(1, MOST_PLACES);
        for i in 0..=steps {
            for j in 0..=steps - i {
                let weights = [i, j, steps - i - j].map(|count| count as f64 / steps as f64);
                let at: Vector = std::array::from_fn(|axis| (0..3).map(|c| weights[c] * ends[c][axis]).sum());
                if cells.insert(at.map(|x| (x / spacing).floor() as i64)) {
                    let mut order = [0, 1, 2];
                    order.sort_by(|&a, &b| weights[b].total_cmp(&weights[a]));
                    places.push(Place { at, corners: order.map(|corner| corners[corner]) });
                }
            }
        }
    }
    places
}
