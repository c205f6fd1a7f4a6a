//! PNG: any colour type and depth, interlaced or not, read row by row.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits, Transformations};

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
    rows.finish(warnings)
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
    /// The indices that are transparent, of palettes and small greys.
    clear_indices: Vec<usize>,
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
        // One number a sample; the decoder gives those of up to 8 bits as bytes.
        let key: Option<Vec<u16>> = clear.map(|bytes| match depth {
            BitDepth::Sixteen => {
                let samples = bytes.as_chunks::<2>().0.iter();
                samples.map(|&bytes| u16::from_be_bytes(bytes)).collect()
            }
            _ => bytes.iter().map(|&byte| u16::from(byte)).collect(),
        });
        let (pixels, palette, clear, clear_indices) = match kind {
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
                let seen = alphas.iter().enumerate();
                let seen = seen.filter(|alpha| *alpha.1 < 255).map(|alpha| alpha.0);
                (
                    indexed(one_bit, across, count),
                    palette,
                    None,
                    seen.collect(),
                )
            }
            ColorType::Grayscale if small => {
                let most = (1u16 << depth as u8) - 1;
                let clear = key.as_ref().and_then(|key| key.first().copied());
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
                    clear.map(usize::from).into_iter().collect(),
                )
            }
            _ => (Pixels::Colours(Vec::new()), Vec::new(), key, Vec::new()),
        };
        Self {
            width: across,
            height,
            kind,
            depth,
            palette,
            clear,
            clear_indices,
            pixels: match pixels {
                Pixels::Colours(_) => Pixels::Colours(Vec::with_capacity(count)),
                other => other,
            },
            transparent: false,
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
                    colours.push(over_white(colour, alpha));
                }
            }
        }
    }

    fn finish(mut self, warnings: &mut Vec<String>) -> Result<Raster, Fault> {
        fill_palette(&mut self.palette, &self.pixels, warnings);
        let raster = Raster::new(self.width as u32, self.height, self.pixels, self.palette)?;
        let counts = raster.index_counts().unwrap_or_default();
        let met = |index: &usize| counts.get(*index).is_some_and(|&count| count > 0);
        if self.transparent || self.clear_indices.iter().any(met) {
            remark(warnings, TRANSPARENT);
        }
        Ok(raster)
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
