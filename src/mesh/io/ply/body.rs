//! The rows of a PLY file: decoded from any encoding to little-endian bytes, and walked.

use super::header::{Element, Encoding, Header, Kind, Scalar};
use crate::mesh::io::scanner::{Fault, Scanner, parse_float, parse_integer, quote};

/// The rows of every element as little-endian bytes.
pub fn decode(header: &Header, bytes: &[u8], start: usize) -> Result<Vec<Vec<u8>>, Fault> {
    match header.encoding {
        Encoding::Ascii => {
            let mut scanner = Scanner::new(bytes);
            scanner.advance(start - scanner.position());
            decode_elements(header, &mut AsciiSource(scanner))
        }
        encoding => {
            let big_endian = encoding == Encoding::BigEndian;
            decode_elements(header, &mut BinarySource { bytes, position: start, big_endian })
        }
    }
}

/// Calls `visit` with the start of every property in `rows`, row by row.
pub fn for_each_row(
    element: &Element,
    rows: &[u8],
    mut visit: impl FnMut(&[usize]) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let mut starts = vec![0; element.properties.len()];
    let mut position = 0;
    while position < rows.len() {
        for (start, property) in starts.iter_mut().zip(&element.properties) {
            *start = position;
            position += match property.kind {
                Kind::Scalar(scalar) => scalar.size(),
                Kind::List { count, item } => {
                    count.size() + list_length(count, &rows[position..]) * item.size()
                }
            };
        }
        visit(&starts)?;
    }
    Ok(())
}

/// Where values come from, one after the other.
trait Source {
    /// Appends the next value as little-endian bytes.
    fn scalar(&mut self, scalar: Scalar, rows: &mut Vec<u8>) -> Result<(), Fault>;
    /// Takes rows of a fixed size in one piece, if they can be.
    fn block(&mut self, size: u64) -> Option<&[u8]>;
    /// Most values that can still follow.
    fn values_left(&self) -> usize;
    /// A fault at the place reached.
    fn fault(&self, message: std::fmt::Arguments) -> Fault;
}

fn decode_elements(header: &Header, source: &mut impl Source) -> Result<Vec<Vec<u8>>, Fault> {
    header.elements.iter().map(|element| decode_element(element, source)).collect()
}

fn decode_element(element: &Element, source: &mut impl Source) -> Result<Vec<u8>, Fault> {
    let mut rows = Vec::new();
    if element.properties.is_empty() {
        return Ok(rows);
    }
    if element.count.saturating_mul(element.properties.len() as u64) > source.values_left() as u64 {
        return Err(source.fault(format_args!(
            "the header promises {} rows of \"{}\", more than the rest of the file can hold; it is cut off, \
             export it again",
            element.count, element.name
        )));
    }
    if !element.has_lists()
        && let Some(block) = source.block(element.count.saturating_mul(element.smallest_row() as u64))
    {
        return Ok(block.to_vec());
    }
    for row in 0..element.count {
        decode_row(element, source, &mut rows).map_err(|fault| name_row(fault, element, row))?;
    }
    Ok(rows)
}

fn decode_row(element: &Element, source: &mut impl Source, rows: &mut Vec<u8>) -> Result<(), Fault> {
    for property in &element.properties {
        match property.kind {
            Kind::Scalar(scalar) => source.scalar(scalar, rows)?,
            Kind::List { count, item } => {
                let at = rows.len();
                source.scalar(count, rows)?;
                if count.number(&rows[at..]) < 0.0 {
                    return Err(
                        source.fault(format_args!("a list has a negative length; export the file again"))
                    );
                }
                let length = list_length(count, &rows[at..]);
                if length > source.values_left() {
                    return Err(source.fault(format_args!(
                        "a list of {length} values is longer than the rest of the file; it is cut off, export it again"
                    )));
                }
                for _ in 0..length {
                    source.scalar(item, rows)?;
                }
            }
        }
    }
    Ok(())
}

fn name_row(fault: Fault, element: &Element, row: u64) -> Fault {
    match fault {
        Fault::Content(message) => {
            Fault::Content(format!("{message} ({} {row} of {})", element.name, element.count))
        }
        other => other,
    }
}

/// Number of values of a list whose count stands at the start of `bytes`.
fn list_length(count: Scalar, bytes: &[u8]) -> usize {
    count.integer(bytes).max(0) as usize
}

struct BinarySource<'a> {
    bytes: &'a [u8],
    position: usize,
    big_endian: bool,
}

impl Source for BinarySource<'_> {
    fn scalar(&mut self, scalar: Scalar, rows: &mut Vec<u8>) -> Result<(), Fault> {
        let Some(value) = self.bytes.get(self.position..self.position + scalar.size()) else {
            return Err(self.fault(format_args!("the file ends here; it is cut off, export it again")));
        };
        if self.big_endian {
            rows.extend(value.iter().rev());
        } else {
            rows.extend_from_slice(value);
        }
        self.position += scalar.size();
        Ok(())
    }

    fn block(&mut self, size: u64) -> Option<&[u8]> {
        let end = self.position.checked_add(usize::try_from(size).ok()?)?;
        let block = self.bytes.get(self.position..end).filter(|_| !self.big_endian)?;
        self.position = end;
        Some(block)
    }

    fn values_left(&self) -> usize {
        self.bytes.len() - self.position
    }

    fn fault(&self, message: std::fmt::Arguments) -> Fault {
        Fault::new(format!("byte {}: {message}", self.position))
    }
}

struct AsciiSource<'a>(Scanner<'a>);

impl Source for AsciiSource<'_> {
    fn scalar(&mut self, scalar: Scalar, rows: &mut Vec<u8>) -> Result<(), Fault> {
        let Some(word) = self.0.token() else {
            return Err(self.0.fault("the file ends here; it is cut off, export it again"));
        };
        push_word(scalar, word, rows).ok_or_else(|| {
            self.0.fault(format_args!(
                "{} is no value of its type; correct the line or export it again",
                quote(word)
            ))
        })
    }

    fn block(&mut self, _size: u64) -> Option<&[u8]> {
        None
    }

    fn values_left(&self) -> usize {
        self.0.remaining().len().div_ceil(2)
    }

    fn fault(&self, message: std::fmt::Arguments) -> Fault {
        self.0.fault(message)
    }
}

fn push_word(scalar: Scalar, word: &[u8], rows: &mut Vec<u8>) -> Option<()> {
    match scalar {
        Scalar::I8 => rows.extend(i8::try_from(parse_integer(word)?).ok()?.to_le_bytes()),
        Scalar::U8 => rows.extend(u8::try_from(parse_integer(word)?).ok()?.to_le_bytes()),
        Scalar::I16 => rows.extend(i16::try_from(parse_integer(word)?).ok()?.to_le_bytes()),
        Scalar::U16 => rows.extend(u16::try_from(parse_integer(word)?).ok()?.to_le_bytes()),
        Scalar::I32 => rows.extend(i32::try_from(parse_integer(word)?).ok()?.to_le_bytes()),
        Scalar::U32 => rows.extend(u32::try_from(parse_integer(word)?).ok()?.to_le_bytes()),
        Scalar::F32 => rows.extend(parse_f32(word)?.to_le_bytes()),
        Scalar::F64 => rows.extend(parse_float(word)?.to_le_bytes()),
    }
    Some(())
}

/// Rounded once, not by way of a double.
fn parse_f32(word: &[u8]) -> Option<f32> {
    let direct = std::str::from_utf8(word).ok()?.parse().ok();
    direct.or_else(|| parse_float(word).map(|value| value as f32))
}
