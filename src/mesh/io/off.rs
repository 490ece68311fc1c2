//! OFF (Geomview): plain and with the prefixes ST, C and N, whose extra columns are skipped with a note.

use super::scanner::{Fault, Scanner, parse_integer};
use super::{Format, MeshFile, PolygonMesh, close_face, skipped_attributes};
use crate::base::limits::Limits;

/// Whether the text begins with an OFF keyword.
pub fn is_off(bytes: &[u8]) -> bool {
    Scanner::new(bytes).with_comments(b'#').token().is_some_and(|word| keyword(word).is_some())
}

/// Reads an OFF file.
pub fn parse(bytes: &[u8], limits: &Limits) -> Result<MeshFile, Fault> {
    let mut scanner = Scanner::new(bytes).with_comments(b'#');
    let (vertices, faces) = parse_header(&mut scanner)?;
    limits.check_vertices(vertices)?;
    limits.check_faces(faces)?;
    let mut polygons = PolygonMesh { face_offsets: vec![0], ..PolygonMesh::default() };
    // A vertex takes at least six bytes, a face two.
    polygons.positions.reserve((vertices as usize).min(bytes.len() / 6 + 1));
    polygons.face_offsets.reserve((faces as usize).min(bytes.len() / 2 + 1));
    polygons.face_vertices.reserve((3 * faces as usize).min(bytes.len() / 2 + 1));
    let (mut with_more, mut coloured) = (0, 0);
    for vertex in 0..vertices {
        let what = format_args!("vertex {vertex} of {vertices}");
        polygons.positions.push([scanner.number(what)?, scanner.number(what)?, scanner.number(what)?]);
        with_more += usize::from(scanner.token_in_line().is_some());
        scanner.skip_line();
    }
    for face in 0..faces {
        coloured += usize::from(parse_face(&mut scanner, face, faces, &mut polygons)?);
    }
    let mut notes =
        Vec::from_iter(skipped_attributes(&[(with_more, "vertex attribute"), (coloured, "face colour")]));
    if scanner.token().is_some() {
        notes.push(format!(
            "What follows the last face, from line {} on, was ignored.",
            scanner.line_number()
        ));
    }
    Ok(MeshFile::new(polygons, Format::Off, notes))
}

/// Reads a face; whether it has a colour.
fn parse_face(
    scanner: &mut Scanner,
    face: u64,
    faces: u64,
    polygons: &mut PolygonMesh,
) -> Result<bool, Fault> {
    let what = format_args!("face {face} of {faces}");
    let corners = scanner.count(what)?;
    if corners > scanner.remaining().len() as u64 {
        return Err(scanner.fault(format_args!(
            "{what} claims {corners} corners, more than the rest of the file holds; it is cut off, export it again"
        )));
    }
    for _ in 0..corners {
        polygons.face_vertices.push(scanner.index(what)?);
    }
    let is_coloured = scanner.token_in_line().is_some();
    scanner.skip_line();
    close_face(polygons).map(|()| is_coloured)
}

/// Numbers of vertices and faces.
fn parse_header(scanner: &mut Scanner) -> Result<(u64, u64), Fault> {
    let start = scanner.clone();
    let word = scanner.token().unwrap_or_default();
    match keyword(word) {
        Some((prefix, rest)) => {
            if prefix.contains(&b'4') || prefix.contains(&b'n') {
                return Err(
                    scanner.fault("the vertices are not three-dimensional (4OFF or nOFF); export plain OFF")
                );
            }
            // Some writers forget the line break: OFF490 518 0.
            let first = if rest.is_empty() { None } else { parse_integer(rest) };
            match first {
                Some(vertices) if vertices >= 0 => return finish_header(scanner, vertices as u64),
                _ => refuse_binary(scanner)?,
            }
        }
        // The keyword is optional: counts alone are a header too.
        None if parse_integer(word).is_some() => *scanner = start,
        None => {
            return Err(
                scanner.fault("an OFF file begins with the word OFF; check the file's name and content")
            );
        }
    }
    let vertices = scanner.count("the number of vertices")?;
    finish_header(scanner, vertices)
}

fn finish_header(scanner: &mut Scanner, vertices: u64) -> Result<(u64, u64), Fault> {
    let faces = scanner.count("the number of faces")?;
    scanner.skip_line();
    Ok((vertices, faces))
}

fn refuse_binary(scanner: &Scanner) -> Result<(), Fault> {
    match scanner.clone().token_in_line() {
        Some(word) if word.eq_ignore_ascii_case(b"BINARY") => {
            Err(scanner.fault("binary OFF is not read; export ascii OFF or PLY"))
        }
        _ => Ok(()),
    }
}

/// Splits a word like `COFF` or `OFF490` into what stands before and after the keyword.
fn keyword(word: &[u8]) -> Option<(&[u8], &[u8])> {
    let at = word.windows(3).position(|letters| letters == b"OFF")?;
    let (prefix, rest) = (&word[..at], &word[at + 3..]);
    let known = prefix.iter().all(|letter| b"STCN4n".contains(letter));
    (known && rest.iter().all(u8::is_ascii_digit)).then_some((prefix, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> PolygonMesh {
        parse(text.as_bytes(), &Limits::default()).expect("a readable file").polygons
    }

    #[test]
    fn the_variants_of_the_header_are_one() {
        let body = "0 0 0\n1 0 0 # corner\n\n0 1 0\n# faces\n3 0 1 2 255 0 0\n";
        let plain = read(&format!("OFF\n3 1 3\n{body}"));
        assert_eq!(plain.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!((&plain.face_offsets[..], &plain.face_vertices[..]), (&[0, 3][..], &[0, 1, 2][..]));
        for header in [
            "# note\nOFF 3 1 3",
            "OFF3 1 3",
            "COFF\r\n3 1 0\r",
            "\u{feff}OFF\n3 1",
            "3 1 3",
            "STCNOFF\n3 1 0",
        ] {
            assert_eq!(read(&format!("{header}\n{body}")), plain, "{header}");
        }
    }

    #[test]
    fn columns_after_the_position_are_skipped() {
        let text = "NOFF\n2 2 0\n0 1 2 0 0 1\n3 4 5 1 0 0\n2 0 1 # of no colour\n2 0 1 255 0 0\n";
        let file = parse(text.as_bytes(), &Limits::default()).expect("a readable file");
        assert_eq!(file.polygons.positions, [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]);
        assert_eq!(file.notes, ["Skipped, and not in what is written: 2 vertex attributes, 1 face colour."]);
    }
}
