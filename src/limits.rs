//! Limits on what is read and solved, so that a hostile or mistaken file cannot exhaust memory.

use crate::error::{Error, Result};

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

fn check(what: &'static str, found: u64, limit: u64) -> Result<()> {
    if found > limit { Err(Error::Limit { what, found, limit }) } else { Ok(()) }
}
