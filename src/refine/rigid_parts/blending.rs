//! Where no part fits, as at a bent joint, the motions of those around pass into each other.
//!
//! A skin follows the bones on both sides of a joint by weights that change smoothly from one to the other (N. Magnenat-Thalmann,
//! R. Laperriere, D. Thalmann, "Joint-dependent local deformations for hand animation and object grasping", 1988). Here the weights of the
//! parts' motions are harmonic where the parts fit badly (as in P. Joshi et al., "Harmonic coordinates for character articulation", 2007)
//! and stay as they are where they fit: with C what the parts around a vertex say in all, K the stiffness and M the masses, the weights of
//! all motions at once solve `(M (C + map) + reach^2 K) w = M c`.

use super::mapped::Mapped;
use super::motion::Motion;
use super::{Goal, Part};
use crate::base::error::Result;
use crate::mesh::vector::Vector;
use crate::spectral::laplacian::IntrinsicSurface;

/// Where the parts say 1 in all, motions pass into each other over this distance, in sqrt(area).
const REACH: f64 = 0.0224;
/// What the map says everywhere. With less, parts that fit badly lead hands and faces astray, whose poses are not rigid.
const MAP: f64 = 0.5;
/// Numbers of a motion, and the share of motions in what is said.
const NUMBERS: usize = 13;

/// Where each vertex's image should lie.
///
/// # Errors
/// [`crate::Error::Internal`].
pub(super) fn goals(
    mapped: &Mapped,
    surface: &IntrinsicSurface,
    parts: &[Part],
    agreed: &[Goal],
) -> Result<Vec<Vector>> {
    let said = said(mapped, parts, agreed);
    let share = |(mass, said): (&f64, &[f64; NUMBERS])| said.map(|said| mass / (REACH * REACH) * said);
    let right: Vec<[f64; NUMBERS]> = surface.lumped_mass.iter().zip(&said).map(share).collect();
    let of_map = surface.lumped_mass.iter().map(|mass| MAP * mass / (REACH * REACH));
    let diagonal: Vec<f64> = right.iter().zip(of_map).map(|(said, map)| said[12] + map).collect();
    let goal = |(vertex, blended): (usize, [f64; NUMBERS])| {
        let [own, image] = [mapped.shell.positions[vertex], mapped.images[vertex]];
        std::array::from_fn(|axis| {
            let turned: f64 = (0..3).map(|k| blended[3 * axis + k] * own[k]).sum();
            turned + blended[9 + axis] + (1.0 - blended[12]) * image[axis]
        })
    };
    Ok(surface.solve(&diagonal, &right)?.into_iter().enumerate().map(goal).collect())
}

/// The sum of the motions of each vertex's parts, each as often as it says, and how often that is.
fn said(mapped: &Mapped, parts: &[Part], agreed: &[Goal]) -> Vec<[f64; NUMBERS]> {
    let mut said = vec![[0.0; NUMBERS]; mapped.images.len()];
    for part in parts {
        let numbers = numbers(&part.motion);
        for (vertex, weight) in part.says(mapped, Some(agreed)) {
            said[vertex].iter_mut().zip(&numbers).for_each(|(sum, number)| *sum += weight * number);
        }
    }
    said
}

/// Rows of the turn, the shift, and 1.
fn numbers(motion: &Motion) -> [f64; NUMBERS] {
    let [a, b, c] = motion.turn;
    let [x, y, z] = motion.shift;
    [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], x, y, z, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::vertex_map::VertexMap;
    use crate::mesh::Shell;
    use crate::refine::rigid_parts::mapped::Disc;
    use crate::refine::rigid_parts::strip;

    const COLUMNS: u32 = 41;

    /// A flat strip of area 1 / 5.
    fn flat_strip() -> Shell {
        strip(|column, row| [f64::from(column) / 40.0, f64::from(row) / 20.0, 0.0])
    }

    /// Lifts by a height.
    fn lift(height: f64) -> Motion {
        Motion { turn: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], shift: [0.0, 0.0, height] }
    }

    /// Heights of the goals along the strip where some columns are lifted, each by all that is said there; the map is the identity.
    fn heights(lifted: &[(std::ops::Range<u32>, f64)]) -> Vec<f64> {
        let shell = flat_strip();
        let surface = IntrinsicSurface::new(&shell);
        let own = (0..shell.positions.len() as u32).collect();
        let mapped = Mapped::new(&shell, &VertexMap::at_vertices(&shell.triangles, own));
        let column = |vertex: u32| shell.points[vertex as usize] / 5;
        let disc = |columns: &std::ops::Range<u32>| Disc {
            middle: 0,
            members: (0..5 * COLUMNS).filter(|&v| columns.contains(&column(v))).map(|v| (v, 10.0)).collect(),
        };
        let discs: Vec<Disc> = lifted.iter().map(|(columns, _)| disc(columns)).collect();
        let part = |disc, height| Part { disc, start: lift(height), motion: lift(height), trust: 1.0 };
        let parts: Vec<Part> =
            discs.iter().zip(lifted).map(|(disc, (_, height))| part(disc, *height)).collect();
        let agreed = crate::refine::rigid_parts::agreed(&mapped, &parts);
        let goals = goals(&mapped, &surface, &parts, &agreed).expect("goals");
        let middle =
            |of: u32| (0..5 * COLUMNS).find(|&v| shell.points[v as usize] == 5 * of + 2).expect("a vertex");
        (0..COLUMNS).map(|of| goals[middle(of) as usize][2]).collect()
    }

    #[test]
    fn motions_reach_beyond_their_parts_and_pass_into_each_other() {
        // Nothing is said of column 20.
        let heights = heights(&[(0..20, 0.02), (21..COLUMNS, 0.01)]);
        let beside_the_map = |height: f64| height * 10.0 / (10.0 + MAP);
        let all_near = |of: &[f64], height: f64| of.iter().all(|h| (h - beside_the_map(height)).abs() < 5e-4);
        assert!(all_near(&heights[..18], 0.02) && all_near(&heights[23..], 0.01), "{heights:?}");
        assert!(heights[17..21].windows(2).all(|pair| pair[0] > pair[1]), "{heights:?}");
        // The map itself, which lifts nothing, would leave 0.
        assert!((0.003..0.015).contains(&heights[20]), "{heights:?}");
    }

    #[test]
    fn far_from_all_parts_the_map_stays() {
        assert!(heights(&[]).iter().all(|height| *height == 0.0));
        let heights = heights(&[(0..3, 0.02)]);
        assert!(heights[0] > 0.018 && heights[COLUMNS as usize - 1] < 0.25 * heights[0], "{heights:?}");
    }
}
