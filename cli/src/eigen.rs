//! `intrinsym eigen`: eigenvalues as text, and everything as a NumPy archive.

use crate::Ending;
use crate::arguments::Eigen as Arguments;
use crate::numpy_archive::{Array, archive};
use crate::targets::{self, Claims};
use crate::terminal;
use intrinsym::internals::base::atomic_file::write_atomically;
use intrinsym::{CancelToken, Eigen, Mesh, Progress, Result, eigen};

/// Runs the command.
pub fn run(arguments: &Arguments, token: &CancelToken) -> Ending {
    if let Err(message) = check_target(arguments) {
        eprintln!("intrinsym: {message}");
        return Ending::Failed;
    }
    match compute(arguments, token) {
        Ok(text) => terminal::answer(&text, arguments.common.quiet),
        Err(error) => terminal::complain(&arguments.input, &error),
    }
}

/// Refuses an archive that would take the place of the input, or of a file that this program has not written.
fn check_target(arguments: &Arguments) -> std::result::Result<(), String> {
    let Some(path) = &arguments.output else { return Ok(()) };
    Claims::of_inputs([&arguments.input]).claim(path, "the archive".into())?;
    let stands = path.exists() && !arguments.force && !targets::is_our_archive(path);
    if stands { Err(targets::exists(path)) } else { Ok(()) }
}

/// Computes, writes the archive if one was asked for, and gives back the text for stdout.
fn compute(arguments: &Arguments, token: &CancelToken) -> Result<String> {
    let bar = terminal::progress_bar(1000, arguments.common.quiet);
    let show = |stage: &str, fraction: f64| {
        bar.set_message(stage.to_string());
        bar.set_position((1000.0 * fraction) as u64);
    };
    let progress = Progress::new(Some(&show), token.clone());
    let limits = arguments.common.limits();
    progress.report("reading", 0.0)?;
    let file = arguments.common.read(&arguments.input)?;
    let mesh = Mesh::new(&file.polygons, &limits)?;
    let result = eigen(&mesh, usize::from(arguments.count), &progress)?;
    bar.finish_and_clear();
    let mut text: String = result.eigenvalues.iter().map(|value| format!("{value:.9e}\n")).collect();
    if let Some(path) = &arguments.output {
        write_atomically(path, |out| out.write_all(&archive_of(&result)?))?;
        text = format!("wrote {}: {} eigenvalues\n", path.display(), result.eigenvalues.len());
    }
    Ok(text)
}

/// The archive's bytes: `eigenvalues`, `eigenfunctions` and `mass`.
fn archive_of(eigen: &Eigen) -> std::io::Result<Vec<u8>> {
    let (count, vertices) = (eigen.eigenvalues.len(), eigen.lumped_mass.len());
    archive(&[
        Array { name: "eigenvalues", shape: &[count], values: &eigen.eigenvalues },
        Array { name: "eigenfunctions", shape: &[vertices, count], values: &eigen.eigenfunctions },
        Array { name: "mass", shape: &[vertices], values: &eigen.lumped_mass },
    ])
}
