//! How far a map moves the surface.
//!
//! The identity is as isometric as a map can be, and maps near to it gain from that: what moves little must be
//! the more isometric to be believed.

use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::sampling::SPREAD_COORDINATES;
use crate::spectral::signature::mean;

/// Mean distance of the vertices, which stand for `areas`, from their `partners` in the embedding that spreads the samples
/// (`phi_j / sqrt(eigenvalue_j)`), in radii of the embedding: 0 for the identity. O(vertices).
pub fn mean_displacement(basis: &Eigenbasis, areas: &[f64], partners: &[u32]) -> f64 {
    let (mut squared_radius, mut squared_ways) = (0.0, vec![0.0; partners.len()]);
    for (j, eigenvalue) in basis.eigenvalues.iter().take(SPREAD_COORDINATES).enumerate() {
        let column = basis.eigenfunctions.col_as_slice(j);
        let weight = 1.0 / eigenvalue.max(f64::MIN_POSITIVE);
        squared_radius += weight * mean(areas, column.iter().map(|value| value.powi(2)));
        for ((way, value), &partner) in squared_ways.iter_mut().zip(column).zip(partners) {
            *way += weight * (value - column[partner as usize]).powi(2);
        }
    }
    mean(areas, squared_ways.into_iter().map(f64::sqrt)) / squared_radius.sqrt().max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

    /// Two eigenfunctions at the corners of a rectangle; the first is longer in the embedding.
    fn rectangle() -> Eigenbasis {
        let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]];
        let eigenfunctions = Mat::from_fn(4, 2, |i, j| signs[i][j]);
        Eigenbasis { eigenvalues: vec![1.0, 4.0], eigenfunctions }
    }

    #[test]
    fn the_identity_moves_nothing_and_a_map_the_more_the_lower_the_function_it_reverses() {
        let measure = |partners: [u32; 4]| mean_displacement(&rectangle(), &[0.25; 4], &partners);
        assert_eq!(measure([0, 1, 2, 3]), 0.0);
        let radius = 1.25f64.sqrt();
        assert!((measure([3, 2, 1, 0]) - 2.0 / radius).abs() < 1e-12);
        assert!((measure([1, 0, 3, 2]) - 1.0 / radius).abs() < 1e-12);
        assert!((measure([2, 3, 0, 1]) - 2.0).abs() < 1e-12);
    }
}
