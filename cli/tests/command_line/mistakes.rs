//! What a user may get wrong: each is answered with status 2 and a message that says what to change.

use super::*;

#[track_caller]
fn refused(arguments: &[&str], expected: &str) {
    let output = run(arguments);
    assert_eq!(output.status.code(), FAILED, "{arguments:?}: {}", stderr(&output));
    assert!(stderr(&output).contains(expected), "{arguments:?}: {}", stderr(&output));
    assert_eq!(stdout(&output), "");
}

#[test]
fn numeric_options_name_their_range() {
    refused(&["detect", "in.ply", "--eigenfunctions", "11"], "11 is not in 12..=200");
    refused(&["detect", "in.ply", "--effort", "hard"], "[possible values: fast, default, thorough]");
    refused(&["detect", "in.ply", "--symmetries", "0"], "0 is not in 1..=32");
    refused(&["detect", "in.ply", "--beam-width", "wide"], "expected a whole number in 1..=256");
    refused(&["detect", "in.ply", "--time-limit", "0.5"], "expected a whole number in 1..=1000000");
    refused(&["eigen", "in.ply", "-k", "0"], "0 is not in 1..=1000");
}

#[test]
fn help_shows_the_shared_table() {
    let help = stdout(&run(&["detect", "--help"]));
    let flat = help.split_whitespace().collect::<Vec<_>>().join(" ");
    for spec in &intrinsym::OPTIONS {
        assert!(flat.contains(&format!("--{}", spec.name.replace('_', "-"))), "{help}");
        if spec.choices.is_empty() {
            let range = format!("{} Range {}..={}", spec.help, spec.minimum, spec.maximum);
            assert!(flat.contains(&range), "{help}");
            assert!(flat.contains(&format!("[default: {}]", spec.default)), "{help}");
        } else {
            assert!(flat.contains(spec.help), "{help}");
            assert!(flat.contains(&format!("[default: {}]", spec.choices[spec.default])), "{help}");
            assert!(flat.contains(&format!("[possible values: {}]", spec.choices.join(", "))), "{help}");
        }
    }
    assert!(
        help.contains("0 found (or done), 3 doubtful (the files are written), 1 no symmetry found, 2 error, 130 interrupted, 141 nobody reads")
    );
}

#[test]
fn the_mesh_is_written_as_ply_or_glb_only() {
    refused(&["detect", "in.ply", "-o", "out.obj"], "name the file something.ply or something.glb");
    refused(&["eigen", "in.ply", "-o", "out.csv"], "name the file something.npz");
    refused(&["detect", "in.ply", "--picture", "out.jpg"], "name the file something.png");
    refused(&["detect", "in.ply", "--json", "-"], "for standard output give /dev/stdout");
}

#[test]
fn a_missing_file_is_named() {
    refused(&["detect", "no/such.ply"], "no/such.ply: cannot be read");
    refused(&["info", "no/such.ply"], "no/such.ply: cannot be read");
}

#[test]
fn a_model_that_cannot_be_read_is_named() {
    let input = example("quadruped.ply");
    let arguments = ["detect", input.to_str().unwrap(), "--model", "no/such.onnx"];
    refused(&arguments, "the sign network's model cannot be used: no/such.onnx: cannot be read");
}

#[test]
#[cfg(feature = "onnx")]
fn a_model_of_ones_own_needs_onnx_runtime() {
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/signnet.onnx");
    let arguments = ["detect".into(), example("quadruped.ply"), "--model".into(), model];
    let output = command().args(arguments).env("ORT_DYLIB_PATH", "no/such/library.so").output().unwrap();
    assert_eq!(output.status.code(), FAILED);
    for expected in ["signnet.onnx", "no/such/library.so", "set ORT_DYLIB_PATH to"] {
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}

#[test]
fn a_bad_mesh_names_the_file_and_the_element() {
    let path = folder("bad").join("index.off");
    std::fs::write(&path, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n").unwrap();
    let path = path.to_str().unwrap();
    for subcommand in ["detect", "info", "eigen"] {
        refused(&[subcommand, path], "index.off: the mesh cannot be used: ");
        refused(&[subcommand, path], "vertex 7");
    }
}

#[test]
fn limits_can_be_set_and_say_what_was_found() {
    let path = example("blob.ply");
    refused(&["info", path.to_str().unwrap(), "--max-vertices", "100"], "3174 exceeds the limit of 100");
    let path = folder("limits").join("a.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nf 1 2 3\nv 0 1 0\n v 0 0 1\nvn 0 0 1\nf 1 2 4\nf 1 3 4\n")
        .unwrap();
    let path = path.to_str().unwrap();
    refused(&["info", path, "--max-vertices", "1"], "the number of vertices 4 exceeds the limit of 1");
    refused(&["info", path, "--max-faces", "1"], "the number of faces 3 exceeds the limit of 1");
}

#[test]
fn several_inputs_need_a_folder_and_distinct_names() {
    refused(&["detect", "a.ply", "b.ply", "--map", "out.map"], "several inputs need --output-dir");
    let out = folder("distinct");
    let out = out.to_str().unwrap();
    refused(
        &["detect", "a/x.ply", "b/x.ply", "--output-dir", out],
        "x.ply would be both the mesh of a/x.ply and",
    );
    refused(&["detect", "a.ply", "--map", "a.map", "--output-dir", out], "cannot be used with");
}
