//! `pickglass check`: floats, warnings and scale.

use serde_json::json;

use crate::cli::CheckArgs;
use crate::opened::Opened;
use crate::out;

pub fn run(args: &CheckArgs) -> anyhow::Result<()> {
    let opened = Opened::argument(&args.design, &args.sett)?;
    let design = &opened.design;
    if args.json {
        return out::say_json(&json!({
            "ends": design.pattern.ends(),
            "picks": design.pattern.picks(),
            "yarns": design.yarns.len(),
            "warnings": opened.warnings,
        }));
    }
    out::say(&format!(
        "{}\n  {} ends x {} picks",
        opened.name(),
        design.pattern.ends(),
        design.pattern.picks()
    ))
}
