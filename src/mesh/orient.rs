//! Consistent orientation over the edges that exactly two polygons share: disjoint sets of polygons, each as it was given and reversed.

use super::Mesh;
use super::edges::{EdgeTable, UnionFind};
use super::polygons::Polygons;
use super::shells::centre;
use super::vector::{Vector, cross, dot, squared_norm, subtract};

/// What [`orientation`] decides, per polygon.
pub struct Orientation {
    /// Whether the polygon must be reversed to agree with its neighbours.
    pub flip: Vec<bool>,
    /// Whether the polygon's patch cannot be oriented (such a patch is left as it was given).
    pub conflicting: Vec<bool>,
}

/// Area and number of polygons.
type Weight = (f64, usize);

/// Orients each patch (polygons connected over manifold edges) as the majority of its area was given.
pub fn orientation(polygons: &Polygons, edges: &EdgeTable, areas: &[f64]) -> Orientation {
    // Of each polygon the lowest that agrees with it, and the lowest that agrees with it reversed; the lower of these stands for the patch.
    let lowest = lowest_that_agree(polygons, edges);
    let patch_and_side =
        |[own, reversed]: [u32; 2]| (own.min(reversed) as usize, usize::from(reversed < own));
    let mut weights = vec![[Weight::default(); 2]; polygons.len()];
    for (&sides, area) in lowest.iter().zip(areas) {
        let (patch, side) = patch_and_side(sides);
        let weight = &mut weights[patch][side];
        *weight = (weight.0 + area, weight.1 + 1);
    }
    let flip = |&sides: &[u32; 2]| {
        let (patch, side) = patch_and_side(sides);
        sides[0] != sides[1] && (side == 1) != is_turned_over(weights[patch])
    };
    Orientation {
        flip: lowest.iter().map(flip).collect(),
        conflicting: lowest.iter().map(|[own, reversed]| own == reversed).collect(),
    }
}

/// Whether a patch was mostly given the other way round than its lowest polygon.
fn is_turned_over([given, reversed]: [Weight; 2]) -> bool {
    let tie = (given.0 - reversed.0).abs() <= 1e-9 * (given.0 + reversed.0);
    if tie { reversed.1 > given.1 } else { reversed.0 > given.0 }
}

/// For each polygon as it was given, and for each reversed, what stands for all that agree with it. Both are the same where two ways disagree.
fn lowest_that_agree(polygons: &Polygons, edges: &EdgeTable) -> Vec<[u32; 2]> {
    let (owner, count) = (polygons.polygon_of_corner(), polygons.len() as u32);
    let mut sets = UnionFind::new(2 * polygons.len());
    for edge in edges.edges() {
        let &[a, b] = edge else { continue };
        let same_direction = polygons.corners[a as usize] == polygons.corners[b as usize];
        let [a, b] = [a, b].map(|half_edge| owner[half_edge as usize]);
        let [given, reversed] = if same_direction { [b + count, b] } else { [b, b + count] };
        sets.join(a, given);
        sets.join(a + count, reversed);
    }
    (0..count).map(|polygon| [sets.find(polygon), sets.find(polygon + count)]).collect()
}

impl Mesh {
    /// Whether the faces of each shell look inwards: by its volume, which is negative then. That of an open shell depends on what it is
    /// measured from, and counts if it is negative from everywhere within the root mean square distance of its points from their mean.
    pub(crate) fn inside_out(&self) -> Vec<bool> {
        let mut points = vec![Vec::new(); self.shell_count];
        for (&at, &shell) in self.positions.iter().zip(&self.shell_of_point) {
            points[shell as usize].push(at);
        }
        let middles: Vec<Vector> = points.iter_mut().map(|points| centre(points)).collect();
        // Six times the volume, twice the vector area.
        let mut sums = vec![(0.0, [0.0; 3]); self.shell_count];
        for triangle in &self.triangles {
            let shell = self.shell_of_point[triangle[0] as usize] as usize;
            let [a, b, c] = triangle.map(|corner| subtract(self.positions[corner as usize], middles[shell]));
            let (volume, area) = &mut sums[shell];
            *volume += dot(a, cross(b, c));
            let own = cross(subtract(b, a), subtract(c, a));
            (0..3).for_each(|axis| area[axis] += own[axis]);
        }
        let is_negative = |((volume, area), points): ((f64, Vector), Vec<Vector>)| {
            let square = points.iter().map(|&at| squared_norm(at)).sum::<f64>() / points.len() as f64;
            volume < -(square * squared_norm(area)).sqrt()
        };
        sums.into_iter().zip(points).map(is_negative).collect()
    }
}
