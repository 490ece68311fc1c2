//! A validated triangle mesh: its only constructor, one function per refusal or repair.

mod attachment;
mod canonical;
mod connectivity_hash;
mod copies;
pub mod edges;
mod fans;
mod frame;
pub mod half_edges;
pub mod io;
mod orient;
mod polygons;
pub mod rotation;
mod shells;
mod split_hubs;
mod triangulate;
mod validate;
pub mod vector;
mod weld;

use crate::base::error::Result;
use crate::base::limits::Limits;
use edges::EdgeTable;
use frame::Frame;
use polygons::Polygons;
use std::sync::Arc;
use vector::Vector;

pub use attachment::anchors;
pub use canonical::Canonical;
pub use connectivity_hash::connectivity_hash;
pub(crate) use edges::UnionFind;
pub use polygons::bucket;
pub use shells::{Shell, partition};
pub use split_hubs::{MOST_AROUND, SplitHubs};

/// Marks "no such element" in index arrays.
pub const NONE: u32 = u32::MAX;

/// Polygons as a file or a caller gives them: nothing is validated yet.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PolygonMesh {
    /// Vertex positions, any unit.
    pub positions: Vec<[f64; 3]>,
    /// Face `f` has the corners `face_vertices[face_offsets[f]..face_offsets[f + 1]]`; one longer than the faces.
    pub face_offsets: Vec<u32>,
    /// Vertex indices of all corners, 0-based.
    pub face_vertices: Vec<u32>,
}

impl PolygonMesh {
    /// Whether the same vertices are joined in the same faces, wherever they lie.
    pub fn has_connectivity_of(&self, other: &PolygonMesh) -> bool {
        self.positions.len() == other.positions.len()
            && self.face_offsets == other.face_offsets
            && self.face_vertices == other.face_vertices
    }
}

/// What was repaired inside, without touching the caller's numbering. Counts of elements.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct RepairReport {
    /// Vertices that no used face refers to; they have no partner.
    pub unreferenced_vertices: usize,
    /// Faces with fewer than three distinct corners, dropped.
    pub degenerate_faces: usize,
    /// Faces with the same corners as an earlier face, dropped.
    pub duplicate_faces: usize,
    /// Faces whose orientation was reversed to agree with their neighbours.
    pub flipped_faces: usize,
    /// Edges with more than two faces, kept.
    pub non_manifold_edges: usize,
    /// Vertices whose faces form more than one fan, kept.
    pub non_manifold_vertices: usize,
    /// Vertices on seams (boundary edges in the same place, but for rounding and noise) or on a copy of a shell in the same
    /// place, treated as one point with another vertex there.
    pub welded_vertices: usize,
    /// Faces of no area (kept: intrinsic mollification handles them).
    pub zero_area_faces: usize,
}

/// A validated mesh: what the pipeline works on, with the way back to the caller's numbering.
///
/// Points are numbered 0.. without gaps: each is one caller's vertex, or several that were welded.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Positions of the points, centred at their mean and scaled so that the total area is 1.
    pub positions: Vec<[f64; 3]>,
    /// Triangles over points, consistently oriented within each orientable shell, no two corners alike.
    pub triangles: Vec<[u32; 3]>,
    /// The caller's face of each triangle.
    pub face_of_triangle: Vec<u32>,
    /// The kept polygons over points, oriented like the triangles: offsets, one longer than the kept polygons.
    pub polygon_offsets: Vec<u32>,
    /// The corners of the kept polygons.
    pub polygon_points: Vec<u32>,
    /// The caller's face of each kept polygon.
    pub face_of_polygon: Vec<u32>,
    /// Point of each caller's vertex, or [`NONE`] if no used face refers to it.
    pub point_of_vertex: Vec<u32>,
    /// The lowest-numbered caller's vertex of each point.
    pub vertex_of_point: Vec<u32>,
    /// Shell (connected component by triangles sharing a point) of each point; shells by falling area.
    pub shell_of_point: Vec<u32>,
    /// Number of shells.
    pub shell_count: usize,
    /// Whether each shell could be oriented consistently.
    pub shell_orientable: Vec<bool>,
    /// Number of faces the caller gave.
    pub face_count: usize,
    /// These faces over the caller's vertices, where some of these were welded.
    pub(crate) given_faces: Option<Arc<Polygons>>,
    /// Length in the caller's unit of one unit of `positions` (the square root of the total area).
    pub unit_length: f64,
    /// The caller's position of the origin of `positions`.
    pub centre: [f64; 3],
    /// What was repaired.
    pub repairs: RepairReport,
}

impl Mesh {
    /// Number of points: vertices that lie in one place are one.
    pub fn point_count(&self) -> usize {
        self.positions.len()
    }

    /// The area of each point: a third of that of the triangles around it.
    pub(crate) fn point_areas(&self) -> Vec<f64> {
        vector::point_areas(&self.positions, &self.triangles)
    }

    /// Squared distance of two points in space, in the unit of the positions.
    pub fn squared_distance(&self, a: u32, b: u32) -> f64 {
        vector::squared_norm(vector::subtract(self.positions[a as usize], self.positions[b as usize]))
    }

    /// Validates and repairs. O(n) time and memory in vertices and face corners.
    ///
    /// # Errors
    /// [`Error::Mesh`](crate::Error::Mesh) naming the first bad element;
    /// [`Error::Limit`](crate::Error::Limit).
    pub fn new(mesh: &PolygonMesh, limits: &Limits) -> Result<Mesh> {
        validate::check(mesh, limits)?;
        let mut repairs = RepairReport::default();
        let polygons =
            Polygons::clean(mesh, &mut repairs).without_duplicates(mesh.positions.len(), &mut repairs);
        validate::check_any_face_left(polygons.len(), mesh.face_offsets.len() - 1)?;

        validate::check_spread(&polygons.corners, &mesh.positions)?;
        let frame = Frame::of(polygons.corners.iter().copied(), &mesh.positions);
        let mut local: Vec<Vector> =
            mesh.positions.iter().map(|&position| frame.localise(position)).collect();
        let (polygons, representative) = weld(polygons, &local, &mut repairs);
        let mut surface = triangulate_kept(polygons, &local, &mut repairs);
        validate::check_any_face_left(surface.polygons.len(), mesh.face_offsets.len() - 1)?;
        let areas = polygon_areas(&surface, &local, &mut repairs);
        let area: f64 = areas.iter().sum();
        validate::check_area(area)?;

        let conflicting = orient(&mut surface, &areas, local.len(), &mut repairs);
        let numbering = Numbering::new(&surface.polygons, representative, local.len(), &mut repairs);
        numbering.apply(&mut surface, &mut local);
        Ok(assemble(mesh, surface, &conflicting, numbering, Normalised::new(local, area, &frame), repairs))
    }
}

/// The kept polygons and their triangles.
struct Surface {
    polygons: Polygons,
    triangles: Vec<[u32; 3]>,
    polygon_of_triangle: Vec<u32>,
}

/// Makes one of shells that are there twice and closes seams; also the lowest vertex that each vertex coincides with.
fn weld(mut polygons: Polygons, local: &[Vector], repairs: &mut RepairReport) -> (Polygons, Vec<u32>) {
    let mut representative: Vec<u32> = (0..local.len() as u32).collect();
    let copies = weld::joined(local.len(), &[&copies::copied_vertices(&polygons, local)]);
    let mut join = |polygons: Polygons, mut sets: UnionFind| {
        representative.iter_mut().for_each(|vertex| *vertex = sets.find(*vertex));
        let corners = polygons.corners.iter().map(|&corner| sets.find(corner)).collect();
        Polygons { corners, ..polygons }.without_degenerate(repairs).without_duplicates(local.len(), repairs)
    };
    if let Some(sets) = copies {
        polygons = join(polygons, sets);
    }
    let edges = EdgeTable::new(&polygons, local.len());
    if let Some(sets) = weld::seams(&polygons, &edges, local) {
        polygons = join(polygons, sets);
    }
    (polygons, representative)
}

/// Triangulates, and drops polygons that fold onto themselves so that no triangle is left.
fn triangulate_kept(polygons: Polygons, local: &[Vector], repairs: &mut RepairReport) -> Surface {
    let (triangles, mut owners) = triangulate::triangulate(&polygons, local);
    let mut new_index = vec![NONE; polygons.len()];
    for &owner in &owners {
        new_index[owner as usize] = 0;
    }
    let folded = new_index.iter().filter(|&&index| index == NONE).count();
    if folded == 0 {
        return Surface { polygons, triangles, polygon_of_triangle: owners };
    }
    repairs.degenerate_faces += folded;
    let kept = polygons.retain(|polygon| new_index[polygon] != NONE);
    for (new, index) in new_index.iter_mut().filter(|index| **index != NONE).enumerate() {
        *index = new as u32;
    }
    for owner in &mut owners {
        *owner = new_index[*owner as usize];
    }
    Surface { polygons: kept, triangles, polygon_of_triangle: owners }
}

fn polygon_areas(surface: &Surface, local: &[Vector], repairs: &mut RepairReport) -> Vec<f64> {
    let mut areas = vec![0.0; surface.polygons.len()];
    for (triangle, &polygon) in surface.triangles.iter().zip(&surface.polygon_of_triangle) {
        let [a, b, c] = triangle.map(|vertex| local[vertex as usize]);
        areas[polygon as usize] += vector::triangle_area(a, b, c);
    }
    repairs.zero_area_faces = areas.iter().filter(|&&area| area == 0.0).count();
    areas
}

/// Orients consistently and counts what is not manifold; says which polygons cannot be oriented.
fn orient(
    surface: &mut Surface,
    areas: &[f64],
    vertex_count: usize,
    repairs: &mut RepairReport,
) -> Vec<bool> {
    let edges = EdgeTable::new(&surface.polygons, vertex_count);
    repairs.non_manifold_edges = edges.non_manifold_count();
    repairs.non_manifold_vertices = edges::non_manifold_vertex_count(&surface.polygons, &edges, vertex_count);
    let orientation = orient::orientation(&surface.polygons, &edges, areas);
    for polygon in (0..surface.polygons.len()).filter(|&polygon| orientation.flip[polygon]) {
        surface.polygons.flip(polygon);
        repairs.flipped_faces += 1;
    }
    for (triangle, &polygon) in surface.triangles.iter_mut().zip(&surface.polygon_of_triangle) {
        if orientation.flip[polygon as usize] {
            triangle.swap(1, 2);
        }
    }
    orientation.conflicting
}

/// From the caller's vertices to points without gaps, and back.
struct Numbering {
    point_of_vertex: Vec<u32>,
    vertex_of_point: Vec<u32>,
}

impl Numbering {
    fn new(
        polygons: &Polygons,
        representative: Vec<u32>,
        count: usize,
        repairs: &mut RepairReport,
    ) -> Numbering {
        let mut used = vec![false; count];
        for &corner in &polygons.corners {
            used[corner as usize] = true;
        }
        let mut point_of_vertex = vec![NONE; count];
        let mut vertex_of_point = Vec::new();
        for vertex in 0..count {
            let lowest = representative[vertex] as usize;
            if !used[lowest] {
                repairs.unreferenced_vertices += 1;
            } else if lowest == vertex {
                point_of_vertex[vertex] = vertex_of_point.len() as u32;
                vertex_of_point.push(vertex as u32);
            } else {
                point_of_vertex[vertex] = point_of_vertex[lowest];
                repairs.welded_vertices += 1;
            }
        }
        Numbering { point_of_vertex, vertex_of_point }
    }

    /// Renumbers corners from vertices to points and keeps only the points' positions.
    fn apply(&self, surface: &mut Surface, positions: &mut Vec<Vector>) {
        for corner in surface.polygons.corners.iter_mut().chain(surface.triangles.as_flattened_mut()) {
            *corner = self.point_of_vertex[*corner as usize];
        }
        *positions = self.vertex_of_point.iter().map(|&vertex| positions[vertex as usize]).collect();
    }
}

/// Positions centred at their mean with area 1, and the way back.
struct Normalised {
    positions: Vec<Vector>,
    unit_length: f64,
    centre: Vector,
}

impl Normalised {
    fn new(mut positions: Vec<Vector>, area: f64, frame: &Frame) -> Normalised {
        let centre = shells::centre(&mut positions);
        let local_unit = area.sqrt();
        for position in &mut positions {
            *position = position.map(|coordinate| coordinate / local_unit);
        }
        let (unit_length, centre) = (frame.global_length(local_unit), frame.globalise(centre));
        Normalised { positions, unit_length, centre }
    }
}

fn assemble(
    mesh: &PolygonMesh,
    surface: Surface,
    conflicting: &[bool],
    numbering: Numbering,
    normalised: Normalised,
    repairs: RepairReport,
) -> Mesh {
    let Surface { polygons, triangles, polygon_of_triangle } = surface;
    let partition = shells::partition(&triangles, &normalised.positions);
    let mut shell_orientable = vec![true; partition.count];
    for polygon in (0..polygons.len()).filter(|&polygon| conflicting[polygon]) {
        let point = polygons.corners_of(polygon)[0];
        shell_orientable[partition.shell_of_point[point as usize] as usize] = false;
    }
    Mesh {
        positions: normalised.positions,
        triangles,
        face_of_triangle: polygon_of_triangle
            .iter()
            .map(|&polygon| polygons.faces[polygon as usize])
            .collect(),
        polygon_offsets: polygons.offsets,
        polygon_points: polygons.corners,
        face_of_polygon: polygons.faces,
        point_of_vertex: numbering.point_of_vertex,
        vertex_of_point: numbering.vertex_of_point,
        shell_of_point: partition.shell_of_point,
        shell_count: partition.count,
        shell_orientable,
        face_count: mesh.face_offsets.len() - 1,
        given_faces: (repairs.welded_vertices > 0).then(|| Arc::new(Polygons::given(mesh))),
        unit_length: normalised.unit_length,
        centre: normalised.centre,
        repairs,
    }
}
