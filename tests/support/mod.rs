//! Meshes that the stage and property tests share: made in code, or read from `examples/`.
#![allow(dead_code)] // each test binary uses a part

use intrinsym::{Detection, Limits, Mesh, Options, Outcome, PolygonMesh, Symmetry, io};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub type Vector = [f64; 3];

pub fn polygon_mesh<F: AsRef<[u32]>>(positions: &[Vector], faces: &[F]) -> PolygonMesh {
    let mut mesh =
        PolygonMesh { positions: positions.to_vec(), face_offsets: vec![0], face_vertices: Vec::new() };
    for face in faces {
        mesh.face_vertices.extend_from_slice(face.as_ref());
        mesh.face_offsets.push(mesh.face_vertices.len() as u32);
    }
    mesh
}

pub fn validated(mesh: &PolygonMesh) -> Mesh {
    Mesh::new(mesh, &Limits::default()).expect("a usable mesh")
}

pub fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

pub fn distance(a: Vector, b: Vector) -> f64 {
    let difference = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    dot(difference, difference).sqrt()
}

fn unit(a: Vector) -> Vector {
    a.map(|coordinate| coordinate / dot(a, a).sqrt())
}

/// A unit icosphere: `10 * 4^levels + 2` vertices.
pub fn icosphere(levels: usize) -> PolygonMesh {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points: Vec<Vector> = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        points.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]].map(unit));
    }
    let edge = (0..12).map(|i| distance(points[0], points[i])).filter(|d| *d > 0.1).fold(9.0, f64::min);
    let near = |a: usize, b: usize| a != b && distance(points[a], points[b]) < 1.01 * edge;
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for a in 0..12 {
        for b in (a + 1..12).filter(|&b| near(a, b)) {
            for c in (b + 1..12).filter(|&c| near(a, c) && near(b, c)) {
                triangles.push([a as u32, b as u32, c as u32]);
            }
        }
    }
    for _ in 0..levels {
        triangles = subdivided(&mut points, &triangles);
    }
    polygon_mesh(&points, &triangles)
}

fn subdivided(points: &mut Vec<Vector>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = BTreeMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let (p, q) = (points[a as usize], points[b as usize]);
            points.push(unit([p[0] + q[0], p[1] + q[1], p[2] + q[2]]));
            points.len() as u32 - 1
        })
    };
    let split = |&[a, b, c]: &[u32; 3]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
    };
    triangles.iter().flat_map(split).collect()
}

/// A unit geodesic sphere: each edge of the icosahedron in `frequency` parts, `10 frequency^2 + 2` vertices.
pub fn geodesic_sphere(frequency: u32) -> PolygonMesh {
    let corners = icosphere(0);
    let mut index_of: BTreeMap<[(u32, u32); 3], u32> = BTreeMap::new();
    let mut points: Vec<Vector> = Vec::new();
    let mut triangles = Vec::new();
    for face in corners.face_vertices.chunks_exact(3) {
        let mut at = |i: u32, j: u32| {
            // A point is known by its weights at the icosahedron's corners, wherever it is met.
            let mut key = [(face[0], frequency - i - j), (face[1], i), (face[2], j)];
            key.iter_mut().filter(|(_, weight)| *weight == 0).for_each(|entry| entry.0 = u32::MAX);
            key.sort_unstable();
            *index_of.entry(key).or_insert_with(|| {
                let weighted = |axis: usize, &(corner, weight): &(u32, u32)| {
                    if weight == 0 {
                        0.0
                    } else {
                        f64::from(weight) * corners.positions[corner as usize][axis]
                    }
                };
                points.push(unit([0, 1, 2].map(|axis| key.iter().map(|entry| weighted(axis, entry)).sum())));
                points.len() as u32 - 1
            })
        };
        for i in 0..frequency {
            for j in 0..frequency - i {
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < frequency {
                    triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    polygon_mesh(&points, &triangles)
}

/// Rotation by `angle` (radians) about `axis`.
pub fn rotated(point: Vector, axis: Vector, angle: f64) -> Vector {
    let (axis, (sine, cosine)) = (unit(axis), angle.sin_cos());
    let cross = [0, 1, 2].map(|i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        axis[j] * point[k] - axis[k] * point[j]
    });
    let along = dot(axis, point) * (1.0 - cosine);
    [0, 1, 2].map(|i| point[i] * cosine + cross[i] * sine + axis[i] * along)
}

/// Limbs of [`creature`]: direction (x >= 0; off the middle they come in mirrored pairs), length, width.
const LIMBS: [(Vector, f64, f64); 5] = [
    ([0.0, 0.2, 1.0], 1.3, 18.0),
    ([0.0, -1.0, -0.35], 0.7, 26.0),
    ([1.0, 0.45, 0.25], 1.6, 22.0),
    ([0.75, -0.5, -0.7], 1.0, 24.0),
    ([0.35, 0.9, -0.3], 0.45, 40.0),
];

/// The distance of the creature's surface from the origin: symmetric in x and in nothing else.
fn creature_radius(direction: Vector) -> f64 {
    let bump = |limb: Vector, length: f64, width: f64| length * (width * (dot(direction, limb) - 1.0)).exp();
    let both = |&(limb, length, width): &(Vector, f64, f64)| {
        let limb = unit(limb);
        let mirrored = [-limb[0], limb[1], limb[2]];
        bump(limb, length, width) + if limb[0] > 0.0 { bump(mirrored, length, width) } else { 0.0 }
    };
    1.0 + LIMBS.iter().map(both).sum::<f64>()
}

/// A lump with limbs, symmetric in x. With `turn` 0 its mesh is mirrored too; with another angle
/// (radians) only its surface is, and left and right share no connectivity.
pub fn creature(levels: usize, turn: f64) -> PolygonMesh {
    creature_from(icosphere(levels), turn)
}

/// [`creature`] with the connectivity of any sphere.
pub fn creature_from(sphere: PolygonMesh, turn: f64) -> PolygonMesh {
    let mut mesh = sphere;
    for position in &mut mesh.positions {
        let direction = rotated(*position, [1.0, 2.0, 3.0], turn);
        let radius = creature_radius(direction);
        *position = direction.map(|coordinate| coordinate * radius);
    }
    mesh
}

/// A creature for benchmarks, of `10 frequency^2 + 2` vertices: none has its mirror image among them, and no plane mirrors it, as it is twisted.
pub fn twisted_creature(frequency: u32) -> PolygonMesh {
    let mut mesh = creature_from(geodesic_sphere(frequency), 0.4);
    mesh.positions.iter_mut().for_each(|at| *at = rotated(*at, [0.0, 1.0, 0.0], 0.1 * at[1]));
    mesh
}

/// The vertex nearest to the mirror image of each vertex of [`creature`].
pub fn creature_truth(mesh: &PolygonMesh) -> Vec<u32> {
    let nearest = |&[x, y, z]: &Vector| {
        let image = [-x, y, z];
        let away = |i: &usize| distance(mesh.positions[*i], image);
        (0..mesh.positions.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap() as u32
    };
    mesh.positions.iter().map(nearest).collect()
}

/// A flat grid of `columns * rows` squares of the given size, each cut into two triangles.
pub fn rectangle(columns: usize, rows: usize, [width, height]: [f64; 2]) -> PolygonMesh {
    let at = |i: usize, count: usize, length: f64| length * i as f64 / count as f64;
    let positions: Vec<Vector> = (0..=rows)
        .flat_map(|j| (0..=columns).map(move |i| [at(i, columns, width), at(j, rows, height), 0.0]))
        .collect();
    let index = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    let squares = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let cut = |(i, j): (usize, usize)| {
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    };
    polygon_mesh(&positions, &squares.flat_map(cut).collect::<Vec<_>>())
}

/// The surface of the cube from -1 to 1, each side in `count` times `count` squares.
pub fn cube_of_squares(count: usize) -> PolygonMesh {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    let mut index_of = BTreeMap::new();
    for side in 0..6 {
        let (axis, high) = (side / 2, side % 2 == 1);
        let mut corner = |i: usize, j: usize| {
            let mut place = [0; 3];
            place[axis] = if high { count } else { 0 };
            (place[(axis + 1) % 3], place[(axis + 2) % 3]) = (i, j);
            *index_of.entry(place).or_insert_with(|| {
                positions.push(place.map(|value| 2.0 * value as f64 / count as f64 - 1.0));
                positions.len() as u32 - 1
            })
        };
        for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
            let mut face = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            if !high {
                face.reverse();
            }
            faces.push(face);
        }
    }
    polygon_mesh(&positions, &faces)
}

fn example_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name)
}

/// A mesh of `examples/`, as its file gives it.
pub fn example(name: &str) -> PolygonMesh {
    io::read(&example_path(&format!("{name}.ply")), &Limits::default()).unwrap().polygons
}

/// Its table of true partners.
pub fn example_truth(name: &str) -> Vec<u32> {
    let table = std::fs::read_to_string(example_path(&format!("{name}.mirror"))).unwrap();
    table.lines().map(|line| line.parse().unwrap()).collect()
}

/// `mesh` with a diagonal cut at random in every quad: no connectivity is mirrored any more.
pub fn with_random_diagonals(mesh: &PolygonMesh) -> PolygonMesh {
    let mut state = 1u32;
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for face in mesh.face_offsets.windows(2) {
        let corners = &mesh.face_vertices[face[0] as usize..face[1] as usize];
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let first = (state >> 31) as usize;
        let corner = |k: usize| corners[(first + k) % corners.len()];
        triangles.extend((1..corners.len() - 1).map(|k| [corner(0), corner(k), corner(k + 1)]));
    }
    polygon_mesh(&mesh.positions, &triangles)
}

/// A triangle mesh, of whose edges one of `every` is flipped where the triangles do not turn over and the new edge is not there.
pub fn with_flipped_edges(mesh: &PolygonMesh, every: usize) -> PolygonMesh {
    let mut triangles: Vec<[u32; 3]> = mesh.face_vertices.chunks(3).map(|t| [t[0], t[1], t[2]]).collect();
    let sides = |[a, b, c]: [u32; 3]| [(a, b, c), (b, c, a), (c, a, b)];
    let at = |vertex: u32| mesh.positions[vertex as usize];
    let normal = |a: u32, b: u32, c: u32| {
        let [u, v] = [b, c].map(|end| [0, 1, 2].map(|axis| at(end)[axis] - at(a)[axis]));
        [0, 1, 2]
            .map(|axis: usize| u[(axis + 1) % 3] * v[(axis + 2) % 3] - u[(axis + 2) % 3] * v[(axis + 1) % 3])
    };
    let mut beside: BTreeMap<(u32, u32), (usize, u32)> = BTreeMap::new();
    for (index, &triangle) in triangles.iter().enumerate() {
        beside.extend(sides(triangle).map(|(a, b, c)| ((a, b), (index, c))));
    }
    let mut inner: Vec<(u32, u32)> = beside.keys().copied().filter(|&(a, b)| a < b).collect();
    inner.sort_unstable_by_key(|&(a, b)| (a.wrapping_mul(747_796_405) ^ b.wrapping_mul(2_891_336_453), a, b));
    let mut left = inner.len() / every;
    for (a, b) in inner {
        let (Some(&(first, c)), Some(&(second, d))) = (beside.get(&(a, b)), beside.get(&(b, a))) else {
            continue;
        };
        let old = [normal(a, b, c), normal(b, a, d)];
        let new = [normal(a, d, c), normal(b, c, d)];
        let turns_over = old.iter().any(|&old| new.iter().any(|&new| dot(old, new) <= 0.0));
        if left == 0 || turns_over || beside.contains_key(&(c, d)) || beside.contains_key(&(d, c)) {
            continue;
        }
        (triangles[first], triangles[second]) = ([a, d, c], [b, c, d]);
        beside.remove(&(a, b));
        beside.remove(&(b, a));
        for index in [first, second] {
            beside.extend(sides(triangles[index]).map(|(a, b, c)| ((a, b), (index, c))));
        }
        left -= 1;
    }
    assert_eq!(left, 0, "so many edges cannot be flipped");
    polygon_mesh(&mesh.positions, &triangles)
}

/// Mean and share beyond 0.05 of the distances to the true partners, in sqrt(area).
pub fn errors(mesh: &PolygonMesh, partner: &[i32], truth: &[u32]) -> (f64, f64) {
    let roads = Roads::new(mesh);
    let pairs = partner.iter().zip(truth).map(|(&partner, &truth)| (partner as u32, truth));
    let distances: Vec<f64> = pairs.map(|(a, b)| roads.distance(a, b)).collect();
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    let far = distances.iter().filter(|distance| **distance > 0.05).count() as f64 / distances.len() as f64;
    println!("  mean error {mean:.4} sqrt(area), {far:.4} beyond 0.05");
    (mean, far)
}

/// Distances along edges, for points that lie near each other.
pub struct Roads {
    neighbours: Vec<Vec<(u32, f64)>>,
}

impl Roads {
    /// Lengths in sqrt(area).
    pub fn new(polygons: &PolygonMesh) -> Roads {
        let mesh = validated(polygons);
        let mut neighbours = vec![Vec::new(); polygons.positions.len()];
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|point| mesh.vertex_of_point[point as usize]);
            for (a, b) in [(a, b), (b, c), (c, a), (b, a), (c, b), (a, c)] {
                let length = distance(polygons.positions[a as usize], polygons.positions[b as usize]);
                neighbours[a as usize].push((b, length / mesh.unit_length));
            }
        }
        Roads { neighbours }
    }

    /// The shortest way along edges by Dijkstra's algorithm, at most 1.
    pub fn distance(&self, from: u32, to: u32) -> f64 {
        let mut reached = BTreeMap::from([(from, 0.0)]);
        let mut queue = std::collections::BTreeSet::from([(0u64, from)]);
        // Distances are not negative, so their bits are ordered as they are.
        while let Some((bits, vertex)) = queue.pop_first() {
            let here = f64::from_bits(bits);
            if vertex == to || here > 1.0 {
                return here.min(1.0);
            }
            for &(next, length) in &self.neighbours[vertex as usize] {
                let there = here + length;
                if reached.get(&next).is_none_or(|known| there < *known) {
                    reached.insert(next, there);
                    queue.insert((there.to_bits(), next));
                }
            }
        }
        1.0
    }
}

/// Whether vertices go hardly farther than through a thin sheet.
fn exchanges_sheets(mesh: &Mesh, symmetry: &Symmetry) -> bool {
    let places = || mesh.vertex_of_point.iter().zip(&mesh.positions);
    let partner = |vertex: u32| usize::try_from(symmetry.partner[vertex as usize]).ok();
    let image = |vertex: u32| partner(vertex).map(|partner| mesh.point_of_vertex[partner] as usize);
    let moved = places()
        .filter_map(|(&vertex, place)| Some(distance(*place, mesh.positions[image(vertex)?]).powi(2)));
    (moved.sum::<f64>() / places().count() as f64).sqrt() < 0.06
}

/// What the documentation of [`Detection`] and [`Symmetry`] promises.
pub fn assert_keeps_its_contract(mesh: &Mesh, options: &Options, found: &Detection) {
    assert_eq!(found.outcome == Outcome::None, found.symmetries.is_empty());
    assert!(found.symmetries.len() <= options.symmetries);
    let rank = |symmetry: &Symmetry| {
        let plausibility = symmetry.plausibility;
        (symmetry.kind, if exchanges_sheets(mesh, symmetry) { -plausibility.min(0.5) } else { -plausibility })
    };
    assert!(
        found.symmetries.iter().map(rank).is_sorted(),
        "reflections, half turns, the most plausible first, exchanges of sheets behind"
    );
    assert!(found.report.eigenvalues.is_sorted() && !found.report.evidence().is_empty());
    assert_eq!((found.report.vertices, found.report.faces), (mesh.point_of_vertex.len(), mesh.face_count));
    for symmetry in &found.symmetries {
        for vertex in 0..mesh.point_of_vertex.len() {
            assert_vertex_keeps_its_contract(mesh, symmetry, vertex);
        }
        assert!((0.0..=1.0).contains(&symmetry.mean_confidence) && symmetry.score.is_finite());
        assert!((0.0..=1.0).contains(&symmetry.exact_share));
        for point in symmetry.fixed_curve.iter().flat_map(|curve| &curve.points) {
            assert!((0.0..=1.0).contains(&point.t), "{point:?}");
        }
    }
}

fn assert_vertex_keeps_its_contract(mesh: &Mesh, symmetry: &Symmetry, vertex: usize) {
    let partner = symmetry.partner[vertex];
    assert!((-1..mesh.point_of_vertex.len() as i32).contains(&partner));
    assert!((0.0..=1.0).contains(&symmetry.confidence[vertex]), "{}", symmetry.confidence[vertex]);
    assert!((-1..=1).contains(&symmetry.side[vertex]));
    let Some(point) = symmetry.surface_point[vertex] else {
        assert_eq!((partner, symmetry.side[vertex]), (-1, 0));
        return;
    };
    assert!(partner >= 0 && (point.face as usize) < mesh.face_count);
    assert!(point.barycentric.iter().all(|weight| (0.0..=1.0).contains(weight)), "{point:?}");
    assert!((point.barycentric.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{point:?}");
}
