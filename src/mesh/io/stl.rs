//! STL, ascii and binary. The format has no connectivity: corners at exactly one position become one vertex.

use super::scanner::{Fault, Scanner, parse_float, quote};
use super::{Format, MeshFile, PolygonMesh, close_face};
use crate::base::limits::Limits;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

const HEADER_BYTES: usize = 84;
const TRIANGLE_BYTES: usize = 50;

/// Whether the bytes are surely an STL: of exactly the size a binary header promises, or ascii facets.
pub fn is_stl(bytes: &[u8]) -> bool {
    promised_size(bytes) == Some(bytes.len() as u64) || is_ascii(bytes)
}

/// Reads an STL file.
pub fn parse(bytes: &[u8], limits: &Limits) -> Result<MeshFile, Fault> {
    let ascii = promised_size(bytes) != Some(bytes.len() as u64) && is_ascii(bytes);
    let mut notes = Vec::new();
    let polygons = if ascii { parse_ascii(bytes, limits)? } else { parse_binary(bytes, limits, &mut notes)? };
    notes.push(format!(
        "STL has no connectivity: {} corners at equal positions were joined to {} vertices, numbered as they first appear.",
        polygons.face_vertices.len(),
        polygons.positions.len()
    ));
    Ok(MeshFile::new(polygons, Format::Stl, notes))
}

/// The size of a binary file by the triangle count in its header.
fn promised_size(bytes: &[u8]) -> Option<u64> {
    let count: [u8; 4] = bytes.get(80..HEADER_BYTES)?.try_into().ok()?;
    Some(HEADER_BYTES as u64 + TRIANGLE_BYTES as u64 * u64::from(u32::from_le_bytes(count)))
}

/// Binary files may begin with "solid" too, so the first facet must follow as text.
fn is_ascii(bytes: &[u8]) -> bool {
    if bytes[..bytes.len().min(HEADER_BYTES)].contains(&0) {
        return false;
    }
    let mut scanner = Scanner::new(bytes);
    if !scanner.token().is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        return false;
    }
    skip_name(&mut scanner);
    scanner
        .token()
        .is_none_or(|word| word.eq_ignore_ascii_case(b"facet") || word.eq_ignore_ascii_case(b"endsolid"))
}

fn parse_binary(bytes: &[u8], limits: &Limits, notes: &mut Vec<String>) -> Result<PolygonMesh, Fault> {
    let Some(promised) = promised_size(bytes) else {
        return Err(Fault::new(format!(
            "byte {}: the file ends within the header of {HEADER_BYTES} bytes; it is cut off or no STL",
            bytes.len()
        )));
    };
    let count = (promised - HEADER_BYTES as u64) / TRIANGLE_BYTES as u64;
    if (bytes.len() as u64) < promised {
        return Err(Fault::new(format!(
            "byte 80: the header promises {count} triangles ({promised} bytes) but the file has {} bytes; \
             it is cut off or no STL, export it again",
            bytes.len()
        )));
    }
    if bytes.len() as u64 > promised {
        notes.push(format!("{} bytes after the last triangle were ignored.", bytes.len() as u64 - promised));
    }
    limits.check_faces(count)?;
    let mut soup = Soup::new(*limits);
    for triangle in bytes[HEADER_BYTES..promised as usize].chunks_exact(TRIANGLE_BYTES) {
        // Twelve bytes of normal, three corners, two bytes of attribute.
        for corner in triangle[12..48].chunks_exact(12) {
            let coordinate =
                |at: usize| f32::from_le_bytes([corner[at], corner[at + 1], corner[at + 2], corner[at + 3]]);
            soup.corner([coordinate(0), coordinate(4), coordinate(8)].map(f64::from))?;
        }
        close_face(&mut soup.polygons)?;
    }
    Ok(soup.polygons)
}

fn parse_ascii(bytes: &[u8], limits: &Limits) -> Result<PolygonMesh, Fault> {
    let mut scanner = Scanner::new(bytes);
    let mut soup = Soup::new(*limits);
    let mut is_open = true;
    while let Some(word) = scanner.token() {
        match word.to_ascii_lowercase().as_slice() {
            b"solid" => skip_name(&mut scanner),
            b"endsolid" => {
                is_open = false;
                skip_name(&mut scanner);
            }
            b"facet" => {
                is_open = true;
                skip_words(&mut scanner, |word| {
                    word.eq_ignore_ascii_case(b"normal") || parse_float(word).is_some()
                });
            }
            b"outer" => skip_words(&mut scanner, |word| word.eq_ignore_ascii_case(b"loop")),
            b"vertex" => {
                let what = format_args!("a vertex of facet {}", soup.polygons.face_offsets.len());
                soup.corner([scanner.number(what)?, scanner.number(what)?, scanner.number(what)?])?;
            }
            b"endloop" => {
                limits.check_faces(soup.polygons.face_offsets.len() as u64)?;
                close_face(&mut soup.polygons)?;
            }
            b"endfacet" => {}
            _ => {
                return Err(scanner.fault(format_args!(
                    "{} is no word of an ascii STL; correct the line or export the file again",
                    quote(word)
                )));
            }
        }
    }
    let closed = soup.polygons.face_offsets[soup.polygons.face_offsets.len() - 1] as usize;
    if soup.polygons.face_vertices.len() != closed {
        return Err(scanner.fault("the file ends within a facet; it is cut off, export it again"));
    }
    if is_open {
        return Err(scanner.fault("the file ends without endsolid; it is cut off, export it again"));
    }
    Ok(soup.polygons)
}

/// Skips the name of a solid: to the end of the line, or to its first facet where all is in one line.
fn skip_name(scanner: &mut Scanner) {
    let mut ahead = scanner.clone();
    let mut before = scanner.clone();
    while let Some(word) = ahead.token_in_line() {
        let normal = ahead.clone().token_in_line();
        if word.eq_ignore_ascii_case(b"facet")
            && normal.is_some_and(|next| next.eq_ignore_ascii_case(b"normal"))
        {
            *scanner = before;
            return;
        }
        before = ahead.clone();
    }
    scanner.skip_line();
}

/// Skips words of this line as long as they are `wanted`.
fn skip_words(scanner: &mut Scanner, wanted: impl Fn(&[u8]) -> bool) {
    let mut ahead = scanner.clone();
    while ahead.token_in_line().is_some_and(&wanted) {
        *scanner = ahead.clone();
    }
}

/// Collects corners, joining those at equal positions.
struct Soup {
    polygons: PolygonMesh,
    vertex_at: HashMap<[u64; 3], u32>,
    limits: Limits,
}

impl Soup {
    fn new(limits: Limits) -> Soup {
        let polygons = PolygonMesh { face_offsets: vec![0], ..PolygonMesh::default() };
        Soup { polygons, vertex_at: HashMap::new(), limits }
    }

    fn corner(&mut self, position: [f64; 3]) -> Result<(), Fault> {
        // Adding zero makes the two zeros equal.
        let key = position.map(|coordinate| (coordinate + 0.0).to_bits());
        let vertex = match self.vertex_at.entry(key) {
            Entry::Occupied(entry) => *entry.get(),
            Entry::Vacant(entry) => {
                self.limits.check_vertices(self.polygons.positions.len() as u64 + 1)?;
                let vertex = self.polygons.positions.len() as u32;
                self.polygons.positions.push(position);
                *entry.insert(vertex)
            }
        };
        self.polygons.face_vertices.push(vertex);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASCII: &str = "solid two of them\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
                         endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 -0 0\nvertex 1 1 0\nvertex 0 1 0\n\
                         endloop\nendfacet\nendsolid two of them\n";

    fn binary(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = b"solid but binary".to_vec();
        bytes.resize(80, 0);
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; 12]);
            triangle.iter().flatten().for_each(|coordinate| bytes.extend(coordinate.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    #[test]
    fn ascii_and_binary_are_welded_alike() {
        let ascii = parse(ASCII.as_bytes(), &Limits::default()).unwrap();
        let triangles =
            [[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], [[1., -0., 0.], [1., 1., 0.], [0., 1., 0.]]];
        let bytes = binary(&triangles);
        let binary = parse(&bytes, &Limits::default()).unwrap();
        assert_eq!(ascii.polygons, binary.polygons);
        assert_eq!(ascii.polygons.face_vertices, [0, 1, 2, 1, 3, 2]);
        assert!(ascii.notes[0].contains("6 corners at equal positions were joined to 4 vertices"));
        assert!(is_stl(ASCII.as_bytes()) && is_stl(&bytes));
    }

    #[test]
    fn a_file_in_one_line_is_read_as_one_in_many() {
        let lines = parse(ASCII.as_bytes(), &Limits::default()).unwrap();
        let one_line = ASCII.replace('\n', " ");
        assert!(is_stl(one_line.as_bytes()));
        assert_eq!(parse(one_line.as_bytes(), &Limits::default()).unwrap().polygons, lines.polygons);
        let two_solids = format!("{one_line}{one_line}");
        let twice = parse(two_solids.as_bytes(), &Limits::default()).unwrap().polygons;
        assert_eq!(twice.face_offsets, [0, 3, 6, 9, 12]);
    }

    #[test]
    fn every_cut_before_the_last_word_is_refused() {
        let end = ASCII.rfind("endsolid").unwrap() + "endsolid".len();
        for length in 1..end {
            let read = parse(&ASCII.as_bytes()[..length], &Limits::default());
            assert!(read.is_err(), "{:?} is read", &ASCII[..length]);
        }
        assert!(parse(&ASCII.as_bytes()[..end], &Limits::default()).is_ok());
    }

    #[test]
    fn ascii_facets_are_limited() {
        let of = |faces| parse(ASCII.as_bytes(), &Limits { faces, ..Limits::default() });
        assert!(of(2).is_ok());
        let Err(Fault::Other(error)) = of(1) else { panic!("two facets are more than one") };
        assert_eq!(error.to_string().split(" exceeds").next(), Some("the number of faces 2"));
    }

    #[test]
    fn a_cut_off_binary_file_is_refused() {
        let mut bytes = binary(&[[[0.; 3]; 3]; 2]);
        bytes.truncate(100);
        match parse(&bytes, &Limits::default()) {
            Err(Fault::Content(message)) => {
                assert!(message.starts_with("byte 80: the header promises 2 triangles"))
            }
            other => panic!("{other:?}"),
        }
    }
}
