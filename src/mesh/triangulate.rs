//! Polygons to triangles: every corner stays a corner, and a polygon of n corners gives n - 2 triangles.
//!
//! Ear clipping after G. H. Meisters, "Polygons have ears", 1975, in the polygon's mean plane (Newell's
//! normal). We deviate in that a polygon without ears (self-crossing, collinear) is still cut, at its most
//! convex corner, and that the work is bounded: once a mesh has used up its budget of point-in-triangle tests,
//! which only made-up files do, the rest of its polygons become fans.

use super::polygons::Polygons;
use super::vector::{Vector, cross, dot, squared_norm, subtract};

/// Point-in-triangle tests that one mesh may cost: about a second.
const TEST_BUDGET: u64 = 300_000_000;

/// Triangles over the vertices of `polygons`, and the polygon of each, in the order of the polygons.
///
/// Triangles with two corners alike (from polygons that touch themselves) are left out.
pub fn triangulate(polygons: &Polygons, positions: &[Vector]) -> (Vec<[u32; 3]>, Vec<u32>) {
    let count = polygons.corners.len() - 2 * polygons.len();
    let mut triangles = Vec::with_capacity(count);
    let mut owners = Vec::with_capacity(count);
    let mut tests_left = TEST_BUDGET;
    for polygon in 0..polygons.len() {
        let corners = polygons.corners_of(polygon);
        match *corners {
            [a, b, c] => triangles.push([a, b, c]),
            [a, b, c, d] => split_quad([a, b, c, d], positions, &mut triangles),
            _ => EarClipper::new(corners, positions, &mut tests_left).clip(&mut triangles),
        }
        let begin = owners.len();
        drop_repeating(&mut triangles, begin);
        owners.resize(triangles.len(), polygon as u32);
    }
    (triangles, owners)
}

fn drop_repeating(triangles: &mut Vec<[u32; 3]>, begin: usize) {
    let mut end = begin;
    for at in begin..triangles.len() {
        let [a, b, c] = triangles[at];
        if a != b && b != c && c != a {
            triangles[end] = [a, b, c];
            end += 1;
        }
    }
    triangles.truncate(end);
}

/// Splits along the shorter diagonal, unless only the longer one lies inside.
fn split_quad(corners: [u32; 4], positions: &[Vector], triangles: &mut Vec<[u32; 3]>) {
    let [a, b, c, d] = corners;
    let [pa, pb, pc, pd] = corners.map(|corner| positions[corner as usize]);
    let normal = |p: Vector, q: Vector, r: Vector| cross(subtract(q, p), subtract(r, p));
    let inside_ac = dot(normal(pa, pb, pc), normal(pa, pc, pd)) > 0.0;
    let inside_bd = dot(normal(pa, pb, pd), normal(pb, pc, pd)) > 0.0;
    let shorter_ac = squared_norm(subtract(pc, pa)) <= squared_norm(subtract(pd, pb));
    if if inside_ac == inside_bd { shorter_ac } else { inside_ac } {
        triangles.extend([[a, b, c], [a, c, d]]);
    } else {
        triangles.extend([[a, b, d], [b, c, d]]);
    }
}

/// A polygon on its way to triangles, projected to its mean plane and turned counter-clockwise.
struct EarClipper<'a> {
    corners: &'a [u32],
    plane: Vec<[f64; 2]>,
    previous: Vec<usize>,
    next: Vec<usize>,
    tests_left: &'a mut u64,
}

impl<'a> EarClipper<'a> {
    fn new(corners: &'a [u32], positions: &[Vector], tests_left: &'a mut u64) -> EarClipper<'a> {
        let count = corners.len();
        EarClipper {
            corners,
            plane: project(corners, positions),
            previous: (0..count).map(|corner| (corner + count - 1) % count).collect(),
            next: (0..count).map(|corner| (corner + 1) % count).collect(),
            tests_left,
        }
    }

    fn clip(mut self, triangles: &mut Vec<[u32; 3]>) {
        let mut reflex: Vec<usize> = (0..self.corners.len()).filter(|&at| self.turn(at) <= 0.0).collect();
        let (mut at, mut left, mut failed) = (0, self.corners.len(), 0);
        while left > 3 {
            if failed < left && !self.is_ear(at, &reflex) {
                (at, failed) = (self.next[at], failed + 1);
                continue;
            }
            let ear = if failed < left { at } else { self.most_convex(at, left) };
            at = self.cut(ear, triangles);
            self.update_reflex(ear, &mut reflex);
            (left, failed) = (left - 1, 0);
        }
        self.cut(at, triangles);
    }

    /// Forgets the corner that was cut, and its neighbours where they have become convex.
    fn update_reflex(&mut self, ear: usize, reflex: &mut Vec<usize>) {
        *self.tests_left = self.tests_left.saturating_sub(reflex.len() as u64);
        if *self.tests_left == 0 {
            reflex.clear();
        }
        let (before, after) = (self.previous[ear], self.next[ear]);
        reflex.retain(|&corner| {
            let neighbour = corner == before || corner == after;
            corner != ear && (!neighbour || self.turn(corner) <= 0.0)
        });
    }

    /// Emits the triangle at a corner and unlinks the corner; the answer is where to look next, one corner
    /// further, which avoids fans of slivers.
    fn cut(&mut self, ear: usize, triangles: &mut Vec<[u32; 3]>) -> usize {
        let (before, after) = (self.previous[ear], self.next[ear]);
        triangles.push([before, ear, after].map(|corner| self.corners[corner]));
        self.next[before] = after;
        self.previous[after] = before;
        self.next[after]
    }

    /// Twice the signed area of the triangle at a corner; positive where the polygon is convex.
    fn turn(&self, corner: usize) -> f64 {
        signed_area(self.plane[self.previous[corner]], self.plane[corner], self.plane[self.next[corner]])
    }

    fn is_ear(&mut self, corner: usize, reflex: &[usize]) -> bool {
        if *self.tests_left == 0 {
            return true;
        }
        *self.tests_left = self.tests_left.saturating_sub(reflex.len() as u64 + 1);
        let triangle = [self.previous[corner], corner, self.next[corner]];
        let [a, b, c] = triangle.map(|at| self.plane[at]);
        signed_area(a, b, c) > 0.0
            && !reflex.iter().any(|&other| {
                let point = self.plane[other];
                point != a
                    && point != b
                    && point != c
                    && signed_area(a, b, point) >= 0.0
                    && signed_area(b, c, point) >= 0.0
                    && signed_area(c, a, point) >= 0.0
            })
    }

    fn most_convex(&self, start: usize, left: usize) -> usize {
        let (mut best, mut at) = (start, start);
        for _ in 0..left {
            if self.turn(at) > self.turn(best) {
                best = at;
            }
            at = self.next[at];
        }
        best
    }
}

fn signed_area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Coordinates in the plane of Newell's normal, in which the polygon runs counter-clockwise.
fn project(corners: &[u32], positions: &[Vector]) -> Vec<[f64; 2]> {
    let origin = positions[corners[0] as usize];
    let relative: Vec<Vector> =
        corners.iter().map(|&corner| subtract(positions[corner as usize], origin)).collect();
    let mut normal = [0.0; 3];
    for at in 0..relative.len() {
        let part = cross(relative[at], relative[(at + 1) % relative.len()]);
        normal = [normal[0] + part[0], normal[1] + part[1], normal[2] + part[2]];
    }
    // Dropping the axis nearest to the normal is an affine image of the true projection: convexity and
    // containment are the same, and no rounding is added.
    let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(2);
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let sign = if normal[axis] < 0.0 { -1.0 } else { 1.0 };
    relative.iter().map(|position| [position[u], sign * position[v]]).collect()
}

#[cfg(test)]
mod tests {
    use super::super::vector::triangle_area;
    use super::*;

    fn cut(outline: &[[f64; 2]]) -> (usize, f64) {
        let positions: Vec<Vector> = outline.iter().map(|p| [p[0], p[1], 0.5 * p[0] - p[1]]).collect();
        let corners: Vec<u32> = (0..outline.len() as u32).collect();
        let polygons = Polygons { offsets: vec![0, corners.len() as u32], corners, faces: vec![0] };
        let (triangles, owners) = triangulate(&polygons, &positions);
        assert_eq!(triangles.len(), owners.len());
        let flat: Vec<Vector> = outline.iter().map(|p| [p[0], p[1], 0.0]).collect();
        let area = |[a, b, c]: [u32; 3]| triangle_area(flat[a as usize], flat[b as usize], flat[c as usize]);
        (triangles.len(), triangles.into_iter().map(area).sum())
    }

    #[test]
    fn a_concave_quad_is_split_inside() {
        let arrow = [[0.0, 0.0], [4.0, 1.0], [0.0, 2.0], [1.0, 1.0]];
        assert_eq!(cut(&arrow), (2, 3.0));
    }

    #[test]
    fn a_convex_quad_is_split_along_its_shorter_diagonal() {
        let mut triangles = Vec::new();
        let positions = [[0.0, 0.0, 0.0], [3.0, 1.0, 0.0], [6.0, 0.0, 0.0], [3.0, -1.0, 0.0]];
        split_quad([0, 1, 2, 3], &positions, &mut triangles);
        assert_eq!(triangles, [[0, 1, 3], [1, 2, 3]]);
    }

    #[test]
    fn a_comb_keeps_its_area() {
        let comb = [
            [0.0, 0.0],
            [7.0, 0.0],
            [7.0, 3.0],
            [6.0, 3.0],
            [6.0, 1.0],
            [5.0, 1.0],
            [5.0, 3.0],
            [4.0, 3.0],
            [4.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ];
        let (count, area) = cut(&comb);
        assert_eq!(count, 10);
        assert!((area - 13.0).abs() < 1e-12, "{area}");
    }

    #[test]
    fn a_polygon_is_cut_alike_in_any_plane() {
        let hook = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [3.0, 3.0], [3.0, 1.0], [0.0, 1.0]];
        let triangles = |shift: usize, sign: f64| {
            let place = |&[x, y]: &[f64; 2]| {
                let mut at = [x, sign * y, 0.0];
                at.rotate_right(shift);
                at
            };
            let positions: Vec<Vector> = hook.iter().map(place).collect();
            let polygons = Polygons { offsets: vec![0, 6], corners: (0..6).collect(), faces: vec![0] };
            let (triangles, _) = triangulate(&polygons, &positions);
            let corners = |triangle: &[u32; 3]| triangle.map(|corner| positions[corner as usize]);
            let area: f64 = triangles.iter().map(corners).map(|[a, b, c]| triangle_area(a, b, c)).sum();
            assert!((area - 6.0).abs() < 1e-12, "{area}");
            triangles
        };
        for (shift, sign) in [(1, 1.0), (2, 1.0), (0, -1.0), (1, -1.0), (2, -1.0)] {
            assert_eq!(triangles(shift, sign), triangles(0, 1.0));
        }
    }

    #[test]
    fn collinear_corners_stay_corners() {
        let square = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0]];
        let (count, area) = cut(&square);
        assert_eq!(count, 4);
        assert!((area - 4.0).abs() < 1e-12, "{area}");
    }

    #[test]
    fn a_keyhole_polygon_leaves_its_hole_open() {
        let outline =
            [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0], [1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0]];
        let positions: Vec<Vector> = outline.iter().map(|p| [p[0], p[1], 0.0]).collect();
        let corners = vec![0, 1, 2, 3, 0, 4, 5, 6, 7, 4];
        let polygons = Polygons { offsets: vec![0, 10], corners, faces: vec![0] };
        let (triangles, _) = triangulate(&polygons, &positions);
        let area: f64 = triangles
            .iter()
            .map(|t| t.map(|c| positions[c as usize]))
            .map(|[a, b, c]| triangle_area(a, b, c))
            .sum();
        assert!((area - 8.0).abs() < 1e-12, "{area}");
    }

    #[test]
    fn a_collinear_polygon_and_a_crossing_one_are_still_cut() {
        assert_eq!(cut(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, 0.0]]), (3, 0.0));
        assert_eq!(cut(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0], [1.0, 5.0]]).0, 3);
    }
}
