//! The sign network: the files' hashes, the embedded network against the training framework, its invariances; and models
//! of one's own, whose tests need an ONNX Runtime and run by `make train-test`.

use std::path::PathBuf;

use intrinsym::internals::search::sign_network::{SIGNS, SignNetwork, SignPrediction};
use intrinsym::{Error, Limits, Mesh, Options, Progress, detect, detect_again, io};
use proptest::prelude::*;
use sha2::{Digest, Sha256};

const K: usize = SIGNS;

fn model_file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("models").join(name)
}

/// The made-up eigenfunctions of `reference_rows` in `training/export.py`, row-major.
fn reference_rows(points: usize) -> Vec<f64> {
    let value = |p: f64, j: f64| (0.1 * (j + 1.0) * p + j).sin() + 0.25 * (0.017 * (j + 2.0) * p).cos();
    (0..points * K).map(|at| value((at / K) as f64, (at % K) as f64)).collect()
}

fn largest_difference(first: &[SignPrediction], second: &[SignPrediction]) -> f32 {
    let parts = |p: &SignPrediction| [p.even, p.odd, p.neither, p.logit];
    let pairs = first.iter().zip(second);
    pairs
        .flat_map(|(a, b)| parts(a).into_iter().zip(parts(b)))
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max)
}

#[test]
fn the_models_files_have_the_pinned_hashes() {
    let pinned = std::fs::read_to_string(model_file("signnet.sha256")).unwrap();
    assert_eq!(pinned.lines().count(), 2);
    for (line, wanted) in pinned.lines().zip(["signnet.onnx", "signnet.weights"]) {
        let bytes = std::fs::read(model_file(wanted)).unwrap();
        let hash: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(line, format!("{hash}  {wanted}"));
    }
}

#[test]
fn the_embedded_model_gives_the_frameworks_numbers() {
    let text = std::fs::read_to_string(model_file("signnet.reference.json")).unwrap();
    let stored: serde_json::Value = serde_json::from_str(&text).unwrap();
    let points = stored["points"].as_u64().unwrap() as usize;
    let predictions = SignNetwork::embedded().predict(&reference_rows(points), points, K).unwrap();
    for (prediction, logits) in predictions.iter().zip(stored["logits"].as_array().unwrap()) {
        let wanted: Vec<f64> =
            logits.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
        assert!((f64::from(prediction.logit) - (wanted[0] - wanted[1])).abs() < 1e-5);
        let total: f64 = wanted.iter().map(|logit| logit.exp()).sum();
        assert!((f64::from(prediction.neither) - wanted[2].exp() / total).abs() < 1e-5);
    }
    assert_eq!(predictions.len(), K);
}

#[test]
#[ignore = "needs ORT_DYLIB_PATH: make train-test"]
fn a_model_file_and_the_embedded_model_agree() {
    let own = SignNetwork::from_file(model_file("signnet.onnx")).unwrap();
    for (samples, k) in [(700, K), (256, 3), (100, 23)] {
        let rows: Vec<f64> = reference_rows(samples * 2).into_iter().take(samples * k).collect();
        let embedded = SignNetwork::embedded().predict(&rows, samples, k).unwrap();
        assert!(largest_difference(&embedded, &own.predict(&rows, samples, k).unwrap()) < 1e-5);
    }
}

#[test]
fn any_number_of_eigenfunctions_is_answered() {
    let network = SignNetwork::embedded();
    let rows = reference_rows(512);
    let all = network.predict(&rows, 512, K).unwrap();
    for k in [3, 5] {
        let fewer: Vec<f64> = rows.chunks(K).flat_map(|row| row[..k].to_vec()).collect();
        assert!(largest_difference(&network.predict(&fewer, 512, k).unwrap(), &all[..k]) < 1e-5);
    }
    let more: Vec<f64> = rows.chunks(K).flat_map(|row| [row, row].concat()).collect();
    let answers = network.predict(&more, 512, 2 * K).unwrap();
    assert!(largest_difference(&answers[..K], &all) < 1e-5);
    assert!(largest_difference(&answers[K..], &all) < 1e-5);
}

#[test]
fn wrong_arrays_are_refused() {
    let network = SignNetwork::embedded();
    assert!(matches!(network.predict(&[0.0; 10], 2, 4), Err(Error::Internal(_))));
    assert!(matches!(network.predict(&[f64::INFINITY; 8], 2, 4), Err(Error::Internal(_))));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    /// The signs of the eigenfunctions are arbitrary, so the answer must not depend on them.
    #[test]
    fn signs_and_scales_change_nothing(
        rows in prop::collection::vec(-2.0..2.0f64, 64 * K),
        flips in prop::collection::vec(any::<bool>(), K),
        power in -8..8i32,
    ) {
        let network = SignNetwork::embedded();
        let scale = f64::from(power).exp2();
        let flipped: Vec<f64> =
            rows.iter().enumerate().map(|(at, value)| if flips[at % K] { -value } else { *value } * scale).collect();
        let before = network.predict(&rows, 64, K).unwrap();
        let after = network.predict(&flipped, 64, K).unwrap();
        prop_assert!(largest_difference(&before, &after) <= 1e-5);
    }
}

/// Its connectivity is mirrored, so that its detection needs no network.
#[test]
fn what_is_no_model_is_refused_where_none_is_needed() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let file = io::read(&root.join("examples/human.ply"), &Limits::default()).unwrap();
    let mesh = Mesh::new(&file.polygons, &Limits::default()).unwrap();
    let found = detect(&mesh, &Options::default(), &Progress::default()).unwrap();
    for path in [root.join("README.md"), root.join("examples")] {
        let options = Options { model: Some(path.clone()), ..Options::default() };
        let answers = [
            detect(&mesh, &options, &Progress::default()),
            detect_again(&mesh, &found, &options, &Progress::default()),
        ];
        for answer in answers {
            let message = answer.expect_err("it is an error").to_string();
            assert!(message.contains(path.to_str().unwrap()), "{message}");
        }
        let options = Options { network: false, ..options };
        detect(&mesh, &options, &Progress::default()).unwrap();
    }
}

fn refusal(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/models").join(name);
    match SignNetwork::from_file(path) {
        Err(Error::Model(message)) => message,
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
#[ignore = "needs ORT_DYLIB_PATH: make train-test"]
fn unusable_models_are_refused_with_the_reason() {
    assert!(refusal("wrong_channels.onnx").contains("[signs, points, 4] is wanted"));
    assert!(refusal("wrong_rank.onnx").contains("[signs, points, 4] is wanted"));
    assert!(refusal("wrong_answers.onnx").contains("[12, 3] is wanted"));
    assert!(refusal("wrong_type.onnx").contains("float32"));
    assert!(refusal("two_inputs.onnx").contains("2 inputs"));
    assert!(refusal("unknown_operator.onnx").contains("unknown_operator.onnx"));
}

#[test]
#[ignore = "needs ORT_DYLIB_PATH: make train-test"]
fn broken_bytes_are_refused() {
    let folder = std::env::temp_dir().join(format!("intrinsym-model-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let whole = std::fs::read(model_file("signnet.onnx")).unwrap();
    for (name, bytes) in
        [("empty", &whole[..0]), ("short", &whole[..whole.len() / 2]), ("text", b"not a model")]
    {
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        assert!(matches!(SignNetwork::from_file(&path), Err(Error::Model(_))), "{name}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
    let Err(Error::Model(message)) = SignNetwork::from_file(folder.join("gone")) else {
        panic!("a model's error")
    };
    assert!(message.contains("gone"), "{message}");
}
