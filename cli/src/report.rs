//! The report of a detection as JSON, with where it came from.

use crate::outputs::Input;
use intrinsym::{Detection, Options, Result};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The library's report with the file's name, format and notes, and the other files: those that were written, and those that earlier
/// runs have left beside, seen from the folder of this run.
pub fn json(
    input: &Input,
    detection: &Detection,
    options: &Options,
    files: &[PathBuf],
    left_over: &[&Path],
) -> Result<Value> {
    let mut report = intrinsym::report::json(input.mesh, detection, options)?;
    report["input"] = json!(input.path.to_string_lossy());
    report["format"] = json!(input.file.format);
    report["notes"] = json!(input.file.notes);
    report["files"] = files.iter().map(|file| json!(file.to_string_lossy())).collect();
    report["left_over"] = left_over.iter().map(|file| json!(file.to_string_lossy())).collect();
    report["folder"] = json!(std::env::current_dir().unwrap_or_default().to_string_lossy());
    Ok(report)
}
