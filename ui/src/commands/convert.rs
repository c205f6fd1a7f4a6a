//! `pickglass convert`: between draft and design formats.

use serde_json::json;

use super::{check_output, note_warnings};
use crate::cli::ConvertArgs;
use crate::opened::Opened;
use crate::out;
use crate::stub::design::DesignError;

pub fn run(args: &ConvertArgs) -> anyhow::Result<()> {
    check_output(&args.output)?;
    let opened = Opened::argument(&args.input, &args.sett)?;
    note_warnings(&opened.warnings);
    let lost: Vec<String> = Vec::new();
    let shown = args.output.display().to_string();
    if !shown.ends_with(".ron") && !shown.ends_with(".wif") {
        return Err(DesignError::Format(shown).into());
    }
    if args.json {
        return out::say_json(&json!({ "written": shown, "lost": lost }));
    }
    out::say(&format!("wrote {shown}"))
}
