//! `isym_mesh_*`: meshes from arrays and files, and their detection.

use super::eigen::{EIGENS, isym_eigen};
use super::handles::Table;
use super::memory::{Output, array, expect, product, text};
use super::options::{isym_options, options_of};
use super::panic_boundary::boundary;
use super::progress::{isym_progress, progress_of};
use super::result::{RESULTS, ResultObject, isym_result};
use super::status::{Fault, ISYM_ERROR_VALUE, Result, isym_status};
use intrinsym::io::Format;
use intrinsym::{Limits, Mesh, PolygonMesh, detect, detect_again, eigen, io};
use std::ffi::c_char;
use std::path::{Path, PathBuf};

/// A validated mesh. It never changes; any number of calls in any threads may use it at once.
pub struct isym_mesh(());

/// Live meshes.
pub static MESHES: Table<isym_mesh, MeshObject> = Table::new("mesh");

/// What a mesh handle stands for.
pub struct MeshObject {
    /// As the caller gave it.
    pub polygons: PolygonMesh,
    /// As the pipeline wants it.
    pub mesh: Mesh,
    /// Where it was read from.
    pub source: Option<Source>,
}

/// The file of a mesh.
pub struct Source {
    /// As the caller wrote it.
    pub path: PathBuf,
    /// By its content.
    pub format: Format,
    /// What the reader did.
    pub notes: Vec<String>,
}

impl MeshObject {
    fn new(polygons: PolygonMesh, source: Option<Source>) -> Result<MeshObject> {
        let mesh = Mesh::new(&polygons, &Limits::default())?;
        Ok(MeshObject { polygons, mesh, source })
    }

    /// Number of the caller's vertices.
    pub fn vertex_count(&self) -> usize {
        self.polygons.positions.len()
    }
}

/// The caller's arrays that make a mesh.
struct Arrays<T> {
    positions: *const T,
    vertex_count: usize,
    face_offsets: Option<*const u32>,
    face_count: usize,
    corners: *const u32,
    corner_count: usize,
}

impl<T: Copy + Into<f64>> Arrays<T> {
    /// # Safety
    /// Each array has the length that is said of it.
    unsafe fn polygons(&self) -> Result<PolygonMesh> {
        // Before anything is copied.
        Limits::default().check_vertices(self.vertex_count as u64)?;
        Limits::default().check_faces(self.face_count as u64)?;
        // SAFETY: this function's own condition, for all three.
        let coordinates = unsafe { array(self.positions, product(self.vertex_count, 3)?, "positions") }?;
        let face_vertices = unsafe { array(self.corners, self.corner_count, "the face vertices") }?;
        let face_offsets = match self.face_offsets {
            Some(offsets) => unsafe { array(offsets, self.face_count + 1, "face_offsets") }?,
            None => (0..=self.face_count as u32).map(|face| 3 * face).collect(),
        };
        let positions =
            coordinates.chunks_exact(3).map(|c| [c[0].into(), c[1].into(), c[2].into()]).collect();
        Ok(PolygonMesh { positions, face_offsets, face_vertices })
    }

    /// # Safety
    /// As [`Arrays::polygons`], and one handle can be written to `mesh`.
    unsafe fn make(&self, mesh: *mut *mut isym_mesh) -> Result {
        // SAFETY: this function's own condition.
        let (output, polygons) = unsafe { (Output::new(mesh, 1, "mesh")?, self.polygons()?) };
        output.write(&[MESHES.insert(MeshObject::new(polygons, None)?)]);
        Ok(())
    }
}

/// Makes a mesh of triangles. The arrays are copied.
///
/// Non-manifold edges, several shells, boundaries, inconsistent orientation, duplicate and degenerate faces and unreferenced
/// vertices are accepted (the report says what was repaired); numbers that are not finite, indices past the end, and a mesh
/// without any area are not.
///
/// @param positions x, y, z of each vertex, 3 * vertex_count numbers, any unit.
/// @param vertex_count Number of vertices, at most 5 million.
/// @param triangles 3 * triangle_count vertex numbers from 0.
/// @param triangle_count Number of triangles, at most 10 million.
/// @param[out] mesh Free it with `isym_mesh_free`.
/// @return `ISYM_OK`, `ISYM_ERROR_MESH`, `ISYM_ERROR_LIMIT`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_from_triangles(
    positions: *const f64,
    vertex_count: usize,
    triangles: *const u32,
    triangle_count: usize,
    mesh: *mut *mut isym_mesh,
) -> isym_status {
    boundary(|| {
        let corner_count = product(triangle_count, 3)?;
        let (face_offsets, face_count, corners) = (None, triangle_count, triangles);
        let arrays = Arrays { positions, vertex_count, face_offsets, face_count, corners, corner_count };
        // SAFETY: the caller's one promise.
        unsafe { arrays.make(mesh) }
    })
}

/// As `isym_mesh_from_triangles`, with single-precision positions.
///
/// @param positions x, y, z of each vertex, 3 * vertex_count numbers, any unit.
/// @param vertex_count Number of vertices.
/// @param triangles 3 * triangle_count vertex numbers from 0.
/// @param triangle_count Number of triangles.
/// @param[out] mesh Free it with `isym_mesh_free`.
/// @return As `isym_mesh_from_triangles`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_from_triangles_f32(
    positions: *const f32,
    vertex_count: usize,
    triangles: *const u32,
    triangle_count: usize,
    mesh: *mut *mut isym_mesh,
) -> isym_status {
    boundary(|| {
        let corner_count = product(triangle_count, 3)?;
        let (face_offsets, face_count, corners) = (None, triangle_count, triangles);
        let arrays = Arrays { positions, vertex_count, face_offsets, face_count, corners, corner_count };
        // SAFETY: the caller's one promise.
        unsafe { arrays.make(mesh) }
    })
}

/// As `isym_mesh_from_triangles`, for polygons of any size.
///
/// @param positions x, y, z of each vertex, 3 * vertex_count numbers, any unit.
/// @param vertex_count Number of vertices.
/// @param face_offsets face_count + 1 rising numbers from 0 to corner_count: the corners of face f are
/// `corners[face_offsets[f]]` to before `corners[face_offsets[f + 1]]`.
/// @param face_count Number of faces.
/// @param corners Vertex numbers from 0.
/// @param corner_count Number of corners of all faces.
/// @param[out] mesh Free it with `isym_mesh_free`.
/// @return As `isym_mesh_from_triangles`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_from_polygons(
    positions: *const f64,
    vertex_count: usize,
    face_offsets: *const u32,
    face_count: usize,
    corners: *const u32,
    corner_count: usize,
    mesh: *mut *mut isym_mesh,
) -> isym_status {
    boundary(|| {
        let face_offsets = Some(face_offsets);
        let arrays = Arrays { positions, vertex_count, face_offsets, face_count, corners, corner_count };
        // SAFETY: the caller's one promise.
        unsafe { arrays.make(mesh) }
    })
}

/// As `isym_mesh_from_polygons`, with single-precision positions.
///
/// @param positions x, y, z of each vertex, 3 * vertex_count numbers, any unit.
/// @param vertex_count Number of vertices.
/// @param face_offsets face_count + 1 rising numbers from 0 to corner_count: the corners of face f are
/// `corners[face_offsets[f]]` to before `corners[face_offsets[f + 1]]`.
/// @param face_count Number of faces.
/// @param corners Vertex numbers from 0.
/// @param corner_count Number of corners of all faces.
/// @param[out] mesh Free it with `isym_mesh_free`.
/// @return As `isym_mesh_from_triangles`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_from_polygons_f32(
    positions: *const f32,
    vertex_count: usize,
    face_offsets: *const u32,
    face_count: usize,
    corners: *const u32,
    corner_count: usize,
    mesh: *mut *mut isym_mesh,
) -> isym_status {
    boundary(|| {
        let face_offsets = Some(face_offsets);
        let arrays = Arrays { positions, vertex_count, face_offsets, face_count, corners, corner_count };
        // SAFETY: the caller's one promise.
        unsafe { arrays.make(mesh) }
    })
}

/// Reads a mesh from a PLY, OBJ, OFF, STL, glTF or GLB file.
///
/// @param path The file, UTF-8.
/// @param[out] mesh Free it with `isym_mesh_free`.
/// @return `ISYM_OK`; `ISYM_ERROR_FILE`: the text names the line or byte that is wrong; `ISYM_ERROR_MESH`,
/// `ISYM_ERROR_LIMIT`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_read(path: *const c_char, mesh: *mut *mut isym_mesh) -> isym_status {
    boundary(|| {
        // SAFETY: the caller's one promise, for both.
        let (path, output) = unsafe { (text(path, "path")?, Output::new(mesh, 1, "mesh")?) };
        let file = io::read(Path::new(&path), &Limits::default())?;
        let source = Source { path: path.into(), format: file.format, notes: file.notes };
        output.write(&[MESHES.insert(MeshObject::new(file.polygons, Some(source))?)]);
        Ok(())
    })
}

/// Reads what the mesh was made with.
///
/// @param mesh The mesh.
/// @param[out] vertex_count Number of vertices.
/// @param[out] face_count Number of faces.
/// @param[out] corner_count Number of corners of all faces.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_size(
    mesh: *const isym_mesh,
    vertex_count: *mut usize,
    face_count: *mut usize,
    corner_count: *mut usize,
) -> isym_status {
    boundary(|| {
        let mesh = MESHES.get(mesh)?;
        // SAFETY: the caller's one promise, for all three.
        let vertices = unsafe { Output::new(vertex_count, 1, "vertex_count") }?;
        let faces = unsafe { Output::new(face_count, 1, "face_count") }?;
        let corners = unsafe { Output::new(corner_count, 1, "corner_count") }?;
        vertices.write(&[mesh.vertex_count()]);
        faces.write(&[mesh.polygons.face_offsets.len() - 1]);
        corners.write(&[mesh.polygons.face_vertices.len()]);
        Ok(())
    })
}

/// Copies the vertices' positions out.
///
/// @param mesh The mesh.
/// @param[out] positions x, y, z of each vertex.
/// @param length 3 * vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_LENGTH`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_positions(
    mesh: *const isym_mesh,
    positions: *mut f64,
    length: usize,
) -> isym_status {
    boundary(|| {
        let mesh = MESHES.get(mesh)?;
        let values = mesh.polygons.positions.as_flattened();
        // SAFETY: the caller's one promise.
        unsafe { Output::new(positions, length, "positions") }?.expect(values.len())?.write(values);
        Ok(())
    })
}

/// Copies the faces out, in the form of `isym_mesh_from_polygons`.
///
/// @param mesh The mesh.
/// @param[out] face_offsets Where the corners of each face begin, and their end.
/// @param offset_count Faces + 1.
/// @param[out] corners Vertex numbers from 0.
/// @param corner_count Number of corners of all faces.
/// @return `ISYM_OK`, `ISYM_ERROR_LENGTH`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_polygons(
    mesh: *const isym_mesh,
    face_offsets: *mut u32,
    offset_count: usize,
    corners: *mut u32,
    corner_count: usize,
) -> isym_status {
    boundary(|| {
        let mesh = MESHES.get(mesh)?;
        let (offsets, vertices) = (&mesh.polygons.face_offsets, &mesh.polygons.face_vertices);
        // SAFETY: the caller's one promise, for both.
        let first = unsafe { Output::new(face_offsets, offset_count, "face_offsets") }?;
        let second = unsafe { Output::new(corners, corner_count, "corners") }?;
        let (first, second) = (first.expect(offsets.len())?, second.expect(vertices.len())?);
        first.write(offsets);
        second.write(vertices);
        Ok(())
    })
}

/// Reads a 64-bit hash of the connectivity: number of vertices, face sizes and corners, not the positions.
///
/// Equal for equal connectivity on every machine and in every version. Keep it beside a stored map: where it has changed, the
/// map is stale.
///
/// @param mesh The mesh.
/// @param[out] hash The hash.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_connectivity_hash(mesh: *const isym_mesh, hash: *mut u64) -> isym_status {
    boundary(|| {
        let mesh = MESHES.get(mesh)?;
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(hash, 1, "hash") }?;
        output.write(&[intrinsym::connectivity_hash(&mesh.polygons)]);
        Ok(())
    })
}

/// Finds the intrinsic symmetries of the mesh.
///
/// That none was found is a result without symmetries, and no error. The result keeps what it needs of the mesh, which may be
/// freed before it. One call uses at most as many threads as its options say; calls in several threads run side by side.
///
/// @param mesh The mesh.
/// @param options NULL for the defaults.
/// @param progress NULL: nothing is reported, and nobody can cancel.
/// @param[out] result Free it with `isym_result_free`.
/// @return `ISYM_OK`, `ISYM_ERROR_CANCELLED`, `ISYM_ERROR_CALLBACK`, `ISYM_ERROR_LIMIT`;
/// `ISYM_ERROR_MODEL`, with a sign network of your own.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_detect(
    mesh: *const isym_mesh,
    options: *const isym_options,
    progress: *mut isym_progress,
    result: *mut *mut isym_result,
) -> isym_status {
    boundary(|| {
        let (mesh, options, progress) = (MESHES.get(mesh)?, options_of(options)?, progress_of(progress)?);
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(result, 1, "result") }?;
        let detection = progress.run(|progress| detect(&mesh.mesh, &options, progress))?;
        output.write(&[RESULTS.insert(ResultObject::new(mesh, detection, &options)?)]);
        Ok(())
    })
}

/// As `isym_mesh_detect`, starting from an earlier result on a mesh with the same connectivity and other positions: some seven
/// times as fast while the shape is deformed.
///
/// If the first symmetry of `previous` is still one, it is kept with all others that still are: partners, surface points,
/// confidences, sides and fixed curves as they were, scores and the report new (its `kept` is true). Otherwise, or if
/// `previous` has none, this is a detection, and the report says why. What is kept knows nothing of vertices that were slid
/// along the surface, on one side alone: detect anew after that.
///
/// A result that was not restored also holds what the call needs of the connectivity (some 1 MB, and 4 bytes a vertex), which
/// the new one shares: hand over the newest or the first, not a restored one, and the call takes half the time.
///
/// @param mesh The mesh as it is now.
/// @param previous May be restored, and may be freed after the call.
/// @param options NULL for the defaults.
/// @param progress NULL: nothing is reported, and nobody can cancel.
/// @param[out] result Free it with `isym_result_free`.
/// @return As `isym_mesh_detect`; `ISYM_ERROR_VALUE`: `previous` is of another connectivity (`isym_mesh_connectivity_hash`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_detect_again(
    mesh: *const isym_mesh,
    previous: *const isym_result,
    options: *const isym_options,
    progress: *mut isym_progress,
    result: *mut *mut isym_result,
) -> isym_status {
    boundary(|| {
        let (mesh, previous) = (MESHES.get(mesh)?, RESULTS.get(previous)?);
        let (options, progress) = (options_of(options)?, progress_of(progress)?);
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(result, 1, "result") }?;
        if !previous.mesh.polygons.has_connectivity_of(&mesh.polygons) {
            return Err(Fault::new(ISYM_ERROR_VALUE, "the previous result is of another connectivity"));
        }
        let detection =
            progress.run(|progress| detect_again(&mesh.mesh, previous.previous(), &options, progress))?;
        output.write(&[RESULTS.insert(ResultObject::new(mesh, detection, &options)?)]);
        Ok(())
    })
}

/// Computes the lowest eigenpairs of the Laplace-Beltrami operator on the mesh's largest shell, the constant function left out.
///
/// @param mesh The mesh.
/// @param count How many, 1 to 1000.
/// @param progress NULL: nothing is reported, and nobody can cancel.
/// @param[out] eigenpairs Free them with `isym_eigen_free`.
/// @return `ISYM_OK`, `ISYM_ERROR_CANCELLED`, `ISYM_ERROR_CALLBACK`; `ISYM_ERROR_VALUE`: another count.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_mesh_eigen(
    mesh: *const isym_mesh,
    count: usize,
    progress: *mut isym_progress,
    eigenpairs: *mut *mut isym_eigen,
) -> isym_status {
    boundary(|| {
        let (mesh, progress) = (MESHES.get(mesh)?, progress_of(progress)?);
        // SAFETY: the caller's one promise.
        let output = unsafe { Output::new(eigenpairs, 1, "eigenpairs") }?;
        if !(1..=1000).contains(&count) {
            return Err(Fault::new(ISYM_ERROR_VALUE, format!("count is {count}, outside 1..=1000")));
        }
        let found = progress.run(|progress| eigen(&mesh.mesh, count, progress))?;
        output.write(&[EIGENS.insert(found)]);
        Ok(())
    })
}

/// Frees a mesh. Results made from it, and calls that run with it, stay usable.
///
/// @param mesh The mesh; NULL is fine.
/// @return `ISYM_OK`, `ISYM_ERROR_HANDLE`.
#[unsafe(no_mangle)]
pub extern "C" fn isym_mesh_free(mesh: *mut isym_mesh) -> isym_status {
    boundary(|| MESHES.remove(mesh))
}

/// Refuses an array that has not one entry for each of the mesh's vertices.
pub fn expect_vertices(mesh: &MeshObject, found: usize) -> Result {
    expect(found, mesh.vertex_count(), "vertex_count says that each array")
}
