//! The report of a detection as JSON, with where it came from.

use crate::outputs::Input;
use intrinsym::base::error::Result;
use intrinsym::base::options::Options;
use intrinsym::detect::driver::Detection;
use serde_json::{Value, json};

/// The library's report with the file's name, format and notes.
pub fn json(input: &Input, detection: &Detection, options: &Options) -> Result<Value> {
    let mut report = intrinsym::detect::report::json(input.mesh, detection, options)?;
    report["input"] = json!(input.path.to_string_lossy());
    report["format"] = json!(input.file.format);
    report["notes"] = json!(input.file.notes);
    Ok(report)
}
