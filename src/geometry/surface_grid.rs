//! Places spread over a surface, at most one in each cell of a grid.

use crate::mesh::vector::{Vector, squared_norm, subtract};
use std::collections::HashSet;

/// Most places on the longest edge of a triangle.
const MOST_PLACES: usize = 64;

/// Cells that are remembered as taken, beside the set of all: neighbouring needles lie in the same ones.
const REMEMBERED: usize = 1 << 12;

/// A place on a surface, and the corners of its triangle, the nearest first.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Where it is.
    pub at: Vector,
    /// Points of the surface.
    pub corners: [u32; 3],
}

/// Places on triangles over `positions`, about `spacing` from each other. O(triangles + (longest edge / spacing)^2 of each).
pub fn places<'a>(
    positions: &[Vector],
    triangles: impl IntoIterator<Item = &'a [u32; 3]>,
    spacing: f64,
) -> Vec<Place> {
    let (mut cells, mut places) = (Cells::new(spacing), Vec::new());
    for &corners in triangles {
        let ends = corners.map(|point| positions[point as usize]);
        let length = |a: usize, b: usize| squared_norm(subtract(ends[a], ends[b])).sqrt();
        let longest = length(0, 1).max(length(1, 2)).max(length(2, 0));
        let steps = ((longest / spacing).ceil() as usize).clamp(1, MOST_PLACES);
        // Of a triangle smaller than a cell one corner is enough.
        let last = if steps == 1 { 0 } else { steps };
        for i in 0..=last {
            for j in 0..=last.saturating_sub(i) {
                let weights = [i, j, steps - i - j].map(|count| count as f64 / steps as f64);
                let at: Vector = std::array::from_fn(|axis| (0..3).map(|c| weights[c] * ends[c][axis]).sum());
                if cells.take(at) {
                    let mut order = [0, 1, 2];
                    order.sort_by(|&a, &b| weights[b].total_cmp(&weights[a]));
                    places.push(Place { at, corners: order.map(|corner| corners[corner]) });
                }
            }
        }
    }
    places
}

/// Cells of a grid that are taken.
struct Cells {
    spacing: f64,
    all: HashSet<[i64; 3]>,
    recent: Vec<Option<[i64; 3]>>,
}

impl Cells {
    fn new(spacing: f64) -> Cells {
        Cells { spacing, all: HashSet::new(), recent: vec![None; REMEMBERED] }
    }

    /// Takes the cell of a place; whether it was free.
    fn take(&mut self, at: Vector) -> bool {
        let cell = at.map(|coordinate| floor(coordinate / self.spacing));
        let mixed = cell.iter().fold(0i64, |mixed, &index| mixed.wrapping_mul(31).wrapping_add(index));
        let recent = &mut self.recent[mixed as usize % REMEMBERED];
        if *recent == Some(cell) {
            return false;
        }
        *recent = Some(cell);
        self.all.insert(cell)
    }
}

/// As [`f64::floor`], which is a call of the system's library on older processors.
fn floor(value: f64) -> i64 {
    let whole = value as i64;
    whole.saturating_sub(i64::from(value < whole as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_taken_once_however_many_lie_between() {
        let mut cells = Cells::new(0.5);
        let at = |index: i32| [-0.25 + 0.5 * f64::from(index), 1e-9, -1e-9];
        let many = 3 * REMEMBERED as i32;
        assert!((0..many).all(|index| cells.take(at(index))));
        assert!((0..many).rev().all(|index| !cells.take(at(index))));
        assert_eq!([-1.5, -1.0, -0.0, 0.9, 1e300, -1e300].map(floor), [-2, -1, 0, 0, i64::MAX, i64::MIN]);
    }
}
