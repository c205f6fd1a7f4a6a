//! One file a format, reading and writing.
//!
//! [`load`] recognises a design, draft, loom file or image by its content, not by its
//! name; [`save`] writes one by the ending of its name and says what the format has no
//! place for. `ron` is the design document, `wif` the weavers' interchange format, `dtx`,
//! `wpo` and `dbw` the files of drafting programs, `jc5` those of jacquard looms, `image`
//! all kinds of images, `photo` any picture that is to be posterised; `sheet` is what
//! drafts have in common. `volume` takes cloth out as voxels and reads them in, `yarns` takes
//! it out as curves and tubes. `output` says beforehand whether a file can and may be written.

pub mod dbw;
pub mod dtx;
mod encoding;
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
pub mod volume;
pub mod wif;
pub mod wpo;
pub mod yarns;

use reading::stem;
pub use reading::{Imported, LoadOptions};
pub use sheet::{Place, SheetError};

use std::io::Read;
use std::path::{Path, PathBuf};

use crate::atomic;
use crate::design::{Density, Design, Sett};
use image::{Black, Corner, Encoding, ImageContent, ImageFormat};

/// A file that could not be opened as a design: one line with the file, the place, what
/// was expected and what to do.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The system would not give it.
    #[error("cannot read {file}: {source}; check the name and that you may read it")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Larger than any design.
    #[error("{file}: expected at most {} MiB; this is no design", MAX_FILE >> 20)]
    TooLarge {
        /// The file.
        file: String,
    },
    /// Neither a design nor a draft.
    #[error(
        "{file}: expected a design (.ron), a draft (.wif, .dtx, .wpo, .dbw), a loom file (.jc5) \
         or an image, found {found}; choose another file"
    )]
    Unknown {
        /// The file.
        file: String,
        /// What it looks like.
        found: &'static str,
    },
    /// A design document with something wrong.
    #[error(transparent)]
    Ron(#[from] ron::RonError),
    /// A WIF with something wrong.
    #[error(transparent)]
    Wif(#[from] wif::WifError),
    /// Another draft or a loom file with something wrong.
    #[error(transparent)]
    Sheet(#[from] SheetError),
    /// An image with something wrong, or a design that no image can hold.
    #[error(transparent)]
    Image(#[from] image::ImageError),
    /// A name with an ending that no format has.
    #[error(
        "{file}: designs are written as .ron, drafts as .wif, images as .png, .bmp, .tif or \
         .gif; end the name in one of them"
    )]
    Ending {
        /// The file.
        file: String,
    },
    /// A file that could not be written.
    #[error(transparent)]
    Write(#[from] atomic::WriteError),
    /// A sett that cannot be woven.
    #[error("{file}: {problem}; give another sett")]
    Sett {
        /// The file.
        file: String,
        /// What is wrong.
        problem: String,
    },
}

/// The largest file that is opened: many times the largest design.
pub const MAX_FILE: u64 = crate::limits::FILE;

/// The bytes of a file, if they are no more than [`MAX_FILE`].
///
/// # Errors
/// [`FormatError`] for a file that cannot be read or is too large.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, FormatError> {
    let file = || path.display().to_string();
    let unreadable = |source| FormatError::Unreadable {
        file: file(),
        source,
    };
    let opened = std::fs::File::open(path).map_err(unreadable)?;
    let length = opened.metadata().map_or(0, |about| about.len());
    let mut bytes = Vec::with_capacity(length.min(MAX_FILE + 1) as usize);
    // One byte more than allowed tells a file that is too large, whatever its length says.
    opened
        .take(MAX_FILE + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > MAX_FILE {
        return Err(FormatError::TooLarge { file: file() });
    }
    Ok(bytes)
}

/// Opens a design document, a draft or an image, whichever it is.
///
/// # Errors
/// [`FormatError`]: one line with the file, the place, what was expected and what to do.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Imported, FormatError> {
    load_bytes(&read_bytes(path)?, &path.display().to_string(), options)
}

/// What bytes are, by their content.
enum Kind {
    /// A design document.
    Ron,
    /// A weavers' draft, or any other text.
    Wif,
    /// A draft or loom file of another program.
    Loom(LoomReader),
    /// An image.
    Image,
    /// Certainly something else.
    Other(&'static str),
}

impl Kind {
    fn of(bytes: &[u8]) -> Self {
        if Encoding::of(bytes).is_some() {
            return Self::Image;
        }
        let bytes = encoding::beginning(bytes);
        if let Some((_, read)) = LOOM_FORMATS
            .iter()
            .find(|(recognises, _)| recognises(&bytes))
        {
            return Self::Loom(*read);
        }
        if let Some(found) = other_kind(&bytes) {
            return Self::Other(found);
        }
        let start = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]);
        match ron::version(&start) {
            Some(_) => Self::Ron,
            None => Self::Wif,
        }
    }
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
    match Kind::of(bytes) {
        Kind::Other(found) => Err(FormatError::Unknown {
            file: name.to_owned(),
            found,
        }),
        Kind::Image => Ok(image::design(image::read(bytes, name)?, name, options)?),
        Kind::Loom(read) => Ok(read(bytes, name, options)?),
        Kind::Wif => Ok(wif::read_with(bytes, name, options)?),
        Kind::Ron => {
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
    }
}

/// The fields that change what is read, one table a reader.
pub fn field_tables() -> Vec<field_table::Table> {
    let mut tables = vec![
        wif::FIELDS,
        dtx::FIELDS,
        wpo::FIELDS,
        dbw::FIELDS,
        jc5::FIELDS,
        volume::VOL_FIELDS,
        volume::NRRD_FIELDS,
        volume::META_IMAGE_FIELDS,
        exr::FIELDS,
    ];
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

/// How a design is written as an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SaveOptions {
    /// What of the design an image shows.
    pub content: ImageContent,
    /// Which thread black puts on the face.
    pub black: Black,
    /// Where an image starts to count; `None` = where the file did that the design is from.
    pub corner: Option<Corner>,
}

/// A design as the bytes of a file, and what of it has no place there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Saved {
    /// The file.
    pub bytes: Vec<u8>,
    /// One line each.
    pub lost: Vec<String>,
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
    let saved = save_bytes(design, &ending, options)
        .unwrap_or_else(|| Err(FormatError::Ending { file: file() }))?;
    atomic::write(path, &saved.bytes)?;
    let mut lost = saved.lost;
    if ImageFormat::of_ending(&ending).is_some() && stem(&file()) != design.name {
        lost.push(format!(
            "its name, \"{}\": images have that of their file",
            design.name
        ));
    }
    Ok(lost)
}

/// As [`save`], into memory; `None` if no format has this ending.
pub fn save_bytes(
    design: &Design,
    ending: &str,
    options: &SaveOptions,
) -> Option<Result<Saved, FormatError>> {
    let format = match ending.to_ascii_lowercase().as_str() {
        "ron" => {
            let written = ron::write(design).map_err(FormatError::from);
            return Some(written.map(|text| Saved {
                bytes: text.into_bytes(),
                lost: Vec::new(),
            }));
        }
        "wif" => {
            let written = wif::write(design).map_err(FormatError::from);
            return Some(written.map(|written| Saved {
                bytes: written.text.into_bytes(),
                lost: written.lost,
            }));
        }
        other => ImageFormat::of_ending(other)?,
    };
    Some(save_image(design, format, options))
}

fn save_image(
    design: &Design,
    format: ImageFormat,
    options: &SaveOptions,
) -> Result<Saved, FormatError> {
    let export = image::export(design, options.content, options.black, options.corner)?;
    let mut lost = export.lost;
    lost.extend(image::sett_loss(design, format.keeps_resolution()));
    Ok(Saved {
        bytes: image::encode(&export.raster, format, &design.name)?,
        lost,
    })
}

/// Reads a draft or loom file.
type LoomReader = fn(&[u8], &str, &LoadOptions) -> Result<Imported, SheetError>;

/// Tells a format by its content.
type Recogniser = fn(&[u8]) -> bool;

/// Draft and loom files: how each is known, and its reader.
const LOOM_FORMATS: [(Recogniser, LoomReader); 4] = [
    (dtx::recognises, dtx::read),
    (wpo::recognises, wpo::read),
    (dbw::recognises, dbw::read),
    (jc5::recognises, jc5::read),
];

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

const NRRD_VOLUME: &str =
    "an NRRD volume: pickglass still takes it, named .nrrd, or .nhdr with its voxels beside it";
const META_IMAGE_VOLUME: &str =
    "a MetaImage volume: pickglass still takes it, named .mha, or .mhd with its voxels beside it";

/// What bytes are that are certainly no design.
fn other_kind(bytes: &[u8]) -> Option<&'static str> {
    let kinds: [(&[u8], &str); 10] = [
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
        (b"@@StartDTX", "a Fiberworks draft"),
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
