//! Parity of eigenfunctions by a small neural network, run through ONNX Runtime's interface.
//!
//! After Y.-L. Qiao, L. Gao, S.-Z. Liu, L. Liu, Y.-K. Lai, X. Chen, "Learning-based Real-time Detection
//! of Intrinsic Reflectional Symmetry" (SignNet). It looks at the first three eigenfunctions and one
//! more at sampled points, and says whether that one is even (+1) or odd (-1) under the mirror map. We
//! deviate: the network is 200 times smaller, it may answer "neither", and its answer does not depend
//! on the eigenfunctions' signs at all (see `training/network.py` and `docs/sign_network.md`).
//!
//! The model is embedded; without the feature `onnx` this module answers every call with an error.

#[cfg(feature = "onnx")]
mod session;

use std::path::Path;
#[cfg(feature = "onnx")]
use std::sync::OnceLock;

use crate::error::{Error, Result};

#[cfg(feature = "onnx")]
use session::Runner;

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
    pub const UNKNOWN: SignPrediction = SignPrediction { even: 0.5, odd: 0.5, neither: 0.0, logit: 0.0 };

    /// What a person is sure of.
    pub fn certain(even: bool) -> Self {
        let (yes, no) = (1.0, 0.0);
        let logit = if even { CERTAIN_LOGIT } else { -CERTAIN_LOGIT };
        let (even, odd) = if even { (yes, no) } else { (no, yes) };
        SignPrediction { even, odd, neither: no, logit }
    }

    /// Softmax of the network's three outputs (even, odd, neither).
    #[cfg_attr(not(feature = "onnx"), allow(dead_code))]
    fn from_logits(logits: [f32; 3]) -> Self {
        let peak = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let exponentials = logits.map(|logit| (logit - peak).exp());
        let total: f32 = exponentials.iter().sum();
        let [even, odd, neither] = exponentials.map(|value| value / total);
        Self { even, odd, neither, logit: logits[0] - logits[1] }
    }
}

/// A loaded network. Loading takes milliseconds; one network serves any number of meshes and threads
/// (calls are serialised).
#[derive(Debug)]
pub struct SignNetwork {
    #[cfg(feature = "onnx")]
    runner: Runner,
}

/// Log-odds of a sign that a person is sure of: above the network's own.
const CERTAIN_LOGIT: f32 = 30.0;

/// Eigenfunctions that every input holds beside the one in question.
pub const REFERENCES: usize = 3;

/// SHA-256 of the embedded model, hexadecimal, as in `models/signnet.sha256`.
pub fn embedded_model_hash() -> &'static str {
    include_str!("../models/signnet.sha256").split_whitespace().next().unwrap_or_default()
}

#[cfg(feature = "onnx")]
impl SignNetwork {
    /// The network inside this library.
    ///
    /// It runs on the built-in interpreter, or on the ONNX Runtime library that the environment
    /// variable `ORT_DYLIB_PATH` names; the choice is made once a process, at the first call.
    ///
    /// # Errors
    /// [`Error::Model`] if the library of `ORT_DYLIB_PATH` cannot be loaded.
    pub fn embedded() -> Result<Self> {
        let runner = Runner::load(include_bytes!("../models/signnet.onnx"))
            .map_err(|message| Error::Model(format!("embedded model: {message}")))?;
        Ok(Self { runner })
    }

    /// [`SignNetwork::embedded`], loaded once a process.
    ///
    /// # Errors
    /// As [`SignNetwork::embedded`], each time.
    pub fn shared() -> Result<&'static Self> {
        static SHARED: OnceLock<std::result::Result<SignNetwork, String>> = OnceLock::new();
        let load = || Self::embedded().map_err(|error| error.to_string());
        SHARED.get_or_init(load).as_ref().map_err(|message| Error::Model(message.clone()))
    }

    /// A model of the user's own: trusted input, as it runs inside this process.
    ///
    /// It needs one float32 input `[signs, points, 4]` (columns: the first three eigenfunctions and the
    /// one in question; `signs` and `points` may be dynamic) and one float32 output `[signs, 3]`,
    /// the logits of even, odd, neither.
    ///
    /// # Errors
    /// [`Error::File`] if the file cannot be read, [`Error::Model`] if it is no such model.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let bytes = session::read_model(path)?;
        let runner =
            Runner::load(&bytes).map_err(|message| Error::Model(format!("{}: {message}", path.display())))?;
        Ok(Self { runner })
    }

    /// Parity of each of the first `k` eigenfunctions.
    ///
    /// `eigenfunctions` holds `samples` rows of `k` numbers: the eigenfunctions (constant left out, by
    /// rising eigenvalue) at points spread in proportion to area, see [`crate::sampling::area_weighted_vertices`]. Scale
    /// and sign of each column do not matter. Rows are thinned out evenly, or repeated, to the number
    /// of points that the model takes (256). Cost: `O(k * points)`, about 0.3 ms an eigenfunction.
    ///
    /// # Errors
    /// [`Error::Internal`] if the array's length is not `samples * k`, `samples` is zero, `k` is below
    /// [`REFERENCES`], or a number is not finite; [`Error::Model`] if the model fails.
    pub fn predict(&self, eigenfunctions: &[f64], samples: usize, k: usize) -> Result<Vec<SignPrediction>> {
        check_samples(eigenfunctions, samples, k)?;
        let mut predictions = Vec::with_capacity(k);
        for first in (0..k).step_by(self.runner.signs()) {
            let functions: Vec<usize> = (first..first + self.runner.signs()).map(|i| i.min(k - 1)).collect();
            let input = network_input(eigenfunctions, samples, k, &functions, self.runner.points());
            let logits = self.runner.run(input).map_err(Error::Model)?;
            predictions
                .extend(logits.iter().take(k - first).map(|&three| SignPrediction::from_logits(three)));
        }
        Ok(predictions)
    }
}

#[cfg(not(feature = "onnx"))]
impl SignNetwork {
    /// Always an error: this library was built without the feature `onnx`.
    ///
    /// # Errors
    /// [`Error::Model`], always.
    pub fn embedded() -> Result<Self> {
        Err(without_network())
    }

    /// Always an error: this library was built without the feature `onnx`.
    ///
    /// # Errors
    /// [`Error::Model`], always.
    pub fn shared() -> Result<&'static Self> {
        Err(without_network())
    }

    /// Always an error: this library was built without the feature `onnx`.
    ///
    /// # Errors
    /// [`Error::Model`], always.
    pub fn from_file(_path: impl AsRef<Path>) -> Result<Self> {
        Err(without_network())
    }

    /// Always an error: this library was built without the feature `onnx`.
    ///
    /// # Errors
    /// [`Error::Model`], always.
    pub fn predict(
        &self,
        _eigenfunctions: &[f64],
        _samples: usize,
        _k: usize,
    ) -> Result<Vec<SignPrediction>> {
        Err(without_network())
    }
}

#[cfg(not(feature = "onnx"))]
fn without_network() -> Error {
    Error::Model("this library was built without the sign network (feature `onnx`)".into())
}

#[cfg_attr(not(feature = "onnx"), allow(dead_code))]
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

/// The network's input `[functions, points, 4]` from `samples` rows thinned out evenly to `points`.
#[cfg_attr(not(feature = "onnx"), allow(dead_code))]
fn network_input(
    eigenfunctions: &[f64],
    samples: usize,
    k: usize,
    functions: &[usize],
    points: usize,
) -> Vec<f32> {
    let mut input = Vec::with_capacity(functions.len() * points * (REFERENCES + 1));
    for &function in functions {
        for point in 0..points {
            let row = &eigenfunctions[point * samples / points * k..][..k];
            input.extend(row[..REFERENCES].iter().chain([&row[function]]).map(|&value| value as f32));
        }
    }
    input
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
    fn input_repeats_the_references_and_adds_the_function() {
        let rows = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
        assert_eq!(
            network_input(&rows, 2, 4, &[3, 0], 2),
            [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 1.0, 2.0, 3.0, 1.0, 5.0, 6.0, 7.0, 5.0]
        );
    }

    #[test]
    fn wrong_lengths_are_refused() {
        assert!(check_samples(&[0.0; 7], 2, 4).is_err());
        assert!(check_samples(&[0.0; 4], 2, 2).is_err());
        assert!(check_samples(&[f64::NAN; 8], 2, 4).is_err());
        assert!(check_samples(&[0.0; 8], 2, 4).is_ok());
    }
}
