//! Images as designs: PNG, BMP, TIFF, GIF and PCX, and JPEG and WebP as pictures.
//!
//! A file's bytes become a [`Raster`] (indices and palette, or true colours); a raster
//! becomes a design by an [`ImageReading`], and a design becomes a raster again by
//! [`export`]. One pixel is one crossing.
//!
//! | file | does |
//! |---|---|
//! | `raster` | pixels, palette, counting colours |
//! | `png`, `bmp`, `tiff`, `gif`, `pcx`, `photo` | one reader each |
//! | `tags` | what a file says beside its pixels; the tables of fields |
//! | `encode` | one writer for each format that looms take |
//! | `reading` | what an image is and how it is read; presets by maker |
//! | `import` | raster → design; `numbers` are its colours as regions or yarns |
//! | `yarn_maps` | rasters → the yarns of a design |
//! | `export` | design → raster, and what is lost |
//!
//! * **Colour, not bits.** What is black is decided by what is displayed, whatever the
//!   file's polarity, palette order or bit order. Two colours: the darker one is black;
//!   more: luma below one half. Transparent pixels, those of a colour key too, are white
//!   paper; colours shine through in linear light. Colours are taken as sRGB.
//! * **Orientation.** The image is the face of the cloth as every viewer shows it, with
//!   its orientation followed, its top row the last pick. A
//!   file that starts to count in another corner says so by [`Corner`]; see there.
//! * **Size** is checked against [`crate::design::MAX_CROSSINGS`] and against what the
//!   file's bytes can hold at the format's best compression, before memory is asked for.
//! * **Resolution** is the sett: pixels per cm are ends and picks per cm, unless they are
//!   an image program's default (72, 96 or 300 dpi).

mod bmp;
mod encode;
mod export;
mod gif;
mod import;
mod numbers;
mod pcx;
mod photo;
mod png;
mod raster;
mod reading;
mod tags;
mod tiff;
mod yarn_maps;

pub use encode::{ImageFormat, encode};
pub(in crate::formats) use export::sett_loss;
pub use export::{Export, ImageContent, export};
pub use import::design;
pub use raster::{Colours, MAX_COLOURS, Pixels, Raster, RasterError, luma};
pub use reading::{Black, Convention, Corner, ImageAs, ImageReading, Key};
pub use tags::TABLES;
pub use yarn_maps::{Maps, with_maps};

use crate::design::check_size;

/// An image that could not be read as a design, or a design that no image can hold: one
/// line with the file, what was expected and what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {problem}; {remedy}")]
pub struct ImageError {
    /// The file, as the reader was told.
    pub file: String,
    /// What was expected and what was found.
    pub problem: String,
    /// What to do about it.
    pub remedy: String,
    /// Of an image that is a picture, to be posterised first: how many colours it has, in
    /// words.
    pub picture: Option<String>,
}

/// What is wrong with an image, before the file's name is known.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Fault {
    problem: String,
    remedy: &'static str,
}

/// What to do about a file that was cut off or damaged.
const SAVE_AGAIN: &str = "copy or save it again";
/// What to do about a kind of image that is not read.
const SAVE_PLAIN: &str = "save it as an indexed or 1-bit PNG, BMP or TIFF";

impl Fault {
    fn new(problem: impl Into<String>, remedy: &'static str) -> Self {
        // Decoders' messages may span lines; ours are one.
        let problem: String = problem.into();
        let problem = problem.split_whitespace().collect::<Vec<_>>().join(" ");
        Self { problem, remedy }
    }

    fn damaged(what: impl std::fmt::Display) -> Self {
        Self::new(format!("the image is damaged ({what})"), SAVE_AGAIN)
    }

    fn named(self, file: &str) -> ImageError {
        ImageError {
            file: file.to_owned(),
            problem: self.problem,
            remedy: self.remedy.to_owned(),
            picture: None,
        }
    }
}

impl From<RasterError> for Fault {
    fn from(error: RasterError) -> Self {
        Self::damaged(error)
    }
}

/// The image formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// Portable network graphics.
    Png,
    /// Windows bitmap.
    Bmp,
    /// Tagged image file format, BigTIFF too.
    Tiff,
    /// Graphics interchange format.
    Gif,
    /// PC Paintbrush.
    Pcx,
    /// JPEG: pictures only.
    Jpeg,
    /// WebP: pictures only.
    WebP,
}

impl Encoding {
    /// The format of bytes, by their content; `None` if they are no image.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let starts: [(&[u8], Self); 10] = [
            (b"\x89PNG", Self::Png),
            (b"BM", Self::Bmp),
            (b"II*\0", Self::Tiff),
            (b"MM\0*", Self::Tiff),
            (b"II+\0", Self::Tiff),
            (b"MM\0+", Self::Tiff),
            (b"GIF87a", Self::Gif),
            (b"GIF89a", Self::Gif),
            (b"\xff\xd8\xff", Self::Jpeg),
            (b"RIFF", Self::WebP),
        ];
        let found = starts.iter().find(|(start, _)| bytes.starts_with(start));
        match found {
            Some((_, Self::WebP)) if bytes.get(8..12) != Some(b"WEBP") => None,
            Some(&(_, encoding)) => Some(encoding),
            None => pcx::recognised(bytes).then_some(Self::Pcx),
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Bmp => "BMP",
            Self::Tiff => "TIFF",
            Self::Gif => "GIF",
            Self::Pcx => "PCX",
            Self::Jpeg => "JPEG",
            Self::WebP => "WebP",
        }
    }

    /// Whether its compression changes colours, so that it holds pictures only.
    pub fn lossy(self) -> bool {
        matches!(self, Self::Jpeg | Self::WebP)
    }
}

/// An image that was read, and what the reader had to decide for itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoded {
    /// The pixels.
    pub raster: Raster,
    /// The format they came in.
    pub encoding: Encoding,
    /// One line each.
    pub warnings: Vec<String>,
}

/// Reads an image of any format that [`Encoding::of`] knows. `name` is the file's name,
/// for messages.
///
/// # Errors
/// [`ImageError`]: one line with the file, what is wrong and what to do.
pub fn read(bytes: &[u8], name: &str) -> Result<Decoded, ImageError> {
    read_kind(bytes, name, false)
}

/// As [`read`], with the kinds of TIFF that only pictures come in: JPEG compression,
/// fractions, floating point.
///
/// # Errors
/// As [`read`].
pub fn read_picture(bytes: &[u8], name: &str) -> Result<Decoded, ImageError> {
    let mut decoded = read_kind(bytes, name, true)?;
    if let Some((across, down)) = decoded.raster.per_cm
        && !(0.99..=1.01).contains(&(across / down))
    {
        decoded.warnings.push(format!(
            "its pixels are not square (resolution {across:.4} × {down:.4} per cm): the picture is \
             taken as if they were"
        ));
    }
    Ok(decoded)
}

fn read_kind(bytes: &[u8], name: &str, picture: bool) -> Result<Decoded, ImageError> {
    let Some(encoding) = Encoding::of(bytes) else {
        return Err(Fault::new("expected an image, found something else", SAVE_PLAIN).named(name));
    };
    let tags = tags::Tags::of(bytes, encoding);
    let mut warnings = Vec::new();
    let read = match encoding {
        Encoding::Png => png::read(bytes, &mut warnings),
        Encoding::Bmp => bmp::read(bytes, &mut warnings),
        Encoding::Tiff => match tiff::read(bytes, &mut warnings) {
            Err(fault) if picture && fault.remedy == SAVE_PLAIN => {
                photo::tiff(bytes, &mut warnings)
            }
            read => read,
        },
        Encoding::Gif => gif::read(bytes, &mut warnings),
        Encoding::Pcx => pcx::read(bytes, &mut warnings),
        Encoding::Jpeg | Encoding::WebP => photo::read(bytes, encoding, &mut warnings),
    };
    let turned = read.and_then(|mut raster| {
        raster.per_cm = raster.per_cm.or(tags.per_cm);
        Ok(tags.turn.apply(raster)?)
    });
    warnings.extend(tags.warnings);
    if tags.inks {
        warnings.push(
            "its four inks (CMYK) are turned into colours without their profile: convert it to \
             sRGB for true colours"
                .to_owned(),
        );
    }
    match turned {
        Ok(raster) => Ok(Decoded {
            raster,
            encoding,
            warnings,
        }),
        Err(fault) => Err(Fault {
            problem: format!("{}: {}", encoding.name(), fault.problem),
            remedy: fault.remedy,
        }
        .named(name)),
    }
}

/// The most pixels of an image in true colours (768 MiB).
const MOST_COLOURED: u64 = 1 << 28;

/// Refuses a declared size that no design has, or that `bytes` bytes cannot hold at
/// `most_per_byte` pixels a byte, before memory is asked for.
fn check_declared(
    width: u64,
    height: u64,
    bytes: usize,
    most_per_byte: u64,
) -> Result<(u32, u32), Fault> {
    if width == 0 || height == 0 {
        let problem = format!("{width} × {height} pixels are declared, which is no image");
        return Err(Fault::new(problem, SAVE_AGAIN));
    }
    if check_size(width, height).is_err() {
        let problem = format!(
            "{width} × {height} pixels are declared, more than a design may have \
             ({})",
            crate::design::MAX_CROSSINGS
        );
        return Err(Fault::new(problem, "cut it into parts"));
    }
    if width * height > (bytes as u64 + 64).saturating_mul(most_per_byte) {
        let problem = format!(
            "{width} × {height} pixels are declared, but its {bytes} bytes cannot hold them"
        );
        return Err(Fault::new(problem, SAVE_AGAIN));
    }
    // Both are at most MAX_CROSSINGS by now.
    Ok((width as u32, height as u32))
}

/// Refuses a picture in true colours that is too large to hold: three bytes a pixel, which
/// are only looked at to tell regions or yarns apart.
fn check_coloured((width, height): (u32, u32)) -> Result<(), Fault> {
    if u64::from(width) * u64::from(height) > MOST_COLOURED {
        let problem = format!(
            "{width} × {height} pixels in true colours, of which at most {MOST_COLOURED} are read"
        );
        return Err(Fault::new(
            problem,
            "save it with a palette, or cut it into parts",
        ));
    }
    ask_memory((width, height), 3)
}

/// Asks for a picture's memory before it is taken.
fn ask_memory((width, height): (u32, u32), bytes_a_pixel: u64) -> Result<(), Fault> {
    let pixels = u64::from(width) * u64::from(height);
    let what = || format!("a picture of {width} × {height} pixels");
    crate::memory::ask(pixels.saturating_mul(bytes_a_pixel), what)
        .map_err(|error| Fault::new(error.to_string(), "scale it down"))
}

/// Remembers one warning once.
fn remark(warnings: &mut Vec<String>, what: &str) {
    if !warnings.iter().any(|known| known == what) {
        warnings.push(what.to_owned());
    }
}

const TRANSPARENT: &str = "transparent pixels are read as white paper";

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn declared_sizes_are_checked_before_memory() {
        assert!(check_declared(100, 100, 100, 100).is_ok());
        let message = check_declared(3_000_000, 2_000_000, 1 << 20, 8).unwrap_err();
        assert!(message.problem.contains("more than a design"));
        let message = check_declared(16_384, 16_384, 100, 1024).unwrap_err();
        assert!(message.problem.contains("cannot hold them"));
        assert!(check_declared(16_000, 20_000, 1 << 20, 8256).is_ok());
        assert!(check_coloured((16_384, 16_384)).is_ok());
        let message = check_coloured((16_000, 20_000)).unwrap_err();
        assert!(message.remedy.contains("palette"));
        assert!(check_declared(0, 7, 100, 100).is_err());
        assert!(check_declared(u64::MAX, u64::MAX, usize::MAX, u64::MAX).is_err());
    }

    #[test]
    fn formats_are_known_by_content() {
        assert_eq!(Encoding::of(b"BM123"), Some(Encoding::Bmp));
        assert_eq!(Encoding::of(b"RIFF1234WEBPVP8 "), Some(Encoding::WebP));
        assert_eq!(Encoding::of(b"RIFF1234WAVE"), None);
        assert_eq!(Encoding::of(b""), None);
        assert_eq!(Encoding::of(b"[WIF]"), None);
    }
}
