//! The parts of a glTF document that hold geometry. Materials, textures, cameras and extensions are not looked at, so that a
//! fault in one of them does not stand in the way.

use crate::mesh::io::scanner::Fault;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Required extensions that change how a surface looks, or that the accessors understand. A name or the start of one.
const HARMLESS: [&str; 10] = [
    "KHR_mesh_quantization",
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "EXT_texture_",
    "EXT_lights_",
    "MSFT_texture_",
    "VRM",
    "KHR_animation_pointer",
];

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Document {
    pub accessors: Vec<Accessor>,
    pub animations: Vec<Animation>,
    pub buffers: Vec<Buffer>,
    pub buffer_views: Vec<View>,
    pub extensions_required: Vec<String>,
    pub meshes: Vec<Mesh>,
    pub nodes: Vec<Node>,
    pub scene: Option<usize>,
    pub scenes: Vec<Scene>,
    pub skins: Vec<Skin>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: u32,
    pub count: u64,
    #[serde(default)]
    pub normalized: bool,
    pub sparse: Option<Sparse>,
    #[serde(rename = "type")]
    pub shape: String,
}

#[derive(Deserialize)]
pub struct Sparse {
    pub count: u64,
    pub indices: Place,
    pub values: Place,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Place {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: u64,
    /// Of indices alone.
    pub component_type: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Buffer {
    pub byte_length: u64,
    pub uri: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct View {
    pub buffer: usize,
    pub byte_length: u64,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_stride: Option<u64>,
}

#[derive(Deserialize)]
pub struct Mesh {
    pub primitives: Vec<Primitive>,
    #[serde(default)]
    pub weights: Vec<f64>,
}

#[derive(Deserialize)]
pub struct Primitive {
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    pub mode: Option<u32>,
    #[serde(default)]
    pub targets: Vec<BTreeMap<String, usize>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub struct Node {
    pub children: Vec<usize>,
    pub matrix: Option<[f64; 16]>,
    pub mesh: Option<usize>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    pub skin: Option<usize>,
    pub translation: Option<[f64; 3]>,
    pub weights: Option<Vec<f64>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub struct Scene {
    pub nodes: Vec<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Skin {
    pub inverse_bind_matrices: Option<usize>,
    pub joints: Vec<usize>,
}

#[derive(Deserialize)]
pub struct Animation {
    #[serde(default)]
    pub name: String,
    pub channels: Vec<Channel>,
    pub samplers: Vec<Sampler>,
}

#[derive(Deserialize)]
pub struct Channel {
    pub sampler: usize,
    pub target: Target,
}

#[derive(Deserialize)]
pub struct Target {
    pub node: Option<usize>,
    pub path: String,
}

#[derive(Deserialize)]
pub struct Sampler {
    pub input: usize,
    /// "LINEAR" where nothing else is said; some exporters write numbers here.
    #[serde(default)]
    pub interpolation: serde_json::Value,
    pub output: usize,
}

/// Reads the JSON, and refuses what must be understood and is not.
pub fn parse(json: &[u8]) -> Result<Document, Fault> {
    let document: Document = serde_json::from_slice(json).map_err(|error| {
        Fault::new(format!("the JSON is not that of a glTF 2.0 file: {error}; export the file again"))
    })?;
    for name in &document.extensions_required {
        if name.ends_with("_draco_mesh_compression") || name.ends_with("_meshopt_compression") {
            return Err(Fault::new(format!(
                "the mesh is compressed ({name}), which is not read; export it again without compression"
            )));
        }
        if !HARMLESS.iter().any(|start| name.starts_with(start)) {
            return Err(Fault::new(format!(
                "the file requires the extension {name}, which is not known; export it again without"
            )));
        }
    }
    Ok(document)
}

/// The JSON of a file, and the binary chunk of a `.glb`.
pub fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None));
    }
    let number = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let cut_off = |at: usize| {
        Fault::new(format!(
            "byte {at}: the file ends before the length it promises; it is cut off, export it again"
        ))
    };
    let (Some(version), Some(length)) = (number(4), number(8)) else { return Err(cut_off(bytes.len())) };
    if version != 2 {
        return Err(Fault::new(format!("it is a binary glTF of version {version}; export it as glTF 2.0")));
    }
    let (length, mut at, mut json, mut binary) = (length as usize, 12, None, None);
    if length > bytes.len() {
        return Err(cut_off(bytes.len()));
    }
    while at < length {
        let (Some(size), Some(kind)) = (number(at), number(at + 4)) else { return Err(cut_off(at)) };
        let end = (at + 8).saturating_add(size as usize);
        let chunk = bytes.get(at + 8..end).ok_or_else(|| cut_off(at))?;
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at = end;
    }
    Ok((json.ok_or_else(|| Fault::new("the file has no JSON chunk; export it again"))?, binary))
}

/// An element that another one refers to.
pub fn get<'a, T>(list: &'a [T], index: usize, what: &str) -> Result<&'a T, Fault> {
    list.get(index).ok_or_else(|| {
        let count = list.len();
        Fault::new(format!(
            "the file refers to {what} {index}, but has {count} of them, numbered from 0; export it again"
        ))
    })
}
