//! Where the nodes of a glTF scene stand, and the joints of its skins.

use super::data::Data;
use super::document::{Document, Node, get};
use crate::mesh::NONE;
use crate::mesh::io::scanner::Fault;
use crate::mesh::vector::{cross, dot};

/// Three rows of an affine map.
pub type Matrix = [[f64; 4]; 3];

const IDENTITY: Matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// The map of a point.
pub fn apply(matrix: &Matrix, [x, y, z]: [f64; 3]) -> [f64; 3] {
    matrix.map(|[a, b, c, d]| a * x + b * y + c * z + d)
}

/// Whether a map mirrors, so that the corners of a face turn round.
pub fn mirrors([a, b, c]: &Matrix) -> bool {
    let [a, b, c] = [a, b, c].map(|&[x, y, z, _]| [x, y, z]);
    dot(cross(a, b), c) < 0.0
}

/// First `inner`, then `outer`.
fn compose(outer: &Matrix, inner: &Matrix) -> Matrix {
    outer.map(|row| {
        let mut product =
            [0, 1, 2, 3].map(|column| (0..3).map(|at| row[at] * inner[at][column]).sum::<f64>());
        product[3] += row[3];
        product
    })
}

/// From glTF's 16 numbers, column by column.
fn of_columns(columns: &[f64; 16]) -> Matrix {
    [0, 1, 2].map(|row| [0, 4, 8, 12].map(|column| columns[column + row]))
}

fn local(node: &Node) -> Matrix {
    if let Some(columns) = &node.matrix {
        return of_columns(columns);
    }
    let [x, y, z, w] = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = node.scale.unwrap_or([1.0; 3]);
    let shift = node.translation.unwrap_or([0.0; 3]);
    let rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ];
    [0, 1, 2].map(|row| {
        let [a, b, c] = rows[row];
        [a * scale[0], b * scale[1], c * scale[2], shift[row]]
    })
}

/// The nodes as they stand.
pub struct Scene {
    /// From each node to the scene.
    pub worlds: Vec<Matrix>,
    /// Whether a node belongs to the scene that is shown.
    pub is_shown: Vec<bool>,
}

impl Scene {
    /// Of the default scene, or else the first one, or else all nodes.
    pub fn new(document: &Document) -> Result<Scene, Fault> {
        let nodes = &document.nodes;
        let parents = parents(nodes)?;
        let mut is_shown = vec![document.scenes.is_empty(); nodes.len()];
        if !document.scenes.is_empty() {
            for &root in &get(&document.scenes, document.scene.unwrap_or(0), "scene")?.nodes {
                get(nodes, root, "node")?;
                is_shown[root] = true;
            }
        }
        let mut worlds = vec![IDENTITY; nodes.len()];
        let mut stack: Vec<usize> = (0..nodes.len()).filter(|&node| parents[node] == NONE).collect();
        let mut visited = 0;
        while let Some(node) = stack.pop() {
            visited += 1;
            worlds[node] = local(&nodes[node]);
            if let Some(parent) = Some(parents[node] as usize).filter(|&parent| parent < nodes.len()) {
                worlds[node] = compose(&worlds[parent], &worlds[node]);
                is_shown[node] |= is_shown[parent];
            }
            stack.extend(&nodes[node].children);
        }
        if visited < nodes.len() {
            return Err(Fault::new("some nodes are their own descendants; export the file again"));
        }
        Ok(Scene { worlds, is_shown })
    }

    /// What each joint of a skin does to the vertices bound to it.
    pub fn joints(&self, data: &Data, skin: usize) -> Result<Vec<Matrix>, Fault> {
        let skin = get(&data.document.skins, skin, "skin")?;
        let inverse = match skin.inverse_bind_matrices {
            Some(accessor) => data.numbers(accessor, 16)?,
            None => Vec::new(),
        };
        let inverse = inverse.as_chunks().0;
        let of_joint = |(at, &node): (usize, &usize)| {
            let world = get(&self.worlds, node, "node")?;
            Ok(inverse.get(at).map_or(*world, |columns| compose(world, &of_columns(columns))))
        };
        skin.joints.iter().enumerate().map(of_joint).collect()
    }
}

/// The parent of each node, or [`NONE`].
fn parents(nodes: &[Node]) -> Result<Vec<u32>, Fault> {
    let mut parents = vec![NONE; nodes.len()];
    for (parent, node) in nodes.iter().enumerate() {
        for &child in &node.children {
            get(nodes, child, "node")?;
            if parents[child] != NONE {
                return Err(Fault::new(format!(
                    "node {child} is a child of both node {} and node {parent}; export the file again",
                    parents[child]
                )));
            }
            parents[child] = parent as u32;
        }
    }
    Ok(parents)
}
