//! `pickglass convert`: between draft, design and image formats.

use pickglass::formats;
use serde_json::json;

use super::{check_output, note_warnings};
use crate::cli::ConvertArgs;
use crate::opened::{self, Opened};
use crate::out;

pub fn run(args: &ConvertArgs) -> anyhow::Result<()> {
    check_output(&args.output)?;
    let opened = Opened::argument(&args.input, &args.sett, &args.image)?;
    note_warnings(&opened.warnings);
    let lost = formats::save(&opened.design, &args.output, &opened::writing(args))?;
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
