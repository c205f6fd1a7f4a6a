//! The program `pickglass`: command line and window.
//!
//! [`cli`] is the grammar, [`commands`] has one file a command, [`window`] is the
//! viewer. Both consume the same stream: a [`pickglass::job::Job`] that reports
//! progress, and passes of a picture that refines. Nothing here computes cloth.

mod cli;
mod command_table;
mod commands;
#[cfg(test)]
mod docs;
mod help;
mod idle;
mod interrupt;
mod late;
mod opened;
mod out;
mod tokens;
mod values;
mod volumes;
mod window;

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;

fn main() -> ExitCode {
    let begun = Instant::now();
    out::start_log();
    let cli = cli::Cli::try_parse().unwrap_or_else(|error| out::usage(&error));
    if let Some(complaint) = pickglass::memory::complaint() {
        out::note(&format!("warning: {complaint}"));
    }
    match commands::run(cli, begun) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            out::error_line(&error);
            ExitCode::from(1)
        }
    }
}
