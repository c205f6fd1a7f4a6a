//! Images made to take memory: refused before it is asked for; and honest images take no
//! more than four times their pixels.
//!
//! Each is read in a process of its own, since peak memory is the process's. Pixels count
//! at their depth in the file, at least 8 bits where there are more colours than two.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::time::{Duration, Instant};

use crate::image_files::{Tiff, folder};
use crate::memory::{alone, peak, reset_peak};
use pickglass::formats::image::{ImageAs, ImageReading};
use pickglass::formats::{LoadOptions, load_bytes};

const WIDTH: u32 = 4001;
const HEIGHT: u32 = 3000;
const PIXELS: u64 = WIDTH as u64 * HEIGHT as u64;

fn noise(count: u64) -> impl Iterator<Item = u8> {
    (0..count).scan(0x9e37_79b9_7f4a_7c15u64, |state, _| {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        Some((*state >> 24) as u8)
    })
}

fn png_of(kind: png::ColorType, depth: png::BitDepth, size: (u32, u32), data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size.0, size.1);
    encoder.set_color(kind);
    encoder.set_depth(depth);
    if kind == png::ColorType::Indexed {
        encoder.set_palette((0..768u32).map(|k| (k * 7) as u8).collect::<Vec<_>>());
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
    writer.finish().unwrap();
    bytes
}

/// A GIF of many colours.
fn gif() -> Vec<u8> {
    let palette: Vec<u8> = (0..768u32).map(|k| (k * 7) as u8).collect();
    let data: Vec<u8> = noise(PIXELS).collect();
    let mut bytes = Vec::new();
    let (width, height) = (WIDTH as u16, HEIGHT as u16);
    let mut encoder = gif::Encoder::new(&mut bytes, width, height, &palette).unwrap();
    let frame = gif::Frame::from_indexed_pixels(width, height, data.as_slice(), None);
    encoder.write_frame(&frame).unwrap();
    drop(encoder);
    bytes
}

/// A BMP header with pixels of `bits` bits that are all there.
fn bmp(width: u32, height: u32, bits: u16, length: usize) -> Vec<u8> {
    let palette = if bits <= 8 { 4usize << bits } else { 0 };
    let mut file = b"BM\0\0\0\0\0\0\0\0".to_vec();
    file.extend((54 + palette as u32).to_le_bytes());
    file.extend(40u32.to_le_bytes());
    file.extend(width.to_le_bytes());
    file.extend(height.to_le_bytes());
    file.extend(1u16.to_le_bytes());
    file.extend(bits.to_le_bytes());
    file.extend([0; 24]);
    file.extend((0..palette).map(|k| (k * 5) as u8));
    file.extend(noise(length as u64));
    file
}

/// Bytes, the size of the pixels, and how the image is read.
type Case = (&'static str, fn() -> Vec<u8>, u64, ImageAs);

const HONEST: [Case; 9] = [
    (
        "1-bit png",
        || {
            let data: Vec<u8> = noise(u64::from(WIDTH.div_ceil(8) * HEIGHT)).collect();
            let kind = png::ColorType::Grayscale;
            png_of(kind, png::BitDepth::One, (WIDTH, HEIGHT), &data)
        },
        PIXELS / 8,
        ImageAs::Weave,
    ),
    (
        "1-bit bmp",
        || bmp(WIDTH, HEIGHT, 1, 504 * 3000),
        PIXELS / 8,
        ImageAs::Weave,
    ),
    (
        "1-bit tiff",
        || {
            let data: Vec<u8> = noise(u64::from(WIDTH.div_ceil(8) * HEIGHT)).collect();
            let tiff = Tiff {
                photometric: 0,
                fill_order: 2,
                ..Tiff::new(WIDTH, HEIGHT, 1)
            };
            tiff.with(&data)
        },
        PIXELS / 8,
        ImageAs::Weave,
    ),
    (
        "palette png",
        || {
            let data: Vec<u8> = noise(PIXELS).collect();
            let kind = png::ColorType::Indexed;
            png_of(kind, png::BitDepth::Eight, (WIDTH, HEIGHT), &data)
        },
        PIXELS,
        ImageAs::Artwork,
    ),
    (
        "palette bmp",
        || bmp(WIDTH, HEIGHT, 8, 4004 * 3000),
        PIXELS,
        ImageAs::Artwork,
    ),
    (
        "palette tiff",
        || {
            let tiff = Tiff {
                photometric: 3,
                colour_map: (0..768).map(|k: u32| (k * 997) as u16).collect(),
                ..Tiff::new(WIDTH, HEIGHT, 8)
            };
            tiff.with(&noise(PIXELS).collect::<Vec<_>>())
        },
        PIXELS,
        ImageAs::Artwork,
    ),
    ("palette gif", gif, PIXELS, ImageAs::Artwork),
    (
        "24-bit bmp",
        || bmp(4000, 3000, 24, 12000 * 3000),
        36_000_000,
        ImageAs::Weave,
    ),
    (
        "rgb png",
        || {
            let data: Vec<u8> = noise(3 * PIXELS).collect();
            png_of(
                png::ColorType::Rgb,
                png::BitDepth::Eight,
                (WIDTH, HEIGHT),
                &data,
            )
        },
        3 * PIXELS,
        ImageAs::Weave,
    ),
];

/// A PNG whose header claims another size than its pixels have.
fn png_bomb(width: u32, height: u32) -> Vec<u8> {
    let data = vec![0; 300_000];
    let kind = png::ColorType::Grayscale;
    let mut bytes = png_of(kind, png::BitDepth::Eight, (1000, 300), &data);
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let sum = bytes[12..29].iter().fold(u32::MAX, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| {
            sum >> 1 ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 }
        })
    });
    bytes[29..33].copy_from_slice(&(!sum).to_be_bytes());
    bytes
}

/// A file that must be refused.
type Bomb = (&'static str, fn() -> Vec<u8>);

const BOMBS: [Bomb; 8] = [
    ("png of the earth", || png_bomb(0x7fff_ffff, 0x7fff_ffff)),
    ("png within the most", || png_bomb(16_384, 16_384)),
    ("bmp within the most", || bmp(16_384, 16_384, 8, 4096)),
    ("bmp of 24 bits", || bmp(16_000, 16_000, 24, 4096)),
    ("tiff in one strip", || {
        Tiff::new(16_384, 16_384, 8).with(&[0; 4096])
    }),
    ("tiff of empty fax lines", || {
        let tiff = Tiff {
            compression: 4,
            ..Tiff::new(60_000, 4_000, 1)
        };
        tiff.with(&[0x80; 400])
    }),
    ("tiff with a giant tile", || {
        let tiff = Tiff {
            tile: Some((21, 9)),
            ..Tiff::new(21, 9, 8)
        };
        let mut bytes = tiff.with(&[0; 189]);
        // TileWidth and TileLength are fields 322 and 323, each a number of its own.
        for tag in [322u16, 323] {
            let [low, high] = tag.to_le_bytes();
            let at = bytes
                .windows(4)
                .position(|four| four == [low, high, 4, 0])
                .unwrap();
            bytes[at + 8..at + 12].copy_from_slice(&0x0fff_fff0u32.to_le_bytes());
        }
        bytes
    }),
    ("gif of nothing", || {
        let mut bytes = b"GIF89a\xff\xff\xff\x0f\x80\0\0\0\0\0\xff\xff\xff".to_vec();
        bytes.extend(b",\0\0\0\0\xff\xff\xff\x0f\0\x02\x01\x44\0;");
        bytes
    }),
];

fn as_is(what: Option<ImageAs>) -> LoadOptions {
    LoadOptions {
        image: ImageReading {
            what,
            ..ImageReading::default()
        },
        ..LoadOptions::default()
    }
}

/// Reads in this process; what was taken above what was held before.
fn measured(name: &str, bytes: &[u8], options: &LoadOptions) -> (Option<u64>, bool) {
    let before = reset_peak();
    let started = Instant::now();
    let answer = load_bytes(bytes, "flood", options);
    let seconds = started.elapsed();
    assert!(seconds < Duration::from_secs(20), "{name}: {seconds:?}");
    let taken = before
        .zip(peak())
        .map(|(before, after)| after.saturating_sub(before));
    let said = match &answer {
        Ok(_) => "read".to_owned(),
        Err(error) => error.to_string(),
    };
    println!(
        "{name}: {} KiB taken, {seconds:?}, {said}",
        taken.unwrap_or(0) >> 10
    );
    (taken, answer.is_ok())
}

#[test]
fn memory_stays_near_the_pixels() {
    let mut names: Vec<String> = HONEST.iter().map(|case| case.0.to_owned()).collect();
    names.extend(BOMBS.iter().map(|bomb| bomb.0.to_owned()));
    names.extend(folder().map(|_| "Bad_reallybig.bmp".to_owned()));
    let test = concat!(module_path!(), "::memory_stays_near_the_pixels");
    let Some(name) = alone(test, &names) else {
        return;
    };
    if let Some(&(name, make, pixels, what)) = HONEST.iter().find(|case| case.0 == name) {
        let bytes = make();
        let (taken, read) = measured(name, &bytes, &as_is(Some(what)));
        assert!(read, "{name} is honest");
        // A few MiB are the allocator's and the program's own pages.
        let allowed = 4 * pixels + (4 << 20);
        let taken = taken.unwrap_or(0);
        assert!(taken <= allowed, "{name}: {taken} of {allowed} bytes");
        return;
    }
    let bytes = match BOMBS.iter().find(|bomb| bomb.0 == name) {
        Some((_, make)) => make(),
        None => std::fs::read(folder().unwrap().join(&name)).unwrap(),
    };
    let (taken, read) = measured(&name, &bytes, &as_is(None));
    assert!(!read, "{name} must be refused");
    assert!(taken.unwrap_or(0) < 50_000_000, "{name}: {taken:?}");
}

#[test]
fn the_measure_of_memory_can_fail() {
    let test = concat!(module_path!(), "::the_measure_of_memory_can_fail");
    if alone(test, &[""]).is_none() {
        return;
    }
    let Some(before) = reset_peak() else { return };
    let large = vec![1u8; 60_000_000];
    assert!(std::hint::black_box(&large).len() > 1);
    assert!(peak().unwrap() - before > 50_000_000);
}
