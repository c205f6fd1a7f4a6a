//! `pickglass weaves`: the weave library.

use pickglass::design::{ColourOrders, LibraryWeave, WeavePattern, library, weave};
use serde_json::{Value, json};

use crate::cli::WeavesArgs;
use crate::out;

pub fn run(args: &WeavesArgs) -> anyhow::Result<()> {
    match &args.name {
        Some(name) => one(name, args.json),
        None => list(args.family.as_deref(), args.json),
    }
}

/// One weave by name or notation, drawn.
fn one(name: &str, as_json: bool) -> anyhow::Result<()> {
    let Some(known) = library::find(name) else {
        // Any notation can be looked at, in the library or not.
        let pattern = weave(name)?;
        if as_json {
            return out::say_json(&json!({ "weaves": [drawn_json(name, &pattern)] }));
        }
        let mut lines = vec![name.to_owned()];
        draw(&mut lines, &pattern);
        return out::say(&lines);
    };
    if as_json {
        return out::say_json(&json!({ "weaves": [entry_json(known)] }));
    }
    let mut lines = vec![line(known), format!("  {}", known.notation())];
    if let Some(colours) = known.colours() {
        lines.push(format!(
            "  warp {}, weft {} (D dark, L light)",
            letters(&colours.warp),
            letters(&colours.weft)
        ));
    }
    if known.preview_only() {
        lines.push("  preview only: a map of two layers, drawn as one".to_owned());
    }
    draw(&mut lines, known.pattern());
    out::say(&lines)
}

/// Adds a pattern, a line a pick.
fn draw(lines: &mut Vec<String>, pattern: &WeavePattern) {
    let drawn = pattern.to_string();
    lines.extend(drawn.trim_end().lines().map(str::to_owned));
}

fn list(family: Option<&str>, as_json: bool) -> anyhow::Result<()> {
    let shown: Vec<&LibraryWeave> = library()
        .iter()
        .filter(|weave| family.is_none_or(|family| same(weave.family(), family)))
        .collect();
    if let (true, Some(family)) = (shown.is_empty(), family) {
        let mut families: Vec<&str> = library().iter().map(LibraryWeave::family).collect();
        families.dedup();
        anyhow::bail!(
            "family {family}: the library has none of this name: choose one of {}",
            families.join(", ")
        );
    }
    if as_json {
        let weaves: Vec<Value> = shown.into_iter().map(entry_json).collect();
        return out::say_json(&json!({ "weaves": weaves }));
    }
    let mut lines = Vec::new();
    let mut before = "";
    for weave in shown {
        if weave.family() != before {
            before = weave.family();
            lines.push(before.to_owned());
        }
        lines.push(format!("  {}", line(weave)));
    }
    out::say(&lines)
}

fn same(family: &str, asked: &str) -> bool {
    let plain = |text: &str| text.trim().to_lowercase().replace('ê', "e");
    plain(family) == plain(asked)
}

/// Name, repeat and use in a line.
fn line(weave: &LibraryWeave) -> String {
    let (ends, picks) = weave.repeat();
    let also = match weave.also() {
        [] => String::new(),
        names => format!(" (also {})", names.join(", ")),
    };
    format!(
        "{}{also}, {ends} × {picks}: {}",
        weave.name(),
        weave.usual_use()
    )
}

fn letters(order: &[u16]) -> String {
    let letter = |&colour: &u16| if colour == 0 { 'D' } else { 'L' };
    order.iter().map(letter).collect()
}

fn drawn_json(name: &str, pattern: &WeavePattern) -> Value {
    json!({
        "name": name,
        "ends": pattern.ends(),
        "picks": pattern.picks(),
        "drawdown": pattern.to_string().lines().collect::<Vec<_>>(),
    })
}

fn entry_json(weave: &LibraryWeave) -> Value {
    let mut entry = drawn_json(weave.name(), weave.pattern());
    entry["also"] = json!(weave.also());
    entry["family"] = json!(weave.family());
    entry["notation"] = json!(weave.notation());
    entry["use"] = json!(weave.usual_use());
    entry["preview_only"] = json!(weave.preview_only());
    if let Some(ColourOrders { warp, weft }) = weave.colours() {
        entry["colours"] = json!({ "warp": letters(warp), "weft": letters(weft) });
    }
    entry
}
