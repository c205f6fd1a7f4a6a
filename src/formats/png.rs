//! PNG stills: sRGB with alpha, 8 or 16 bits, true scale and text in the metadata.

use std::path::Path;

use crate::atomic;
use crate::film::Picture;

/// Bits per channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Depth {
    /// 8 bits, with ordered dithering by half a step.
    #[default]
    Eight,
    /// 16 bits.
    Sixteen,
}

/// What a still says about itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Metadata {
    /// Pixels per millimetre of cloth; written as pixels per metre.
    pub pixels_per_mm: Option<f32>,
    /// Keyword and text, such as the settings and the hash of the design. Keywords are
    /// 1 to 79 Latin-1 characters; texts of any characters.
    pub texts: Vec<(String, String)>,
}

/// Why a PNG could not be written.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// Pixels do not match the size.
    #[error("picture of {width}x{height} has {pixels} pixels: give width times height")]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// Pixels given.
        pixels: usize,
    },
    /// The encoder refused.
    #[error("png: {0}; check the size and the text keywords")]
    Encode(#[from] png::EncodingError),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] atomic::WriteError),
}

/// Encodes a picture into the bytes of a PNG file.
pub fn encode(picture: &Picture, depth: Depth, metadata: &Metadata) -> Result<Vec<u8>, PngError> {
    let count = picture.width as usize * picture.height as usize;
    if count != picture.pixels.len() {
        return Err(PngError::Size {
            width: picture.width,
            height: picture.height,
            pixels: picture.pixels.len(),
        });
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(match depth {
        Depth::Eight => png::BitDepth::Eight,
        Depth::Sixteen => png::BitDepth::Sixteen,
    });
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    if let Some(per_mm) = metadata.pixels_per_mm {
        let per_metre = (per_mm * 1000.0).round();
        if (1.0..2e9).contains(&per_metre) {
            encoder.set_pixel_dims(Some(png::PixelDimensions {
                xppu: per_metre as u32,
                yppu: per_metre as u32,
                unit: png::Unit::Meter,
            }));
        }
    }
    for (keyword, text) in &metadata.texts {
        if text.chars().all(|c| (c as u32) < 256) {
            encoder.add_text_chunk(keyword.clone(), text.clone())?;
        } else {
            encoder.add_itxt_chunk(keyword.clone(), text.clone())?;
        }
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&samples(picture, depth))?;
    writer.finish()?;
    Ok(bytes)
}

/// Writes a PNG file, whole or not at all.
pub fn write(
    path: &Path,
    picture: &Picture,
    depth: Depth,
    metadata: &Metadata,
) -> Result<(), PngError> {
    let bytes = encode(picture, depth, metadata)?;
    Ok(atomic::write(path, &bytes)?)
}

/// The samples in file order, big-endian. NaN becomes 0.
fn samples(picture: &Picture, depth: Depth) -> Vec<u8> {
    let width = picture.width.max(1) as usize;
    let unit = |v: f32| if v > 0.0 { v.min(1.0) } else { 0.0 };
    match depth {
        Depth::Eight => picture
            .pixels
            .iter()
            .enumerate()
            .flat_map(|(k, pixel)| {
                let threshold = dither(k % width, k / width);
                let [r, g, b, a] = *pixel;
                let colour = |v: f32| (unit(v) * 255.0 + threshold) as u8;
                [
                    colour(r),
                    colour(g),
                    colour(b),
                    (unit(a) * 255.0 + 0.5) as u8,
                ]
            })
            .collect(),
        Depth::Sixteen => picture
            .pixels
            .iter()
            .flat_map(|pixel| {
                let [r, g, b, a] = pixel.map(|v| ((unit(v) * 65535.0 + 0.5) as u16).to_be_bytes());
                [r[0], r[1], g[0], g[1], b[0], b[1], a[0], a[1]]
            })
            .collect(),
    }
}

/// A threshold in (0, 1) from Bayer's 4×4 matrix. Whole values stay what they are.
fn dither(x: usize, y: usize) -> f32 {
    const BAYER: [[f32; 4]; 4] = [
        [0.0, 8.0, 2.0, 10.0],
        [12.0, 4.0, 14.0, 6.0],
        [3.0, 11.0, 1.0, 9.0],
        [15.0, 7.0, 13.0, 5.0],
    ];
    (BAYER[y % 4][x % 4] + 0.5) / 16.0
}
