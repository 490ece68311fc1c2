//! Command line of Intrinsym: `detect`, `info`, `eigen` and `completions`.
//!
//! Exit status: that of the worst [`Ending`] of all meshes.

mod arguments;
mod detect;
mod eigen;
mod info;
mod job;
mod manual;
mod numpy_archive;
mod outputs;
mod picture;
mod report;
mod summary;
mod targets;
mod terminal;

use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;

/// How a command ended, from best to worst.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ending {
    /// A symmetry was found, or what was asked is done.
    Found,
    /// A map was found and written, but something speaks against it.
    Doubtful,
    /// No symmetry was found.
    None,
    /// Something went wrong; a message on stderr says what.
    Failed,
    /// Ctrl-C.
    Interrupted,
    /// Whoever read stdout went away, as `head` does.
    Unheard,
}

impl Ending {
    /// The exit status.
    fn status(self) -> u8 {
        match self {
            Ending::Found => 0,
            Ending::Doubtful => 3,
            Ending::None => 1,
            Ending::Failed => 2,
            Ending::Interrupted => 130,
            Ending::Unheard => 141,
        }
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let token = terminal::cancel_on_interrupt();
    let ending = match &arguments.command {
        Command::Detect(detect) => detect::run(detect, &token),
        Command::Info(info) => info::run(info),
        Command::Eigen(eigen) => eigen::run(eigen, &token),
        Command::Completions(completions) => manual::complete(completions.shell),
        Command::Manual(manual) => manual::write(&manual.folder),
    };
    ExitCode::from(ending.status())
}
