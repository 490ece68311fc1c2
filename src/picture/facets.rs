//! The surface as small flat facets of one colour each, and the pieces of the fixed curve, seen in a view.

use super::view::View;
use crate::detect::correspondence::{EdgePoint, Symmetry};
use crate::mesh::vector::{cross, dot, subtract};
use crate::mesh::{Mesh, NONE};
use crate::mirror::pair_colour::pair_colours;

/// Longest edge of a facet in pixels: longer ones are halved, for smooth colours and correct order.
const LONGEST_EDGE: f32 = 18.0;
/// Most halvings of one triangle.
const DEEPEST: u32 = 6;
/// Light from the upper left, in front: right, up, towards the eye.
const LIGHT: [f32; 3] = [-0.41, 0.53, 0.74];
/// Light that falls everywhere.
const AMBIENT: f32 = 0.56;

/// What is drawn, in the mesh's coordinates: per point a position, a normal and a colour.
pub struct Surface<'a> {
    mesh: &'a Mesh,
    normals: Vec<[f64; 3]>,
    colours: Vec<[f32; 3]>,
    curve: Vec<[EdgePoint; 2]>,
}

/// One thing to paint. Positions in pixels of the panel.
#[derive(Debug, Clone, Copy)]
pub struct Item {
    /// Distance towards the eye; items are painted from small to large.
    pub depth: f32,
    /// Corners of a triangle, or both ends of a line (and the second one again).
    pub corners: [[f32; 2]; 3],
    /// Colour of a facet; `None` for a piece of the fixed curve.
    pub colour: Option<[u8; 3]>,
}

#[derive(Clone, Copy)]
struct Corner {
    place: [f32; 3],
    normal: [f32; 3],
    colour: [f32; 3],
}

/// From the mesh's coordinates to a panel's pixels.
#[derive(Debug, Clone, Copy)]
pub struct Placement {
    /// Pixels per unit.
    pub scale: f64,
    /// Pixel of the origin.
    pub origin: [f64; 2],
}

impl<'a> Surface<'a> {
    /// Colours, normals and curve of a symmetry.
    pub fn new(mesh: &'a Mesh, symmetry: &Symmetry) -> Surface<'a> {
        let of_vertex = pair_colours(mesh, symmetry);
        let colours =
            mesh.vertex_of_point.iter().map(|&vertex| of_vertex[vertex as usize].map(f32::from)).collect();
        let mut curve = Vec::new();
        for line in &symmetry.fixed_curve {
            curve.extend(line.points.windows(2).map(|pair| [pair[0], pair[1]]));
            if let (true, [first, .., last]) = (line.closed, &line.points[..]) {
                curve.push([*last, *first]);
            }
        }
        Surface { mesh, normals: point_normals(mesh), colours, curve }
    }

    /// Right and up of every point, for fitting the view.
    pub fn outline(&self, view: &View) -> impl Iterator<Item = [f64; 2]> {
        let view = *view;
        self.mesh.positions.iter().map(move |&position| {
            let [right, up, _] = view.project(position);
            [right, up]
        })
    }

    /// Everything to paint, from back to front.
    pub fn items(&self, view: &View, placement: &Placement) -> Vec<Item> {
        let corners: Vec<Corner> =
            (0..self.mesh.positions.len()).map(|point| self.corner(point, view, placement)).collect();
        let mut items = Vec::with_capacity(self.mesh.triangles.len() + self.curve.len());
        for triangle in &self.mesh.triangles {
            divide(triangle.map(|point| corners[point as usize]), 0, &mut items);
        }
        let lift = 1.5 * typical_edge(&self.mesh.triangles, &corners);
        items.extend(self.curve.iter().filter_map(|piece| self.piece(piece, &corners, lift)));
        items.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        items
    }

    fn corner(&self, point: usize, view: &View, placement: &Placement) -> Corner {
        let [right, up, toward] = view.project(self.mesh.positions[point]);
        let place = [
            placement.origin[0] + placement.scale * right,
            placement.origin[1] - placement.scale * up,
            placement.scale * toward,
        ];
        let normal = view.project(self.normals[point]);
        Corner {
            place: place.map(|value| value as f32),
            normal: normal.map(|value| value as f32),
            colour: self.colours[point],
        }
    }

    /// A piece of the fixed curve, lifted off the surface; none on the far side.
    fn piece(&self, piece: &[EdgePoint; 2], corners: &[Corner], lift: f32) -> Option<Item> {
        let [first, last] = piece.map(|end| self.on_edge(&end, corners));
        let (first, last) = (first?, last?);
        let facing = first.normal[2] + last.normal[2];
        let depth = (first.place[2] + last.place[2]) / 2.0 + lift;
        let corners = [first, last, last].map(|corner| [corner.place[0], corner.place[1]]);
        (facing > -0.6).then_some(Item { depth, corners, colour: None })
    }

    fn on_edge(&self, point: &EdgePoint, corners: &[Corner]) -> Option<Corner> {
        let ends = [point.from, point.to].map(|vertex| self.mesh.point_of_vertex[vertex as usize]);
        if ends.contains(&NONE) {
            return None;
        }
        let [from, to] = ends.map(|end| corners[end as usize]);
        Some(between(&from, &to, point.t))
    }
}

/// Area-weighted normals of the points, outward on closed shells (where "outward" means anything).
fn point_normals(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut normals = vec![[0.0; 3]; mesh.positions.len()];
    let mut volumes = vec![0.0; mesh.shell_count];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|point| mesh.positions[point as usize]);
        let normal = cross(subtract(b, a), subtract(c, a));
        let volume = dot(a, normal);
        volumes[mesh.shell_of_point[triangle[0] as usize] as usize] += volume;
        for &point in triangle {
            let sum = &mut normals[point as usize];
            *sum = [sum[0] + normal[0], sum[1] + normal[1], sum[2] + normal[2]];
        }
    }
    for (point, normal) in normals.iter_mut().enumerate() {
        let length = normal.iter().map(|value| value * value).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        let outward = if volumes[mesh.shell_of_point[point] as usize] < 0.0 { -length } else { length };
        *normal = normal.map(|value| value / outward);
    }
    normals
}

/// Median of the triangles' longest projected edges, in pixels.
fn typical_edge(triangles: &[[u32; 3]], corners: &[Corner]) -> f32 {
    let mut lengths: Vec<f32> = triangles
        .iter()
        .map(|triangle| longest_edge(&triangle.map(|point| corners[point as usize])).min(LONGEST_EDGE))
        .collect();
    let middle = lengths.len() / 2;
    *lengths.select_nth_unstable_by(middle, f32::total_cmp).1
}

fn longest_edge(corners: &[Corner; 3]) -> f32 {
    let length = |a: &Corner, b: &Corner| (a.place[0] - b.place[0]).hypot(a.place[1] - b.place[1]);
    let [a, b, c] = corners;
    length(a, b).max(length(b, c)).max(length(c, a))
}

/// Adds the triangle, halved along all edges while it is large.
fn divide(corners: [Corner; 3], depth: u32, items: &mut Vec<Item>) {
    if depth >= DEEPEST || longest_edge(&corners) <= LONGEST_EDGE {
        items.push(facet(&corners));
        return;
    }
    let [a, b, c] = corners;
    let [ab, bc, ca] = [between(&a, &b, 0.5), between(&b, &c, 0.5), between(&c, &a, 0.5)];
    for part in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
        divide(part, depth + 1, items);
    }
}

fn between(a: &Corner, b: &Corner, t: f32) -> Corner {
    let mix = |a: &[f32; 3], b: &[f32; 3]| std::array::from_fn(|k| (1.0 - t) * a[k] + t * b[k]);
    Corner {
        place: mix(&a.place, &b.place),
        normal: mix(&a.normal, &b.normal),
        colour: mix(&a.colour, &b.colour),
    }
}

fn facet(corners: &[Corner; 3]) -> Item {
    let mean = |of: fn(&Corner) -> [f32; 3]| -> [f32; 3] {
        std::array::from_fn(|k| corners.iter().map(|corner| of(corner)[k]).sum::<f32>() / 3.0)
    };
    let place = mean(|corner| corner.place);
    let brightness = brightness(mean(|corner| corner.normal));
    let colour = mean(|corner| corner.colour).map(|value| (value * brightness).clamp(0.0, 255.0) as u8);
    Item {
        depth: place[2],
        corners: corners.map(|corner| [corner.place[0], corner.place[1]]),
        colour: Some(colour),
    }
}

/// Diffuse light on both sides of the surface: the inside of an open mesh is lit as well.
fn brightness(normal: [f32; 3]) -> f32 {
    let length = normal.iter().map(|value| value * value).sum::<f32>().sqrt().max(f32::MIN_POSITIVE);
    let toward_eye = if normal[2] < 0.0 { -length } else { length };
    let lit: f32 = (0..3).map(|k| LIGHT[k] * normal[k] / toward_eye).sum();
    AMBIENT + (1.06 - AMBIENT) * lit.max(0.0)
}
