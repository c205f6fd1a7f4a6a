//! One file a format, reading and writing.
//!
//! [`load`] recognises a design, draft, loom file or image by its content, not by its
//! name; [`save`] writes one by the ending of its name and says what the format has no
//! place for. Which formats there are stands in [`FORMATS`]: `ron` is the design document,
//! `wif` the weavers' interchange format, `dtx`, `wpo` and `dbw` the files of drafting
//! programs, `jc5` those of jacquard looms, `image` all kinds of images. `photo` is any
//! picture that is to be posterised; `sheet` is what drafts have in common. `volume` takes
//! cloth out as voxels and reads them in, `yarns` takes it out as curves and tubes. `output`
//! says beforehand whether a file can and may be written.

mod bytes;
pub mod dbw;
mod designs;
pub mod dtx;
mod encoding;
mod error;
pub mod exr;
pub mod field_table;
pub mod image;
pub mod jc5;
pub mod output;
pub mod photo;
pub mod png;
mod reading;
pub mod ron;
mod sheet;
mod table;
pub mod volume;
pub mod wif;
pub mod wpo;
mod writing;
pub mod yarns;

pub use bytes::{MAX_FILE, read_bytes};
pub use error::FormatError;
use reading::stem;
pub use reading::{Imported, LoadOptions};
pub use sheet::{Place, SheetError};
pub use table::{FORMATS, Format, Kind, endings, endings_in_words, of_ending};
pub use writing::{SaveOptions, Saved};

use std::path::{Path, PathBuf};

use crate::atomic;
use crate::design::Design;

/// Opens a design document, a draft or an image, whichever it is.
///
/// # Errors
/// [`FormatError`]: one line with the file, the place, what was expected and what to do.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Imported, FormatError> {
    load_bytes(&read_bytes(path)?, &path.display().to_string(), options)
}

/// As [`load`], for bytes already in memory; `name` is what messages call them.
///
/// # Errors
/// As [`load`].
pub fn load_bytes(
    bytes: &[u8],
    name: &str,
    options: &LoadOptions,
) -> Result<Imported, FormatError> {
    let text = encoding::beginning(bytes);
    let known = FORMATS
        .iter()
        .find(|format| format.recognises(bytes, &text));
    let found = match known {
        Some(_) => None,
        None => other_kind(&text),
    };
    if let Some(found) = found {
        return Err(FormatError::Unknown {
            file: name.to_owned(),
            expected: what_is_read(),
            found,
        });
    }
    // Any other text is taken for a WIF, whose reader says what is wrong with it.
    match known {
        Some(format) => format.read(bytes, name, options),
        None => designs::read_wif(bytes, name, options),
    }
}

/// What is read, for a message.
fn what_is_read() -> String {
    let of = |kind: Kind| endings_in_words(|format| format.kind == kind, ", ");
    format!(
        "a design ({}), a draft ({}), a loom file ({}) or an image",
        of(Kind::Design),
        of(Kind::Draft),
        of(Kind::Loom)
    )
}

/// What is written, for a message.
fn what_is_written() -> String {
    let of =
        |kind: Kind| endings_in_words(|format| format.kind == kind && format.is_written(), " or ");
    format!(
        "designs are written as {}, drafts as {}, cards of looms as {}, images as {}",
        of(Kind::Design),
        of(Kind::Draft),
        of(Kind::Loom),
        of(Kind::Image)
    )
}

/// The fields that change what is read, one table a reader.
pub fn field_tables() -> Vec<field_table::Table> {
    let mut tables: Vec<_> = (FORMATS.iter())
        .flat_map(|format| format.fields.iter().copied())
        .collect();
    tables.extend([
        volume::VOL_FIELDS,
        volume::NRRD_FIELDS,
        volume::META_IMAGE_FIELDS,
        exr::FIELDS,
    ]);
    tables.extend(image::TABLES);
    tables
}

/// Images that say which yarn lies where.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MapFiles {
    /// The warp yarn of every crossing.
    pub warp: Option<PathBuf>,
    /// The weft yarn of every crossing.
    pub weft: Option<PathBuf>,
}

/// Gives a design the yarns of images; see [`image::with_maps`].
///
/// # Errors
/// [`FormatError`] if an image cannot be read or has another size than the design.
pub fn with_map_files(
    design: Imported,
    files: &MapFiles,
    options: &LoadOptions,
) -> Result<Imported, FormatError> {
    if *files == MapFiles::default() {
        return Ok(design);
    }
    let read = |path: &Option<PathBuf>| -> Result<_, FormatError> {
        let Some(path) = path else { return Ok(None) };
        let name = path.display().to_string();
        let decoded = image::read(&read_bytes(path)?, &name)?;
        Ok(Some((decoded, name)))
    };
    let maps = image::Maps {
        warp: read(&files.warp)?,
        weft: read(&files.weft)?,
    };
    Ok(image::with_maps(design, maps, options)?)
}

/// Writes a design in the format of the path's ending, whole or not at all. Returns what
/// had no place in it, one line each.
///
/// # Errors
/// [`FormatError`] for an ending of no format, a design that the format cannot hold, and
/// a file that cannot be written.
pub fn save(
    design: &Design,
    path: &Path,
    options: &SaveOptions,
) -> Result<Vec<String>, FormatError> {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let file = || path.display().to_string();
    let saved = save_bytes(design, &ending, options).unwrap_or_else(|| {
        Err(FormatError::Ending {
            file: file(),
            written: what_is_written(),
        })
    });
    let saved = saved.map_err(|error| match error {
        FormatError::NoLoom { looms, .. } => FormatError::NoLoom {
            file: file(),
            looms,
        },
        other => other,
    })?;
    atomic::write(path, &saved.bytes)?;
    let mut lost = saved.lost;
    let is_image = of_ending(&ending).is_some_and(|format| format.kind == Kind::Image);
    if is_image && stem(&file()) != design.name {
        lost.push(format!(
            "its name, \"{}\": images have that of their file",
            design.name
        ));
    }
    Ok(lost)
}

/// As [`save`], into memory; `None` if no format that is written has this ending.
pub fn save_bytes(
    design: &Design,
    ending: &str,
    options: &SaveOptions,
) -> Option<Result<Saved, FormatError>> {
    of_ending(ending)?.write(design, ending, options)
}

const NRRD_VOLUME: &str =
    "an NRRD volume: pickglass still takes it, named .nrrd, or .nhdr with its voxels beside it";
const META_IMAGE_VOLUME: &str =
    "a MetaImage volume: pickglass still takes it, named .mha, or .mhd with its voxels beside it";

/// What bytes are that are certainly no design.
fn other_kind(bytes: &[u8]) -> Option<&'static str> {
    let kinds: [(&[u8], &str); 9] = [
        (b"NRRD000", NRRD_VOLUME),
        (b"ObjectType", META_IMAGE_VOLUME),
        (b"NDims", META_IMAGE_VOLUME),
        (
            b"VOL\x03",
            "a Mitsuba volume: pickglass still takes it, named .vol",
        ),
        (b"PK\x03\x04", "an archive"),
        (b"%PDF", "a PDF"),
        (
            b"8BPS",
            "a Photoshop document: save it as a TIFF, PNG or BMP",
        ),
        (b"{", "JSON"),
        (b"\x7fELF", "a program"),
    ];
    if bytes.is_empty() {
        return Some("an empty file");
    }
    kinds
        .iter()
        .find(|(start, _)| bytes.starts_with(start))
        .map(|&(_, kind)| kind)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn message(bytes: &[u8]) -> String {
        let options = LoadOptions::default();
        load_bytes(bytes, "x", &options).unwrap_err().to_string()
    }

    #[test]
    fn files_are_known_by_content() {
        assert!(message(b"\x89PNG\r\n").contains("PNG: the image is damaged"));
        assert!(message(b"PK\x03\x04").contains("found an archive"));
        assert!(message(b"").contains("an empty file"));
        assert!(message(b"(pickglass: 1,").contains("damaged"));
        assert!(message(b"hello").contains("expected a WIF"));
        let missing = load(Path::new("/no/such/file.wif"), &LoadOptions::default());
        assert!(
            missing
                .unwrap_err()
                .to_string()
                .contains("/no/such/file.wif")
        );
    }
}
