//! A mesh of another format as a glTF: positions and triangles, nothing else.

use super::Block;
use super::write::{ARRAY_BUFFER, FLOAT, GltfFile};
use crate::base::error::Result;
use crate::base::limits::Limits;
use crate::mesh::polygons::Polygons;
use crate::mesh::{PolygonMesh, RepairReport, triangulate, validate};
use serde_json::json;

const UNSIGNED_INT: u32 = 5125;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

impl GltfFile {
    /// A file that holds positions and triangles only.
    pub fn of_polygons(mesh: &PolygonMesh) -> Result<GltfFile> {
        let unlimited = Limits { vertices: u64::MAX, faces: u64::MAX, file_bytes: u64::MAX };
        validate::check(mesh, &unlimited)?;
        let polygons = Polygons::clean(mesh, &mut RepairReport::default());
        let (triangles, _) = triangulate::triangulate(&polygons, &mesh.positions);
        let positions: Vec<[f32; 3]> =
            mesh.positions.iter().map(|position| position.map(|number| number as f32)).collect();
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
        let json = json!({
            "asset": { "version": "2.0" },
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0 }],
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
