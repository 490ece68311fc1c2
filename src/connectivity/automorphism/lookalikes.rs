//! Whether the connectivity of a mesh may be mirrored at all, from its polygons alone.
//!
//! A vertex and its partner have one colour (Weisfeiler and Leman 1968; [`super::colours`] has the citation), so on mirrored
//! connectivity nearly every colour occurs twice. In independent triangulations few do: the surroundings of a vertex, five rings
//! wide, occur once. Vertices and faces are coloured in turn, which needs no half-edges.

use super::almost::REPEATED;
use super::colours::hash;
use crate::mesh::Mesh;

/// Rounds of colours: three leave lookalikes to half of an independent triangulation of 50,000 vertices, five to a thirtieth.
const ROUNDS: usize = 5;

/// Which shells have as many lookalikes as [`super::almost`] asks for. Others have no bijection, and no pairing but for a few
/// defects. O(corners + points log points).
pub(super) fn shells_with_lookalikes(mesh: &Mesh) -> Vec<bool> {
    let mut of_shell = coloured(mesh);
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

/// The colour of each point, and its shell.
fn coloured(mesh: &Mesh) -> Vec<(u64, u32)> {
    let mut colours = vec![0; mesh.point_count()];
    for _ in 0..ROUNDS {
        colours = refined(mesh, &colours);
    }
    colours.into_iter().zip(mesh.shell_of_point.iter().copied()).collect()
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

/// What is seen of a shell's connectivity that no mirroring changes.
#[derive(Debug, Clone, Copy)]
pub struct Signature {
    /// Two shells of different connectivity hardly ever have the same.
    pub hash: u64,
    /// Share of the points, 0..=1, that tell themselves from most others by their surroundings: next to nothing of a regular tube.
    pub distinct: f64,
}

/// The signature of each shell. O(corners + points log points).
pub fn shell_signatures(mesh: &Mesh) -> Vec<Signature> {
    let mut signatures = vec![Signature { hash: 0, distinct: 0.0 }; mesh.shell_count];
    let mut points = vec![0usize; mesh.shell_count];
    let mut of_shell = coloured(mesh);
    of_shell.sort_unstable_by_key(|&(colour, shell)| (shell, colour));
    for class in of_shell.chunk_by(|a, b| a == b) {
        let (colour, shell) = (class[0].0, class[0].1 as usize);
        let own = &mut signatures[shell];
        own.hash = own.hash.wrapping_add(hash(colour).wrapping_mul(class.len() as u64));
        own.distinct += if class.len() <= 2 { class.len() as f64 } else { 0.0 };
        points[shell] += class.len();
    }
    signatures.iter_mut().zip(points).for_each(|(own, points)| own.distinct /= points.max(1) as f64);
    signatures
}
