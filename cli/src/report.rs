//! The report of a detection as JSON, with where it came from.

use crate::outputs::Input;
use intrinsym::{Detection, Options, Result};
use serde_json::{Value, json};
use std::path::PathBuf;

/// The library's report with the file's name, format and notes, and the other files that were written.
pub fn json(input: &Input, detection: &Detection, options: &Options, files: &[PathBuf]) -> Result<Value> {
    let mut report = intrinsym::report::json(input.mesh, detection, options)?;
    report["input"] = json!(input.path.to_string_lossy());
    report["format"] = json!(input.file.format);
    report["notes"] = json!(input.file.notes);
    report["files"] = files.iter().map(|file| json!(file.to_string_lossy())).collect();
    Ok(report)
}
