//! A map of a shell's vertices to points of the surface, as every stage passes it on.

use crate::geometry::embedded_triangles::TrianglePoint;
use std::collections::HashMap;

/// Where a shell's vertices go.
#[derive(Debug, Clone)]
pub struct VertexMap {
    /// Nearest target vertex.
    pub partners: Vec<u32>,
    /// Nearest point of the target.
    pub points: Vec<TrianglePoint>,
}

impl VertexMap {
    /// Images that are vertices: `partners[v]` is that of v, a corner of some of the `triangles`. O(both).
    pub fn at_vertices(triangles: &[[u32; 3]], partners: Vec<u32>) -> VertexMap {
        let mut corner_of = HashMap::new();
        for (index, triangle) in triangles.iter().enumerate() {
            for (corner, &vertex) in triangle.iter().enumerate() {
                corner_of.insert(vertex, (index as u32, corner));
            }
        }
        let point = |vertex: &u32| {
            let (triangle, corner) = corner_of[vertex];
            TrianglePoint {
                triangle,
                barycentric: std::array::from_fn(|c| if c == corner { 1.0 } else { 0.0 }),
            }
        };
        VertexMap { points: partners.iter().map(point).collect(), partners }
    }
}
