//! `pickglass convert`: between draft, loom, image and design formats.

use std::path::Path;

use pickglass::atomic;
use pickglass::design::Design;
use pickglass::formats::jc5::{self, LoomPreset, WriteOptions};
use pickglass::formats::{self, output, read_bytes};
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
    let lost = write(&opened.design, args)?;
    let written = args.output.display().to_string();
    if args.json {
        return out::say_json(&json!({ "written": written, "lost": lost }));
    }
    let mut lines = vec![format!("wrote {written}")];
    lines.extend(lost.iter().map(|line| format!("  lost: {line}")));
    out::say(&lines)
}

/// Writes a design in the format of the path's ending; returns what had no place in it.
fn write(design: &Design, args: &ConvertArgs) -> anyhow::Result<Vec<String>> {
    let (path, loom) = (&args.output, &args.loom);
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    if ending.as_deref() != Some("jc5") && (loom.like.is_some() || loom.loom.is_some()) {
        anyhow::bail!(
            "{}: --like and --loom are for loom files: end the name in .jc5",
            path.display()
        );
    }
    if ending.as_deref() == Some("jc5") {
        let written = loom_file(design, path, args)?;
        atomic::write(path, &written.bytes)?;
        return Ok(written.lost);
    }
    Ok(formats::save(design, path, &opened::writing(args))?)
}

/// A card file: always into the hooks of a loom that is stated.
fn loom_file(design: &Design, path: &Path, args: &ConvertArgs) -> anyhow::Result<jc5::Written> {
    let loom = &args.loom;
    let mut options = WriteOptions {
        face_down: args.image.face_down,
    };
    if let Some(like) = &loom.like {
        let template = read_bytes(like)?;
        let name = like.display().to_string();
        return Ok(jc5::write_into(&template, &name, design, options)?);
    }
    let Some(name) = &loom.loom else {
        anyhow::bail!(
            "{}: a loom file needs the hooks of a loom: give a file of it with --like, or a \
             loom with --loom ({})",
            path.display(),
            jc5::PRESETS.map(|preset| preset.0).join(", ")
        );
    };
    let preset = match LoomPreset::named(name) {
        Some(preset) => preset?,
        None if name.ends_with(".ron") => {
            let bytes = read_bytes(Path::new(name))?;
            LoomPreset::parse(&String::from_utf8_lossy(&bytes), name)?
        }
        None => anyhow::bail!(
            "{name}: no loom is called this: give a .ron file, or one of {}",
            jc5::PRESETS.map(|preset| preset.0).join(", ")
        ),
    };
    options.face_down |= preset.face_down;
    let template = jc5::template(&preset, name)?;
    Ok(jc5::write_into(&template, name, design, options)?)
}
