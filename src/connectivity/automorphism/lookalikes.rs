//! Whether the connectivity of a mesh may be mirrored at all, from its polygons alone.
//!
//! A vertex and its partner have one colour (Weisfeiler and Leman 1968; [`super::colours`] has the citation), so on mirrored
//! connectivity nearly every colour occurs twice. In independent triangulations few do: the surroundings of a vertex, five rings
//! wide, occur once. Vertices and faces are coloured in turn, which needs no half-edges.

use super::almost::REPEATED;
use super::colours::hash;
use crate::mesh::Mesh;
use std::collections::BTreeMap;

/// Rounds of colours: three leave lookalikes to half of an independent triangulation of 50,000 vertices, five to a thirtieth.
const ROUNDS: usize = 5;
/// Rounds of the colours that tell two shells alike in part: what is three rings away from a difference looks the same.
const NEAR: usize = 3;
/// Points that tell two shells from all others.
pub const MANY: usize = 30;

/// Which shells have as many lookalikes as [`super::almost`] asks for. Others have no bijection, and no pairing but for a few
/// defects. O(corners + points log points).
pub(super) fn shells_with_lookalikes(mesh: &Mesh) -> Vec<bool> {
    let colours = coloured(mesh, ROUNDS);
    let mut of_shell: Vec<(u64, u32)> =
        colours.into_iter().zip(mesh.shell_of_point.iter().copied()).collect();
    of_shell.sort_unstable();
    let mut counts = vec![[0usize; 2]; mesh.shell_count];
    for class in of_shell.chunk_by(|a, b| a.0 == b.0) {
        for &(_, shell) in class {
            let [repeated, points] = &mut counts[shell as usize];
            *points += 1;
            *repeated += usize::from(class.len() > 1);
        }
    }
    counts.iter().map(|&[repeated, points]| repeated as f64 >= REPEATED * points as f64).collect()
}

/// The colour of each point after some rounds.
fn coloured(mesh: &Mesh, rounds: usize) -> Vec<u64> {
    (0..rounds).fold(vec![0; mesh.point_count()], |colours, _| refined(mesh, &colours))
}

/// One round: each face takes in the colours of its corners, each point those of its faces, both in no order.
fn refined(mesh: &Mesh, colours: &[u64]) -> Vec<u64> {
    let mut rings = colours.to_vec();
    for face in mesh.polygon_offsets.windows(2) {
        let corners = &mesh.polygon_points[face[0] as usize..face[1] as usize];
        let sum = |sum: u64, &point: &u32| sum.wrapping_add(colours[point as usize]);
        let colour = hash(corners.iter().fold(corners.len() as u64, sum));
        for &point in corners {
            rings[point as usize] = rings[point as usize].wrapping_add(colour);
        }
    }
    rings.iter_mut().for_each(|ring| *ring = hash(*ring));
    rings
}

/// The colours of a shell's points by what is around them, with the order of corners around faces.
#[derive(Debug, Clone, Default)]
pub struct ShellColours {
    /// As seen from outside, sorted.
    seen: Vec<u64>,
    /// As seen in a mirror, sorted.
    mirrored: Vec<u64>,
}

impl ShellColours {
    /// Whether another shell has the same connectivity, mirrored or not.
    pub fn are_like(&self, other: &ShellColours) -> bool {
        self.seen == other.mirrored || self.seen == other.seen
    }

    /// Whether this is the mirror image of another shell's connectivity, and not of its own, as gloves are; by many points: of few it is so by chance.
    pub fn are_gloves(&self, other: &ShellColours) -> bool {
        self.seen != self.mirrored && self.seen == other.mirrored && self.mirrored_in(other).0 >= MANY
    }

    /// How many points tell themselves from all others by their surroundings and have the mirror image of these in another shell, and their share, 0..=1: nearly
    /// all of a mirrored copy, or of one with something else on it, next to nothing of a regular tube; none of a copy that was but turned. O(points).
    pub fn mirrored_in(&self, other: &ShellColours) -> (usize, f64) {
        let points = self.seen.len().max(other.seen.len()).max(1) as f64;
        let [mirrored, turned] = [&other.mirrored, &other.seen].map(|there| shared(&self.seen, there));
        if mirrored < turned { (0, 0.0) } else { (mirrored, mirrored as f64 / points) }
    }
}

/// Shells of which each is the only other one that has the mirror image of the other's connectivity.
pub fn only_twins(colours: &[&ShellColours]) -> Vec<[usize; 2]> {
    let mut seen: BTreeMap<&[u64], Vec<usize>> = BTreeMap::new();
    colours.iter().enumerate().for_each(|(own, shell)| seen.entry(&shell.seen).or_default().push(own));
    let only = |(own, shell): (usize, &&ShellColours)| {
        let mut others = seen.get(&shell.mirrored[..])?.iter().filter(|&&other| other != own);
        others.next().filter(|_| others.next().is_none()).copied()
    };
    let only: Vec<Option<usize>> = colours.iter().enumerate().map(only).collect();
    let twins = only.iter().enumerate().filter_map(|(own, twin)| Some([own, (*twin)?]));
    twins.filter(|&[own, twin]| own < twin && only[twin] == Some(own)).collect()
}

/// How many of some sorted values that are there once are among others.
fn shared(own: &[u64], there: &[u64]) -> usize {
    let mut there = there.iter().peekable();
    let found = |class: &&[u64]| {
        while there.next_if(|&&other| other < class[0]).is_some() {}
        class.len() == 1 && there.peek() == Some(&&class[0])
    };
    own.chunk_by(|a, b| a == b).filter(found).count()
}

/// The colours of each shell. O(corners + points log points).
pub fn shell_colours(mesh: &Mesh) -> Vec<ShellColours> {
    let colours = coloured(mesh, NEAR);
    // The order of colours around a face, from either side.
    let (mut seen, mut mirrored) = (colours.clone(), colours.clone());
    for face in mesh.polygon_offsets.windows(2) {
        let corners = &mesh.polygon_points[face[0] as usize..face[1] as usize];
        for (corner, &point) in corners.iter().enumerate() {
            let beside = [corner + corners.len() - 1, corner + 1];
            let [before, after] = beside.map(|beside| colours[corners[beside % corners.len()] as usize]);
            let [forth, back] = [[before, after], [after, before]].map(|[a, b]| hash(hash(a) ^ b));
            let (seen, mirrored) = (&mut seen[point as usize], &mut mirrored[point as usize]);
            (*seen, *mirrored) = (seen.wrapping_add(forth), mirrored.wrapping_add(back));
        }
    }
    let mut shells = vec![ShellColours::default(); mesh.shell_count];
    for (point, &shell) in mesh.shell_of_point.iter().enumerate() {
        shells[shell as usize].seen.push(seen[point]);
        shells[shell as usize].mirrored.push(mirrored[point]);
    }
    for shell in &mut shells {
        shell.seen.sort_unstable();
        shell.mirrored.sort_unstable();
    }
    shells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::PolygonMesh;

    /// A closed shell of 20 corners that is like its mirror image nowhere, a copy beside it, its mirror image, and that given inside out.
    fn copies() -> Mesh {
        let ring = |level: u32| {
            let angles = (0..6).map(|k| f64::from(k) * std::f64::consts::TAU / 6.0);
            angles.map(move |angle| [angle.cos(), angle.sin(), f64::from(level)])
        };
        let mut positions: Vec<[f64; 3]> = (0..3).flat_map(ring).collect();
        positions.extend([[0.0, 0.0, -0.5], [0.0, 0.0, 2.5]]);
        let mut faces: Vec<Vec<u32>> = Vec::new();
        for k in 0..6 {
            let next = (k + 1) % 6;
            faces.extend([vec![next, k, 18], vec![12 + k, 12 + next, 19]]);
            for level in [0, 6] {
                let [a, b, c, d] = [level + k, level + next, level + 6 + next, level + 6 + k];
                // Some squares are cut, along one diagonal or the other.
                faces.extend(match (level + k) % 5 {
                    0 | 1 => vec![vec![a, b, c], vec![a, c, d]],
                    2 => vec![vec![a, b, d], vec![b, c, d]],
                    _ => vec![vec![a, b, c, d]],
                });
            }
        }
        let mut all = PolygonMesh { face_offsets: vec![0], ..PolygonMesh::default() };
        for (copy, [flip, reverse]) in
            [[false, false], [false, false], [true, true], [true, false]].into_iter().enumerate()
        {
            let first = all.positions.len() as u32;
            let sign = if flip { -1.0 } else { 1.0 };
            all.positions.extend(positions.iter().map(|&[x, y, z]| [sign * x + 4.0 * copy as f64, y, z]));
            for face in &faces {
                let corners = face.iter().map(|&corner| first + corner);
                match reverse {
                    true => all.face_vertices.extend(corners.rev()),
                    false => all.face_vertices.extend(corners),
                }
                all.face_offsets.push(all.face_vertices.len() as u32);
            }
        }
        // Numbered so, all of it looks outwards.
        Mesh::new(&all, &Limits::default()).expect("a usable mesh").canonical().mesh
    }

    #[test]
    fn a_mirrored_copy_is_told_from_one_that_was_moved() {
        let mesh = copies();
        let colours = shell_colours(&mesh);
        let of = |copy: usize| {
            let point = mesh.point_of_vertex[20 * copy];
            &colours[mesh.shell_of_point[point as usize] as usize]
        };
        assert_eq!(of(0).mirrored_in(of(1)), (0, 0.0));
        for copy in [2, 3] {
            let (points, share) = of(0).mirrored_in(of(copy));
            assert!(points >= 15 && share >= 0.75, "{points} {share}");
        }
        assert!((1..4).all(|copy| of(0).are_like(of(copy))));
    }
}
