//! Makes polygons manifold by giving each fan of faces its own vertex.
//!
//! Two faces are glued along an edge if they are its only two and run along it in opposite directions;
//! all other inner edges are cut. The corners glued together round a point are one fan, hence one vertex,
//! as in Gueziec, Taubin, Lazarus and Horn, "Cutting and stitching" (IEEE TVCG 2001), their global cut.
//! Deviation: a face that would still repeat a directed edge (a Moebius band) or that repeats a point
//! is detached from all its neighbours. Cost O(corners), plus a sort within each vertex's edges.

use super::edges::{EdgeTable, UnionFind, next_corners};

/// Manifold polygons over new vertices, and the way back.
pub(super) struct Fans {
    /// New vertex of each corner.
    pub corner_vertex: Vec<u32>,
    /// Point of each new vertex; rising, so that without any split the order of points is kept.
    pub point_of_vertex: Vec<u32>,
}

/// Splits points until every directed edge has one face and every vertex one fan.
///
/// Faces are `points[offsets[f]..offsets[f + 1]]`, each with at least three corners, `points < point_count`.
pub(super) fn split(point_count: usize, offsets: &[u32], points: &[u32]) -> Fans {
    let next = next_corners(offsets);
    let mut detached = faces_repeating_a_point(offsets, points);
    loop {
        let fans = glue(point_count, points, &next, &detached);
        let repeating = corners_repeating_an_edge(&fans, &next);
        if repeating.is_empty() {
            return fans;
        }
        for corner in repeating {
            let face = offsets.partition_point(|&offset| offset <= corner) - 1;
            let corners = offsets[face] as usize..offsets[face + 1] as usize;
            detached[corners].fill(true);
        }
    }
}

/// Per corner, whether its face meets a point twice.
fn faces_repeating_a_point(offsets: &[u32], points: &[u32]) -> Vec<bool> {
    let mut repeating = vec![false; points.len()];
    let mut sorted = Vec::new();
    for face in offsets.windows(2) {
        let corners = face[0] as usize..face[1] as usize;
        sorted.clear();
        sorted.extend_from_slice(&points[corners.clone()]);
        sorted.sort_unstable();
        if sorted.windows(2).any(|pair| pair[0] == pair[1]) {
            repeating[corners].fill(true);
        }
    }
    repeating
}

fn glue(point_count: usize, points: &[u32], next: &[u32], detached: &[bool]) -> Fans {
    let mut fans = UnionFind::new(points.len());
    for corners in EdgeTable::of(point_count, points, next).edges() {
        let &[first, second] = corners else { continue };
        let (first, second) = (first as usize, second as usize);
        let opposite = points[first] != points[second];
        if opposite && !detached[first] && !detached[second] {
            fans.join(first as u32, next[second]);
            fans.join(next[first], second as u32);
        }
    }
    number_by_point(points, &mut fans)
}

fn number_by_point(points: &[u32], fans: &mut UnionFind) -> Fans {
    let corners = 0..points.len() as u32;
    let mut roots: Vec<u32> = corners.clone().filter(|&corner| fans.find(corner) == corner).collect();
    roots.sort_by_key(|&root| points[root as usize]);
    let mut vertex_of_root = vec![0; points.len()];
    for (vertex, &root) in roots.iter().enumerate() {
        vertex_of_root[root as usize] = vertex as u32;
    }
    Fans {
        corner_vertex: corners.map(|corner| vertex_of_root[fans.find(corner) as usize]).collect(),
        point_of_vertex: roots.iter().map(|&root| points[root as usize]).collect(),
    }
}

/// Corners whose edge runs the same way as that of an earlier corner.
fn corners_repeating_an_edge(fans: &Fans, next: &[u32]) -> Vec<u32> {
    let mut repeating = Vec::new();
    let vertices = &fans.corner_vertex;
    for corners in EdgeTable::of(fans.point_of_vertex.len(), vertices, next).edges() {
        for (position, &corner) in corners.iter().enumerate() {
            let starts_alike = |&earlier: &u32| vertices[earlier as usize] == vertices[corner as usize];
            if corners[..position].iter().any(starts_alike) {
                repeating.push(corner);
            }
        }
    }
    repeating
}
