//! Mirrors a selection of faces: exactly where faces have mirrored faces, otherwise by their vertices.

use super::mirror_selection;
use crate::base::error::Result;
use crate::detect::correspondence::Symmetry;
use crate::mesh::{Mesh, PolygonMesh};
use std::collections::HashMap;

/// The point of no partner: not that of a vertex without faces.
const NO_POINT: i32 = -2;

/// Mirrors a selection of faces, one entry per caller's face.
///
/// A face whose corners have the corners of another face as their partners, or places of such corners, is selected if that one is.
/// Any other face is selected if all its corners are in the mirror image of the corners of the selected faces
/// ([`mirror_selection`]). Faces with a corner below `minimum_confidence` are never selected. `mesh` is that of the `polygons`.
/// O(corners) in time and memory.
///
/// # Errors
/// [`Error::Option`](crate::Error::Option) for a confidence outside 0..=1.
///
/// # Panics
/// If `selected` has not one entry per face, or `symmetry` one per vertex.
pub fn mirror_face_selection(
    mesh: &Mesh,
    polygons: &PolygonMesh,
    symmetry: &Symmetry,
    selected: &[bool],
    minimum_confidence: f32,
) -> Result<Vec<bool>> {
    let count = polygons.face_offsets.len().saturating_sub(1);
    assert_eq!(selected.len(), count);
    let corners = |face: usize| {
        let range = polygons.face_offsets[face] as usize..polygons.face_offsets[face + 1] as usize;
        &polygons.face_vertices[range]
    };
    let mut touched = vec![false; polygons.positions.len()];
    for face in (0..count).filter(|&face| selected[face]) {
        corners(face).iter().for_each(|&vertex| touched[vertex as usize] = true);
    }
    let mirrored = mirror_selection(symmetry, &touched, minimum_confidence)?;
    let twins = |number: &dyn Fn(i32) -> i32| -> Vec<Option<usize>> {
        let own = |face| (sorted(corners(face).iter().map(|&vertex| number(vertex as i32))), face);
        let by_corners: HashMap<Vec<i32>, usize> = (0..count).map(own).collect();
        let partner = |&vertex: &u32| number(symmetry.partner[vertex as usize]);
        (0..count).map(|face| by_corners.get(&sorted(corners(face).iter().map(partner))).copied()).collect()
    };
    let mut twin = twins(&|vertex| vertex);
    if mesh.repairs.welded_vertices > 0 {
        let point = |vertex| usize::try_from(vertex).map_or(NO_POINT, |at| mesh.point_of_vertex[at] as i32);
        let by_place = twins(&point);
        twin.iter_mut().zip(by_place).for_each(|(twin, there)| *twin = twin.or(there));
    }
    let trusted = |&vertex: &u32| symmetry.confidence[vertex as usize] >= minimum_confidence;
    let belongs = |face: usize| {
        let image = || twin[face].map(|twin| selected[twin]);
        let by_vertices = || corners(face).iter().all(|&vertex| mirrored[vertex as usize]);
        !corners(face).is_empty() && corners(face).iter().all(trusted) && image().unwrap_or_else(by_vertices)
    };
    Ok((0..count).map(belongs).collect())
}

fn sorted(vertices: impl Iterator<Item = i32>) -> Vec<i32> {
    let mut vertices: Vec<i32> = vertices.collect();
    vertices.sort_unstable();
    vertices
}
