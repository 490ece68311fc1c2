//! glTF files: what of a scene becomes the mesh, what is refused, and what is written back.

use intrinsym::io::{self, AttributeValues, Format, MeshFile, Pose, VertexAttribute};
use intrinsym::{Error, Limits, Mesh};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A document that is put together value by value.
struct Builder {
    json: Value,
    binary: Vec<u8>,
}

impl Builder {
    fn new() -> Builder {
        let json = json!({
            "asset": { "version": "2.0", "generator": "by hand" },
            "accessors": [], "bufferViews": [], "buffers": [{}], "meshes": [], "nodes": [],
        });
        Builder { json, binary: Vec::new() }
    }

    fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let start = self.binary.len();
        self.binary.extend(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": start, "byteLength": bytes.len() }))
    }

    fn accessor(&mut self, component: u32, shape: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": component, "type": shape, "count": count }),
        )
    }

    fn floats<const N: usize>(&mut self, shape: &str, rows: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = rows.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
        self.accessor(5126, shape, rows.len(), &bytes)
    }

    fn indices(&mut self, corners: &[u16]) -> usize {
        let bytes: Vec<u8> = corners.iter().flat_map(|corner| corner.to_le_bytes()).collect();
        self.accessor(5123, "SCALAR", corners.len(), &bytes)
    }

    /// A mesh of one primitive and its node.
    fn show(&mut self, primitive: Value) -> usize {
        let mesh = self.push("meshes", json!({ "primitives": [primitive] }));
        self.push("nodes", json!({ "mesh": mesh }))
    }

    fn text(&self, uri: &str) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0] = json!({ "byteLength": self.binary.len(), "uri": uri });
        json.to_string().into_bytes()
    }

    fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0]["byteLength"] = json!(self.binary.len());
        glb(&json.to_string(), &self.binary)
    }

    fn read(&self) -> MeshFile {
        parse(&self.glb()).unwrap()
    }
}

fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let json = format!("{json:0$}", json.len().next_multiple_of(4)).into_bytes();
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json[..]), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

fn parse(bytes: &[u8]) -> Result<MeshFile, Error> {
    io::parse(Path::new("a.glb"), bytes, &Limits::default())
}

#[track_caller]
fn refused(bytes: &[u8], expected: &str) {
    let message = parse(bytes).expect_err(expected).to_string();
    assert!(message.contains(expected), "{message}");
}

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

/// Two triangles.
fn square() -> Builder {
    let mut builder = Builder::new();
    let (positions, corners) = (builder.floats("VEC3", &SQUARE), builder.indices(&[0, 1, 2, 2, 1, 3]));
    builder.show(json!({ "attributes": { "POSITION": positions }, "indices": corners }));
    builder
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gltf").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn nodes_place_their_meshes_one_after_the_other() {
    let mut builder = square();
    builder.json["nodes"] = json!([
        { "mesh": 0, "translation": [0, 0, 5] },
        { "children": [3], "scale": [2, 2, 2] },
        { "mesh": 0 },
        { "mesh": 0, "matrix": [0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1] },
    ]);
    builder.json["scenes"] = json!([{ "nodes": [2] }, { "nodes": [1, 0] }]);
    builder.json["scene"] = json!(1);
    let file = builder.read();
    assert_eq!((file.format, file.polygons.positions.len()), (Format::Gltf, 8));
    assert_eq!(file.polygons.positions[3], [1.0, 1.0, 5.0]);
    assert_eq!(file.polygons.positions[5], [6.0, 2.0, 0.0]);
    // The second one is mirrored, and its faces turned.
    assert_eq!(file.polygons.face_vertices, [0, 1, 2, 2, 1, 3, 4, 6, 5, 6, 7, 5]);
}

#[test]
fn strips_fans_and_lists_without_indices_are_triangles() {
    let corners = |mode: u32| {
        let mut builder = Builder::new();
        let positions =
            builder.floats("VEC3", &[SQUARE[0], SQUARE[1], SQUARE[3], SQUARE[2], [0.0; 3], [0.0; 3]]);
        builder.show(json!({ "attributes": { "POSITION": positions }, "mode": mode }));
        builder.read()
    };
    assert_eq!(corners(4).polygons.face_vertices, [0, 1, 2, 3, 4, 5]);
    assert_eq!(corners(5).polygons.face_vertices[..9], [0, 1, 2, 1, 3, 2, 2, 3, 4]);
    assert_eq!(corners(6).polygons.face_vertices[..6], [1, 2, 0, 2, 3, 0]);
    assert_eq!(corners(1).notes, ["1 primitives of points or lines were skipped."]);
}

#[test]
fn accessors_are_read_whatever_their_layout() {
    let mut builder = square();
    let expected = builder.read().polygons;
    // Quantised, and with other bytes between the elements.
    let bytes: Vec<u8> = SQUARE.iter().flat_map(|p| [p[0] as u8 * 255, p[1] as u8 * 255, 0, 99]).collect();
    let positions = builder.accessor(5121, "VEC3", 4, &bytes);
    builder.json["accessors"][positions]["normalized"] = json!(true);
    builder.json["bufferViews"][positions]["byteStride"] = json!(4);
    builder.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    builder.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(positions);
    assert_eq!(builder.read().polygons, expected);
    // Zeros but for two elements.
    let (at, values) = (builder.view(&[1, 2]), builder.floats("VEC3", &SQUARE[1..3]));
    let sparse = json!({ "count": 2, "indices": { "bufferView": at, "componentType": 5121 }, "values": { "bufferView": values + 1 } });
    let positions = builder
        .push("accessors", json!({ "componentType": 5126, "type": "VEC3", "count": 4, "sparse": sparse }));
    builder.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(positions);
    let found = builder.read().polygons;
    assert_eq!(found.positions[..3], expected.positions[..3]);
    assert_eq!(found.positions[3], [0.0; 3]);
}

#[test]
fn buffers_may_be_base64_text_or_lie_beside_the_file() {
    let builder = square();
    let expected = builder.read().polygons;
    let letters = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let base64: String = builder
        .binary
        .chunks(3)
        .flat_map(|bytes| {
            let bits =
                (0..3).fold(0u32, |bits, at| bits << 8 | u32::from(bytes.get(at).copied().unwrap_or(0)));
            (0..4).map(move |at| {
                if at > bytes.len() { '=' } else { letters[(bits >> (18 - 6 * at) & 63) as usize] as char }
            })
        })
        .collect();
    let text = builder.text(&format!("data:application/octet-stream;base64,{base64}"));
    assert_eq!(io::parse(Path::new("a.gltf"), &text, &Limits::default()).unwrap().polygons, expected);
    let folder = folder("beside");
    std::fs::write(folder.join("my data.bin"), &builder.binary).unwrap();
    let read = |uri: &str| io::parse(&folder.join("a.gltf"), &builder.text(uri), &Limits::default());
    assert_eq!(read("my%20data.bin").unwrap().polygons, expected);
    for outside in ["../beside/my data.bin", "/etc/passwd", "http://example.org/a.bin", "%2e%2e/a", "%zz", ""]
    {
        let message = read(outside).unwrap_err().to_string();
        assert!(message.contains("is not a file beside the mesh or below"), "{outside}: {message}");
    }
    assert!(read("data:text/plain,abc").unwrap_err().to_string().contains("is not base64 text"));
    assert!(read("none.bin").unwrap_err().to_string().contains("none.bin: cannot be read"));
}

/// A square whose upper two vertices follow a joint one above the origin.
fn skinned() -> Builder {
    let mut builder = square();
    let shift = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0];
    let mut still = shift;
    still[13] = 0.0;
    let inverse = builder.floats("MAT4", &[still, shift]);
    let joints = builder.accessor(5121, "VEC4", 4, &[0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    let weights = builder.floats("VEC4", &[[1.0, 0.0, 0.0, 0.0]; 4]);
    let attributes = &mut builder.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    builder.json["nodes"] = json!([
        { "mesh": 0, "skin": 0, "translation": [100, 100, 100] },
        { "children": [2] },
        { "translation": [0, 1, 0] },
    ]);
    builder.json["skins"] = json!([{ "joints": [1, 2], "inverseBindMatrices": inverse }]);
    builder
}

fn posed(builder: &Builder, animation: &str, time: f64) -> Result<MeshFile, Error> {
    let path = folder(&format!("posed{animation}{time}")).join("a.glb");
    std::fs::write(&path, builder.glb()).unwrap();
    io::read_posed(&path, &Limits::default(), Some(&Pose { animation: animation.into(), time }))
}

#[test]
fn skins_are_applied_at_rest_and_at_a_time() {
    let mut builder = skinned();
    let rest = builder.read().polygons.positions;
    assert_eq!(rest, SQUARE.map(|position| position.map(f64::from)), "the skin's own node does not count");
    let (half, times) = (0.5f32.sqrt(), builder.floats("SCALAR", &[[1.0], [3.0]]));
    let turns = builder.floats("VEC4", &[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, half, half]]);
    let lifts =
        builder.floats("VEC3", &[[0.0; 3], [0.0, 1.0, 0.0], [0.0; 3], [0.0; 3], [0.0, 2.0, 0.0], [0.0; 3]]);
    builder.json["animations"] = json!([
        { "name": "turn", "samplers": [{ "input": times, "output": turns }],
          "channels": [{ "sampler": 0, "target": { "node": 2, "path": "rotation" } }, { "sampler": 0, "target": { "path": "pointer" } }] },
        { "name": "lift", "samplers": [{ "input": times, "output": lifts, "interpolation": "CUBICSPLINE" }],
          "channels": [{ "sampler": 0, "target": { "node": 2, "path": "translation" } }] },
    ]);
    let at = |animation: &str, time: f64| posed(&builder, animation, time).unwrap().polygons.positions;
    assert_eq!(at("turn", 0.0), rest);
    let near = |found: [f64; 3], expected: [f64; 3]| {
        assert!((0..3).all(|k| (found[k] - expected[k]).abs() < 1e-6), "{found:?}")
    };
    near(at("turn", 9.0)[3], [0.0, 2.0, 0.0]);
    near(at("turn", 2.0)[3], [0.5f64.sqrt(), 1.0 + 0.5f64.sqrt(), 0.0]);
    near(at("lift", 2.0)[3], [1.0, 1.5, 0.0]);
    near(at("lift", 1.5)[3], [1.0, 1.0 + 0.15625, 0.0]);
    builder.json["accessors"][times]["count"] = json!(0);
    let message = posed(&builder, "turn", 0.0).unwrap_err().to_string();
    assert!(message.contains("has not one value for each of its times"), "{message}");
    let message = posed(&builder, "run", 0.0).unwrap_err().to_string();
    assert!(message.contains("no animation is named \"run\"; the file has: turn, lift"), "{message}");
    let off = folder("still").join("a.off");
    std::fs::write(&off, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").unwrap();
    let pose = Pose { animation: "turn".into(), time: 0.0 };
    let message = io::read_posed(&off, &Limits::default(), Some(&pose)).unwrap_err().to_string();
    assert!(message.contains("OFF has no animations"), "{message}");
}

#[test]
fn morph_targets_are_applied_by_their_weights() {
    let mut builder = square();
    let shifts = builder.floats("VEC3", &[[0.0, 0.0, 2.0]; 4]);
    builder.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "NORMAL": 0 }, { "POSITION": shifts }]);
    assert_eq!(builder.read().polygons.positions[3], [1.0, 1.0, 0.0]);
    builder.json["meshes"][0]["weights"] = json!([1, 0.5]);
    assert_eq!(builder.read().polygons.positions[3], [1.0, 1.0, 1.0]);
    builder.json["nodes"][0]["weights"] = json!([0, 1]);
    assert_eq!(builder.read().polygons.positions[3], [1.0, 1.0, 2.0]);
}

#[test]
fn faults_outside_the_geometry_do_not_matter() {
    let mut builder = square();
    builder.json["materials"] = json!("none");
    builder.json["textures"] = json!([{ "extensions": { "EXT_texture_webp": {} } }]);
    builder.json["extensionsRequired"] = json!(["EXT_texture_webp", "KHR_materials_unlit"]);
    builder.json["scenes"] = json!([{ "nodes": [0] }, {}]);
    assert_eq!(builder.read().polygons.positions.len(), 4);
}

#[test]
fn what_cannot_be_read_is_refused_in_words() {
    let with = |change: &dyn Fn(&mut Value)| {
        let mut builder = square();
        change(&mut builder.json);
        builder.glb()
    };
    let requires = |name: &str| with(&|json| json["extensionsRequired"] = json!([name]));
    refused(
        &requires("KHR_draco_mesh_compression"),
        "is compressed (KHR_draco_mesh_compression), which is not read",
    );
    refused(&requires("EXT_meshopt_compression"), "export it again without compression");
    refused(&requires("ACME_surfaces"), "requires the extension ACME_surfaces, which is not known");
    let nodes = |nodes: Value| with(&|json| json["nodes"] = nodes.clone());
    refused(&nodes(json!([{ "children": [1] }, { "children": [0], "mesh": 0 }])), "their own descendants");
    refused(
        &nodes(json!([{ "children": [2] }, { "children": [2] }, {}])),
        "node 2 is a child of both node 0 and node 1",
    );
    refused(&nodes(json!([{ "children": [7] }])), "refers to node 7, but has 1 of them");
    refused(&nodes(json!([{ "mesh": 3 }])), "refers to mesh 3");
    refused(&nodes(json!([{ "mesh": 0, "skin": 0 }])), "refers to skin 0");
    refused(&with(&|json| json["scenes"] = json!([{ "nodes": [9] }])), "refers to node 9");
    for (field, value, expected) in [
        ("count", 7, "accessor 1 reaches beyond the end of its buffer"),
        ("count", u64::MAX / 40, "the number of faces"),
        ("byteOffset", 4, "reaches beyond the end"),
        ("byteOffset", u64::MAX, "reaches beyond the end"),
    ] {
        refused(&with(&|json| json["accessors"][1][field] = json!(value)), expected);
    }
    refused(&with(&|json| json["bufferViews"][0]["byteLength"] = json!(u64::MAX)), "reaches beyond the end");
    refused(&with(&|json| json["bufferViews"][0]["buffer"] = json!(1)), "refers to buffer 1");
    refused(
        &with(&|json| json["accessors"][0]["type"] = json!("VEC2")),
        "is \"VEC2\" where 3 components are needed",
    );
    refused(&with(&|json| json["accessors"][0]["componentType"] = json!(5124)), "5124 is no component type");
    refused(&with(&|json| json["meshes"][0]["primitives"][0]["indices"] = json!(8)), "refers to accessor 8");
    refused(&with(&|json| json["nodes"] = json!("none")), "the JSON is not that of a glTF 2.0 file");
    let mut builder = square();
    builder.binary[48] = 4;
    refused(&builder.glb(), "refers to its vertex 4, but has 4");
    let mut builder = skinned();
    builder.json["skins"][0]["joints"] = json!([1]);
    refused(&builder.glb(), "refers to joint 1");
    builder.json["accessors"][3] = json!({ "componentType": 5121, "type": "VEC4", "count": 1u64 << 60 });
    refused(&builder.glb(), "accessor 3 has more elements than a mesh within the limits");
    refused(b"glTF\x01\0\0\0\x0c\0\0\0", "version 1");
    refused(b"glTF\x02\0\0\0\x0c\0\0\0", "has no JSON chunk");
}

#[test]
fn every_cut_of_a_file_is_refused() {
    let bytes = skinned().glb();
    for length in 1..bytes.len() {
        assert!(parse(&bytes[..length]).is_err(), "{length} of {} bytes are read", bytes.len());
    }
}

#[test]
fn counts_are_limited_before_memory_is_taken() {
    let of = |vertices, faces| {
        io::parse(Path::new("a.glb"), &square().glb(), &Limits { vertices, faces, ..Limits::default() })
    };
    assert!(of(4, 2).is_ok());
    assert!(matches!(of(3, 2), Err(Error::Limit { found: 4, .. })));
    assert!(matches!(of(4, 1), Err(Error::Limit { found: 2, .. })));
    let mut builder = square();
    builder.json["accessors"][0] = json!({ "componentType": 5126, "type": "VEC3", "count": u64::MAX });
    assert!(matches!(parse(&builder.glb()), Err(Error::Limit { .. })));
    builder.json["accessors"][0]["count"] = json!(4);
    builder.json["accessors"][1] = json!({ "componentType": 5125, "type": "SCALAR", "count": u64::MAX });
    assert!(matches!(parse(&builder.glb()), Err(Error::Limit { .. })));
}

/// A cube as exporters write it: each side has corners of its own.
fn cube() -> Builder {
    let side = |axis: usize, end: f32| {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[a, b]| {
            let mut corner = [0.0; 3];
            (corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3]) = (end, a, b * 1.5);
            corner
        })
    };
    let sides: Vec<[f32; 3]> = (0..3).flat_map(|axis| [side(axis, 0.0), side(axis, 1.0)]).flatten().collect();
    let mut builder = Builder::new();
    let attributes = json!({ "POSITION": builder.floats("VEC3", &sides) });
    let mut half = |sides: std::ops::Range<u16>| {
        let corners: Vec<u16> =
            sides.flat_map(|side| [0, 1, 2, 0, 2, 3].map(|corner| 4 * side + corner)).collect();
        json!({ "attributes": attributes, "indices": builder.indices(&corners), "material": 0 })
    };
    let primitives = [half(0..3), half(3..6)];
    builder.push("meshes", json!({ "primitives": primitives, "name": "cube" }));
    builder.push("nodes", json!({ "mesh": 0 }));
    builder
}

#[test]
fn primitives_share_vertices_and_seams_are_closed_and_given_back() {
    let mut builder = Builder::new();
    let positions: Vec<[f32; 3]> = SQUARE.into_iter().chain(SQUARE).collect();
    let positions = builder.floats("VEC3", &positions);
    let primitive = |corners| json!({ "attributes": { "POSITION": positions }, "indices": corners });
    let primitives = [builder.indices(&[0, 1, 2]), builder.indices(&[6, 5, 7])].map(primitive);
    builder.push("meshes", json!({ "primitives": primitives }));
    builder.push("nodes", json!({ "mesh": 0 }));
    let file = builder.read();
    assert_eq!(file.polygons.positions.len(), 8);
    let mesh = Mesh::new(&file.polygons, &Limits::default()).unwrap();
    assert_eq!((mesh.point_count(), mesh.shell_count, mesh.repairs.welded_vertices), (4, 1, 2));
    assert_eq!(mesh.point_of_vertex[1], mesh.point_of_vertex[5]);
}

/// JSON and bytes of a written file.
fn chunks(path: &Path) -> (Value, String, Vec<u8>) {
    let bytes = std::fs::read(path).unwrap();
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(number(8), bytes.len());
    let json = String::from_utf8(bytes[20..20 + number(12)].to_vec()).unwrap();
    let binary = bytes[28 + number(12)..].to_vec();
    assert_eq!(binary.len(), number(20 + number(12)));
    (serde_json::from_str(&json).unwrap(), json, binary)
}

fn floats(json: &Value, binary: &[u8], accessor: &Value) -> Vec<f32> {
    let accessor = &json["accessors"][accessor.as_u64().unwrap() as usize];
    assert_eq!((&accessor["componentType"], &accessor["type"]), (&json!(5126), &json!("SCALAR")));
    let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let start = view["byteOffset"].as_u64().unwrap() as usize;
    let bytes = &binary[start..start + view["byteLength"].as_u64().unwrap() as usize];
    let numbers: Vec<f32> = bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    assert_eq!(numbers.len() as u64, accessor["count"].as_u64().unwrap());
    numbers
}

fn attributes(count: usize) -> Vec<VertexAttribute> {
    let attribute = |name: &str, values| VertexAttribute { name: name.into(), values };
    vec![
        attribute("sym_vertex", AttributeValues::Int((0..count as i32).map(|vertex| vertex - 1).collect())),
        attribute("sym_confidence_2", AttributeValues::Float(vec![0.25; count])),
        attribute("color", AttributeValues::Color(vec![[255, 0, 188]; count])),
    ]
}

#[test]
fn a_written_file_keeps_its_content_and_gains_attributes() {
    let mut builder = cube();
    builder.json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [3, 0, 0], "name": "twin" }]);
    builder.json["materials"] = json!([{ "pbrMetallicRoughness": { "metallicFactor": 0.5 } }]);
    let text = builder
        .json
        .to_string()
        .replace("0.5", "5.00e-1")
        .replace("\"buffers\":[{}]", &format!("\"buffers\":[{{\"byteLength\":{}}}]", builder.binary.len()));
    let bytes = glb(&text, &builder.binary);
    let file = parse(&bytes).unwrap();
    assert_eq!(file.polygons.positions.len(), 48, "two primitives share 24 vertices, two nodes a mesh");
    let path = folder("kept").join("a.glb");
    io::write_glb(&path, &file, &attributes(48)).unwrap();
    let (json, text, binary) = chunks(&path);
    assert!(text.contains("\"metallicFactor\":5.00e-1") && text.starts_with("{\"asset\":"), "{text}");
    assert_eq!(json["asset"]["generator"], "by hand, symmetry by intrinsym");
    assert!(binary.starts_with(&builder.binary));
    assert_eq!(
        (&json["nodes"][0]["mesh"], &json["nodes"][1]),
        (&json!(0), &json!({ "mesh": 1, "name": "twin", "translation": [3, 0, 0] }))
    );
    for (mesh, first) in [(0, -1.0), (1, 23.0)] {
        let [one, two] = [0, 1].map(|primitive| &json["meshes"][mesh]["primitives"][primitive]["attributes"]);
        assert_eq!(one, two, "shared vertices share their attributes");
        let numbers = floats(&json, &binary, &one["_SYM_VERTEX"]);
        assert_eq!((numbers.len(), numbers[0], numbers[23]), (24, first, first + 23.0));
        assert_eq!(floats(&json, &binary, &one["_SYM_CONFIDENCE_2"]), [0.25; 24]);
        let colours = &json["accessors"][one["COLOR_0"].as_u64().unwrap() as usize];
        assert_eq!(
            (&colours["componentType"], &colours["normalized"], &colours["type"]),
            (&json!(5123), &json!(true), &json!("VEC4"))
        );
    }
    let again = io::read(&path, &Limits::default()).unwrap();
    assert_eq!(again.polygons, file.polygons);
    assert!(again.has_vertex_colours() && !file.has_vertex_colours());
    io::write_glb(&path, &again, &attributes(48)[..1]).unwrap();
    let (json, text, binary) = chunks(&path);
    assert_eq!(text.matches("symmetry by intrinsym").count(), 1);
    assert_eq!(
        floats(&json, &binary, &json["meshes"][1]["primitives"][0]["attributes"]["_SYM_VERTEX"])[0],
        23.0
    );
}

#[test]
fn a_document_of_an_odd_shape_is_not_written() {
    let mut builder = square();
    builder.json["asset"] = json!("mine");
    let path = folder("odd").join("a.glb");
    let message = io::write_glb(&path, &builder.read(), &attributes(4)).unwrap_err().to_string();
    assert!(message.contains("cannot be changed: generator belongs into an object"), "{message}");
    assert!(!path.exists());
}

#[test]
fn a_text_file_becomes_one_binary_file() {
    let builder = square();
    let folder = folder("text");
    std::fs::write(folder.join("a.bin"), &builder.binary).unwrap();
    let file = io::parse(&folder.join("a.gltf"), &builder.text("a.bin"), &Limits::default()).unwrap();
    io::write_glb(&folder.join("b.glb"), &file, &attributes(4)).unwrap();
    std::fs::remove_file(folder.join("a.bin")).unwrap();
    let (json, _, binary) = chunks(&folder.join("b.glb"));
    assert_eq!(json["buffers"], json!([{ "byteLength": binary.len() }]));
    assert_eq!(io::read(&folder.join("b.glb"), &Limits::default()).unwrap().polygons, file.polygons);
}

#[test]
fn further_buffers_move_into_the_binary_file() {
    let builder = square();
    let folder = folder("buffers");
    let mut json: Value = serde_json::from_slice(&builder.text("a.bin")).unwrap();
    let size = builder.binary.len() + 4;
    json["buffers"].as_array_mut().unwrap().push(json!({ "byteLength": size, "uri": "b.bin" }));
    for view in json["bufferViews"].as_array_mut().unwrap() {
        view["buffer"] = json!(1);
        view["byteOffset"] = json!(view["byteOffset"].as_u64().unwrap() + 4);
    }
    std::fs::write(folder.join("a.bin"), vec![7; builder.binary.len()]).unwrap();
    std::fs::write(folder.join("b.bin"), [&[9; 4][..], &builder.binary].concat()).unwrap();
    let file = io::parse(&folder.join("a.gltf"), json.to_string().as_bytes(), &Limits::default()).unwrap();
    io::write_glb(&folder.join("c.glb"), &file, &attributes(4)).unwrap();
    std::fs::remove_file(folder.join("b.bin")).unwrap();
    let (json, _, binary) = chunks(&folder.join("c.glb"));
    assert_eq!(json["buffers"], json!([{ "byteLength": binary.len() }]));
    assert_eq!(io::read(&folder.join("c.glb"), &Limits::default()).unwrap().polygons, file.polygons);
}

#[test]
fn other_formats_become_positions_and_triangles() {
    let off = "OFF\n5 2 0\n0 0 0\n2 0 0\n2 2 0\n0.5 0.5 0\n0 2 0\n5 0 1 2 3 4\n3 0 1 4\n";
    let file = io::parse(Path::new("a.off"), off.as_bytes(), &Limits::default()).unwrap();
    let path = folder("plain").join("a.glb");
    io::write_glb(&path, &file, &attributes(5)).unwrap();
    let (json, _, binary) = chunks(&path);
    assert_eq!(json["accessors"][0]["max"], json!([2.0, 2.0, 0.0]));
    assert_eq!(
        floats(&json, &binary, &json["meshes"][0]["primitives"][0]["attributes"]["_SYM_VERTEX"]),
        [-1.0, 0.0, 1.0, 2.0, 3.0]
    );
    let again = io::read(&path, &Limits::default()).unwrap();
    assert_eq!(again.polygons.positions, file.polygons.positions);
    assert_eq!(again.polygons.face_offsets.len(), 5);
    let short = io::write_glb(&path, &file, &attributes(4)).unwrap_err();
    assert!(short.to_string().contains("has 4 values for 5 vertices"), "{short}");
}

#[test]
fn a_mesh_far_away_keeps_its_numbers() {
    // Numbers of single precision stay as they are; the others are as exact as the mesh is large.
    let off = "OFF\n4 1 0\n500000.25 5400000.5 3\n500001.5 5400000 3\n500000 5400001 3.1\n0 0 0\n3 0 1 2\n";
    let file = io::parse(Path::new("a.off"), off.as_bytes(), &Limits::default()).unwrap();
    let path = folder("far").join("a.glb");
    io::write_glb(&path, &file, &attributes(4)).unwrap();
    assert_eq!(chunks(&path).0["nodes"][0]["translation"], json!([500000.75, 5400000.5, 0.0]));
    let again = io::read(&path, &Limits::default()).unwrap().polygons.positions;
    assert_eq!(again[..2], file.polygons.positions[..2]);
    assert_eq!(again[3], [0.0; 3]);
    assert!((again[2][2] - 3.1).abs() < 1e-6, "{again:?}");
}

#[test]
fn formats_of_other_programs_name_the_way_out() {
    for (name, program) in [("a.fbx", "FBX"), ("a.USDZ", "USD"), ("a.blend", "Blender's .blend")] {
        let message = io::parse(Path::new(name), b"PK\x03\x04", &Limits::default()).unwrap_err().to_string();
        assert!(message.contains(program) && message.contains("File > Export > glTF 2.0"), "{message}");
    }
}
