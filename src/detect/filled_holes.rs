//! Small holes of the shell on which a map is sought, filled.
//!
//! A hole changes eigenfunctions, distances and signatures around it, and a scan has holes on one side that its other side has not. So
//! each closed boundary that is short is filled by triangles around the mean of its vertices, which is near enough: what is asked of the filling
//! is that the surface goes on, not where. Nothing of it is seen in what the caller gets.

use crate::connectivity::automorphism::hash;
use crate::geometry::embedded_triangles::TrianglePoint;
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::vector::{Vector, mean, squared_norm, subtract};
use crate::mesh::{MOST_AROUND, NONE, Shell};
use std::collections::{HashMap, HashSet};

/// Longest boundary that is filled, in sqrt(area).
const LONGEST: f64 = 1.0;
/// An image this far inside a filling, in sqrt(area), says nothing of where on the surface it might be.
const LOST: f64 = 0.05;

/// A shell whose first vertices and triangles are those of another, and whose last fill that one's holes.
pub struct FilledShell {
    /// The shell; its vertices inside fillings are no point of the mesh, [`NONE`].
    pub shell: Shell,
    /// Triangles that are no filling.
    own_triangles: usize,
    /// Vertices around each filled hole, then those of each joint.
    rims: Vec<Vec<u32>>,
    /// How many of those are holes.
    holes: usize,
    /// The rim of each triangle of a filling.
    rim_of: Vec<u32>,
}

impl FilledShell {
    /// `joints` are added, too: triangles over the shell's vertices that join its parts. `None` if there are none, and nothing is to be filled:
    /// no short boundary, sides that cannot be told, or because the caller wants none filled. O(triangles).
    pub fn new(shell: &Shell, joints: &[[u32; 3]], fills: bool) -> Option<FilledShell> {
        let mut rims = match fills && shell.orientable && shell.scale > 0.0 {
            true => boundaries(shell),
            false => Vec::new(),
        };
        rims.retain(|rim| length(rim, &shell.positions) <= LONGEST);
        let holes = rims.len();
        rims.extend(joints.iter().map(|joint| joint.to_vec()));
        if rims.is_empty() {
            return None;
        }
        let (mut positions, mut triangles) = (shell.positions.clone(), shell.triangles.clone());
        let mut rim_of = Vec::new();
        for (index, rim) in rims.iter().enumerate() {
            match rim[..] {
                [a, b, c] => triangles.push([a, b, c]),
                _ => {
                    let middle = positions.len() as u32;
                    positions.push(mean(rim.iter().map(|&vertex| positions[vertex as usize])));
                    triangles.extend(around(rim).map(|(from, to)| [from, to, middle]));
                }
            }
            rim_of.resize(triangles.len() - shell.triangles.len(), index as u32);
        }
        let mut points = shell.points.clone();
        points.resize(positions.len(), NONE);
        let mut triangle_of_local = shell.triangle_of_local.clone();
        triangle_of_local.resize(triangles.len(), NONE);
        let filled = Shell { points, positions, triangles, triangle_of_local, scale: shell.scale, ..*shell };
        Some(FilledShell {
            shell: filled.rescaled(),
            own_triangles: shell.triangles.len(),
            rims,
            holes,
            rim_of,
        })
    }

    /// How many holes are filled.
    pub fn hole_count(&self) -> usize {
        self.holes
    }

    /// Moves images of the filled shell's vertices from fillings to the nearest vertices around them; gives back which share of its confidence each
    /// image keeps, 0..=1.
    pub fn leave_fillings(&self, images: &mut VertexMap) -> Vec<f32> {
        let Shell { positions, triangles, .. } = &self.shell;
        let mut on_rim = vec![false; positions.len()];
        self.rims.iter().flatten().for_each(|&vertex| on_rim[vertex as usize] = true);
        let mut corner_of = HashMap::new();
        for (index, triangle) in triangles[..self.own_triangles].iter().enumerate() {
            for (corner, &vertex) in triangle.iter().enumerate().filter(|(_, v)| on_rim[**v as usize]) {
                corner_of.insert(vertex, (index as u32, corner));
            }
        }
        let leave = |partner: &mut u32, point: &mut TrianglePoint| {
            let Some(filling) = (point.triangle as usize).checked_sub(self.own_triangles) else { return 1.0 };
            let place = point.interpolate_vectors(triangles, positions);
            let away = |vertex: &u32| squared_norm(subtract(positions[*vertex as usize], place));
            let rim = &self.rims[self.rim_of[filling] as usize];
            let nearest = rim.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b))).expect("a rim");
            let (triangle, corner) = corner_of[&nearest];
            let barycentric = std::array::from_fn(|k| if k == corner { 1.0 } else { 0.0 });
            (*partner, *point) = (nearest, TrianglePoint { triangle, barycentric });
            (1.0 - away(&nearest).sqrt() / LOST).max(0.0) as f32
        };
        images
            .partners
            .iter_mut()
            .zip(&mut images.points)
            .map(|(partner, point)| leave(partner, point))
            .collect()
    }
}

/// Closed boundaries, each against the direction of its triangles, those of two holes that meet at a vertex apart; where more meet, they are taken for one.
///
/// [`crate::mesh::half_edges`] go around holes, too, but around two that meet as around one, and are made only while this one's result is solved.
fn boundaries(shell: &Shell) -> Vec<Vec<u32>> {
    let corners = || shell.triangles.iter().flat_map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]]);
    // Around a vertex inside, each neighbour is as often the end of an edge as the start of one, so that the sum of any numbers of theirs vanishes;
    // hardly any few hashes have the same sum.
    let mut balance = vec![0u64; shell.points.len()];
    for triangle in &shell.triangles {
        let numbers = triangle.map(|corner| hash(u64::from(corner)));
        for (k, &corner) in triangle.iter().enumerate() {
            let own = &mut balance[corner as usize];
            *own = own.wrapping_add(numbers[(k + 1) % 3]).wrapping_sub(numbers[(k + 2) % 3]);
        }
    }
    let is_rim = |vertex: u32| balance[vertex as usize] != 0;
    // The third corner beside each edge that starts at such a vertex.
    let beside: HashMap<(u32, u32), u32> =
        corners().filter(|[from, ..]| is_rim(*from)).map(|[from, to, third]| ((from, to), third)).collect();
    let is_open = |(from, to): (u32, u32)| is_rim(to) && !beside.contains_key(&(to, from));
    let mut open: Vec<(u32, u32)> = beside.keys().copied().filter(|&edge| is_open(edge)).collect();
    open.sort_unstable();
    let mut open_at: HashMap<u32, Vec<u32>> = HashMap::new();
    for &(from, to) in &open {
        open_at.entry(to).or_default().push(from);
    }
    let after = |(from, to): (u32, u32)| {
        let mut third = *beside.get(&(from, to))?;
        for _ in 0..MOST_AROUND {
            match beside.get(&(from, third)) {
                Some(&next) => third = next,
                None => break,
            }
        }
        // Along the triangles around it the other hole of two is reached.
        match open_at.get(&from)?[..] {
            [a, b] if third == a => Some((b, from)),
            [a, b] if third == b => Some((a, from)),
            _ => Some((third, from)),
        }
    };
    let mut passed = HashSet::new();
    let mut found = Vec::new();
    for start in open {
        let (mut edge, mut rim) = (start, Vec::new());
        while passed.insert(edge) {
            rim.push(edge.1);
            let Some(next) = after(edge).filter(|&next| is_open(next)) else { break };
            edge = next;
        }
        if edge == start && rim.len() > 2 {
            found.push(rim);
        }
    }
    found
}

fn around(rim: &[u32]) -> impl Iterator<Item = (u32, u32)> + '_ {
    rim.iter().copied().zip(rim.iter().copied().cycle().skip(1))
}

fn length(rim: &[u32], positions: &[Vector]) -> f64 {
    around(rim)
        .map(|(a, b)| squared_norm(subtract(positions[a as usize], positions[b as usize])).sqrt())
        .sum()
}
