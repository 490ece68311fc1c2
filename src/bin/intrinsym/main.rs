//! Command line of Intrinsym: `detect`, `info` and `eigen`.
//!
//! Exit status: 0 found (or done), 1 no symmetry found, 2 error, 130 interrupted, 141 nobody reads standard output.

mod arguments;
mod detect;
mod eigen;
mod info;
mod job;
mod numpy_archive;
mod outputs;
mod report;
mod summary;
mod targets;
mod terminal;

use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;

/// How a command ended, as its exit status.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ending {
    /// A symmetry was found, or what was asked is done.
    Found = 0,
    /// No symmetry was found.
    None = 1,
    /// Something went wrong; a message on stderr says what.
    Failed = 2,
    /// Ctrl-C.
    Interrupted = 130,
    /// Whoever read stdout went away, as `head` does.
    Unheard = 141,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let token = terminal::cancel_on_interrupt();
    let ending = match &arguments.command {
        Command::Detect(detect) => detect::run(detect, &token),
        Command::Info(info) => info::run(info),
        Command::Eigen(eigen) => eigen::run(eigen, &token),
    };
    ExitCode::from(ending as u8)
}
