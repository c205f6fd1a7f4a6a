//! BMP: palettes of 1, 2, 4 and 8 bits, run lengths, bottom-up or top-down; true colours
//! by the `image` crate.
//!
//! The `image` crate's own decoder turns palettes into colours, and asked for indices it
//! panics where they are packed (0.25.10: one and four bits, run lengths); indices and
//! resolution are read here. Layout after the Windows GDI documentation (BITMAPFILEHEADER,
//! BITMAPINFOHEADER, BITMAPCOREHEADER, run-length encoding).

use std::io::Cursor;

use image::codecs::bmp::BmpDecoder;

use super::raster::{fill_palette, unpack};
use super::{Fault, Pixels, Raster, SAVE_PLAIN, check_declared};
use crate::design::Srgb;

/// Run lengths hold at most 255 pixels in two bytes. Jumps skip more at less cost, but a
/// file that is mostly jumps is made to fill memory.
const MOST_PER_BYTE_PACKED: u64 = 1024;

/// The fields of a header that matter here.
struct Header {
    width: u64,
    height: u64,
    top_down: bool,
    bits: u16,
    compression: u32,
    /// Where the pixels start in the file.
    pixels_at: usize,
    /// Where the palette starts, bytes an entry and entries.
    palette: (usize, usize, usize),
    per_cm: Option<(f32, f32)>,
}

const RGB: u32 = 0;
const RLE8: u32 = 1;
const RLE4: u32 = 2;
const FILE_HEADER: usize = 14;

pub(super) fn read(bytes: &[u8], warnings: &mut Vec<String>) -> Result<Raster, Fault> {
    let header = Header::read(bytes)?;
    let packed = matches!(header.compression, RLE8 | RLE4);
    let most_per_byte = match header.bits {
        _ if packed => MOST_PER_BYTE_PACKED,
        bits @ 1..=8 => 8 / u64::from(bits),
        _ => 1,
    };
    let (width, height) = check_declared(header.width, header.height, bytes.len(), most_per_byte)?;
    let mut raster = match (header.compression, header.bits) {
        (RGB, 1 | 2 | 4 | 8) => flat(bytes, &header, width, height, warnings)?,
        (RLE8, 8) | (RLE4, 4) => runs(bytes, &header, width, height, warnings)?,
        (_, 16 | 24 | 32) => true_colour(bytes, width, height, warnings)?,
        (compression, bits) => {
            let problem = format!("{bits} bits a pixel with compression {compression} is not read");
            return Err(Fault::new(problem, SAVE_PLAIN));
        }
    };
    raster.per_cm = header.per_cm;
    Ok(raster)
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let short = || Fault::damaged("it ends within its header");
        let u16_at = |at: usize| {
            let found = bytes.get(at..at + 2).and_then(|two| two.first_chunk());
            found.map(|&two| u16::from_le_bytes(two)).ok_or_else(short)
        };
        let u32_at = |at: usize| {
            let found = bytes.get(at..at + 4).and_then(|four| four.first_chunk());
            found
                .map(|&four| u32::from_le_bytes(four))
                .ok_or_else(short)
        };
        let size = u32_at(FILE_HEADER)? as usize;
        let pixels_at = u32_at(10)? as usize;
        if size == 12 {
            let bits = u16_at(24)?;
            let entries = if bits <= 8 { 1usize << bits } else { 0 };
            return Ok(Self {
                width: u16_at(18)?.into(),
                height: u16_at(20)?.into(),
                top_down: false,
                bits,
                compression: RGB,
                pixels_at,
                palette: (FILE_HEADER + size, 3, entries),
                per_cm: None,
            });
        }
        if size < 40 {
            return Err(Fault::damaged(format!("a header of {size} bytes")));
        }
        let (width, height) = (u32_at(18)? as i32, u32_at(22)? as i32);
        if width <= 0 || height == 0 || height == i32::MIN {
            return Err(Fault::damaged(format!("{width} × {height} pixels")));
        }
        let (bits, compression) = (u16_at(28)?, u32_at(30)?);
        let (across, down) = (u32_at(38)? as i32, u32_at(42)? as i32);
        let stated = u32_at(46)? as usize;
        let entries = match bits {
            1..=8 if stated == 0 || stated > 1 << bits => 1 << bits,
            1..=8 => stated,
            _ => 0,
        };
        Ok(Self {
            width: width as u64,
            height: u64::from(height.unsigned_abs()),
            top_down: height < 0,
            bits,
            compression,
            pixels_at,
            palette: (FILE_HEADER.saturating_add(size), 4, entries),
            per_cm: (across > 0 && down > 0).then(|| (across as f32 / 100.0, down as f32 / 100.0)),
        })
    }

    /// The palette: what lies between header and pixels.
    fn colours(&self, bytes: &[u8]) -> Vec<Srgb> {
        let (from, step, entries) = self.palette;
        let to = match self.pixels_at {
            at if at > from => at.min(bytes.len()),
            _ => bytes.len(),
        };
        let table = bytes.get(from..to).unwrap_or_default();
        table
            .chunks_exact(step)
            .take(entries)
            .map(|entry| Srgb(entry[2], entry[1], entry[0]))
            .collect()
    }
}

/// Uncompressed indices.
fn flat(
    bytes: &[u8],
    header: &Header,
    width: u32,
    height: u32,
    warnings: &mut Vec<String>,
) -> Result<Raster, Fault> {
    let (across, down) = (width as usize, height as usize);
    let depth = usize::from(header.bits);
    let stride = (across * depth).div_ceil(32) * 4;
    let used = (across * depth).div_ceil(8);
    // The last row's padding may be missing.
    let table = bytes
        .get(header.pixels_at..)
        .filter(|table| table.len() >= stride * (down - 1) + used)
        .ok_or_else(|| Fault::damaged("it ends before its last row"))?;
    let mut pixels = match depth {
        1 => Pixels::Bits(Vec::with_capacity(used * down)),
        _ => Pixels::Indices(Vec::with_capacity(across * down)),
    };
    for y in 0..down {
        let stored = if header.top_down { y } else { down - 1 - y };
        let row = &table[stored * stride..][..used];
        match &mut pixels {
            Pixels::Indices(indices) if depth == 8 => indices.extend_from_slice(row),
            Pixels::Indices(indices) => unpack(row, depth, across, indices),
            Pixels::Bits(bits) => bits.extend_from_slice(row),
            Pixels::Colours(_) => {}
        }
    }
    let mut palette = header.colours(bytes);
    fill_palette(&mut palette, &pixels, warnings);
    Ok(Raster::new(width, height, pixels, palette)?)
}

/// Run-length encoded indices.
fn runs(
    bytes: &[u8],
    header: &Header,
    width: u32,
    height: u32,
    warnings: &mut Vec<String>,
) -> Result<Raster, Fault> {
    let (across, down) = (width as usize, height as usize);
    let four = header.compression == RLE4;
    let mut indices = vec![0u8; across * down];
    let mut stream = bytes
        .get(header.pixels_at..)
        .unwrap_or_default()
        .iter()
        .copied();
    let mut next = || {
        stream
            .next()
            .ok_or_else(|| Fault::damaged("its runs end too early"))
    };
    let (mut x, mut y) = (0usize, 0usize);
    // Rows are stored from the bottom unless the height is negative.
    let mut put = |x: usize, y: usize, index: u8| {
        if x < across && y < down {
            let row = if header.top_down { y } else { down - 1 - y };
            indices[row * across + x] = index;
        }
    };
    let half = |byte: u8, second: bool| if second { byte & 15 } else { byte >> 4 };
    while y < down {
        match (next()?, next()?) {
            (0, 0) => (x, y) = (0, y + 1),
            (0, 1) => break,
            (0, 2) => {
                x += usize::from(next()?);
                y += usize::from(next()?);
            }
            (0, count) => {
                let count = usize::from(count);
                let length = if four { count.div_ceil(2) } else { count };
                for at in 0..length {
                    let byte = next()?;
                    if four {
                        put(x + 2 * at, y, half(byte, false));
                        if 2 * at + 1 < count {
                            put(x + 2 * at + 1, y, half(byte, true));
                        }
                    } else {
                        put(x + at, y, byte);
                    }
                }
                if length % 2 == 1 {
                    next()?;
                }
                x += count;
            }
            (count, byte) => {
                for at in 0..usize::from(count) {
                    put(x + at, y, if four { half(byte, at % 2 == 1) } else { byte });
                }
                x += usize::from(count);
            }
        }
    }
    let pixels = Pixels::Indices(indices);
    let mut palette = header.colours(bytes);
    fill_palette(&mut palette, &pixels, warnings);
    Ok(Raster::new(width, height, pixels, palette)?)
}

/// 16, 24 and 32 bits, with or without masks.
fn true_colour(
    bytes: &[u8],
    width: u32,
    height: u32,
    warnings: &mut Vec<String>,
) -> Result<Raster, Fault> {
    super::check_coloured((width, height))?;
    let decoder = BmpDecoder::new(Cursor::new(bytes)).map_err(Fault::damaged)?;
    super::photo::raster(decoder, width, height, warnings)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    /// A file of 8 or 4 bits, compressed, 6 × 3, from its runs.
    fn compressed(bits: u16, runs: &[u8]) -> Vec<u8> {
        let mut file = b"BM\0\0\0\0\0\0\0\0".to_vec();
        file.extend((14u32 + 40 + 16).to_le_bytes());
        file.extend(40u32.to_le_bytes());
        file.extend(6i32.to_le_bytes());
        file.extend(3i32.to_le_bytes());
        file.extend(1u16.to_le_bytes());
        file.extend(bits.to_le_bytes());
        file.extend(u32::from(if bits == 8 { RLE8 } else { RLE4 } as u16).to_le_bytes());
        file.extend([0; 12]);
        file.extend(4u32.to_le_bytes());
        file.extend([0; 4]);
        file.extend([0, 0, 0, 0, 255, 255, 255, 0, 0, 0, 255, 0, 255, 0, 0, 0]);
        file.extend(runs);
        file
    }

    fn rows(file: &[u8]) -> Vec<Vec<u8>> {
        let raster = read(file, &mut Vec::new()).unwrap();
        let Pixels::Indices(indices) = raster.pixels() else {
            panic!("indices")
        };
        indices.chunks(6).map(<[u8]>::to_vec).collect()
    }

    #[test]
    fn run_lengths_jumps_and_early_ends_are_read() {
        // Bottom row 111222; a jump of 2 across and 1 up; 3 pixels one by one; the end.
        let file = compressed(
            8,
            &[3, 1, 3, 2, 0, 0, 0, 2, 2, 0, 0, 3, 3, 2, 1, 0, 0, 0, 0, 1],
        );
        assert_eq!(
            rows(&file),
            [[0, 0, 0, 0, 0, 0], [0, 0, 3, 2, 1, 0], [1, 1, 1, 2, 2, 2]]
        );
    }

    #[test]
    fn half_bytes_alternate() {
        let file = compressed(4, &[5, 0x12, 0, 0, 0, 5, 0x32, 0x10, 0x30, 0, 0, 1]);
        assert_eq!(
            rows(&file),
            [[0, 0, 0, 0, 0, 0], [3, 2, 1, 0, 3, 0], [1, 2, 1, 2, 1, 0]]
        );
    }

    #[test]
    fn runs_that_stop_are_refused() {
        let file = compressed(8, &[3, 1, 3]);
        assert!(read(&file, &mut Vec::new()).is_err());
    }
}
