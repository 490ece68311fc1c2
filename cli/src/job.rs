//! One mesh from its file to its result files.

use crate::Ending;
use crate::arguments::Detect;
use crate::outputs::{Input, Outputs};
use intrinsym::{Detection, Mesh, Outcome, Progress, Result, detect};
use std::path::{Path, PathBuf};

/// What is left of a finished job.
pub struct Finished {
    /// Found, doubtful or none.
    pub ending: Ending,
    /// The mesh, for lengths in the caller's unit.
    pub mesh: Mesh,
    /// The result.
    pub detection: Detection,
    /// What the reader did that a user may want to know.
    pub notes: Vec<String>,
    /// The files that hold it.
    pub written: Vec<PathBuf>,
}

/// Reads, detects and writes. Nothing is written unless the detection ran to its end.
///
/// # Errors
/// Whatever the file, the mesh, the limits or the caller's cancel call for.
pub fn run(path: &Path, outputs: &Outputs, arguments: &Detect, progress: &Progress) -> Result<Finished> {
    let limits = arguments.common.limits();
    progress.report("reading", 0.0)?;
    let file = arguments.common.read(path)?;
    let mesh = Mesh::new(&file.polygons, &limits)?;
    let detection = detect(&mesh, &arguments.options(), progress)?;
    progress.report("writing", 1.0)?;
    let input = Input { path, file: &file, mesh: &mesh };
    let written = outputs.write(&input, &detection, arguments)?;
    let ending = match detection.outcome {
        Outcome::Found => Ending::Found,
        Outcome::Doubtful => Ending::Doubtful,
        Outcome::None => Ending::None,
    };
    Ok(Finished { ending, mesh, detection, notes: file.notes, written })
}
