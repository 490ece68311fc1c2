//! The mirror plane of a mesh at rest, if it has one.
//!
//! What nobody has posed yet is symmetric in space, and its plane says more than any map along the surface. A plane's normal is at first a principal
//! axis; the plane is then brought to where the images of places lie best on the tangent planes of the surface (Y. Chen, G. Medioni, "Object modelling by registration of
//! multiple range images", 1992).

use crate::base::threads;
use crate::geometry::surface_grid::{Place, places};
use crate::geometry::surface_walk::{SurfaceWalk, nearest_of};
use crate::mesh::Mesh;
use crate::mesh::rotation::principal_axes;
use crate::mesh::vector::{Vector, cross, dot, mean, squared_norm, subtract, unit};
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::f64::consts::PI;

/// Distance of the places that are compared, in sqrt(area), and how many are fitted.
const SPACING: f64 = 0.02;
const FITTED: usize = 100;
/// Places on which a plane that is near is settled, and how little it then moves, in sqrt(area).
const SETTLED: usize = 400;
/// Points of the mesh on which it is settled in the end.
const POINTS: usize = 1000;
const RESTS: f64 = 1e-6;
/// Distance of a plane's image from the surface, in sqrt(area), up to which a point counts as mirrored.
pub const MIRRORED: f64 = 0.006;
/// The same of a vertex from another one's image, and of a point that is mirrored exactly.
const MEETS: f64 = 0.001;
/// The least share of the surface, and of points of the mesh, that a mirror plane of the mesh mirrors.
pub const MOSTLY: f64 = 0.75;
/// Rounds of the fit.
const ROUNDS: usize = 8;
/// Places near an image whose triangles may hold the nearest point.
const AROUND: usize = 4;
/// Of a plane worth settling, images of [`MOSTLY`] all places are this near to the surface, in sqrt(area).
const NEAR: f64 = 0.012;
/// A point whose image is farther than this, in sqrt(area), from where it should be does not count, at first and once a plane is near.
const AFAR: f64 = 0.2;
const FAR: f64 = 0.045;
/// How that shrinks each round, as far as where a point is mirrored.
const SHRINKS: f64 = 0.7;
/// Second moments as near to each other as this, in parts of the largest, leave the plane's normal open: so many are tried in half a turn.
const DISTINCT: f64 = 0.02;
const TURNS: u32 = 12;
/// Planes that put images so far apart are others, and as good if they mirror this part of what the best one mirrors.
const OTHER: f64 = 0.1;
const ALIKE: f64 = 0.97;

/// A place, its image on the surface, and the surface's normal there.
#[derive(Debug, Clone, Copy)]
struct Pair {
    from: Vector,
    to: Vector,
    normal: Vector,
}

/// A plane: what is on it has `dot(normal, position) = offset`.
#[derive(Debug, Clone, Copy)]
pub struct MirrorPlane {
    /// Of length 1.
    pub normal: Vector,
    /// In the unit of the mesh.
    pub offset: f64,
}

impl MirrorPlane {
    /// The plane that mirrors most of the surface, and whether it does so exactly; `None` if that is less than [`MOSTLY`], or if many planes mirror as much.
    ///
    /// O(triangles + area / spacing^2), about a thousand walks on the surface for each normal, and some thousand more if images are near; on at most `threads` threads.
    pub fn of(mesh: &Mesh, threads: usize) -> Option<(MirrorPlane, bool)> {
        let places: Vec<Place> = places(&mesh.positions, &mesh.triangles, SPACING);
        let middle = mean(places.iter().map(|place| place.at));
        let moments = moments(places.iter().map(|place| subtract(place.at, middle)));
        let axes = principal_axes(moments);
        let sizes = [0, 1, 2].map(|k| along(&moments, axes[k]));
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        // Of a lathe-turned body only what it wears tells the plane.
        let is_open = |[k, l]: [usize; 2]| (sizes[k] - sizes[l]).abs() < DISTINCT * largest;
        let open = [[0, 1], [1, 2], [2, 0]].into_iter().filter(|&pair| is_open(pair));
        let turned = open.flat_map(|[k, l]| {
            let turn = move |turn: u32| (PI * f64::from(turn) / f64::from(TURNS)).sin_cos();
            (1..TURNS).map(turn).map(move |(sin, cos)| [0, 1, 2].map(|i| cos * axes[k][i] + sin * axes[l][i]))
        });
        let turned: Vec<Vector> = turned.collect();
        let leaf = |(place, index): (&Place, usize)| GeomWithData::new(place.at, index);
        let tree = RTree::bulk_load(places.iter().zip(0..).map(leaf).collect());
        let some = |count: usize| {
            places.iter().step_by(places.len().div_ceil(count).max(1)).map(|place| place.at).collect()
        };
        let fitted: Vec<Vector> = some(FITTED);
        let starts =
            axes.into_iter().chain(turned).map(|normal| MirrorPlane { normal, offset: dot(normal, middle) });
        let compared: Vec<Vector> = some(SETTLED);
        let surface = SurfaceWalk::new(&mesh.positions, &mesh.triangles);
        let nearest = |goal: Vector| {
            // Of large triangles no corner may be near: those of the places nearby are looked at, too.
            let around = tree.nearest_neighbor_iter(goal).take(AROUND);
            let mut triangles: Vec<[u32; 3]> = around.map(|leaf| places[leaf.data].corners).collect();
            let (_, walked) = surface.nearest(goal, triangles[0][0]);
            triangles.push(mesh.triangles[walked.triangle as usize]);
            let (point, _) = nearest_of(goal, &mesh.positions, &triangles, 0..triangles.len() as u32);
            let corners = triangles[point.triangle as usize].map(|corner| mesh.positions[corner as usize]);
            let to = point.interpolate_vectors(&triangles, &mesh.positions);
            (to, unit(cross(subtract(corners[1], corners[0]), subtract(corners[2], corners[0]))))
        };
        let mut planes: Vec<(f64, MirrorPlane)> = Vec::new();
        let rough = threads::map(threads, starts.collect(), |start: MirrorPlane| {
            let plane = start.settled(AFAR, &fitted, nearest);
            (plane.mirrored(NEAR, &fitted, nearest) >= MOSTLY).then_some(plane)
        });
        for start in rough.into_iter().flatten() {
            let is_new = |plane: &MirrorPlane| planes.iter().all(|other| other.1.distance(plane) > OTHER);
            if is_new(&start) {
                let plane = start.settled(FAR, &compared, nearest);
                if is_new(&plane) {
                    planes.push((plane.mirrored(MIRRORED, &compared, nearest), plane));
                }
            }
        }
        let planes = alike(planes, MOSTLY);
        // A shape of revolution has a family of planes.
        if planes.len() > TURNS as usize / 2 {
            return None;
        }
        // Places depend on how the mesh lies; points of it do not.
        let step = mesh.point_count().div_ceil(POINTS).max(1);
        let points: Vec<Vector> = mesh.positions.iter().step_by(step).copied().collect();
        let settled = planes.into_iter().map(|(_, plane)| plane.settled(FAR, &points, nearest));
        let settled = settled.filter(|plane| plane.mirrored(MIRRORED, &points, nearest) >= MOSTLY);
        let settled = settled.map(|plane| (plane.mirrored(MIRRORED, &compared, nearest), plane));
        let settled = alike(settled.collect(), MOSTLY);
        // Of planes that mirror as much, that one is meant which mirrors more vertices to vertices, or else moves more.
        let vertices = RTree::bulk_load(if settled.len() > 1 { mesh.positions.clone() } else { Vec::new() });
        let meets = |plane: &MirrorPlane| {
            let off = |image: Vector| Some(squared_norm(subtract(image, *vertices.nearest_neighbor(image)?)));
            let is_met = |at: &&Vector| off(plane.image(**at)).is_some_and(|off| off < MEETS * MEETS);
            points.iter().filter(is_met).count() as f64
        };
        let settled = alike(settled.into_iter().map(|(_, plane)| (meets(&plane), plane)).collect(), 0.0);
        let moves = |plane: &MirrorPlane| along(&moments, plane.normal);
        let best =
            settled.into_iter().map(|(_, plane)| plane).max_by(|a, b| moves(a).total_cmp(&moves(b)))?;
        Some((best, best.mirrored(MEETS, &points, nearest) >= MOSTLY))
    }

    /// The plane nearby whose images lie best on the surface, of which `nearest` gives the nearest point and the normal there.
    fn settled(
        mut self,
        mut far: f64,
        places: &[Vector],
        nearest: impl Fn(Vector) -> (Vector, Vector) + Copy,
    ) -> MirrorPlane {
        let pair = |plane: &MirrorPlane, &from: &Vector| {
            let (to, normal) = nearest(plane.image(from));
            Pair { from, to, normal }
        };
        for _ in 0..ROUNDS {
            let pairs: Vec<Pair> = places.iter().map(|place| pair(&self, place)).collect();
            let next = self.through(&pairs, far);
            let moved = next.distance(&self);
            self = next;
            far = MIRRORED.max(SHRINKS * far);
            if moved < RESTS {
                break;
            }
        }
        self
    }

    /// The share of places whose images lie on the surface, `within` a distance, of which `nearest` gives the nearest point.
    fn mirrored(&self, within: f64, places: &[Vector], nearest: impl Fn(Vector) -> (Vector, Vector)) -> f64 {
        let is_mirrored = |place: &&Vector| {
            let image = self.image(**place);
            squared_norm(subtract(image, nearest(image).0)) < within * within
        };
        places.iter().filter(is_mirrored).count() as f64 / places.len() as f64
    }

    /// The mirror image of a place.
    pub fn image(&self, place: Vector) -> Vector {
        let away = 2.0 * (dot(self.normal, place) - self.offset);
        std::array::from_fn(|axis| place[axis] - away * self.normal[axis])
    }

    /// How far images by two planes are from each other, about.
    fn distance(&self, other: &MirrorPlane) -> f64 {
        let same = dot(self.normal, other.normal).signum();
        let apart = subtract(self.normal, other.normal.map(|x| same * x));
        squared_norm(apart).sqrt() + 2.0 * (self.offset - same * other.offset).abs()
    }

    /// The plane nearby whose images lie best on the tangent planes of the surface, but for points that have no image near where it should be.
    fn through(&self, pairs: &[Pair], far: f64) -> MirrorPlane {
        let mut aside = principal_axes(std::array::from_fn(|i| self.normal.map(|x| x * self.normal[i])));
        aside.sort_by(|a, b| dot(*a, self.normal).abs().total_cmp(&dot(*b, self.normal).abs()));
        let [u, v, _] = aside;
        // What turns the plane about two axes, and what shifts it, do to how far an image is off.
        let (mut matrix, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
        for pair in pairs {
            let off = subtract(self.image(pair.from), pair.to);
            // Tukey's biweight.
            let weight = (1.0 - squared_norm(off) / (far * far)).max(0.0).powi(2);
            let along = dot(self.normal, pair.normal);
            let away = dot(self.normal, pair.from) - self.offset;
            let turn = |axis: Vector| -2.0 * (dot(axis, pair.from) * along + away * dot(axis, pair.normal));
            let row = [turn(u), turn(v), 2.0 * along];
            for i in 0..3 {
                (0..3).for_each(|j| matrix[i][j] += weight * row[i] * row[j]);
                right[i] -= weight * row[i] * dot(off, pair.normal);
            }
        }
        let Some([a, b, shift]) = solved(&matrix, right) else { return *self };
        let normal: Vector = std::array::from_fn(|k| self.normal[k] + a * u[k] + b * v[k]);
        let length = squared_norm(normal).sqrt();
        MirrorPlane { normal: normal.map(|x| x / length), offset: (self.offset + shift) / length }
    }
}

/// The planes of at least some worth that are worth nearly as much as the best.
fn alike(mut planes: Vec<(f64, MirrorPlane)>, least: f64) -> Vec<(f64, MirrorPlane)> {
    let most = planes.iter().map(|(worth, _)| *worth).fold(0.0, f64::max);
    planes.retain(|(worth, _)| *worth >= least.max(ALIKE * most));
    planes
}

/// What the moments say of a direction.
fn along(moments: &[[f64; 3]; 3], axis: Vector) -> f64 {
    (0..3).map(|i| axis[i] * dot(moments[i], axis)).sum()
}

/// The sum of `a a^T`.
fn moments(offsets: impl Iterator<Item = Vector>) -> [[f64; 3]; 3] {
    let mut sum = [[0.0; 3]; 3];
    for a in offsets {
        (0..3).for_each(|i| (0..3).for_each(|j| sum[i][j] += a[i] * a[j]));
    }
    sum
}

/// The solution of a symmetric system of three equations, by Cramer's rule; `None` if there is no only one.
fn solved(matrix: &[[f64; 3]; 3], right: Vector) -> Option<Vector> {
    let determinant = |rows: [Vector; 3]| dot(rows[0], cross(rows[1], rows[2]));
    let whole = determinant(*matrix);
    let size = matrix.iter().map(|row| squared_norm(*row)).sum::<f64>().sqrt();
    // The matrix is symmetric: its rows are its columns.
    let with = |k: usize| {
        let mut rows = *matrix;
        rows[k] = right;
        determinant(rows) / whole
    };
    (whole.abs() > 1e-9 * size.powi(3)).then(|| [with(0), with(1), with(2)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::PolygonMesh;

    /// Two wheels on an axle, and a box on it, a little tilted. The sides of a wheel are single faces, cut into a fan from another corner on the left than on the right.
    fn wheels() -> Mesh {
        const CORNERS: u32 = 24;
        let mut polygons = PolygonMesh { face_offsets: vec![0], ..PolygonMesh::default() };
        let mut add = |round: u32, radii: [f64; 2], ends: [f64; 2], middle: [f64; 2], start: u32| {
            let first = polygons.positions.len() as u32;
            for x in ends {
                for corner in 0..round {
                    let angle = (f64::from(corner) + 0.5) * std::f64::consts::TAU / f64::from(round);
                    let [y, z] = [middle[0] + radii[0] * angle.sin(), middle[1] + radii[1] * angle.cos()];
                    polygons.positions.push([x + 0.02 * z + 0.01 * y, y - 0.01 * x, z - 0.02 * x]);
                }
            }
            let at = |end: u32, corner: u32| first + round * end + (corner + start) % round;
            let mut faces: Vec<Vec<u32>> = vec![
                (0..round).rev().map(|corner| at(0, corner)).collect(),
                (0..round).map(|corner| at(1, corner)).collect(),
            ];
            faces.extend((0..round).map(|k| vec![at(0, k), at(0, k + 1), at(1, k + 1), at(1, k)]));
            for face in faces {
                polygons.face_vertices.extend(face);
                polygons.face_offsets.push(polygons.face_vertices.len() as u32);
            }
        };
        add(CORNERS, [1.0, 1.0], [-1.0, -0.9], [0.0, 0.0], 0);
        add(CORNERS, [1.0, 1.0], [0.9, 1.0], [0.0, 0.0], 7);
        add(4, [0.2, 0.2], [-0.9, 0.9], [0.0, 0.0], 0);
        add(4, [0.5, 1.4], [-0.5, 0.5], [0.5, 1.3], 0);
        Mesh::new(&polygons, &Limits::default()).expect("a usable mesh")
    }

    #[test]
    fn large_faces_have_images_far_from_all_corners() {
        let mesh = wheels();
        let (plane, _) = MirrorPlane::of(&mesh, 2).expect("a plane");
        let nearest = |image: Vector| {
            mesh.positions.iter().map(|&at| squared_norm(subtract(at, image))).fold(f64::MAX, f64::min)
        };
        let farthest = mesh.positions.iter().map(|&at| nearest(plane.image(at)).sqrt()).fold(0.0, f64::max);
        assert!(farthest < 2e-3, "{farthest} {plane:?}");
    }

    #[test]
    fn of_planes_that_mirror_all_of_a_box_that_one_is_taken_that_moves_it_most() {
        for sizes in [[3.0, 2.0, 1.0], [1.0, 3.0, 2.0], [2.0, 1.0, 3.0]] {
            let corner = |k: u32| std::array::from_fn(|axis| sizes[axis] * f64::from(k >> axis & 1));
            let polygons = PolygonMesh {
                positions: (0..8).map(corner).collect(),
                face_offsets: (0..=6).map(|face| 4 * face).collect(),
                face_vertices: vec![0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5],
            };
            let mesh = Mesh::new(&polygons, &Limits::default()).expect("a usable mesh");
            let (plane, _) = MirrorPlane::of(&mesh, 2).expect("a plane");
            let longest = sizes.iter().position(|&size| size == 3.0).expect("one");
            assert!(plane.normal[longest].abs() > 0.999, "{sizes:?}: {plane:?}");
        }
    }

    /// A box of which two faces have a point inside, not in the middle: the longest axis' plane mirrors the surface alone.
    #[test]
    fn of_planes_that_mirror_all_of_a_box_that_one_is_meant_that_mirrors_the_vertices() {
        let corner = |k: u32| [0, 1, 2].map(|axis| [3.0, 2.0, 1.0][axis] * f64::from(k >> axis & 1));
        let inside = [0.0, 1.0].map(|z| [0.8, 1.0, z]);
        let mut polygons = PolygonMesh {
            positions: (0..8).map(corner).chain(inside).collect(),
            face_offsets: (0..=4).map(|face| 4 * face).collect(),
            face_vertices: vec![0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5],
        };
        for (point, around) in [(8, [0, 2, 3, 1]), (9, [4, 5, 7, 6])] {
            for (&from, &to) in around.iter().zip(around.iter().cycle().skip(1)) {
                polygons.face_vertices.extend([from, to, point]);
                polygons.face_offsets.push(polygons.face_vertices.len() as u32);
            }
        }
        let mesh = Mesh::new(&polygons, &Limits::default()).expect("a usable mesh");
        let (plane, _) = MirrorPlane::of(&mesh, 2).expect("a plane");
        assert!(plane.normal[1].abs() > 0.999 || plane.normal[2].abs() > 0.999, "{plane:?}");
    }

    #[test]
    fn a_plane_is_turned_about_both_axes_and_shifted_whichever_way_it_lies() {
        for axis in 0..3 {
            let normal: Vector = std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 });
            let mirror = MirrorPlane { normal, offset: 0.1 };
            let pair = |k: i32| {
                let at = |step: f64| (step * f64::from(k)).sin();
                let from = [at(1.0), at(1.7), at(2.3)];
                let looks = [at(3.1), at(4.3), at(5.9)];
                let length = squared_norm(looks).sqrt();
                Pair { from, to: mirror.image(from), normal: looks.map(|x| x / length) }
            };
            let pairs: Vec<Pair> = (1..60).map(pair).collect();
            let tilted: Vector = std::array::from_fn(|k| if k == axis { 1.0 } else { 0.003 });
            let length = squared_norm(tilted).sqrt();
            let mut plane = MirrorPlane { normal: tilted.map(|x| x / length), offset: 0.102 };
            for _ in 0..3 {
                plane = plane.through(&pairs, FAR);
            }
            assert!(plane.distance(&mirror) < 1e-9, "{plane:?}");
        }
    }
}
