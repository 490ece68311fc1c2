//! Mirrors a selection of faces: exactly where faces have mirrored faces, otherwise by their vertices.

use super::mirror_selection;
use crate::base::error::Result;
use crate::detect::correspondence::Symmetry;
use crate::mesh::PolygonMesh;
use std::collections::HashMap;

/// Mirrors a selection of faces, one entry per caller's face.
///
/// A face whose corners have the corners of another face as their partners is selected if that one is. Any
/// other face is selected if all its corners are in the mirror image of the corners of the selected faces
/// ([`mirror_selection`]). Faces with a corner below `minimum_confidence` are never selected.
/// O(corners) in time and memory.
///
/// # Errors
/// [`Error::Option`](crate::Error::Option) for a confidence outside 0..=1.
///
/// # Panics
/// If `selected` has not one entry per face, or `symmetry` one per vertex.
pub fn mirror_face_selection(
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
    let by_corners: HashMap<Vec<i32>, usize> =
        (0..count).map(|face| (sorted(corners(face).iter().map(|&vertex| vertex as i32)), face)).collect();
    let twin = |face: usize| {
        let partners = corners(face).iter().map(|&vertex| symmetry.partner[vertex as usize]);
        by_corners.get(&sorted(partners)).copied()
    };
    let trusted = |&vertex: &u32| symmetry.confidence[vertex as usize] >= minimum_confidence;
    let belongs = |face: usize| {
        let image = || twin(face).map(|twin| selected[twin]);
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
