//! `intrinsym detect`: one mesh with a full summary, or many with a line each.

use crate::Ending;
use crate::arguments::Detect;
use crate::job::{self, Finished};
use crate::outputs::Outputs;
use crate::{summary, terminal};
use indicatif::ProgressBar;
use intrinsym::base::error::{Error, Result};
use intrinsym::base::progress::{CancelToken, Progress};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
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
    match (&arguments.inputs[..], &outputs[..]) {
        ([input], [outputs]) => run_one(input, outputs, arguments, token),
        (_, outputs) => run_many(outputs, arguments, token),
    }
}

fn run_one(input: &Path, outputs: &Outputs, arguments: &Detect, token: &CancelToken) -> Ending {
    let bar = terminal::progress_bar(1000, arguments.common.quiet);
    let show = |stage: &str, fraction: f64| {
        bar.set_message(stage.to_string());
        bar.set_position((1000.0 * fraction) as u64);
    };
    let result = job::run(input, outputs, arguments, &Progress::new(Some(&show), token.clone()));
    bar.finish_and_clear();
    let describe = |finished: &Finished| {
        let files: String = outputs.files().map(|file| format!("  wrote {}\n", file.display())).collect();
        summary::detection(input, &finished.mesh, &finished.detection) + &files
    };
    report(input, result, arguments, describe)
}

/// Works through the inputs with several threads; a bad input does not stop the others.
fn run_many(outputs: &[Outputs], arguments: &Detect, token: &CancelToken) -> Ending {
    let bar = terminal::progress_bar(outputs.len() as u64, arguments.common.quiet);
    let (next, worst) = (AtomicUsize::new(0), Mutex::new(Ending::Found));
    let work = || {
        while let Some((input, outputs)) = take(&next, &arguments.inputs, outputs) {
            let ending = run_one_of_many(input, outputs, arguments, token, &bar);
            let mut worst = worst.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            *worst = ending.max(*worst);
            if *worst == Ending::Interrupted {
                break;
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
) -> Ending {
    let progress = Progress::new(None, token.clone());
    // Our own mistake on one mesh must not lose the others.
    let result = catch_unwind(AssertUnwindSafe(|| job::run(input, outputs, arguments, &progress)))
        .unwrap_or_else(|_| Err(Error::Internal("the mesh made the program panic; please report it".into())));
    bar.inc(1);
    bar.suspend(|| report(input, result, arguments, |finished| summary::one_line(input, &finished.detection)))
}

/// Prints the outcome to stdout, or the error to stderr.
fn report(
    input: &Path,
    result: Result<Finished>,
    arguments: &Detect,
    describe: impl Fn(&Finished) -> String,
) -> Ending {
    match result {
        Ok(finished) => {
            if !arguments.common.quiet {
                terminal::say(&describe(&finished));
            }
            finished.ending
        }
        Err(error) => terminal::complain(input, &error),
    }
}
