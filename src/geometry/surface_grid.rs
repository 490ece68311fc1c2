//! Places spread over a surface, at most one in each cell of a grid.

use crate::mesh::vector::{Vector, squared_norm, subtract};
use std::collections::HashSet;

/// Most places on the longest edge of a triangle.
const MOST_PLACES: usize = 64;
/// Cells that are remembered beside the set of all.
const PASSED: usize = 1024;

/// A place on a surface, and the corners of its triangle, the nearest first.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Where it is.
    pub at: Vector,
    /// Points of the surface.
    pub corners: [u32; 3],
}

/// Places on triangles over `positions`, about `spacing` from each other. O(triangles + (longest edge / spacing) (1 + shortest edge / spacing) of each).
pub fn places<'a>(
    positions: &[Vector],
    triangles: impl IntoIterator<Item = &'a [u32; 3]>,
    spacing: f64,
) -> Vec<Place> {
    let (mut cells, mut places) = (HashSet::new(), Vec::new());
    // Around a hub all triangles pass the same cells.
    let mut passed = [[i64::MAX; 3]; PASSED];
    for corners in triangles {
        for (corners, weights) in spread(positions, *corners, spacing) {
            let ends = corners.map(|point| positions[point as usize]);
            let at: Vector = std::array::from_fn(|axis| (0..3).map(|c| weights[c] * ends[c][axis]).sum());
            let cell = at.map(|x| (x / spacing).floor() as i64);
            let last = &mut passed[cell.iter().fold(0, |sum, x| 31 * sum + (x & 0xffff) as usize) % PASSED];
            if *last != cell && cells.insert(cell) {
                let mut order = [0, 1, 2];
                order.sort_by(|&a, &b| weights[b].total_cmp(&weights[a]));
                places.push(Place { at, corners: order.map(|corner| corners[corner]) });
            }
            *last = cell;
        }
    }
    places
}

/// Weights of a triangle's corners, in rows along its shortest side: a needle has one or two in each. Of a triangle smaller than the spacing
/// one corner is enough.
fn spread(
    positions: &[Vector],
    [a, b, c]: [u32; 3],
    spacing: f64,
) -> impl Iterator<Item = ([u32; 3], [f64; 3])> {
    let length = |a: u32, b: u32| {
        squared_norm(subtract(positions[a as usize], positions[b as usize])).sqrt() / spacing
    };
    let mut sides = [(length(b, c), [a, b, c]), (length(c, a), [b, c, a]), (length(a, b), [c, a, b])];
    sides.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(shortest, corners), _, (longest, _)] = sides;
    let steps = (longest.ceil() as usize).clamp(1, MOST_PLACES);
    let rows = if steps == 1 { 0 } else { steps };
    (0..=rows).flat_map(move |row| {
        let away = row as f64 / steps as f64;
        let columns = ((away * shortest).ceil() as usize).min(row);
        (0..=columns).map(move |column| {
            let along = column as f64 / columns.max(1) as f64;
            (corners, [1.0 - away, away * (1.0 - along), away * along])
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_as_far_apart_as_asked_for_on_needles_too() {
        let positions = [[0.01, 0.01, 0.0], [1.01, 0.01, 0.0], [0.51, 0.81, 0.0], [1.01, 0.02, 0.0]];
        let count = |triangle: [u32; 3]| places(&positions, &[triangle], 0.05).len();
        // 160 cells of a grid have the broad one's area, and those on its border are cut.
        assert!((160..240).contains(&count([0, 1, 2])), "{}", count([0, 1, 2]));
        assert!((21..=44).contains(&spread(&positions, [0, 1, 3], 0.05).count()));
        assert!((19..=21).contains(&count([0, 1, 3])), "{}", count([0, 1, 3]));
        assert_eq!(count([0, 0, 0]), 1);
        // On the other side of the origin, too.
        let behind = positions.map(|at| at.map(|x| x - 3.0));
        assert!((160..240).contains(&places(&behind, &[[0, 1, 2]], 0.05).len()));
    }
}
