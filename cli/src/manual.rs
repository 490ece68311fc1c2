//! Shell completions and manual pages, made from the argument parser.

use crate::Ending;
use crate::arguments::Arguments;
use crate::terminal;
use clap::CommandFactory;
use clap_complete::Shell;
use std::path::Path;

const NAME: &str = "intrinsym";

/// Prints what a shell reads to complete the commands.
pub fn complete(shell: Shell) -> Ending {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), NAME, &mut script);
    terminal::answer(&String::from_utf8_lossy(&script), false)
}

/// Writes the manual page of the program and of each command.
pub fn write(folder: &Path) -> Ending {
    match clap_mangen::generate_to(Arguments::command(), folder) {
        Ok(()) => Ending::Found,
        Err(error) => {
            eprintln!("intrinsym: {}: the manual pages cannot be written: {error}", folder.display());
            Ending::Failed
        }
    }
}
