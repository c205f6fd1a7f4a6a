//! One file a command. Each turns its arguments into library calls and their results
//! into lines or one JSON object.

mod check;
mod convert;
mod posterize;
mod still;
mod synthesize;
mod volume;
mod weaves;
mod window;

use std::path::Path;

use serde_json::{Map, Value};

use crate::cli::{Cli, Command};
use crate::out;

/// Runs what the command line asks for.
pub fn run(cli: Cli) -> anyhow::Result<()> {
    match cli.command {
        None => window::run(&cli.window),
        Some(Command::Check(args)) => check::run(&args),
        Some(Command::Convert(args)) => convert::run(&args),
        Some(Command::Posterize(args)) => posterize::run(&args),
        Some(Command::Synthesize(args)) => synthesize::run(&args),
        Some(Command::Still(args)) => still::run(&args),
        Some(Command::Weaves(args)) => weaves::run(&args),
        Some(Command::Volume(args)) => volume::run(&args),
    }
}

/// Fails early when `path` cannot be written, before minutes of work are spent on it.
fn check_output(path: &Path) -> anyhow::Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let shown = path.display();
    if !folder.is_dir() {
        anyhow::bail!(
            "{shown}: the folder {} does not exist: create it or choose another with -o",
            folder.display()
        );
    }
    if path.is_dir() {
        anyhow::bail!("{shown}: this is a folder: name a file in it");
    }
    Ok(())
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
