//! JPEG and WebP, and the TIFFs that only pictures come in, decoded by the `image` crate
//! into true colours.

use std::io::Cursor;

use image::codecs::jpeg::JpegDecoder;
use image::codecs::tiff::TiffDecoder;
use image::codecs::webp::WebPDecoder;
use image::{ColorType, DynamicImage, ImageDecoder, Limits};

use super::raster::over_white;
use super::{
    Encoding, Fault, Pixels, Raster, SAVE_PLAIN, TRANSPARENT, ask_memory, check_declared, remark,
};
use crate::design::Srgb;

/// A pixel costs a JPEG no less than a bit for each block of 8 × 8, and so a WebP with the
/// simplest prediction; more is made to fill memory.
const MOST_PER_BYTE: u64 = 2048;

/// Deflate does not better than 1032 to 1, and a byte holds 8 pixels.
const MOST_PER_BYTE_TIFF: u64 = 1032 * 8;

/// The largest picture, 128 million pixels: what a camera takes.
const MOST_PIXELS: u64 = 1 << 27;

pub(super) fn read(
    bytes: &[u8],
    encoding: Encoding,
    warnings: &mut Vec<String>,
) -> Result<Raster, Fault> {
    match encoding {
        Encoding::WebP => {
            let decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(Fault::damaged)?;
            sized(decoder, bytes.len(), MOST_PER_BYTE, warnings)
        }
        _ => {
            let decoder = JpegDecoder::new(Cursor::new(bytes)).map_err(Fault::damaged)?;
            sized(decoder, bytes.len(), MOST_PER_BYTE, warnings)
        }
    }
}

/// A TIFF of a kind that no weave comes in.
pub(super) fn tiff(bytes: &[u8], warnings: &mut Vec<String>) -> Result<Raster, Fault> {
    let decoder = TiffDecoder::new(Cursor::new(bytes))
        .map_err(|error| Fault::new(error.to_string(), SAVE_PLAIN))?;
    sized(decoder, bytes.len(), MOST_PER_BYTE_TIFF, warnings)
}

fn sized(
    mut decoder: impl ImageDecoder,
    bytes: usize,
    most_per_byte: u64,
    warnings: &mut Vec<String>,
) -> Result<Raster, Fault> {
    let (width, height) = decoder.dimensions();
    let (width, height) = check_declared(width.into(), height.into(), bytes, most_per_byte)?;
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        let problem = format!("a picture of {width} × {height} pixels is too large");
        return Err(Fault::new(problem, "scale it down"));
    }
    let each = u64::from(decoder.color_type().bytes_per_pixel());
    ask_memory((width, height), each + 3)?;
    let mut limits = Limits::no_limits();
    // The pixels and a decoder's own copies.
    limits.max_alloc = Some((1 << 26) + 3 * decoder.total_bytes());
    decoder.set_limits(limits).map_err(Fault::damaged)?;
    raster(decoder, width, height, warnings)
}

/// The true colours of a decoder whose size has been checked.
pub(super) fn raster(
    decoder: impl ImageDecoder,
    width: u32,
    height: u32,
    warnings: &mut Vec<String>,
) -> Result<Raster, Fault> {
    if decoder.dimensions() != (width, height) {
        return Err(Fault::damaged("its size is stated twice"));
    }
    let count = width as usize * height as usize;
    let colours = match decoder.color_type() {
        ColorType::Rgb8 => {
            let mut colours = vec![[0u8; 3]; count];
            decoder
                .read_image(colours.as_flattened_mut())
                .map_err(Fault::damaged)?;
            colours
        }
        ColorType::L8 => {
            let mut greys = vec![0u8; count];
            decoder.read_image(&mut greys).map_err(Fault::damaged)?;
            let palette = (0..=255).map(|grey| Srgb(grey, grey, grey)).collect();
            return Ok(Raster::new(width, height, Pixels::Indices(greys), palette)?);
        }
        ColorType::Rgba8 => {
            let mut samples = vec![[0u8; 4]; count];
            decoder
                .read_image(samples.as_flattened_mut())
                .map_err(Fault::damaged)?;
            seen(samples.into_iter(), warnings)
        }
        _ => {
            let picture = DynamicImage::from_decoder(decoder).map_err(Fault::damaged)?;
            let picture = picture.into_rgba8();
            seen(picture.pixels().map(|pixel| pixel.0), warnings)
        }
    };
    Ok(Raster::new(
        width,
        height,
        Pixels::Colours(colours),
        Vec::new(),
    )?)
}

/// Pixels over white paper.
fn seen(pixels: impl Iterator<Item = [u8; 4]>, warnings: &mut Vec<String>) -> Vec<[u8; 3]> {
    let mut transparent = false;
    let colours = pixels
        .map(|[red, green, blue, alpha]| {
            transparent |= alpha < 255;
            over_white([red, green, blue], alpha)
        })
        .collect();
    if transparent {
        remark(warnings, TRANSPARENT);
    }
    colours
}
