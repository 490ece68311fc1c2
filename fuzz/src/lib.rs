//! What the targets share.

#[path = "../../tests/support/hostile.rs"]
pub mod hostile;

use intrinsym::{Limits, Mesh, PolygonMesh, io};
use std::path::Path;

/// Small, so that an input is slow only by a mistake of ours.
pub const LIMITS: Limits = Limits { vertices: 20_000, faces: 40_000, file_bytes: 1 << 20 };

/// Reads bytes as a file of this name, and makes a mesh of what is in it.
pub fn read(name: &str, bytes: &[u8]) {
    if let Ok(file) = io::parse(Path::new(name), bytes, &LIMITS) {
        validated(&file.polygons);
    }
}

/// Validates and holds the mesh against what every later stage relies on.
pub fn validated(polygons: &PolygonMesh) -> Option<Mesh> {
    let mesh = Mesh::new(polygons, &LIMITS).ok()?;
    let points = mesh.positions.len();
    assert!(points > 0 && !mesh.triangles.is_empty());
    assert!(mesh.positions.as_flattened().iter().all(|coordinate| coordinate.is_finite()));
    for triangle in &mesh.triangles {
        let [a, b, c] = *triangle;
        assert!(a != b && b != c && c != a, "{triangle:?} repeats a corner");
        assert!(triangle.iter().all(|&point| (point as usize) < points), "{triangle:?} of {points} points");
    }
    assert_eq!(mesh.point_of_vertex.len(), polygons.positions.len());
    assert!(mesh.shell_of_point.iter().all(|&shell| (shell as usize) < mesh.shell_count));
    assert!(mesh.unit_length > 0.0 && mesh.unit_length.is_finite());
    Some(mesh)
}
