//! One file a command. Each turns its arguments into library calls and their results
//! into lines or one JSON object.

mod accuracy;
mod check;
mod convert;
mod effects;
mod posterize;
mod selftest;
mod shell;
mod still;
mod synthesize;
mod volume;
mod weaves;
mod window;

use std::time::Instant;

use serde_json::{Map, Value};

use crate::cli::{Cli, Command};
use crate::out;

/// Runs what the command line asks for; the program began at `begun`.
pub fn run(cli: Cli, begun: Instant) -> anyhow::Result<()> {
    match cli.command {
        None => window::run(&cli.window),
        Some(Command::Check(args)) => check::run(&args),
        Some(Command::Convert(args)) => convert::run(&args),
        Some(Command::Posterize(args)) => posterize::run(&args),
        Some(Command::Synthesize(args)) => synthesize::run(&args),
        Some(Command::Still(args)) => still::run(&args, begun),
        Some(Command::Effects(args)) => effects::run(&args),
        Some(Command::Accuracy(args)) => accuracy::run(&args),
        Some(Command::Selftest(args)) => selftest::run(&args),
        Some(Command::Weaves(args)) => weaves::run(&args),
        Some(Command::Volume(args)) => volume::run(&args),
        Some(Command::Completions(args)) => shell::completions(&args),
        Some(Command::Man(args)) => shell::man(&args),
    }
}

/// Says on standard error what was remarked on while reading a design.
fn note_warnings(warnings: &[String]) {
    for warning in warnings {
        out::note(&format!("warning: {warning}"));
    }
}

/// Stages and their total as one JSON object.
fn seconds_json(stages: &[(String, f64)], total: f64) -> Value {
    let mut map: Map<String, Value> = stages
        .iter()
        .map(|(stage, seconds)| (stage.clone(), Value::from(*seconds)))
        .collect();
    map.insert("total".to_owned(), Value::from(total));
    Value::Object(map)
}
