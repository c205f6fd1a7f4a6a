//! Damaged, cut and random images: an answer or an error, never a panic, never for long.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::time::{Duration, Instant};

use crate::image_files::{Tiff, bmp, folder, pack};
use pickglass::formats::image::{ImageAs, ImageReading};
use pickglass::formats::{LoadOptions, load_bytes};
use proptest::prelude::*;

fn rows() -> Vec<Vec<bool>> {
    (0..9u32)
        .map(|y| {
            (0..21)
                .map(|x| (x * 7 + y * y * 3 + x * x * y) % 5 < 2)
                .collect()
        })
        .collect()
}

/// A small file of every kind that is read.
fn files() -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    let mut add = |name: &str, bytes: Vec<u8>| files.push((name.to_owned(), bytes));
    for bits in [1u16, 4, 8] {
        add(
            "bmp",
            bmp(
                &rows(),
                bits,
                bits == 4,
                &[[0, 0, 0], [255, 255, 255]],
                true,
            ),
        );
        let tiff = |photometric, colour_map| Tiff {
            photometric,
            colour_map,
            rows_per_strip: 4,
            big_endian: bits == 4,
            ..Tiff::new(21, 9, bits)
        };
        add("tiff", tiff(0, Vec::new()).with(&pack(&rows(), bits, true)));
        let map = (0..3u16 << bits).map(|k| k.wrapping_mul(9_001)).collect();
        add(
            "palette tiff",
            tiff(3, map).with(&pack(&rows(), bits, true)),
        );
    }
    let tiled = Tiff {
        tile: Some((32, 16)),
        fill_order: 2,
        ..Tiff::new(21, 9, 8)
    };
    add("tiles", tiled.with(&pack(&rows(), 8, false)));
    let planes = Tiff {
        photometric: 2,
        samples: 3,
        planar: true,
        ..Tiff::new(21, 9, 8)
    };
    add("planes", planes.with(&pack(&rows(), 8, false).repeat(3)));
    let grey = image::GrayImage::from_fn(21, 9, |x, y| image::Luma([(x * 12 + y) as u8]));
    let colours = image::RgbaImage::from_fn(21, 9, |x, y| {
        image::Rgba([x as u8 * 12, y as u8 * 28, 90, (x * y) as u8])
    });
    let flat = image::DynamicImage::ImageRgba8(colours.clone()).to_rgb8();
    for format in [
        image::ImageFormat::Png,
        image::ImageFormat::Bmp,
        image::ImageFormat::Tiff,
        image::ImageFormat::Jpeg,
        image::ImageFormat::WebP,
    ] {
        let name = format!("{format:?}");
        let mut bytes = std::io::Cursor::new(Vec::new());
        if format != image::ImageFormat::WebP && grey.write_to(&mut bytes, format).is_ok() {
            add(&name, bytes.into_inner());
        }
        let mut bytes = std::io::Cursor::new(Vec::new());
        if flat.write_to(&mut bytes, format).is_ok() {
            add(&name, bytes.into_inner());
        }
        let mut bytes = std::io::Cursor::new(Vec::new());
        if format != image::ImageFormat::Jpeg && colours.write_to(&mut bytes, format).is_ok() {
            add(&name, bytes.into_inner());
        }
    }
    let indices: Vec<u8> = rows().into_iter().flatten().map(u8::from).collect();
    let mut bytes = Vec::new();
    let palette = [255, 255, 255, 0, 0, 0];
    let mut encoder = gif::Encoder::new(&mut bytes, 25, 12, &palette).unwrap();
    let mut frame = gif::Frame::from_indexed_pixels(21, 9, indices.as_slice(), Some(0));
    (frame.left, frame.top) = (3, 2);
    encoder.write_frame(&frame).unwrap();
    encoder.write_frame(&frame).unwrap();
    drop(encoder);
    add("gif", bytes);
    let mut bytes = Vec::new();
    let mut writer = pcx::WriterPaletted::new(&mut bytes, (21, 9), (300, 300)).unwrap();
    for row in indices.chunks(21) {
        writer.write_row(row).unwrap();
    }
    writer.write_palette(&palette).unwrap();
    add("pcx", bytes);
    let mut bytes = Vec::new();
    let mut writer = pcx::WriterRgb::new(&mut bytes, (21, 9), (300, 300)).unwrap();
    for row in flat.as_raw().chunks(63) {
        writer.write_row(row).unwrap();
    }
    writer.finish().unwrap();
    add("pcx", bytes);
    let mut encoder = fax::encoder::Encoder::new(fax::VecWriter::new());
    for row in rows() {
        let line = row.iter().map(|&black| match black {
            true => fax::Color::Black,
            false => fax::Color::White,
        });
        let _ = encoder.encode_line(line, 21);
    }
    let fax4 = Tiff {
        compression: 4,
        photometric: 0,
        ..Tiff::new(21, 9, 1)
    };
    add("fax", fax4.with(&encoder.finish().unwrap().finish()));
    files
}

/// Reads bytes as each thing an image can be; a design must be whole, an error one line.
fn survives(bytes: &[u8]) -> bool {
    let started = Instant::now();
    let mut read = false;
    for what in [
        None,
        Some(ImageAs::Weave),
        Some(ImageAs::Artwork),
        Some(ImageAs::Warp),
    ] {
        let options = LoadOptions {
            image: ImageReading {
                what,
                ..ImageReading::default()
            },
            ..LoadOptions::default()
        };
        match load_bytes(bytes, "fuzz", &options) {
            Ok(imported) => {
                let design = &imported.design;
                assert_eq!(design.sett().fault(), None);
                if u64::from(design.ends()) * u64::from(design.picks()) < 1 << 20 {
                    assert_eq!(design.weave().ends(), design.ends());
                }
                read = true;
            }
            Err(error) => {
                let message = error.to_string();
                assert_eq!(message.lines().count(), 1, "{message:?}");
                assert!(message.starts_with("fuzz"), "{message:?}");
            }
        }
    }
    let taken = started.elapsed();
    assert!(taken < Duration::from_secs(20), "{taken:?}");
    read
}

#[test]
fn images_cut_at_every_length_give_an_answer() {
    let mut all = 0;
    for (name, bytes) in files() {
        assert!(survives(&bytes), "{name} is whole");
        let read = (0..bytes.len())
            .filter(|&end| survives(&bytes[..end]))
            .count();
        // Some formats end with what nobody needs; most cuts lose pixels.
        println!("{name}: {read} of {} cuts are read", bytes.len());
        all += 1;
    }
    assert!(all > 25, "{all}");
}

/// Numbers for a mutation, from a counter: the same in every run.
fn hash(counter: u64) -> u64 {
    let mut x = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

fn mutated(bytes: &[u8], seed: u64) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for step in 0..=hash(seed) % 4 {
        let pick = hash(seed * 31 + step);
        // Headers are where the harm is.
        let reach = if pick & 64 == 0 {
            bytes.len().min(160)
        } else {
            bytes.len()
        };
        let at = (pick >> 8) as usize % reach.max(1);
        match pick % 5 {
            0 if at < bytes.len() => bytes[at] ^= 1 << (pick >> 40 & 7),
            1 if at < bytes.len() => bytes[at] = (pick >> 48) as u8,
            2 if at < bytes.len() => bytes[at] = if pick >> 40 & 1 == 0 { 0 } else { 0xff },
            3 => {
                let to = (at + (pick >> 40) as usize % 12).min(bytes.len());
                bytes.drain(at.min(to)..to);
            }
            _ => {
                let piece = [(pick >> 32) as u8, (pick >> 40) as u8, 0, 0xff];
                let length = (pick >> 50) as usize % 5;
                bytes.splice(at..at, piece[..length.min(4)].iter().copied());
            }
        }
    }
    bytes
}

#[test]
fn mutated_images_give_an_answer() {
    let (mut read, mut all) = (0, 0);
    for (index, (_, source)) in files().iter().enumerate() {
        for round in 0..400 {
            read += usize::from(survives(&mutated(source, (index as u64) << 32 | round)));
            all += 1;
        }
    }
    // Mutations neither all break a file nor all leave it whole.
    assert!(read > all / 10 && read < all * 9 / 10, "{read} of {all}");
}

#[test]
fn mutated_files_of_the_collection_give_an_answer() {
    let Some(folder) = folder() else { return };
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    for (index, path) in files.iter().enumerate() {
        let bytes = std::fs::read(path).unwrap();
        let rounds = if bytes.len() > 30_000 { 4 } else { 60 };
        for round in 0..rounds {
            survives(&mutated(&bytes, (index as u64) << 40 | round));
        }
    }
}

proptest! {
    #[test]
    fn random_bytes_behind_any_header_give_an_answer(
        bytes in proptest::collection::vec(any::<u8>(), 0..300),
        start in 0usize..60,
        kind in 0usize..40,
    ) {
        let files = files();
        let (_, whole) = &files[kind % files.len()];
        let mut headed = whole[..start.min(whole.len())].to_vec();
        headed.extend_from_slice(&bytes);
        survives(&headed);
        survives(&bytes);
    }
}
