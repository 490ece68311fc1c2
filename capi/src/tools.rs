//! `isym_result_mirror_*`, `_carry_*`, `_symmetrize_*`: what hosts do with a symmetry.

use super::memory::{Output, Versioned, array, expect, number, product, structure};
use super::mesh::expect_vertices;
use super::panic_boundary::boundary;
use super::progress::{isym_progress, progress_of};
use super::result::{RESULTS, ResultObject, isym_result};
use super::status::{Fault, ISYM_ERROR_LENGTH, ISYM_ERROR_VALUE, Result, isym_status};
use intrinsym::mirror::curve_distance::curve_distances;
use intrinsym::mirror::faces::mirror_face_selection;
use intrinsym::mirror::frames::carry_displacement;
use intrinsym::mirror::positions::symmetrize;
use intrinsym::mirror::{Merge, Mirroring, mirror_selection, mirror_values};
use std::mem::MaybeUninit;
use std::sync::Arc;

/// Which vertices take the value of their mirror image.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum isym_merge {
    /// Every vertex: the two sides are exchanged. This is also how an attribute named "left" becomes "right".
    ISYM_MERGE_SWAP = 0,
    /// Every vertex takes the mean of its own and its image's value.
    ISYM_MERGE_AVERAGE = 1,
    /// Vertices with side -1 take it; side 1 stays, and so does the fixed curve.
    ISYM_MERGE_POSITIVE_WINS = 2,
    /// Vertices with side 1 take it; side -1 stays, and so does the fixed curve.
    ISYM_MERGE_NEGATIVE_WINS = 3,
}
pub use isym_merge::*;

/// The library's own values.
const MERGES: [(isym_merge, Merge); 4] = [
    (ISYM_MERGE_SWAP, Merge::Swap),
    (ISYM_MERGE_AVERAGE, Merge::Average),
    (ISYM_MERGE_POSITIVE_WINS, Merge::PositiveWins),
    (ISYM_MERGE_NEGATIVE_WINS, Merge::NegativeWins),
];

/// How mirrored values meet the old ones.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct isym_mirroring {
    /// `sizeof` of this struct, set by the caller before the call.
    pub size: usize,
    /// A half turn has no sides: only swap and average.
    pub merge: MaybeUninit<isym_merge>,
    /// Vertices with less confidence keep their value; 0..=1.
    pub minimum_confidence: f32,
    /// 0: trusted vertices change wholly. 1: each changes by the share of its confidence.
    pub weight_by_confidence: i32,
}

// SAFETY: as declared above.
unsafe impl Versioned for isym_mirroring {}

impl isym_mirroring {
    fn checked(self) -> Result<Mirroring> {
        // SAFETY: the caller's one promise: the struct is filled.
        let number = unsafe { number(self.merge) };
        let Some(&(_, merge)) = MERGES.iter().find(|(known, _)| *known as i32 == number) else {
            return Err(Fault::new(ISYM_ERROR_VALUE, format!("{number} is no ISYM_MERGE_ constant")));
        };
        let weight_by_confidence = match self.weight_by_confidence {
            0 => false,
            1 => true,
            other => {
                let message = format!("weight_by_confidence is {other}, neither 0 nor 1");
                return Err(Fault::new(ISYM_ERROR_VALUE, message));
            }
        };
        Ok(Mirroring { merge, minimum_confidence: self.minimum_confidence, weight_by_confidence })
    }
}

/// The result of a handle, if its mesh has as many vertices as the caller's arrays.
fn result_for(handle: *const isym_result, vertex_count: usize) -> Result<Arc<ResultObject>> {
    let result = RESULTS.get(handle)?;
    expect_vertices(&result.mesh, vertex_count)?;
    Ok(result)
}

/// # Safety
/// `mirroring` is NULL or points to one, of as many bytes as its first field says.
unsafe fn mirroring_of(mirroring: *const isym_mirroring) -> Result<Mirroring> {
    // SAFETY: this function's own condition.
    unsafe { structure(mirroring, "mirroring") }?.checked()
}

/// # Safety
/// `3 * vertex_count` numbers can be read at `values`, unless it is NULL.
unsafe fn vectors(values: *const f64, vertex_count: usize, name: &str) -> Result<Vec<[f64; 3]>> {
    // SAFETY: this function's own condition.
    let flat = unsafe { array(values, product(vertex_count, 3)?, name) }?;
    if let Some(index) = flat.iter().position(|value| !value.is_finite()) {
        let (vertex, value) = (index / 3, flat[index]);
        return Err(Fault::new(ISYM_ERROR_VALUE, format!("{name}: vertex {vertex} has {value}")));
    }
    Ok(flat.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect())
}

/// Mirrors a selection of vertices: selects those whose mirror image lies in it.
///
/// A vertex of a denser side selects its partner even where that stands for several.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param selected One byte per vertex, 0 or 1 (any other number counts as 1).
/// @param minimum_confidence Vertices with less, 0..=1, are not selected.
/// @param[out] mirrored One byte per vertex, 0 or 1; may be `selected`.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`; `ISYM_ERROR_OPTION`: a number is outside its range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_mirror_selection(
    result: *const isym_result,
    symmetry: usize,
    selected: *const u8,
    minimum_confidence: f32,
    mirrored: *mut u8,
    vertex_count: usize,
) -> isym_status {
    boundary(|| {
        let result = result_for(result, vertex_count)?;
        // SAFETY: the caller's one promise, for both.
        let selected = unsafe { array(selected, vertex_count, "selected") }?;
        let output = unsafe { Output::new(mirrored, vertex_count, "mirrored") }?;
        let selected: Vec<bool> = selected.into_iter().map(|byte| byte != 0).collect();
        let found = mirror_selection(result.symmetry(symmetry)?, &selected, minimum_confidence)?;
        output.write(&found.into_iter().map(u8::from).collect::<Vec<_>>());
        Ok(())
    })
}

/// Mirrors a selection of faces: selects those whose mirror image is selected.
///
/// Where connectivity is mirrored, faces go to their exact mirror images; elsewhere a face is selected if all its corners are
/// in the mirror image of the selected faces' corners.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param selected One byte per face that the mesh was made with, 0 or 1 (any other number counts as 1).
/// @param minimum_confidence Faces with a corner of less, 0..=1, are not selected.
/// @param[out] mirrored One byte per face, 0 or 1; may be `selected`.
/// @param face_count Number of the mesh's faces.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`; `ISYM_ERROR_OPTION`: a number is outside its range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_mirror_face_selection(
    result: *const isym_result,
    symmetry: usize,
    selected: *const u8,
    minimum_confidence: f32,
    mirrored: *mut u8,
    face_count: usize,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        let (mesh, polygons) = (&result.mesh.mesh, &result.mesh.polygons);
        expect(face_count, polygons.face_offsets.len() - 1, "selected")?;
        // SAFETY: the caller's one promise, for both.
        let selected = unsafe { array(selected, face_count, "selected") }?;
        let output = unsafe { Output::new(mirrored, face_count, "mirrored") }?;
        let selected: Vec<bool> = selected.into_iter().map(|byte| byte != 0).collect();
        let symmetry = result.symmetry(symmetry)?;
        let found = mirror_face_selection(mesh, polygons, symmetry, &selected, minimum_confidence)?;
        output.write(&found.into_iter().map(u8::from).collect::<Vec<_>>());
        Ok(())
    })
}

/// Mirrors a vertex attribute of any number of components: weights, colours, masks, texture coordinates.
///
/// Vectors in space need `isym_result_carry_displacement` instead.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param mirroring Its `size` is set before the call.
/// @param values components * vertex_count numbers, those of one vertex side by side.
/// @param components Numbers of one vertex, 1 or more.
/// @param[out] mirrored As `values`; may be the same array.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`, `ISYM_ERROR_SIZE`, `ISYM_ERROR_VALUE`; `ISYM_ERROR_OPTION`: the
/// confidence is outside its range, or a half turn has no sides.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_mirror_values(
    result: *const isym_result,
    symmetry: usize,
    mirroring: *const isym_mirroring,
    values: *const f64,
    components: usize,
    mirrored: *mut f64,
    vertex_count: usize,
) -> isym_status {
    boundary(|| {
        let result = result_for(result, vertex_count)?;
        let length = product(components, vertex_count)?;
        if components == 0 {
            return Err(Fault::new(ISYM_ERROR_LENGTH, "components is 0"));
        }
        // SAFETY: the caller's one promise, for all three.
        let mirroring = unsafe { mirroring_of(mirroring) }?;
        let values = unsafe { array(values, length, "values") }?;
        let output = unsafe { Output::new(mirrored, length, "mirrored") }?;
        output.write(&mirror_values(result.symmetry(symmetry)?, &values, components, &mirroring)?);
        Ok(())
    })
}

/// Carries a displacement field across the map in local frames, so that it is right in any pose: a shape key, or an edit since a
/// remembered state. It is turned and stretched with the surface.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param mirroring Its `size` is set before the call.
/// @param positions x, y, z of each vertex of the shape that is displaced, in the pose it is in.
/// @param displacements x, y, z of each vertex, in any unit.
/// @param[out] carried As `displacements`; may be the same array.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`, `ISYM_ERROR_SIZE`, `ISYM_ERROR_VALUE`; `ISYM_ERROR_OPTION`: the
/// confidence is outside its range, or a half turn has no sides.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_carry_displacement(
    result: *const isym_result,
    symmetry: usize,
    mirroring: *const isym_mirroring,
    positions: *const f64,
    displacements: *const f64,
    carried: *mut f64,
    vertex_count: usize,
) -> isym_status {
    boundary(|| {
        let result = result_for(result, vertex_count)?;
        // SAFETY: the caller's one promise, for all four.
        let mirroring = unsafe { mirroring_of(mirroring) }?;
        let positions = unsafe { vectors(positions, vertex_count, "positions") }?;
        let displacements = unsafe { vectors(displacements, vertex_count, "displacements") }?;
        let output = unsafe { Output::new(carried, product(vertex_count, 3)?, "carried") }?;
        let (mesh, symmetry) = (&result.mesh.mesh, result.symmetry(symmetry)?);
        let found = carry_displacement(mesh, symmetry, &positions, &displacements, &mirroring)?;
        output.write(found.as_flattened());
        Ok(())
    })
}

/// Makes positions symmetric across the map in local frames: each side keeps its pose and takes the other's shape, or both the
/// mean of the two.
///
/// What is much smaller than the surface is carried whole; what is as large as a limb's pose stays. Solves one sparse system.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param mirroring Its `size` is set before the call.
/// @param positions x, y, z of each vertex, in any unit and pose.
/// @param progress NULL: nothing is reported, and nobody can cancel.
/// @param[out] symmetrized As `positions`; may be the same array.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`, `ISYM_ERROR_SIZE`, `ISYM_ERROR_VALUE`; `ISYM_ERROR_OPTION`: the
/// confidence is outside its range, or a half turn has no sides. Also
/// `ISYM_ERROR_CANCELLED`, `ISYM_ERROR_CALLBACK`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_symmetrize_positions(
    result: *const isym_result,
    symmetry: usize,
    mirroring: *const isym_mirroring,
    positions: *const f64,
    progress: *mut isym_progress,
    symmetrized: *mut f64,
    vertex_count: usize,
) -> isym_status {
    boundary(|| {
        let result = result_for(result, vertex_count)?;
        let progress = progress_of(progress)?;
        // SAFETY: the caller's one promise, for all three.
        let mirroring = unsafe { mirroring_of(mirroring) }?;
        let positions = unsafe { vectors(positions, vertex_count, "positions") }?;
        let output = unsafe { Output::new(symmetrized, product(vertex_count, 3)?, "symmetrized") }?;
        let (mesh, symmetry) = (&result.mesh.mesh, result.symmetry(symmetry)?);
        let found = progress.run(|progress| symmetrize(mesh, symmetry, &positions, &mirroring, progress))?;
        output.write(found.as_flattened());
        Ok(())
    })
}

/// Measures how far each vertex is from the fixed curve, along the surface.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param positions x, y, z of each vertex, in any unit and pose.
/// @param[out] distances vertex_count numbers in that unit; infinite where the curve cannot be reached: on other shells, without a
/// curve, and with a result from `isym_result_restore`, which has none.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`; `ISYM_ERROR_VALUE`: a position is not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_curve_distances(
    result: *const isym_result,
    symmetry: usize,
    positions: *const f64,
    distances: *mut f64,
    vertex_count: usize,
) -> isym_status {
    boundary(|| {
        let result = result_for(result, vertex_count)?;
        // SAFETY: the caller's one promise, for both.
        let positions = unsafe { vectors(positions, vertex_count, "positions") }?;
        let output = unsafe { Output::new(distances, vertex_count, "distances") }?;
        output.write(&curve_distances(&result.mesh.mesh, result.symmetry(symmetry)?, &positions));
        Ok(())
    })
}
