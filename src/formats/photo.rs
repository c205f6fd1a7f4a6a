//! Photographs and paintings, of any format of [`image`](mod@super::image), as opaque 8-bit
//! sRGB.
//!
//! Orientation, transparency, colour keys and profiles are those of `image`: a picture and a
//! weave are read by one rule.

use std::io::Read;
use std::path::Path;

use ::image::{DynamicImage, RgbImage};

use super::image::{self as raster, Encoding, ImageError, Pixels, Raster};
use crate::design::{MAX_SOURCE_PIXELS, SourceError, SourceImage, Srgb};
use crate::memory::{self, TooMuch};

/// The largest picture file that is opened.
const MAX_FILE: u64 = 1 << 28;
/// The most pixels that are taken; larger than a source may be, since it is reduced.
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
    #[error(
        "{file}: expected a picture (PNG, JPEG, BMP, TIFF, WebP, GIF or PCX); choose another file"
    )]
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
    #[error(transparent)]
    Damaged(#[from] ImageError),
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
    if Encoding::of(bytes).is_none() {
        return Err(PhotoError::Unknown { file: file() });
    }
    let decoded = raster::read_picture(bytes, name)?;
    let (width, height) = (decoded.raster.width(), decoded.raster.height());
    let pixels = u64::from(width) * u64::from(height);
    if pixels > MAX_PIXELS {
        return Err(PhotoError::TooLarge {
            file: file(),
            what: format!("{width} × {height} pixels"),
        });
    }
    // As colours, and once more where it is reduced.
    memory::ask(6 * pixels, file)?;
    let mut warnings: Vec<String> = (decoded.warnings.iter())
        .map(|line| format!("{name}: {line}"))
        .collect();
    let (mut across, mut down) = (width, height);
    let mut colours = colours(decoded.raster);
    if pixels > MAX_SOURCE_PIXELS {
        ((across, down), colours) = reduced((width, height), colours);
        warnings.push(format!(
            "{name}: reduced to {across} × {down} pixels, more is not kept with a design"
        ));
    }
    let source = SourceImage::new(across, down, colours).map_err(|source| PhotoError::Size {
        file: file(),
        source,
    })?;
    Ok(Photo { source, warnings })
}

/// The displayed colours, row by row.
fn colours(picture: Raster) -> Vec<[u8; 3]> {
    if let Pixels::Colours(_) = picture.pixels() {
        return picture.into_colours();
    }
    let (width, height) = (picture.width(), picture.height());
    let row = |y| (0..width).map(move |x| (x, y));
    (0..height)
        .flat_map(row)
        .map(|(x, y)| {
            let Srgb(red, green, blue) = picture.colour(x, y);
            [red, green, blue]
        })
        .collect()
}

/// A picture of as many pixels as are kept.
fn reduced((width, height): (u32, u32), colours: Vec<[u8; 3]>) -> ((u32, u32), Vec<[u8; 3]>) {
    let (across, down) = (f64::from(width), f64::from(height));
    let scale = (MAX_SOURCE_PIXELS as f64 / (across * down)).sqrt();
    let side = |length: f64| (length * scale).floor().max(1.0) as u32;
    // A very long picture is one pixel high: its length is what is bounded then.
    let most = |length: u32| length.min(MAX_SOURCE_PIXELS as u32);
    let (across, down) = (most(side(across)), most(side(down)));
    // A colour for each pixel: there is always a picture.
    let picture = RgbImage::from_raw(width, height, colours.into_flattened()).unwrap_or_default();
    let picture = DynamicImage::ImageRgb8(picture).thumbnail_exact(across, down);
    let colours = picture.into_rgb8().into_raw();
    ((across, down), colours.as_chunks::<3>().0.to_vec())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use ::image::{ImageBuffer, ImageFormat, Luma, Rgba};
    use std::io::Cursor;

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
        assert_eq!(
            photo.warnings,
            ["x: transparent pixels are read as white paper"]
        );
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
}
