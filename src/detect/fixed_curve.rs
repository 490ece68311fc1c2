//! The two sides of a reflection and the curve between them.
//!
//! How far a vertex moves is 0 on the fixed curve and grows away from it. Neighbours that both move far
//! lie on one side, a vertex and its image on different sides: taken from the most certain of these
//! statements to the least, each that contradicts no earlier one is kept (the maximum spanning tree of
//! J. B. Kruskal, 1956, over a union-find with parity). What the kept ones leave between the sides is the
//! curve. The side times the movement is a function with `f(image of x) = -f(x)`, whose zero set it is.

use crate::geometry::vertex_map::VertexMap;
use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::laplacian::IntrinsicSurface;

/// Rounds of averaging over neighbours, which take the jags of single edges off the curve.
const SMOOTHING_ROUNDS: usize = 4;

/// Share of the area below which a part of one sign is no side of its own: a disc of radius 0.018 sqrt(area).
const SPECK: f64 = 1e-3;

/// A crossing of the fixed curve with an edge of the shell: `(1 - t) * from + t * to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeCrossing {
    /// First vertex.
    pub from: u32,
    /// Second vertex.
    pub to: u32,
    /// Position along the edge.
    pub t: f32,
}

/// A function that is positive on one side, negative on the other and 0 on the fixed curve; one value per
/// vertex, in units of the commute-time embedding. The overall sign has no meaning.
///
/// Cost: O(n (count + log n)) for `count` eigenfunctions.
pub fn odd_function(surface: &IntrinsicSurface, basis: &Eigenbasis, images: &VertexMap) -> Vec<f64> {
    let moved = movements(surface, basis, images);
    let neighbours = |vertex: usize| surface.stiffness.neighbours(vertex);
    let around = |vertex: usize| neighbours(vertex).iter().copied();
    let sides = sides(neighbours, &images.partners, &moved);
    let signed: Vec<f64> = moved.iter().zip(&sides).map(|(moved, side)| moved * f64::from(*side)).collect();
    let image_value = |vertex: usize| images.points[vertex].interpolate(&surface.triangles, &signed);
    let odd = (0..signed.len()).map(|vertex| 0.5 * (signed[vertex] - image_value(vertex))).collect();
    let mut odd = surface.stiffness.averaged(odd, SMOOTHING_ROUNDS);
    dissolve_specks(around, &surface.lumped_mass, &mut odd);
    odd
}

/// Gives connected parts of one sign that have less than `SPECK` of the area the other sign, the one around them:
/// on the curve the movement is all noise. The largest part of each sign stays. O(n).
///
/// `neighbours` may name a vertex more than once; `mass` is the area that each vertex stands for.
pub fn dissolve_specks<N: IntoIterator<Item = u32>>(
    neighbours: impl Fn(usize) -> N,
    mass: &[f64],
    odd: &mut [f64],
) {
    let positive: Vec<bool> = odd.iter().map(|value| *value >= 0.0).collect();
    let mut visited = vec![false; odd.len()];
    let mut parts = Vec::new();
    for start in 0..odd.len() {
        if std::mem::replace(&mut visited[start], true) {
            continue;
        }
        let mut part = vec![start];
        let mut next = 0;
        while next < part.len() {
            for other in neighbours(part[next]) {
                let other = other as usize;
                if positive[other] == positive[start] && !std::mem::replace(&mut visited[other], true) {
                    part.push(other);
                }
            }
            next += 1;
        }
        parts.push((part.iter().map(|&vertex| mass[vertex]).sum::<f64>(), part));
    }
    let sign = |part: &[usize]| positive[part[0]];
    let largest = |side: bool| {
        parts.iter().filter(|(_, part)| sign(part) == side).map(|(area, _)| *area).fold(0.0, f64::max)
    };
    let largest = [largest(false), largest(true)];
    let limit = SPECK * mass.iter().sum::<f64>();
    for (_, part) in parts.iter().filter(|(area, part)| *area < limit.min(largest[usize::from(sign(part))])) {
        for &vertex in part {
            odd[vertex] = if odd[vertex] == 0.0 { -f64::EPSILON } else { -odd[vertex] };
        }
    }
}

/// Distance of each vertex from its image, in the commute-time embedding (eigenfunctions over the root of
/// their eigenvalues): intrinsic, and resolved to the wavelength of the last eigenfunction.
fn movements(surface: &IntrinsicSurface, basis: &Eigenbasis, images: &VertexMap) -> Vec<f64> {
    let mut squared = vec![0.0; images.partners.len()];
    for (j, &eigenvalue) in basis.eigenvalues.iter().enumerate() {
        let function = basis.eigenfunctions.col_as_slice(j);
        for (vertex, sum) in squared.iter_mut().enumerate() {
            let moved = function[vertex] - images.points[vertex].interpolate(&surface.triangles, function);
            *sum += moved * moved / eigenvalue.max(f64::MIN_POSITIVE);
        }
    }
    squared.into_iter().map(f64::sqrt).collect()
}

/// Two vertices on one side, or on different ones.
struct Statement {
    certainty: f64,
    vertices: [u32; 2],
    apart: bool,
}

/// +1 or -1 for every vertex. O(n log n).
fn sides<'a>(neighbours: impl Fn(usize) -> &'a [u32], partners: &[u32], moved: &[f64]) -> Vec<i8> {
    let mut statements = Vec::with_capacity(4 * partners.len());
    for (vertex, &partner) in partners.iter().enumerate() {
        let mut state = |other: u32, certainty: f64, apart: bool| {
            statements.push(Statement { certainty, vertices: [vertex as u32, other], apart });
        };
        if partner as usize != vertex {
            state(partner, moved[vertex], true);
        }
        for &next in neighbours(vertex).iter().filter(|&&next| next as usize > vertex) {
            state(next, moved[vertex].min(moved[next as usize]), false);
        }
    }
    statements.sort_by(|a, b| b.certainty.total_cmp(&a.certainty));
    let mut forest = ParityForest::new(partners.len());
    for statement in &statements {
        forest.join(statement.vertices, statement.apart);
    }
    (0..partners.len() as u32).map(|vertex| if forest.find(vertex).1 { -1 } else { 1 }).collect()
}

/// Union-find in which each element is on the side of its root, or on the other one.
struct ParityForest {
    parent: Vec<u32>,
    /// Whether the element is on the other side than its parent.
    other: Vec<bool>,
}

impl ParityForest {
    fn new(count: usize) -> ParityForest {
        ParityForest { parent: (0..count as u32).collect(), other: vec![false; count] }
    }

    /// The root, and whether the element is on the other side than it. Halves the path on the way.
    fn find(&mut self, mut element: u32) -> (u32, bool) {
        let mut other = false;
        loop {
            let here = element as usize;
            let parent = self.parent[here] as usize;
            if parent == here {
                return (element, other);
            }
            // Two steps up at once; at the root's child the second step changes nothing.
            self.other[here] ^= self.other[parent];
            self.parent[here] = self.parent[parent];
            other ^= self.other[here];
            element = self.parent[here];
        }
    }

    /// Holds the two on one side, or apart, unless earlier statements say otherwise.
    fn join(&mut self, vertices: [u32; 2], apart: bool) {
        let [(first, first_other), (second, second_other)] = vertices.map(|vertex| self.find(vertex));
        if first != second {
            self.parent[second as usize] = first;
            self.other[second as usize] = first_other ^ second_other ^ apart;
        }
    }
}

/// The zero set of `odd` as polylines of edge crossings: `(points, closed)`, longest first.
///
/// A value of exactly 0 counts as positive, so the curve passes through such vertices with t at an end.
pub fn zero_set(triangles: &[[u32; 3]], odd: &[f64]) -> Vec<(Vec<EdgeCrossing>, bool)> {
    let positive = |vertex: u32| odd[vertex as usize] >= 0.0;
    let mut next_of = std::collections::BTreeMap::<(u32, u32), Vec<(u32, u32)>>::new();
    for triangle in triangles {
        let crossed: Vec<(u32, u32)> = (0..3)
            .map(|corner| (triangle[corner], triangle[(corner + 1) % 3]))
            .filter(|(a, b)| positive(*a) != positive(*b))
            .map(|(a, b)| (a.min(b), a.max(b)))
            .collect();
        if let [first, second] = crossed[..] {
            next_of.entry(first).or_default().push(second);
            next_of.entry(second).or_default().push(first);
        }
    }
    let mut lines = chain(&next_of);
    lines.sort_by_key(|(edges, _)| std::cmp::Reverse(edges.len()));
    let crossing = |(from, to): (u32, u32)| {
        let (a, b) = (odd[from as usize], odd[to as usize]);
        EdgeCrossing { from, to, t: (a / (a - b)) as f32 }
    };
    lines.into_iter().map(|(edges, closed)| (edges.into_iter().map(crossing).collect(), closed)).collect()
}

type Edge = (u32, u32);

fn chain(next_of: &std::collections::BTreeMap<Edge, Vec<Edge>>) -> Vec<(Vec<Edge>, bool)> {
    let mut used = std::collections::BTreeSet::new();
    let mut lines = Vec::new();
    // Ends of open curves (boundary edges) first, so that no open curve is started in its middle.
    let starts = next_of.iter().filter(|(_, next)| next.len() == 1).chain(next_of.iter());
    for (&start, _) in starts {
        if used.contains(&start) {
            continue;
        }
        let mut line = vec![start];
        used.insert(start);
        let mut current = start;
        while let Some(&next) = next_of[&current].iter().find(|edge| !used.contains(*edge)) {
            used.insert(next);
            line.push(next);
            current = next;
        }
        let closed = line.len() > 2 && next_of[&current].contains(&start);
        lines.push((line, closed));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of 2 x 9 vertices mirrored about its middle column.
    fn strip() -> (Vec<Vec<u32>>, Vec<u32>, Vec<f64>) {
        let near = |a: u32, b: u32| (a % 9).abs_diff(b % 9) + (a / 9).abs_diff(b / 9) <= 1;
        let neighbours = (0..18).map(|a| (0..18).filter(|&b| near(a, b)).collect()).collect();
        let partners = (0..18).map(|a| a / 9 * 9 + 8 - a % 9).collect();
        let moved = (0..18).map(|a: u32| 2.0 * f64::from((a % 9).abs_diff(4))).collect();
        (neighbours, partners, moved)
    }

    fn assert_two_halves(sides: &[i8]) {
        for vertex in (0..18).filter(|vertex| vertex % 9 != 4) {
            let expected = if vertex % 9 < 4 { sides[0] } else { -sides[0] };
            assert_eq!(sides[vertex], expected, "vertex {vertex} of {sides:?}");
        }
    }

    #[test]
    fn a_strip_falls_into_its_halves() {
        let (neighbours, partners, moved) = strip();
        assert_two_halves(&sides(|vertex| &neighbours[vertex], &partners, &moved));
    }

    #[test]
    fn a_wrong_image_near_the_curve_changes_nothing() {
        let (neighbours, mut partners, mut moved) = strip();
        // Beside the middle: sent along its own side instead of across.
        partners[3] = 2;
        moved[3] = 1.0;
        assert_two_halves(&sides(|vertex| &neighbours[vertex], &partners, &moved));
    }

    #[test]
    fn specks_take_the_sign_around_them_and_sides_stay() {
        let neighbours: Vec<Vec<u32>> =
            (0..4000u32).map(|i| (i.saturating_sub(1)..=(i + 1).min(3999)).collect()).collect();
        let mass = vec![1.0 / 4000.0; 4000];
        // Sides of 2,000 vertices each; specks of two and of one, whose value is exactly 0; a part of 10.
        let mut odd: Vec<f64> = (0..4000).map(|i| if i < 2000 { 1.0 } else { -1.0 }).collect();
        odd[100..102].fill(-0.5);
        odd[3000] = 0.0;
        odd[500..510].fill(-0.5);
        dissolve_specks(|vertex: usize| neighbours[vertex].iter().copied(), &mass, &mut odd);
        let negative = |i: usize| i >= 2000 || (500..510).contains(&i);
        assert!((0..4000).all(|i| (odd[i] < 0.0) == negative(i)));
    }

    #[test]
    fn a_forest_keeps_the_first_of_contradicting_statements() {
        let mut forest = ParityForest::new(5);
        forest.join([0, 1], true);
        forest.join([1, 2], true);
        forest.join([3, 4], false);
        forest.join([4, 2], true);
        forest.join([0, 3], false);
        let sides: Vec<bool> = (0..5).map(|vertex| forest.find(vertex).1 ^ forest.find(0).1).collect();
        assert_eq!(sides, [false, true, false, true, true]);
    }
}
