//! The ONNX session behind [`super::SignNetwork`]: choice of runtime, checks of a model, one run.
//!
//! Two runtimes stand behind the same interface (`ort`): tract, in Rust and linked in, and any ONNX
//! Runtime shared library that the user names. The reasons are in `docs/sign_network.md`.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};

use ort::environment::Environment;
use ort::session::Session;
use ort::session::builder::GraphOptimizationLevel;
use ort::value::{Tensor, TensorElementType, ValueType};

use crate::error::{Error, Result};

/// Eigenfunctions answered at once if the model leaves the number open.
const DEFAULT_SIGNS: i64 = 12;
/// Points if the model leaves the number open.
const DEFAULT_POINTS: i64 = 512;
/// Numbers per point: three references and the function in question.
const CHANNELS: i64 = super::REFERENCES as i64 + 1;
/// Answers per eigenfunction: even, odd, neither.
const ANSWERS: i64 = 3;
/// Bounds on the sizes a model may ask for.
const MOST_SIGNS: i64 = 1024;
const MOST_POINTS: i64 = 1 << 16;
/// Largest model file that is read, in bytes (the paper's own network has 9 MB).
const MOST_BYTES: u64 = 256 << 20;

/// A session with the sizes of its input.
pub(super) struct Runner {
    session: Mutex<Session>,
    signs: i64,
    points: i64,
}

impl fmt::Debug for Runner {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Runner").field("signs", &self.signs).field("points", &self.points).finish()
    }
}

impl Runner {
    /// Parses, checks and optimises a model; the error says what is wrong with it.
    pub(super) fn load(model: &[u8]) -> Result<Self, String> {
        let session = Session::builder(runtime()?)
            .map_err(|fault| fault.to_string())?
            .with_optimization_level(GraphOptimizationLevel::Level3)
            .map_err(|fault| fault.to_string())?
            .with_intra_threads(1) // tract has no such setting, and never more than one thread
            .unwrap_or_else(|fault| fault.recover())
            .commit_from_memory(model)
            .map_err(|fault| format!("it is not a model that can be run: {fault}"))?;
        let (signs, points) = input_sizes(&session)?;
        check_output(&session, signs)?;
        Ok(Self { session: Mutex::new(session), signs, points })
    }

    /// Eigenfunctions answered by one run.
    pub(super) fn signs(&self) -> usize {
        self.signs as usize
    }

    /// Points of the input.
    pub(super) fn points(&self) -> usize {
        self.points as usize
    }

    /// Logits (even, odd, neither) of each of the `signs` rows of the input `[signs, points, 4]`.
    pub(super) fn run(&self, input: Vec<f32>) -> Result<Vec<[f32; 3]>, String> {
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

/// The runtime of this process, chosen at the first call.
fn runtime() -> Result<&'static Environment, String> {
    static RUNTIME: OnceLock<Result<Environment, String>> = OnceLock::new();
    RUNTIME.get_or_init(choose_runtime).as_ref().map_err(Clone::clone)
}

fn choose_runtime() -> Result<Environment, String> {
    let builder = match std::env::var_os("ORT_DYLIB_PATH").filter(|path| !path.is_empty()) {
        Some(path) => ort::init_from(PathBuf::from(path))
            .map_err(|fault| format!("the ONNX Runtime library of ORT_DYLIB_PATH cannot be used: {fault}"))?,
        None => {
            ort::set_api(ort_tract::api());
            ort::init()
        }
    };
    builder.with_telemetry(false).build().map_err(|fault| format!("the ONNX runtime does not start: {fault}"))
}

/// Reads a model file of at most [`MOST_BYTES`].
pub(super) fn read_model(path: &Path) -> Result<Vec<u8>> {
    let failed = |fault: std::io::Error| Error::File { path: path.into(), message: fault.to_string() };
    let size = std::fs::metadata(path).map_err(failed)?.len();
    if size > MOST_BYTES {
        return Err(Error::Limit { what: "the size of the model file", found: size, limit: MOST_BYTES });
    }
    std::fs::read(path).map_err(failed)
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
    let signs = if signs < 0 { DEFAULT_SIGNS } else { signs };
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
