//! The header of a PLY file, with every line kept.

use crate::mesh::io::scanner::{Fault, Scanner, quote};

/// Types of scalars.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scalar {
    /// `char`, `int8`.
    I8,
    /// `uchar`, `uint8`.
    U8,
    /// `short`, `int16`.
    I16,
    /// `ushort`, `uint16`.
    U16,
    /// `int`, `int32`.
    I32,
    /// `uint`, `uint32`.
    U32,
    /// `float`, `float32`.
    F32,
    /// `double`, `float64`.
    F64,
}

impl Scalar {
    fn of_name(name: &[u8]) -> Option<Scalar> {
        Some(match name {
            b"char" | b"int8" => Scalar::I8,
            b"uchar" | b"uint8" => Scalar::U8,
            b"short" | b"int16" => Scalar::I16,
            b"ushort" | b"uint16" => Scalar::U16,
            b"int" | b"int32" => Scalar::I32,
            b"uint" | b"uint32" => Scalar::U32,
            b"float" | b"float32" => Scalar::F32,
            b"double" | b"float64" => Scalar::F64,
            _ => return None,
        })
    }

    /// Bytes it takes.
    pub fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }

    /// Whether it can hold fractions.
    pub fn is_float(self) -> bool {
        matches!(self, Scalar::F32 | Scalar::F64)
    }

    /// The value at the start of little-endian bytes.
    pub fn number(self, bytes: &[u8]) -> f64 {
        match self {
            Scalar::F32 => f64::from(f32::from_le_bytes(head(bytes))),
            Scalar::F64 => f64::from_le_bytes(head(bytes)),
            _ => self.integer(bytes) as f64,
        }
    }

    /// The whole number at the start of little-endian bytes; fractions are cut off.
    pub fn integer(self, bytes: &[u8]) -> i64 {
        match self {
            Scalar::I8 => i64::from(i8::from_le_bytes(head(bytes))),
            Scalar::U8 => i64::from(bytes[0]),
            Scalar::I16 => i64::from(i16::from_le_bytes(head(bytes))),
            Scalar::U16 => i64::from(u16::from_le_bytes(head(bytes))),
            Scalar::I32 => i64::from(i32::from_le_bytes(head(bytes))),
            Scalar::U32 => i64::from(u32::from_le_bytes(head(bytes))),
            Scalar::F32 | Scalar::F64 => self.number(bytes) as i64,
        }
    }
}

fn head<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut head = [0; N];
    head.copy_from_slice(&bytes[..N]);
    head
}

/// What a property holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// One value.
    Scalar(Scalar),
    /// A count and as many values.
    List {
        /// Type of the count.
        count: Scalar,
        /// Type of the values.
        item: Scalar,
    },
}

/// A property of an element.
#[derive(Debug, Clone)]
pub struct Property {
    /// Its name.
    pub name: String,
    /// Its type.
    pub kind: Kind,
    /// Its line in the header.
    pub line: Vec<u8>,
}

/// An element: a table of rows.
#[derive(Debug, Clone)]
pub struct Element {
    /// Its name.
    pub name: String,
    /// Number of rows, not to be trusted before the rows are decoded.
    pub count: u64,
    /// The columns.
    pub properties: Vec<Property>,
}

impl Element {
    /// Fewest bytes that a row takes in binary.
    pub fn smallest_row(&self) -> usize {
        let smallest = |property: &Property| match property.kind {
            Kind::Scalar(scalar) => scalar.size(),
            Kind::List { count, .. } => count.size(),
        };
        self.properties.iter().map(smallest).sum()
    }

    /// Whether any property is a list.
    pub fn has_lists(&self) -> bool {
        self.properties.iter().any(|property| matches!(property.kind, Kind::List { .. }))
    }
}

/// A line of the header after the format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// Index into [`Header::comments`].
    Comment(usize),
    /// An element.
    Element(usize),
    /// A property of an element.
    Property(usize, usize),
}

/// How the rows are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// As text.
    Ascii,
    /// Least significant byte first.
    LittleEndian,
    /// Most significant byte first.
    BigEndian,
}

/// The header.
#[derive(Debug, Clone)]
pub struct Header {
    /// How the rows are stored in the file it came from.
    pub encoding: Encoding,
    /// The lines in their order.
    pub lines: Vec<Line>,
    /// Lines that begin with `comment` or `obj_info`.
    pub comments: Vec<Vec<u8>>,
    /// The elements in their order.
    pub elements: Vec<Element>,
}

/// Whether the bytes begin like a PLY file.
pub fn is_ply(bytes: &[u8]) -> bool {
    Scanner::new(bytes).line().trim_ascii_end() == b"ply"
}

/// Reads the header; also the byte where the body starts.
pub fn parse(bytes: &[u8]) -> Result<(Header, usize), Fault> {
    let mut scanner = Scanner::new(bytes);
    if !is_ply(bytes) {
        return Err(
            scanner.fault("a PLY file begins with the line \"ply\"; check the file's name and content")
        );
    }
    scanner.line();
    let mut encoding = None;
    let mut header =
        Header { encoding: Encoding::Ascii, lines: Vec::new(), comments: Vec::new(), elements: Vec::new() };
    loop {
        if scanner.remaining().is_empty() {
            return Err(
                scanner.fault("the header has no line \"end_header\"; the file is cut off, export it again")
            );
        }
        let line_start = scanner.clone();
        let line = scanner.line().trim_ascii_end();
        let words: Vec<&[u8]> = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).collect();
        match words.first().copied() {
            Some(b"end_header") => break,
            Some(b"format") => encoding = Some(parse_format(&words, &line_start)?),
            Some(b"comment" | b"obj_info") => header.push_comment(line),
            Some(b"element") => header.push_element(&words, &line_start)?,
            Some(b"property") => header.push_property(&words, line, &line_start)?,
            None => {}
            Some(word) => {
                return Err(line_start
                    .fault(format_args!("{} is no word of a PLY header; correct the line", quote(word))));
            }
        }
    }
    header.encoding = encoding
        .ok_or_else(|| scanner.fault("the header has no line \"format\"; add it or export the file again"))?;
    Ok((header, scanner.position()))
}

fn parse_format(words: &[&[u8]], scanner: &Scanner) -> Result<Encoding, Fault> {
    match words.get(1).copied() {
        Some(b"ascii") => Ok(Encoding::Ascii),
        Some(b"binary_little_endian") => Ok(Encoding::LittleEndian),
        Some(b"binary_big_endian") => Ok(Encoding::BigEndian),
        other => Err(scanner.fault(format_args!(
            "the format {} is not known; it must be ascii, binary_little_endian or binary_big_endian",
            quote(other.unwrap_or_default())
        ))),
    }
}

impl Header {
    fn push_comment(&mut self, line: &[u8]) {
        self.lines.push(Line::Comment(self.comments.len()));
        self.comments.push(line.to_vec());
    }

    fn push_element(&mut self, words: &[&[u8]], scanner: &Scanner) -> Result<(), Fault> {
        let count = words.get(2).and_then(|word| std::str::from_utf8(word).ok()?.parse().ok());
        let (Some(name), Some(count)) = (words.get(1), count) else {
            return Err(scanner.fault("an element line needs a name and a count, like \"element vertex 8\""));
        };
        self.lines.push(Line::Element(self.elements.len()));
        let name = String::from_utf8_lossy(name).into_owned();
        self.elements.push(Element { name, count, properties: Vec::new() });
        Ok(())
    }

    fn push_property(&mut self, words: &[&[u8]], line: &[u8], scanner: &Scanner) -> Result<(), Fault> {
        let known = |word: &[u8]| {
            Scalar::of_name(word).ok_or_else(|| {
                scanner.fault(format_args!(
                    "the type {} is not known; PLY has char, uchar, short, ushort, int, uint, float and double",
                    quote(word)
                ))
            })
        };
        let (kind, name) = match *words {
            [_, b"list", count, item, name, ..] => {
                (Kind::List { count: known(count)?, item: known(item)? }, name)
            }
            [_, scalar, name, ..] if scalar != b"list" => (Kind::Scalar(known(scalar)?), name),
            _ => {
                return Err(
                    scanner.fault("a property line needs a type and a name, like \"property float x\"")
                );
            }
        };
        let element_index = self.elements.len().wrapping_sub(1);
        let Some(element) = self.elements.last_mut() else {
            return Err(scanner.fault("a property stands before the first element; export the file again"));
        };
        self.lines.push(Line::Property(element_index, element.properties.len()));
        let name = String::from_utf8_lossy(name).into_owned();
        element.properties.push(Property { name, kind, line: line.to_vec() });
        Ok(())
    }
}
