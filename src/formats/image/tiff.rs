//! TIFF: strips and tiles, 1 to 16 bits, palettes, either polarity and bit order;
//! uncompressed, PackBits, LZW, deflate and CCITT group 4.
//!
//! The `tiff` crate decodes the pixels, but knows neither palettes nor the order of bits
//! in a byte. So a copy of the file is handed to it in which the photometric field says
//! "grey" and reversed bytes are put right; colours come from the colour map here. (TIFF
//! 6.0: fields 262 PhotometricInterpretation, 266 FillOrder, 320 ColorMap.)

use std::borrow::Cow;
use std::io::Cursor;

use tiff::decoder::{ChunkType, Decoder, DecodingResult, Limits};
use tiff::tags::{CompressionMethod, Tag};

use super::png::to_eight;
use super::raster::{fill_palette, over_white, unpack};
use super::{
    Fault, Pixels, Raster, SAVE_PLAIN, TRANSPARENT, check_coloured, check_declared, remark,
};
use crate::design::Srgb;
use crate::limits::FILE as MAX_FILE;

type Open<'b> = Decoder<Cursor<Cow<'b, [u8]>>>;

const WHITE_IS_ZERO: u16 = 0;
const BLACK_IS_ZERO: u16 = 1;
const RGB: u16 = 2;
const PALETTE: u16 = 3;
const CMYK: u16 = 5;

/// What the sample behind the colours is (ExtraSamples).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Alpha {
    /// The colours are multiplied by it.
    Associated,
    /// The colours are as they are.
    Straight,
}

impl Alpha {
    /// The colour that was stored, seen over white paper.
    fn seen(self, stored: [u8; 3], alpha: u8) -> [u8; 3] {
        let own = match (self, alpha) {
            (Self::Associated, 1..) => stored.map(|value| {
                let whole = (u32::from(value) * 255 + u32::from(alpha) / 2) / u32::from(alpha);
                whole.min(255) as u8
            }),
            _ => stored,
        };
        over_white(own, alpha)
    }
}

/// The fields that say how pixels are stored.
struct Fields {
    width: u32,
    height: u32,
    bits: u16,
    samples: u16,
    photometric: u16,
    planar: bool,
    alpha: Option<Alpha>,
    reversed: bool,
    rows_per_strip: u64,
}

pub(super) fn read(bytes: &[u8], warnings: &mut Vec<String>) -> Result<Raster, Fault> {
    let mut decoder = open(Cow::Borrowed(bytes))?;
    let fields = Fields::read(&mut decoder, bytes.len())?;
    let palette = fields.palette(&mut decoder)?;
    if decoder.more_images() {
        remark(warnings, "only the first page of the TIFF is read");
    }
    let patched = fields.patched(bytes, &mut decoder)?;
    drop(decoder);
    let mut decoder = open(patched)?;
    if !fields.indexed() {
        check_coloured((fields.width, fields.height))?;
    }
    let mut canvas = Canvas::new(&fields);
    let (across, chunks) = match decoder.get_chunk_type() {
        ChunkType::Strip => (1, decoder.strip_count()),
        ChunkType::Tile => {
            let (wide, _) = decoder.chunk_dimensions();
            (fields.width.div_ceil(wide.max(1)), decoder.tile_count())
        }
    };
    let (wide, high) = decoder.chunk_dimensions();
    let chunks = chunks.map_err(Fault::damaged)?;
    let planes = if fields.planar {
        u32::from(fields.samples)
    } else {
        1
    };
    let per_plane = across * fields.height.div_ceil(high.max(1));
    if per_plane.checked_mul(planes) != Some(chunks) && per_plane != chunks {
        return Err(Fault::damaged("the number of its strips"));
    }
    for chunk in 0..chunks {
        let within = chunk % per_plane;
        let place = (within % across * wide, within / across * high);
        if place.0 >= fields.width || place.1 >= fields.height {
            return Err(Fault::damaged("a strip outside it"));
        }
        let size = decoder.chunk_data_dimensions(chunk);
        let read = decoder.read_chunk(chunk).map_err(Fault::damaged)?;
        canvas.put(&read, place, size, chunk / per_plane)?;
    }
    canvas.finish(palette, warnings)
}

fn open(bytes: Cow<'_, [u8]>) -> Result<Open<'_>, Fault> {
    let mut limits = Limits::default();
    // Sizes are checked here; the crate's own limit is below a large uncompressed strip.
    limits.decoding_buffer_size = 3 * MAX_FILE as usize;
    limits.intermediate_buffer_size = MAX_FILE as usize;
    let decoder = Decoder::new(Cursor::new(bytes)).map_err(Fault::damaged)?;
    Ok(decoder.with_limits(limits))
}

impl Fields {
    fn read(decoder: &mut Open<'_>, bytes: usize) -> Result<Self, Fault> {
        let mut number = |tag: Tag, usual: u64| -> Result<u64, Fault> {
            let found = decoder.find_tag_unsigned_vec::<u64>(tag);
            let found = found.map_err(Fault::damaged)?;
            Ok(found
                .and_then(|list| list.first().copied())
                .unwrap_or(usual))
        };
        let bits = number(Tag::BitsPerSample, 1)?;
        let samples = number(Tag::SamplesPerPixel, 1)?;
        let compression = number(Tag::Compression, 1)?;
        let (width, height) = (number(Tag::ImageWidth, 0)?, number(Tag::ImageLength, 0)?);
        let photometric = number(Tag::PhotometricInterpretation, 1)?;
        let rows_per_strip = number(Tag::RowsPerStrip, u64::from(u32::MAX))?;
        let alpha = match number(Tag::ExtraSamples, 0)? {
            1 => Some(Alpha::Associated),
            2 => Some(Alpha::Straight),
            _ => None,
        };
        let planar = number(Tag::PlanarConfiguration, 1)? == 2 && samples > 1;
        let reversed = number(Tag::FillOrder, 1)? == 2;
        let sample_format = number(Tag::SampleFormat, 1)?;
        let tile = number(Tag::TileWidth, 1)?.saturating_mul(number(Tag::TileLength, 1)?);
        let refuse = |what: String| Err(Fault::new(what, SAVE_PLAIN));
        // Output bits a byte of each compression can stand for at best.
        let expands = match CompressionMethod::from_u16_exhaustive(compression as u16) {
            CompressionMethod::None => 8,
            CompressionMethod::PackBits => 8 * 128,
            CompressionMethod::LZW => 8 * 4096,
            CompressionMethod::Deflate | CompressionMethod::OldDeflate => 8 * 1032,
            // An empty line costs one bit.
            CompressionMethod::Fax4 => 8 * width,
            CompressionMethod::Fax3 | CompressionMethod::Huffman => {
                return refuse("CCITT group 3 is not read, only group 4".to_owned());
            }
            CompressionMethod::JPEG | CompressionMethod::ModernJPEG => {
                return refuse("JPEG compression changes colours and is not read".to_owned());
            }
            _ => return refuse(format!("compression {compression} is not read")),
        };
        let depth = (bits * samples).max(1);
        let (width, height) = check_declared(width, height, bytes, expands.div_ceil(depth).max(1))?;
        let grey = matches!(photometric as u16, WHITE_IS_ZERO | BLACK_IS_ZERO);
        let known = match photometric as u16 {
            PALETTE => samples == 1 && matches!(bits, 1 | 2 | 4 | 8),
            RGB => (3..=8).contains(&samples) && matches!(bits, 8 | 16),
            CMYK => samples == 4 && bits == 8,
            _ if samples == 1 => grey && matches!(bits, 1 | 2 | 4 | 8 | 16),
            _ => grey && samples <= 8 && matches!(bits, 8 | 16),
        };
        if !known || sample_format != 1 {
            return refuse(format!(
                "{samples} samples of {bits} bits (photometric {photometric}, sample format \
                 {sample_format}) are not read"
            ));
        }
        if tile > 1 << 28 {
            return Err(Fault::damaged("tiles larger than any image"));
        }
        Ok(Self {
            width,
            height,
            bits: bits as u16,
            samples: samples as u16,
            photometric: photometric as u16,
            planar,
            alpha,
            reversed,
            rows_per_strip,
        })
    }

    /// Whether pixels stay palette indices or greys of one byte or less.
    fn indexed(&self) -> bool {
        self.samples == 1
    }

    /// The colours of indices: the colour map, or greys from black to white or back.
    fn palette(&self, decoder: &mut Open<'_>) -> Result<Vec<Srgb>, Fault> {
        if !self.indexed() {
            return Ok(Vec::new());
        }
        let count = 1usize << self.bits.min(8);
        if self.photometric != PALETTE {
            let grey = |at: usize| {
                let value = (at * 255 / (count - 1)) as u8;
                match self.photometric {
                    WHITE_IS_ZERO => 255 - value,
                    _ => value,
                }
            };
            return Ok((0..count)
                .map(|at| Srgb(grey(at), grey(at), grey(at)))
                .collect());
        }
        let map = decoder
            .find_tag_unsigned_vec::<u16>(Tag::ColorMap)
            .map_err(Fault::damaged)?
            .filter(|map| map.len() >= 3 * count)
            .ok_or_else(|| Fault::damaged("a palette without colours"))?;
        // Some programs write 8-bit values where 16-bit ones belong.
        let eight = map.iter().all(|&value| value < 256);
        let value = |at: usize| {
            if eight {
                map[at] as u8
            } else {
                to_eight(map[at])
            }
        };
        Ok((0..count)
            .map(|at| Srgb(value(at), value(at + count), value(at + 2 * count)))
            .collect())
    }

    /// The file as the decoder understands it.
    fn patched<'b>(&self, bytes: &'b [u8], decoder: &mut Open<'_>) -> Result<Cow<'b, [u8]>, Fault> {
        let mut patched = Cow::Borrowed(bytes);
        let directory = Directory::of(bytes, decoder)?;
        if self.indexed() && self.photometric != BLACK_IS_ZERO {
            directory.write(
                &mut patched,
                Tag::PhotometricInterpretation,
                BLACK_IS_ZERO.into(),
            )?;
        }
        if self.rows_per_strip > u64::from(self.height) {
            // "All rows in one strip" is often written as the largest number there is.
            // Without the field its default means the same, and needs no change.
            let _ = directory.write(&mut patched, Tag::RowsPerStrip, self.height);
        }
        if self.reversed {
            let ranges = |decoder: &mut Open<'_>, tag| {
                let list = decoder.find_tag_unsigned_vec::<u64>(tag);
                list.map_err(Fault::damaged).map(Option::unwrap_or_default)
            };
            let mut starts = ranges(decoder, Tag::StripOffsets)?;
            starts.extend(ranges(decoder, Tag::TileOffsets)?);
            let mut lengths = ranges(decoder, Tag::StripByteCounts)?;
            lengths.extend(ranges(decoder, Tag::TileByteCounts)?);
            let mut strips: Vec<(u64, u64)> = starts.into_iter().zip(lengths).collect();
            // Strips that share bytes are turned once.
            strips.sort_unstable();
            let mut done = 0;
            for (start, length) in strips {
                let end = start.saturating_add(length).min(bytes.len() as u64);
                let from = start.max(done).min(end);
                for byte in &mut patched.to_mut()[from as usize..end as usize] {
                    *byte = byte.reverse_bits();
                }
                done = done.max(end);
            }
        }
        Ok(patched)
    }
}

/// Where the entries of the first directory lie in the file.
struct Directory {
    big_endian: bool,
    /// First entry, bytes an entry, entries.
    entries: (usize, usize, usize),
    /// Where in an entry its value stands.
    value_at: usize,
}

impl Directory {
    fn of(bytes: &[u8], decoder: &mut Open<'_>) -> Result<Self, Fault> {
        let at = decoder.ifd_pointer().map_or(0, |pointer| pointer.0) as usize;
        let big_endian = bytes.starts_with(b"MM");
        let wide = matches!(bytes.get(..4), Some(b"II+\0" | b"MM\0+"));
        let counted = if wide { 8 } else { 2 };
        let count = bytes.get(at..at.saturating_add(counted));
        let count = count.ok_or_else(|| Fault::damaged("its directory"))?;
        let digits: Vec<u8> = match big_endian {
            true => count.to_vec(),
            false => count.iter().rev().copied().collect(),
        };
        let count = digits.iter().fold(0usize, |sum, &digit| {
            (sum << 8 | usize::from(digit)) & 0xffff
        });
        let (step, value_at) = if wide { (20, 12) } else { (12, 8) };
        Ok(Self {
            big_endian,
            entries: (at + counted, step, count),
            value_at,
        })
    }

    /// Overwrites the single number of an entry in a copy of the file.
    fn write(&self, bytes: &mut Cow<'_, [u8]>, tag: Tag, value: u32) -> Result<(), Fault> {
        let (first, step, count) = self.entries;
        let u16_of = |two: [u8; 2]| match self.big_endian {
            true => u16::from_be_bytes(two),
            false => u16::from_le_bytes(two),
        };
        for entry in 0..count {
            let at = first + entry * step;
            let Some(&[a, b, c, d]) = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>())
            else {
                break;
            };
            if u16_of([a, b]) != tag.to_u16() {
                continue;
            }
            let length = match u16_of([c, d]) {
                1 => 1,
                3 => 2,
                4 => 4,
                _ => break,
            };
            let place = at + self.value_at;
            let Some(target) = bytes.to_mut().get_mut(place..place + length) else {
                break;
            };
            match self.big_endian {
                true => target.copy_from_slice(&value.to_be_bytes()[4 - length..]),
                false => target.copy_from_slice(&value.to_le_bytes()[..length]),
            }
            return Ok(());
        }
        Err(Fault::damaged("its directory"))
    }
}

/// The image that strips and tiles are put together into.
struct Canvas<'f> {
    fields: &'f Fields,
    pixels: Pixels,
    transparent: bool,
}

impl<'f> Canvas<'f> {
    fn new(fields: &'f Fields) -> Self {
        let (across, down) = (fields.width as usize, fields.height as usize);
        let pixels = match fields.indexed() {
            true if fields.bits == 1 => Pixels::Bits(vec![0; across.div_ceil(8) * down]),
            true => Pixels::Indices(vec![0; across * down]),
            // Ink of planes is added up, so it starts with none.
            false => Pixels::Colours(vec![[0; 3]; across * down]),
        };
        Self {
            fields,
            pixels,
            transparent: false,
        }
    }

    /// Puts a strip or tile with its upper left pixel at `place`.
    fn put(
        &mut self,
        read: &DecodingResult,
        (left, top): (u32, u32),
        (across, down): (u32, u32),
        plane: u32,
    ) -> Result<(), Fault> {
        let (width, height) = (self.fields.width as usize, self.fields.height as usize);
        let (left, top) = (left as usize, top as usize);
        let whole = across as usize * down as usize;
        let (across, down) = (
            (across as usize).min(width - left),
            (down as usize).min(height - top),
        );
        let short = || Fault::damaged("a strip is too short");
        let read_samples = match read {
            DecodingResult::U8(all) => all.len(),
            DecodingResult::U16(all) => all.len(),
            _ => 0,
        };
        let colours = self.fields.colours();
        let samples = if self.fields.planar {
            1
        } else if self.fields.alpha.is_none() && read_samples == whole * colours {
            // The decoder leaves out what lies behind the colours and is no alpha.
            colours
        } else {
            usize::from(self.fields.samples)
        };
        let depth = usize::from(self.fields.bits);
        for row in 0..down {
            let line = Line::of(read, row, across * samples, depth).ok_or_else(short)?;
            let from = (top + row) * width + left;
            match &mut self.pixels {
                Pixels::Bits(bits) => {
                    let Line::Eight(line) = line else {
                        return Err(short());
                    };
                    if !left.is_multiple_of(8) {
                        return Err(Fault::damaged("tiles that begin within a byte"));
                    }
                    let at = (top + row) * width.div_ceil(8) + left / 8;
                    bits[at..at + across.div_ceil(8)].copy_from_slice(&line[..across.div_ceil(8)]);
                }
                Pixels::Indices(indices) => {
                    let target = &mut indices[from..from + across];
                    match line {
                        Line::Eight(line) if depth == 8 => target.copy_from_slice(&line[..across]),
                        Line::Eight(line) => {
                            let mut unpacked = Vec::with_capacity(across + 8);
                            unpack(line, depth, across, &mut unpacked);
                            target.copy_from_slice(unpacked.get(..across).ok_or_else(short)?);
                        }
                        Line::Sixteen(line) => {
                            for (index, &value) in target.iter_mut().zip(line) {
                                *index = to_eight(value);
                            }
                        }
                    }
                }
                Pixels::Colours(colours) => {
                    let target = &mut colours[from..from + across];
                    if self.fields.planar {
                        self.transparent |= self.fields.add_plane(target, &line, plane as usize);
                    } else {
                        self.transparent |= self.fields.add_pixels(target, &line, samples);
                    }
                }
            }
        }
        Ok(())
    }

    fn finish(self, mut palette: Vec<Srgb>, warnings: &mut Vec<String>) -> Result<Raster, Fault> {
        if self.transparent {
            remark(warnings, TRANSPARENT);
        }
        fill_palette(&mut palette, &self.pixels, warnings);
        Ok(Raster::new(
            self.fields.width,
            self.fields.height,
            self.pixels,
            palette,
        )?)
    }
}

/// The samples of one row of a strip or tile.
enum Line<'r> {
    Eight(&'r [u8]),
    Sixteen(&'r [u16]),
}

impl<'r> Line<'r> {
    /// Row `row` of `samples` samples of `depth` bits; `None` if it is not all there.
    fn of(read: &'r DecodingResult, row: usize, samples: usize, depth: usize) -> Option<Self> {
        match read {
            DecodingResult::U8(all) => {
                let stride = (samples * depth).div_ceil(8);
                all.get(row * stride..(row + 1) * stride).map(Self::Eight)
            }
            DecodingResult::U16(all) => all
                .get(row * samples..(row + 1) * samples)
                .map(Self::Sixteen),
            _ => None,
        }
    }

    fn at(&self, index: usize) -> u8 {
        match self {
            Self::Eight(line) => line[index],
            Self::Sixteen(line) => to_eight(line[index]),
        }
    }
}

impl Fields {
    /// Samples of a pixel that are its colour.
    fn colours(&self) -> usize {
        match self.photometric {
            RGB => 3,
            CMYK => 4,
            _ => 1,
        }
    }

    /// Colours of interleaved samples; whether any was transparent.
    fn add_pixels(&self, target: &mut [[u8; 3]], line: &Line<'_>, samples: usize) -> bool {
        let (mut transparent, colours) = (false, self.colours());
        for (x, colour) in target.iter_mut().enumerate() {
            let sample = |channel: usize| line.at(x * samples + channel);
            let found = match self.photometric {
                RGB => [sample(0), sample(1), sample(2)],
                CMYK => {
                    let light = |ink: u8| {
                        let light = u32::from(255 - ink) * u32::from(255 - sample(3));
                        ((light + 127) / 255) as u8
                    };
                    [light(sample(0)), light(sample(1)), light(sample(2))]
                }
                WHITE_IS_ZERO => [255 - sample(0); 3],
                _ => [sample(0); 3],
            };
            *colour = match self.alpha.filter(|_| samples > colours) {
                Some(kind) => {
                    let alpha = sample(colours);
                    transparent |= alpha < 255;
                    kind.seen(found, alpha)
                }
                None => found,
            };
        }
        transparent
    }

    /// One plane of separate planes, whether it made any transparent; those beyond the
    /// colours and alpha are left out.
    fn add_plane(&self, target: &mut [[u8; 3]], line: &Line<'_>, plane: usize) -> bool {
        if let Some(kind) = self.alpha.filter(|_| plane == self.colours()) {
            let mut transparent = false;
            for (x, colour) in target.iter_mut().enumerate() {
                let alpha = line.at(x);
                transparent |= alpha < 255;
                *colour = kind.seen(*colour, alpha);
            }
            return transparent;
        }
        for (x, colour) in target.iter_mut().enumerate() {
            let value = line.at(x);
            match (self.photometric, plane) {
                (RGB, 0..=2) => colour[plane] = value,
                (CMYK, 0..=2) => colour[plane] = 255 - value,
                (CMYK, 3) => {
                    *colour = colour.map(|light| {
                        ((u32::from(light) * u32::from(255 - value) + 127) / 255) as u8
                    });
                }
                (WHITE_IS_ZERO, 0) => *colour = [255 - value; 3],
                (BLACK_IS_ZERO, 0) => *colour = [value; 3],
                _ => {}
            }
        }
        false
    }
}
