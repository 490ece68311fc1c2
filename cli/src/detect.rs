//! `intrinsym detect`: one mesh with a full summary, or many with a line each.

use crate::Ending;
use crate::arguments::Detect;
use crate::job::{self, Finished};
use crate::outputs::Outputs;
use crate::{summary, targets, terminal};
use indicatif::ProgressBar;
use intrinsym::{CancelToken, Error, Progress, Result};
use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Runs the command.
pub fn run(arguments: &Detect, token: &CancelToken) -> Ending {
    let outputs = match Outputs::of_all(arguments) {
        Ok(outputs) => outputs,
        Err(message) => {
            eprintln!("intrinsym: {message}");
            return Ending::Failed;
        }
    };
    if let Some(folder) = &arguments.output_dir
        && let Err(error) = std::fs::create_dir_all(folder)
    {
        eprintln!("intrinsym: {}: the folder cannot be made: {error}", folder.display());
        return Ending::Failed;
    }
    let ending = match (&arguments.inputs[..], &outputs[..]) {
        ([input], [outputs]) => run_one(input, outputs, arguments, token).unwrap_or_else(|stopped| stopped),
        (_, outputs) => run_many(outputs, arguments, token),
    };
    if let Some(folder) = arguments.output_dir.as_ref().filter(|_| !arguments.common.quiet) {
        say_what_else_is_in(folder, arguments);
    }
    ending
}

/// How one mesh ended; an error ends the whole run.
type Step = Result<Ending, Ending>;

fn run_one(input: &Path, outputs: &Outputs, arguments: &Detect, token: &CancelToken) -> Step {
    let bar = terminal::progress_bar(1000, arguments.common.quiet);
    let show = |stage: &str, fraction: f64| {
        bar.set_message(stage.to_string());
        bar.set_position((1000.0 * fraction) as u64);
    };
    let result = job::run(input, outputs, arguments, &Progress::new(Some(&show), token.clone()));
    bar.finish_and_clear();
    let describe = |finished: &Finished| {
        let line = |what: &str, file: &Path| format!("  {what} {}\n", file.display());
        let wrote = finished.written.iter().map(|file| line("wrote", file));
        let left_over = outputs.left_over(&finished.written);
        let left = left_over.iter().map(|file| line("left by an earlier run:", file));
        let notes = finished.notes.iter().map(|note| format!("  {note}\n"));
        let files = notes.chain(wrote).chain(left).collect::<String>();
        summary::detection(input, &finished.mesh, &finished.detection) + &files
    };
    report(input, result, outputs, arguments, describe)
}

/// Works through the inputs with several threads; a bad input does not stop the others.
fn run_many(outputs: &[Outputs], arguments: &Detect, token: &CancelToken) -> Ending {
    let bar = terminal::progress_bar(outputs.len() as u64, arguments.common.quiet);
    let (next, worst) = (AtomicUsize::new(0), Mutex::new(Ending::Found));
    let work = || {
        while let Some((input, outputs)) = take(&next, &arguments.inputs, outputs) {
            let step = run_one_of_many(input, outputs, arguments, token, &bar);
            let mut worst = worst.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            *worst = step.unwrap_or_else(|stopped| stopped).max(*worst);
            if step.is_err() {
                next.store(arguments.inputs.len(), Ordering::Relaxed);
            }
        }
    };
    let threads = usize::from(arguments.jobs).min(outputs.len());
    std::thread::scope(|scope| {
        (0..threads).for_each(|_| {
            scope.spawn(work);
        });
    });
    bar.finish_and_clear();
    worst.into_inner().unwrap_or(Ending::Failed)
}

fn take<'a, A: AsRef<Path>, B>(
    next: &AtomicUsize,
    inputs: &'a [A],
    outputs: &'a [B],
) -> Option<(&'a Path, &'a B)> {
    let index = next.fetch_add(1, Ordering::Relaxed);
    Some((inputs.get(index)?.as_ref(), outputs.get(index)?))
}

fn run_one_of_many(
    input: &Path,
    outputs: &Outputs,
    arguments: &Detect,
    token: &CancelToken,
    bar: &ProgressBar,
) -> Step {
    let progress = Progress::new(None, token.clone());
    // Our own mistake on one mesh must not lose the others.
    let result = catch_unwind(AssertUnwindSafe(|| job::run(input, outputs, arguments, &progress)))
        .unwrap_or_else(|_| Err(Error::Internal("the mesh made the program panic; please report it".into())));
    bar.inc(1);
    let describe = |finished: &Finished| {
        let left = left_by_earlier_runs(&outputs.left_over(&finished.written));
        summary::one_line(input, &finished.detection).trim_end().to_string() + &left + "\n"
    };
    bar.suspend(|| report(input, result, outputs, arguments, describe))
}

/// Prints the outcome to stdout, or the error to stderr.
fn report(
    input: &Path,
    result: Result<Finished>,
    outputs: &Outputs,
    arguments: &Detect,
    describe: impl Fn(&Finished) -> String,
) -> Step {
    match result {
        Ok(finished) => {
            let said = if arguments.common.quiet { Ok(()) } else { terminal::say(&describe(&finished)) };
            said.map(|()| finished.ending).map_err(|failed| failed.max(finished.ending))
        }
        Err(error) => {
            let ending = terminal::complain(input, &error);
            let left = outputs.left_over(&[]);
            if !left.is_empty() {
                eprintln!("intrinsym: {}{}", input.display(), left_by_earlier_runs(&left));
            }
            if ending == Ending::Interrupted { Err(ending) } else { Ok(ending) }
        }
    }
}

/// The end of a line that names the results of earlier runs, if there are any.
fn left_by_earlier_runs(files: &[&Path]) -> String {
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    if names.is_empty() { String::new() } else { format!("; left by an earlier run: {}", names.join(", ")) }
}

/// Says on stderr which results of other meshes a folder holds, so that they are not taken for those of this run.
fn say_what_else_is_in(folder: &Path, arguments: &Detect) {
    let own: HashSet<_> = arguments.inputs.iter().filter_map(|input| input.file_stem()).collect();
    let is_report = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "json");
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut others: Vec<PathBuf> = entries
        .filter(|path| is_report(path) && path.file_stem().is_some_and(|stem| !own.contains(stem)))
        .collect();
    others.sort();
    // One is read, not all of a large folder.
    if let Some(first) = others.iter().find(|path| targets::is_report(path)) {
        let (folder, first) = (folder.display(), first.display());
        eprintln!("intrinsym: {folder} also holds results of an earlier run on other meshes, as {first}");
    }
}
