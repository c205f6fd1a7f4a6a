//! Writing images as looms and weavers' programs take them: 1 bit or 8-bit indices.
//!
//! | format | 1 bit | indexed | resolution |
//! |---|---|---|---|
//! | PNG | greyscale, or a palette of two | palette | pHYs, per metre |
//! | BMP | palette of two, bottom-up | 8 bits, bottom-up | pixels per metre |
//! | TIFF | BlackIsZero, or a palette of two | 8-bit palette | per cm, to 1/1000 |
//! | GIF | palette of two | palette | has none |
//!
//! TIFF and BMP are written without compression, which every program reads.

use std::io::Cursor;

use tiff::encoder::{Rational, TiffEncoder};
use tiff::tags::Tag;

use super::{Fault, ImageError, Pixels, Raster};
use crate::design::Srgb;

const BLACK_AND_WHITE: [Srgb; 2] = [Srgb(0, 0, 0), Srgb(255, 255, 255)];

/// The image formats that are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImageFormat {
    /// Portable network graphics.
    Png,
    /// Windows bitmap.
    Bmp,
    /// Tagged image file format.
    Tiff,
    /// Graphics interchange format.
    Gif,
}

impl ImageFormat {
    /// Every format.
    pub const ALL: [Self; 4] = [Self::Png, Self::Bmp, Self::Tiff, Self::Gif];

    /// The format of a file's ending (png, bmp, tif, tiff, gif in any case).
    pub fn of_ending(ending: &str) -> Option<Self> {
        match ending.to_ascii_lowercase().as_str() {
            "png" => Some(Self::Png),
            "bmp" => Some(Self::Bmp),
            "tif" | "tiff" => Some(Self::Tiff),
            "gif" => Some(Self::Gif),
            _ => None,
        }
    }

    /// The usual ending.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Bmp => "bmp",
            Self::Tiff => "tif",
            Self::Gif => "gif",
        }
    }

    /// Whether the format has a place for a resolution.
    pub fn keeps_resolution(self) -> bool {
        self != Self::Gif
    }
}

/// The bytes of an image file. `name` is what messages call it.
///
/// # Errors
/// [`ImageError`] for true colours and for sizes that the format has no numbers for.
pub fn encode(raster: &Raster, format: ImageFormat, name: &str) -> Result<Vec<u8>, ImageError> {
    let written = match format {
        ImageFormat::Png => png(raster),
        ImageFormat::Bmp => bmp(raster),
        ImageFormat::Tiff => tiff(raster),
        ImageFormat::Gif => gif(raster),
    };
    written.map_err(|fault| fault.named(name))
}

fn true_colours() -> Fault {
    Fault::new(
        "expected palette indices, found true colours",
        "reduce the colours first",
    )
}

fn unwritable(error: impl std::fmt::Display) -> Fault {
    Fault::new(
        format!("it cannot be encoded ({error})"),
        "choose another image format",
    )
}

fn flat(palette: &[Srgb]) -> Vec<u8> {
    palette
        .iter()
        .flat_map(|&Srgb(red, green, blue)| [red, green, blue])
        .collect()
}

/// Pixels per metre as a whole number; `None` if there is none.
fn per_metre(raster: &Raster) -> Option<(u32, u32)> {
    let (across, down) = raster.per_cm?;
    let whole = |per_cm: f32| {
        let per_metre = (f64::from(per_cm) * 100.0).round();
        (1.0..2e9).contains(&per_metre).then_some(per_metre as u32)
    };
    Some((whole(across)?, whole(down)?))
}

fn png(raster: &Raster) -> Result<Vec<u8>, Fault> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, raster.width(), raster.height());
    // Grids of indices have no gradients for filters to find.
    encoder.set_filter(png::Filter::NoFilter);
    if let Some((xppu, yppu)) = per_metre(raster) {
        let unit = png::Unit::Meter;
        encoder.set_pixel_dims(Some(png::PixelDimensions { xppu, yppu, unit }));
    }
    let (depth, bytes) = match raster.pixels() {
        Pixels::Bits(bits) => (png::BitDepth::One, bits),
        Pixels::Indices(indices) => (png::BitDepth::Eight, indices),
        Pixels::Colours(_) => return Err(true_colours()),
    };
    encoder.set_depth(depth);
    if depth == png::BitDepth::One && raster.palette() == BLACK_AND_WHITE {
        encoder.set_color(png::ColorType::Grayscale);
    } else {
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(flat(raster.palette()));
    }
    let mut writer = encoder.write_header().map_err(unwritable)?;
    writer.write_image_data(bytes).map_err(unwritable)?;
    writer.finish().map_err(unwritable)?;
    Ok(file)
}

/// A BITMAPINFOHEADER, its palette, and rows from the bottom padded to 4 bytes.
fn bmp(raster: &Raster) -> Result<Vec<u8>, Fault> {
    let (bits, bytes) = match raster.pixels() {
        Pixels::Bits(bits) => (1u16, bits),
        Pixels::Indices(indices) => (8, indices),
        Pixels::Colours(_) => return Err(true_colours()),
    };
    let used = (raster.width() as usize * usize::from(bits)).div_ceil(8);
    let stride = used.next_multiple_of(4);
    let palette = raster.palette();
    let pixels_at = 14 + 40 + 4 * palette.len();
    let size = stride * raster.height() as usize;
    let number = |value: usize| u32::try_from(value).map_err(|_| unwritable("more than 4 GiB"));
    let (across, down) = per_metre(raster).unwrap_or_default();
    let mut file = Vec::with_capacity(pixels_at + size);
    file.extend(b"BM");
    file.extend(number(pixels_at + size)?.to_le_bytes());
    file.extend([0; 4]);
    file.extend(number(pixels_at)?.to_le_bytes());
    file.extend(40u32.to_le_bytes());
    file.extend(raster.width().to_le_bytes());
    file.extend(raster.height().to_le_bytes());
    file.extend(1u16.to_le_bytes());
    file.extend(bits.to_le_bytes());
    file.extend(0u32.to_le_bytes());
    file.extend(number(size)?.to_le_bytes());
    file.extend(across.to_le_bytes());
    file.extend(down.to_le_bytes());
    file.extend(number(palette.len())?.to_le_bytes());
    file.extend(0u32.to_le_bytes());
    for &Srgb(red, green, blue) in palette {
        file.extend([blue, green, red, 0]);
    }
    for row in bytes.chunks(used).rev() {
        file.extend_from_slice(row);
        file.resize(file.len() + stride - used, 0);
    }
    Ok(file)
}

/// One strip, uncompressed; the tags of a baseline bilevel or palette image.
fn tiff(raster: &Raster) -> Result<Vec<u8>, Fault> {
    let (bits, bytes) = match raster.pixels() {
        Pixels::Bits(bits) => (1u16, bits),
        Pixels::Indices(indices) => (8, indices),
        Pixels::Colours(_) => return Err(true_colours()),
    };
    let bilevel = bits == 1 && raster.palette() == BLACK_AND_WHITE;
    let mut file = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut file).map_err(unwritable)?;
    let mut directory = encoder.image_directory().map_err(unwritable)?;
    let mut write = || -> tiff::TiffResult<()> {
        let offset = directory.write_data(bytes.as_slice())?;
        directory.write_tag(Tag::NewSubfileType, 0u32)?;
        directory.write_tag(Tag::ImageWidth, raster.width())?;
        directory.write_tag(Tag::ImageLength, raster.height())?;
        directory.write_tag(Tag::BitsPerSample, bits)?;
        directory.write_tag(Tag::Compression, 1u16)?;
        directory.write_tag(
            Tag::PhotometricInterpretation,
            if bilevel { 1u16 } else { 3 },
        )?;
        directory.write_tag(Tag::StripOffsets, u32::try_from(offset)?)?;
        directory.write_tag(Tag::SamplesPerPixel, 1u16)?;
        directory.write_tag(Tag::RowsPerStrip, raster.height())?;
        directory.write_tag(Tag::StripByteCounts, u32::try_from(bytes.len())?)?;
        let (across, down) = raster.per_cm.unwrap_or((72.0 / 2.54, 72.0 / 2.54));
        let rational = |per_cm: f32| Rational {
            n: (f64::from(per_cm) * 1000.0).round().clamp(1.0, 4e9) as u32,
            d: 1000,
        };
        directory.write_tag(Tag::XResolution, rational(across))?;
        directory.write_tag(Tag::YResolution, rational(down))?;
        directory.write_tag(Tag::ResolutionUnit, 3u16)?;
        directory.write_tag(Tag::Software, "Pickglass")?;
        if !bilevel {
            // All reds, then all greens, then all blues, each from 0 to 65535.
            let mut map = vec![0u16; 3 << bits];
            for (at, &Srgb(red, green, blue)) in raster.palette().iter().enumerate() {
                for (channel, value) in [red, green, blue].into_iter().enumerate() {
                    map[(channel << bits) + at] = u16::from(value) * 257;
                }
            }
            directory.write_tag(Tag::ColorMap, map.as_slice())?;
        }
        Ok(())
    };
    write().map_err(unwritable)?;
    directory.finish().map_err(unwritable)?;
    Ok(file.into_inner())
}

fn gif(raster: &Raster) -> Result<Vec<u8>, Fault> {
    let side = |pixels: u32| {
        u16::try_from(pixels).map_err(|_| {
            let problem = format!("a GIF has at most 65535 pixels along a side, not {pixels}");
            Fault::new(problem, "choose PNG, BMP or TIFF")
        })
    };
    let (width, height) = (side(raster.width())?, side(raster.height())?);
    let unpacked: Vec<u8>;
    let indices: &[u8] = match raster.pixels() {
        Pixels::Indices(indices) => indices,
        Pixels::Bits(bits) => {
            let across = raster.width() as usize;
            let mut all = Vec::with_capacity(across * raster.height() as usize + 8);
            for row in bits.chunks(across.div_ceil(8)) {
                super::raster::unpack(row, 1, across, &mut all);
            }
            unpacked = all;
            &unpacked
        }
        Pixels::Colours(_) => return Err(true_colours()),
    };
    let mut file = Vec::new();
    let palette = flat(raster.palette());
    let mut encoder = gif::Encoder::new(&mut file, width, height, &palette).map_err(unwritable)?;
    let frame = gif::Frame::from_indexed_pixels(width, height, indices, None);
    encoder.write_frame(&frame).map_err(unwritable)?;
    drop(encoder);
    Ok(file)
}
