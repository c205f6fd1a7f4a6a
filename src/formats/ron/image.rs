//! Grids inside a document: PNG in base64, so that any image program can show them.
//!
//! A weave is a 1-bit greyscale image with black = warp up; maps of regions and yarns are
//! indexed (or 16-bit, above 256 values). The bottom row of the image is pick 0. Size and
//! kind of an image are checked against the document before its pixels are decoded, row by
//! row, into shared tiles. The picture a design was made of is 8-bit RGB of its own size.

use std::io::Cursor;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use png::{BitDepth, ColorType, Decoder, Encoder, Limits, Reader, Transformations};

use crate::design::{Grid, MAX_SOURCE_PIXELS, SourceImage, WeavePattern};

/// A PNG whose header has been read and found right.
type Open = Reader<Cursor<Vec<u8>>>;

/// Opens an image that must be `ends` × `picks` of one of these kinds.
fn open(
    text: &str,
    ends: u32,
    picks: u32,
    kinds: &[(ColorType, BitDepth)],
) -> Result<Open, String> {
    open_of(text, ends, kinds, |width, height| {
        if (width, height) == (ends, picks) {
            return Ok(());
        }
        Err(format!(
            "the image has {width} × {height} pixels, but {ends} × {picks} are declared"
        ))
    })
}

/// Opens an image of one of these kinds whose size `check` accepts, at most `widest` wide.
fn open_of(
    text: &str,
    widest: u32,
    kinds: &[(ColorType, BitDepth)],
    check: impl FnOnce(u32, u32) -> Result<(), String>,
) -> Result<Open, String> {
    let bytes = STANDARD
        .decode(text.trim())
        .map_err(|error| format!("the image is no base64 ({error})"))?;
    // A row and the inflater's window are all that is held; text chunks are skipped.
    let limits = Limits {
        bytes: (1 << 20) + 16 * widest as usize,
    };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(Transformations::IDENTITY);
    let unreadable = |error: png::DecodingError| format!("the image is no PNG ({error})");
    let header = decoder.read_header_info().map_err(unreadable)?;
    check(header.width, header.height)?;
    if header.interlaced || !kinds.contains(&(header.color_type, header.bit_depth)) {
        return Err("the image is of another kind of PNG than belongs here".to_owned());
    }
    decoder.read_info().map_err(unreadable)
}

/// Calls `row(pick, bytes)` for every row from the top (the last pick) down.
fn each_row(reader: &mut Open, picks: u32, mut row: impl FnMut(u32, &[u8])) -> Result<(), String> {
    for pick in (0..picks).rev() {
        match reader.next_row() {
            Ok(Some(line)) => row(pick, line.data()),
            Ok(None) => return Err("the image ends too early".to_owned()),
            Err(error) => return Err(format!("the image is damaged ({error})")),
        }
    }
    Ok(())
}

/// Reads a 1-bit image.
pub(super) fn read_pattern(text: &str, ends: u32, picks: u32) -> Result<WeavePattern, String> {
    let mut pattern = WeavePattern::try_new(u64::from(ends), u64::from(picks))
        .map_err(|error| error.to_string())?;
    let mut reader = open(text, ends, picks, &[(ColorType::Grayscale, BitDepth::One)])?;
    each_row(&mut reader, picks, |pick, line| {
        for (word, bytes) in line.chunks(8).enumerate() {
            let mut eight = [0xff; 8];
            eight[..bytes.len()].copy_from_slice(bytes);
            // PNG's first pixel is the highest bit; ours is the lowest. Black is up.
            let bits = !u64::from_be_bytes(eight).reverse_bits();
            pattern.set_pick_word(word as u32, pick, bits);
        }
    })?;
    Ok(pattern)
}

/// Writes a 1-bit image.
pub(super) fn write_pattern(pattern: &WeavePattern) -> Result<String, String> {
    let line = pattern.ends().div_ceil(8) as usize;
    let mut bytes = Vec::with_capacity(line * pattern.picks() as usize);
    for pick in (0..pattern.picks()).rev() {
        let from = bytes.len();
        for bits in pattern.pick_words(pick) {
            bytes.extend_from_slice(&(!bits.reverse_bits()).to_be_bytes());
        }
        bytes.truncate(from + line);
    }
    encode(pattern.ends(), pattern.picks(), &bytes, |encoder| {
        encoder.set_color(ColorType::Grayscale);
        encoder.set_depth(BitDepth::One);
    })
}

/// Reads a map of small numbers.
pub(super) fn read_map(text: &str, ends: u32, picks: u32) -> Result<Grid<u16>, String> {
    let mut grid = Grid::filled(ends, picks, 0u16).map_err(|error| error.to_string())?;
    let kinds = [
        (ColorType::Indexed, BitDepth::Eight),
        (ColorType::Grayscale, BitDepth::Sixteen),
    ];
    let mut reader = open(text, ends, picks, &kinds)?;
    let wide = reader.info().bit_depth == BitDepth::Sixteen;
    each_row(&mut reader, picks, |pick, line| {
        for end in 0..ends {
            let at = end as usize;
            let value = match wide {
                true => u16::from_be_bytes([line[2 * at], line[2 * at + 1]]),
                false => u16::from(line[at]),
            };
            grid.set(end, pick, value);
        }
    })?;
    Ok(grid)
}

/// Writes a map of small numbers.
pub(super) fn write_map(grid: &Grid<u16>) -> Result<String, String> {
    let wide = grid.max() > Some(255);
    let mut bytes = Vec::new();
    for pick in (0..grid.picks()).rev() {
        for end in 0..grid.ends() {
            let value = grid.get(end, pick);
            match wide {
                true => bytes.extend_from_slice(&value.to_be_bytes()),
                false => bytes.push(value as u8),
            }
        }
    }
    encode(grid.ends(), grid.picks(), &bytes, |encoder| {
        if wide {
            encoder.set_color(ColorType::Grayscale);
            encoder.set_depth(BitDepth::Sixteen);
        } else {
            encoder.set_color(ColorType::Indexed);
            encoder.set_depth(BitDepth::Eight);
            encoder.set_palette(palette(grid.max().unwrap_or(0)));
        }
    })
}

/// Reads the picture a design was made of.
pub(super) fn read_picture(text: &str) -> Result<SourceImage, String> {
    let checked =
        |width, height| SourceImage::check_size(width, height).map_err(|error| error.to_string());
    let widest = MAX_SOURCE_PIXELS as u32;
    let mut reader = open_of(text, widest, &[(ColorType::Rgb, BitDepth::Eight)], checked)?;
    let (width, height) = (reader.info().width, reader.info().height);
    let mut pixels = Vec::with_capacity(width as usize * height as usize);
    each_row(&mut reader, height, |_, line| {
        pixels.extend(line.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]));
    })?;
    SourceImage::new(width, height, pixels).map_err(|error| error.to_string())
}

/// Writes the picture a design was made of.
pub(super) fn write_picture(picture: &SourceImage) -> Result<String, String> {
    let bytes = picture.pixels().as_flattened();
    encode(picture.width(), picture.height(), bytes, |encoder| {
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_filter(png::Filter::Adaptive);
        encoder.set_compression(png::Compression::Balanced);
    })
}

/// Colours that tell neighbouring numbers apart; they mean nothing.
fn palette(most: u16) -> Vec<u8> {
    (0..=most)
        .flat_map(|index| {
            // Steps of the golden angle round the colour circle.
            let turn = (f32::from(index) * 0.618_034).fract() * std::f32::consts::TAU;
            [0.0f32, 2.094, 4.189].map(|phase| (150.0 + 90.0 * (turn - phase).cos()) as u8)
        })
        .collect()
}

fn encode(
    width: u32,
    height: u32,
    bytes: &[u8],
    set: impl FnOnce(&mut Encoder<'_, &mut Vec<u8>>),
) -> Result<String, String> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, width, height);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    set(&mut encoder);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(bytes)?;
        writer.finish()
    });
    written.map_err(|error| error.to_string())?;
    Ok(STANDARD.encode(file))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn noise(ends: u32, picks: u32) -> WeavePattern {
        WeavePattern::from_fn(ends, picks, |end, pick| (end * 7 + pick * pick * 3) % 5 < 2)
    }

    #[test]
    fn patterns_of_any_width_survive() {
        for ends in [1, 7, 8, 9, 63, 64, 65, 130] {
            let pattern = noise(ends, 11);
            let text = write_pattern(&pattern).unwrap();
            assert_eq!(read_pattern(&text, ends, 11).unwrap(), pattern);
            assert_ne!(read_pattern(&text, ends, 11).unwrap(), pattern.inverted());
        }
    }

    #[test]
    fn maps_of_few_and_many_values_survive() {
        for most in [2u32, 256, 257, 60_000] {
            let grid = Grid::from_fn(33, 9, |end, pick| ((end * pick * 977) % most) as u16);
            let grid = grid.unwrap();
            let text = write_map(&grid).unwrap();
            assert_eq!(read_map(&text, 33, 9).unwrap(), grid);
        }
    }

    #[test]
    fn an_image_of_another_size_or_kind_is_refused() {
        let text = write_pattern(&noise(40, 30)).unwrap();
        assert!(read_pattern(&text, 40, 31).unwrap_err().contains("40 × 30"));
        assert!(read_map(&text, 40, 30).unwrap_err().contains("kind"));
        assert!(read_pattern("%%%", 4, 4).unwrap_err().contains("base64"));
        assert!(read_pattern("aGVsbG8=", 4, 4).unwrap_err().contains("PNG"));
        assert!(read_pattern(&text[..text.len() / 8 * 4], 40, 30).is_err());
    }

    #[test]
    fn a_header_that_claims_the_earth_is_refused() {
        let mut bytes = STANDARD
            .decode(write_pattern(&noise(8, 8)).unwrap())
            .unwrap();
        // Width and height of the header, with its checksum made right again.
        bytes[16..20].copy_from_slice(&0x7fff_ffffu32.to_be_bytes());
        bytes[20..24].copy_from_slice(&0x7fff_ffffu32.to_be_bytes());
        let sum = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&sum.to_be_bytes());
        let text = STANDARD.encode(bytes);
        let huge = 0x7fff_ffff;
        let message = read_pattern(&text, 8, 8).unwrap_err();
        assert!(message.contains("2147483647 × 2147483647"), "{message}");
        assert!(
            read_pattern(&text, huge, huge)
                .unwrap_err()
                .contains("too many")
        );
    }

    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(u32::MAX, |sum, &byte| {
            (0..8).fold(sum ^ u32::from(byte), |sum, _| {
                sum >> 1 ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 }
            })
        })
    }
}
