//! The surface and the fixed curve as they are seen in a view.

use super::canvas::Corner;
use super::view::View;
use intrinsym::internals::mesh::vector::{cross, dot, subtract};
use intrinsym::mirror::pair_colour::pair_colours;
use intrinsym::{EdgePoint, Mesh, NONE, Symmetry};

/// Longest part of the fixed curve that is hidden or seen as a whole, in pixels, and the largest edge that counts as typical.
const LONGEST_EDGE: f32 = 18.0;
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

/// A short straight part of the fixed curve.
#[derive(Debug, Clone, Copy)]
pub struct Stroke {
    /// Its ends, in pixels.
    pub ends: [[f32; 2]; 2],
    /// Its middle, lifted off the surface: in pixels, and the distance towards the eye.
    pub middle: [f32; 3],
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

    /// All triangles, and the parts of the fixed curve on the side that is seen.
    pub fn seen(&self, view: &View, placement: &Placement) -> (Vec<[Corner; 3]>, Vec<Stroke>) {
        let corners: Vec<Corner> =
            (0..self.mesh.positions.len()).map(|point| self.corner(point, view, placement)).collect();
        let of_triangle = |triangle: &[u32; 3]| triangle.map(|point| corners[point as usize]);
        let triangles: Vec<[Corner; 3]> = self.mesh.triangles.iter().map(of_triangle).collect();
        let lift = 1.5 * typical_edge(&triangles);
        let strokes = self.curve.iter().flat_map(|piece| self.strokes(piece, &corners, lift)).collect();
        (triangles, strokes)
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
    fn strokes(&self, piece: &[EdgePoint; 2], corners: &[Corner], lift: f32) -> Vec<Stroke> {
        let [Some(first), Some(last)] = piece.map(|end| self.on_edge(&end, corners)) else {
            return Vec::new();
        };
        if first.normal[2] + last.normal[2] <= -0.6 {
            return Vec::new();
        }
        let count = (length(&first, &last) / LONGEST_EDGE).ceil().clamp(1.0, 256.0);
        let at = |part: f32| between(&first, &last, part / count).place;
        let stroke = |part: u16| {
            let [from, to] = [at(part.into()), at(f32::from(part) + 1.0)].map(|[x, y, _]| [x, y]);
            let [x, y, toward] = at(f32::from(part) + 0.5);
            Stroke { ends: [from, to], middle: [x, y, toward + lift] }
        };
        (0..count as u16).map(stroke).collect()
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
fn typical_edge(triangles: &[[Corner; 3]]) -> f32 {
    let longest =
        |[a, b, c]: &[Corner; 3]| length(a, b).max(length(b, c)).max(length(c, a)).min(LONGEST_EDGE);
    let mut lengths: Vec<f32> = triangles.iter().map(longest).collect();
    let middle = lengths.len() / 2;
    *lengths.select_nth_unstable_by(middle, f32::total_cmp).1
}

/// Distance in the picture, in pixels.
fn length(a: &Corner, b: &Corner) -> f32 {
    (a.place[0] - b.place[0]).hypot(a.place[1] - b.place[1])
}

fn between(a: &Corner, b: &Corner, t: f32) -> Corner {
    let mix = |a: &[f32; 3], b: &[f32; 3]| std::array::from_fn(|k| (1.0 - t) * a[k] + t * b[k]);
    Corner {
        place: mix(&a.place, &b.place),
        normal: mix(&a.normal, &b.normal),
        colour: mix(&a.colour, &b.colour),
    }
}

/// Diffuse light on both sides of the surface: the inside of an open mesh is lit as well.
pub fn brightness(normal: [f32; 3]) -> f32 {
    let length = normal.iter().map(|value| value * value).sum::<f32>().sqrt().max(f32::MIN_POSITIVE);
    let toward_eye = if normal[2] < 0.0 { -length } else { length };
    let lit: f32 = (0..3).map(|k| LIGHT[k] * normal[k] / toward_eye).sum();
    AMBIENT + (1.06 - AMBIENT) * lit.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use intrinsym::{Limits, PolygonMesh};

    /// A tetrahedron about the origin, its faces wound outward or inward.
    fn tetrahedron(outward: bool) -> Mesh {
        let positions = vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
        let mut face_vertices = vec![0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2];
        if !outward {
            face_vertices.chunks_mut(3).for_each(|face| face.swap(1, 2));
        }
        let polygons = PolygonMesh { positions, face_offsets: vec![0, 3, 6, 9, 12], face_vertices };
        Mesh::new(&polygons, &Limits::default()).expect("a usable mesh")
    }

    #[test]
    fn normals_of_a_closed_shell_point_outward_however_it_is_wound() {
        for mesh in [tetrahedron(true), tetrahedron(false)] {
            for (normal, position) in point_normals(&mesh).into_iter().zip(&mesh.positions) {
                assert!((dot(normal, *position) - dot(*position, *position).sqrt()).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn distances_are_in_the_picture() {
        let corner = |place| Corner { place, normal: [0.0; 3], colour: [0.0; 3] };
        assert_eq!(length(&corner([1.0, 9.0, 5.0]), &corner([4.0, 5.0, 0.0])), 5.0);
    }
}
