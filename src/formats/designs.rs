//! Designs from and into the bytes of a file, one function for each kind of format: what the
//! rows of the table do.

use std::path::Path;

use super::bytes::read_bytes;
use super::error::FormatError;
use super::image::{self, ImageFormat};
use super::jc5::{self, Hooks};
use super::reading::{Imported, LoadOptions};
use super::writing::{SaveOptions, Saved};
use super::{encoding, ron, sheet, wif};
use crate::design::{Density, Design, Sett};

/// A design document.
pub fn read_document(
    bytes: &[u8],
    name: &str,
    options: &LoadOptions,
) -> Result<Imported, FormatError> {
    let mut warnings = sheet::Warnings::default();
    let text = encoding::as_utf_8(bytes, &mut warnings);
    let (design, unknown) = ron::read_told(&text, name)?;
    let mut warnings = warnings.finish();
    warnings.extend(unknown);
    Ok(Imported {
        design: with_options(design, name, options)?,
        warnings,
    })
}

/// Whether a text begins as a design document.
pub fn is_document(text: &[u8]) -> bool {
    let start = &text[..text.len().min(4096)];
    ron::version(&String::from_utf8_lossy(start)).is_some()
}

/// A draft as WIF.
pub fn read_wif(bytes: &[u8], name: &str, options: &LoadOptions) -> Result<Imported, FormatError> {
    Ok(wif::read_with(bytes, name, options)?)
}

/// An image of any encoding.
pub fn read_image(
    bytes: &[u8],
    name: &str,
    options: &LoadOptions,
) -> Result<Imported, FormatError> {
    Ok(image::design(image::read(bytes, name)?, name, options)?)
}

/// The design itself.
pub fn write_document(design: &Design, _: &str, _: &SaveOptions) -> Result<Saved, FormatError> {
    Ok(Saved {
        bytes: ron::write(design)?.into_bytes(),
        lost: Vec::new(),
    })
}

/// A draft as WIF.
pub fn write_wif(design: &Design, _: &str, _: &SaveOptions) -> Result<Saved, FormatError> {
    let written = wif::write(design)?;
    Ok(Saved {
        bytes: written.text.into_bytes(),
        lost: written.lost,
    })
}

/// An image of the ending's format.
pub fn write_image(
    design: &Design,
    ending: &str,
    options: &SaveOptions,
) -> Result<Saved, FormatError> {
    let format = ImageFormat::of_ending(ending).unwrap_or(ImageFormat::Png);
    let export = image::export(design, options.content, options.black, options.corner)?;
    let mut lost = export.lost;
    lost.extend(image::sett_loss(design, format.keeps_resolution()));
    Ok(Saved {
        bytes: image::encode(&export.raster, format, &design.name)?,
        lost,
    })
}

/// A card file: always into the hooks of a loom that is stated.
pub fn write_cards(design: &Design, _: &str, options: &SaveOptions) -> Result<Saved, FormatError> {
    let Some(loom) = &options.loom else {
        return Err(FormatError::NoLoom {
            file: design.name.clone(),
            looms: looms(),
        });
    };
    let mut face_down = loom.face_down;
    let (template, name) = match &loom.hooks {
        Hooks::Like(file) => (read_bytes(file)?, file.display().to_string()),
        Hooks::Named(name) => {
            let preset = match jc5::LoomPreset::named(name) {
                Some(preset) => preset?,
                None if name.ends_with(".ron") => jc5::LoomPreset::parse(
                    &String::from_utf8_lossy(&read_bytes(Path::new(name))?),
                    name,
                )?,
                None => return Err(FormatError::Loom(name.clone(), looms())),
            };
            face_down |= preset.face_down;
            (jc5::template(&preset, name)?, name.clone())
        }
    };
    let written = jc5::write_into(&template, &name, design, jc5::WriteOptions { face_down })?;
    Ok(Saved {
        bytes: written.bytes,
        lost: written.lost,
    })
}

fn looms() -> String {
    jc5::PRESETS.map(|preset| preset.0).join(", ")
}

/// A design at the sett somebody asked for; unequal spacings keep their ratios.
fn with_options(design: Design, name: &str, options: &LoadOptions) -> Result<Design, FormatError> {
    let Some((ends, picks)) = options.sett else {
        return Ok(design);
    };
    let scaled = |density: &Density, per_cm: f32| Density {
        per_cm,
        pitches_mm: density.pitches_mm.as_ref().map(|list| {
            let ratio = density.per_cm / per_cm;
            list.iter().map(|pitch| pitch * ratio).collect()
        }),
    };
    let sett = Sett {
        ends: scaled(&design.sett().ends, ends),
        picks: scaled(&design.sett().picks, picks),
        assumed: false,
    };
    design.with_sett(sett).map_err(|error| FormatError::Sett {
        file: name.to_owned(),
        problem: error.to_string(),
    })
}
