//! Where to look from: upright, and so that both sides of the symmetry are seen.

use intrinsym::internals::mesh::vector::{Vector, cross, dot, point_areas, subtract};
use intrinsym::{Mesh, NONE, Symmetry};

/// The direction that points up in the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Up {
    /// Chosen among +x, +y and +z: the one on which the shape stands best.
    #[default]
    Auto,
    /// A coordinate axis (0: x, 1: y, 2: z), upwards or reversed.
    Axis {
        /// 0: x, 1: y, 2: z.
        axis: usize,
        /// Whether the negative direction points up.
        reversed: bool,
    },
}

/// Height of the eye above the horizon, in degrees.
const ELEVATION: f64 = 12.0;
/// How far the eye is turned from the front of a long shape at most, in degrees.
const LARGEST_TURN: f64 = 55.0;
/// Share of the height within which points count as touching the ground.
const GROUND: f64 = 0.05;

/// An orthographic view: orthonormal directions in the mesh's coordinates.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// To the right in the picture.
    pub right: Vector,
    /// Upwards in the picture.
    pub up: Vector,
    /// Towards the eye.
    pub toward: Vector,
}

impl View {
    /// Two views from opposite sides, both slightly from above.
    pub fn front_and_back(mesh: &Mesh, symmetry: &Symmetry, up: Up) -> [View; 2] {
        let across = mean_direction_across(mesh, symmetry);
        let up = upright(mesh, across, up);
        let side = horizontal(across, up);
        let front = cross(up, side);
        let turn = f64::atan2(extent(mesh, front), extent(mesh, side)).to_degrees() * 0.75;
        let turn = turn.min(LARGEST_TURN);
        [turn, turn + 180.0].map(|degrees| View::orbit(side, front, up, degrees))
    }

    /// The eye at `degrees` from `front` towards `side`, raised above the horizon.
    fn orbit(side: Vector, front: Vector, up: Vector, degrees: f64) -> View {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let level = combine(cos, front, sin, side);
        let (high, wide) = ELEVATION.to_radians().sin_cos();
        let toward = combine(wide, level, high, up);
        let up = combine(wide, up, -high, level);
        View { right: cross(up, toward), up, toward }
    }

    /// Right, up and towards the eye, of a position or direction.
    pub fn project(&self, position: Vector) -> Vector {
        [dot(self.right, position), dot(self.up, position), dot(self.toward, position)]
    }
}

/// The direction in which partners mostly lie apart: the principal axis of the directions to the partner,
/// each weighted by its vertex's area, whatever the distance (an outstretched arm counts no more than a rib).
fn mean_direction_across(mesh: &Mesh, symmetry: &Symmetry) -> Vector {
    let mut moment = [[0.0; 3]; 3];
    for (point, area) in point_areas(&mesh.positions, &mesh.triangles).into_iter().enumerate() {
        let Ok(partner) = usize::try_from(symmetry.partner[mesh.vertex_of_point[point] as usize]) else {
            continue;
        };
        let image = mesh.point_of_vertex[partner];
        if image == NONE {
            continue;
        }
        let apart = subtract(mesh.positions[point], mesh.positions[image as usize]);
        let Some(unit) = normalised(apart) else { continue };
        for i in 0..3 {
            moment[i] = combine(1.0, moment[i], area * unit[i], unit);
        }
    }
    principal_axis(&moment).unwrap_or([1.0, 0.0, 0.0])
}

/// The eigenvector of the largest eigenvalue, by power iteration; `None` for the zero matrix.
fn principal_axis(moment: &[Vector; 3]) -> Option<Vector> {
    let mut axis = [0.9, 0.3, 0.2];
    for _ in 0..100 {
        axis = normalised(std::array::from_fn(|i| dot(moment[i], axis)))?;
    }
    Some(axis)
}

/// The unit vector that points up.
fn upright(mesh: &Mesh, across: Vector, up: Up) -> Vector {
    let unit = |axis: usize, sign: f64| std::array::from_fn(|k| if k == axis { sign } else { 0.0 });
    if let Up::Axis { axis, reversed } = up {
        return unit(axis.min(2), if reversed { -1.0 } else { 1.0 });
    }
    let most_across = (0..3).max_by(|&i, &j| across[i].abs().total_cmp(&across[j].abs()));
    let standing = (0..3).filter(|&axis| Some(axis) != most_across);
    let best = standing.max_by(|&i, &j| stance(mesh, i).total_cmp(&stance(mesh, j)));
    unit(best.unwrap_or(2), 1.0)
}

/// How well the shape stands along a coordinate axis: tall, with feet spread over much of its outline.
/// Programs have y or z up; x must stand twice as well to be believed.
fn stance(mesh: &Mesh, axis: usize) -> f64 {
    let [mut low, mut high] = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for position in &mesh.positions {
        low = std::array::from_fn(|k| low[k].min(position[k]));
        high = std::array::from_fn(|k| high[k].max(position[k]));
    }
    let height = high[axis] - low[axis];
    let [mut first, mut last] = [high, low];
    for position in mesh.positions.iter().filter(|position| position[axis] < low[axis] + GROUND * height) {
        first = std::array::from_fn(|k| first[k].min(position[k]));
        last = std::array::from_fn(|k| last[k].max(position[k]));
    }
    let others = [(axis + 1) % 3, (axis + 2) % 3];
    let share = |k: usize| (last[k] - first[k]) / (high[k] - low[k]).max(f64::MIN_POSITIVE);
    let believed = if axis == 0 { 0.5 } else { 1.0 };
    believed * height * (0.3 + (share(others[0]) * share(others[1])).max(0.0).sqrt())
}

/// `across` without its part along `up`, or any horizontal direction if nothing is left.
fn horizontal(across: Vector, up: Vector) -> Vector {
    let level = |vector: Vector| normalised(combine(1.0, vector, -dot(vector, up), up));
    if dot(across, up).abs() < 0.95
        && let Some(side) = level(across)
    {
        return side;
    }
    level([1.0, 0.0, 0.0]).filter(|side| side[0] > 0.5).or(level([0.0, 1.0, 0.0])).unwrap_or([1.0, 0.0, 0.0])
}

fn extent(mesh: &Mesh, direction: Vector) -> f64 {
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
    for &position in &mesh.positions {
        let along = dot(position, direction);
        (low, high) = (low.min(along), high.max(along));
    }
    high - low
}

/// `s a + t b`.
fn combine(s: f64, a: Vector, t: f64, b: Vector) -> Vector {
    std::array::from_fn(|k| s * a[k] + t * b[k])
}

fn normalised(vector: Vector) -> Option<Vector> {
    let length = dot(vector, vector).sqrt();
    (length > f64::MIN_POSITIVE).then(|| vector.map(|value| value / length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use intrinsym::{Limits, PolygonMesh};

    #[test]
    fn an_orbit_is_a_right_handed_frame_with_the_eye_above() {
        for degrees in [0.0, 40.0, 180.0] {
            let view = View::orbit([1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], degrees);
            for (a, b) in [(view.right, view.up), (view.up, view.toward), (view.toward, view.right)] {
                assert!(dot(a, b).abs() < 1e-12);
            }
            let [_, _, toward] = view.project(cross(view.right, view.up));
            assert!((toward - 1.0).abs() < 1e-12);
            assert!(view.up[2] > 0.9 && view.toward[2] > 0.1);
        }
    }

    #[test]
    fn a_direction_across_that_points_up_still_gives_a_horizontal_side() {
        for up in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let side = horizontal(up, up);
            assert!(dot(side, up).abs() < 1e-12 && (dot(side, side) - 1.0).abs() < 1e-12);
        }
    }

    /// A closed box with the given extents.
    fn solid(extents: Vector) -> Mesh {
        let corner =
            |index: usize| std::array::from_fn(|k| if index >> k & 1 == 1 { extents[k] } else { 0.0 });
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let polygons = PolygonMesh {
            positions: (0..8).map(corner).collect(),
            face_offsets: (0..=6).map(|face| 4 * face).collect(),
            face_vertices: quads.concat(),
        };
        Mesh::new(&polygons, &Limits::default()).unwrap()
    }

    #[test]
    fn the_taller_of_y_and_z_is_up_unless_the_caller_says_otherwise() {
        let across = [1.0, 0.0, 0.0];
        assert_eq!(upright(&solid([1.0, 3.0, 2.0]), across, Up::Auto), [0.0, 1.0, 0.0]);
        assert_eq!(upright(&solid([1.0, 2.0, 3.0]), across, Up::Auto), [0.0, 0.0, 1.0]);
        // Lying along x, partners apart along z: y is up although x is longer.
        assert_eq!(upright(&solid([1.8, 1.0, 1.0]), [0.0, 0.0, 1.0], Up::Auto), [0.0, 1.0, 0.0]);
        let reversed = Up::Axis { axis: 2, reversed: true };
        assert_eq!(upright(&solid([1.0, 3.0, 2.0]), across, reversed), [0.0, 0.0, -1.0]);
    }
}
