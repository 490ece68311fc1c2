//! Twins that a map sees, though it may not send them to each other.
//!
//! Legs of an insect are alike, and a pose bends each as it likes: neither size nor distance says for sure which is whose twin. A map of the trunk does: it takes the place where a leg sits to
//! the one where its twin does.

use crate::base::symmetry_kind::SymmetryKind;
use crate::detect::companions::{AREA_TOLERANCE, FARTHEST};
use crate::detect::contact_place::ContactPlace;
use crate::detect::coverage::{partner_point, targets_of_shells};
use crate::detect::twins::counts;
use crate::mesh::vector::{squared_norm, subtract};
use crate::mesh::{Mesh, NONE, Shell};

/// How much nearer to the goal one's contact is than that of any other that is alike.
const CLEARLY: f64 = 0.5;

/// Pairs of `shells`, the mesh's largest, that are alike, each of which has the other's contact where a map with these vertices' `partner` takes its own, on the largest shell that it sits on; none if the map sends all of
/// these to each other. O(points of shells x contacts).
pub fn pairs(mesh: &Mesh, shells: &[Shell], contacts: &[ContactPlace], partner: &[i32]) -> Vec<[usize; 2]> {
    let goes = |&vertex: &u32| partner_point(mesh, partner[vertex as usize]);
    let goes: Vec<u32> = mesh.vertex_of_point.iter().map(goes).collect();
    let targets = targets_of_shells(mesh, &goes);
    let at = |point: u32| mesh.positions[point as usize];
    let are_alike = |a: usize, b: usize| {
        let [one, two] = [a, b].map(|shell| &shells[shell]);
        counts(one) == counts(two) && (one.area() / two.area()).ln().abs() < AREA_TOLERANCE
    };
    // Larger shells come first.
    let host = |own: usize| {
        let is_on = |contact: &&ContactPlace| {
            let [host, sitting] = contact.shells;
            sitting == own && !are_alike(own, host)
        };
        contacts.iter().filter(is_on).min_by_key(|contact| contact.shells[0])
    };
    let seen = |own: usize| {
        let contact = host(own)?;
        let points = shells[contact.shells[0]].points.iter().map(|&point| [point, goes[point as usize]]);
        let ends = points.filter(|ends| ends[1] != NONE).map(|ends| ends.map(at));
        let goal = contact.carried(ends, SymmetryKind::Reflection, &[contact.middle])?[0];
        let there = targets[contact.shells[0]] as usize;
        let gap = |other: usize| {
            let mut shells = [other, there];
            shells.sort_unstable();
            let contact = contacts.iter().find(|contact| contact.shells == shells);
            contact.map_or(f64::INFINITY, |contact| squared_norm(subtract(contact.middle, goal)).sqrt())
        };
        let alike = (0..shells.len()).filter(|&other| are_alike(own, other));
        let mut gaps: Vec<(f64, usize)> = alike.map(|other| (gap(other), other)).collect();
        gaps.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [(least, nearest), (next, _), ..] = gaps[..] else { return None };
        (least < f64::from(FARTHEST).min(CLEARLY * next) && nearest != own).then_some(nearest)
    };
    let seen: Vec<Option<usize>> = (0..shells.len()).map(seen).collect();
    let twin = |own: usize| seen[own].filter(|&twin| own < twin && seen[twin] == Some(own));
    let pairs: Vec<[usize; 2]> =
        (0..seen.len()).filter_map(|own| twin(own).map(|twin| [own, twin])).collect();
    let is_known = |&[a, b]: &[usize; 2]| [targets[a], targets[b]] == [b as u32, a as u32];
    if pairs.iter().all(is_known) { Vec::new() } else { pairs }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::PolygonMesh;

    /// A long trunk, and on each of its long sides two legs.
    fn insect() -> Mesh {
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let bit = |corner: u32, axis: usize| f64::from(corner >> axis & 1) - 0.5;
        let block = |middle: [f64; 3], size: [f64; 3]| {
            (0..8).map(move |corner| std::array::from_fn(|k| middle[k] + size[k] * bit(corner, k)))
        };
        let leg = |x: f64, y: f64| block([x, y, 0.0], [1.0, 0.2, 0.2]);
        let polygons = PolygonMesh {
            positions: block([0.0; 3], [1.0, 2.0, 0.5])
                .chain([-1.0, 1.0].into_iter().flat_map(|x| leg(x, -0.6).chain(leg(x, 0.6))))
                .collect(),
            face_offsets: (0..=30).map(|face| 4 * face).collect(),
            face_vertices: (0..5)
                .flat_map(|block| sides.as_flattened().iter().map(move |corner| 8 * block + corner))
                .collect(),
        };
        Mesh::new(&polygons, &Limits::default()).expect("a usable mesh")
    }

    /// Pairs of legs, by their numbers, that a map sees which sends the trunk across an axis and each leg to one of these.
    fn seen(axis: usize, targets: [usize; 4]) -> Vec<[usize; 2]> {
        let mesh = insect();
        let shells = mesh.shells();
        let shell = |block: usize| mesh.shell_of_point[mesh.point_of_vertex[8 * block] as usize] as usize;
        let at = |vertex: usize| mesh.positions[mesh.point_of_vertex[vertex] as usize];
        // The corners of a leg's end at the trunk.
        let end = |leg: usize| {
            (0..8).filter(move |corner| (corner & 1 == 1) == (leg < 3)).map(move |k| 8 * leg + k)
        };
        let contact = |leg| ContactPlace::new([shell(0), shell(leg)], &end(leg).map(at).collect::<Vec<_>>());
        let trunk = (0..8).map(|corner| corner ^ 1 << axis);
        let legs = targets.into_iter().flat_map(|target| (0..8).map(move |k| 8 * target as i32 + (k ^ 1)));
        let partner: Vec<i32> = trunk.chain(legs).collect();
        let contacts: Vec<ContactPlace> = (1..5).map(contact).collect();
        let leg = |own: usize| (1..5).find(|&leg| shell(leg) == own).expect("a leg");
        let pairs = pairs(&mesh, &shells, &contacts, &partner).into_iter().map(|pair| pair.map(leg));
        let mut pairs: Vec<[usize; 2]> = pairs.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        pairs.sort_unstable();
        pairs
    }

    #[test]
    fn legs_have_the_twins_that_the_trunk_says_wherever_the_map_sends_them() {
        // Diagonally, to themselves, and two of them only.
        for targets in [[4, 3, 2, 1], [1, 2, 3, 4], [3, 2, 1, 4]] {
            assert_eq!(seen(0, targets), [[1, 3], [2, 4]], "{targets:?}");
            assert_eq!(seen(1, targets), [[1, 2], [3, 4]], "{targets:?}");
        }
    }

    #[test]
    fn nothing_is_seen_where_the_map_says_the_same_or_the_trunk_that_each_leg_stays() {
        assert!(seen(0, [3, 4, 1, 2]).is_empty());
        assert!(seen(2, [4, 3, 2, 1]).is_empty());
    }
}
