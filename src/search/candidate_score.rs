//! How symmetric, how isometric and how reflecting a candidate map is.
//!
//! Commutativity with the Laplacian alone prefers wrong maps (legs swapped and arms kept; front and
//! back exchanged). The score adds the orientation operator (J. Ren, A. Poulenard, P. Wonka,
//! M. Ovsjanikov, "Continuous and Orientation-preserving Correspondences via Functional Maps", 2018,
//! section 4), the share of points that hardly move, and the disagreement with predicted parities.
//! The formula `ln(lap + 0.003) + orientation + 3 fixed + 4 disagreement` and its weights are ours.

use crate::base::error::Result;
use crate::base::symmetry_kind::SymmetryKind;
use crate::search::functional_map::{Projection, commutator, mean_trace};
use crate::search::refinement::{SampleRefiner, nearest_of_twins};
use crate::search::sign_network::SIGNS;
use crate::spectral::dense::product;
use crate::spectral::eigenbasis::Eigenbasis;
use crate::spectral::laplacian::IntrinsicSurface;
use crate::spectral::sampling::{SPREAD_COORDINATES, Samples, spread_rows};
use crate::spectral::twin_parts::TwinParts;
use faer::{ColRef, Mat};

/// Eigenfunctions that the orientation looks at on a surface with parts, whose first ones hardly vary inside parts; elsewhere as many as have signs.
const ORIENTATION_FUNCTIONS_OF_PARTS: usize = 24;
/// A pair of functions whose operator hardly varies, as two that depend on the height alone on a surface of revolution, is
/// weighed as if it varied by this share of the mean of all pairs.
const LEAST_VARIANCE: f64 = 1e-4;
/// Samples that move less than this share of the embedding's radius count as fixed.
const FIXED_RADIUS: f64 = 0.15;
/// Orientation correlations from minus this to this say neither reflection nor half turn.
const UNSIDED: f64 = 0.3;
/// Weight of the parities that a map contradicts.
const DISAGREEMENT_WEIGHT: f64 = 4.0;
/// Times that images are sought when a map is turned over.
const TURNING_ROUNDS: usize = 3;
/// Candidates nearer to the identity than this (mean trace) are refused.
const IDENTITY_TRACE: f64 = 0.85;

/// The terms of the score; every field is the lower the better except `trace`, which only refuses.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Score {
    /// Failure to commute with the Laplacian, 0 for an isometry.
    pub commutator: f64,
    /// Correlation of the orientation operator before and after the map: -1 reflection, +1 half turn, 0 unknown.
    pub orientation: f64,
    /// Share of samples that hardly move, 0..=1.
    pub fixed: f64,
    /// Confidence-weighted share of predicted parities that the map contradicts, 0..=1; 0 without predictions.
    pub disagreement: f64,
    /// Mean trace of the map: 1 for the identity.
    pub trace: f64,
    /// Whether the map takes parts to their likely twins, of which some are not themselves: it is a reflection then, and no identity, whatever the orientation and the trace say.
    pub by_twins: bool,
}

impl Score {
    /// The number that ranks candidates: lower is better.
    pub fn total(&self) -> f64 {
        (self.commutator + 0.003).ln()
            + self.orientation
            + 3.0 * self.fixed
            + DISAGREEMENT_WEIGHT * self.disagreement
    }

    /// What the orientation says the map is; `None` between the two.
    ///
    /// A shell that cannot be oriented gives no evidence (exactly 0) and passes as a reflection.
    pub fn kind(&self) -> Option<SymmetryKind> {
        match self.orientation {
            o if self.by_twins || o < -UNSIDED || o == 0.0 => Some(SymmetryKind::Reflection),
            o if o > UNSIDED => Some(SymmetryKind::HalfTurn),
            _ => None,
        }
    }

    /// [`Score::total`] with the orientation counted as evidence for either kind.
    pub(crate) fn total_of_kind(&self) -> f64 {
        self.total() - self.orientation - self.orientation.abs()
    }

    /// How far the map is from an isometry of its kind, whatever the network says: lower is better.
    pub fn isometry(&self) -> f64 {
        self.total_of_kind() - DISAGREEMENT_WEIGHT * self.disagreement
    }

    /// Whether the map is too near to the identity to be a symmetry.
    pub fn is_identity(&self) -> bool {
        self.trace >= IDENTITY_TRACE && !self.by_twins
    }
}

/// What scoring needs to know of a shell.
pub struct ScoreTerms {
    /// Those of the functions.
    eigenvalues: Vec<f64>,
    orientation: Option<OrientationOperator>,
    spread: Vec<[f64; SPREAD_COORDINATES]>,
}

impl ScoreTerms {
    /// O(triangles + samples).
    pub fn new(surface: &IntrinsicSurface, basis: &Eigenbasis, samples: &Samples) -> ScoreTerms {
        let orientation = surface.orientable.then(|| OrientationOperator::new(surface, basis, samples));
        let spread = spread_rows(samples, &basis.eigenvalues);
        ScoreTerms { eigenvalues: basis.eigenvalues.clone(), orientation, spread }
    }
}

/// Scores maps of a shell.
pub struct Scorer<'a> {
    /// The samples.
    pub(crate) refiner: &'a SampleRefiner,
    terms: &'a ScoreTerms,
    /// Predicted parity of the first eigenfunctions, P(even) - P(odd): -1 odd .. +1 even.
    predicted: Vec<f64>,
}

impl<'a> Scorer<'a> {
    /// `predicted` may be empty.
    pub fn new(refiner: &'a SampleRefiner, terms: &'a ScoreTerms, predicted: Vec<f64>) -> Scorer<'a> {
        Scorer { refiner, terms, predicted }
    }

    /// Those of the functions.
    pub fn eigenvalues(&self) -> &'a [f64] {
        &self.terms.eigenvalues
    }

    /// Judges `map` after re-estimating it, unprojected, from the points it gives.
    pub fn score(&self, map: &Mat<f64>) -> Result<Score> {
        self.score_of(map, &self.refiner.partners(map))
    }

    /// The same from the `partners` that `map` gives the samples.
    pub fn score_of(&self, map: &Mat<f64>, partners: &[u32]) -> Result<Score> {
        let free = self.refiner.estimate(partners, map.nrows(), Projection::None)?;
        let orientation =
            self.terms.orientation.as_ref().map_or(0.0, |operator| operator.correlation(&free, partners));
        Ok(Score {
            commutator: commutator(&free, self.eigenvalues()),
            orientation,
            fixed: self.fixed_share(partners),
            disagreement: self.disagreement(&free),
            trace: mean_trace(map),
            by_twins: self.refiner.samples.parts.as_ref().is_some_and(TwinParts::any_exchange),
        })
    }

    /// The map that leads to nearly the same places as `map` and turns the surface the other way round, and its partners; `None` where sides cannot be told.
    ///
    /// What is thin or round is nearly its own image front to back, and a half turn of it is a reflection but for that. So images are
    /// sought anew where the orientation operator is the reverse of what `map` makes of it. O(samples^2 x functions).
    ///
    /// # Errors
    /// [`crate::Error::Internal`] if a decomposition fails.
    pub fn turned_over(&self, map: &Mat<f64>) -> Result<Option<(Mat<f64>, Vec<u32>)>> {
        let Some(operator) = &self.terms.orientation else { return Ok(None) };
        let mut turned = map.clone();
        for _ in 0..TURNING_ROUNDS {
            let partners = operator.reversed_partners(self.refiner, &turned);
            turned = self.refiner.estimate(&partners, map.nrows(), Projection::Involution)?;
        }
        let partners = self.refiner.partners(&turned);
        Ok(Some((turned, partners)))
    }

    fn fixed_share(&self, partners: &[u32]) -> f64 {
        let moved = |i: usize| {
            let (from, to) = (&self.terms.spread[i], &self.terms.spread[partners[i] as usize]);
            from.iter().zip(to).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
        };
        let fixed = (0..partners.len()).filter(|&i| moved(i) < FIXED_RADIUS * FIXED_RADIUS).count();
        fixed as f64 / partners.len() as f64
    }

    fn disagreement(&self, map: &Mat<f64>) -> f64 {
        // A person may know more signs than a map of candidates has functions.
        let predicted = &self.predicted[..self.predicted.len().min(map.nrows())];
        let total: f64 = predicted.iter().map(|sign| sign.abs()).sum();
        if total == 0.0 {
            return 0.0;
        }
        let against = |(i, sign): (usize, &f64)| sign.abs() - sign * map[(i, i)].clamp(-1.0, 1.0);
        predicted.iter().enumerate().map(against).sum::<f64>() / (2.0 * total)
    }
}

/// `n . (grad phi_a x grad phi_b)` at each sample, for all pairs a < b of the first eigenfunctions.
///
/// The area-weighted mean over the triangles of a vertex needs only differences of function values:
/// the areas cancel. It changes sign with the orientation of the triangles and of the map alike.
struct OrientationOperator {
    functions: usize,
    /// Samples x pairs, these in the order of the strict upper triangle, row by row.
    values: Mat<f64>,
}

impl OrientationOperator {
    fn new(surface: &IntrinsicSurface, basis: &Eigenbasis, samples: &Samples) -> OrientationOperator {
        let most = if surface.parts.is_some() { ORIENTATION_FUNCTIONS_OF_PARTS } else { SIGNS };
        let functions = basis.count().min(most);
        let pairs = functions * functions.saturating_sub(1) / 2;
        let mut sample_of_vertex = vec![u32::MAX; surface.vertex_count()];
        for (sample, &vertex) in samples.vertices.iter().enumerate() {
            sample_of_vertex[vertex as usize] = sample as u32;
        }
        let mut sums = vec![vec![0.0; pairs]; samples.count()];
        let mut areas = vec![0.0; samples.count()];
        for (triangle, lengths) in surface.triangles.iter().zip(&surface.edge_lengths) {
            for &vertex in triangle {
                let sample = sample_of_vertex[vertex as usize] as usize;
                if sample < samples.count() {
                    areas[sample] += crate::spectral::laplacian::triangle_area(*lengths);
                    add_wedges(&mut sums[sample], basis, triangle, functions);
                }
            }
        }
        let mean = |i: usize, pair: usize| sums[i][pair] / areas[i].max(f64::MIN_POSITIVE);
        OrientationOperator { functions, values: Mat::from_fn(samples.count(), pairs, mean) }
    }

    /// Correlation of the pulled-back functions' operator at x with the operator at the image of x.
    fn correlation(&self, map: &Mat<f64>, partners: &[u32]) -> f64 {
        let pulled = product(self.values.as_ref(), self.pull_back(map).as_ref());
        let squares = |values: ColRef<f64>| -> f64 {
            partners.iter().map(|&partner| values[partner as usize].powi(2)).sum()
        };
        let sums: Vec<f64> = self.values.col_iter().map(squares).collect();
        let least = LEAST_VARIANCE * sums.iter().sum::<f64>() / sums.len().max(1) as f64 + 1e-12;
        let (mut cross, mut own, mut other) = (0.0, 0.0, 1e-20);
        for ((pulled, values), sum) in pulled.col_iter().zip(self.values.col_iter()).zip(&sums) {
            let weight = partners.len() as f64 / (sum + least);
            for (value, &partner) in pulled.iter().zip(partners) {
                let there = values[partner as usize];
                cross += weight * value * there;
                own += weight * value * value;
                other += weight * there * there;
            }
        }
        cross / (own * other).sqrt().max(1e-20)
    }

    /// The sample nearest to each sample's image under `map`, by the functions and by the operator, which should be the reverse of that pulled back.
    fn reversed_partners(&self, refiner: &SampleRefiner, map: &Mat<f64>) -> Vec<u32> {
        let (rows, size) = (refiner.samples.rows.as_ref(), map.nrows());
        let rows = rows.subcols(0, size);
        let (mapped, pulled) =
            (product(rows, map.as_ref()), product(self.values.as_ref(), self.pull_back(map).as_ref()));
        let (count, pairs) = (rows.nrows(), self.values.ncols());
        let squares: Vec<f64> = self.values.col_iter().map(|column| column.squared_norm_l2()).collect();
        let least = LEAST_VARIANCE * squares.iter().sum::<f64>() / pairs as f64 + 1e-12;
        // All pairs together weigh as much as the functions.
        let scale = |pair: usize| (count * size) as f64 / ((squares[pair] + least) * pairs as f64);
        let joined = |functions: &dyn Fn(usize, usize) -> f64, operators: &dyn Fn(usize, usize) -> f64| {
            Mat::from_fn(count, size + pairs, |i, j| match j.checked_sub(size) {
                None => functions(i, j) as f32,
                Some(pair) => (operators(i, pair) * scale(pair).sqrt()) as f32,
            })
        };
        let queries = joined(&|i, j| mapped[(i, j)], &|i, pair| -pulled[(i, pair)]);
        let targets = joined(&|i, j| rows[(i, j)], &|i, pair| self.values[(i, pair)]);
        nearest_of_twins(refiner.samples.parts.as_ref(), queries.as_ref(), targets.as_ref())
    }

    /// What the operators J of functions `phi` are to be multiplied by for those of `phi C`, which are `C^T J C`: the
    /// second compound matrix of C, of its 2 x 2 minors. Pairs x pairs.
    fn pull_back(&self, map: &Mat<f64>) -> Mat<f64> {
        let functions = self.functions.min(map.nrows());
        let pairs = || (0..functions).flat_map(move |a| (a + 1..functions).map(move |b| (a, b)));
        let mut out = Mat::zeros(self.values.ncols(), self.values.ncols());
        for (a, b) in pairs() {
            for (c, d) in pairs() {
                let minor = map[(a, c)] * map[(b, d)] - map[(b, c)] * map[(a, d)];
                out[(pair_index(a, b, self.functions), pair_index(c, d, self.functions))] = minor;
            }
        }
        out
    }
}

/// Place of the pair a < b in the strict upper triangle, row by row.
fn pair_index(a: usize, b: usize, functions: usize) -> usize {
    a * functions - a * (a + 1) / 2 + b - a - 1
}

fn add_wedges(row: &mut [f64], basis: &Eigenbasis, triangle: &[u32; 3], functions: usize) {
    let value = |corner: usize, j: usize| basis.eigenfunctions[(triangle[corner] as usize, j)];
    let first: [f64; ORIENTATION_FUNCTIONS_OF_PARTS] =
        std::array::from_fn(|j| if j < functions { value(1, j) - value(0, j) } else { 0.0 });
    let second: [f64; ORIENTATION_FUNCTIONS_OF_PARTS] =
        std::array::from_fn(|j| if j < functions { value(2, j) - value(0, j) } else { 0.0 });
    let mut pair = 0;
    for a in 0..functions {
        for b in a + 1..functions {
            row[pair] += 0.5 * (first[a] * second[b] - first[b] * second[a]);
            pair += 1;
        }
    }
}
