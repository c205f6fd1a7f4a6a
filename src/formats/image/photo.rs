//! JPEG and WebP, decoded by the `image` crate into true colours.

use std::io::Cursor;

use image::codecs::jpeg::JpegDecoder;
use image::codecs::webp::WebPDecoder;
use image::{ColorType, ImageDecoder};

use super::raster::over_white;
use super::{Encoding, Fault, Pixels, Raster, SAVE_PLAIN, TRANSPARENT, check_declared, remark};
use crate::design::Srgb;

/// A pixel costs a JPEG no less than a bit for each block of 8 × 8, and so a WebP with the
/// simplest prediction; more is made to fill memory.
const MOST_PER_BYTE: u64 = 2048;

/// The largest picture, 64 million pixels: what a camera takes.
const MOST_PIXELS: u64 = 1 << 26;

pub(super) fn read(
    bytes: &[u8],
    encoding: Encoding,
    warnings: &mut Vec<String>,
) -> Result<Raster, Fault> {
    match encoding {
        Encoding::WebP => {
            let decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(Fault::damaged)?;
            sized(decoder, bytes.len(), warnings)
        }
        _ => {
            let decoder = JpegDecoder::new(Cursor::new(bytes)).map_err(Fault::damaged)?;
            sized(decoder, bytes.len(), warnings)
        }
    }
}

fn sized(
    decoder: impl ImageDecoder,
    bytes: usize,
    warnings: &mut Vec<String>,
) -> Result<Raster, Fault> {
    let (width, height) = decoder.dimensions();
    let (width, height) = check_declared(width.into(), height.into(), bytes, MOST_PER_BYTE)?;
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        let problem = format!("a picture of {width} × {height} pixels is too large");
        return Err(Fault::new(problem, "scale it down"));
    }
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
            let mut colours = Vec::with_capacity(count);
            for [red, green, blue, alpha] in samples {
                if alpha < 255 {
                    remark(warnings, TRANSPARENT);
                }
                colours.push(over_white([red, green, blue], alpha));
            }
            colours
        }
        other => {
            let problem = format!("its pixels ({other:?}) are not read");
            return Err(Fault::new(problem, SAVE_PLAIN));
        }
    };
    Ok(Raster::new(
        width,
        height,
        Pixels::Colours(colours),
        Vec::new(),
    )?)
}
