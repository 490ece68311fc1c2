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

/// Which shells have as many lookalikes as [`super::almost`] asks for. Others have no bijection, no pairing but for a few
/// defects, and hardly one of half of the shell: that asks for lookalikes of half of its vertices within three rings.
/// O(corners + points log points).
pub(super) fn shells_with_lookalikes(mesh: &Mesh) -> Vec<bool> {
    let mut colours = vec![0; mesh.point_count()];
    for _ in 0..ROUNDS {
        colours = refined(mesh, &colours);
    }
    let mut of_shell: Vec<(u64, u32)> =
        colours.into_iter().zip(mesh.shell_of_point.iter().copied()).collect();
    of_shell.sort_unstable();
    let mut counts = vec![[0usize; 2]; mesh.shell_count];
    for alike in of_shell.chunk_by(|a, b| a.0 == b.0) {
        for &(_, shell) in alike {
            let [repeated, points] = &mut counts[shell as usize];
            *points += 1;
            *repeated += usize::from(alike.len() > 1);
        }
    }
    counts.iter().map(|&[repeated, points]| repeated as f64 >= REPEATED * points as f64).collect()
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
