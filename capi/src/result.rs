//! `isym_result_*`: the symmetries that were found, as arrays and as a report.

use super::handles::Table;
use super::memory::{Output, Versioned, array, number, product};
use super::mesh::{MESHES, MeshObject, expect_vertices, isym_mesh};
use super::panic_boundary::boundary;
use super::status::{Fault, ISYM_ERROR_INDEX, ISYM_ERROR_VALUE, Result, isym_status};
use intrinsym::mirror::pair_colour::pair_colours;
use intrinsym::{
    Coverage, Detection, JudgingMesh, Options, Outcome, Previous, SurfacePoint, Symmetry, SymmetryKind,
    report,
};
use serde_json::json;
use std::ffi::{CString, c_char};
use std::mem::MaybeUninit;
use std::sync::Arc;

/// What was found on a mesh: symmetries (reflections, best first, then half turns) and a report. It never changes.
pub struct isym_result(());

/// The kind of a symmetry.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum isym_kind {
    /// Reverses orientation: left and right are exchanged.
    ISYM_KIND_REFLECTION = 0,
    /// Keeps orientation and is its own inverse. It has no sides and no fixed curve.
    ISYM_KIND_HALF_TURN = 1,
}
pub use isym_kind::*;

/// What was found.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum isym_outcome {
    /// At least one symmetry.
    ISYM_OUTCOME_FOUND = 0,
    /// A map is given, and the report's "evidence" says what speaks against it: it is less plausible than was asked for, or its
    /// confidence is low over most of the surface.
    ISYM_OUTCOME_DOUBTFUL = 1,
    /// No map came near to a symmetry; the report says why.
    ISYM_OUTCOME_NONE = 2,
}
pub use isym_outcome::*;

/// No such element, in arrays of indices.
pub const ISYM_NONE: u32 = u32::MAX;

/// Numbers of one symmetry as a whole.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct isym_summary {
    /// `sizeof` of this struct, set by the caller before the call.
    pub size: usize,
    /// Reflection or half turn.
    pub kind: isym_kind,
    /// How plausible it is, 0..=1, that it is a symmetry of the shape at all. The option "plausibility" says from where on one
    /// counts. A restored one has 1: it was accepted before.
    pub plausibility: f64,
    /// Lower is better; comparable between symmetries of one mesh.
    pub score: f64,
    /// Mean of the confidence over the surface, 0..=1.
    pub mean_confidence: f64,
    /// Share of the vertices whose partner comes from mirrored connectivity, an exact bijection; 0..=1.
    pub exact_share: f64,
    /// Share of the surface whose vertices have a partner, 0..=1.
    pub paired_share: f64,
    /// Shells (connected components) whose mirror image is another shell.
    pub shells_paired: usize,
    /// Shells that are their own mirror image.
    pub shells_self_mirrored: usize,
    /// Shells without a mirror image.
    pub shells_alone: usize,
}

// SAFETY: as declared above.
unsafe impl Versioned for isym_summary {}

/// Live results.
pub static RESULTS: Table<isym_result, ResultObject> = Table::new("result");

/// What a result handle stands for.
pub struct ResultObject {
    /// The mesh it was found on.
    pub mesh: Arc<MeshObject>,
    symmetries: Vec<Symmetry>,
    judging: Option<Arc<JudgingMesh>>,
    outcome: Outcome,
    continuous_family: bool,
    report: CString,
}

impl ResultObject {
    /// Keeps what was found, and makes the report.
    pub fn new(mesh: Arc<MeshObject>, detection: Detection, options: &Options) -> Result<ResultObject> {
        let mut value = report::json(&mesh.mesh, &detection, options)?;
        if let Some(source) = &mesh.source {
            value["input"] = json!(source.path.to_string_lossy());
            value["format"] = json!(source.format);
            value["notes"] = json!(source.notes);
        }
        // JSON holds no NUL: it escapes them.
        let report = CString::new(format!("{value:#}\n")).unwrap_or_default();
        let continuous_family = detection.report.continuous_family;
        let Detection { outcome, symmetries, judging, .. } = detection;
        Ok(ResultObject { mesh, symmetries, judging, outcome, continuous_family, report })
    }

    /// All that a later detection on the same connectivity starts from.
    pub fn previous(&self) -> Previous<'_> {
        Previous { symmetries: &self.symmetries, judging: self.judging.as_ref() }
    }

    /// Symmetry `index`.
    pub fn symmetry(&self, index: usize) -> Result<&Symmetry> {
        let count = self.symmetries.len();
        let missing = || Fault::new(ISYM_ERROR_INDEX, format!("there is no symmetry {index}, only {count}"));
        self.symmetries.get(index).ok_or_else(missing)
    }
}

/// Reads what was found.
///
/// @param result The result.
/// @param[out] outcome `ISYM_OUTCOME_FOUND` for a restored result: it was accepted before.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_outcome(
    result: *const isym_result,
    outcome: *mut isym_outcome,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        // SAFETY: the caller's one promise.
        unsafe { Output::new(outcome, 1, "outcome") }?.write(&[match result.outcome {
            Outcome::Found => ISYM_OUTCOME_FOUND,
            Outcome::Doubtful => ISYM_OUTCOME_DOUBTFUL,
            Outcome::None => ISYM_OUTCOME_NONE,
        }]);
        Ok(())
    })
}

/// Reads the number of symmetries that were found.
///
/// @param result The result.
/// @param[out] count A doubtful one counts; 0 if the mesh has none.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_symmetry_count(
    result: *const isym_result,
    count: *mut usize,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        // SAFETY: the caller's one promise.
        unsafe { Output::new(count, 1, "count") }?.write(&[result.symmetries.len()]);
        Ok(())
    })
}

/// Reads whether the mesh has a continuous family of symmetries, as a sphere, a torus or a vase has.
///
/// @param result The result.
/// @param[out] continuous_family 1: those found are arbitrary ones of infinitely many. 0: no; also for a restored result, where
/// nobody has looked.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_continuous_family(
    result: *const isym_result,
    continuous_family: *mut u8,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(continuous_family, 1, "continuous_family") }?;
        output.write(&[u8::from(result.continuous_family)]);
        Ok(())
    })
}

/// Reads the numbers of a symmetry as a whole.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[in,out] summary Its `size` is set before the call.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_SIZE`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_summary(
    result: *const isym_result,
    symmetry: usize,
    summary: *mut isym_summary,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::structure(summary, "summary") }?;
        let found = result.symmetry(symmetry)?;
        output.write(&[isym_summary {
            size: size_of::<isym_summary>(),
            kind: match found.kind {
                SymmetryKind::Reflection => ISYM_KIND_REFLECTION,
                SymmetryKind::HalfTurn => ISYM_KIND_HALF_TURN,
            },
            plausibility: found.plausibility,
            score: found.score,
            mean_confidence: found.mean_confidence,
            exact_share: found.exact_share,
            paired_share: found.coverage.paired_share,
            shells_paired: found.coverage.shells_paired,
            shells_self_mirrored: found.coverage.shells_self_mirrored,
            shells_alone: found.coverage.shells_alone,
        }]);
        Ok(())
    })
}

/// Copies the partner vertex of each vertex out.
///
/// Of several vertices in one place, as at seams, the partner is the one at the mirrored corner of the mirrored face. Where left
/// and right are not split alike, several vertices have one partner.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] partners `ISYM_NONE` for a vertex without partner, such as one that no face uses.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_partners(
    result: *const isym_result,
    symmetry: usize,
    partners: *mut u32,
    vertex_count: usize,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(partners, vertex_count, "partners") }?;
        let values = &result.symmetry(symmetry)?.partner;
        let output = output.expect(values.len())?;
        // -1 is no partner, which is `ISYM_NONE` in an unsigned number.
        output.write(&values.iter().map(|&partner| partner as u32).collect::<Vec<_>>());
        Ok(())
    })
}

/// Copies out how far each partner can be trusted.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] confidences The estimated probability, 0..=1, that the partner lies within 0.05 sqrt(area) of the true mirror image.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_confidences(
    result: *const isym_result,
    symmetry: usize,
    confidences: *mut f32,
    vertex_count: usize,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(confidences, vertex_count, "confidences") }?;
        let values = &result.symmetry(symmetry)?.confidence;
        output.expect(values.len())?.write(values);
        Ok(())
    })
}

/// Copies each vertex's side out.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] sides 1 and -1 on the two sides, 0 on the fixed curve, without partner, and everywhere for a half turn.
/// Which side is 1 has no meaning.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_sides(
    result: *const isym_result,
    symmetry: usize,
    sides: *mut i8,
    vertex_count: usize,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(sides, vertex_count, "sides") }?;
        let values = &result.symmetry(symmetry)?.side;
        output.expect(values.len())?.write(values);
        Ok(())
    })
}

/// Copies out the exact mirror image of each vertex, a point of the surface.
///
/// A vertex without partner has `ISYM_NONE` four times, and weights 0.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] faces vertex_count numbers of the faces that hold the images.
/// @param[out] corners 3 * vertex_count numbers of three vertices of that face, a triangle of it.
/// @param[out] barycentrics 3 * vertex_count weights of these, each 0..=1, summing to 1.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_surface_points(
    result: *const isym_result,
    symmetry: usize,
    faces: *mut u32,
    corners: *mut u32,
    barycentrics: *mut f32,
    vertex_count: usize,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        let three = product(vertex_count, 3)?;
        // SAFETY: the caller's one promise, for all three.
        let first = unsafe { Output::new(faces, vertex_count, "faces") }?;
        let second = unsafe { Output::new(corners, three, "corners") }?;
        let third = unsafe { Output::new(barycentrics, three, "barycentrics") }?;
        let points = &result.symmetry(symmetry)?.surface_point;
        let first = first.expect(points.len())?;
        let nowhere = SurfacePoint { face: ISYM_NONE, vertices: [ISYM_NONE; 3], barycentric: [0.0; 3] };
        let point = |index: usize| points[index].unwrap_or(nowhere);
        let all = 0..points.len();
        first.write(&all.clone().map(|index| point(index).face).collect::<Vec<_>>());
        second.write(&all.clone().flat_map(|index| point(index).vertices).collect::<Vec<_>>());
        third.write(&all.flat_map(|index| point(index).barycentric).collect::<Vec<_>>());
        Ok(())
    })
}

/// Copies out a colour for each vertex that its partner shares, and distinct pairs do not: the colours that the command line
/// writes. Grey where there is no partner or no confidence.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] colours 3 * vertex_count numbers: red, green, blue of each vertex, sRGB.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_pair_colours(
    result: *const isym_result,
    symmetry: usize,
    colours: *mut u8,
    vertex_count: usize,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        expect_vertices(&result.mesh, vertex_count)?;
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(colours, product(vertex_count, 3)?, "colours") }?;
        output.write(pair_colours(&result.mesh.mesh, result.symmetry(symmetry)?).as_flattened());
        Ok(())
    })
}

/// Reads the size of the fixed curve.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] line_count Number of lines; 0: there is no curve.
/// @param[out] point_count Number of points of all lines.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_curve_size(
    result: *const isym_result,
    symmetry: usize,
    line_count: *mut usize,
    point_count: *mut usize,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        // SAFETY: the caller's one promise, for both.
        let lines = unsafe { Output::new(line_count, 1, "line_count") }?;
        let points = unsafe { Output::new(point_count, 1, "point_count") }?;
        let curve = &result.symmetry(symmetry)?.fixed_curve;
        lines.write(&[curve.len()]);
        points.write(&[curve.iter().map(|line| line.points.len()).sum()]);
        Ok(())
    })
}

/// Copies the fixed curve out: where the map leaves the surface in place.
///
/// With no line at all there is nothing to copy, and no need to call this. Point p lies at
/// (1 - t) * `edges[2 * p]` + t * `edges[2 * p + 1]`, where t is `parameters[p]`.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] line_offsets line_count + 1 numbers; line l has the points from `line_offsets[l]` to before
/// `line_offsets[l + 1]`.
/// @param[out] closed line_count numbers, 1 where the last point joins the first, otherwise 0.
/// @param line_count That of `isym_result_curve_size`.
/// @param[out] edges 2 * point_count vertex numbers.
/// @param[out] parameters point_count numbers, 0..=1.
/// @param point_count That of `isym_result_curve_size`.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_curve(
    result: *const isym_result,
    symmetry: usize,
    line_offsets: *mut u32,
    closed: *mut u8,
    line_count: usize,
    edges: *mut u32,
    parameters: *mut f32,
    point_count: usize,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        // SAFETY: the caller's one promise, for all four.
        let starts = unsafe { Output::new(line_offsets, line_count.saturating_add(1), "line_offsets") }?;
        let closures = unsafe { Output::new(closed, line_count, "closed") }?;
        let ends = unsafe { Output::new(edges, product(point_count, 2)?, "edges") }?;
        let places = unsafe { Output::new(parameters, point_count, "parameters") }?;
        let lines = &result.symmetry(symmetry)?.fixed_curve;
        let points: Vec<_> = lines.iter().flat_map(|line| line.points.iter().copied()).collect();
        let (closures, places) = (closures.expect(lines.len())?, places.expect(points.len())?);
        let mut offsets = vec![0u32];
        offsets.extend(lines.iter().scan(0, |total, line| {
            *total += line.points.len() as u32;
            Some(*total)
        }));
        starts.write(&offsets);
        closures.write(&lines.iter().map(|line| u8::from(line.closed)).collect::<Vec<_>>());
        ends.write(&points.iter().flat_map(|point| [point.from, point.to]).collect::<Vec<_>>());
        places.write(&points.iter().map(|point| point.t).collect::<Vec<_>>());
        Ok(())
    })
}

/// Reads the size of the report.
///
/// @param result The result.
/// @param[out] size Number of bytes, with the final NUL.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_report_size(
    result: *const isym_result,
    size: *mut usize,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        // SAFETY: the caller's one promise.
        unsafe { Output::new(size, 1, "size") }?.write(&[result.report.as_bytes_with_nul().len()]);
        Ok(())
    })
}

/// Copies the report out: the JSON that `intrinsym detect --json` writes.
///
/// @param result The result.
/// @param[out] report UTF-8, with a final NUL.
/// @param size That of `isym_result_report_size`.
/// @return `ISYM_OK`, `ISYM_ERROR_LENGTH`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_report(
    result: *const isym_result,
    report: *mut c_char,
    size: usize,
) -> isym_status {
    boundary(|| {
        let result = RESULTS.get(result)?;
        let bytes = result.report.as_bytes_with_nul();
        // SAFETY: the caller's one promise.
        unsafe { Output::new(report.cast::<u8>(), size, "report") }?.expect(bytes.len())?.write(bytes);
        Ok(())
    })
}

/// Makes a result with one symmetry from stored arrays, so that the tools work on a map that was kept with a mesh.
///
/// All arrays are in the form in which this library gave them. Positions may have changed since; the connectivity may not
/// (compare `isym_mesh_connectivity_hash`).
///
/// @param mesh The mesh.
/// @param kind Reflection or half turn.
/// @param partners vertex_count numbers; `ISYM_NONE` for none.
/// @param confidences vertex_count numbers, 0..=1.
/// @param sides vertex_count numbers: -1, 0 or 1.
/// @param faces vertex_count numbers.
/// @param corners 3 * vertex_count numbers.
/// @param barycentrics 3 * vertex_count numbers.
/// @param vertex_count Number of the mesh's vertices.
/// @param[out] result Free it with `isym_result_free`.
/// @return `ISYM_OK`, `ISYM_ERROR_LENGTH`; `ISYM_ERROR_VALUE`: an entry cannot be right, and the text names it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_result_restore(
    mesh: *const isym_mesh,
    kind: MaybeUninit<isym_kind>,
    partners: *const u32,
    confidences: *const f32,
    sides: *const i8,
    faces: *const u32,
    corners: *const u32,
    barycentrics: *const f32,
    vertex_count: usize,
    result: *mut *mut isym_result,
) -> isym_status {
    boundary(|| {
        let mesh = MESHES.get(mesh)?;
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(result, 1, "result") }?;
        expect_vertices(&mesh, vertex_count)?;
        // SAFETY: the caller's one promise, for all six.
        let stored = unsafe {
            Stored {
                partners: array(partners, vertex_count, "partners")?,
                confidences: array(confidences, vertex_count, "confidences")?,
                sides: array(sides, vertex_count, "sides")?,
                faces: array(faces, vertex_count, "faces")?,
                corners: array(corners, product(vertex_count, 3)?, "corners")?,
                barycentrics: array(barycentrics, product(vertex_count, 3)?, "barycentrics")?,
            }
        };
        // SAFETY: C hands a number over.
        let symmetry = stored.symmetry(kind_of(unsafe { number(kind) })?, &mesh)?;
        let detection = Detection::restored(&mesh.mesh, symmetry);
        output.write(&[RESULTS.insert(ResultObject::new(mesh, detection, &Options::default())?)]);
        Ok(())
    })
}

/// Arrays of a map that a host has kept.
struct Stored {
    partners: Vec<u32>,
    confidences: Vec<f32>,
    sides: Vec<i8>,
    faces: Vec<u32>,
    corners: Vec<u32>,
    barycentrics: Vec<f32>,
}

impl Stored {
    fn symmetry(self, kind: SymmetryKind, mesh: &MeshObject) -> Result<Symmetry> {
        let faces = mesh.polygons.face_offsets.len() - 1;
        let points = (0..self.partners.len()).map(|vertex| self.point(vertex, faces));
        let surface_point = points.collect::<Result<Vec<_>>>()?;
        // As they were looked at: an index, or `ISYM_NONE`, which is -1.
        let partner: Vec<i32> = self.partners.iter().map(|&partner| partner as i32).collect();
        let sum: f64 = self.confidences.iter().copied().map(f64::from).sum();
        Ok(Symmetry {
            kind,
            mean_confidence: sum / partner.len().max(1) as f64,
            coverage: Coverage::of(&mesh.mesh, &partner),
            partner,
            surface_point,
            confidence: self.confidences,
            side: self.sides,
            fixed_curve: Vec::new(),
            score: 0.0,
            plausibility: 1.0,
            exact_share: 0.0,
        })
    }

    /// The image of a vertex, after its entries were looked at.
    fn point(&self, vertex: usize, faces: usize) -> Result<Option<SurfacePoint>> {
        let wrong = |what: String| Fault::new(ISYM_ERROR_VALUE, format!("vertex {vertex} has {what}"));
        let (count, partner) = (self.partners.len(), self.partners[vertex]);
        let (confidence, side) = (self.confidences[vertex], self.sides[vertex]);
        if partner != ISYM_NONE && partner as usize >= count {
            // As hosts write it, to whom `ISYM_NONE` is -1: no mesh has so many vertices.
            let shown = partner.cast_signed();
            return Err(wrong(format!("the partner {shown}; there are {count} vertices")));
        }
        if !(0.0..=1.0).contains(&confidence) {
            return Err(wrong(format!("the confidence {confidence}, outside 0..=1")));
        }
        if !(-1..=1).contains(&side) {
            return Err(wrong(format!("the side {side}; only -1, 0 and 1 are sides")));
        }
        if partner == ISYM_NONE {
            return Ok(None);
        }
        let three = 3 * vertex..3 * vertex + 3;
        let corners: [u32; 3] = self.corners[three.clone()].try_into().unwrap_or([ISYM_NONE; 3]);
        let weights: [f32; 3] = self.barycentrics[three].try_into().unwrap_or_default();
        if self.faces[vertex] as usize >= faces || corners.iter().any(|&corner| corner as usize >= count) {
            return Err(wrong(format!("the face {} with the corners {corners:?}", self.faces[vertex])));
        }
        let sum: f32 = weights.iter().sum();
        if weights.iter().any(|weight| !(0.0..=1.0).contains(weight)) || (sum - 1.0).abs() > 1e-3 {
            return Err(wrong(format!("the weights {weights:?}, which must be 0..=1 and sum to 1")));
        }
        Ok(Some(SurfacePoint { face: self.faces[vertex], vertices: corners, barycentric: weights }))
    }
}

fn kind_of(number: i32) -> Result<SymmetryKind> {
    match [ISYM_KIND_REFLECTION, ISYM_KIND_HALF_TURN].into_iter().find(|kind| *kind as i32 == number) {
        Some(ISYM_KIND_REFLECTION) => Ok(SymmetryKind::Reflection),
        Some(ISYM_KIND_HALF_TURN) => Ok(SymmetryKind::HalfTurn),
        None => Err(Fault::new(ISYM_ERROR_VALUE, format!("{number} is no kind of symmetry"))),
    }
}

/// Frees a result.
///
/// @param result The result; NULL is fine.
/// @return `ISYM_OK`, `ISYM_ERROR_HANDLE`.
#[unsafe(no_mangle)]
pub extern "C" fn isym_result_free(result: *mut isym_result) -> isym_status {
    boundary(|| RESULTS.remove(result))
}
