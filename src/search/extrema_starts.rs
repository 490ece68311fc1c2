//! Starts of maps from the ends of limbs: which of them are mirror images of which, by their distances alone.
//!
//! The lowest functions of eight legs that are nearly alike mix so that no signs, nor angles of pairs, describe the mirror map. But the ends of
//! the legs are far from each other, and distances along the surface tell which may be pairs. They are where the average geodesic distance
//! is largest (M. Hilaga, Y. Shinagawa, T. Kohmura, T. Kunii, "Topology matching for fully automatic similarity estimation of 3D shapes", 2001),
//! and the first points that V. Kim, Y. Lipman, X. Chen, T. Funkhouser, "Möbius Transformations For Global Intrinsic Symmetry Analysis", 2010, pair.

use crate::base::error::Result;
use crate::base::progress::CancelToken;
use crate::base::threads;
use crate::geometry::shortest_paths::{EdgeLengths, PathSearch};
use crate::search::functional_map::Projection;
use crate::search::refinement::{SampleRefiner, nearest};
use crate::search::sign_network::SIGNS;
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::sampling::area_weighted_vertices;
use faer::Mat;
use std::ops::ControlFlow;

/// Vertices from which distances are averaged.
const SOURCES: usize = 32;
/// An extremum has the largest average distance within this distance, in sqrt(area).
const APART: f64 = 0.12;
/// Most extrema that are paired, and most of these that are their own images.
const MOST_EXTREMA: usize = 12;
const MOST_FIXED: usize = 3;
/// What an extremum without an image costs, as if it differed by this share of the sum in each distance.
const UNMATCHED: f64 = 0.08;
/// Pairings that become starts.
const PAIRINGS: usize = 24;

/// Functional maps of the pairings of extrema that keep distances best: an image of a sample has distances from the images of the extrema
/// like the sample's own from these. Empty for a shape with fewer than two extrema.
///
/// Some 40 searches over the whole surface.
///
/// # Errors
/// [`crate::Error::Cancelled`], [`crate::Error::Internal`].
pub fn starts(
    surface: &IntrinsicSurface,
    refiner: &SampleRefiner,
    thread_count: usize,
    token: &CancelToken,
) -> Result<Vec<Mat<f64>>> {
    let edges = EdgeLengths::new(surface.vertex_count(), &surface.triangles, &surface.edge_lengths);
    let distances = |from: Vec<u32>| threads::map(thread_count, from, |source| edges.distances(&[source]));
    let sources = area_weighted_vertices(&surface.lumped_mass, SOURCES);
    let from_sources = distances(sources.into_iter().map(|vertex| vertex as u32).collect());
    token.check()?;
    let mean = |vertex: usize| from_sources.iter().map(|from| from[vertex]).sum::<f64>() / SOURCES as f64;
    let averages: Vec<f64> = (0..edges.vertex_count()).map(mean).collect();
    let extrema = extrema(&edges, &averages);
    let from_extrema = distances(extrema.clone());
    token.check()?;
    let at_extrema = |values: &Vec<f64>| extrema.iter().map(|&vertex| values[vertex as usize]).collect();
    let between: Vec<Vec<f64>> = from_extrema.iter().map(at_extrema).collect();
    let size = SIGNS.min(refiner.samples.rows.ncols());
    let samples = &refiner.samples.vertices;
    let start = |pairing: Vec<Option<usize>>| {
        let matched: Vec<(usize, usize)> =
            pairing.into_iter().enumerate().filter_map(|(own, image)| Some((own, image?))).collect();
        // Of roots, so that what is near tells more than what is far.
        let root = |i: usize, extremum: usize| from_extrema[extremum][samples[i] as usize].sqrt() as f32;
        let own = Mat::from_fn(samples.len(), matched.len(), |i, k| root(i, matched[k].0));
        let theirs = Mat::from_fn(samples.len(), matched.len(), |i, k| root(i, matched[k].1));
        let partners = nearest(own.as_ref(), theirs.as_ref());
        refiner.estimate(&partners, size, Projection::Orthogonal)
    };
    pairings(&between, &at_extrema(&averages)).into_iter().map(start).collect()
}

/// Vertices whose average distance is largest around, the largest first.
pub fn extrema(edges: &EdgeLengths, average: &[f64]) -> Vec<u32> {
    let before = |a: u32, b: u32| average[a as usize].total_cmp(&average[b as usize]).then(b.cmp(&a));
    let is_top = |vertex: &u32| edges.of(*vertex).all(|(near, _)| before(near, *vertex).is_le());
    let mut tops: Vec<u32> = (0..average.len() as u32).filter(is_top).collect();
    tops.sort_by(|&a, &b| before(b, a));
    let mut search = PathSearch::new(average.len());
    let (mut found, mut is_below) = (Vec::new(), vec![false; average.len()]);
    for vertex in tops {
        if found.len() == MOST_EXTREMA {
            break;
        }
        // Around a hub there may be as many as vertices, all near each other.
        if is_below[vertex as usize] {
            continue;
        }
        let (mut largest, mut reached) = (true, Vec::new());
        search.run(
            &[vertex],
            APART,
            |vertex| edges.of(vertex),
            |near, _| {
                reached.push(near);
                largest = before(near, vertex).is_le();
                if largest { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            },
        );
        if largest {
            reached.into_iter().for_each(|near| is_below[near as usize] = true);
            found.push(vertex);
        }
    }
    found
}

/// The involutions that keep distances best, the best first: the image of each extremum, `None` for one without.
///
/// `between` are the distances of the extrema from each other, `averages` those from everywhere.
fn pairings(between: &[Vec<f64>], averages: &[f64]) -> Vec<Vec<Option<usize>>> {
    let mut search = Pairings { between, averages, found: Vec::new() };
    search.extend(&mut vec![State::Open; averages.len()], 0.0, 0);
    let image = |state| match state {
        State::Image(image) => Some(image),
        State::Open | State::Unmatched => None,
    };
    search.found.into_iter().map(|(_, states)| states.into_iter().map(image).collect()).collect()
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    Open,
    Unmatched,
    Image(usize),
}

/// Branch and bound over involutions.
struct Pairings<'a> {
    between: &'a [Vec<f64>],
    averages: &'a [f64],
    /// With their costs, the cheapest first.
    found: Vec<(f64, Vec<State>)>,
}

impl Pairings<'_> {
    /// Tries all that the first open one may be; `cost` and the number of `fixed` ones are those of `states`.
    fn extend(&mut self, states: &mut Vec<State>, cost: f64, fixed: usize) {
        if self.found.len() == PAIRINGS && cost >= self.found[PAIRINGS - 1].0 {
            return;
        }
        let count = states.len();
        let Some(first) = states.iter().position(|state| *state == State::Open) else {
            self.add(states, cost);
            return;
        };
        for image in (first + 1..count).chain([first]) {
            let fixed = fixed + usize::from(image == first);
            if states[image] != State::Open || fixed > MOST_FIXED {
                continue;
            }
            let more = self.cost_of_pair(states, first, image);
            (states[first], states[image]) = (State::Image(image), State::Image(first));
            self.extend(states, cost + more, fixed);
            (states[first], states[image]) = (State::Open, State::Open);
        }
        states[first] = State::Unmatched;
        self.extend(states, cost + UNMATCHED * count as f64, fixed);
        states[first] = State::Open;
    }

    /// How much distances differ that the pair adds to those between what is paired.
    fn cost_of_pair(&self, states: &[State], first: usize, image: usize) -> f64 {
        let mut cost = difference(self.averages[first], self.averages[image]);
        for (k, state) in states.iter().enumerate() {
            let State::Image(other) = *state else { continue };
            cost += difference(self.between[first][k], self.between[image][other]);
            if image != first {
                cost += difference(self.between[image][k], self.between[first][other]);
            }
        }
        cost
    }

    /// Adds what pairs at least two.
    fn add(&mut self, states: &[State], cost: f64) {
        let moves = |(own, state): (usize, &State)| matches!(state, State::Image(image) if *image != own);
        if states.iter().enumerate().any(moves) {
            let place = self.found.partition_point(|(other, _)| *other <= cost);
            self.found.insert(place, (cost, states.to_vec()));
            self.found.truncate(PAIRINGS);
        }
    }
}

/// Relative difference of two distances.
fn difference(a: f64, b: f64) -> f64 {
    (a - b).abs() / (a + b).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All that [`pairings`] asks for, of points in the plane.
    fn paired(points: &[[f64; 2]]) -> Vec<Vec<Option<usize>>> {
        let distance = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let between: Vec<Vec<f64>> =
            points.iter().map(|a| points.iter().map(|b| distance(a, b)).collect()).collect();
        let averages: Vec<f64> =
            between.iter().map(|row| row.iter().sum::<f64>() / row.len() as f64).collect();
        pairings(&between, &averages)
    }

    #[test]
    fn mirrored_points_are_paired_and_one_without_a_partner_is_left_out() {
        let (head, pair) = ([0.0, 3.0], |x: f64, y: f64| [[-x, y], [x, y]]);
        let [[a, b], [c, d], [e, f]] = [pair(1.0, 2.0), pair(1.2, 0.1), pair(0.9, -1.7)];
        let whole = paired(&[a, c, head, e, b, f, d]);
        assert_eq!(whole.len(), PAIRINGS);
        assert_eq!(whole[0], [Some(4), Some(6), Some(2), Some(5), Some(0), Some(3), Some(1)]);
        let without_one = paired(&[a, c, head, e, b, d]);
        assert_eq!(without_one[0], [Some(4), Some(5), Some(2), None, Some(0), Some(1)]);
    }

    #[test]
    fn a_pairing_moves_something_and_fixes_little() {
        assert!(paired(&[]).is_empty() && paired(&[[0.0, 0.0]]).is_empty());
        let star: Vec<[f64; 2]> = (0..8).map(|k| f64::from(k) * 0.785).map(|a| [a.cos(), a.sin()]).collect();
        for pairing in paired(&star) {
            let fixed = (0..8).filter(|&k| pairing[k] == Some(k)).count();
            assert!(fixed <= MOST_FIXED, "{pairing:?}");
            assert!((0..8).any(|k| pairing[k].is_some_and(|image| image != k)), "{pairing:?}");
        }
    }
}
