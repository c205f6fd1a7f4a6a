//! `pickglass convert`: between draft, loom and design formats.

use std::path::Path;

use pickglass::design::Design;
use pickglass::formats::jc5::{self, LoomPreset, WriteOptions};
use pickglass::formats::{LoadOptions, atomic, read_bytes, ron, wif};
use serde_json::json;

use super::{check_output, note_warnings};
use crate::cli::{ConvertArgs, LoomArgs};
use crate::opened::Opened;
use crate::out;

pub fn run(args: &ConvertArgs) -> anyhow::Result<()> {
    check_output(&args.output)?;
    let options = LoadOptions {
        face_down: args.loom.face_down,
        ..LoadOptions::default()
    };
    let opened = Opened::argument_with(&args.input, &args.sett, options)?;
    note_warnings(&opened.warnings);
    let lost = write(&opened.design, &args.output, &args.loom)?;
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
fn write(design: &Design, path: &Path, loom: &LoomArgs) -> anyhow::Result<Vec<String>> {
    let ending = path
        .extension()
        .map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    if ending.as_deref() != Some("jc5") && (loom.like.is_some() || loom.loom.is_some()) {
        anyhow::bail!(
            "{}: --like and --loom are for loom files: end the name in .jc5",
            path.display()
        );
    }
    let (bytes, lost) = match ending.as_deref() {
        Some("ron") => (ron::write(design)?.into_bytes(), Vec::new()),
        Some("wif") => {
            let written = wif::write(design)?;
            (written.text.into_bytes(), written.lost)
        }
        Some("jc5") => {
            let written = loom_file(design, path, loom)?;
            (written.bytes, written.lost)
        }
        _ => anyhow::bail!(
            "{}: designs are written as .ron, drafts as .wif and loom files as .jc5: end the name in \
             one of them",
            path.display()
        ),
    };
    atomic::write(path, &bytes)?;
    Ok(lost)
}

/// A card file: always into the hooks of a loom that is stated.
fn loom_file(design: &Design, path: &Path, loom: &LoomArgs) -> anyhow::Result<jc5::Written> {
    let mut options = WriteOptions {
        face_down: loom.face_down,
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
