//! Shells that are there twice in one place, corner for corner: a copy left behind, or the other side of a sheet. They become one, so that none of them
//! takes the other for its mirror image.

use super::edges::UnionFind;
use super::polygons::{Polygons, bucket};
use super::vector::Vector;
use super::weld::position_key;

/// A position as [`position_key`] has it.
type Key = [u64; 3];

/// Pairs of vertices that are in one place on a shell and on a copy of it. Patches that only meet on seams are shells of their own here.
/// O(corners); O(corners log corners) of the copies.
pub fn copied_vertices(polygons: &Polygons, positions: &[Vector]) -> Vec<[u32; 2]> {
    let mut sets = UnionFind::new(positions.len());
    for polygon in 0..polygons.len() {
        let corners = polygons.corners_of(polygon);
        corners.iter().for_each(|&corner| sets.join(corners[0], corner));
    }
    let shell_of_polygon =
        (0..polygons.len()).map(|polygon| sets.find(polygons.corners_of(polygon)[0])).collect::<Vec<u32>>();
    let (starts, order) = bucket(shell_of_polygon.iter().copied(), positions.len());
    let polygons_of =
        |shell: u32| &order[starts[shell as usize] as usize..starts[shell as usize + 1] as usize];
    let key = |&corner: &u32| position_key(positions[corner as usize]);
    // A copy has as many polygons, and the same first corner of all.
    let likeness = |shell: u32| {
        let corners = polygons_of(shell).iter().flat_map(|&polygon| polygons.corners_of(polygon as usize));
        (polygons_of(shell).len(), corners.map(key).min())
    };
    let shells = (0..positions.len() as u32).filter(|&shell| !polygons_of(shell).is_empty());
    let mut shells: Vec<_> = shells.map(|shell| (likeness(shell), shell)).collect();
    shells.sort_unstable();
    let mut pairs = Vec::new();
    for alike in shells.chunk_by(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1) {
        let placed = |&(_, shell)| placed_polygons(polygons, polygons_of(shell), key);
        let mut placed: Vec<Vec<Vec<(Key, u32)>>> = alike.iter().map(placed).collect();
        let places =
            |shell: &[Vec<(Key, u32)>]| shell.iter().flatten().map(|corner| corner.0).collect::<Vec<Key>>();
        placed.sort_by_cached_key(|shell| places(shell));
        for pair in placed.windows(2).filter(|pair| places(&pair[0]) == places(&pair[1])) {
            let corners = pair[0].iter().flatten().zip(pair[1].iter().flatten());
            pairs.extend(corners.map(|(a, b)| [a.1, b.1]));
        }
    }
    pairs
}

/// Polygons in the order of their places, each with its corners in that order.
fn placed_polygons(polygons: &Polygons, of: &[u32], key: impl Fn(&u32) -> Key) -> Vec<Vec<(Key, u32)>> {
    let placed = |&polygon: &u32| {
        let corners = polygons.corners_of(polygon as usize).iter();
        let mut corners: Vec<(Key, u32)> = corners.map(|corner| (key(corner), *corner)).collect();
        corners.sort_unstable();
        corners
    };
    let mut placed: Vec<Vec<(Key, u32)>> = of.iter().map(placed).collect();
    placed.sort_unstable();
    placed
}
