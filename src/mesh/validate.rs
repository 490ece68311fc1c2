//! The refusals: what no repair can make a surface of. Each names the first bad element.

use super::PolygonMesh;
use crate::base::error::{MeshFault, Result};
use crate::base::limits::Limits;
use crate::mesh::vector::{Vector, subtract};

/// The largest distance from the middle, over the usual one: from ten times as much on the masses of vertices differ too much for the
/// eigenproblem.
const FARTHEST: f64 = 1e8;
/// Corners whose distance counts as usual in the median.
const LOOKED_AT: u64 = 1000;

/// Refuses polygons that are not a mesh, before anything is built from them.
///
/// # Errors
/// [`crate::Error::Mesh`] naming the first bad element and what to do; [`crate::Error::Limit`].
pub fn check(polygons: &PolygonMesh, limits: &Limits) -> Result<()> {
    check_counts(polygons, limits)?;
    check_offsets(polygons)?;
    check_triangle_count(polygons, limits)?;
    check_coordinates(&polygons.positions)?;
    check_indices(polygons)
}

/// Refuses a mesh all of whose faces were dropped.
pub fn check_any_face_left(left: usize, given: usize) -> Result<()> {
    refuse_if(left == 0, MeshFault::NoFaceLeft { faces: given })
}

/// Refuses a mesh that has no area at all.
pub fn check_area(total: f64) -> Result<()> {
    refuse_if(total.is_nan() || total <= 0.0, MeshFault::NoArea)
}

/// Refuses a mesh most of which is almost one point beside a vertex far away.
pub fn check_spread(corners: &[u32], positions: &[Vector]) -> Result<()> {
    let at = |corner: u32| positions[corner as usize];
    // Spread over all corners by the golden ratio: every third corner may be the same hub.
    let place = |i: u64| (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) as u128 * corners.len() as u128) >> 64;
    let looked_at = || (0..LOOKED_AT).map(|i| corners[place(i) as usize]);
    let middle = [0, 1, 2].map(|axis| median(looked_at().map(|corner| at(corner)[axis]).collect()));
    let away = |corner: u32| subtract(at(corner), middle).map(f64::abs).into_iter().fold(0.0, f64::max);
    let usual = median(looked_at().map(away).collect());
    let farthest = corners.iter().copied().max_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or(0);
    // Where the usual distance is 0 the vertices lie in one place, which is a matter of its own.
    let is_far = usual > 0.0 && usual * FARTHEST < away(farthest);
    refuse_if(is_far, MeshFault::TooFar { vertex: farthest as usize })
}

fn median(mut values: Vec<f64>) -> f64 {
    let half = values.len() / 2;
    *values.select_nth_unstable_by(half, f64::total_cmp).1
}

fn refuse_if(is_bad: bool, fault: MeshFault) -> Result<()> {
    if is_bad { Err(fault.into()) } else { Ok(()) }
}

fn check_counts(polygons: &PolygonMesh, limits: &Limits) -> Result<()> {
    refuse_if(polygons.positions.is_empty(), MeshFault::NoVertices)?;
    refuse_if(polygons.face_offsets.len() < 2, MeshFault::NoFaces)?;
    let largest_index = u64::from(u32::MAX) - 1;
    let limits = Limits {
        vertices: limits.vertices.min(largest_index),
        faces: limits.faces.min(largest_index),
        ..*limits
    };
    limits.check_vertices(polygons.positions.len() as u64)?;
    limits.check_faces(polygons.face_offsets.len() as u64 - 1)
}

fn check_offsets(polygons: &PolygonMesh) -> Result<()> {
    let offsets = &polygons.face_offsets;
    refuse_if(offsets[0] != 0, MeshFault::FirstOffset { offset: offsets[0] })?;
    if let Some(face) = offsets.windows(2).position(|pair| pair[1] < pair[0]) {
        return Err(MeshFault::Offsets { face, from: offsets[face], to: offsets[face + 1] }.into());
    }
    let (last, corners) = (offsets[offsets.len() - 1], polygons.face_vertices.len());
    refuse_if(last as usize != corners, MeshFault::LastOffset { offset: last, corners })
}

fn check_triangle_count(polygons: &PolygonMesh, limits: &Limits) -> Result<()> {
    let triangles =
        polygons.face_offsets.windows(2).map(|pair| u64::from(pair[1] - pair[0]).saturating_sub(2));
    limits.check_faces(triangles.sum())
}

fn check_coordinates(positions: &[[f64; 3]]) -> Result<()> {
    for (vertex, position) in positions.iter().enumerate() {
        if let Some(axis) = position.iter().position(|coordinate| !coordinate.is_finite()) {
            return Err(MeshFault::NotFinite { vertex, axis, value: position[axis] }.into());
        }
    }
    Ok(())
}

fn check_indices(polygons: &PolygonMesh) -> Result<()> {
    let vertices = polygons.positions.len();
    let Some(corner) = polygons.face_vertices.iter().position(|&vertex| vertex as usize >= vertices) else {
        return Ok(());
    };
    let face = polygons.face_offsets.partition_point(|&offset| offset as usize <= corner) - 1;
    Err(MeshFault::Index { face, vertex: polygons.face_vertices[corner], vertices }.into())
}
