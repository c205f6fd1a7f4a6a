//! `pickglass convert`: between draft, loom, image and design formats.

use std::path::Path;

use pickglass::formats::{self, output};
use serde_json::json;

use super::note_warnings;
use crate::cli::ConvertArgs;
use crate::opened::{self, Opened};
use crate::{idle, out};

pub fn run(args: &ConvertArgs) -> anyhow::Result<()> {
    let mut inputs = Opened::inputs(&args.input, &args.image);
    inputs.extend(args.loom.like.as_deref());
    inputs.extend(args.loom.loom.as_deref().map(Path::new));
    output::check(&args.output, inputs)?;
    idle::in_converting(args)?;
    let opened = Opened::argument(&args.input, &args.sett, &args.image)?;
    note_warnings(&opened.warnings);
    let lost = formats::save(&opened.design, &args.output, &opened::writing(args))?;
    let written = args.output.display().to_string();
    if args.json {
        return out::say_json(&json!({ "written": written, "lost": lost }));
    }
    let mut lines = vec![format!("wrote {written}")];
    lines.extend(lost.iter().map(|line| format!("  lost: {line}")));
    out::say(&lines)
}
