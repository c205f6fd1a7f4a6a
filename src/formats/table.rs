//! The table of formats that designs are read from and written to: one row a format, from
//! which opening, saving, dialogs, messages, the help and the README's table come.

use std::fmt::Write;

use super::error::FormatError;
use super::field_table::Table;
use super::image::Encoding;
use super::reading::{Imported, LoadOptions};
use super::sheet::SheetError;
use super::writing::{SaveOptions, Saved};
use super::{dbw, designs, dtx, jc5, wif, wpo};
use crate::design::Design;

/// What kind of thing a format holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A whole design.
    Design,
    /// A weaver's draft.
    Draft,
    /// The cards of a loom.
    Loom,
    /// A weave, artwork or yarns, a pixel a crossing.
    Image,
    /// A photograph, which is no weave unless somebody says so.
    Picture,
}

/// One format.
pub struct Format {
    /// What it is called in messages.
    pub name: &'static str,
    /// What it holds.
    pub kind: Kind,
    /// The endings of its files; the first is the usual one.
    pub endings: &'static [&'static str],
    /// What the README says of it.
    pub notes: &'static str,
    /// Fields of its files that change what is read.
    pub fields: &'static [Table],
    recognises: Recogniser,
    read: Reading,
    write: Option<Writer>,
}

/// How a file is told.
enum Recogniser {
    /// By its bytes.
    Bytes(fn(&[u8]) -> bool),
    /// By its beginning, as UTF-8 where it is a text.
    Beginning(fn(&[u8]) -> bool),
}

/// Reads a file; the name is what messages call it.
type Reader = fn(&[u8], &str, &LoadOptions) -> Result<Imported, FormatError>;
/// Reads a draft or the cards of a loom.
type SheetReader = fn(&[u8], &str, &LoadOptions) -> Result<Imported, SheetError>;
/// Writes a design into a file with this ending.
type Writer = fn(&Design, &str, &SaveOptions) -> Result<Saved, FormatError>;

/// How a file is read.
enum Reading {
    Any(Reader),
    Sheet(SheetReader),
}

const CARDS: &str = "Stäubli card files; written into the hooks of a file of the loom (`--like`) or of a known loom (`--loom`), face up or `--face-down` (the window asks)";
const DESIGN: &str =
    "the design itself, versioned; fields that are not known are left out, and named";
const FIBERWORKS: &str = "drafts of Fiberworks; texts of drafts are UTF-8, UTF-16 or Windows-1252";
const IMAGE: &str = "weaves in 1 bit, artwork and yarn maps indexed; the resolution is the sett";
const PICTURE: &str = "a weave only when told, with a warning";
const TIFF: &str = "as PNG: strips, tiles, palettes, either polarity and bit order, PackBits, LZW, deflate, CCITT group 4";
const WIF: &str = "WIF 1.1, with the quirks of real programs; unknown sections are kept";

/// All formats, in the order in which files are tried.
#[rustfmt::skip]
pub static FORMATS: &[Format] = &[
    image("PNG", &["png"], IMAGE, |bytes| is(bytes, Encoding::Png)).written(designs::write_image),
    image("BMP", &["bmp"], "as PNG", |bytes| is(bytes, Encoding::Bmp)).written(designs::write_image),
    image("TIFF", &["tif", "tiff"], TIFF, |bytes| is(bytes, Encoding::Tiff)).written(designs::write_image),
    image("GIF", &["gif"], "as PNG; has no place for a resolution", |bytes| is(bytes, Encoding::Gif)).written(designs::write_image),
    image("PCX", &["pcx"], "as PNG", |bytes| is(bytes, Encoding::Pcx)),
    image("JPEG", &["jpg", "jpeg"], PICTURE, |bytes| is(bytes, Encoding::Jpeg)).of_kind(Kind::Picture),
    image("WebP", &["webp"], PICTURE, |bytes| is(bytes, Encoding::WebP)).of_kind(Kind::Picture),
    draft("DTX", &["dtx"], FIBERWORKS, &[dtx::FIELDS], dtx::recognises, dtx::read),
    draft("WPO", &["wpo"], "drafts of WeavePoint", &[wpo::FIELDS], wpo::recognises, wpo::read),
    draft("DBW", &["dbw"], "drafts of DB-WEAVE", &[dbw::FIELDS], dbw::recognises, dbw::read),
    draft("JC5", &["jc5"], CARDS, &[jc5::FIELDS], jc5::recognises, jc5::read).of_kind(Kind::Loom).written(designs::write_cards),
    text("RON", &["ron"], DESIGN, &[], designs::is_document, designs::read_document).of_kind(Kind::Design).written(designs::write_document),
    // Any other text is taken for one, and its reader says what is wrong with it.
    text("WIF", &["wif"], WIF, &[wif::FIELDS], |_| false, designs::read_wif).written(designs::write_wif),
];

fn is(bytes: &[u8], encoding: Encoding) -> bool {
    Encoding::of(bytes) == Some(encoding)
}

/// A row of images.
const fn image(
    name: &'static str,
    endings: &'static [&'static str],
    notes: &'static str,
    recognises: fn(&[u8]) -> bool,
) -> Format {
    let read = Reading::Any(designs::read_image);
    row(
        name,
        endings,
        notes,
        &[],
        Recogniser::Bytes(recognises),
        read,
    )
    .of_kind(Kind::Image)
}

/// A row of texts.
const fn text(
    name: &'static str,
    endings: &'static [&'static str],
    notes: &'static str,
    fields: &'static [Table],
    recognises: fn(&[u8]) -> bool,
    read: Reader,
) -> Format {
    let known = Recogniser::Beginning(recognises);
    row(name, endings, notes, fields, known, Reading::Any(read))
}

/// A row of drafts of other programs.
const fn draft(
    name: &'static str,
    endings: &'static [&'static str],
    notes: &'static str,
    fields: &'static [Table],
    recognises: fn(&[u8]) -> bool,
    read: SheetReader,
) -> Format {
    let known = Recogniser::Beginning(recognises);
    row(name, endings, notes, fields, known, Reading::Sheet(read))
}

/// A row of drafts that are read.
const fn row(
    name: &'static str,
    endings: &'static [&'static str],
    notes: &'static str,
    fields: &'static [Table],
    recognises: Recogniser,
    read: Reading,
) -> Format {
    Format {
        name,
        kind: Kind::Draft,
        endings,
        notes,
        fields,
        recognises,
        read,
        write: None,
    }
}

impl Format {
    const fn of_kind(mut self, kind: Kind) -> Self {
        self.kind = kind;
        self
    }

    const fn written(mut self, write: Writer) -> Self {
        self.write = Some(write);
        self
    }

    /// Whether bytes, whose beginning as UTF-8 is `text`, are a file of it for certain.
    pub fn recognises(&self, bytes: &[u8], text: &[u8]) -> bool {
        match self.recognises {
            Recogniser::Bytes(recognises) => recognises(bytes),
            Recogniser::Beginning(recognises) => recognises(text),
        }
    }

    /// Reads a file; `name` is what messages call it.
    ///
    /// # Errors
    /// [`FormatError`]: one line with the file, the place, what was expected and what to do.
    pub fn read(
        &self,
        bytes: &[u8],
        name: &str,
        options: &LoadOptions,
    ) -> Result<Imported, FormatError> {
        match self.read {
            Reading::Any(read) => read(bytes, name, options),
            Reading::Sheet(read) => Ok(read(bytes, name, options)?),
        }
    }

    /// Writes a design into a file with this ending; `None` if it is not written.
    pub fn write(
        &self,
        design: &Design,
        ending: &str,
        options: &SaveOptions,
    ) -> Option<Result<Saved, FormatError>> {
        self.write.map(|write| write(design, ending, options))
    }

    /// Whether designs are written in it.
    pub fn is_written(&self) -> bool {
        self.write.is_some()
    }

    /// Its row of the README's table.
    pub fn row(&self) -> String {
        let endings = self.endings.iter().map(|ending| format!("`.{ending}`"));
        let endings: Vec<String> = endings.collect();
        let read = match self.kind {
            Kind::Picture => "as pictures",
            _ => "yes",
        };
        let written = if self.is_written() { "yes" } else { "–" };
        format!(
            "| {} | {read} | {written} | {} |",
            endings.join(" "),
            self.notes
        )
    }
}

/// The format of a file's ending, in any case.
pub fn of_ending(ending: &str) -> Option<&'static Format> {
    let known = |format: &&Format| {
        let mut endings = format.endings.iter();
        endings.any(|known| known.eq_ignore_ascii_case(ending))
    };
    FORMATS.iter().find(known)
}

/// The endings of formats, in the order of the table.
pub fn endings(wanted: impl Fn(&Format) -> bool) -> Vec<&'static str> {
    let formats = FORMATS.iter().filter(|format| wanted(format));
    formats.flat_map(|format| format.endings).copied().collect()
}

/// The usual endings of formats in words: `.png, .bmp or .tif`.
pub fn endings_in_words(wanted: impl Fn(&Format) -> bool, last: &str) -> String {
    let formats: Vec<_> = FORMATS.iter().filter(|format| wanted(format)).collect();
    let mut words = String::new();
    for (place, format) in formats.iter().enumerate() {
        let before = match place {
            0 => "",
            _ if place + 1 == formats.len() => last,
            _ => ", ",
        };
        // Writing into a string does not fail.
        let _ = write!(words, "{before}.{}", format.endings[0]);
    }
    words
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn readme_has_the_row_of_every_format() {
        let readme = include_str!("../../README.md");
        for format in FORMATS {
            assert!(readme.contains(&format.row()), "{}", format.row());
        }
    }

    #[test]
    fn an_ending_names_one_format() {
        let all = endings(|_| true);
        let different: HashSet<_> = all.iter().collect();
        assert_eq!(different.len(), all.len());
        for format in FORMATS {
            for ending in format.endings {
                assert_eq!(of_ending(&ending.to_uppercase()).unwrap().name, format.name);
            }
        }
        assert!(of_ending("psd").is_none() && of_ending("").is_none());
        let images = endings_in_words(
            |format| format.kind == Kind::Image && format.is_written(),
            " or ",
        );
        assert_eq!(images, ".png, .bmp, .tif or .gif");
    }
}
