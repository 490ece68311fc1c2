//! Writing a `.glb`: the file's own JSON and bytes with vertex attributes added.
//!
//! Attributes of an application's own begin with `_` and cannot be unsigned 32-bit integers (glTF 2.0, section 3.7.2.1): all are
//! floats, which hold every vertex number below 2^24.

use super::Block;
use crate::base::error::{Error, Result};
use crate::mesh::io::scanner::Fault;
use crate::mesh::io::{AttributeValues, VertexAttribute};
use serde_json::value::RawValue;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashSet};
use std::io::{self, Write};
use std::ops::Range;

/// What files have in their `asset.generator` that were written here.
pub const GLB_MARK: &str = "symmetry by intrinsym";

const LARGEST_WHOLE_FLOAT: u64 = 1 << 24;
pub(super) const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
pub(super) const ARRAY_BUFFER: u32 = 34962;

/// What is needed to write a file back.
#[derive(Debug, Clone)]
pub struct GltfFile {
    pub(super) json: Vec<u8>,
    /// All buffers, one behind the other, and where each begins.
    pub(super) binary: Vec<u8>,
    pub(super) starts: Vec<usize>,
    pub(super) blocks: Vec<Block>,
    pub(super) has_colours: bool,
}

/// Elements of the document as their text, so that what is not changed stays as it is.
type Texts = Vec<Box<RawValue>>;

impl GltfFile {
    /// Whether a primitive has colours of its own.
    pub fn has_colours(&self) -> bool {
        self.has_colours
    }

    /// The JSON and the bytes behind the file's own, with the attributes.
    pub fn with(&self, attributes: &[VertexAttribute]) -> Result<Glb<'_>, Fault> {
        let found = self.blocks.last().map_or(0, |block| block.vertices.end) as u64;
        if found > LARGEST_WHOLE_FLOAT {
            let what = "the number of vertices in a .glb";
            return Err(Error::Limit { what, found, limit: LARGEST_WHOLE_FLOAT }.into());
        }
        self.try_with(attributes).map_err(|error| {
            Fault::new(format!("the glTF that was read cannot be changed: {error}; write a .ply"))
        })
    }

    fn try_with(&self, attributes: &[VertexAttribute]) -> serde_json::Result<Glb<'_>> {
        let mut root: BTreeMap<String, Box<RawValue>> = serde_json::from_slice(&self.json)?;
        let (mut accessors, mut views): (Texts, Texts) =
            (list(&root, "accessors")?, list(&root, "bufferViews")?);
        let (mut meshes, mut nodes): (Vec<Value>, Texts) = (list(&root, "meshes")?, list(&root, "nodes")?);
        for view in &mut views {
            self.move_to_first_buffer(view)?;
        }
        let start = self.binary.len().next_multiple_of(4);
        let (mut added, mut used, mut current) = (Vec::new(), HashSet::new(), None);
        for block in &self.blocks {
            let mesh = match current {
                Some((node, mesh)) if node == block.node => mesh,
                _ => own_mesh(&mut nodes[block.node], &mut meshes, &mut used)?,
            };
            current = Some((block.node, mesh));
            for attribute in attributes {
                let (name, mut accessor, bytes) = encoded(attribute, &block.vertices);
                let view = json!({ "buffer": 0, "byteOffset": start + added.len(), "byteLength": bytes.len(), "target": ARRAY_BUFFER });
                accessor["bufferView"] = views.len().into();
                for &primitive in &block.primitives {
                    let path = format!("/primitives/{primitive}/attributes");
                    let primitive =
                        meshes[mesh].pointer_mut(&path).ok_or_else(|| not_an_object("primitive"))?;
                    set(primitive, &name, accessors.len())?;
                }
                views.push(serde_json::value::to_raw_value(&view)?);
                accessors.push(serde_json::value::to_raw_value(&accessor)?);
                added.extend(bytes);
            }
        }
        let mut buffers: Vec<Value> = list(&root, "buffers")?;
        let mut first = buffers.first_mut().map_or(json!({}), Value::take);
        first.as_object_mut().map(|first| first.remove("uri"));
        set(&mut first, "byteLength", start + added.len())?;
        replace(&mut root, "accessors", &accessors)?;
        replace(&mut root, "bufferViews", &views)?;
        replace(&mut root, "buffers", &[first])?;
        replace(&mut root, "meshes", &meshes)?;
        replace(&mut root, "nodes", &nodes)?;
        Ok(Glb { json: text(root)?, binary: &self.binary, added })
    }

    /// A view of another buffer becomes one of the first, in which all buffers are.
    fn move_to_first_buffer(&self, view: &mut Box<RawValue>) -> serde_json::Result<()> {
        let mut value: Value = serde_json::from_str(view.get())?;
        let buffer = value["buffer"].as_u64().unwrap_or_default() as usize;
        if buffer > 0 {
            let offset = value["byteOffset"].as_u64().unwrap_or_default() as usize;
            let start = self.starts.get(buffer).ok_or_else(|| not_an_object("buffer"))?;
            set(&mut value, "byteOffset", start + offset)?;
            set(&mut value, "buffer", 0)?;
            *view = serde_json::value::to_raw_value(&value)?;
        }
        Ok(())
    }
}

/// A list of the document, empty if there is none.
fn list<T: serde::de::DeserializeOwned>(
    root: &BTreeMap<String, Box<RawValue>>,
    name: &str,
) -> serde_json::Result<Vec<T>> {
    root.get(name).map_or(Ok(Vec::new()), |text| serde_json::from_str(text.get()))
}

fn replace(
    root: &mut BTreeMap<String, Box<RawValue>>,
    name: &str,
    list: &impl serde::Serialize,
) -> serde_json::Result<()> {
    root.insert(name.to_string(), serde_json::value::to_raw_value(list)?);
    Ok(())
}

/// Sets a member of what must be an object.
fn set(object: &mut Value, key: &str, value: impl Into<Value>) -> serde_json::Result<()> {
    let members = object.as_object_mut().ok_or_else(|| not_an_object(key))?;
    members.insert(key.to_string(), value.into());
    Ok(())
}

fn not_an_object(what: &str) -> serde_json::Error {
    serde::de::Error::custom(format_args!("{what} belongs into an object"))
}

/// The mesh of a node: a copy if another node shows it too, since each has results of its own.
fn own_mesh(
    node: &mut Box<RawValue>,
    meshes: &mut Vec<Value>,
    used: &mut HashSet<usize>,
) -> serde_json::Result<usize> {
    let mut value: Value = serde_json::from_str(node.get())?;
    let mesh = value["mesh"].as_u64().unwrap_or_default() as usize;
    if used.insert(mesh) {
        return Ok(mesh);
    }
    meshes.push(meshes[mesh].clone());
    set(&mut value, "mesh", meshes.len() - 1)?;
    *node = serde_json::value::to_raw_value(&value)?;
    Ok(meshes.len() - 1)
}

/// Name, accessor and bytes of the values of some vertices.
fn encoded(attribute: &VertexAttribute, vertices: &Range<usize>) -> (String, Value, Vec<u8>) {
    let count = vertices.len();
    let own = |bytes| {
        let name = format!("_{}", attribute.name.to_uppercase());
        (name, json!({ "componentType": FLOAT, "count": count, "type": "SCALAR" }), bytes)
    };
    match &attribute.values {
        AttributeValues::Int(values) => {
            own(values[vertices.clone()].iter().flat_map(|&value| (value as f32).to_le_bytes()).collect())
        }
        AttributeValues::Float(values) => {
            own(values[vertices.clone()].iter().flat_map(|value| value.to_le_bytes()).collect())
        }
        AttributeValues::Color(values) => {
            let opaque = |[red, green, blue]: [u8; 3]| [linear(red), linear(green), linear(blue), u16::MAX];
            let bytes = values[vertices.clone()]
                .iter()
                .flat_map(|&colour| opaque(colour))
                .flat_map(u16::to_le_bytes)
                .collect();
            let accessor = json!({ "componentType": UNSIGNED_SHORT, "normalized": true, "count": count, "type": "VEC4" });
            ("COLOR_0".into(), accessor, bytes)
        }
    }
}

/// From sRGB to the linear light that glTF's colours are in.
fn linear(channel: u8) -> u16 {
    let share = f64::from(channel) / 255.0;
    let light = if share <= 0.04045 { share / 12.92 } else { ((share + 0.055) / 1.055).powf(2.4) };
    (light * 65535.0).round() as u16
}

/// The document as text, the asset with its mark first.
fn text(mut root: BTreeMap<String, Box<RawValue>>) -> serde_json::Result<Vec<u8>> {
    let asset = root.remove("asset").map_or(Ok(json!({})), |text| serde_json::from_str(text.get()));
    let mut asset: Value = asset?;
    let generator = asset["generator"].as_str().unwrap_or_default().to_string();
    if !generator.contains(GLB_MARK) {
        let separator = if generator.is_empty() { "" } else { ", " };
        set(&mut asset, "generator", format!("{generator}{separator}{GLB_MARK}"))?;
    }
    let mut text = format!("{{\"asset\":{asset}").into_bytes();
    for (key, value) in root {
        write!(text, ",{}:{}", json!(key), value.get()).map_err(serde_json::Error::io)?;
    }
    text.push(b'}');
    Ok(text)
}

/// The content of a `.glb`.
pub struct Glb<'a> {
    json: Vec<u8>,
    binary: &'a [u8],
    added: Vec<u8>,
}

impl Glb<'_> {
    /// Writes the container.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let json = self.json.len().next_multiple_of(4);
        let binary = self.binary.len().next_multiple_of(4);
        let size =
            |bytes: usize| u32::try_from(bytes).map_err(|_| io::Error::other("a .glb holds at most 4 GiB"));
        out.write_all(b"glTF\x02\0\0\0")?;
        out.write_all(&size(28 + json + binary + self.added.len())?.to_le_bytes())?;
        out.write_all(&size(json)?.to_le_bytes())?;
        out.write_all(b"JSON")?;
        out.write_all(&self.json)?;
        out.write_all(&b"   "[..json - self.json.len()])?;
        out.write_all(&size(binary + self.added.len())?.to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        out.write_all(self.binary)?;
        out.write_all(&[0; 3][..binary - self.binary.len()])?;
        out.write_all(&self.added)
    }
}
