//! The bytes of a glTF file's buffers, and the numbers that accessors find in them.

use super::document::{Buffer, Document, get};
use crate::base::limits::Limits;
use crate::mesh::io::ply::Scalar;
use crate::mesh::io::scanner::{Fault, quote};
use crate::mesh::io::{Format, read_limited};
use serde::Deserialize;
use std::borrow::Cow;
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

/// Buffers by number; one without data is a fault only where it is used.
pub type Buffers<'a> = Vec<Option<Cow<'a, [u8]>>>;

/// Loads all buffers: the binary chunk, base64 text, files beside `path`.
pub fn load<'a>(
    document: &Document,
    chunk: Option<&'a [u8]>,
    path: &Path,
    limits: &Limits,
) -> Result<Buffers<'a>, Fault> {
    let mut total = 0;
    let of_buffer = |(index, buffer): (usize, &Buffer)| {
        let data: Option<Cow<[u8]>> = match &buffer.uri {
            None if index == 0 => chunk.map(Cow::Borrowed),
            None => None,
            Some(uri) => Some(of_uri(uri, path, limits)?.into()),
        };
        let found = data.as_ref().map_or(0, |data| data.len() as u64);
        total += found;
        limits.check_file_bytes(total)?;
        if data.is_some() && found < buffer.byte_length {
            let promised = buffer.byte_length;
            return Err(Fault::new(format!(
                "buffer {index} has {found} bytes of the {promised} that it promises; it is cut off, export it again"
            )));
        }
        Ok(data)
    };
    document.buffers.iter().enumerate().map(of_buffer).collect()
}

fn of_uri(uri: &str, path: &Path, limits: &Limits) -> Result<Vec<u8>, Fault> {
    let shown = quote(uri.as_bytes());
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        return text.and_then(base64).ok_or_else(|| {
            Fault::new(format!("the buffer {shown} is not base64 text; export the file again"))
        });
    }
    match file_of(uri, path) {
        Some(file) => Ok(read_limited(&file, limits)?),
        None => Err(Fault::new(format!(
            "the buffer {shown} is not a file beside the mesh or below; export it as .glb, which is one file"
        ))),
    }
}

/// The file beside `path` or below that a buffer's URI names.
fn file_of(uri: &str, path: &Path) -> Option<PathBuf> {
    let name = percent_decoded(uri).filter(|name| !name.is_empty() && !name.contains(':'))?;
    let mut parts = Path::new(&name).components();
    let is_below = parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    is_below.then(|| path.with_file_name(name))
}

/// The files beside a glTF, or below, that its buffers are read from; none for other files, and where it cannot be read.
pub fn buffer_files(path: &Path) -> Vec<PathBuf> {
    #[derive(Deserialize)]
    struct Buffers {
        buffers: Vec<Buffer>,
    }
    let json = json_of(path).unwrap_or_default();
    let found = serde_json::from_slice(json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&json));
    let buffers = found.map_or(Vec::new(), |Buffers { buffers }| buffers);
    buffers.iter().filter_map(|buffer| file_of(buffer.uri.as_ref()?, path)).collect()
}

/// The JSON of a glTF, without the rest of a `.glb`; nothing of other files.
fn json_of(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    let mut bytes = Vec::new();
    file.by_ref().take(20).read_to_end(&mut bytes)?;
    match bytes[..] {
        [b'g', b'l', b'T', b'F', _, _, _, _, _, _, _, _, a, b, c, d, _, _, _, _] => {
            bytes.clear();
            file.take(u32::from_le_bytes([a, b, c, d]).into()).read_to_end(&mut bytes)?;
        }
        _ if Format::of_extension(path) == Some(Format::Gltf) => drop(file.read_to_end(&mut bytes)?),
        _ => bytes.clear(),
    }
    Ok(bytes)
}

fn percent_decoded(text: &str) -> Option<String> {
    let mut parts = text.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        bytes.push(u8::from_str_radix(part.get(..2)?, 16).ok()?);
        bytes.extend_from_slice(&part.as_bytes()[2..]);
    }
    String::from_utf8(bytes).ok()
}

fn base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=');
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    let (mut bits, mut count) = (0u32, 0);
    for letter in text.bytes() {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        (bits, count) = (bits << 6 | u32::from(value), count + 6);
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    Some(bytes)
}

/// What accessors are read from.
pub struct Data<'a> {
    pub document: &'a Document,
    pub buffers: &'a Buffers<'a>,
    pub limits: &'a Limits,
}

/// Where elements begin in a view.
type Start = (usize, u64);

impl Data<'_> {
    /// The numbers of an accessor whose elements have `width` components, one element after the other.
    pub fn numbers(&self, index: usize, width: usize) -> Result<Vec<f64>, Fault> {
        let accessor = get(&self.document.accessors, index, "accessor")?;
        if components(&accessor.shape) != width {
            let shape = quote(accessor.shape.as_bytes());
            return Err(Fault::new(format!(
                "accessor {index} is {shape} where {width} components are needed; export the file again"
            )));
        }
        // A count without bytes behind it would take memory too.
        let most = self.limits.vertices.saturating_add(self.limits.faces).saturating_mul(12);
        if accessor.count.saturating_mul(width as u64) > most {
            return Err(Fault::new(format!(
                "accessor {index} has more elements than a mesh within the limits; raise the limits"
            )));
        }
        let (scalar, count) = (scalar(accessor.component_type)?, accessor.count);
        let mut numbers = match accessor.buffer_view {
            Some(view) => self.block(index, (view, accessor.byte_offset), scalar, width, count)?,
            None => vec![0.0; accessor.count as usize * width],
        };
        if let Some(sparse) = &accessor.sparse {
            let (at, of) = (&sparse.indices, &sparse.values);
            let index_scalar = self::scalar(at.component_type.unwrap_or(0))?;
            let places =
                self.block(index, (at.buffer_view, at.byte_offset), index_scalar, 1, sparse.count)?;
            let values = self.block(index, (of.buffer_view, of.byte_offset), scalar, width, sparse.count)?;
            for (place, value) in places.iter().zip(values.chunks_exact(width)) {
                let start = *place as usize * width;
                let old = numbers.get_mut(start..start + width).ok_or_else(|| {
                    Fault::new(format!(
                        "accessor {index} replaces element {place} of {}; export the file again",
                        accessor.count
                    ))
                })?;
                old.copy_from_slice(value);
            }
        }
        if accessor.normalized {
            normalise(&mut numbers, scalar);
        }
        Ok(numbers)
    }

    /// The numbers of `count` elements, each of `width`.
    fn block(
        &self,
        accessor: usize,
        (view, offset): Start,
        scalar: Scalar,
        width: usize,
        count: u64,
    ) -> Result<Vec<f64>, Fault> {
        let view = get(&self.document.buffer_views, view, "buffer view")?;
        let Some(buffer) = get(self.buffers, view.buffer, "buffer")? else {
            return Err(Fault::new(format!("buffer {} has no data; export the file as .glb", view.buffer)));
        };
        let size = (scalar.size() * width) as u64;
        let stride = view.byte_stride.unwrap_or(size).max(size);
        let whole = view.byte_offset.checked_add(view.byte_length).filter(|&end| end <= buffer.len() as u64);
        let length = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
        let end = length.and_then(|length| length.checked_add(offset)).filter(|&end| end <= view.byte_length);
        if whole.is_none() || end.is_none() {
            return Err(Fault::new(format!(
                "accessor {accessor} reaches beyond the end of its buffer; the file is cut off or damaged, export it again"
            )));
        }
        let start = (view.byte_offset + offset) as usize;
        let mut numbers = Vec::with_capacity(count as usize * width);
        for element in 0..count as usize {
            let bytes = &buffer[start + element * stride as usize..][..size as usize];
            numbers.extend(bytes.chunks_exact(scalar.size()).map(|bytes| scalar.number(bytes)));
        }
        Ok(numbers)
    }
}

fn components(shape: &str) -> usize {
    match shape {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        _ => 0,
    }
}

fn scalar(component_type: u32) -> Result<Scalar, Fault> {
    Ok(match component_type {
        5120 => Scalar::I8,
        5121 => Scalar::U8,
        5122 => Scalar::I16,
        5123 => Scalar::U16,
        5125 => Scalar::U32,
        5126 => Scalar::F32,
        other => {
            return Err(Fault::new(format!(
                "{other} is no component type of glTF 2.0; export the file again"
            )));
        }
    })
}

/// Whole numbers as fractions of the largest of their type.
fn normalise(numbers: &mut [f64], scalar: Scalar) {
    let largest = match scalar {
        Scalar::I8 => 127.0,
        Scalar::U8 => 255.0,
        Scalar::I16 => 32767.0,
        Scalar::U16 => 65535.0,
        _ => return,
    };
    for number in numbers {
        *number = (*number / largest).max(-1.0);
    }
}
