//! `pickglass convert`: between draft and design formats.

use std::path::Path;

use pickglass::design::Design;
use pickglass::formats::{atomic, ron, wif};
use serde_json::json;

use super::{check_output, note_warnings};
use crate::cli::ConvertArgs;
use crate::opened::Opened;
use crate::out;

pub fn run(args: &ConvertArgs) -> anyhow::Result<()> {
    check_output(&args.output)?;
    let opened = Opened::argument(&args.input, &args.sett)?;
    note_warnings(&opened.warnings);
    let lost = write(&opened.design, &args.output)?;
    let written = args.output.display().to_string();
    if args.json {
        return out::say_json(&json!({ "written": written, "lost": lost }));
    }
    let mut text = format!("wrote {written}");
    for line in &lost {
        text += &format!("\n  lost: {line}");
    }
    out::say(&text)
}

/// Writes a design in the format of the path's ending; returns what had no place in it.
fn write(design: &Design, path: &Path) -> anyhow::Result<Vec<String>> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let (text, lost) = match ending.as_deref() {
        Some("ron") => (ron::write(design)?, Vec::new()),
        Some("wif") => {
            let written = wif::write(design)?;
            (written.text, written.lost)
        }
        _ => anyhow::bail!(
            "{}: designs are written as .ron and drafts as .wif: end the name in one of them",
            path.display()
        ),
    };
    atomic::write(path, text.as_bytes())?;
    Ok(lost)
}
