//! How the images of vertices lie among the vertices.
//!
//! The images of an isometry lie as evenly as the vertices that it maps: where as many images as vertices come, it is the partner of one
//! that leaves about a quarter of the vertices without an image, if the two meshings have nothing in common. Images that a map scatters
//! at random leave 1/e of them, and so do those of a map between surfaces of different shape, folds and gaps included, that looks smooth
//! from afar. Unlike lengths and areas, this asks nothing of the size of the triangles: where a coarse side comes onto a fine one, most
//! vertices must stay without an image, and little can be learnt.

use super::mapped::Mapped;

/// Rounds of averaging over neighbours, to know how many images come to the surroundings of a vertex.
const ROUNDS: usize = 3;
/// The vertices without an image that are expected lie this far from those that images at random leave, towards those that even ones do.
const EVEN: f64 = 0.4;
/// More scatter says no more.
const MOST: f64 = 0.04;

/// Share of the surface whose vertices are without an image beyond what is expected, 0..=0.04.
pub(super) fn scatter(mapped: &Mapped) -> f64 {
    let count = mapped.areas.len();
    let mut images = vec![0.0; count];
    mapped.partners.iter().for_each(|&partner| images[partner as usize] += 1.0);
    let (mut around, mut vertices) = (images.clone(), vec![1.0; count]);
    for _ in 0..ROUNDS {
        around = shared(mapped, &around);
        vertices = shared(mapped, &vertices);
    }
    let beyond = |vertex: usize| {
        let density = around[vertex] / vertices[vertex];
        let (random, even) = ((-density).exp(), (1.0 - density).max(0.0));
        f64::from(images[vertex] == 0.0) - (1.0 - EVEN) * random - EVEN * even
    };
    let area: f64 = mapped.areas.iter().sum();
    let sum: f64 = mapped.areas.iter().enumerate().map(|(vertex, area)| area * beyond(vertex)).sum();
    (sum / area.max(f64::MIN_POSITIVE)).clamp(0.0, MOST)
}

/// Every vertex gives its neighbours, and itself, equal parts of what it has.
fn shared(mapped: &Mapped, values: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; values.len()];
    for (vertex, value) in values.iter().enumerate() {
        let near = || mapped.walk.around(vertex as u32);
        let part = value / (near().count() + 1) as f64;
        sums[vertex] += part;
        near().for_each(|next| sums[next as usize] += part);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::vertex_map::VertexMap;
    use crate::refine::rigid_parts::strip;

    /// Scatter of a flat strip of 41 x 5 vertices, whose columns lie at `place`, if vertex `i`, column by column, has partner `to(i)`.
    fn scatter_of(place: impl Fn(u32) -> f64, to: impl Fn(u32) -> u32) -> f64 {
        let shell = strip(|column, row| [place(column), f64::from(row) / 20.0, 0.0]);
        let local =
            |point: u32| (0..).zip(&shell.points).find(|(_, own)| **own == point).expect("a vertex").0;
        let partners: Vec<u32> = shell.points.iter().map(|&point| local(to(point))).collect();
        scatter(&Mapped::new(&shell, &VertexMap::at_vertices(&shell.triangles, partners)))
    }

    fn evenly(column: u32) -> f64 {
        f64::from(column) / 40.0
    }

    #[test]
    fn a_bijection_scatters_nothing_and_chance_much() {
        assert_eq!(scatter_of(evenly, |vertex| 204 - vertex), 0.0);
        // As evenly as they come, but one in two has an image.
        assert_eq!(scatter_of(evenly, |vertex| 204 - vertex / 2 * 2), MOST);
        let mut state = 1u64;
        let random: Vec<u32> = (0..205)
            .map(|_| {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                ((state >> 33) % 205) as u32
            })
            .collect();
        assert_eq!(scatter_of(evenly, |vertex| random[vertex as usize]), MOST);
    }

    #[test]
    fn a_coarse_side_need_not_cover_a_fine_one() {
        // 31 columns in the first half, ten in the other: two of three in the first half have no image.
        let place = |column: u32| match column {
            0..=30 => f64::from(column) / 60.0,
            _ => 0.5 + f64::from(column - 30) / 20.0,
        };
        let nearest = |x: f64| {
            (0..41).min_by(|&a, &b| (place(a) - x).abs().total_cmp(&(place(b) - x).abs())).expect("columns")
        };
        let found = scatter_of(place, |vertex| 5 * nearest(1.0 - place(vertex / 5)) + vertex % 5);
        assert!(found < 0.01, "{found}");
    }
}
