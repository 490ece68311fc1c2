//! A sign network of the user's own in an ONNX Runtime library: finding the library, checks of the model, one run.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fmt;
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock};

use ort::environment::Environment;
use ort::session::Session;
use ort::session::builder::GraphOptimizationLevel;
use ort::value::{Tensor, TensorElementType, ValueType};

use super::{REFERENCES, SIGNS};

/// Points if the model leaves the number open.
const DEFAULT_POINTS: i64 = 512;
/// Numbers per point: three references and the function in question.
const CHANNELS: i64 = REFERENCES as i64 + 1;
/// Answers per eigenfunction: even, odd, neither.
const ANSWERS: i64 = 3;
/// Bounds on the sizes a model may ask for.
const MOST_SIGNS: i64 = 1024;
const MOST_POINTS: i64 = 1 << 16;
/// What to do where no library is found.
const REMEDY: &str = "set ORT_DYLIB_PATH to the file of its library, version 1.24 or newer \
                      (`pip install onnxruntime` brings one: onnxruntime/capi/libonnxruntime.so.*)";

/// A session with the sizes of its input.
pub(super) struct OwnModel {
    session: Mutex<Session>,
    signs: i64,
    points: i64,
}

impl fmt::Debug for OwnModel {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("OwnModel").field("signs", &self.signs).field("points", &self.points).finish()
    }
}

impl OwnModel {
    /// Parses, checks and optimises a model; the error says what is wrong with it.
    pub(super) fn load(model: &[u8]) -> Result<Self, String> {
        let session = Session::builder(runtime()?)
            .map_err(|fault| fault.to_string())?
            .with_optimization_level(GraphOptimizationLevel::Level3)
            .map_err(|fault| fault.to_string())?
            .with_intra_threads(1)
            .map_err(|fault| fault.to_string())?
            .commit_from_memory(model)
            .map_err(|fault| format!("it is not a model that can be run: {fault}"))?;
        let (signs, points) = input_sizes(&session)?;
        check_output(&session, signs)?;
        Ok(Self { session: Mutex::new(session), signs, points })
    }

    /// Points of the input.
    pub(super) fn points(&self) -> usize {
        self.points as usize
    }

    /// Logits (even, odd, neither) of each of `k` eigenfunctions; `values` has [`OwnModel::points`] rows of `k` numbers.
    pub(super) fn logits(&self, values: &[f64], k: usize) -> Result<Vec<[f32; 3]>, String> {
        let mut logits = Vec::with_capacity(k);
        for first in (0..k).step_by(self.signs as usize) {
            let functions = (first..first + self.signs as usize).map(|function| function.min(k - 1));
            let answers = self.run(network_input(values, k, functions))?;
            logits.extend(answers.into_iter().take(k - first));
        }
        Ok(logits)
    }

    /// Logits of each of the `signs` rows of the input `[signs, points, 4]`.
    fn run(&self, input: Vec<f32>) -> Result<Vec<[f32; 3]>, String> {
        let tensor = Tensor::from_array(([self.signs, self.points, CHANNELS], input))
            .map_err(|fault| fault.to_string())?;
        let mut session = self.session.lock().map_err(|_| "an earlier call failed midway".to_string())?;
        let outputs = session.run(ort::inputs![tensor]).map_err(|fault| fault.to_string())?;
        let (shape, logits) = outputs[0].try_extract_tensor::<f32>().map_err(|fault| fault.to_string())?;
        if **shape != [self.signs, ANSWERS] {
            return Err(format!("it returned shape {shape:?}, [{}, {ANSWERS}] is wanted", self.signs));
        }
        if logits.iter().any(|value| !value.is_finite()) {
            return Err("it returned numbers that are not finite".into());
        }
        Ok(logits.chunks_exact(3).map(|three| [three[0], three[1], three[2]]).collect())
    }
}

/// The input `[functions, points, 4]`: at each point the references and the function in question.
fn network_input(values: &[f64], k: usize, functions: impl Iterator<Item = usize>) -> Vec<f32> {
    let of = |function| {
        values.chunks_exact(k).flat_map(move |row| row[..REFERENCES].iter().chain([&row[function]]))
    };
    functions.flat_map(of).map(|&value| value as f32).collect()
}

/// The ONNX Runtime library of this process, loaded at the first call.
fn runtime() -> Result<&'static Environment, String> {
    static RUNTIME: OnceLock<Result<Environment, String>> = OnceLock::new();
    RUNTIME.get_or_init(load_runtime).as_ref().map_err(Clone::clone)
}

/// Loads the library that `ORT_DYLIB_PATH` names, else the one that the system finds by its usual name.
fn load_runtime() -> Result<Environment, String> {
    let named = std::env::var_os("ORT_DYLIB_PATH").filter(|path| !path.is_empty());
    let library = named.unwrap_or_else(|| format!("{DLL_PREFIX}onnxruntime{DLL_SUFFIX}").into());
    ort::init_from(PathBuf::from(library))
        .map_err(|fault| format!("a model of your own needs ONNX Runtime: {fault}; {REMEDY}"))?
        .with_telemetry(false)
        .build()
        .map_err(|fault| format!("ONNX Runtime does not start: {fault}"))
}

/// `signs` and `points` of the model's only input, defaults where the model leaves them open.
fn input_sizes(session: &Session) -> Result<(i64, i64), String> {
    let [input] = session.inputs() else {
        return Err(format!("it has {} inputs, one is wanted", session.inputs().len()));
    };
    let shape = float_shape("input", input.dtype())?;
    let [signs, points, channels] = shape[..] else {
        return Err(format!("its input has shape {shape:?}, [signs, points, {CHANNELS}] is wanted"));
    };
    let signs = if signs < 0 { SIGNS as i64 } else { signs };
    let points = if points < 0 { DEFAULT_POINTS } else { points };
    let fits = (1..=MOST_SIGNS).contains(&signs) && (1..=MOST_POINTS).contains(&points);
    if !fits || (channels >= 0 && channels != CHANNELS) {
        return Err(format!("its input has shape {shape:?}, [signs, points, {CHANNELS}] is wanted"));
    }
    Ok((signs, points))
}

fn check_output(session: &Session, signs: i64) -> Result<(), String> {
    let [output] = session.outputs() else {
        return Err(format!("it has {} outputs, one is wanted", session.outputs().len()));
    };
    let shape = float_shape("output", output.dtype())?;
    let fits = |size: i64, wanted: i64| size < 0 || size == wanted;
    match shape[..] {
        [rows, answers] if fits(rows, signs) && fits(answers, ANSWERS) => Ok(()),
        _ => Err(format!("its output has shape {shape:?}, [{signs}, {ANSWERS}] is wanted")),
    }
}

fn float_shape(which: &str, kind: &ValueType) -> Result<Vec<i64>, String> {
    match kind {
        ValueType::Tensor { ty: TensorElementType::Float32, shape, .. } => Ok(shape.to_vec()),
        other => Err(format!("its {which} is {other}, a float32 tensor is wanted")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn input_repeats_the_references_and_adds_the_function() {
        let rows = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
        assert_eq!(
            network_input(&rows, 4, [3, 0].into_iter()),
            [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 1.0, 2.0, 3.0, 1.0, 5.0, 6.0, 7.0, 5.0]
        );
    }
}
