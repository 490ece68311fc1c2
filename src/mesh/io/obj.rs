//! OBJ (Wavefront): vertices and polygons; groups are skipped, and materials, normals, texture coordinates and colours with a note.

use super::scanner::{Fault, Scanner, parse_integer, quote};
use super::{Format, MeshFile, PolygonMesh, close_face, skipped_attributes};
use crate::base::limits::Limits;

/// Whether a statement says nothing of the surface, or of how it looks.
#[rustfmt::skip]
fn is_skipped(word: &[u8]) -> bool {
    matches!(
        word,
        b"vp" | b"g" | b"o" | b"s" | b"mg" | b"mtllib" | b"maplib" | b"usemap" | b"cstype" | b"deg" | b"bmat" | b"step" | b"parm" | b"trim" | b"hole"
            | b"scrv" | b"sp" | b"end" | b"con" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj"
            | b"trace_obj" | b"ctech" | b"stech" | b"call"
    )
}

/// Reads an OBJ file.
pub fn parse(bytes: &[u8], limits: &Limits) -> Result<MeshFile, Fault> {
    let mut scanner = Scanner::new(bytes).with_comments(b'#');
    if let Some(at) = bytes.iter().position(|&byte| byte == 0) {
        scanner.advance(at);
        return Err(
            scanner.fault("a byte is 0, which no text has; the file is damaged or binary, export it again")
        );
    }
    let mut reader = Reader {
        polygons: PolygonMesh { face_offsets: vec![0], ..PolygonMesh::default() },
        furthest: None,
        colours: 0,
        textures: 0,
        normals: 0,
        materials: 0,
        lines: 0,
        curved: 0,
        unknown: 0,
        first_unknown: String::new(),
    };
    loop {
        reader.statement(&mut scanner, limits)?;
        if !scanner.skip_line() {
            break;
        }
    }
    reader.check_furthest()?;
    let mut notes = reader.notes();
    if !bytes.ends_with(b"\n") && !bytes.ends_with(b"\r") {
        notes.push("The last line has no end: if the file was cut off, the rest is missing.".into());
    }
    Ok(MeshFile::new(reader.polygons, Format::Obj, notes))
}

struct Reader<'a> {
    polygons: PolygonMesh,
    /// Highest vertex that a face refers to, and where: a face may stand before its vertices.
    furthest: Option<(u32, Scanner<'a>)>,
    colours: usize,
    textures: usize,
    normals: usize,
    materials: usize,
    lines: usize,
    curved: usize,
    unknown: usize,
    /// The first unknown word, and its line.
    first_unknown: String,
}

impl<'a> Reader<'a> {
    fn statement(&mut self, scanner: &mut Scanner<'a>, limits: &Limits) -> Result<(), Fault> {
        match scanner.token_in_line() {
            Some(b"v") => {
                let found = self.polygons.positions.len() as u64 + 1;
                if found > limits.vertices {
                    limits.check_vertices(found + statements(scanner, &[b"v"]))?;
                }
                self.vertex(scanner)
            }
            Some(b"f" | b"fo") => {
                let found = self.polygons.face_offsets.len() as u64;
                if found > limits.faces {
                    limits.check_faces(found + statements(scanner, &[b"f", b"fo"]))?;
                }
                self.face(scanner)
            }
            Some(b"vt") => {
                self.textures += 1;
                Ok(())
            }
            Some(b"vn") => {
                self.normals += 1;
                Ok(())
            }
            Some(b"usemtl") => {
                self.materials += 1;
                Ok(())
            }
            Some(b"l" | b"p") => {
                self.lines += 1;
                Ok(())
            }
            Some(b"curv" | b"curv2" | b"surf") => {
                self.curved += 1;
                Ok(())
            }
            Some(word) if !is_skipped(word) => {
                if self.unknown == 0 {
                    self.first_unknown = format!("{} in line {}", quote(word), scanner.line_number());
                }
                self.unknown += 1;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn vertex(&mut self, scanner: &mut Scanner) -> Result<(), Fault> {
        let mut position = [0.0; 3];
        for coordinate in &mut position {
            let what = format_args!("vertex {}", self.polygons.positions.len() + 1);
            *coordinate = match word(scanner) {
                Some(word) => scanner.parse_number(word, what)?,
                None => {
                    return Err(
                        scanner.fault(format_args!("{what} has fewer than three coordinates; add them"))
                    );
                }
            };
        }
        self.polygons.positions.push(position);
        // One number more is a weight.
        self.colours += usize::from(word(scanner).is_some() && word(scanner).is_some());
        Ok(())
    }

    fn face(&mut self, scanner: &mut Scanner<'a>) -> Result<(), Fault> {
        while let Some(corner) = word(scanner) {
            let vertex = self.resolve(scanner, corner)?;
            if self.furthest.as_ref().is_none_or(|(furthest, _)| vertex > *furthest) {
                self.furthest = Some((vertex, scanner.clone()));
            }
            self.polygons.face_vertices.push(vertex);
        }
        close_face(&mut self.polygons)
    }

    /// The 0-based vertex of a corner like `7`, `7/1`, `7//3` or `-1/-1/-1`.
    fn resolve(&self, scanner: &Scanner, corner: &[u8]) -> Result<u32, Fault> {
        let digits = corner.split(|&byte| byte == b'/').next().unwrap_or_default();
        let face = self.polygons.face_offsets.len();
        let Some(index) = parse_integer(digits) else {
            return Err(scanner.fault(format_args!(
                "face {face} has {} where a vertex index should be; correct the line or export the file again",
                quote(corner)
            )));
        };
        let count = self.polygons.positions.len() as i64;
        let vertex = if index < 0 { count + index } else { index - 1 };
        u32::try_from(vertex).map_err(|_| {
            scanner.fault(format_args!(
                "face {face} refers to vertex {index}; indices count from 1, or back from -1 over the {count} \
                 vertices above the line"
            ))
        })
    }

    fn check_furthest(&self) -> Result<(), Fault> {
        let count = self.polygons.positions.len();
        match &self.furthest {
            Some((vertex, scanner)) if *vertex as usize >= count => Err(scanner.fault(format_args!(
                "a face refers to vertex {}, but the file has only {count}; it is cut off, export it again",
                u64::from(*vertex) + 1
            ))),
            _ => Ok(()),
        }
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::from_iter(skipped_attributes(&[
            (self.colours, "vertex colour"),
            (self.textures, "texture coordinate"),
            (self.normals, "normal"),
            (self.materials, "change of material"),
        ]));
        if self.lines > 0 {
            notes.push(format!("{} lines and points without a surface were skipped.", self.lines));
        }
        if self.curved > 0 {
            notes.push(format!(
                "{} free-form curves and surfaces were skipped; only polygons are read.",
                self.curved
            ));
        }
        if self.unknown > 0 {
            notes.push(format!(
                "{} lines begin with a word that is not known and were skipped, the first with {}.",
                self.unknown, self.first_unknown
            ));
        }
        notes
    }
}

/// How many of the lines after this one are statements with one of these words.
fn statements(scanner: &Scanner, words: &[&[u8]]) -> u64 {
    let mut scanner = scanner.clone();
    let mut count = 0;
    while scanner.skip_line() {
        count += u64::from(scanner.clone().token_in_line().is_some_and(|word| words.contains(&word)));
    }
    count
}

/// The next word of the statement, which a backslash continues on the next line.
fn word<'a>(scanner: &mut Scanner<'a>) -> Option<&'a [u8]> {
    loop {
        match scanner.token_in_line()? {
            b"\\" => {
                scanner.skip_line();
            }
            [word @ .., b'\\'] => {
                scanner.skip_line();
                return Some(word);
            }
            word => return Some(word),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> MeshFile {
        parse(text.as_bytes(), &Limits::default()).expect("a readable file")
    }

    #[test]
    fn all_forms_of_corners_are_read() {
        let file = read(
            "# made by hand\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nvn 0 0 1\nvt 0 0\n\
             g side\nf 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nv 0 1 0\nf -4/1/1 -3/1/1 \\\n -2/1/1 -1/1/1\nl 1 2\n",
        );
        assert_eq!(file.polygons.positions, [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!(file.polygons.face_offsets, [0, 3, 6, 9, 13]);
        assert_eq!(file.polygons.face_vertices, [0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 3]);
        let skipped = "Skipped, and not in what is written: 1 vertex colour, 1 texture coordinate, 1 normal.";
        assert_eq!(file.notes, [skipped, "1 lines and points without a surface were skipped."]);
    }

    #[test]
    fn what_is_skipped_is_said() {
        let file = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nF 1 2 3\nface 1 2 3\nf 1 2 3\n");
        let expected =
            "2 lines begin with a word that is not known and were skipped, the first with \"F\" in line 4.";
        assert_eq!((file.polygons.face_offsets.len(), file.notes), (2, vec![expected.to_string()]));
        assert!(read("v 0 0 0\nf 1 1 1").notes[0].starts_with("The last line has no end"));
    }

    #[test]
    fn attributes_that_are_skipped_are_said() {
        let body =
            "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 1\nvt 0 0\nusemtl red\ns 1\ng a\nf 1 2 3\n";
        let expected = "Skipped, and not in what is written: 1 vertex colour, 1 texture coordinate, 2 normals, 1 change of material.";
        assert_eq!(read(body).notes, [expected]);
        assert!(read("v 0 0 0 1.0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").notes.is_empty());
    }

    #[test]
    fn a_bad_line_is_named() {
        let message = |text: &str| match parse(text.as_bytes(), &Limits::default()) {
            Err(Fault::Content(message)) => message,
            other => panic!("{other:?}"),
        };
        assert!(message("v 0 0 0\nv 1 x 0\n").starts_with("line 2: vertex 2 has \"x\""));
        assert!(message("v 0 0\n").starts_with("line 1: vertex 1 has fewer than three coordinates"));
        assert!(message("v 0 0 0\n\nf 0 1 2\n").starts_with("line 3: face 1 refers to vertex 0;"));
        assert!(message("v 0 0 0\rf -1 -2 -1\r").starts_with("line 2: face 1 refers to vertex -2;"));
        assert!(message("v 0 0 0\nv 1 0 0\0\nf 1 1 1\n").starts_with("line 2: a byte is 0"));
        assert!(message("f a b c").starts_with("line 1: face 1 has \"a\""));
    }
}
