//! Image files made by hand, field by field, independently of the writers under test.
#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::{Path, PathBuf};

/// The collection of image files, or `None` after saying what is missing.
pub fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("PICKGLASS_IMAGES").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/images"),
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    let required = std::env::var("GOLDEN_REQUIRED").is_ok_and(|value| value == "1");
    let shown = folder.display();
    assert!(!required, "no images in {shown}: set PICKGLASS_IMAGES");
    eprintln!("not run: no images in {shown}");
    None
}

/// Rows of pixels packed at `bits` a pixel, each row padded to a byte; `ones` says
/// whether black is 1 and white 0, or the other way round.
pub fn pack(rows: &[Vec<bool>], bits: u16, ones: bool) -> Vec<u8> {
    let mut data = Vec::new();
    for row in rows {
        let mut bytes = vec![0u8; (row.len() * usize::from(bits)).div_ceil(8)];
        for (x, &black) in row.iter().enumerate() {
            let last_bit = (x + 1) * usize::from(bits) - 1;
            if black == ones {
                bytes[last_bit / 8] |= 1 << (7 - last_bit % 8);
            }
        }
        data.extend(bytes);
    }
    data
}

/// Samples a pixel, and what messages call the file.
pub struct Samples<'n>(pub u16, pub &'n str);

/// The fields of a TIFF.
pub struct Tiff {
    pub width: u32,
    pub height: u32,
    pub bits: u16,
    pub samples: u16,
    pub photometric: u16,
    pub compression: u16,
    pub fill_order: u16,
    pub planar: bool,
    pub rows_per_strip: u32,
    pub tile: Option<(u32, u32)>,
    pub colour_map: Vec<u16>,
    /// More fields: tag, type (3 = u16, 4 = u32, 5 = fractions, 7 = bytes), values.
    pub extra: Vec<(u16, u16, Vec<u32>)>,
    pub big_endian: bool,
}

impl Tiff {
    /// Black is zero, one strip, little-endian.
    pub fn new(width: u32, height: u32, bits: u16) -> Self {
        Self {
            width,
            height,
            bits,
            samples: 1,
            photometric: 1,
            compression: 1,
            fill_order: 1,
            planar: false,
            rows_per_strip: height,
            tile: None,
            colour_map: Vec::new(),
            extra: Vec::new(),
            big_endian: false,
        }
    }

    fn u16(&self, value: u16) -> [u8; 2] {
        if self.big_endian {
            value.to_be_bytes()
        } else {
            value.to_le_bytes()
        }
    }

    fn u32(&self, value: u32) -> [u8; 4] {
        if self.big_endian {
            value.to_be_bytes()
        } else {
            value.to_le_bytes()
        }
    }

    /// The pieces that pixels are stored in: strips, planes or one tile. Tiles take rows
    /// of a byte a pixel.
    fn chunks(&self, data: &[u8]) -> Vec<Vec<u8>> {
        if let Some((width, height)) = self.tile {
            let mut tile = vec![0; (width * height) as usize];
            for (y, row) in data.chunks(self.width as usize).enumerate() {
                tile[y * width as usize..][..row.len()].copy_from_slice(row);
            }
            return vec![tile];
        }
        if self.compression != 1 || self.rows_per_strip >= self.height {
            let planes = if self.planar {
                usize::from(self.samples)
            } else {
                1
            };
            return data
                .chunks(data.len().div_ceil(planes).max(1))
                .map(<[u8]>::to_vec)
                .collect();
        }
        let row = (self.width * u32::from(self.bits)).div_ceil(8) * self.rows_per_strip;
        data.chunks(row as usize).map(<[u8]>::to_vec).collect()
    }

    /// The file: header, pixels, lists, directory.
    pub fn with(&self, data: &[u8]) -> Vec<u8> {
        let mut file = if self.big_endian { b"MM\0*" } else { b"II*\0" }.to_vec();
        file.extend([0; 4]);
        let (mut offsets, mut lengths) = (Vec::new(), Vec::new());
        for chunk in self.chunks(data) {
            offsets.push(file.len() as u32);
            lengths.push(chunk.len() as u32);
            file.extend(chunk);
        }
        // Tag, type (3 = u16, 4 = u32), values.
        let mut fields: Vec<(u16, u16, Vec<u32>)> = vec![
            (256, 4, vec![self.width]),
            (257, 4, vec![self.height]),
            (258, 3, vec![self.bits.into(); usize::from(self.samples)]),
            (259, 3, vec![self.compression.into()]),
            (262, 3, vec![self.photometric.into()]),
            (266, 3, vec![self.fill_order.into()]),
            (277, 3, vec![self.samples.into()]),
            (284, 3, vec![if self.planar { 2 } else { 1 }]),
        ];
        match self.tile {
            Some((width, height)) => fields.extend([
                (322, 4, vec![width]),
                (323, 4, vec![height]),
                (324, 4, offsets),
                (325, 4, lengths),
            ]),
            None => fields.extend([
                (273, 4, offsets),
                (278, 4, vec![self.rows_per_strip]),
                (279, 4, lengths),
            ]),
        }
        if !self.colour_map.is_empty() {
            let map = self.colour_map.iter().map(|&value| value.into()).collect();
            fields.push((320, 3, map));
        }
        fields.extend(self.extra.iter().cloned());
        fields.sort_by_key(|field| field.0);
        let mut entries = Vec::new();
        for (tag, kind, values) in &fields {
            let bytes: Vec<u8> = match kind {
                3 => values
                    .iter()
                    .flat_map(|&value| self.u16(value as u16))
                    .collect(),
                7 => values.iter().map(|&value| value as u8).collect(),
                _ => values.iter().flat_map(|&value| self.u32(value)).collect(),
            };
            entries.extend(self.u16(*tag));
            entries.extend(self.u16(*kind));
            let count = values.len() / if *kind == 5 { 2 } else { 1 };
            entries.extend(self.u32(count as u32));
            if bytes.len() <= 4 {
                let mut four = bytes;
                four.resize(4, 0);
                entries.extend(four);
            } else {
                entries.extend(self.u32(file.len() as u32));
                file.extend(bytes);
            }
        }
        if file.len() % 2 == 1 {
            file.push(0);
        }
        let directory = self.u32(file.len() as u32);
        file[4..8].copy_from_slice(&directory);
        file.extend(self.u16(fields.len() as u16));
        file.extend(entries);
        file.extend([0; 4]);
        file
    }
}

/// A BMP of two colours, given as red, green, blue; `ones` as for [`pack`].
pub fn bmp(
    rows: &[Vec<bool>],
    bits: u16,
    top_down: bool,
    palette: &[[u8; 3]; 2],
    ones: bool,
) -> Vec<u8> {
    let (width, height) = (rows[0].len() as i32, rows.len() as i32);
    let mut file = b"BM\0\0\0\0\0\0\0\0".to_vec();
    file.extend((14u32 + 40 + 8).to_le_bytes());
    file.extend(40u32.to_le_bytes());
    file.extend(width.to_le_bytes());
    file.extend(if top_down { -height } else { height }.to_le_bytes());
    file.extend(1u16.to_le_bytes());
    file.extend(bits.to_le_bytes());
    file.extend([0; 16]);
    file.extend(2u32.to_le_bytes());
    file.extend([0; 4]);
    for [red, green, blue] in palette {
        file.extend([*blue, *green, *red, 0]);
    }
    let mut ordered = rows.to_vec();
    if !top_down {
        ordered.reverse();
    }
    for row in ordered {
        let mut line = pack(&[row], bits, ones);
        line.resize(line.len().next_multiple_of(4), 0);
        file.extend(line);
    }
    file
}
