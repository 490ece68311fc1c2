//! Limits on what is read and solved, so that a hostile or mistaken file cannot exhaust memory.

use crate::base::error::{Error, Result};

/// Upper bounds checked before memory is taken. The defaults suit a workstation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most vertices of a mesh.
    pub vertices: u64,
    /// Most faces (polygons) of a mesh, and most triangles after triangulation.
    pub faces: u64,
    /// Largest file that is read, in bytes.
    pub file_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits { vertices: 5_000_000, faces: 10_000_000, file_bytes: 2 << 30 }
    }
}

impl Limits {
    /// Refuses a vertex count above the limit.
    pub fn check_vertices(&self, found: u64) -> Result<()> {
        check("the number of vertices", found, self.vertices)
    }

    /// Refuses a face count above the limit.
    pub fn check_faces(&self, found: u64) -> Result<()> {
        check("the number of faces", found, self.faces)
    }

    /// Refuses a file size above the limit.
    pub fn check_file_bytes(&self, found: u64) -> Result<()> {
        check("the file's size in bytes", found, self.file_bytes)
    }
}

/// Bytes that a detection takes at its peak, its mesh included: an upper estimate from the peaks of `make bench`.
///
/// `solved` are the vertices on which the map is sought.
pub fn estimated_memory(vertices: usize, solved: usize, eigenfunctions: usize) -> u64 {
    const FIXED: usize = 60_000_000;
    const A_VERTEX: usize = 700;
    const A_SOLVED_VERTEX: usize = 600;
    const AN_EIGENFUNCTION: usize = 36;
    (FIXED + A_VERTEX * vertices + solved * (A_SOLVED_VERTEX + AN_EIGENFUNCTION * eigenfunctions)) as u64
}

/// Refuses what needs more than `limit` MB; 0 is no limit.
///
/// # Errors
/// [`Error::Limit`].
pub fn check_memory(needed: u64, limit: usize) -> Result<()> {
    let limit = if limit == 0 { u64::MAX } else { limit as u64 };
    check("the estimated memory in MB", needed.div_ceil(1_000_000), limit)
}

fn check(what: &'static str, found: u64, limit: u64) -> Result<()> {
    if found > limit { Err(Error::Limit { what, found, limit }) } else { Ok(()) }
}
