//! What stages must at least do on the counted mesh: floating-point operations and bytes.
//!
//! Products of matrices, solves and distances are counted from the sizes of the data and the steps of the algorithms
//! (a product and a sum are two operations); what is left out is said beside each count. Bytes are those of the arrays
//! that a stage reads and writes, each once. Some numbers depend on the mesh in ways no formula says: steps of conjugate
//! gradients, the candidates' searches, the distances that an image takes. They were counted once, in November 2026, by
//! counters put into the code for that; `WIDTH` to `COARSE` below follow `src` and are to be changed with it.

use intrinsym::internals::detect::shell_symmetry::PreparedShell;
use intrinsym::internals::geometry::vertex_map::VertexMap;
use intrinsym::internals::spectral::laplacian::SymmetricSparse;
use intrinsym::internals::spectral::sparse_cholesky::Analysis;
use intrinsym::{Mesh, PolygonMesh};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Right-hand sides of the eigenbasis: pairs that are carried along, those wanted, panels of which one is solved once and all four times.
const WIDTH: usize = 192;
const WANTED: usize = 151;
const PANEL: usize = 16;
const SOLVES: usize = 4;
/// Conjugate-gradient steps of both mean curvatures, as counted.
const GRADIENT_STEPS: usize = 97;
/// Operations of the candidates, as counted: 410 searches for nearest neighbours among 500 samples (single precision),
/// 52 million steps of the beam search of four each (single), products of 404 estimates (double).
const CANDIDATES: (f64, f64) = (3.14e9 + 4.0 * 52.3e6, 0.141e9);
/// Numbers of rows that distances and triangles take for each number of a row whose image is sought, as counted (while
/// maps grew on 3,859 points in all ways): 177 and 31.5 million for 18.1 million, or 10.2 distances and 1.9 triangles for
/// each of 202,018 images.
const DISTANCES: f64 = 9.8;
const TRIANGLES: f64 = 1.75;
/// Operations for each number of a row: difference, square, sum; three differences and six products for a triangle.
const PER_DISTANCE: f64 = 3.0;
const PER_TRIANGLE: f64 = 15.0;
/// Points on which maps are refined (4,000 asked for), those of the ways in which they grow, these ways, the size to which,
/// and the step after.
const POINTS: usize = 3_859;
const WAY_POINTS: usize = 2_000;
const WAYS: [(usize, usize); 4] = [(20, 5), (10, 10), (15, 10), (25, 10)];
const MIDDLE: usize = 80;
const LAST_STEP: usize = 10;
const COARSE: usize = 50;

/// One stage's work.
struct Floor {
    stage: &'static str,
    counted: &'static str,
    double: f64,
    single: f64,
    bytes: f64,
    /// What `copy` the bytes are held against: `memory` or `cache`.
    from: &'static str,
}

pub struct Floors(Vec<Floor>);

fn bytes<T>(values: &[T]) -> f64 {
    size_of_val(values) as f64
}

fn bytes_of_matrix(matrix: &SymmetricSparse) -> f64 {
    bytes(&matrix.row_offsets) + bytes(&matrix.columns) + bytes(&matrix.values)
}

impl Floors {
    pub fn of(polygons: &PolygonMesh, mesh: &Mesh, shell: &PreparedShell, images: &VertexMap) -> Floors {
        let (surface, size) = (&shell.surface, shell.surface.vertex_count() as f64);
        let count = shell.basis.count();
        let functions = 8.0 * size * count as f64;
        let given =
            bytes(&polygons.positions) + bytes(&polygons.face_offsets) + bytes(&polygons.face_vertices);
        let corners = bytes(&mesh.polygon_offsets) + bytes(&mesh.polygon_points);
        let triangles = bytes(&mesh.triangles);
        let kept =
            bytes(&mesh.positions) + triangles + corners + 8.0 * surface.triangles.len() as f64 + 12.0 * size;
        let stiffness = bytes_of_matrix(&surface.stiffness);
        let images = bytes(&images.partners) + bytes(&images.points);
        let moved =
            |stage, counted, bytes| Floor { stage, counted, double: 0.0, single: 0.0, bytes, from: "memory" };
        Floors(vec![
            moved("mesh", "polygons read, mesh written", given + kept),
            // Four numbers of four bytes for each half-edge, two for each vertex.
            moved(
                "half-edges",
                "polygons read, arrays written",
                corners + 4.0 * bytes(&mesh.polygon_points) * 2.0 + 8.0 * size,
            ),
            Floor {
                stage: "Laplacian",
                counted: "each step of conjugate gradients reads the matrix and moves ten vectors",
                double: GRADIENT_STEPS as f64 * (2.0 * surface.stiffness.values.len() as f64 + 12.0 * size),
                single: 0.0,
                bytes: GRADIENT_STEPS as f64 * (stiffness + 80.0 * size),
                from: "cache",
            },
            eigenfunctions(surface.stiffness.clone(), size),
            moved("match target", "eigenfunctions read, rows in single precision written", 1.5 * functions),
            Floor {
                stage: "candidates",
                counted: "nearest samples, beam search, estimates; no decompositions",
                double: CANDIDATES.1,
                single: CANDIDATES.0,
                bytes: 0.0,
                from: "memory",
            },
            refinement(size, count),
            Floor {
                stage: "verdict",
                counted: "signatures at twelve times",
                double: 25.0 * size * count as f64,
                single: 0.0,
                bytes: functions,
                from: "memory",
            },
            moved("sides", "eigenfunctions read twice, at vertices and images", 2.0 * functions + images),
        ])
    }

    /// Beside criterion's own files.
    pub fn write(&self) {
        let folder = std::env::var_os("CRITERION_HOME").map_or("target/criterion".into(), PathBuf::from);
        let entry = |floor: &Floor| -> Value {
            json!({
                "stage": floor.stage, "counted": floor.counted, "double": floor.double,
                "single": floor.single, "bytes": floor.bytes, "from": floor.from,
            })
        };
        let floors: Vec<Value> = self.0.iter().map(entry).collect();
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join("floors.json"), Value::from(floors).to_string()).expect("floors written");
    }
}

/// Solves with the factor (two operations an entry and right-hand side each way), its making, and the two symmetric
/// products and the last one of Rayleigh and Ritz. Left out: the coarse start, the order of elimination, the dense problem.
fn eigenfunctions(stiffness: SymmetricSparse, size: f64) -> Floor {
    let analysis = Analysis::new(&stiffness).expect("an analysis");
    let (entries, squares) = analysis.column_counts().fold((0.0, 0.0), |(entries, squares), count| {
        (entries + count as f64, squares + (count * count) as f64)
    });
    let right_hand_sides = (PANEL + SOLVES * WIDTH) as f64;
    let ritz = 2.0 * size * (WIDTH * (WIDTH + WANTED)) as f64;
    // The factor is read twice for each panel, which is read and written twice with it.
    let of_panel = 2.0 * 8.0 * entries + 4.0 * 8.0 * PANEL as f64 * size;
    Floor {
        stage: "eigenfunctions",
        counted: "factorisation, 784 solves, Rayleigh-Ritz products; no coarse start",
        double: 4.0 * entries * right_hand_sides + squares + ritz,
        single: 0.0,
        bytes: right_hand_sides / PANEL as f64 * of_panel,
        from: "cache",
    }
}

/// Products of estimates and of mapped rows, distances of points and to triangles. Left out: decompositions, the polish on
/// samples.
fn refinement(size: f64, count: usize) -> Floor {
    let (points, few) = (POINTS as f64, WAY_POINTS as f64);
    // Sizes of the maps whose estimates are made, and of those under which images are sought, each with its points.
    let mut estimates = vec![(points, COARSE), (size, count)];
    let mut mapped = vec![(points, COARSE), (points, COARSE), (size, count), (size, count)];
    let to_middle = WAYS.map(|(first, step)| (few, first, step, MIDDLE));
    let last = (points, MIDDLE + LAST_STEP, LAST_STEP, count);
    for (points, first, step, last) in to_middle.into_iter().chain([last]) {
        let sizes = (first..last).step_by(step).chain([last]);
        estimates.extend(sizes.clone().map(|size| (points, size)));
        mapped.extend([first].into_iter().chain(sizes).map(|size| (points, size)));
    }
    let products = |steps: &[(f64, usize)]| -> f64 {
        steps.iter().map(|(points, size)| 2.0 * points * (size * size) as f64).sum()
    };
    // Two columns of mean curvature.
    let rows: f64 = mapped.iter().map(|(points, size)| points * (size + 2) as f64).sum();
    let searched = rows * (DISTANCES * PER_DISTANCE + TRIANGLES * PER_TRIANGLE);
    Floor {
        stage: "refinement",
        counted: "estimates, mapped rows, 10 distances and 2 triangles an image; no decompositions",
        double: 0.0,
        single: products(&estimates) + products(&mapped) + searched,
        bytes: 0.0,
        from: "memory",
    }
}
