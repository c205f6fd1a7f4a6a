//! Files of image formats, made field by field. Each is read by both doors: as a design's
//! image and as a picture, and what is not told by both is not told.

use super::{Outcome, Twins, Walker};
use crate::image_files::Tiff;
use ::image::codecs::jpeg::JpegEncoder;
use ::image::codecs::webp::WebPEncoder;
use ::image::{ExtendedColorType, ImageEncoder};
use pickglass::formats::field_table::Field;
use pickglass::formats::{image, photo};
use std::path::Path;

pub fn walkers() -> Vec<Walker> {
    let walker = |format, twins| Walker {
        format,
        twins,
        read,
        named: false,
    };
    vec![
        walker("png", png),
        walker("jpeg", jpeg),
        walker("webp", webp),
        walker("tiff", tiff),
        walker("gif", gif),
        walker("pcx", pcx),
        walker("bmp", bmp),
    ]
}

fn read(path: &Path) -> Outcome {
    let bytes = std::fs::read(path).expect("the test's own file");
    let one = image::read(&bytes, "x").map_err(|error| error.to_string())?;
    let photo = photo::read(&bytes, "x").map_err(|error| error.to_string())?;
    let raster = one.raster;
    let (width, height) = (raster.width(), raster.height());
    let colours: Vec<_> = (0..width * height)
        .map(|k| raster.colour(k % width, k / width))
        .collect();
    let size = (photo.source.width(), photo.source.height());
    assert_eq!(size, (width, height), "both doors turn alike");
    let same = colours.iter().zip(photo.source.pixels());
    assert!(
        same.into_iter().all(|(a, b)| [a.0, a.1, a.2] == *b),
        "both doors show alike"
    );
    let told = |line: &String| {
        photo
            .warnings
            .iter()
            .any(|other| other.contains(line.as_str()))
    };
    let text = format!("{width} × {height}, {:?}, {colours:?}", raster.per_cm);
    Ok((text, one.warnings.into_iter().filter(told).collect()))
}

fn twins(folder: &Path, with: Vec<u8>, without: Vec<u8>) -> Twins {
    let write = |name: &str, bytes: Vec<u8>| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("written");
        path
    };
    Twins {
        with: write("with", with),
        without: write("without", without),
    }
}

/// An ICC profile's header and a description, as far as they are looked at.
fn profile() -> Vec<u8> {
    let mut profile = vec![0; 128];
    profile[16..20].copy_from_slice(b"RGB ");
    profile.extend(b"desc Adobe RGB (1998)");
    profile
}

/// A TIFF directory: tag, type, values as bytes in little-endian order.
fn exif(fields: &[(u16, u16, Vec<u8>)]) -> Vec<u8> {
    let each = |kind: u16| match kind {
        3 => 2,
        4 => 4,
        _ => 8,
    };
    let mut block = b"II*\0\x08\0\0\0".to_vec();
    block.extend((fields.len() as u16).to_le_bytes());
    let mut behind: Vec<u8> = Vec::new();
    let values_at = 8 + 2 + 12 * fields.len() + 4;
    for (tag, kind, value) in fields {
        block.extend(tag.to_le_bytes());
        block.extend(kind.to_le_bytes());
        block.extend(((value.len() / each(*kind)) as u32).to_le_bytes());
        if value.len() <= 4 {
            let mut four = value.clone();
            four.resize(4, 0);
            block.extend(four);
        } else {
            block.extend(((values_at + behind.len()) as u32).to_le_bytes());
            behind.extend(value);
        }
    }
    block.extend([0; 4]);
    block.extend(behind);
    block
}

fn short(tag: u16, value: u16) -> (u16, u16, Vec<u8>) {
    (tag, 3, value.to_le_bytes().to_vec())
}

fn ratio(tag: u16, value: u32) -> (u16, u16, Vec<u8>) {
    let parts = [value.to_le_bytes(), 1u32.to_le_bytes()];
    (tag, 5, parts.concat())
}

const SIZE: (u32, u32) = (2, 3);

/// Six different colours, red the first.
fn colours() -> Vec<u8> {
    vec![
        255, 0, 0, 10, 20, 30, 0, 255, 0, 0, 0, 255, 200, 100, 50, 90, 90, 90,
    ]
}

fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| match crc & 1 {
            1 => crc >> 1 ^ 0xedb8_8320,
            _ => crc >> 1,
        })
    })
}

/// A PNG with a chunk behind its header.
fn with_chunk(file: &[u8], kind: &[u8; 4], body: &[u8]) -> Vec<u8> {
    const HEADER_ENDS: usize = 8 + 12 + 13;
    let mut chunk = (body.len() as u32).to_be_bytes().to_vec();
    chunk.extend(kind);
    chunk.extend(body);
    chunk.extend(crc(&chunk[4..]).to_be_bytes());
    [&file[..HEADER_ENDS], &chunk, &file[HEADER_ENDS..]].concat()
}

fn plain_png(kind: ::png::ColorType, palette: Option<&[u8]>, pixels: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut file, SIZE.0, SIZE.1);
    encoder.set_color(kind);
    encoder.set_depth(::png::BitDepth::Eight);
    if let Some(palette) = palette {
        encoder.set_palette(palette.to_vec());
    }
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(pixels).expect("pixels");
    writer.finish().expect("an end");
    file
}

fn png(folder: &Path, field: &Field, _: &str) -> Twins {
    use ::png::ColorType::{Indexed, Rgb, Rgba};
    let base = plain_png(Rgb, None, &colours());
    let words = |values: &[u32]| -> Vec<u8> {
        values
            .iter()
            .flat_map(|value| value.to_be_bytes())
            .collect()
    };
    let clear = |alpha: u8| {
        let mut pixels = [9, 9, 9, 255].repeat(6);
        pixels[3] = alpha;
        plain_png(Rgba, None, &pixels)
    };
    let indexed = |palette: &[u8]| plain_png(Indexed, Some(palette), &[0, 1, 0, 1, 1, 1]);
    let (kind, body): (&[u8; 4], Vec<u8>) = match field.name {
        "PLTE" => {
            let with = indexed(&[255, 0, 0, 0, 255, 0]);
            return twins(folder, with, indexed(&[0, 0, 0, 255, 255, 255]));
        }
        "alpha" => return twins(folder, clear(0), clear(255)),
        "tRNS" => (b"tRNS", vec![0, 255, 0, 0, 0, 0]),
        "pHYs" => (b"pHYs", [words(&[2000, 3000]), vec![1]].concat()),
        "pHYs without a unit" => (b"pHYs", [words(&[2, 1]), vec![0]].concat()),
        "eXIf" => (b"eXIf", exif(&[short(274, 6)])),
        "iCCP" => {
            let packed = miniz_oxide::deflate::compress_to_vec_zlib(&profile(), 6);
            (b"iCCP", [b"name\0\0".to_vec(), packed].concat())
        }
        "cICP" => (b"cICP", vec![9, 16, 0, 1]),
        "gAMA" => (b"gAMA", words(&[100_000])),
        "cHRM" => (
            b"cHRM",
            words(&[
                31_270, 32_900, 70_800, 29_200, 17_000, 79_700, 13_100, 4_600,
            ]),
        ),
        "acTL" => (b"acTL", words(&[2, 0])),
        other => panic!("no file for {other}"),
    };
    let with = with_chunk(&base, kind, &body);
    twins(folder, with, base)
}

fn jpeg(folder: &Path, field: &Field, _: &str) -> Twins {
    let mut base = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut base, 100);
    let written = encoder.write_image(&colours(), SIZE.0, SIZE.1, ExtendedColorType::Rgb8);
    written.expect("encodes");
    assert_eq!(&base[6..11], b"JFIF\0");
    let density = |unit: u8, across: u8, down: u8| {
        let mut file = base.clone();
        file[13..18].copy_from_slice(&[unit, 0, across, 0, down]);
        file
    };
    let segment = |marker: u8, body: &[u8]| {
        let length = (body.len() as u16 + 2).to_be_bytes();
        [&base[..20], &[0xff, marker], &length, body, &base[20..]].concat()
    };
    let with_exif = |block: Vec<u8>| segment(0xe1, &[b"Exif\0\0".to_vec(), block].concat());
    let with = match field.name {
        "JFIF density" => density(2, 50, 50),
        "JFIF density without a unit" => density(0, 2, 1),
        "Orientation" => with_exif(exif(&[short(274, 6)])),
        "XResolution" => with_exif(exif(&[ratio(282, 50), ratio(283, 60), short(296, 3)])),
        "ColorSpace" => {
            // The inner directory stands behind the outer one.
            let outer = 8 + 2 + 12 + 4;
            let pointer = (0x8769, 4, u32::to_le_bytes(outer).to_vec());
            let inner = &exif(&[short(0xa001, 65_535)])[8..];
            with_exif([exif(&[pointer]).as_slice(), inner].concat())
        }
        "ICC_PROFILE" => segment(
            0xe2,
            &[b"ICC_PROFILE\0\x01\x01".to_vec(), profile()].concat(),
        ),
        other => panic!("no file for {other}"),
    };
    twins(folder, with, base)
}

fn webp(folder: &Path, field: &Field, _: &str) -> Twins {
    let mut base = Vec::new();
    let encoder = WebPEncoder::new_lossless(&mut base);
    let written = encoder.write_image(&colours(), SIZE.0, SIZE.1, ExtendedColorType::Rgb8);
    written.expect("encodes");
    let picture = &base[12..];
    assert_eq!(&picture[..4], b"VP8L");
    let chunk = |kind: &[u8; 4], body: &[u8]| {
        let mut chunk = [&kind[..], &(body.len() as u32).to_le_bytes(), body].concat();
        chunk.resize(chunk.len().next_multiple_of(2), 0);
        chunk
    };
    let [width, height] = [SIZE.0, SIZE.1].map(|side| (side - 1) as u8);
    let extended = |flags: u8, parts: &[&[u8]]| {
        let size = [flags, 0, 0, 0, width, 0, 0, height, 0, 0];
        let body = [b"WEBP".to_vec(), chunk(b"VP8X", &size), parts.concat()].concat();
        chunk(b"RIFF", &body)
    };
    let with = match field.name {
        "Orientation" => extended(8, &[picture, &chunk(b"EXIF", &exif(&[short(274, 6)]))]),
        "ICCP" => extended(0x20, &[&chunk(b"ICCP", &profile()), picture]),
        "ANIM" => {
            let place = [0, 0, 0, 0, 0, 0, width, 0, 0, height, 0, 0, 9, 0, 0, 2];
            let frame = chunk(b"ANMF", &[&place[..], picture].concat());
            extended(2, &[&chunk(b"ANIM", &[0; 6]), &frame, &frame])
        }
        other => panic!("no file for {other}"),
    };
    twins(folder, with, base)
}

fn tiff(folder: &Path, field: &Field, _: &str) -> Twins {
    type Extra = Vec<(u16, u16, Vec<u32>)>;
    let grey = |extra: Extra| Tiff {
        extra,
        ..Tiff::new(SIZE.0, SIZE.1, 8)
    };
    let greys = [0, 50, 100, 150, 200, 250];
    let file = |extra: Extra| grey(extra).with(&greys);
    let resolution = [
        (282, 5, vec![50, 1]),
        (283, 5, vec![60, 1]),
        (296, 3, vec![3]),
    ];
    let all_but = |left_out: usize| {
        let mut some = resolution.to_vec();
        some.remove(left_out);
        twins(folder, file(resolution.to_vec()), file(some))
    };
    let bytes = |list: &[u8]| list.iter().map(|&byte| u32::from(byte)).collect();
    let of = |change: &dyn Fn(&mut Tiff), bits: u16, data: &[u8]| {
        let mut tiff = Tiff::new(SIZE.0, SIZE.1, bits);
        change(&mut tiff);
        tiff.with(data)
    };
    let extra = match field.name {
        "Orientation" => vec![(274, 3, vec![6])],
        "XResolution" => return all_but(0),
        "YResolution" => return all_but(1),
        "ResolutionUnit" => return all_but(2),
        "ResolutionUnit none" => {
            vec![
                (282, 5, vec![1, 1]),
                (283, 5, vec![2, 1]),
                (296, 3, vec![1]),
            ]
        }
        "PhotometricInterpretation" => {
            let with = of(&|tiff| tiff.photometric = 0, 8, &greys);
            return twins(folder, with, file(Vec::new()));
        }
        "ColorMap" => {
            let map = |value: u16| {
                of(
                    &|tiff| {
                        tiff.photometric = 3;
                        tiff.colour_map = vec![65_535, 0, 0, value, 0, 0];
                    },
                    1,
                    &[0x80, 0x40, 0xc0],
                )
            };
            return twins(folder, map(65_535), map(0));
        }
        "FillOrder" => {
            let file = |order| of(&|tiff| tiff.fill_order = order, 1, &[0x80, 0x40, 0x03]);
            return twins(folder, file(2), file(1));
        }
        "ExtraSamples" => {
            let data: Vec<u8> = (0..6).flat_map(|k| [9, 9, 9, 40 * k]).collect();
            let file = |extra: Extra| {
                of(
                    &|tiff| {
                        (tiff.photometric, tiff.samples) = (2, 4);
                        tiff.extra.clone_from(&extra);
                    },
                    8,
                    &data,
                )
            };
            return twins(folder, file(vec![(338, 3, vec![2])]), file(Vec::new()));
        }
        "sample format" => vec![(339, 3, vec![3])],
        "ICCProfile" => vec![(34_675, 7, bytes(&profile()))],
        "TransferFunction" => vec![(301, 3, vec![0, 1, 2])],
        "WhitePoint" => vec![(318, 5, vec![3457, 10_000, 3585, 10_000])],
        "PrimaryChromaticities" => vec![(319, 5, [708, 1000, 292, 1000].repeat(3))],
        "InkSet" => {
            let file = |extra: Extra| {
                of(
                    &|tiff| {
                        (tiff.photometric, tiff.samples) = (5, 4);
                        tiff.extra.clone_from(&extra);
                    },
                    8,
                    &[30; 24],
                )
            };
            return twins(folder, file(vec![(332, 3, vec![2])]), file(Vec::new()));
        }
        "page" => {
            let one = file(Vec::new());
            let at = u32::from_le_bytes([one[4], one[5], one[6], one[7]]) as usize;
            let (next, end) = (one.len() - 4, one.len().next_multiple_of(2));
            let mut two = one.clone();
            two[next..].copy_from_slice(&(end as u32).to_le_bytes());
            two.resize(end, 0);
            two.extend(&one[at..]);
            return twins(folder, two, one);
        }
        other => panic!("no file for {other}"),
    };
    twins(folder, file(extra), file(Vec::new()))
}

fn gif(folder: &Path, field: &Field, _: &str) -> Twins {
    const PALETTES: [&[u8]; 2] = [&[255, 0, 0, 0, 255, 0], &[0, 0, 0, 255, 255, 255]];
    let frame = |change: &dyn Fn(&mut ::gif::Frame<'_>)| {
        let mut frame = ::gif::Frame {
            width: SIZE.0 as u16,
            height: SIZE.1 as u16,
            buffer: vec![0, 1, 1, 1, 0, 0].into(),
            ..::gif::Frame::default()
        };
        change(&mut frame);
        frame
    };
    let file = |width: u16, palette: &[u8], frames: &[::gif::Frame<'_>]| {
        let mut file = Vec::new();
        let encoder = ::gif::Encoder::new(&mut file, width, SIZE.1 as u16, palette);
        let mut encoder = encoder.expect("a header");
        for frame in frames {
            encoder.write_frame(frame).expect("a frame");
        }
        drop(encoder);
        file
    };
    let width = SIZE.0 as u16;
    let plain = frame(&|_| {});
    let base = file(width, PALETTES[1], std::slice::from_ref(&plain));
    let one = |width: u16, change: &dyn Fn(&mut ::gif::Frame<'_>)| {
        file(width, PALETTES[1], &[frame(change)])
    };
    let (with, without) = match field.name {
        "global color table" => (file(width, PALETTES[0], &[plain]), base),
        "local color table" => {
            let own = one(width, &|frame| frame.palette = Some(PALETTES[0].to_vec()));
            (own, base)
        }
        "transparent color index" => {
            let dark = |clear: Option<u8>| {
                file(
                    width,
                    PALETTES[0],
                    &[frame(&|frame| frame.transparent = clear)],
                )
            };
            (dark(Some(1)), dark(None))
        }
        "image left position" => (
            one(width + 1, &|frame| frame.left = 1),
            one(width + 1, &|_| {}),
        ),
        "pixel aspect ratio" => {
            let mut with = base.clone();
            with[12] = 113;
            (with, base)
        }
        "ICCRGBG1012" => {
            let profile = profile();
            let mut block = b"\x21\xff\x0bICCRGBG1012".to_vec();
            block.push(profile.len() as u8);
            block.extend(profile);
            block.push(0);
            let table_ends = 13 + 6;
            let with = [&base[..table_ends], &block, &base[table_ends..]].concat();
            (with, base)
        }
        "animation" => (file(width, PALETTES[1], &[plain.clone(), plain]), base),
        other => panic!("no file for {other}"),
    };
    twins(folder, with, without)
}

fn pcx(folder: &Path, field: &Field, _: &str) -> Twins {
    let file = |dpi: u16, first: [u8; 3]| {
        let mut file = Vec::new();
        let size = (SIZE.0 as u16, SIZE.1 as u16);
        let mut writer = ::pcx::WriterPaletted::new(&mut file, size, (dpi, dpi)).expect("a header");
        for row in [[0, 1], [1, 1], [0, 0]] {
            writer.write_row(&row).expect("a row");
        }
        let mut palette = vec![0; 256 * 3];
        palette[..3].copy_from_slice(&first);
        writer.write_palette(&palette).expect("a palette");
        file
    };
    // Four planes of one bit, as Paintbrush draws in sixteen colours.
    let four = |second: [u8; 3]| {
        let mut file = vec![0; 128];
        file[..4].copy_from_slice(&[10, 5, 1, 1]);
        file[8] = SIZE.0 as u8 - 1;
        file[10] = SIZE.1 as u8 - 1;
        file[19..22].copy_from_slice(&second);
        file[65] = 4;
        file[66] = 2;
        // Of the first plane the left pixel is set.
        for _ in 0..SIZE.1 {
            file.extend([0x80, 0, 0, 0, 0, 0, 0, 0]);
        }
        file
    };
    match field.name {
        "header palette" => twins(folder, four([255, 0, 0]), four([0, 0, 255])),
        "256 colour palette" => twins(folder, file(0, [255, 0, 0]), file(0, [0, 255, 0])),
        "HDpi" => twins(folder, file(150, [9; 3]), file(0, [9; 3])),
        other => panic!("no file for {other}"),
    }
}

fn bmp(folder: &Path, field: &Field, _: &str) -> Twins {
    const FILE_HEADER: usize = 14;
    // Rows of three or four bytes a pixel, padded.
    let file = |bits: u16, palette: &[u8], rows: &[u8], change: &dyn Fn(&mut [u8])| {
        let size = 108;
        let mut header = vec![0; size];
        let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, &(size as u32).to_le_bytes());
        put(4, &SIZE.0.to_le_bytes());
        put(8, &SIZE.1.to_le_bytes());
        put(12, &1u16.to_le_bytes());
        put(14, &bits.to_le_bytes());
        put(32, &(palette.len() as u32 / 4).to_le_bytes());
        put(56, b"BGRs");
        change(&mut header);
        let pixels_at = FILE_HEADER + size + palette.len();
        let mut file = b"BM".to_vec();
        file.extend(((pixels_at + rows.len()) as u32).to_le_bytes());
        file.extend([0; 4]);
        file.extend((pixels_at as u32).to_le_bytes());
        [&file, &header, palette, rows].concat()
    };
    let coloured: Vec<u8> = (0..3).flat_map(|y| [y, 9, 9, 80, 90, 99, 0, 0]).collect();
    let set = |at: usize, value: u32| {
        move |header: &mut [u8]| header[at..at + 4].copy_from_slice(&value.to_le_bytes())
    };
    let plain = |change: &dyn Fn(&mut [u8])| file(24, &[], &coloured, change);
    let resolved = |across: u32, down: u32| {
        plain(&|header| {
            set(24, across)(header);
            set(28, down)(header);
        })
    };
    let tabled = |first: [u8; 4]| {
        let palette = [first, [255; 4]].concat();
        file(8, &palette, &[0, 1, 0, 0].repeat(3), &|_| {})
    };
    let masked = |alpha: u32| {
        let rows: Vec<u8> = (0..6).flat_map(|k| [9, 9, 9, 40 * k]).collect();
        file(32, &[], &rows, &|header| {
            set(16, 3)(header);
            for (at, mask) in [(40, 0xff_0000), (44, 0xff00), (48, 0xff), (52, alpha)] {
                set(at, mask)(header);
            }
        })
    };
    let (with, without) = match field.name {
        "Height below 0" => (plain(&set(8, -(SIZE.1 as i32) as u32)), plain(&|_| {})),
        "XPelsPerMeter" => (resolved(2000, 3000), resolved(0, 3000)),
        "YPelsPerMeter" => (resolved(2000, 3000), resolved(2000, 0)),
        "color table" => (tabled([0, 0, 255, 0]), tabled([0; 4])),
        "AlphaMask" => (masked(0xff00_0000), masked(0)),
        "CSType" => (
            plain(&|header| header[56..60].copy_from_slice(b"KNIL")),
            plain(&|_| {}),
        ),
        other => panic!("no file for {other}"),
    };
    twins(folder, with, without)
}
