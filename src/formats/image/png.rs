//! PNG: any colour type and depth, interlaced or not, read row by row.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits, Transformations, Unit};

use super::raster::{fill_palette, over_white, unpack};
use super::{Fault, Pixels, Raster, TRANSPARENT, check_coloured, check_declared, remark};
use crate::design::Srgb;

/// Deflate cannot do better than 1032 to 1; a byte holds at most 8 pixels.
const MOST_PER_BYTE: u64 = 1032 * 8;

pub(super) fn read(bytes: &[u8], warnings: &mut Vec<String>) -> Result<Raster, Fault> {
    let limits = Limits { bytes: 64 << 20 };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(Transformations::IDENTITY);
    let header = decoder.read_header_info().map_err(Fault::damaged)?;
    let bits = header.bits_per_pixel() as u64;
    let indexed = header.color_type == ColorType::Indexed
        || (header.color_type == ColorType::Grayscale && header.bit_depth != BitDepth::Sixteen);
    let (width, height) = check_declared(
        header.width.into(),
        header.height.into(),
        bytes.len(),
        (MOST_PER_BYTE / bits).max(1),
    )?;
    if !indexed {
        check_coloured((width, height))?;
    }
    let mut reader = decoder.read_info().map_err(Fault::damaged)?;
    let info = reader.info();
    let per_cm = info.pixel_dims.and_then(|dims| match dims.unit {
        Unit::Meter => Some((dims.xppu as f32 / 100.0, dims.yppu as f32 / 100.0)),
        Unit::Unspecified => None,
    });
    let mut rows = Rows::new(
        width,
        height,
        info.color_type,
        info.bit_depth,
        info.palette.as_deref(),
        info.trns.as_deref(),
    );
    if info.interlaced {
        // Interlaced rows come in another order: only the whole can be read.
        let size = reader
            .output_buffer_size()
            .ok_or_else(|| Fault::damaged("its size"))?;
        let mut whole = vec![0; size];
        let frame = reader.next_frame(&mut whole).map_err(Fault::damaged)?;
        for row in whole.chunks(frame.line_size.max(1)).take(height as usize) {
            rows.push(row);
        }
    } else {
        for _ in 0..height {
            match reader.next_row().map_err(Fault::damaged)? {
                Some(row) => rows.push(row.data()),
                None => return Err(Fault::damaged("it ends too early")),
            }
        }
    }
    let mut raster = rows.finish(warnings)?;
    raster.per_cm = per_cm;
    Ok(raster)
}

/// Gathers the rows of an image in the form that holds them best.
struct Rows {
    width: usize,
    height: u32,
    kind: ColorType,
    depth: BitDepth,
    palette: Vec<Srgb>,
    /// The colour that is transparent, of greys and true colours, as samples.
    clear: Option<Vec<u16>>,
    pixels: Pixels,
    transparent: bool,
}

impl Rows {
    fn new(
        width: u32,
        height: u32,
        kind: ColorType,
        depth: BitDepth,
        palette: Option<&[u8]>,
        clear: Option<&[u8]>,
    ) -> Self {
        let across = width as usize;
        let count = across * height as usize;
        let one_bit = depth == BitDepth::One;
        let small = matches!(
            depth,
            BitDepth::One | BitDepth::Two | BitDepth::Four | BitDepth::Eight
        );
        let (pixels, palette, clear, transparent) = match kind {
            ColorType::Indexed => {
                let alphas = clear.unwrap_or_default();
                let colours = palette.unwrap_or_default().as_chunks::<3>().0.iter();
                let palette: Vec<Srgb> = colours
                    .enumerate()
                    .map(|(at, &colour)| {
                        let alpha = alphas.get(at).copied().unwrap_or(255);
                        let [red, green, blue] = over_white(colour, alpha);
                        Srgb(red, green, blue)
                    })
                    .collect();
                let seen = alphas.iter().any(|&alpha| alpha < 255);
                (indexed(one_bit, across, count), palette, None, seen)
            }
            ColorType::Grayscale if small => {
                let most = (1u16 << depth as u8) - 1;
                let clear = clear.and_then(|bytes| bytes.first_chunk::<2>());
                let clear = clear.map(|&bytes| u16::from_be_bytes(bytes));
                let palette = (0..=most)
                    .map(|grey| match clear {
                        Some(clear) if clear == grey => Srgb(255, 255, 255),
                        _ => {
                            let grey = (grey * 255 / most) as u8;
                            Srgb(grey, grey, grey)
                        }
                    })
                    .collect();
                (
                    indexed(one_bit, across, count),
                    palette,
                    None,
                    clear.is_some(),
                )
            }
            _ => {
                let clear = clear.map(|bytes| {
                    let samples = bytes.as_chunks::<2>().0.iter();
                    samples.map(|&bytes| u16::from_be_bytes(bytes)).collect()
                });
                (Pixels::Colours(Vec::new()), Vec::new(), clear, false)
            }
        };
        Self {
            width: across,
            height,
            kind,
            depth,
            palette,
            clear,
            pixels: match pixels {
                Pixels::Colours(_) => Pixels::Colours(Vec::with_capacity(count)),
                other => other,
            },
            transparent,
        }
    }

    fn push(&mut self, row: &[u8]) {
        let width = self.width;
        match &mut self.pixels {
            Pixels::Bits(bits) => {
                let stride = width.div_ceil(8).min(row.len());
                bits.extend_from_slice(&row[..stride]);
            }
            Pixels::Indices(indices) => {
                let depth = self.depth as usize;
                if depth == 8 {
                    indices.extend_from_slice(&row[..width.min(row.len())]);
                } else {
                    unpack(row, depth, width, indices);
                }
            }
            Pixels::Colours(colours) => {
                let samples = self.kind.samples();
                let wide = self.depth == BitDepth::Sixteen;
                let bytes = samples * if wide { 2 } else { 1 };
                for pixel in row.chunks_exact(bytes).take(width) {
                    let sample = |at: usize| match wide {
                        true => u16::from_be_bytes([pixel[2 * at], pixel[2 * at + 1]]),
                        false => u16::from(pixel[at]),
                    };
                    let eight = |at: usize| {
                        if wide {
                            to_eight(sample(at))
                        } else {
                            pixel[at]
                        }
                    };
                    let (colour, alpha) = match self.kind {
                        ColorType::Rgb => ([eight(0), eight(1), eight(2)], 255),
                        ColorType::Rgba => ([eight(0), eight(1), eight(2)], eight(3)),
                        ColorType::GrayscaleAlpha => ([eight(0); 3], eight(1)),
                        ColorType::Grayscale | ColorType::Indexed => ([eight(0); 3], 255),
                    };
                    let clear = self.clear.as_ref().is_some_and(|clear| {
                        clear.len() >= samples && (0..samples).all(|at| clear[at] == sample(at))
                    });
                    let alpha = if clear { 0 } else { alpha };
                    self.transparent |= alpha < 255;
                    colours.push(match alpha {
                        255 => colour,
                        _ => over_white(colour, alpha),
                    });
                }
            }
        }
    }

    fn finish(mut self, warnings: &mut Vec<String>) -> Result<Raster, Fault> {
        if self.transparent {
            remark(warnings, TRANSPARENT);
        }
        fill_palette(&mut self.palette, &self.pixels, warnings);
        Ok(Raster::new(
            self.width as u32,
            self.height,
            self.pixels,
            self.palette,
        )?)
    }
}

fn indexed(one_bit: bool, width: usize, count: usize) -> Pixels {
    match one_bit {
        true => Pixels::Bits(Vec::with_capacity(
            width.div_ceil(8) * (count / width.max(1)),
        )),
        false => Pixels::Indices(Vec::with_capacity(count)),
    }
}

/// The nearest 8-bit value of a 16-bit sample.
pub(super) fn to_eight(value: u16) -> u8 {
    ((u32::from(value) * 255 + 32_767) / 65_535) as u8
}
