//! The command line as its users meet it: exit status, messages, and the files it leaves.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const FOUND: Option<i32> = Some(0);
const NONE: Option<i32> = Some(1);
const FAILED: Option<i32> = Some(2);
const DOUBTFUL: Option<i32> = Some(3);

/// A folder of the test's own, emptied at the start.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("command_line").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name)
}

fn command() -> Command {
    Command::new(env!("CARGO_BIN_EXE_intrinsym"))
}

fn run<A: AsRef<std::ffi::OsStr>>(arguments: &[A]) -> Output {
    command().args(arguments).output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// One number per line.
fn numbers(path: &Path) -> Vec<i64> {
    std::fs::read_to_string(path).unwrap().lines().map(|line| line.parse().unwrap()).collect()
}

#[path = "command_line/detect.rs"]
mod detect;
#[path = "command_line/files.rs"]
mod files;
#[path = "command_line/info_and_eigen.rs"]
mod info_and_eigen;
#[path = "command_line/manual.rs"]
mod manual;
#[path = "command_line/mistakes.rs"]
mod mistakes;
