//! Meshes that cost more than others of their size where work grows with the degree of a vertex, with the number of parts, or with
//! what lies behind what. Each has about as many vertices as it is asked for. Shared by tests and by the fuzz target of the detector.

use intrinsym::PolygonMesh;
use std::f64::consts::TAU;

type Vector = [f64; 3];

/// Numbers in 0..1 that look random: the same ones for the same seed.
pub struct Numbers(pub u64);

impl Numbers {
    /// The next one (D. E. Knuth's linear congruential generator MMIX).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn place(&mut self) -> Vector {
        [self.next(), self.next(), self.next()]
    }
}

/// Faces with the corners that are listed.
pub fn mesh<F: AsRef<[u32]>>(positions: Vec<Vector>, faces: impl IntoIterator<Item = F>) -> PolygonMesh {
    let mut mesh = PolygonMesh { positions, face_offsets: vec![0], face_vertices: Vec::new() };
    for face in faces {
        mesh.face_vertices.extend_from_slice(face.as_ref());
        mesh.face_offsets.push(mesh.face_vertices.len() as u32);
    }
    mesh
}

fn ring(count: u32) -> impl Iterator<Item = Vector> {
    let angle = move |i: u32| TAU * f64::from(i) / f64::from(count);
    (0..count).map(move |i| [angle(i).cos(), angle(i).sin(), 0.1 * (3.0 * angle(i)).sin()])
}

/// A disc: all triangles meet in its middle.
pub fn hub(vertices: usize) -> PolygonMesh {
    let count = (vertices as u32).saturating_sub(1).max(3);
    let positions = std::iter::once([0.0; 3]).chain(ring(count)).collect();
    mesh(positions, (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]))
}

/// Two hubs that share a rim.
pub fn two_hubs(vertices: usize) -> PolygonMesh {
    let count = (vertices as u32).saturating_sub(2).max(3);
    let positions = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.2]].into_iter().chain(ring(count)).collect();
    let sides = |i: u32| [[0, 2 + i, 2 + (i + 1) % count], [1, 2 + (i + 1) % count, 2 + i]];
    mesh(positions, (0..count).flat_map(sides))
}

/// Triangles on one edge.
pub fn fan(vertices: usize) -> PolygonMesh {
    let count = (vertices as u32).saturating_sub(2).max(1);
    let mut numbers = Numbers(1);
    let tips = ring(count).map(|[x, y, _]| [x * (1.0 + 0.3 * numbers.next()), y, numbers.next()]);
    let positions = [[0.0; 3], [0.0, 0.0, 1.0]].into_iter().chain(tips).collect();
    mesh(positions, (0..count).map(|i| [0, 1, 2 + i]))
}

/// Cones that meet in their tips.
pub fn flower(vertices: usize) -> PolygonMesh {
    const RIM: u32 = 19;
    let petals = (vertices as u32).div_ceil(RIM).max(1);
    let (mut positions, mut faces) = (vec![[0.0; 3]], Vec::new());
    for petal in 0..petals {
        let height = 1.0 - 2.0 * (f64::from(petal) + 0.5) / f64::from(petals);
        let (sine, cosine) = (2.399_963 * f64::from(petal)).sin_cos();
        let across = (1.0 - height * height).sqrt();
        let (along, first) = ([across * cosine, across * sine, height], positions.len() as u32);
        let (u, v) = ([-sine, cosine, 0.0], [-height * cosine, -height * sine, across]);
        let half = 0.5 / f64::from(petals).sqrt();
        let at = |[x, y, _]: Vector| std::array::from_fn(|k| along[k] + half * (x * u[k] + y * v[k]));
        positions.extend(ring(RIM).map(at));
        faces.extend((0..RIM).map(|i| [0, first + i, first + (i + 1) % RIM]));
    }
    mesh(positions, faces)
}

/// One polygon in the form of a comb.
pub fn comb(vertices: usize) -> PolygonMesh {
    let teeth = (vertices / 4).max(1);
    let tooth = |i: usize| {
        let (x, width) = (i as f64 / teeth as f64, 0.5 / teeth as f64);
        [[x, 0.0, 0.0], [x, 1.0, 0.0], [x + width, 1.0, 0.0], [x + width, 0.0, 0.0]]
    };
    let back = [[1.0, -0.2, 0.0], [0.0, -0.2, 0.0]];
    let positions: Vec<Vector> = (0..teeth).flat_map(tooth).chain(back).collect();
    let corners: Vec<u32> = (0..positions.len() as u32).rev().collect();
    mesh(positions, [corners])
}

/// A strip of triangles ten thousand times as long as wide.
pub fn slivers(vertices: usize) -> PolygonMesh {
    let count = (vertices as u32 / 2).max(2);
    let pair = |i: u32| {
        let x = 1e-4 * f64::from(i);
        [[x, 0.0, 0.0], [x, 1.0, 0.1 * (100.0 * x).sin()]]
    };
    let triangles = |i: u32| [[2 * i, 2 * i + 2, 2 * i + 1], [2 * i + 1, 2 * i + 2, 2 * i + 3]];
    mesh((0..count).flat_map(pair).collect(), (0..count - 1).flat_map(triangles))
}

/// Loose triangles at random.
pub fn soup(vertices: usize) -> PolygonMesh {
    let (count, mut numbers) = ((vertices as u32 / 3).max(1), Numbers(2));
    let mut positions = Vec::new();
    for _ in 0..count {
        let middle = numbers.place();
        positions.extend([(); 3].map(|()| {
            let offset = numbers.place();
            [0, 1, 2].map(|k| middle[k] + 0.03 * offset[k])
        }));
    }
    mesh(positions, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]))
}

/// Triangles between vertices at random.
pub fn tangle(vertices: usize) -> PolygonMesh {
    let (count, mut numbers) = (vertices.max(3), Numbers(3));
    let positions = (0..count).map(|_| numbers.place()).collect();
    let mut step = || 1 + (numbers.next() * ((count - 1) / 2) as f64) as usize;
    // Two steps do not lead round to the first corner.
    let triangle = |first: usize| {
        let second = first + step();
        [first, second, second + step()].map(|corner| (corner % count) as u32)
    };
    let triangles: Vec<[u32; 3]> = (0..count).map(triangle).collect();
    mesh(positions, triangles)
}

/// Loose tetrahedra, each of another shape.
pub fn tetrahedra(vertices: usize) -> PolygonMesh {
    let (count, mut numbers) = ((vertices as u32 / 4).max(1), Numbers(4));
    let side = f64::from(count).cbrt().ceil();
    let mut positions = Vec::new();
    for i in 0..count {
        let i = f64::from(i);
        let middle = [i % side, (i / side).floor() % side, (i / side / side).floor()];
        positions.extend([(); 4].map(|()| {
            let offset = numbers.place();
            [0, 1, 2].map(|k| middle[k] + 0.5 * offset[k])
        }));
    }
    let sides = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    mesh(positions, (0..count).flat_map(|i| sides.map(|face| face.map(|corner| 4 * i + corner))))
}

/// Loose quads behind each other, each a little larger than the one before.
pub fn nested_quads(vertices: usize) -> PolygonMesh {
    let count = (vertices as u32 / 4).max(1);
    let quad = |i: u32| {
        let (half, height) = (1.0 + 0.001 * f64::from(i), 5e-5 * f64::from(i));
        [[-half, -half, height], [half, -half, height], [half, half, height], [-half, half, height]]
    };
    mesh((0..count).flat_map(quad).collect(), (0..count).map(|i| [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3]))
}

/// Makes a mesh of about so many vertices.
pub type Maker = fn(usize) -> PolygonMesh;

/// All of them, by name.
pub const SHAPES: [(&str, Maker); 11] = [
    ("hub", hub),
    ("two_hubs", two_hubs),
    ("fan", fan),
    ("flower", flower),
    ("comb", comb),
    ("slivers", slivers),
    ("soup", soup),
    ("tangle", tangle),
    ("tetrahedra", tetrahedra),
    ("nested_quads", nested_quads),
    ("loose_quads", loose_quads),
];

/// Loose squares of slightly different sizes beside each other.
pub fn loose_quads(vertices: usize) -> PolygonMesh {
    let (count, mut numbers) = ((vertices as u32 / 4).max(1), Numbers(5));
    let columns = f64::from(count).sqrt().ceil();
    let mut positions = Vec::new();
    for i in 0..count {
        let (x, y) = (f64::from(i) % columns, (f64::from(i) / columns).floor());
        let (width, height) = (0.5 + 0.4 * numbers.next(), 0.5 + 0.4 * numbers.next());
        positions.extend([
            [x, y, 0.0],
            [x + width, y, 0.0],
            [x + width, y + height, 0.0],
            [x, y + height, 0.0],
        ]);
    }
    mesh(positions, (0..count).map(|i| [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3]))
}
