//! One file a format, reading and writing.
//!
//! [`load`] recognises a design or draft by its content, not by its name. `ron` is the
//! design document, `wif` the weavers' interchange format; `atomic` writes files so that
//! nothing is ever half-written. `volume` takes
//! cloth out as voxels and reads them in; `yarns` takes it out as curves and tubes.

pub mod atomic;
pub mod exr;
pub mod png;
pub mod presets;
pub mod ron;
pub mod volume;
pub mod wif;
pub mod yarns;

use std::io::Read;
use std::path::Path;

use crate::design::{Density, Design, Family, Sett};

/// A design that was read, and what the reader had to decide for itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The design.
    pub design: Design,
    /// One line each: what was odd in the file and what was made of it.
    pub warnings: Vec<String>,
}

/// What the person who opens a file knows better than the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoadOptions {
    /// Ends and picks per cm, instead of the file's.
    pub sett: Option<(f32, f32)>,
    /// What yarns are made of where the file does not say; `None` = cotton.
    pub family: Option<Family>,
}

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
        "{file}: expected a design (.ron) or a draft (.wif), found {found}; choose another file"
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
pub const MAX_FILE: u64 = 1 << 28;

/// Opens a design document or a draft, whichever it is.
///
/// # Errors
/// [`FormatError`]: one line with the file, the place, what was expected and what to do.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Imported, FormatError> {
    let file = || path.display().to_string();
    let unreadable = |source| FormatError::Unreadable {
        file: file(),
        source,
    };
    let opened = std::fs::File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    // One byte more than allowed tells a file that is too large, whatever its length says.
    opened
        .take(MAX_FILE + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > MAX_FILE {
        return Err(FormatError::TooLarge { file: file() });
    }
    load_bytes(&bytes, &file(), options)
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
    if let Some(found) = other_kind(bytes) {
        let file = name.to_owned();
        return Err(FormatError::Unknown { file, found });
    }
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]);
    if ron::version(&start).is_none() {
        return Ok(wif::read_with(bytes, name, options)?);
    }
    let design = ron::read(bytes, name)?;
    Ok(Imported {
        design: with_options(design, name, options)?,
        warnings: Vec::new(),
    })
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

/// What bytes are that are certainly no text.
fn other_kind(bytes: &[u8]) -> Option<&'static str> {
    let kinds: [(&[u8], &str); 9] = [
        (b"\x89PNG", "a PNG image"),
        (b"\xff\xd8\xff", "a JPEG image"),
        (b"GIF8", "a GIF image"),
        (b"BM", "a BMP image"),
        (b"II*\0", "a TIFF image"),
        (b"MM\0*", "a TIFF image"),
        (b"PK\x03\x04", "an archive"),
        (b"@@StartDTX", "a Fiberworks draft"),
        (b"{", "JSON"),
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
        assert!(message(b"\x89PNG\r\n").contains("found a PNG image"));
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
