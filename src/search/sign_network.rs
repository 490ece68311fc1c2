//! Parity of eigenfunctions by a small neural network.
//!
//! After Y.-L. Qiao, L. Gao, S.-Z. Liu, L. Liu, Y.-K. Lai, X. Chen, "Learning-based Real-time Detection
//! of Intrinsic Reflectional Symmetry" (SignNet). It looks at the first three eigenfunctions and one
//! more at sampled points, and says whether that one is even (+1) or odd (-1) under the mirror map. We
//! deviate: the network is 200 times smaller, it may answer "neither", and its answer does not depend
//! on the eigenfunctions' signs at all (see `training/network.py` and `docs/sign_network.md`).
//!
//! The embedded network needs nothing else. A model of the user's own runs in an ONNX Runtime library that the
//! user has, by the feature `onnx`.

mod forward;
#[cfg(feature = "onnx")]
mod own_model;

use std::path::Path;
use std::sync::OnceLock;

use crate::base::error::{Error, Result};
use crate::base::limits::Limits;
use crate::base::options::Options;
use crate::mesh::io::read_limited;

use forward::{ForwardPass, POINTS};
#[cfg(feature = "onnx")]
use own_model::OwnModel;

/// What the network says of one eigenfunction. The three probabilities add up to one.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct SignPrediction {
    /// Probability that the function is its own mirror image.
    pub even: f32,
    /// Probability that the function is the negative of its mirror image.
    pub odd: f32,
    /// Probability that it is neither: a repeated eigenvalue, or no symmetry.
    pub neither: f32,
    /// `ln(even / odd)`: positive for even, its size is the confidence.
    pub logit: f32,
}

impl SignPrediction {
    /// Nothing known: even as likely as odd.
    pub(crate) const UNKNOWN: SignPrediction =
        SignPrediction { even: 0.5, odd: 0.5, neither: 0.0, logit: 0.0 };

    /// What a person is sure of.
    pub(crate) fn certain(even: bool) -> Self {
        let (yes, no) = (1.0, 0.0);
        let logit = if even { f32::MAX } else { f32::MIN };
        let (even, odd) = if even { (yes, no) } else { (no, yes) };
        SignPrediction { even, odd, neither: no, logit }
    }

    /// Softmax of the network's three outputs (even, odd, neither).
    fn from_logits(logits: [f32; 3]) -> Self {
        let peak = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let exponentials = logits.map(|logit| (logit - peak).exp());
        let total: f32 = exponentials.iter().sum();
        let [even, odd, neither] = exponentials.map(|value| value / total);
        Self { even, odd, neither, logit: logits[0] - logits[1] }
    }
}

/// A loaded network. One serves any number of meshes and threads.
#[derive(Debug)]
pub struct SignNetwork(Model);

#[derive(Debug)]
enum Model {
    Embedded(ForwardPass),
    #[cfg(feature = "onnx")]
    Own(OwnModel),
}

/// Eigenfunctions that every input holds beside the one in question.
pub const REFERENCES: usize = 3;
/// Eigenfunctions that the embedded network was trained to answer for, from the first on.
pub const SIGNS: usize = 12;

impl SignNetwork {
    /// The network inside this library.
    pub fn embedded() -> Self {
        Self(Model::Embedded(ForwardPass::new()))
    }

    /// [`SignNetwork::embedded`], made once a process.
    pub fn shared() -> &'static Self {
        static SHARED: OnceLock<SignNetwork> = OnceLock::new();
        SHARED.get_or_init(Self::embedded)
    }

    /// A model of the user's own: trusted input, as it runs inside this process. Calls of it are serialised.
    ///
    /// It needs one float32 input `[signs, points, 4]` (columns: the first three eigenfunctions and the
    /// one in question; `signs` and `points` may be dynamic) and one float32 output `[signs, 3]`,
    /// the logits of even, odd, neither. It runs in an ONNX Runtime library (1.24 or newer) that the environment
    /// variable `ORT_DYLIB_PATH` names, or that the system finds; it is chosen once a process.
    ///
    /// # Errors
    /// [`Error::Limit`] if the file is too large, [`Error::Model`] if it cannot be read or is no such model, there is no
    /// ONNX Runtime, or this library was built without the feature `onnx`.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let bytes = read_limited(path, &Limits::default()).map_err(|error| match error {
            Error::File { .. } => Error::Model(error.to_string()),
            other => other,
        })?;
        let model = own_model(&bytes);
        model.map(Self).map_err(|message| Error::Model(format!("{}: {message}", path.display())))
    }

    /// The model of the user's own that the options ask for, if they do.
    ///
    /// # Errors
    /// Those of [`SignNetwork::from_file`].
    pub fn own(options: &Options) -> Result<Option<Self>> {
        options.model.as_ref().filter(|_| options.network).map(Self::from_file).transpose()
    }

    /// Parity of each of the first `k` eigenfunctions.
    ///
    /// `eigenfunctions` holds `samples` rows of `k` numbers: the eigenfunctions (constant left out, by
    /// rising eigenvalue) at points spread in proportion to area, see [`crate::spectral::sampling::area_weighted_vertices`]. Scale
    /// and sign of each column do not matter. Rows are thinned out evenly, or repeated, to the number
    /// of points that the model takes (256). Cost: `O(k * points)`, about 0.2 ms an eigenfunction.
    ///
    /// # Errors
    /// [`Error::Internal`] if the array's length is not `samples * k`, `samples` is zero, `k` is below
    /// [`REFERENCES`], or a number is not finite; [`Error::Model`] if a model of the user's own fails.
    pub fn predict(&self, eigenfunctions: &[f64], samples: usize, k: usize) -> Result<Vec<SignPrediction>> {
        check_samples(eigenfunctions, samples, k)?;
        let thinned = |points| thinned(eigenfunctions, samples, k, points);
        let logits = match &self.0 {
            Model::Embedded(network) => network.logits(&thinned(POINTS), k),
            #[cfg(feature = "onnx")]
            Model::Own(model) => model.logits(&thinned(model.points()), k).map_err(Error::Model)?,
        };
        Ok(logits.into_iter().map(SignPrediction::from_logits).collect())
    }
}

#[cfg(feature = "onnx")]
fn own_model(bytes: &[u8]) -> Result<Model, String> {
    OwnModel::load(bytes).map(Model::Own)
}

#[cfg(not(feature = "onnx"))]
fn own_model(_: &[u8]) -> Result<Model, String> {
    Err("this library was built without models of one's own (feature `onnx`)".into())
}

fn check_samples(eigenfunctions: &[f64], samples: usize, k: usize) -> Result<()> {
    if samples == 0 || k < REFERENCES || Some(eigenfunctions.len()) != samples.checked_mul(k) {
        return Err(Error::Internal(format!(
            "the sign network was given {} numbers for {samples} samples of {k} eigenfunctions",
            eigenfunctions.len()
        )));
    }
    if eigenfunctions.iter().any(|value| !value.is_finite()) {
        return Err(Error::Internal("the sign network was given an eigenfunction that is not finite".into()));
    }
    Ok(())
}

/// `points` rows of the `samples`, thinned out evenly or repeated.
fn thinned(eigenfunctions: &[f64], samples: usize, k: usize, points: usize) -> Vec<f64> {
    (0..points).flat_map(|point| &eigenfunctions[point * samples / points * k..][..k]).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_add_up_and_the_logit_is_their_log_ratio() {
        let prediction = SignPrediction::from_logits([2.0, -1.0, 0.5]);
        assert!((prediction.even + prediction.odd + prediction.neither - 1.0).abs() < 1e-6);
        assert!(((prediction.even / prediction.odd).ln() - prediction.logit).abs() < 1e-5);
    }

    #[test]
    fn rows_are_thinned_out_or_repeated() {
        let rows = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(thinned(&rows, 4, 1, 2), [1.0, 3.0]);
        assert_eq!(thinned(&rows, 2, 2, 4), [1.0, 2.0, 1.0, 2.0, 3.0, 4.0, 3.0, 4.0]);
    }

    #[test]
    fn wrong_lengths_are_refused() {
        assert!(check_samples(&[0.0; 7], 2, 4).is_err());
        assert!(check_samples(&[0.0; 4], 2, 2).is_err());
        assert!(check_samples(&[f64::NAN; 8], 2, 4).is_err());
        assert!(check_samples(&[0.0; 8], 2, 4).is_ok());
    }
}
