//! The progress bar, and Ctrl-C.

use crate::Ending;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use intrinsym::{CancelToken, Error};
use std::io::Write;
use std::path::Path;

/// A token that Ctrl-C cancels. A second Ctrl-C ends the process at once.
pub fn cancel_on_interrupt() -> CancelToken {
    let token = CancelToken::default();
    let cancelled = token.clone();
    let handler = move || {
        if cancelled.is_cancelled() {
            std::process::exit(130);
        }
        cancelled.cancel();
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        eprintln!("intrinsym: Ctrl-C will end the program at once: {error}");
    }
    token
}

/// A bar on stderr; hidden where stderr is no terminal, and when quiet.
pub fn progress_bar(length: u64, quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(length), target);
    let style = ProgressStyle::with_template("{msg:>24} [{bar:40}] {percent:>3} %");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
    bar
}

/// Prints to stdout.
///
/// # Errors
/// How the run ends: quietly where the reader went away (`| head`), otherwise with a message on stderr.
pub fn say(text: &str) -> Result<(), Ending> {
    let mut out = std::io::stdout().lock();
    let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) else { return Ok(()) };
    if error.kind() == std::io::ErrorKind::BrokenPipe {
        return Err(Ending::Unheard);
    }
    eprintln!(
        "intrinsym: standard output cannot be written: {error}; check where it goes and the free space"
    );
    Err(Ending::Failed)
}

/// Prints what a command answers, unless it is to be quiet; how the command ends.
pub fn answer(text: &str, quiet: bool) -> Ending {
    let said = if quiet { Ok(()) } else { say(text) };
    said.err().unwrap_or(Ending::Found)
}

/// One line on stderr that says what went wrong, and with which file.
pub fn complain(input: &Path, error: &Error) -> Ending {
    match error {
        Error::Cancelled => {
            eprintln!("intrinsym: {}: interrupted, nothing was written", input.display());
            return Ending::Interrupted;
        }
        Error::File { .. } => eprintln!("intrinsym: {error}"),
        _ => eprintln!("intrinsym: {}: {error}", input.display()),
    }
    Ending::Failed
}
