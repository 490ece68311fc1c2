//! PLY (G. Turk, "The PLY polygon file format", 1994): everything is kept as it is in the file, so that it can
//! be written back untouched; positions and faces are read out of it.

mod body;
mod header;
mod write;

use super::scanner::Fault;
use super::{Format, MeshFile, PolygonMesh, Source, close_face};
use crate::base::limits::Limits;
use header::{Element, Header, Kind};

pub use header::{Scalar, is_ply};
pub use write::{PLY_MARK, columns};

/// A whole PLY file: its header and the rows of each element as binary little endian.
#[derive(Debug, Clone)]
pub struct PlyFile {
    header: Header,
    /// One per element of the header.
    rows: Vec<Vec<u8>>,
}

/// Reads a PLY file.
pub fn parse(bytes: &[u8], limits: &Limits) -> Result<MeshFile, Fault> {
    let (header, body_start) = header::parse(bytes)?;
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => limits.check_vertices(element.count)?,
            "face" => limits.check_faces(element.count)?,
            _ => {}
        }
    }
    let rows = body::decode(&header, bytes, body_start)?;
    let ply = PlyFile { header, rows };
    let polygons =
        PolygonMesh { positions: ply.positions()?, face_offsets: vec![0], face_vertices: Vec::new() };
    let mut file = MeshFile::new(polygons, Format::Ply, Vec::new());
    ply.faces(limits, &mut file)?;
    file.source = Source::Ply(ply);
    Ok(file)
}

impl PlyFile {
    /// The element of a name and its rows.
    fn element(&self, name: &str) -> Option<(&Element, &[u8])> {
        let at = self.header.elements.iter().position(|element| element.name == name)?;
        Some((&self.header.elements[at], &self.rows[at]))
    }

    /// Whether the vertices have a property of this name.
    pub fn has_vertex_property(&self, name: &str) -> bool {
        let vertices = self.element("vertex");
        vertices.is_some_and(|(element, _)| element.properties.iter().any(|property| property.name == name))
    }

    fn positions(&self) -> Result<Vec<[f64; 3]>, Fault> {
        let Some((element, rows)) = self.element("vertex") else {
            return Err(Fault::new("the header declares no element \"vertex\"; export a mesh"));
        };
        let mut properties = [(0, Scalar::F32); 3];
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            properties[axis] = scalar_property(element, name)?;
        }
        let mut positions = Vec::with_capacity(rows.len() / element.smallest_row().max(1));
        body::for_each_row(element, rows, |starts| {
            positions.push(properties.map(|(property, scalar)| scalar.number(&rows[starts[property]..])));
            Ok(())
        })?;
        Ok(positions)
    }

    /// Reads faces from the element "face" or, as Stanford's scans have it, "tristrips".
    fn faces(&self, limits: &Limits, file: &mut MeshFile) -> Result<(), Fault> {
        let polygons = &mut file.polygons;
        if let Some((element, rows)) = self.element("face") {
            let list = index_list(element)?;
            polygons.face_offsets.reserve(rows.len() / element.smallest_row().max(1));
            let mut face = 0;
            body::for_each_row(element, rows, |starts| {
                list.read(&rows[starts[list.property]..], |index| push_corner(polygons, face, index))?;
                face += 1;
                close_face(polygons)
            })?;
        }
        if let Some((element, rows)) = self.element("tristrips") {
            let list = index_list(element)?;
            body::for_each_row(element, rows, |starts| {
                let mut strip = Strip::default();
                list.read(&rows[starts[list.property]..], |index| strip.push(index, polygons, limits))
            })?;
            file.notes.push("Triangle strips were read; faces are numbered along the strips.".into());
        }
        Ok(())
    }
}

fn scalar_property(element: &Element, name: &str) -> Result<(usize, Scalar), Fault> {
    let found = element.properties.iter().position(|property| property.name == name);
    match found.map(|at| (at, element.properties[at].kind)) {
        Some((at, Kind::Scalar(scalar))) => Ok((at, scalar)),
        _ => Err(Fault::new(format!(
            "the element \"{}\" has no property {name}; every vertex needs x, y and z",
            element.name
        ))),
    }
}

/// The property that lists a face's vertices.
struct IndexList {
    property: usize,
    count: Scalar,
    item: Scalar,
}

fn index_list(element: &Element) -> Result<IndexList, Fault> {
    let named =
        element.properties.iter().position(|p| p.name == "vertex_indices" || p.name == "vertex_index");
    match named.map(|at| (at, element.properties[at].kind)) {
        Some((property, Kind::List { count, item })) if !item.is_float() => {
            Ok(IndexList { property, count, item })
        }
        _ => Err(Fault::new(format!(
            "the element \"{}\" has no list of whole numbers named vertex_indices or vertex_index; export it again",
            element.name
        ))),
    }
}

impl IndexList {
    fn read(&self, bytes: &[u8], mut visit: impl FnMut(i64) -> Result<(), Fault>) -> Result<(), Fault> {
        let count = self.count.integer(bytes).max(0) as usize;
        let items = bytes[self.count.size()..].chunks_exact(self.item.size()).take(count);
        items.map(|item| self.item.integer(item)).try_for_each(&mut visit)
    }
}

fn push_corner(polygons: &mut PolygonMesh, face: usize, index: i64) -> Result<(), Fault> {
    let vertex = u32::try_from(index).map_err(|_| {
        Fault::new(format!(
            "face {face} refers to vertex {index}; indices count from 0, export the file again"
        ))
    })?;
    polygons.face_vertices.push(vertex);
    Ok(())
}

/// The last two vertices of a triangle strip; an index of -1 begins a new one.
#[derive(Default)]
struct Strip {
    last: [i64; 2],
    length: usize,
}

impl Strip {
    fn push(&mut self, index: i64, polygons: &mut PolygonMesh, limits: &Limits) -> Result<(), Fault> {
        if index == -1 {
            self.length = 0;
            return Ok(());
        }
        if self.length >= 2 {
            let face = polygons.face_offsets.len() - 1;
            limits.check_faces(face as u64 + 1)?;
            let [a, b] = if self.length.is_multiple_of(2) { self.last } else { [self.last[1], self.last[0]] };
            for corner in [a, b, index] {
                push_corner(polygons, face, corner)?;
            }
            close_face(polygons)?;
        }
        self.last = [self.last[1], index];
        self.length += 1;
        Ok(())
    }
}
