//! The refusals: what no repair can make a surface of. Each names the first bad element.

use super::PolygonMesh;
use crate::base::error::{Error, Result};
use crate::base::limits::Limits;

/// Refuses polygons that are not a mesh, before anything is built from them.
///
/// # Errors
/// [`Error::Mesh`] naming the first bad element and what to do; [`Error::Limit`].
pub fn check(polygons: &PolygonMesh, limits: &Limits) -> Result<()> {
    check_counts(polygons, limits)?;
    check_offsets(polygons)?;
    check_triangle_count(polygons, limits)?;
    check_coordinates(&polygons.positions)?;
    check_indices(polygons)
}

/// Refuses a mesh all of whose faces were dropped.
pub fn check_any_face_left(left: usize, given: usize) -> Result<()> {
    if left > 0 {
        return Ok(());
    }
    Err(Error::Mesh(format!(
        "none of its {given} faces has three corners at different points; check how the faces were exported"
    )))
}

/// Refuses a mesh that has no area at all.
pub fn check_area(total: f64) -> Result<()> {
    if total > 0.0 {
        return Ok(());
    }
    Err(Error::Mesh(
        "its total area is zero: the corners of every face lie on one line or in one point; \
         check the scale and the precision it was exported with"
            .into(),
    ))
}

fn check_counts(polygons: &PolygonMesh, limits: &Limits) -> Result<()> {
    if polygons.positions.is_empty() {
        return Err(Error::Mesh("it has no vertices; export the geometry again".into()));
    }
    if polygons.face_offsets.len() < 2 {
        return Err(Error::Mesh(
            "it has no faces, only vertices; export a surface, or reconstruct one from the points first"
                .into(),
        ));
    }
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
    if offsets[0] != 0 {
        return Err(Error::Mesh(format!("the face offsets start at {} instead of 0", offsets[0])));
    }
    if let Some(face) = offsets.windows(2).position(|pair| pair[1] < pair[0]) {
        return Err(Error::Mesh(format!(
            "the face offsets decrease after face {face}, from {} to {}; each must be at least the one before",
            offsets[face],
            offsets[face + 1]
        )));
    }
    let (last, corners) = (offsets[offsets.len() - 1] as usize, polygons.face_vertices.len());
    if last != corners {
        return Err(Error::Mesh(format!(
            "the last face offset is {last} but there are {corners} face corners; they must agree"
        )));
    }
    Ok(())
}

fn check_triangle_count(polygons: &PolygonMesh, limits: &Limits) -> Result<()> {
    let triangles =
        polygons.face_offsets.windows(2).map(|pair| u64::from(pair[1] - pair[0]).saturating_sub(2));
    limits.check_faces(triangles.sum())
}

fn check_coordinates(positions: &[[f64; 3]]) -> Result<()> {
    for (vertex, position) in positions.iter().enumerate() {
        if let Some(axis) = position.iter().position(|coordinate| !coordinate.is_finite()) {
            return Err(Error::Mesh(format!(
                "vertex {vertex} has {} = {}; every coordinate must be a finite number",
                ["x", "y", "z"][axis],
                position[axis]
            )));
        }
    }
    Ok(())
}

fn check_indices(polygons: &PolygonMesh) -> Result<()> {
    let count = polygons.positions.len();
    let Some(corner) = polygons.face_vertices.iter().position(|&vertex| vertex as usize >= count) else {
        return Ok(());
    };
    let face = polygons.face_offsets.partition_point(|&offset| offset as usize <= corner) - 1;
    Err(Error::Mesh(format!(
        "face {face} refers to vertex {}, but there are only {count} vertices, numbered from 0; \
         the file is cut off or its indices start elsewhere",
        polygons.face_vertices[corner]
    )))
}
