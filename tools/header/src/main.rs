//! `include/isym.h` is what cbindgen makes of `capi/src`: checks that, or with `--write` makes it.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

const INTRODUCTION: &str = "\
/// @file
/// Intrinsym: the intrinsic mirror symmetry of a surface mesh. This is the C library's only header.
///
/// Made by cbindgen from capi/src (`make header`); do not edit. The comments are Doxygen's.
///
/// Every function that can fail returns an isym_status: ISYM_OK, or a code and, in this thread, a text
/// (isym_error_message). On failure nothing is written. Any call may answer, beside the codes that stand with it,
/// ISYM_ERROR_NULL, ISYM_ERROR_HANDLE, ISYM_ERROR_LENGTH, ISYM_ERROR_ALIGNMENT, ISYM_ERROR_TEXT and ISYM_ERROR_INTERNAL.
///
/// A NULL is an error, but for user_data, for options (the defaults), for progress (none), and for what is freed. Sizes of
/// arrays are in elements. The first field of each struct is its size: set it to sizeof before the call.
///
/// Handles come from functions whose last argument is a pointer to one, and are freed by the function of their kind; a freed
/// handle is an error and no crash. Functions may be called from several threads at once, on the same handles too.
";

/// The repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The library's version, from its manifest.
fn version() -> String {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("Cargo.toml");
    let line = manifest.lines().find_map(|line| line.strip_prefix("version = \""));
    line.and_then(|rest| rest.split('"').next()).expect("a version in Cargo.toml").to_string()
}

/// The sources in the order in which the header reads best.
fn sources() -> [PathBuf; 9] {
    ["version", "status", "panic_boundary", "options", "progress", "mesh", "result", "tools", "eigen"]
        .map(|name| root().join(format!("capi/src/{name}.rs")))
}

const EXPORT_MACRO: &str = "
/// What stands before each function. Programs that link the static library on Windows define ISYM_STATIC.
#ifndef ISYM_API
#if defined(_WIN32) && !defined(ISYM_STATIC)
#define ISYM_API __declspec(dllimport)
#elif defined(__GNUC__)
#define ISYM_API __attribute__((visibility(\"default\")))
#else
#define ISYM_API
#endif
#endif
";

fn version_macros() -> String {
    let version = version();
    let mut text = format!(
        "\n/// The version of this header; isym_version() is the version of the library that is running.\n\
         #define ISYM_VERSION \"{version}\"\n"
    );
    for (name, part) in ["MAJOR", "MINOR", "PATCH"].into_iter().zip(version.split(['.', '-'])) {
        text += &format!("#define ISYM_VERSION_{name} {part}\n");
    }
    text
}

fn generated() -> String {
    let config = cbindgen::Config::from_file(root().join("cbindgen.toml")).expect("cbindgen.toml");
    let mut builder = cbindgen::Builder::new()
        .with_config(config)
        .with_header(INTRODUCTION)
        .with_after_include(version_macros() + EXPORT_MACRO);
    for source in sources() {
        builder = builder.with_src(source);
    }
    builder = builder.with_src(root().join("capi/src/handles.rs"));
    let mut text = Vec::new();
    builder.generate().expect("capi/src can be read").write(&mut text);
    String::from_utf8(text).unwrap()
}

/// The names of all functions that `capi/src` exports.
fn exported() -> Vec<String> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(root().join("capi/src")).expect("capi/src") {
        let source = std::fs::read_to_string(entry.expect("a file").path()).expect("a source file");
        let starts = source.match_indices("extern \"C\" fn ").map(|(at, text)| at + text.len());
        names.extend(starts.filter_map(|start| source[start..].split('(').next()).map(str::to_string));
    }
    names.retain(|name| name.starts_with("isym_"));
    names
}

/// What is wrong with the header that is kept.
fn complaint(generated: &str, kept: &str) -> Option<String> {
    let names = exported();
    assert!(names.len() > 30, "only {} functions were found", names.len());
    if let Some(name) = names.iter().find(|name| !generated.contains(&format!("{name}("))) {
        return Some(format!("{name} is exported and not in the header: is its file in `sources`?"));
    }
    let line = kept.lines().zip(generated.lines()).position(|(kept, made)| kept != made);
    let line = line.unwrap_or_else(|| kept.lines().count().min(generated.lines().count())) + 1;
    (kept != generated).then(|| format!("include/isym.h is stale from line {line} on: make header"))
}

fn main() -> ExitCode {
    let path = root().join("include/isym.h");
    let generated = generated();
    if std::env::args().nth(1).as_deref() == Some("--write") {
        std::fs::write(&path, &generated).expect("include/isym.h can be written");
    }
    match complaint(&generated, &std::fs::read_to_string(&path).unwrap_or_default()) {
        Some(complaint) => {
            eprintln!("{complaint}");
            ExitCode::FAILURE
        }
        None => ExitCode::SUCCESS,
    }
}
