//! `isym_eigen_*`: eigenvalues and eigenfunctions, for those who want to see them.

use super::handles::Table;
use super::memory::{Output, product};
use super::status::{boundary, isym_status};
use intrinsym::Eigen;

/// Eigenpairs of a mesh, from `isym_mesh_eigen`. They never change.
pub struct isym_eigen(());

/// Live eigenpairs.
pub static EIGENS: Table<isym_eigen, Eigen> = Table::new("eigenpairs handle");

/// Reads the numbers of vertices and of eigenpairs.
///
/// @param eigenpairs The eigenpairs.
/// @param[out] vertex_count Number of the mesh's vertices.
/// @param[out] count Number of eigenpairs: fewer than asked for on a tiny mesh.
/// @return `ISYM_OK`, or an error that any call has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_eigen_size(
    eigenpairs: *const isym_eigen,
    vertex_count: *mut usize,
    count: *mut usize,
) -> isym_status {
    boundary(|| {
        let found = EIGENS.get(eigenpairs)?;
        // SAFETY: the caller's one promise, for both.
        let vertices = unsafe { Output::new(vertex_count, 1, "vertex_count") }?;
        let pairs = unsafe { Output::new(count, 1, "count") }?;
        vertices.write(&[found.lumped_mass.len()]);
        pairs.write(&[found.eigenvalues.len()]);
        Ok(())
    })
}

/// Copies the eigenpairs out. The sign of a function has no meaning.
///
/// @param eigenpairs The eigenpairs.
/// @param[out] eigenvalues `count` numbers, ascending, in units of 1 / area of the largest shell.
/// @param[out] eigenfunctions vertex_count * count numbers, those of one vertex side by side; orthonormal in the mass; NaN where
/// the vertex is not on the largest shell.
/// @param[out] mass vertex_count numbers that sum to 1; 0 where the vertex is not on that shell.
/// @param vertex_count That of `isym_eigen_size`.
/// @param count That of `isym_eigen_size`.
/// @return `ISYM_OK`, `ISYM_ERROR_LENGTH`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isym_eigen_read(
    eigenpairs: *const isym_eigen,
    eigenvalues: *mut f64,
    eigenfunctions: *mut f64,
    mass: *mut f64,
    vertex_count: usize,
    count: usize,
) -> isym_status {
    boundary(|| {
        let found = EIGENS.get(eigenpairs)?;
        // SAFETY: the caller's one promise, for all three.
        let values = unsafe { Output::new(eigenvalues, count, "eigenvalues") }?;
        let functions =
            unsafe { Output::new(eigenfunctions, product(vertex_count, count)?, "eigenfunctions") }?;
        let masses = unsafe { Output::new(mass, vertex_count, "mass") }?;
        let (values, masses) =
            (values.expect(found.eigenvalues.len())?, masses.expect(found.lumped_mass.len())?);
        functions.expect(found.eigenfunctions.len())?.write(&found.eigenfunctions);
        values.write(&found.eigenvalues);
        masses.write(&found.lumped_mass);
        Ok(())
    })
}

/// Frees eigenpairs.
///
/// @param eigenpairs The eigenpairs; NULL is fine.
/// @return `ISYM_OK`, `ISYM_ERROR_HANDLE`.
#[unsafe(no_mangle)]
pub extern "C" fn isym_eigen_free(eigenpairs: *mut isym_eigen) -> isym_status {
    boundary(|| EIGENS.remove(eigenpairs))
}
