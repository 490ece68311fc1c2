//! From shells back to the caller's mesh: one [`Symmetry`] in the caller's vertices and faces.

use crate::base::symmetry_kind::SymmetryKind;
use crate::connectivity::automorphism::Automorphism;
use crate::connectivity::mirrored_vertices::MirroredVertices;
use crate::detect::companions::Companion;
use crate::detect::correspondence::{EdgePoint, Polyline, Symmetry};
use crate::detect::coverage::Coverage;
use crate::detect::fixed_curve::{EdgeCrossing, dissolve_specks};
use crate::detect::welded_vertices::{OwnCorners, choose_by_faces};
use crate::geometry::embedded_triangles::{Fans, TrianglePoint};
use crate::geometry::vertex_map::VertexMap;
use crate::mesh::vector::{Vector, dot, squared_norm, subtract, unit};
use crate::mesh::{Mesh, NONE, Shell};

/// Largest mean of `|ln(length of an edge / length of its image)|`, weighted by length, on a shell whose
/// bijection by connectivity is taken. A posed figure has 0.06, a sphere's own symmetry on a lump modelled
/// from it 0.2 to 0.3.
const LARGEST_STRETCH: f64 = 0.15;
/// The same up to which one of several bijections is certain. Terrain and food on a regular grid have 0.05 to 0.09.
const CERTAIN_STRETCH: f64 = 0.03;

/// Least confidence of a pair of mirrored vertices (`docs/method.md`).
const CONFIDENCE_IF_MIRRORED: f32 = 0.99;

/// Least size of the odd function beside an exact fixed curve.
const SMALLEST_ODD: f64 = 1e-6;

/// A map of mesh points, gathered shell by shell.
#[derive(Debug, Clone)]
pub struct PointMap {
    /// Partner point of each point, or [`NONE`].
    pub partner: Vec<u32>,
    /// Triangle of the mesh and weights of its corners, where `partner` is not [`NONE`].
    pub image: Vec<TrianglePoint>,
    /// Confidence of each point.
    pub confidence: Vec<f32>,
    /// Odd function of each point: its sign is the side.
    pub odd: Vec<f64>,
    /// Whether the partner comes from mirrored connectivity.
    pub exact: Vec<bool>,
    /// Whether mirrored connectivity and vertices have been looked for here: a later look leaves the point as it is.
    pub settled: Vec<bool>,
}

impl PointMap {
    /// No point has a partner yet.
    pub fn empty(mesh: &Mesh) -> PointMap {
        let count = mesh.positions.len();
        let nowhere = TrianglePoint { triangle: 0, barycentric: [1.0, 0.0, 0.0] };
        PointMap {
            partner: vec![NONE; count],
            image: vec![nowhere; count],
            confidence: vec![0.0; count],
            odd: vec![0.0; count],
            exact: vec![false; count],
            settled: vec![false; count],
        }
    }

    /// Enters the images of `source`, but for what fills its holes, on `target`, none of them in a filling.
    pub fn insert(&mut self, source: &Shell, target: &Shell, images: &VertexMap, confidence: &[f32]) {
        for (local, &point) in source.points.iter().enumerate().filter(|(_, point)| **point != NONE) {
            let point = point as usize;
            self.partner[point] = target.points[images.partners[local] as usize];
            let inside = images.points[local];
            let triangle = target.triangle_of_local[inside.triangle as usize];
            self.image[point] = TrianglePoint { triangle, ..inside };
            self.confidence[point] = confidence[local];
        }
    }

    /// Gives a shell's points other images, with what confidence they have. What mirrors onto itself has its sides by where it moves.
    pub fn move_shell(
        &mut self,
        mesh: &Mesh,
        source: &Shell,
        target: &Shell,
        images: &VertexMap,
        is_own: bool,
    ) {
        let confidence: Vec<f32> =
            source.points.iter().map(|&point| self.confidence[point as usize]).collect();
        self.insert(source, target, images, &confidence);
        if !is_own {
            return;
        }
        let moved = |&point: &u32| {
            let image = self.image[point as usize].interpolate_vectors(&mesh.triangles, &mesh.positions);
            subtract(mesh.positions[point as usize], image)
        };
        let moved: Vec<Vector> = source.points.iter().map(moved).collect();
        let farthest = moved.iter().copied().max_by(|a, b| squared_norm(*a).total_cmp(&squared_norm(*b)));
        let axis = unit(farthest.unwrap_or_default());
        let former = source.points.iter().map(|&point| self.odd[point as usize]);
        let agrees: f64 = former.zip(&moved).map(|(odd, &moved)| odd * dot(axis, moved)).sum();
        let odd: Vec<f64> = moved.iter().map(|&moved| agrees.signum() * dot(axis, moved)).collect();
        self.insert_odd(source, &odd);
    }

    /// Enters the odd function of a shell's points.
    pub fn insert_odd(&mut self, shell: &Shell, odd: &[f64]) {
        for (&point, &value) in shell.points.iter().zip(odd).filter(|(point, _)| **point != NONE) {
            self.odd[point as usize] = value;
        }
    }

    /// Replaces partners by those that the connectivity gives; points it does not cover stay as they are,
    /// and so do shells whose edges it stretches as no symmetry does, and their partner shells, unless the
    /// bijection has no rival: then the shape was modelled from it.
    ///
    /// A bijection of a whole shell that has no rival, or hardly changes lengths, is certain: its confidence is 1.
    pub fn replace_by_connectivity(&mut self, mesh: &Mesh, found: &Automorphism) {
        let stretch = stretch_of_shells(mesh, &found.partner);
        let mut corner_of = vec![(0u32, 0usize); mesh.positions.len()];
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            for (corner, &point) in triangle.iter().enumerate() {
                corner_of[point as usize] = (index as u32, corner);
            }
        }
        let stretched = |point: usize, most: f64| {
            !found.unrivalled[point] && stretch[mesh.shell_of_point[point] as usize] > most
        };
        let refused = |point: usize| stretched(point, LARGEST_STRETCH);
        for (point, &image) in found.partner.iter().enumerate() {
            if image == NONE || refused(point) || refused(image as usize) {
                continue;
            }
            let (triangle, corner) = corner_of[image as usize];
            let barycentric = std::array::from_fn(|c| if c == corner { 1.0 } else { 0.0 });
            self.partner[point] = image;
            self.image[point] = TrianglePoint { triangle, barycentric };
            let both = [point, image as usize];
            if both.iter().all(|&point| found.exact[point] && !stretched(point, CERTAIN_STRETCH))
                && found.partner[image as usize] == point as u32
            {
                self.exact[point] = true;
                self.confidence[point] = 1.0;
            } else if found.unrivalled[point] {
                self.confidence[point] = self.confidence[point].max(CONFIDENCE_IF_MIRRORED);
            }
        }
        self.make_odd(mesh);
    }

    /// Those of some `points` that a pairing sends within a `distance` of their images.
    pub fn sent_within(&self, distance: f64, mesh: &Mesh, points: &[u32], found: &Automorphism) -> Vec<u32> {
        let is_near = |&point: &u32| {
            let image = self.image[point as usize].interpolate_vectors(&mesh.triangles, &mesh.positions);
            let partner = mesh.positions.get(found.partner[point as usize] as usize);
            partner.is_some_and(|&partner| squared_norm(subtract(partner, image)) < distance * distance)
        };
        points.iter().copied().filter(is_near).collect()
    }

    /// Replaces the images of shells whose vertices are mirrored.
    pub fn replace_by_vertices(&mut self, mesh: &Mesh, found: &MirroredVertices) {
        let odd = self.odd.clone();
        for (point, &partner) in found.partner.iter().enumerate().filter(|(_, partner)| **partner != NONE) {
            self.partner[point] = partner;
            self.image[point] = found.image[point];
            if found.paired[point] {
                self.confidence[point] = self.confidence[point].max(CONFIDENCE_IF_MIRRORED);
                self.odd[point] = 0.5 * (odd[point] - odd[partner as usize]);
            }
        }
        self.keep_exact_pairs();
        self.dissolve_specks(mesh, found);
    }

    /// What had an exact partner that now has another is exact no more.
    fn keep_exact_pairs(&mut self) {
        for point in 0..self.exact.len() {
            let partner = self.partner[point] as usize;
            self.exact[point] &=
                self.exact.get(partner) == Some(&true) && self.partner[partner] == point as u32;
        }
    }

    /// Small parts on the wrong side, on each shell whose vertices are mirrored by itself: another's halves may be as small.
    fn dissolve_specks(&mut self, mesh: &Mesh, found: &MirroredVertices) {
        let areas = mesh.point_areas();
        let fans = Fans::new(areas.len(), &mesh.triangles);
        let mut shells = vec![Vec::new(); mesh.shell_count];
        let mut local = vec![NONE; areas.len()];
        for point in (0..areas.len()).filter(|&point| found.partner[point] != NONE) {
            let shell = &mut shells[mesh.shell_of_point[point] as usize];
            local[point] = shell.len() as u32;
            shell.push(point);
        }
        for points in shells.iter().filter(|points| !points.is_empty()) {
            let around = |index: usize| {
                let triangles = fans.of(points[index] as u32).iter();
                let corners = triangles.flat_map(|&triangle| mesh.triangles[triangle as usize]);
                corners.map(|corner| local[corner as usize]).filter(|&near| near != NONE)
            };
            let mass: Vec<f64> = points.iter().map(|&point| areas[point]).collect();
            let mut odd: Vec<f64> = points.iter().map(|&point| self.odd[point]).collect();
            dissolve_specks(around, &mass, &mut odd);
            points.iter().zip(odd).for_each(|(&point, odd)| self.odd[point] = odd);
        }
    }

    /// `odd <- (odd - odd of the partner) / 2` where the bijection is exact: 0 on its fixed points. Each
    /// part between the fixed points gets one sign, that of its mean.
    fn make_odd(&mut self, mesh: &Mesh) {
        self.keep_exact_pairs();
        let odd = self.odd.clone();
        for point in 0..odd.len() {
            if self.exact[point] {
                self.odd[point] = 0.5 * (odd[point] - odd[self.partner[point] as usize]);
            }
        }
        let part_of = self.exact_parts(mesh);
        let mut sums = vec![0.0; odd.len()];
        for point in (0..odd.len()).filter(|&point| part_of[point] != NONE) {
            sums[part_of[point] as usize] += self.odd[point];
        }
        for point in (0..odd.len()).filter(|&point| part_of[point] != NONE) {
            let (own, other) = (part_of[point], part_of[self.partner[point] as usize]);
            if own != other {
                let positive = (sums[own as usize], other) > (sums[other as usize], own);
                let size = self.odd[point].abs().max(SMALLEST_ODD);
                self.odd[point] = if positive { size } else { -size };
            }
        }
    }

    /// The parts into which the fixed points divide the exact ones: lowest point of each point's part.
    ///
    /// No edge of a polygon crosses the fixed curve but one that joins partners: its image crosses at the
    /// same place.
    fn exact_parts(&self, mesh: &Mesh) -> Vec<u32> {
        let moves = |point: u32| self.exact[point as usize] && self.partner[point as usize] != point;
        let mut neighbours = vec![Vec::new(); self.partner.len()];
        for ends in mesh.polygon_offsets.windows(2) {
            let corners = &mesh.polygon_points[ends[0] as usize..ends[1] as usize];
            for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                if moves(a) && moves(b) && self.partner[a as usize] != b {
                    neighbours[a as usize].push(b);
                    neighbours[b as usize].push(a);
                }
            }
        }
        let mut part_of = vec![NONE; self.partner.len()];
        let mut stack = Vec::new();
        for start in (0..part_of.len() as u32).filter(|&point| moves(point)) {
            if part_of[start as usize] == NONE {
                part_of[start as usize] = start;
                stack.push(start);
            }
            while let Some(point) = stack.pop() {
                for &next in &neighbours[point as usize] {
                    if part_of[next as usize] == NONE {
                        part_of[next as usize] = start;
                        stack.push(next);
                    }
                }
            }
        }
        part_of
    }

    /// Sides of a companion's points: one side each if it swaps with another shell, its anchors' if not.
    pub fn insert_sides(&mut self, shell: &Shell, own: usize, companion: &Companion, anchors_odd: &[f64]) {
        let mean = anchors_odd.iter().sum::<f64>() / anchors_odd.len().max(1) as f64;
        for (local, &point) in shell.points.iter().enumerate() {
            self.odd[point as usize] = if companion.target == own { anchors_odd[local] } else { mean };
        }
    }
}

/// Mean of `|ln(length of an edge / length of its image)|` over the edges of each shell, weighted by length.
fn stretch_of_shells(mesh: &Mesh, partner: &[u32]) -> Vec<f64> {
    let length = |a: u32, b: u32| {
        let (p, q) = (mesh.positions[a as usize], mesh.positions[b as usize]);
        (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>().sqrt().max(f64::MIN_POSITIVE)
    };
    let (mut sums, mut weights) = (vec![0.0; mesh.shell_count], vec![0.0; mesh.shell_count]);
    for ends in mesh.polygon_offsets.windows(2) {
        let corners = &mesh.polygon_points[ends[0] as usize..ends[1] as usize];
        for (&a, &b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let (image_a, image_b) = (partner[a as usize], partner[b as usize]);
            if image_a != NONE && image_b != NONE {
                let shell = mesh.shell_of_point[a as usize] as usize;
                let weight = length(a, b);
                sums[shell] += weight * (weight / length(image_a, image_b)).ln().abs();
                weights[shell] += weight;
            }
        }
    }
    sums.iter().zip(weights).map(|(sum, weight)| if weight > 0.0 { sum / weight } else { 0.0 }).collect()
}

/// Numbers of the symmetry as a whole.
pub struct Summary {
    /// Reflection or half turn.
    pub kind: SymmetryKind,
    /// Total score.
    pub score: f64,
    /// That it is a symmetry.
    pub plausibility: f64,
}

/// The symmetry in the caller's numbering.
pub fn symmetry(
    mesh: &Mesh,
    map: &PointMap,
    curve: Vec<(Vec<EdgeCrossing>, bool)>,
    summary: Summary,
) -> Symmetry {
    let vertices = mesh.point_of_vertex.len();
    let point_of = |vertex: usize| mesh.point_of_vertex[vertex] as usize;
    let answered =
        |vertex: usize| mesh.point_of_vertex[vertex] != NONE && map.partner[point_of(vertex)] != NONE;
    let pick = |vertex: usize| -> i32 {
        if !answered(vertex) {
            return -1;
        }
        let partner = map.partner[point_of(vertex)] as usize;
        // A welded vertex that is its own mirror image stays itself, not another one there, unless faces say so.
        if partner == point_of(vertex) { vertex as i32 } else { mesh.vertex_of_point[partner] as i32 }
    };
    let side = |vertex: usize| -> i8 {
        if !answered(vertex) || summary.kind != SymmetryKind::Reflection {
            return 0;
        }
        let (point, odd) = (point_of(vertex), map.odd[point_of(vertex)]);
        if map.partner[point] as usize == point || odd == 0.0 { 0 } else { odd.signum() as i8 }
    };
    let exact = (0..vertices).filter(|&vertex| answered(vertex) && map.exact[point_of(vertex)]).count();
    let mut partner: Vec<i32> = (0..vertices).map(pick).collect();
    choose_by_faces(mesh, &map.partner, summary.kind, &mut partner);
    let own = OwnCorners::new(mesh);
    let surface_point = |vertex: usize| {
        let image = || &map.image[point_of(vertex)];
        answered(vertex).then(|| own.surface_point(mesh, image(), partner[vertex] as u32))
    };
    Symmetry {
        kind: summary.kind,
        coverage: Coverage::of(mesh, &partner),
        surface_point: (0..vertices).map(surface_point).collect(),
        partner,
        confidence: (0..vertices)
            .map(|v| if answered(v) { map.confidence[point_of(v)] } else { 0.0 })
            .collect(),
        side: (0..vertices).map(side).collect(),
        fixed_curve: curve.into_iter().map(|(points, closed)| polyline(mesh, points, closed)).collect(),
        score: summary.score,
        plausibility: summary.plausibility,
        mean_confidence: mean_over_surface(mesh, &map.confidence),
        exact_share: exact as f64 / vertices.max(1) as f64,
    }
}

fn polyline(mesh: &Mesh, points: Vec<EdgeCrossing>, closed: bool) -> Polyline {
    let vertex = |point: u32| mesh.vertex_of_point[point as usize];
    let mut edge_points: Vec<EdgePoint> = points
        .into_iter()
        .map(|crossing| {
            let (from, to) = (vertex(crossing.from), vertex(crossing.to));
            match crossing.t {
                t if t <= 0.0 => EdgePoint { from, to: from, t: 0.0 },
                t if t >= 1.0 => EdgePoint { from: to, to, t: 0.0 },
                t => EdgePoint { from, to, t },
            }
        })
        .collect();
    edge_points.dedup();
    if closed && edge_points.len() > 1 && edge_points.first() == edge_points.last() {
        edge_points.pop();
    }
    Polyline { points: edge_points, closed }
}

/// Mean of the points' `values`, weighted by their area.
pub fn mean_over_surface(mesh: &Mesh, values: &[f32]) -> f64 {
    let (mut total, mut weight) = (0.0, 0.0);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|point| mesh.positions[point as usize]);
        let area = crate::mesh::vector::triangle_area(a, b, c);
        let sum: f32 = triangle.iter().map(|&point| values[point as usize]).sum();
        total += area * f64::from(sum) / 3.0;
        weight += area;
    }
    // Rounding may leave the range of the values.
    if weight > 0.0 { (total / weight).min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::limits::Limits;
    use crate::mesh::PolygonMesh;

    /// A triangle, and another with these last corners, each other's images by connectivity.
    fn triangles(last: [[f64; 3]; 2]) -> (Mesh, Automorphism) {
        let polygons = PolygonMesh {
            positions: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [5.0, 0.0, 0.0]]
                .into_iter()
                .chain(last)
                .collect(),
            face_offsets: vec![0, 3, 6],
            face_vertices: vec![0, 1, 2, 3, 5, 4],
        };
        let found = Automorphism {
            partner: vec![3, 4, 5, 0, 1, 2],
            exact: vec![true; 6],
            covered: 6,
            complete: true,
            unrivalled: vec![false; 6],
        };
        (Mesh::new(&polygons, &Limits::default()).expect("a usable mesh"), found)
    }

    fn replaced(mesh: &Mesh, found: &Automorphism) -> PointMap {
        let mut map = PointMap::empty(mesh);
        map.replace_by_connectivity(mesh, found);
        map
    }

    /// Weighted by its own lengths, one triangle's stretch is below the limit and its partner's above.
    #[test]
    fn a_pair_of_shells_is_exact_on_both_sides_or_on_none() {
        let (mesh, found) = triangles([[6.5, 0.0, 0.0], [5.75, 0.83, 0.0]]);
        let stretch = stretch_of_shells(&mesh, &found.partner);
        assert!(stretch[0].min(stretch[1]) < LARGEST_STRETCH && stretch[0].max(stretch[1]) > LARGEST_STRETCH);
        let map = replaced(&mesh, &found);
        assert_eq!(map.partner, [NONE; 6]);
        assert_eq!(map.exact, [false; 6]);
    }

    #[test]
    fn a_point_whose_exact_partner_gets_another_is_exact_no_more() {
        let (mesh, found) = triangles([[6.0, 0.0, 0.0], [5.5, 1.0, 0.0]]);
        let mut map = replaced(&mesh, &found);
        let image = map.image.clone();
        let mirrored = MirroredVertices {
            partner: vec![4, NONE, NONE, NONE, NONE, NONE],
            image,
            paired: vec![false; 6],
        };
        map.replace_by_vertices(&mesh, &mirrored);
        assert_eq!(map.exact, [false, true, true, false, true, true]);
        // A shell may also be given another place as a whole.
        map.partner[1] = NONE;
        map.replace_by_connectivity(&mesh, &Automorphism { partner: vec![NONE; 6], ..found });
        assert_eq!(map.exact, [false, false, true, false, false, true]);
    }

    #[test]
    fn what_a_pairing_sends_away_from_its_image_is_told() {
        let (mesh, found) = triangles([[6.0, 0.0, 0.0], [5.5, 1.0, 0.0]]);
        let mut map = replaced(&mesh, &found);
        map.image.swap(1, 2);
        let points: Vec<u32> = (0..6).collect();
        assert_eq!(map.sent_within(0.1, &mesh, &points, &found), [0, 3, 4, 5]);
        assert_eq!(map.sent_within(9.0, &mesh, &points[1..], &found), [1, 2, 3, 4, 5]);
        let found = Automorphism { partner: vec![NONE; 6], ..found };
        assert!(map.sent_within(9.0, &mesh, &points, &found).is_empty());
    }

    #[test]
    fn one_of_several_bijections_that_changes_lengths_is_not_certain() {
        let (mesh, mut found) = triangles([[6.1, 0.0, 0.0], [5.55, 1.0, 0.0]]);
        let map = replaced(&mesh, &found);
        assert_eq!((&map.partner, &map.exact), (&found.partner, &vec![false; 6]));
        assert_eq!(map.confidence, [0.0; 6]);
        found.unrivalled = vec![true; 6];
        assert_eq!(replaced(&mesh, &found).exact, [true; 6]);
        let (mesh, found) = triangles([[6.0, 0.0, 0.0], [5.5, 1.0, 0.0]]);
        assert_eq!(replaced(&mesh, &found).confidence, [1.0; 6]);
    }
}
