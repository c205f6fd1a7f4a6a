//! Images of every kind that looms and image programs write: decided by what is displayed.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use crate::image_files::{Samples, Tiff, bmp, folder, pack};
use pickglass::design::{Srgb, Structure, YarnMap};
use pickglass::formats::image::{
    Black, Colours, Convention, Encoding, ImageAs, ImageReading, Key, Pixels, read,
};
use pickglass::formats::{FormatError, Imported, LoadOptions, load_bytes};

/// The image from its top row; `#` = black. Nothing about it is symmetric.
const ART: &str = "\
##.#...#.#.
.####.....#
#...#.##..#
#.#.......#
";

fn art() -> Vec<Vec<bool>> {
    ART.lines()
        .map(|row| row.chars().map(|c| c == '#').collect())
        .collect()
}

fn load(bytes: &[u8], reading: ImageReading) -> Result<Imported, FormatError> {
    let options = LoadOptions {
        image: reading,
        ..LoadOptions::default()
    };
    load_bytes(bytes, "x.img", &options)
}

/// What an image is without being told, as text art.
fn woven(bytes: &[u8]) -> String {
    let imported = load(bytes, ImageReading::default()).unwrap();
    assert!(matches!(imported.design.structure(), Structure::Pattern(_)));
    imported.design.weave().to_string()
}

#[test]
fn tiff_polarity_and_bit_order_do_not_matter() {
    let black_one = pack(&art(), 1, true);
    let black_zero = pack(&art(), 1, false);
    let turned: Vec<u8> = black_zero.iter().map(|byte| byte.reverse_bits()).collect();
    for big_endian in [false, true] {
        let tiff = |photometric, fill_order, data: &[u8]| {
            Tiff {
                photometric,
                fill_order,
                big_endian,
                ..Tiff::new(11, 4, 1)
            }
            .with(data)
        };
        assert_eq!(woven(&tiff(0, 1, &black_one)), ART);
        assert_eq!(woven(&tiff(1, 1, &black_zero)), ART);
        assert_eq!(woven(&tiff(1, 2, &turned)), ART);
        // The same bits with the other polarity are the other cloth.
        assert_ne!(woven(&tiff(1, 1, &black_one)), ART);
        assert_ne!(woven(&tiff(1, 1, &turned)), ART);
    }
}

#[test]
fn strips_tiles_and_endless_strips_are_put_together() {
    let data = pack(&art(), 1, false);
    for rows in [1, 3, 4, u32::MAX] {
        let tiff = Tiff {
            rows_per_strip: rows,
            ..Tiff::new(11, 4, 1)
        };
        assert_eq!(woven(&tiff.with(&data)), ART, "{rows} rows a strip");
    }
    let tiled = Tiff {
        tile: Some((16, 16)),
        ..Tiff::new(11, 4, 8)
    };
    assert_eq!(woven(&tiled.with(&pack(&art(), 8, false))), ART);
}

#[test]
fn group_4_fax_is_read_in_both_bit_orders() {
    let mut encoder = fax::encoder::Encoder::new(fax::VecWriter::new());
    for row in art() {
        let line = row.iter().map(|&black| match black {
            true => fax::Color::Black,
            false => fax::Color::White,
        });
        let _ = encoder.encode_line(line, 11);
    }
    let data = encoder.finish().unwrap().finish();
    let turned: Vec<u8> = data.iter().map(|byte| byte.reverse_bits()).collect();
    let tiff = |fill_order, data: &[u8]| {
        Tiff {
            photometric: 0,
            compression: 4,
            fill_order,
            rows_per_strip: u32::MAX,
            ..Tiff::new(11, 4, 1)
        }
        .with(data)
    };
    assert_eq!(woven(&tiff(1, &data)), ART);
    assert_eq!(woven(&tiff(2, &turned)), ART);
    let group_3 = Tiff {
        compression: 3,
        ..Tiff::new(11, 4, 1)
    };
    let error = load(&group_3.with(&data), ImageReading::default()).unwrap_err();
    assert!(error.to_string().contains("group 3"), "{error}");
}

#[test]
fn palette_tiffs_keep_indices_and_colours() {
    for bits in [1u16, 4, 8] {
        // Colour 0 is white and colour 1 black.
        let mut map = vec![0u16; 3 << bits];
        for channel in 0..3 {
            map[channel << bits] = 65_535;
        }
        for eight in [false, true] {
            // Some programs write 8-bit values into the map.
            let map = map
                .iter()
                .map(|&value| if eight { value >> 8 } else { value });
            let tiff = Tiff {
                photometric: 3,
                colour_map: map.collect(),
                ..Tiff::new(11, 4, bits)
            };
            let data = pack(&art(), bits, true);
            let bytes = tiff.with(&data);
            assert_eq!(woven(&bytes), ART, "{bits} bits");
            let decoded = read(&bytes, "x").unwrap();
            assert_eq!(decoded.raster.palette()[0], Srgb(255, 255, 255));
            assert_eq!(decoded.raster.index(0, 0), Some(1));
        }
    }
}

#[test]
fn colours_of_tiffs_in_planes_16_bits_and_cmyk() {
    let red = |samples: Samples<'_>, planar, photometric, bits, data: &[u8]| {
        let tiff = Tiff {
            photometric,
            planar,
            samples: samples.0,
            ..Tiff::new(2, 1, bits)
        };
        let decoded = read(&tiff.with(data), samples.1).unwrap();
        [decoded.raster.colour(0, 0), decoded.raster.colour(1, 0)]
    };
    let both = [Srgb(255, 0, 0), Srgb(0, 0, 255)];
    assert_eq!(
        red(Samples(3, "rgb"), false, 2, 8, &[255, 0, 0, 0, 0, 255]),
        both
    );
    assert_eq!(
        red(Samples(3, "planes"), true, 2, 8, &[255, 0, 0, 0, 0, 255]),
        both
    );
    let wide = [255, 255, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255];
    assert_eq!(red(Samples(3, "16 bits"), false, 2, 16, &wide), both);
    let inks = [0, 255, 255, 0, 255, 255, 0, 0];
    assert_eq!(red(Samples(4, "cmyk"), false, 5, 8, &inks), both);
    assert_ne!(
        red(Samples(3, "rgb"), false, 2, 8, &[0, 0, 255, 255, 0, 0]),
        both
    );
}

#[test]
fn bmp_palettes_and_row_order_do_not_matter() {
    let (black, white) = ([0, 0, 0], [255, 255, 255]);
    for bits in [1u16, 4, 8] {
        for top_down in [false, true] {
            let straight = bmp(&art(), bits, top_down, &[black, white], false);
            let white_first = bmp(&art(), bits, top_down, &[white, black], true);
            assert_eq!(woven(&straight), ART, "{bits} bits, top down: {top_down}");
            assert_eq!(
                woven(&white_first),
                ART,
                "{bits} bits, top down: {top_down}"
            );
            let wrong = bmp(&art(), bits, top_down, &[white, black], false);
            assert_ne!(woven(&wrong), ART);
        }
    }
}

fn png_of(
    kind: png::ColorType,
    depth: png::BitDepth,
    size: (u32, u32),
    data: &[u8],
    set: impl FnOnce(&mut png::Encoder<'_, &mut Vec<u8>>),
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size.0, size.1);
    encoder.set_color(kind);
    encoder.set_depth(depth);
    set(&mut encoder);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn pngs_of_all_depths_are_read() {
    use png::{BitDepth, ColorType};
    let size = (11, 4);
    for (depth, bits) in [
        (BitDepth::One, 1),
        (BitDepth::Two, 2),
        (BitDepth::Four, 4),
        (BitDepth::Eight, 8),
    ] {
        let grey = pack(&art(), bits, false);
        // White of a deeper grey is its largest number.
        let grey: Vec<u8> = match bits {
            1 => grey,
            2 => grey.iter().map(|byte| byte * 3).collect(),
            4 => grey.iter().map(|byte| byte * 15).collect(),
            _ => grey.iter().map(|byte| byte * 255).collect(),
        };
        let bytes = png_of(ColorType::Grayscale, depth, size, &grey, |_| {});
        assert_eq!(woven(&bytes), ART, "grey of {bits} bits");
        let indices = pack(&art(), bits, true);
        let bytes = png_of(ColorType::Indexed, depth, size, &indices, |encoder| {
            encoder.set_palette(vec![255, 255, 255, 0, 0, 0]);
        });
        assert_eq!(woven(&bytes), ART, "palette of {bits} bits");
    }
    let flat = |pixel: fn(bool) -> Vec<u8>| -> Vec<u8> {
        art().into_iter().flatten().flat_map(pixel).collect()
    };
    let kinds: [(ColorType, BitDepth, Vec<u8>); 4] = [
        (
            ColorType::Rgb,
            BitDepth::Eight,
            flat(|b| vec![if b { 3 } else { 250 }; 3]),
        ),
        (
            ColorType::Rgb,
            BitDepth::Sixteen,
            flat(|b| vec![if b { 0 } else { 255 }; 6]),
        ),
        (
            ColorType::Grayscale,
            BitDepth::Sixteen,
            flat(|b| vec![if b { 0 } else { 255 }; 2]),
        ),
        // Black ink where it is opaque, clear elsewhere: the paper is white.
        (
            ColorType::Rgba,
            BitDepth::Eight,
            flat(|b| vec![0, 0, 0, if b { 255 } else { 0 }]),
        ),
    ];
    for (kind, depth, data) in kinds {
        let bytes = png_of(kind, depth, size, &data, |_| {});
        assert_eq!(woven(&bytes), ART, "{kind:?} {depth:?}");
        let clear = read(&bytes, "x").unwrap().warnings;
        assert_eq!(
            clear.len(),
            usize::from(kind == ColorType::Rgba),
            "{clear:?}"
        );
    }
}

#[test]
fn what_was_decided_is_said() {
    let mut grey: Vec<u8> = pack(&art(), 8, false)
        .iter()
        .map(|byte| byte * 255)
        .collect();
    grey[0] = 120;
    let size = (11, 4);
    let bytes = png_of(
        png::ColorType::Grayscale,
        png::BitDepth::Eight,
        size,
        &grey,
        |_| {},
    );
    // Three colours are artwork, unless somebody knows better.
    let imported = load(&bytes, ImageReading::default()).unwrap();
    assert!(matches!(imported.design.structure(), Structure::Regions(_)));
    let reading = ImageReading {
        what: Some(ImageAs::Weave),
        ..ImageReading::default()
    };
    let imported = load(&bytes, reading).unwrap();
    assert_eq!(imported.design.weave().to_string(), ART);
    assert_eq!(
        imported.warnings,
        [
            "read as a weave: black = warp up, bottom row = pick 1; 2.3 % of pixels are neither \
             black nor white"
        ]
    );
    let reading = ImageReading {
        black: Black::Weft,
        mirror: true,
        ..reading
    };
    let imported = load(&bytes, reading).unwrap();
    assert!(imported.warnings[0].contains("black = weft up"));
    assert!(imported.warnings[0].contains("Z becomes S"));
}

#[test]
fn two_dark_colours_are_told_apart_by_lightness() {
    let indices = pack(&art(), 1, true);
    let size = (11, 4);
    let bytes = png_of(
        png::ColorType::Indexed,
        png::BitDepth::One,
        size,
        &indices,
        |encoder| {
            encoder.set_palette(vec![90, 20, 20, 0, 0, 60]);
        },
    );
    let reading = Convention::Tc2.reading();
    assert_eq!(
        load(&bytes, reading).unwrap().design.weave().to_string(),
        ART
    );
}

#[test]
fn regions_follow_colour_and_not_the_palette_order() {
    let size = (3, 1);
    let order = |palette: Vec<u8>, indices: [u8; 3]| {
        let (kind, depth) = (png::ColorType::Indexed, png::BitDepth::Eight);
        png_of(kind, depth, size, &indices, |encoder| {
            encoder.set_palette(palette);
        })
    };
    let one = order(vec![9, 9, 9, 200, 0, 0, 0, 0, 120], [0, 1, 2]);
    let two = order(vec![0, 0, 120, 9, 9, 9, 77, 77, 77, 200, 0, 0], [1, 3, 0]);
    let regions = |bytes: &[u8], key| {
        let reading = ImageReading {
            what: Some(ImageAs::Artwork),
            key,
            ..ImageReading::default()
        };
        let design = load(bytes, reading).unwrap().design;
        let Structure::Regions(regions) = design.structure() else {
            panic!("regions")
        };
        regions.clone()
    };
    assert_eq!(regions(&one, Key::Rgb), regions(&two, Key::Rgb));
    let dark_to_light: Vec<_> = regions(&one, Key::Rgb)
        .palette()
        .iter()
        .map(|r| r.colour)
        .collect();
    assert_eq!(
        dark_to_light,
        [
            Some(Srgb(9, 9, 9)),
            Some(Srgb(0, 0, 120)),
            Some(Srgb(200, 0, 0))
        ]
    );
    let indexed = regions(&two, Key::Index);
    assert_eq!(
        indexed.palette().len(),
        4,
        "unused entries keep their number"
    );
    assert_eq!(indexed.map().iter().collect::<Vec<_>>(), [1, 3, 0]);
    let colours = png_of(
        png::ColorType::Rgb,
        png::BitDepth::Eight,
        (1, 1),
        &[1, 2, 3],
        |_| {},
    );
    let reading = ImageReading {
        what: Some(ImageAs::Artwork),
        key: Key::Index,
        ..ImageReading::default()
    };
    let error = load(&colours, reading).unwrap_err().to_string();
    assert!(
        error.contains("tell its parts apart by their colour"),
        "{error}"
    );
}

#[test]
fn yarn_images_are_orders_where_a_loom_can_weave_them() {
    let rows = [[0u8, 1, 1, 2], [0, 1, 1, 2], [0, 1, 1, 2]];
    let (kind, depth) = (png::ColorType::Indexed, png::BitDepth::Eight);
    let palette = vec![10, 10, 10, 120, 120, 120, 240, 240, 240];
    let image = |rows: [[u8; 4]; 3]| {
        png_of(kind, depth, (4, 3), rows.as_flattened(), |encoder| {
            encoder.set_palette(palette.clone());
        })
    };
    let read_as = |bytes: &[u8], what| {
        let reading = ImageReading {
            what: Some(what),
            ..ImageReading::default()
        };
        load(bytes, reading).unwrap().design
    };
    let stripes = image(rows);
    let warp = read_as(&stripes, ImageAs::Warp);
    let order: Vec<u16> = warp
        .maps()
        .warp
        .order()
        .unwrap()
        .iter()
        .map(|id| id.0)
        .collect();
    assert_eq!(order, [0, 1, 1, 2]);
    assert!(warp.weavable());
    let weft = read_as(&stripes, ImageAs::Weft);
    assert!(matches!(weft.maps().weft, YarnMap::Crossings(_)) && !weft.weavable());
    let mut changed = rows;
    changed[2][3] = 0;
    assert!(!read_as(&image(changed), ImageAs::Warp).weavable());
}

#[test]
fn pictures_are_sent_to_posterise() {
    let ramp: Vec<u8> = (0..300u32)
        .flat_map(|k| [k as u8, (k / 2) as u8, (k / 256) as u8])
        .collect();
    let bytes = png_of(
        png::ColorType::Rgb,
        png::BitDepth::Eight,
        (30, 10),
        &ramp,
        |_| {},
    );
    let message = load(&bytes, ImageReading::default())
        .unwrap_err()
        .to_string();
    assert!(message.contains("pickglass posterize x.img"), "{message}");
    for what in [ImageAs::Artwork, ImageAs::Warp] {
        let reading = ImageReading {
            what: Some(what),
            ..ImageReading::default()
        };
        let message = load(&bytes, reading).unwrap_err().to_string();
        assert!(message.contains("at most 256 flat colours"), "{message}");
    }
}

#[test]
fn jpegs_are_thresholded_only_when_told_and_with_a_warning() {
    let black_left =
        image::GrayImage::from_fn(16, 8, |x, _| image::Luma([if x < 8 { 0 } else { 255 }]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    black_left
        .write_to(&mut bytes, image::ImageFormat::Jpeg)
        .unwrap();
    let bytes = bytes.into_inner();
    assert!(load(&bytes, ImageReading::default()).is_err());
    let imported = load(&bytes, Convention::Tc2.reading()).unwrap();
    assert_eq!(imported.design.weave().count_warp_up(), 64);
    assert!(
        imported
            .warnings
            .iter()
            .any(|line| line.contains("JPEG changes colours"))
    );
}

#[test]
fn pcx_is_read() {
    let mut bytes = Vec::new();
    let mut writer = pcx::WriterPaletted::new(&mut bytes, (11, 4), (300, 300)).unwrap();
    for row in art() {
        let row: Vec<u8> = row.iter().map(|&black| u8::from(black)).collect();
        writer.write_row(&row).unwrap();
    }
    writer.write_palette(&[255, 255, 255, 0, 0, 0]).unwrap();
    assert_eq!(Encoding::of(&bytes), Some(Encoding::Pcx));
    assert_eq!(woven(&bytes), ART);
}

/// What becomes of a file of the collection.
enum Expected {
    /// Width, height, displayed colours (`None` = more than 256) and what it is.
    Read(u32, u32, Option<usize>, &'static str),
    Refused(&'static str),
}

#[test]
fn the_collection_is_read_warned_about_or_refused() {
    use Expected::{Read, Refused};
    let Some(folder) = folder() else { return };
    // Sizes, colours and formats as Pillow and tifffile give them. The chessboard has 8-bit
    // greys in 16 bits, so that all it shows is black and a hair lighter than black.
    let expected = [
        ("Bad_reallybig.bmp", Refused("3000000 × 2000000")),
        ("Bad_shortfile.bmp", Refused("cannot hold them")),
        ("Bad_width.bmp", Refused("more than a design")),
        ("Info_1_Bit.bmp", Read(6, 6, Some(2), "weave")),
        ("Info_1_Bit_Top_Down.bmp", Read(6, 6, Some(2), "weave")),
        ("Info_4_Bit.bmp", Read(6, 6, Some(3), "artwork")),
        ("Info_8_Bit.bmp", Read(6, 6, Some(3), "artwork")),
        ("astronaut.png", Read(512, 512, None, "picture")),
        ("checker_bilevel.png", Read(10, 10, Some(2), "weave")),
        ("chessboard_GRAY_U16.tif", Read(200, 200, Some(2), "weave")),
        ("coffee.png", Read(600, 400, None, "picture")),
        ("fax4.tiff", Read(1080, 671, Some(2), "weave")),
        ("horse.png", Read(400, 328, Some(128), "picture")),
        ("multipage.tif", Read(10, 15, Some(150), "picture")),
        ("pal8badindex.bmp", Read(127, 64, Some(60), "artwork")),
        ("pal8rle.bmp", Read(127, 64, Some(151), "picture")),
        ("palette-1c-4b.tiff", Read(157, 151, Some(16), "artwork")),
        ("palette-1c-8b.tiff", Read(157, 151, Some(256), "picture")),
        ("palette_color.png", Read(10, 10, Some(78), "picture")),
        ("seq-1c-1b-71f6a21a.tiff", Read(16, 16, Some(2), "weave")),
        (
            "seq-1c-1b-miniswhite-71f6a21a.tiff",
            Read(16, 16, Some(2), "weave"),
        ),
        ("truncated.jpg", Refused("damaged")),
    ];
    let mut files: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    assert_eq!(
        files,
        expected.iter().map(|entry| entry.0).collect::<Vec<_>>()
    );
    for (name, expected) in expected {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        let decoded = read(&bytes, name);
        match (expected, decoded) {
            (Refused(why), Err(error)) => {
                let line = error.to_string();
                println!("{name:36} refused: {line}");
                assert!(line.starts_with(name) && line.contains(why), "{line}");
                assert_eq!(line.lines().count(), 1);
            }
            (Refused(_), Ok(_)) => panic!("{name} must be refused"),
            (Read(..), Err(error)) => panic!("{name}: {error}"),
            (Read(width, height, colours, what), Ok(decoded)) => {
                let raster = &decoded.raster;
                assert_eq!((raster.width(), raster.height()), (width, height), "{name}");
                let found = match raster.colours() {
                    Colours::Few(few) => Some(few.len()),
                    Colours::Many => None,
                };
                assert_eq!(found, colours, "{name}");
                let options = LoadOptions::default();
                let loaded = load_bytes(&bytes, name, &options);
                let (found, said) = match &loaded {
                    Ok(imported) => match imported.design.structure() {
                        Structure::Pattern(_) => ("weave", imported.warnings.join(" | ")),
                        _ => ("artwork", imported.warnings.join(" | ")),
                    },
                    Err(error) => ("picture", error.to_string()),
                };
                println!("{name:36} {width}×{height} {found}: {said}");
                assert_eq!(found, what, "{name}: {said}");
            }
        }
    }
}

#[test]
fn the_collections_pixels_are_the_displayed_ones() {
    let Some(folder) = folder() else { return };
    let open = |name: &str| read(&std::fs::read(folder.join(name)).unwrap(), name).unwrap();
    // Both polarities show the same picture.
    let (one, other) = (
        open("seq-1c-1b-71f6a21a.tiff").raster,
        open("seq-1c-1b-miniswhite-71f6a21a.tiff").raster,
    );
    let same = |a: &pickglass::formats::image::Raster, b: &pickglass::formats::image::Raster| {
        (0..a.height()).all(|y| (0..a.width()).all(|x| a.colour(x, y) == b.colour(x, y)))
    };
    assert!(matches!(one.pixels(), Pixels::Bits(_)));
    assert!(same(&one, &other));
    // Counts of Pillow: 480033 black of 1080 × 671, and twenty of six by six.
    let count = |name: &str| match open(name).raster.colours() {
        Colours::Few(few) => few,
        Colours::Many => Vec::new(),
    };
    let black = |name: &str| count(name)[0];
    assert_eq!(black("fax4.tiff"), (Srgb(0, 0, 0), 480_033));
    assert_eq!(black("Info_1_Bit.bmp"), (Srgb(0, 0, 0), 20));
    assert_eq!(black("Info_1_Bit_Top_Down.bmp"), (Srgb(0, 0, 0), 20));
    let many = count("palette-1c-4b.tiff");
    assert!(many.contains(&(Srgb(202, 49, 41), 3221)), "{many:?}");
    let bad = open("pal8badindex.bmp");
    assert!(
        bad.warnings[0].contains("those missing are black"),
        "{:?}",
        bad.warnings
    );
    let pages = open("multipage.tif");
    assert!(pages.warnings[0].contains("only the first page"));
}
