//! A mesh of another format as a glTF: positions and triangles, nothing else.

use super::Block;
use super::write::{ARRAY_BUFFER, FLOAT, GltfFile};
use crate::base::limits::Limits;
use crate::mesh::io::scanner::Fault;
use crate::mesh::polygons::Polygons;
use crate::mesh::{PolygonMesh, RepairReport, triangulate, validate};
use serde_json::json;

const UNSIGNED_INT: u32 = 5125;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// So many times as far from 0 as it is large, a mesh is given a place of its own: 20 of the 24 bits of single precision are left to its
/// shape until there.
const FAR: f64 = 16.0;
/// The least size of a mesh in single precision: below it less than 24 bits are left to its shape.
const LEAST_SIZE: f64 = f32::MIN_POSITIVE as f64 * (1 << 24) as f64;

/// The place of a mesh, from which its positions are counted: 0 along an axis, or the middle of its faces where that is far away. It is a
/// number of single precision, so that no position in single precision changes.
pub fn place(mesh: &PolygonMesh) -> [f64; 3] {
    let (lowest, highest) = bounds(mesh);
    let middle = [0, 1, 2].map(|axis| 0.5 * lowest[axis] + 0.5 * highest[axis]);
    let far = FAR * size(lowest, highest);
    middle.map(|middle| if middle.abs() > far { f64::from(middle as f32) } else { 0.0 })
}

/// Lowest and highest coordinates of the corners of faces.
fn bounds(mesh: &PolygonMesh) -> ([f64; 3], [f64; 3]) {
    let start = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    mesh.face_vertices.iter().fold(start, |(lowest, highest), &corner| {
        let position = mesh.positions[corner as usize];
        let choose = |of: [f64; 3], choose: fn(f64, f64) -> f64| {
            [0, 1, 2].map(|axis| choose(of[axis], position[axis]))
        };
        (choose(lowest, f64::min), choose(highest, f64::max))
    })
}

/// The longest side of a box.
fn size(lowest: [f64; 3], highest: [f64; 3]) -> f64 {
    (0..3).map(|axis| highest[axis] - lowest[axis]).fold(0.0, f64::max)
}

/// The positions from a `place` in single precision; refuses a mesh that this cannot hold.
fn positions(mesh: &PolygonMesh, place: [f64; 3]) -> Result<Vec<[f32; 3]>, Fault> {
    let (lowest, highest) = bounds(mesh);
    let size = size(lowest, highest);
    if size > 0.0 && size < LEAST_SIZE {
        return Err(Fault::new(format!(
            "the mesh is {size:e} large, and in a glTF, which is of single precision, from {LEAST_SIZE:.0e} on; write a .ply"
        )));
    }
    let positions: Vec<[f32; 3]> = (mesh.positions.iter())
        .map(|position| [0, 1, 2].map(|axis| (position[axis] - place[axis]) as f32))
        .collect();
    let is_beyond = |position: &[f32; 3]| position.iter().any(|number| !number.is_finite());
    match positions.iter().position(is_beyond) {
        Some(vertex) => Err(Fault::new(format!(
            "vertex {vertex} is beyond {:.1e}, the largest number of a glTF, which is of single precision; write a .ply",
            f32::MAX
        ))),
        None => Ok(positions),
    }
}

impl GltfFile {
    /// A file that holds positions and triangles only.
    pub fn of_polygons(mesh: &PolygonMesh) -> Result<GltfFile, Fault> {
        let unlimited = Limits { vertices: u64::MAX, faces: u64::MAX, file_bytes: u64::MAX };
        validate::check(mesh, &unlimited)?;
        let polygons = Polygons::clean(mesh, &mut RepairReport::default());
        let (triangles, _) = triangulate::triangulate(&polygons, &mesh.positions);
        let place = place(mesh);
        let positions = positions(mesh, place)?;
        let bound = |start: f32, choose: fn(f32, f32) -> f32| {
            positions
                .iter()
                .fold([start; 3], |bound, position| [0, 1, 2].map(|axis| choose(bound[axis], position[axis])))
        };
        let (lowest, highest) = (bound(f32::INFINITY, f32::min), bound(f32::NEG_INFINITY, f32::max));
        let mut binary: Vec<u8> =
            positions.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
        let start = binary.len();
        binary.extend(triangles.as_flattened().iter().flat_map(|corner| corner.to_le_bytes()));
        let node = match place {
            [0.0, 0.0, 0.0] => json!({ "mesh": 0 }),
            _ => json!({ "mesh": 0, "translation": place }),
        };
        let json = json!({
            "asset": { "version": "2.0" },
            "scenes": [{ "nodes": [0] }],
            "nodes": [node],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
            "accessors": [
                { "bufferView": 0, "componentType": FLOAT, "count": positions.len(), "type": "VEC3", "min": lowest, "max": highest },
                { "bufferView": 1, "componentType": UNSIGNED_INT, "count": 3 * triangles.len(), "type": "SCALAR" },
            ],
            "bufferViews": [
                { "buffer": 0, "byteLength": start, "target": ARRAY_BUFFER },
                { "buffer": 0, "byteOffset": start, "byteLength": binary.len() - start, "target": ELEMENT_ARRAY_BUFFER },
            ],
        });
        let block = Block { node: 0, primitives: vec![0], vertices: 0..positions.len() };
        Ok(GltfFile {
            json: json.to_string().into_bytes(),
            binary,
            starts: vec![0],
            blocks: vec![block],
            has_colours: false,
        })
    }
}
