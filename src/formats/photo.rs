//! Photographs and paintings: PNG, JPEG, BMP, TIFF and WebP as opaque 8-bit sRGB.
//!
//! Alpha is laid over white in linear light; grey and 16-bit pictures become 8-bit colour;
//! cameras' orientation is followed. Colours are taken as sRGB: a profile that says
//! otherwise, and the inks of a CMYK JPEG, are remarked on.

use std::io::{Cursor, Read};
use std::path::Path;

use glam::Vec3;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use crate::design::{MAX_SOURCE_PIXELS, SourceError, SourceImage, Srgb};
use crate::memory::{self, TooMuch};

/// The largest picture file that is opened.
const MAX_FILE: u64 = 1 << 28;
/// The most pixels that are decoded; larger than a source may be, since it is reduced.
const MAX_PIXELS: u64 = 1 << 27;

/// A picture that cannot be opened: one line with the file, what is wrong and what to do.
#[derive(Debug, thiserror::Error)]
pub enum PhotoError {
    /// The system would not give it.
    #[error("cannot read {file}: {source}; check the name and that you may read it")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not a picture of a known kind.
    #[error("{file}: expected a picture (PNG, JPEG, BMP, TIFF or WebP); choose another file")]
    Unknown {
        /// The file.
        file: String,
    },
    /// More pixels or bytes than are opened.
    #[error(
        "{file}: too large ({what}; the most is {} megapixels and {} MiB); reduce it first",
        MAX_PIXELS >> 20,
        MAX_FILE >> 20
    )]
    TooLarge {
        /// The file.
        file: String,
        /// Its size.
        what: String,
    },
    /// More than the memory that may be used.
    #[error(transparent)]
    Memory(#[from] TooMuch),
    /// A picture that breaks off or lies about itself.
    #[error("{file}: damaged picture ({problem}); save it anew with another program")]
    Damaged {
        /// The file.
        file: String,
        /// What the decoder said.
        problem: String,
    },
    /// A size that cannot be kept.
    #[error("{file}: {source}")]
    Size {
        /// The file.
        file: String,
        /// What is wrong.
        source: SourceError,
    },
}

/// A picture that was read, and what was remarked on.
#[derive(Debug, Clone, PartialEq)]
pub struct Photo {
    /// The picture.
    pub source: SourceImage,
    /// One line each.
    pub warnings: Vec<String>,
}

/// Opens a picture by its content, whatever its name.
///
/// # Errors
/// [`PhotoError`].
pub fn load(path: &Path) -> Result<Photo, PhotoError> {
    let file = path.display().to_string();
    let unreadable = |source| PhotoError::Unreadable {
        file: file.clone(),
        source,
    };
    let opened = std::fs::File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    (opened.take(MAX_FILE + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_FILE {
        let what = format!("over {} MiB", MAX_FILE >> 20);
        return Err(PhotoError::TooLarge { file, what });
    }
    read(&bytes, &file)
}

/// As [`load`], for bytes already in memory; `name` is what messages call them.
///
/// # Errors
/// [`PhotoError`].
pub fn read(bytes: &[u8], name: &str) -> Result<Photo, PhotoError> {
    let file = || name.to_owned();
    let damaged = |error: image::ImageError| PhotoError::Damaged {
        file: file(),
        // Decoders' messages may have several lines.
        problem: (error.to_string().split_whitespace().collect::<Vec<_>>()).join(" "),
    };
    let Ok(format) = image::guess_format(bytes) else {
        return Err(PhotoError::Unknown { file: file() });
    };
    let reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut decoder = match reader.into_decoder() {
        Ok(decoder) => decoder,
        Err(image::ImageError::Unsupported(_)) => {
            return Err(PhotoError::Unknown { file: file() });
        }
        Err(error) => return Err(damaged(error)),
    };
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(PhotoError::TooLarge {
            file: file(),
            what: format!("{width} × {height} pixels"),
        });
    }
    // As decoded, and as eight bits of three colours.
    let decoded = (decoder.total_bytes()).saturating_add(3 * u64::from(width) * u64::from(height));
    memory::ask(decoded, || {
        format!("{} ({width} × {height} pixels)", file())
    })?;
    let mut limits = Limits::no_limits();
    // Eight bytes a pixel and a decoder's own copies.
    limits.max_alloc = Some((1 << 26) + 3 * decoder.total_bytes());
    let limited = decoder.set_limits(limits);
    limited.map_err(damaged)?;
    let mut warnings = Vec::new();
    if let Ok(Some(profile)) = decoder.icc_profile()
        && let Some(space) = foreign_profile(&profile)
    {
        warnings.push(format!(
            "{name}: its colour profile ({space}) is not applied, colours are taken as sRGB: \
             convert it to sRGB for true colours"
        ));
    }
    if format == ImageFormat::Jpeg && jpeg_components(bytes) == Some(4) {
        warnings.push(format!(
            "{name}: its four inks (CMYK) are turned into colours without their profile: convert \
             it to sRGB for true colours"
        ));
    }
    let orientation = decoder.orientation();
    let mut picture = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    if let Ok(orientation) = orientation {
        picture.apply_orientation(orientation);
    }
    let (picture, reduced) = within_limits(picture);
    if reduced {
        warnings.push(format!(
            "{name}: reduced to {} × {} pixels, more is not kept with a design",
            picture.width(),
            picture.height()
        ));
    }
    let (width, height) = (picture.width(), picture.height());
    let source =
        SourceImage::new(width, height, opaque(picture)).map_err(|source| PhotoError::Size {
            file: file(),
            source,
        })?;
    Ok(Photo { source, warnings })
}

/// The picture with as many pixels as are kept, and whether it had more.
fn within_limits(picture: DynamicImage) -> (DynamicImage, bool) {
    let (width, height) = (f64::from(picture.width()), f64::from(picture.height()));
    let scale = (MAX_SOURCE_PIXELS as f64 / (width * height)).sqrt();
    if scale >= 1.0 {
        return (picture, false);
    }
    let side = |length: f64| (length * scale).floor().max(1.0) as u32;
    // A very long picture is one pixel high: its length is what is bounded then.
    let most = |length: u32| length.min(MAX_SOURCE_PIXELS as u32);
    let (width, height) = (most(side(width)), most(side(height)));
    (picture.thumbnail_exact(width, height), true)
}

/// 8-bit sRGB over white.
fn opaque(picture: DynamicImage) -> Vec<[u8; 3]> {
    if !picture.color().has_alpha() {
        return picture.into_rgb8().pixels().map(|pixel| pixel.0).collect();
    }
    let over_white = |[r, g, b, alpha]: [u8; 4]| match alpha {
        255 => [r, g, b],
        0 => [255; 3],
        _ => {
            let light = Vec3::ONE.lerp(Srgb(r, g, b).to_linear(), f32::from(alpha) / 255.0);
            let Srgb(r, g, b) = Srgb::from_linear(light);
            [r, g, b]
        }
    };
    picture
        .into_rgba8()
        .pixels()
        .map(|pixel| over_white(pixel.0))
        .collect()
}

/// What an ICC profile calls itself, if that is not sRGB.
///
/// The header's bytes 16 to 19 name the space of its numbers; the description is a text
/// somewhere behind it, in ASCII or UTF-16.
fn foreign_profile(profile: &[u8]) -> Option<String> {
    let letters: Vec<u8> = (profile.iter().copied())
        .filter(|byte| byte.is_ascii_graphic())
        .map(|byte| byte.to_ascii_lowercase())
        .collect();
    let says = |name: &[u8]| letters.windows(name.len()).any(|part| part == name);
    let space = String::from_utf8_lossy(profile.get(16..20)?)
        .trim()
        .to_owned();
    // The working space of greys is read with sRGB's curve or one close to it.
    if space == "GRAY" || space == "RGB" && (says(b"srgb") || says(b"iec61966-2.1")) {
        return None;
    }
    let known: [(&[u8], &str); 5] = [
        (b"displayp3", "Display P3"),
        (b"adobergb", "Adobe RGB"),
        (b"prophoto", "ProPhoto RGB"),
        (b"rec2020", "Rec. 2020"),
        (b"bt.2020", "Rec. 2020"),
    ];
    let named = known.iter().find(|(name, _)| says(name));
    Some(named.map_or_else(
        || space.chars().filter(|c| c.is_ascii_graphic()).collect(),
        |&(_, name)| name.to_owned(),
    ))
}

/// Components of a JPEG, from its frame header.
fn jpeg_components(bytes: &[u8]) -> Option<u8> {
    let mut at = 2;
    loop {
        let (&0xff, &marker) = (bytes.get(at)?, bytes.get(at + 1)?) else {
            return None;
        };
        let length = usize::from(u16::from_be_bytes([
            *bytes.get(at + 2)?,
            *bytes.get(at + 3)?,
        ]));
        match marker {
            0xff => at += 1,
            // Start of frame, all kinds; C4, C8 and CC are other things.
            0xc0..=0xcf if !matches!(marker, 0xc4 | 0xc8 | 0xcc) => {
                return bytes.get(at + 9).copied();
            }
            _ => at += 2 + length.max(2),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use image::{ImageBuffer, Luma, Rgba};

    fn png(picture: impl Into<DynamicImage>) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        picture
            .into()
            .write_to(&mut bytes, ImageFormat::Png)
            .unwrap();
        bytes.into_inner()
    }

    #[test]
    fn alpha_lies_over_white_in_linear_light() {
        let pixels: [[u8; 4]; 4] = [[0, 0, 0, 255], [0, 0, 0, 0], [0, 0, 0, 128], [9, 8, 7, 255]];
        let picture = ImageBuffer::from_fn(4, 1, |x, _| Rgba(pixels[x as usize]));
        let photo = read(&png(picture), "x").unwrap();
        let found = photo.source.pixels();
        assert_eq!(
            (found[0], found[1], found[3]),
            ([0; 3], [255; 3], [9, 8, 7])
        );
        // Half black over white is half the light: code 188, not 127.
        assert!(found[2][0].abs_diff(188) <= 1, "{:?}", found[2]);
        assert!(photo.warnings.is_empty());
    }

    #[test]
    fn sixteen_bit_grey_becomes_colour() {
        let picture = ImageBuffer::from_fn(3, 1, |x, _| Luma([(x * 32_768).min(65_535) as u16]));
        let photo = read(&png(DynamicImage::ImageLuma16(picture)), "x").unwrap();
        assert_eq!(photo.source.pixels(), [[0; 3], [128; 3], [255; 3]]);
    }

    #[test]
    fn what_is_no_picture_is_said_in_one_line() {
        let whole = png(ImageBuffer::from_fn(9, 9, |x, y| {
            Rgba([x as u8, y as u8, 9, 255])
        }));
        let cases: [(&[u8], &str); 4] = [
            (b"", "expected a picture"),
            (b"hello world, this is text", "expected a picture"),
            (&whole[..whole.len() / 2], "damaged"),
            (&whole[..12], "damaged"),
        ];
        for (bytes, expected) in cases {
            let message = read(bytes, "x.png").unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
            assert_eq!(message.lines().count(), 1, "{message}");
        }
    }

    #[test]
    fn profiles_other_than_srgb_are_named() {
        let profile = |space: &[u8; 4], text: &[u8]| {
            let mut bytes = vec![0; 128];
            bytes[16..20].copy_from_slice(space);
            bytes.extend_from_slice(text);
            foreign_profile(&bytes)
        };
        assert_eq!(profile(b"RGB ", b"desc sRGB IEC61966-2.1"), None);
        assert_eq!(profile(b"RGB ", b"\0s\0R\0G\0B\0 \0b"), None);
        assert_eq!(profile(b"GRAY", b"Dot gain"), None);
        assert_eq!(
            profile(b"RGB ", b"Display P3").as_deref(),
            Some("Display P3")
        );
        assert_eq!(profile(b"CMYK", b"Coated").as_deref(), Some("CMYK"));
        assert_eq!(foreign_profile(b"short"), None);
    }
}
