//! NumPy archives: arrays of doubles in a `.npz` file (NumPy enhancement proposal 1, format version 1.0).

use rawzip::ZipArchiveWriter;
use std::io::{Error, Result, Write};

/// An array to store: name, shape, and values in C order.
pub struct Array<'a> {
    /// Name under which NumPy gives it back.
    pub name: &'static str,
    /// Length of each axis; their product is the number of values.
    pub shape: &'a [usize],
    /// The values, the last axis running fastest.
    pub values: &'a [f64],
}

/// The bytes of an uncompressed `.npz` file. The same arrays give the same bytes.
pub fn archive(arrays: &[Array]) -> Result<Vec<u8>> {
    let mut archive = ZipArchiveWriter::new(Vec::new());
    for array in arrays {
        let name = format!("{}.npy", array.name);
        let (mut entry, config) = archive.new_file(&*name).start().map_err(Error::other)?;
        let mut writer = config.wrap(&mut entry);
        writer.write_all(&header(array.shape))?;
        for chunk in array.values.chunks(8192) {
            let bytes: Vec<u8> = chunk.iter().flat_map(|value| value.to_le_bytes()).collect();
            writer.write_all(&bytes)?;
        }
        let (_, sums) = writer.finish().map_err(Error::other)?;
        entry.finish(sums).map_err(Error::other)?;
    }
    archive.finish().map_err(Error::other)
}

/// Magic, version, length and description, padded to a multiple of 64 bytes.
fn header(shape: &[usize]) -> Vec<u8> {
    let axes: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    let shape = format!("({}{comma})", axes.join(", "));
    let mut text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What `numpy.save` 2.4.6 writes before the values of `numpy.zeros((3, 2))` and `numpy.zeros((3,))`.
    #[test]
    fn the_header_is_numpys_own() {
        let numpys = |shape: &str| {
            let described = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
            [b"\x93NUMPY\x01\x00v\x00".as_slice(), format!("{described:<117}\n").as_bytes()].concat()
        };
        assert_eq!(header(&[3, 2]), numpys("(3, 2)"));
        assert_eq!(header(&[3]), numpys("(3,)"));
    }
}
