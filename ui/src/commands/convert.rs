//! `pickglass convert`: between draft and design formats.

use serde_json::json;

use super::{check_output, note_warnings};
use crate::cli::ConvertArgs;
use crate::opened::Opened;
use crate::out;
use crate::stub::design;

pub fn run(args: &ConvertArgs) -> anyhow::Result<()> {
    check_output(&args.output)?;
    let opened = Opened::argument(&args.input, &args.sett)?;
    note_warnings(&opened.warnings);
    let lost = design::save(&opened.design, &args.output)?;
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
