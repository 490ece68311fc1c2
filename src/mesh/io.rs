//! Mesh files: PLY, OBJ, OFF, STL and glTF in, PLY or GLB with result attributes and plain maps out.
//!
//! Counts in headers are never trusted: what is allocated is bounded by the size of the file, and the
//! limits are checked first.

mod gltf;
mod obj;
mod off;
mod ply;
mod scanner;
mod stl;

use super::PolygonMesh;
use crate::base::atomic_file::write_atomically;
use crate::base::error::{Error, Result};
use crate::base::limits::Limits;
use gltf::GltfFile;
pub use gltf::{GLB_MARK, Pose, buffer_files};
pub use ply::PLY_MARK;
use ply::PlyFile;
use scanner::Fault;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The file formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Stanford polygons, ascii or binary.
    Ply,
    /// Wavefront.
    Obj,
    /// Geomview's object file.
    Off,
    /// Stereolithography, ascii or binary; corners at one position become one vertex.
    Stl,
    /// glTF 2.0, as text or binary; the meshes of a scene become one.
    Gltf,
}

impl Format {
    /// The name as users know it.
    pub fn name(self) -> &'static str {
        match self {
            Format::Ply => "PLY",
            Format::Obj => "OBJ",
            Format::Off => "OFF",
            Format::Stl => "STL",
            Format::Gltf => "glTF",
        }
    }

    fn of_extension(path: &Path) -> Option<Format> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "ply" => Some(Format::Ply),
            "obj" => Some(Format::Obj),
            "off" => Some(Format::Off),
            "stl" => Some(Format::Stl),
            "gltf" | "glb" => Some(Format::Gltf),
            _ => None,
        }
    }

    /// The format that the first bytes prove; OBJ has no mark of its own.
    fn of_content(bytes: &[u8]) -> Option<Format> {
        if ply::is_ply(bytes) {
            Some(Format::Ply)
        } else if off::is_off(bytes) {
            Some(Format::Off)
        } else if stl::is_stl(bytes) {
            Some(Format::Stl)
        } else if bytes.starts_with(b"glTF") {
            Some(Format::Gltf)
        } else {
            None
        }
    }
}

/// What a file holds, not yet validated, and what is needed to write its own attributes back.
#[derive(Debug, Clone)]
pub struct MeshFile {
    /// Vertices and faces in the file's order and numbering.
    pub polygons: PolygonMesh,
    /// The format by content.
    pub format: Format,
    /// What the reader did that a user may want to know, as sentences.
    pub notes: Vec<String>,
    source: Source,
}

/// The content of formats that are written back.
#[derive(Debug, Clone)]
enum Source {
    Ply(PlyFile),
    Gltf(GltfFile),
    Other,
}

impl MeshFile {
    fn new(polygons: PolygonMesh, format: Format, notes: Vec<String>) -> MeshFile {
        MeshFile { polygons, format, notes, source: Source::Other }
    }

    /// Whether the file has vertex colours of its own (PLY and glTF; other formats' are not read).
    pub fn has_vertex_colours(&self) -> bool {
        match &self.source {
            Source::Ply(ply) => ply.has_vertex_property("red"),
            Source::Gltf(gltf) => gltf.has_colours(),
            Source::Other => false,
        }
    }
}

/// Per-vertex results to write. One value per vertex of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexAttribute {
    /// Name of the property; colours are always `red`, `green`, `blue`.
    pub name: String,
    /// The values.
    pub values: AttributeValues,
}

/// Values of a [`VertexAttribute`], by type.
#[derive(Debug, Clone, PartialEq)]
pub enum AttributeValues {
    /// `int`.
    Int(Vec<i32>),
    /// `float`.
    Float(Vec<f32>),
    /// Three `uchar`: red, green, blue.
    Color(Vec<[u8; 3]>),
}

/// Reads a mesh file. The format is the extension's unless the content proves another.
///
/// # Errors
/// [`Error::File`] naming the line or byte and what to do; [`Error::Limit`].
pub fn read(path: &Path, limits: &Limits) -> Result<MeshFile> {
    read_posed(path, limits, None)
}

/// Reads a mesh file; a glTF at a moment of an animation, if one is given.
///
/// # Errors
/// As [`read`], also if the file has no such animation.
pub fn read_posed(path: &Path, limits: &Limits, pose: Option<&Pose>) -> Result<MeshFile> {
    let bytes = read_limited(path, limits)?;
    parse_posed(path, &bytes, limits, pose)
}

/// Reads a mesh from the bytes of a file; `path` gives the extension, stands in messages, and leads to the buffers of a `.gltf`.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, bytes: &[u8], limits: &Limits) -> Result<MeshFile> {
    parse_posed(path, bytes, limits, None)
}

fn parse_posed(path: &Path, bytes: &[u8], limits: &Limits, pose: Option<&Pose>) -> Result<MeshFile> {
    let result = choose_format(path, bytes).and_then(|(format, note)| {
        let mut file = match format {
            Format::Gltf => gltf::parse(path, bytes, limits, pose),
            _ if pose.is_some() => Err(Fault::new(format!(
                "a file of {} has no animations; give one with glTF files only",
                format.name()
            ))),
            Format::Ply => ply::parse(bytes, limits),
            Format::Obj => obj::parse(bytes, limits),
            Format::Off => off::parse(bytes, limits),
            Format::Stl => stl::parse(bytes, limits),
        }?;
        file.notes.extend(note);
        Ok(file)
    });
    result.map_err(|fault| fault.into_error(path))
}

/// Writes a binary little-endian PLY: the file's own content and the attributes.
///
/// A PLY's own elements, properties and comments are kept with their types and order; a property of the
/// same name as an attribute is replaced where it stands. Other formats give positions (as double where
/// float would change them) and faces.
///
/// # Errors
/// [`Error::File`] if it cannot be written, and then the target is as it was; [`Error::Internal`] if an
/// attribute has not one value per vertex.
pub fn write_ply(path: &Path, file: &MeshFile, attributes: &[VertexAttribute]) -> Result<()> {
    check_counts(attributes, file.polygons.positions.len())?;
    let columns = ply::columns(attributes);
    match &file.source {
        Source::Ply(ply) => write_atomically(path, |out| ply.write(out, &columns)),
        _ => {
            let ply = PlyFile::of_polygons(&file.polygons);
            write_atomically(path, |out| ply.write(out, &columns))
        }
    }
}

/// Writes a binary glTF (`.glb`): the file's own content and the attributes.
///
/// The content of a glTF is kept: only `COLOR_0`, and attributes of the same names, are replaced. An attribute `name` becomes `_NAME`
/// of every primitive, as floats. Images beside a `.gltf` stay beside it. Other formats give positions, which are `float` from a
/// node's place where they lie far from 0, and triangles.
///
/// # Errors
/// As [`write_ply`], also for a mesh that `float` cannot hold: one of 1e39, or of 1e-31; [`Error::Limit`] for more vertices than floats
/// can number.
pub fn write_glb(path: &Path, file: &MeshFile, attributes: &[VertexAttribute]) -> Result<()> {
    check_counts(attributes, file.polygons.positions.len())?;
    let plain;
    let gltf = match &file.source {
        Source::Gltf(gltf) => gltf,
        _ => {
            plain = GltfFile::of_polygons(&file.polygons).map_err(|fault| fault.into_error(path))?;
            &plain
        }
    };
    let glb = gltf.with(attributes).map_err(|fault| fault.into_error(path))?;
    write_atomically(path, |out| glb.write(out))
}

/// Writes a vertex map: one 0-based partner per line, -1 for none.
///
/// # Errors
/// [`Error::File`] if it cannot be written, and then the target is as it was.
pub fn write_map(path: &Path, partners: &[i32]) -> Result<()> {
    write_atomically(path, |out| partners.iter().try_for_each(|partner| writeln!(out, "{partner}")))
}

/// Checks that attributes have one value per vertex.
fn check_counts(attributes: &[VertexAttribute], vertices: usize) -> Result<()> {
    for VertexAttribute { name, values } in attributes {
        let found = match values {
            AttributeValues::Int(values) => values.len(),
            AttributeValues::Float(values) => values.len(),
            AttributeValues::Color(values) => values.len(),
        };
        if found != vertices {
            return Err(Error::Internal(format!(
                "attribute {name} has {found} values for {vertices} vertices"
            )));
        }
    }
    Ok(())
}

/// The bytes of a file within the limits.
pub(crate) fn read_limited(path: &Path, limits: &Limits) -> Result<Vec<u8>> {
    let unreadable = |error: std::io::Error| Error::File {
        path: path.to_path_buf(),
        message: format!("cannot be read: {error}; check the name and the permissions"),
    };
    let file = File::open(path).map_err(unreadable)?;
    let expected = file.metadata().map_err(unreadable)?.len();
    limits.check_file_bytes(expected)?;
    // The length is checked again while reading, for pipes and for files that grow.
    let mut bytes = Vec::with_capacity(expected as usize);
    file.take(limits.file_bytes.saturating_add(1)).read_to_end(&mut bytes).map_err(unreadable)?;
    limits.check_file_bytes(bytes.len() as u64)?;
    Ok(bytes)
}

/// The note of how many attributes of which kind a reader has skipped, if any.
fn skipped_attributes(counts: &[(usize, &str)]) -> Option<String> {
    let plural = |count: usize| if count == 1 { "" } else { "s" };
    let skipped = counts.iter().filter(|&&(count, _)| count > 0);
    let named: Vec<String> =
        skipped.map(|&(count, what)| format!("{count} {what}{}", plural(count))).collect();
    (!named.is_empty()).then(|| format!("Skipped, and not in what is written: {}.", named.join(", ")))
}

/// Ends a face after the corners pushed so far.
fn close_face(polygons: &mut PolygonMesh) -> Result<(), Fault> {
    let corners = polygons.face_vertices.len() as u64;
    let limit = u64::from(u32::MAX);
    let offset = u32::try_from(corners).map_err(|_| Error::Limit {
        what: "the number of face corners",
        found: corners,
        limit,
    })?;
    polygons.face_offsets.push(offset);
    Ok(())
}

/// Whether the bytes are text of two bytes a letter: by their mark, or since every other one of the first letters is 0.
fn is_wide_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(16)];
    let half = |offset: usize| start.iter().skip(offset).step_by(2);
    let alternates = |low: usize| {
        start.len() > 4 && half(1 - low).all(|&byte| byte == 0) && half(low).all(|&byte| byte != 0)
    };
    start.starts_with(&[0xff, 0xfe]) || start.starts_with(&[0xfe, 0xff]) || alternates(0) || alternates(1)
}

/// The name of a format that other programs write and that is not read.
fn of_another_program(path: &Path) -> Option<&'static str> {
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "fbx" => Some("FBX"),
        "usd" | "usda" | "usdc" | "usdz" => Some("USD"),
        "blend" => Some("Blender's .blend"),
        "dae" => Some("Collada"),
        _ => None,
    }
}

fn choose_format(path: &Path, bytes: &[u8]) -> Result<(Format, Option<String>), Fault> {
    if bytes.is_empty() {
        return Err(Fault::new("the file is empty; export it again"));
    }
    if let Some(program) = of_another_program(path) {
        return Err(Fault::new(format!(
            "{program} is not read; open the file in the program that made it, or in Blender, and export glTF 2.0 \
             (Blender: File > Export > glTF 2.0, .glb)"
        )));
    }
    if bytes.starts_with(&[0x1f, 0x8b]) || bytes.starts_with(b"PK\x03\x04") {
        return Err(Fault::new("the file is compressed; unpack it first"));
    }
    if is_wide_text(bytes) {
        return Err(Fault::new("the file is UTF-16 text; save it as UTF-8 or plain ASCII"));
    }
    match (Format::of_extension(path), Format::of_content(bytes)) {
        (Some(named), Some(found)) if named != found => {
            let (named, name) = (named.name(), found.name());
            Ok((
                found,
                Some(format!(
                    "The content is {name}, not {named} as the file's name says; it was read as {name}."
                )),
            ))
        }
        (Some(format), _) | (None, Some(format)) => Ok((format, None)),
        (None, None) => Err(Fault::new(
            "the format is not known; name the file .ply, .obj, .off, .stl, .gltf or .glb, or export one of these",
        )),
    }
}
