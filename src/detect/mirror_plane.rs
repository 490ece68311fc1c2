//! The mirror plane of a mesh at rest, if it has one.
//!
//! What nobody has posed yet is symmetric in space, and its plane says more than any map along the surface. A plane's normal is a principal axis; the plane
//! is then fitted to the places of the surface and those nearest to their images (P. Besl, N. McKay, "A method for registration of 3-D shapes", 1992; the
//! plane of pairs: the eigenvector of least eigenvalue of the symmetrised moments between them).

use crate::geometry::surface_grid::{Place, places};
use crate::mesh::Mesh;
use crate::mesh::rotation::principal_axes;
use crate::mesh::vector::{Vector, dot, squared_norm, subtract};
use rstar::RTree;

/// Distance of the places that are compared, in sqrt(area), and how many are fitted.
const SPACING: f64 = 0.02;
const FITTED: usize = 200;
/// Rounds of the fit; the share of the places that is fitted, the nearest to the surface.
const ROUNDS: usize = 8;
const KEPT: f64 = 0.8;
/// Images of a plane worth looking at are this near to the surface, in sqrt(area), in the median.
const NEAR: f64 = 0.015;
/// From this median on a plane is not fitted any more.
const HOPELESS: f64 = 0.04;
/// Second moments as near to each other as this, in parts of the largest, leave the plane's normal open.
const DISTINCT: f64 = 0.02;

/// A plane: what is on it has `dot(normal, position) = offset`.
#[derive(Debug, Clone, Copy)]
pub struct MirrorPlane {
    /// Of length 1.
    pub normal: Vector,
    /// In the unit of the mesh.
    pub offset: f64,
}

impl MirrorPlane {
    /// The plane whose images are nearest to the surface; `None` if they are not near it, or if the moments of the shape single no plane out. Some ms, if they are not near it.
    pub fn of(mesh: &Mesh) -> Option<MirrorPlane> {
        let places: Vec<Place> = places(&mesh.positions, &mesh.triangles, SPACING);
        let middle = mean(places.iter().map(|place| place.at), places.len());
        let moments = moments(places.iter().map(|place| subtract(place.at, middle)).map(|at| (at, at)));
        let axes = principal_axes(moments);
        let of_axis = |axis: &Vector| (0..3).map(|i| axis[i] * dot(moments[i], *axis)).sum::<f64>();
        let sizes = [0, 1, 2].map(|k| of_axis(&axes[k]));
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        let is_open = |k: usize| (0..3).any(|l| l != k && (sizes[k] - sizes[l]).abs() < DISTINCT * largest);
        let tree = RTree::bulk_load(places.iter().map(|place| place.at).collect());
        let step = places.len().div_ceil(FITTED).max(1);
        let fitted: Vec<Vector> = places.iter().step_by(step).map(|place| place.at).collect();
        let planes = (0..3)
            .filter(|&k| !is_open(k))
            .map(|k| MirrorPlane { normal: axes[k], offset: dot(axes[k], middle) }.fitted(&fitted, &tree));
        let best = planes.min_by(|a, b| a.1.total_cmp(&b.1))?;
        (best.1 < NEAR).then_some(best.0)
    }

    /// The mirror image of a place.
    pub fn image(&self, place: Vector) -> Vector {
        let away = 2.0 * (dot(self.normal, place) - self.offset);
        std::array::from_fn(|axis| place[axis] - away * self.normal[axis])
    }

    /// The plane nearby that fits best, and the median distance of images from the surface.
    fn fitted(mut self, sought: &[Vector], tree: &RTree<Vector>) -> (MirrorPlane, f64) {
        let mut median = f64::INFINITY;
        for _ in 0..ROUNDS {
            let pair = |&from: &Vector| {
                let near = *tree.nearest_neighbor(self.image(from)).expect("a place");
                (squared_norm(subtract(self.image(from), near)), from, near)
            };
            let mut pairs: Vec<(f64, Vector, Vector)> = sought.iter().map(pair).collect();
            pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
            median = pairs[pairs.len() / 2].0.sqrt();
            if median > HOPELESS {
                break;
            }
            pairs.truncate((KEPT * pairs.len() as f64).ceil() as usize);
            let [from, to] = [0, 1].map(|end| {
                mean(pairs.iter().map(|pair| if end == 0 { pair.1 } else { pair.2 }), pairs.len())
            });
            let between = moments(pairs.iter().map(|&(_, a, b)| (subtract(a, from), subtract(b, to))));
            let axes = principal_axes(between);
            let of_axis = |axis: &Vector| (0..3).map(|i| axis[i] * dot(between[i], *axis)).sum::<f64>();
            self.normal = axes.into_iter().min_by(|a, b| of_axis(a).total_cmp(&of_axis(b))).expect("three");
            self.offset = 0.5 * (dot(self.normal, from) + dot(self.normal, to));
        }
        (self, median)
    }
}

fn mean(places: impl Iterator<Item = Vector>, count: usize) -> Vector {
    let sum = places.fold([0.0; 3], |sum: Vector, at| std::array::from_fn(|axis| sum[axis] + at[axis]));
    sum.map(|value| value / count.max(1) as f64)
}

/// The sum of `(a b^T + b a^T) / 2`.
fn moments(pairs: impl Iterator<Item = (Vector, Vector)>) -> [[f64; 3]; 3] {
    let mut sum = [[0.0; 3]; 3];
    for (a, b) in pairs {
        for i in 0..3 {
            for j in 0..3 {
                sum[i][j] += 0.5 * (a[i] * b[j] + b[i] * a[j]);
            }
        }
    }
    sum
}
