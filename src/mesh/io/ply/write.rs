//! Writing a PLY: the file's own content with columns added to, or replaced in, the vertices.

use super::PlyFile;
use super::body::for_each_row;
use super::header::{Element, Encoding, Header, Kind, Line, Property, Scalar};
use crate::mesh::PolygonMesh;
use crate::mesh::io::scanner::Fault;
use crate::mesh::io::{AttributeValues, VertexAttribute};
use std::io::{self, Write};

/// The line by which files are known that were written here.
pub const PLY_MARK: &str = "\ncomment written by intrinsym\n";

/// A property to add to the vertices.
pub struct Column {
    name: String,
    type_name: &'static str,
    size: usize,
    /// `size` little-endian bytes per vertex.
    bytes: Vec<u8>,
}

/// The columns of attributes.
pub fn columns(attributes: &[VertexAttribute]) -> Vec<Column> {
    let mut columns = Vec::new();
    for attribute in attributes {
        push_columns(attribute, &mut columns);
    }
    columns
}

fn push_columns(attribute: &VertexAttribute, columns: &mut Vec<Column>) {
    let name = attribute.name.clone();
    match &attribute.values {
        AttributeValues::Int(values) => {
            let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            columns.push(Column { name, type_name: "int", size: 4, bytes });
        }
        AttributeValues::Float(values) => {
            let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            columns.push(Column { name, type_name: "float", size: 4, bytes });
        }
        AttributeValues::Color(values) => {
            for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
                let bytes = values.iter().map(|value| value[channel]).collect();
                columns.push(Column { name: name.into(), type_name: "uchar", size: 1, bytes });
            }
        }
    }
}

impl PlyFile {
    /// A file that holds positions and faces only.
    pub fn of_polygons(mesh: &PolygonMesh) -> PlyFile {
        let exact = |coordinate: f64| f64::from(coordinate as f32) == coordinate || coordinate.is_nan();
        let (scalar, scalar_name) = if mesh.positions.as_flattened().iter().copied().all(exact) {
            (Scalar::F32, "float")
        } else {
            (Scalar::F64, "double")
        };
        let widest = mesh.face_offsets.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap_or(0);
        let (count, count_name) = if widest <= 255 { (Scalar::U8, "uchar") } else { (Scalar::U32, "uint") };
        let position = |name: &str| property(name, Kind::Scalar(scalar), scalar_name);
        let vertex = ["x", "y", "z"].map(position).into();
        let kind = Kind::List { count, item: Scalar::I32 };
        let list = property("vertex_indices", kind, &format!("list {count_name} int"));
        let faces = mesh.face_offsets.len().saturating_sub(1) as u64;
        let elements = vec![
            Element { name: "vertex".into(), count: mesh.positions.len() as u64, properties: vertex },
            Element { name: "face".into(), count: faces, properties: vec![list] },
        ];
        let lines = [Line::Element(0), Line::Property(0, 0), Line::Property(0, 1), Line::Property(0, 2)];
        let lines = lines.into_iter().chain([Line::Element(1), Line::Property(1, 0)]).collect();
        let header = Header { encoding: Encoding::LittleEndian, lines, comments: Vec::new(), elements };
        PlyFile { header, rows: vec![position_rows(mesh, scalar), face_rows(mesh, count)] }
    }

    /// Writes the file with `columns` added to its vertices.
    pub fn write(&self, out: &mut dyn Write, columns: &[Column]) -> io::Result<()> {
        let vertex = self.header.elements.iter().position(|element| element.name == "vertex");
        let layout = vertex.map(|vertex| Layout::new(&self.header.elements[vertex], columns));
        self.write_header(out, vertex, layout.as_ref())?;
        for (at, (element, rows)) in self.header.elements.iter().zip(&self.rows).enumerate() {
            match &layout {
                Some(layout) if Some(at) == vertex => layout.write_rows(out, element, rows)?,
                _ => out.write_all(rows)?,
            }
        }
        Ok(())
    }

    fn write_header(
        &self,
        out: &mut dyn Write,
        vertex: Option<usize>,
        layout: Option<&Layout>,
    ) -> io::Result<()> {
        let header = &self.header;
        out.write_all(b"ply\nformat binary_little_endian 1.0\n")?;
        if !header.comments.iter().any(|line| line == PLY_MARK.trim().as_bytes()) {
            out.write_all(PLY_MARK.trim_start().as_bytes())?;
        }
        let last_of_vertex = header.lines.iter().rposition(|line| match *line {
            Line::Property(element, _) | Line::Element(element) => Some(element) == vertex,
            Line::Comment(_) => false,
        });
        for (at, line) in header.lines.iter().enumerate() {
            match *line {
                Line::Comment(comment) => write_line(out, &header.comments[comment])?,
                Line::Element(element) => {
                    let element = &header.elements[element];
                    writeln!(out, "element {} {}", element.name, element.count)?;
                }
                Line::Property(element, property) => {
                    let replaced =
                        layout.filter(|_| Some(element) == vertex).and_then(|l| l.replaced[property]);
                    match replaced {
                        Some(column) => write_declaration(out, column)?,
                        None => write_line(out, &header.elements[element].properties[property].line)?,
                    }
                }
            }
            if let Some(layout) = layout.filter(|_| Some(at) == last_of_vertex) {
                layout.added.iter().try_for_each(|column| write_declaration(out, column))?;
            }
        }
        out.write_all(b"end_header\n")
    }
}

/// Where each column goes.
struct Layout<'a> {
    /// The column that replaces each property of the file.
    replaced: Vec<Option<&'a Column>>,
    /// The columns that follow the file's own.
    added: Vec<&'a Column>,
}

impl<'a> Layout<'a> {
    fn new(element: &Element, columns: &'a [Column]) -> Layout<'a> {
        let replacing = |property: &Property| columns.iter().find(|column| column.name == property.name);
        let is_new =
            |column: &&Column| !element.properties.iter().any(|property| property.name == column.name);
        Layout {
            replaced: element.properties.iter().map(replacing).collect(),
            added: columns.iter().filter(is_new).collect(),
        }
    }

    fn write_rows(&self, out: &mut dyn Write, element: &Element, rows: &[u8]) -> io::Result<()> {
        let mut result = Ok(());
        let mut vertex = 0;
        let mut line = Vec::new();
        let walked = for_each_row(element, rows, |starts| {
            line.clear();
            for (property, &start) in starts.iter().enumerate() {
                match self.replaced[property] {
                    Some(column) => line.extend_from_slice(column.value(vertex)),
                    None => {
                        line.extend_from_slice(own_value(element.properties[property].kind, &rows[start..]))
                    }
                }
            }
            self.added.iter().for_each(|column| line.extend_from_slice(column.value(vertex)));
            vertex += 1;
            result = out.write_all(&line);
            if result.is_ok() { Ok(()) } else { Err(Fault::new("writing failed")) }
        });
        result.and(walked.map_err(|_| io::Error::other("the rows could not be read back")))
    }
}

impl Column {
    fn value(&self, vertex: usize) -> &[u8] {
        &self.bytes[vertex * self.size..(vertex + 1) * self.size]
    }
}

fn own_value(kind: Kind, bytes: &[u8]) -> &[u8] {
    match kind {
        Kind::Scalar(scalar) => &bytes[..scalar.size()],
        Kind::List { count, item } => {
            let length = count.integer(bytes).max(0) as usize;
            &bytes[..count.size() + length * item.size()]
        }
    }
}

fn property(name: &str, kind: Kind, type_name: &str) -> Property {
    Property { name: name.into(), kind, line: format!("property {type_name} {name}").into_bytes() }
}

fn write_line(out: &mut dyn Write, line: &[u8]) -> io::Result<()> {
    out.write_all(line)?;
    out.write_all(b"\n")
}

fn write_declaration(out: &mut dyn Write, column: &Column) -> io::Result<()> {
    writeln!(out, "property {} {}", column.type_name, column.name)
}

fn position_rows(mesh: &PolygonMesh, scalar: Scalar) -> Vec<u8> {
    let coordinates = mesh.positions.as_flattened().iter();
    match scalar {
        Scalar::F32 => coordinates.flat_map(|&coordinate| (coordinate as f32).to_le_bytes()).collect(),
        _ => coordinates.flat_map(|coordinate| coordinate.to_le_bytes()).collect(),
    }
}

fn face_rows(mesh: &PolygonMesh, count: Scalar) -> Vec<u8> {
    let mut rows = Vec::with_capacity(mesh.face_offsets.len() * count.size() + 4 * mesh.face_vertices.len());
    for pair in mesh.face_offsets.windows(2) {
        rows.extend_from_slice(&(pair[1] - pair[0]).to_le_bytes()[..count.size()]);
        let corners = &mesh.face_vertices[pair[0] as usize..pair[1] as usize];
        corners.iter().for_each(|corner| rows.extend_from_slice(&corner.to_le_bytes()));
    }
    rows
}
