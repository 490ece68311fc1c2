//! Every file under `tests/data/bad` and what becomes of it, listed in `expected.json` there.
//!
//! A file either has an `error`, its whole message with the file's name for the path, or is read: then every
//! repair that is not zero is listed, and every note; `orientable` is given where a shell is not.

use intrinsym::{Limits, Mesh, io};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/bad")
}

fn expected() -> Map<String, Value> {
    let text = std::fs::read_to_string(folder().join("expected.json")).expect("the manifest");
    serde_json::from_str(&text).expect("a JSON object")
}

/// What becomes of a file, in the manifest's form.
fn outcome(name: &str) -> Value {
    let path = folder().join(name);
    let limits = Limits::default();
    let result =
        io::read(&path, &limits).and_then(|file| Ok((Mesh::new(&file.polygons, &limits)?, file.notes)));
    match result {
        Err(error) => json!({ "error": error.to_string().replace(&path.display().to_string(), name) }),
        Ok((mesh, notes)) => {
            let Ok(Value::Object(mut outcome)) = serde_json::to_value(&mesh.repairs) else {
                panic!("the report is an object")
            };
            outcome.retain(|_, count| *count != json!(0));
            if !notes.is_empty() {
                outcome.insert("notes".into(), json!(notes));
            }
            if mesh.shell_orientable.contains(&false) {
                outcome.insert("orientable".into(), json!(mesh.shell_orientable));
            }
            Value::Object(outcome)
        }
    }
}

#[test]
fn every_bad_file_gets_its_message_or_repair() {
    for (name, expected) in expected() {
        assert_eq!(outcome(&name), expected, "{name}");
    }
}

#[test]
fn every_bad_file_is_listed() {
    let listed = expected();
    let files =
        std::fs::read_dir(folder()).expect("the folder").map(|entry| entry.expect("an entry").file_name());
    let unlisted: Vec<_> = files
        .filter_map(|name| name.into_string().ok())
        .filter(|name| name != "expected.json" && !listed.contains_key(name))
        .collect();
    assert!(unlisted.is_empty(), "not in expected.json: {unlisted:?}");
}

#[test]
fn a_missing_file_is_named() {
    let error = io::read(Path::new("no/such/mesh.ply"), &Limits::default()).unwrap_err().to_string();
    assert!(error.starts_with("no/such/mesh.ply: cannot be read: "), "{error}");
}
