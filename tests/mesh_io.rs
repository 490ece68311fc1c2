//! Mesh files: what is read from each encoding, and what is written back.

use intrinsym::io::{AttributeValues, Format, MeshFile, VertexAttribute};
use intrinsym::{Error, Limits, io};
use std::path::{Path, PathBuf};

const HEADER_REST: &str = "comment made by hand
obj_info kept
element vertex 3
property float x
property float32 y
comment between the properties
property double z
property uchar red
property list uchar short marks
element face 2
property list uchar int vertex_indices
property ushort group
element extra 1
property char a
property int8 b
property uint16 c
property uint d
property list int float e
";

const ASCII_BODY: &str = "0 0 0.1 10 2 -7 300
1 0 0.2 20 0
0 1.5 0.3 30 1 5
3 0 1 2 1000
4 0 1 2 2 65535
-1 -128 65535 4000000000 2 0.25 -3
";

fn ascii() -> Vec<u8> {
    format!("ply\nformat ascii 1.0\n{HEADER_REST}end_header\n{ASCII_BODY}").into_bytes()
}

/// The same rows in binary, written down value by value.
fn binary(big_endian: bool) -> Vec<u8> {
    let name = if big_endian { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = format!("ply\nformat {name} 1.0\n{HEADER_REST}end_header\n").into_bytes();
    let mut put = |value: &[u8]| {
        let mut value = value.to_vec();
        if big_endian {
            value.reverse();
        }
        bytes.extend(value);
    };
    let vertices: [(f32, f32, f64, u8, &[i16]); 3] =
        [(0.0, 0.0, 0.1, 10, &[-7, 300]), (1.0, 0.0, 0.2, 20, &[]), (0.0, 1.5, 0.3, 30, &[5])];
    for (x, y, z, red, marks) in vertices {
        put(&x.to_le_bytes());
        put(&y.to_le_bytes());
        put(&z.to_le_bytes());
        put(&[red]);
        put(&[marks.len() as u8]);
        marks.iter().for_each(|mark| put(&mark.to_le_bytes()));
    }
    let faces: [(&[i32], u16); 2] = [(&[0, 1, 2], 1000), (&[0, 1, 2, 2], 65535)];
    for (corners, group) in faces {
        put(&[corners.len() as u8]);
        corners.iter().for_each(|corner| put(&corner.to_le_bytes()));
        put(&group.to_le_bytes());
    }
    put(&(-1i8).to_le_bytes());
    put(&(-128i8).to_le_bytes());
    put(&65535u16.to_le_bytes());
    put(&4_000_000_000u32.to_le_bytes());
    put(&2i32.to_le_bytes());
    put(&0.25f32.to_le_bytes());
    put(&(-3.0f32).to_le_bytes());
    bytes
}

fn parse(name: &str, bytes: &[u8]) -> MeshFile {
    io::parse(Path::new(name), bytes, &Limits::default()).expect("a readable file")
}

fn written(name: &str, file: &MeshFile, attributes: &[VertexAttribute]) -> Vec<u8> {
    let path = temporary(name);
    io::write_ply(&path, file, attributes).expect("written");
    let bytes = std::fs::read(&path).unwrap();
    std::fs::remove_file(path).unwrap();
    bytes
}

/// The bytes of a PLY with the line that says who wrote it.
fn with_mark(bytes: &[u8]) -> Vec<u8> {
    let start = b"ply\nformat binary_little_endian 1.0\n";
    [start, b"comment written by intrinsym\n".as_slice(), bytes.strip_prefix(start.as_slice()).unwrap()]
        .concat()
}

fn temporary(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("intrinsym-{}-{name}", std::process::id()))
}

fn header_of(bytes: &[u8]) -> String {
    let end = bytes.windows(11).position(|window| window == b"end_header\n").expect("a header") + 11;
    String::from_utf8(bytes[..end].to_vec()).unwrap()
}

#[test]
fn the_encodings_of_ply_say_the_same() {
    let expected = parse("a.ply", &ascii());
    assert_eq!(expected.format, Format::Ply);
    assert_eq!(expected.polygons.positions, [[0.0, 0.0, 0.1], [1.0, 0.0, 0.2], [0.0, 1.5, 0.3]]);
    assert_eq!(expected.polygons.face_offsets, [0, 3, 7]);
    assert_eq!(expected.polygons.face_vertices, [0, 1, 2, 0, 1, 2, 2]);
    for big_endian in [false, true] {
        assert_eq!(parse("a.ply", &binary(big_endian)).polygons, expected.polygons);
    }
}

#[test]
fn a_ply_is_written_back_untouched() {
    for (name, input) in [("a", ascii()), ("l", binary(false)), ("b", binary(true))] {
        let output = written(&format!("untouched-{name}.ply"), &parse("a.ply", &input), &[]);
        let expected = with_mark(&binary(false));
        assert!(output == expected, "{name}: {}", header_of(&output));
    }
}

#[test]
fn attributes_are_added_last_or_replaced_in_place() {
    let attributes = [
        VertexAttribute { name: "sym_vertex".into(), values: AttributeValues::Int(vec![2, -1, 0]) },
        VertexAttribute { name: "colour".into(), values: AttributeValues::Color(vec![[1, 2, 3]; 3]) },
        VertexAttribute {
            name: "sym_confidence".into(),
            values: AttributeValues::Float(vec![0.5, 0.0, 1.0]),
        },
    ];
    let output = written("attributes.ply", &parse("a.ply", &ascii()), &attributes);
    let header = header_of(&output);
    let vertex = "property double z\nproperty uchar red\nproperty list uchar short marks\nproperty int sym_vertex\n\
                  property uchar green\nproperty uchar blue\nproperty float sym_confidence\nelement face 2\n";
    assert!(header.contains(vertex), "{header}");
    let mut first_row = Vec::new();
    first_row.extend(0f32.to_le_bytes());
    first_row.extend(0f32.to_le_bytes());
    first_row.extend(0.1f64.to_le_bytes());
    first_row.extend([1, 2]);
    first_row.extend((-7i16).to_le_bytes());
    first_row.extend(300i16.to_le_bytes());
    first_row.extend(2i32.to_le_bytes());
    first_row.extend([2, 3]);
    first_row.extend(0.5f32.to_le_bytes());
    assert_eq!(output[header.len()..header.len() + first_row.len()], first_row);
    let again = written("again.ply", &parse("b.ply", &output), &attributes);
    assert!(again == output, "writing twice changes nothing");
}

#[test]
fn other_formats_become_ply_without_loss() {
    let exact = parse("a.obj", b"v 0 0 0\nv 1 0 0\nv 0.5 1 0\nf 1 2 3\n");
    let rounded = parse("a.obj", b"v 0 0 0\nv 1 0 0\nv 0.1 1 0\nf 1 2 3\n");
    for (file, scalar) in [(exact, "float"), (rounded, "double")] {
        let output = written(&format!("{scalar}.ply"), &file, &[]);
        assert!(header_of(&output).contains(&format!("element vertex 3\nproperty {scalar} x\n")));
        assert_eq!(parse("b.ply", &output).polygons, file.polygons);
    }
}

#[test]
fn a_face_of_many_corners_survives() {
    let mut text = String::from("OFF\n300 1 0\n");
    (0..300).for_each(|vertex| text.push_str(&format!("{vertex} {} 0\n", vertex * vertex)));
    text.push_str("300");
    (0..300).for_each(|vertex| text.push_str(&format!(" {vertex}")));
    let file = parse("a.off", text.as_bytes());
    assert_eq!(parse("b.ply", &written("many.ply", &file, &[])).polygons, file.polygons);
}

#[test]
fn an_attribute_of_the_wrong_length_is_refused_and_nothing_is_written() {
    let path = temporary("length.ply");
    let attributes = [VertexAttribute { name: "sym_side".into(), values: AttributeValues::Int(vec![0; 2]) }];
    let result = io::write_ply(&path, &parse("a.ply", &ascii()), &attributes);
    assert!(matches!(result, Err(Error::Internal(_))));
    assert!(!path.exists());
}

#[test]
fn triangle_strips_are_read() {
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
                element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 0 0\n8 0 1 2 3 -1 1 4 3\n";
    let file = parse("a.ply", text.as_bytes());
    assert_eq!(file.polygons.face_vertices, [0, 1, 2, 2, 1, 3, 1, 4, 3]);
    assert_eq!(file.notes.len(), 1);
}

#[test]
fn the_content_decides_over_the_name() {
    let file = parse("wrong.obj", &ascii());
    assert_eq!(file.format, Format::Ply);
    assert_eq!(file.notes, ["The content is PLY, not OBJ as the file's name says; it was read as PLY."]);
    assert_eq!(parse("noname", b"OFF\n1 0 0\n0 0 0\n").format, Format::Off);
}

#[test]
fn a_map_is_one_partner_per_line() {
    let path = temporary("partners.map");
    io::write_map(&path, &[1, 0, -1]).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "1\n0\n-1\n");
    std::fs::remove_file(path).unwrap();
}

#[test]
fn limits_are_checked_before_anything_is_allocated() {
    let tight = Limits { vertices: 2, ..Limits::default() };
    let cases: [(&str, &[u8]); 3] =
        [("a.ply", &ascii()), ("a.off", b"OFF\n3 0 0\n"), ("a.obj", b"v 0 0 0\nv 0 0 0\nv 0 0 0\n")];
    for (name, bytes) in cases {
        let result = io::parse(Path::new(name), bytes, &tight);
        assert!(matches!(result, Err(Error::Limit { found: 3, limit: 2, .. })), "{name}");
    }
    let path = temporary("large.off");
    std::fs::write(&path, "OFF\n0 0 0\n").unwrap();
    let result = io::read(&path, &Limits { file_bytes: 9, ..Limits::default() });
    assert!(matches!(result, Err(Error::Limit { found: 10, limit: 9, .. })));
    std::fs::remove_file(path).unwrap();
}

/// The system says that a pipe has no bytes, so its size shows only as it is read.
#[cfg(unix)]
#[test]
fn a_pipe_is_read_up_to_the_limit_of_a_file() {
    let pipe = temporary("pipe.off");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    let text = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".to_string() + &"# more\n".repeat(100);
    let read = |file_bytes: u64| {
        let (path, text) = (pipe.clone(), text.clone());
        let writer = std::thread::spawn(move || std::fs::write(path, text));
        let found = io::read(&pipe, &Limits { file_bytes, ..Limits::default() });
        // A reader that stops early may leave the writer with a closed pipe.
        let _ = writer.join().unwrap();
        found
    };
    let size = text.len() as u64;
    assert_eq!(read(size).unwrap().polygons.positions.len(), 3);
    let error = read(size - 1).unwrap_err().to_string();
    std::fs::remove_file(&pipe).unwrap();
    assert!(error.starts_with(&format!("the file's size in bytes {size} exceeds the limit")), "{error}");
}
