//! glTF 2.0 (Khronos Group, "glTF 2.0 Specification", 2021), `.gltf` and `.glb`: all triangles of the scene as it stands, skins and
//! morph targets applied, as one mesh.
//!
//! Vertices are numbered through the file: by node, then primitive, then vertex; primitives of a node that share their vertices
//! share their numbers. Positions are rounded to single precision, from the mesh's own place where that is far away, so that seams which an
//! exporter split stay seams.

mod animation;
mod data;
mod document;
mod plain;
mod scene;
mod write;

use super::scanner::Fault;
use super::{Format, MeshFile, PolygonMesh, Source, close_face};
use crate::base::limits::Limits;
use animation::Changes;
use data::Data;
use document::{Node, Primitive, get};
use scene::{Matrix, Scene};
use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

pub use data::buffer_files;
pub use write::{GLB_MARK, GltfFile};

/// A moment of an animation.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Its name in the file.
    pub animation: String,
    /// Seconds from its start.
    pub time: f64,
}

/// Vertices of the file and the primitives of a node that they belong to.
#[derive(Debug, Clone)]
struct Block {
    node: usize,
    primitives: Vec<usize>,
    vertices: Range<usize>,
}

/// Reads a glTF file; buffers of a `.gltf` lie beside `path`.
pub fn parse(path: &Path, bytes: &[u8], limits: &Limits, pose: Option<&Pose>) -> Result<MeshFile, Fault> {
    let (json, chunk) = document::split(bytes)?;
    let mut document = document::parse(json)?;
    let buffers = data::load(&document, chunk, path, limits)?;
    if let Some(pose) = pose {
        Changes::of(&Data { document: &document, buffers: &buffers, limits }, pose)?.apply(&mut document);
    }
    let scene = Scene::new(&document)?;
    let mut reader = Reader {
        data: Data { document: &document, buffers: &buffers, limits },
        scene: &scene,
        polygons: PolygonMesh { face_offsets: vec![0], ..PolygonMesh::default() },
        blocks: Vec::new(),
        has_colours: false,
        skipped: 0,
    };
    for (index, node) in document.nodes.iter().enumerate().filter(|(index, _)| scene.is_shown[*index]) {
        reader.node(index, node)?;
    }
    let Reader { mut polygons, blocks, has_colours, skipped, .. } = reader;
    let place = plain::place(&polygons);
    for position in &mut polygons.positions {
        *position = [0, 1, 2].map(|axis| f64::from((position[axis] - place[axis]) as f32) + place[axis]);
    }
    let mut notes = Vec::new();
    if skipped > 0 {
        notes.push(format!("{skipped} primitives of points or lines were skipped."));
    }
    let mut file = MeshFile::new(polygons, Format::Gltf, notes);
    let (mut binary, mut starts) = (Vec::new(), Vec::new());
    for buffer in buffers {
        binary.resize(binary.len().next_multiple_of(4), 0);
        starts.push(binary.len());
        binary.extend_from_slice(&buffer.unwrap_or_default());
    }
    file.source = Source::Gltf(GltfFile { json: json.to_vec(), binary, starts, blocks, has_colours });
    Ok(file)
}

struct Reader<'a> {
    data: Data<'a>,
    scene: &'a Scene,
    polygons: PolygonMesh,
    blocks: Vec<Block>,
    has_colours: bool,
    skipped: usize,
}

impl Reader<'_> {
    fn node(&mut self, index: usize, node: &Node) -> Result<(), Fault> {
        let Some(mesh) = node.mesh else { return Ok(()) };
        let mesh = get(&self.data.document.meshes, mesh, "mesh")?;
        let weights = node.weights.as_ref().unwrap_or(&mesh.weights);
        let joints = node.skin.map(|skin| self.scene.joints(&self.data, skin)).transpose()?;
        let mut known = HashMap::new();
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let attribute = |name: &str| primitive.attributes.get(name).copied();
            let mode = primitive.mode.unwrap_or(4);
            let Some(position) = attribute("POSITION").filter(|_| (4..=6).contains(&mode)) else {
                self.skipped += 1;
                continue;
            };
            let shared = (position, attribute("JOINTS_0"), attribute("WEIGHTS_0"), &primitive.targets);
            let block = *known.entry(shared).or_insert(self.blocks.len());
            if block == self.blocks.len() {
                let start = self.polygons.positions.len();
                self.vertices(position, primitive, weights, &self.scene.worlds[index], joints.as_deref())?;
                let vertices = start..self.polygons.positions.len();
                self.blocks.push(Block { node: index, primitives: Vec::new(), vertices });
            }
            self.blocks[block].primitives.push(number);
            self.has_colours |= attribute("COLOR_0").is_some();
            // A map that mirrors turns faces round; a skin's joints take the place of the node's map.
            let turned = joints.is_none() && scene::mirrors(&self.scene.worlds[index]);
            self.faces(primitive, mode, self.blocks[block].vertices.clone(), turned)?;
        }
        Ok(())
    }

    fn vertices(
        &mut self,
        position: usize,
        primitive: &Primitive,
        weights: &[f64],
        world: &Matrix,
        joints: Option<&[Matrix]>,
    ) -> Result<(), Fault> {
        let count = get(&self.data.document.accessors, position, "accessor")?.count;
        self.data.limits.check_vertices(count.saturating_add(self.polygons.positions.len() as u64))?;
        let mut numbers = self.data.numbers(position, 3)?;
        for (target, weight) in primitive.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let Some(&shift) = target.get("POSITION") else { continue };
            let shifts = self.data.numbers(shift, 3)?;
            numbers.iter_mut().zip(shifts).for_each(|(number, shift)| *number += weight * shift);
        }
        let bound = match joints {
            Some(joints) => self.bound(primitive, joints, count as usize)?,
            None => Vec::new(),
        };
        let placed = numbers
            .as_chunks()
            .0
            .iter()
            .enumerate()
            .map(|(vertex, &position)| scene::apply(bound.get(vertex).unwrap_or(world), position));
        self.polygons.positions.extend(placed);
        Ok(())
    }

    /// The weighted mean of the joints' maps for each vertex; nothing for a primitive without weights.
    fn bound(&self, primitive: &Primitive, joints: &[Matrix], count: usize) -> Result<Vec<Matrix>, Fault> {
        let mut maps = Vec::new();
        let mut sums = vec![0.0; count];
        for set in 0.. {
            let attribute = |name: &str| primitive.attributes.get(&format!("{name}_{set}"));
            let (Some(&of), Some(&by)) = (attribute("JOINTS"), attribute("WEIGHTS")) else { break };
            maps.resize(count, [[0.0; 4]; 3]);
            let (of, by) = (self.data.numbers(of, 4)?, self.data.numbers(by, 4)?);
            for (at, (joint, weight)) in of.into_iter().zip(by).enumerate().take(4 * count) {
                if weight != 0.0 {
                    let joint = get(joints, joint as usize, "joint")?;
                    let (map, whole) = (maps[at / 4].as_flattened_mut(), joint.as_flattened());
                    map.iter_mut().zip(whole).for_each(|(sum, number)| *sum += weight * number);
                    sums[at / 4] += weight;
                }
            }
        }
        for (map, sum) in maps.iter_mut().zip(sums).filter(|(_, sum)| *sum > 0.0) {
            map.as_flattened_mut().iter_mut().for_each(|number| *number /= sum);
        }
        Ok(maps)
    }

    fn faces(
        &mut self,
        primitive: &Primitive,
        mode: u32,
        vertices: Range<usize>,
        turned: bool,
    ) -> Result<(), Fault> {
        let count = match primitive.indices {
            Some(indices) => get(&self.data.document.accessors, indices, "accessor")?.count,
            None => vertices.len() as u64,
        };
        let faces = if mode == 4 { count / 3 } else { count.saturating_sub(2) };
        self.data.limits.check_faces(faces.saturating_add(self.polygons.face_offsets.len() as u64 - 1))?;
        let corners = primitive.indices.map(|indices| self.data.numbers(indices, 1)).transpose()?;
        for face in 0..faces as usize {
            let mut places = match mode {
                4 => [3 * face, 3 * face + 1, 3 * face + 2],
                5 => [face, face + 1 + face % 2, face + 2 - face % 2],
                _ => [face + 1, face + 2, 0],
            };
            if turned {
                places.swap(1, 2);
            }
            for place in places {
                let corner = corners.as_ref().map_or(place, |corners| corners[place] as usize);
                if corner >= vertices.len() {
                    let count = vertices.len();
                    return Err(Fault::new(format!(
                        "a primitive refers to its vertex {corner}, but has {count}, numbered from 0; export the file again"
                    )));
                }
                self.polygons.face_vertices.push((vertices.start + corner) as u32);
            }
            close_face(&mut self.polygons)?;
        }
        Ok(())
    }
}
