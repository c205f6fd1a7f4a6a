//! One drawdown through every pair of formats: bit for bit the same, whatever the way.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use pickglass::design::{
    Design, Family, Fill, Grid, Region, Regions, Sett, Srgb, Structure, WeavePattern, Yarn, YarnId,
    YarnMap, YarnMaps,
};
use pickglass::formats::image::{Black, Corner, ImageAs, ImageContent, ImageReading, Key};
use pickglass::formats::{LoadOptions, MapFiles, SaveOptions};
use pickglass::formats::{load_bytes, save, save_bytes, with_map_files};

const ENDINGS: [&str; 6] = ["ron", "wif", "png", "bmp", "tif", "gif"];

/// A weave with no symmetry: any flip, turn or shift changes it.
fn weave(ends: u32, picks: u32) -> WeavePattern {
    WeavePattern::from_fn(ends, picks, |end, pick| {
        (end * 7 + pick * pick * 3 + end * end * pick) % 5 < 2 || (end, pick) == (0, 0)
    })
}

fn design(weave: WeavePattern) -> Design {
    let yarns = vec![
        Yarn::new("a", Family::Cotton, Srgb(20, 30, 90)),
        Yarn::new("b", Family::Cotton, Srgb(240, 240, 235)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let sett = Sett::per_cm(24.0, 18.0);
    Design::new("matrix", Structure::Pattern(weave), yarns, maps, sett).unwrap()
}

fn options(what: ImageAs) -> LoadOptions {
    LoadOptions {
        image: ImageReading {
            what: Some(what),
            ..ImageReading::default()
        },
        ..LoadOptions::default()
    }
}

fn through(design: &Design, ending: &str) -> Design {
    let saved = save_bytes(design, ending, &SaveOptions::default())
        .unwrap()
        .unwrap();
    load_bytes(&saved.bytes, "matrix.x", &options(ImageAs::Weave))
        .unwrap_or_else(|error| panic!("{ending}: {error}"))
        .design
}

#[test]
fn every_pair_of_formats_keeps_every_crossing() {
    for (ends, picks) in [(13, 5), (8, 8), (65, 9), (129, 70), (1, 3), (3, 1)] {
        let pattern = weave(ends, picks);
        if ends > 8 {
            for other in [
                pattern.mirrored(),
                pattern.inverted(),
                pattern.repeated(ends, picks, (1, 0)),
            ] {
                assert_ne!(other, pattern, "a flip would be seen");
            }
        }
        for first in ENDINGS {
            let once = through(&design(pattern.clone()), first);
            assert_eq!(once.weave(), pattern, "{first} {ends}×{picks}");
            for second in ENDINGS {
                let twice = through(&once, second);
                assert_eq!(twice.weave(), pattern, "{first} → {second} {ends}×{picks}");
            }
        }
    }
}

#[test]
fn a_single_changed_crossing_shows_in_every_format() {
    let pattern = weave(21, 6);
    for ending in ENDINGS {
        let mut other = pattern.clone();
        other.set(20, 5, !pattern.get(20, 5));
        assert_ne!(through(&design(other), ending).weave(), pattern, "{ending}");
    }
}

#[test]
fn the_sett_goes_through_resolutions() {
    for ending in ["png", "bmp", "tif", "wif", "ron"] {
        let back = through(&design(weave(10, 10)), ending);
        assert!(!back.sett().assumed, "{ending}");
        assert!((back.sett().ends.per_cm - 24.0).abs() < 0.01, "{ending}");
        assert!((back.sett().picks.per_cm - 18.0).abs() < 0.01, "{ending}");
    }
    assert!(through(&design(weave(10, 10)), "gif").sett().assumed);
    // 96 dots per inch in both directions are a program's default.
    let usual = design(weave(10, 10))
        .with_sett(Sett::per_cm(37.8, 37.8))
        .unwrap();
    for ending in ["png", "bmp", "tif"] {
        assert!(through(&usual, ending).sett().assumed, "{ending}");
        let saved = save_bytes(&usual, ending, &SaveOptions::default()).unwrap();
        let lost = saved.unwrap().lost.join("\n");
        assert!(lost.contains("looks like a program's default"), "{lost}");
    }
}

#[test]
fn polarity_and_corner_undo_themselves() {
    let pattern = weave(19, 7);
    for black in [Black::Warp, Black::Weft] {
        for corner in [
            Corner::BottomLeft,
            Corner::BottomRight,
            Corner::TopLeft,
            Corner::TopRight,
        ] {
            let how = SaveOptions {
                black,
                corner: Some(corner),
                ..SaveOptions::default()
            };
            let saved = save_bytes(&design(pattern.clone()), "tif", &how).unwrap();
            let bytes = saved.unwrap().bytes;
            let mut reading = options(ImageAs::Weave);
            (reading.image.black, reading.image.corner) = (black, corner);
            let back = load_bytes(&bytes, "x", &reading).unwrap().design;
            assert_eq!(back.weave(), pattern, "{black:?} {corner:?}");
            // Read the other way round it is another cloth.
            reading.image.mirror = true;
            let mirrored = load_bytes(&bytes, "x", &reading).unwrap().design;
            assert_eq!(mirrored.weave(), pattern.mirrored());
            reading.image.mirror = false;
            reading.image.black = match black {
                Black::Warp => Black::Weft,
                Black::Weft => Black::Warp,
            };
            let inverted = load_bytes(&bytes, "x", &reading).unwrap().design;
            assert_eq!(inverted.weave(), pattern.inverted());
        }
    }
}

#[test]
fn a_corner_keeps_the_twill_and_is_remembered() {
    // Three pixels of a Z twill: the line rises to the right in the image.
    let twill = WeavePattern::parse("..#\n.#.\n#..\n").unwrap();
    let bytes = save_bytes(&design(twill.clone()), "png", &SaveOptions::default());
    let bytes = bytes.unwrap().unwrap().bytes;
    for corner in [
        Corner::BottomLeft,
        Corner::BottomRight,
        Corner::TopLeft,
        Corner::TopRight,
    ] {
        let mut reading = options(ImageAs::Weave);
        reading.image.corner = corner;
        let read = load_bytes(&bytes, "x", &reading).unwrap().design;
        assert_eq!(read.weave(), twill, "{corner:?}: Z stays Z");
        let back = save_bytes(&read, "png", &SaveOptions::default()).unwrap();
        assert_eq!(back.unwrap().bytes, bytes, "{corner:?}");
    }
    // Turned by 180°, the last pixel of the first row is the first crossing.
    let corner_pixel = WeavePattern::parse("..#\n...\n").unwrap();
    let bytes = save_bytes(&design(corner_pixel), "png", &SaveOptions::default());
    let bytes = bytes.unwrap().unwrap().bytes;
    let mut reading = options(ImageAs::Weave);
    reading.image.corner = Corner::TopLeft;
    let read = load_bytes(&bytes, "x", &reading).unwrap().design;
    assert_eq!(read.weave().to_string(), "...\n#..\n");
}

fn artwork() -> Design {
    let map = Grid::from_fn(23, 11, |end, pick| {
        u16::from(end * pick % 7 > 2) + u16::from(end > 17)
    });
    let region = |name: &str, colour, notation| Region {
        locked: false,
        yarns: None,
        name: name.into(),
        colour: Some(colour),
        fill: Fill::by_notation(notation).unwrap(),
        origin: (0, 0),
    };
    let palette = vec![
        region("ink", Srgb(20, 20, 60), "7/1 satin"),
        region("rose", Srgb(220, 80, 90), "2/2 twill"),
        region("paper", Srgb(250, 245, 230), "1/7 satin"),
    ];
    let regions = Regions::new(map.unwrap(), palette, None).unwrap();
    design(weave(23, 11))
        .with_structure(Structure::Regions(regions))
        .unwrap()
}

fn regions(design: &Design) -> &Regions {
    match design.structure() {
        Structure::Regions(regions) => regions,
        other => panic!("{other:?}"),
    }
}

#[test]
fn artwork_goes_through_every_image_format() {
    let original = artwork();
    let how = SaveOptions {
        content: ImageContent::Artwork,
        ..SaveOptions::default()
    };
    for ending in ["png", "bmp", "tif", "gif"] {
        let saved = save_bytes(&original, ending, &how).unwrap().unwrap();
        assert!(saved.lost.iter().any(|line| line.contains("weaves")));
        for key in [Key::Rgb, Key::Index] {
            let mut reading = options(ImageAs::Artwork);
            reading.image.key = key;
            let back = load_bytes(&saved.bytes, "x", &reading).unwrap().design;
            let (back, wanted) = (regions(&back), regions(&original));
            // The regions' colours run from dark to light already.
            assert_eq!(back.map(), wanted.map(), "{ending} {key:?}");
            for (found, wanted) in back.palette().iter().zip(wanted.palette()) {
                assert_eq!(found.colour, wanted.colour, "{ending} {key:?}");
            }
        }
    }
    let plain = save_bytes(&design(weave(4, 4)), "png", &how).unwrap();
    assert!(plain.unwrap_err().to_string().contains("without any"));
}

#[test]
fn first_weaves_follow_lightness() {
    let how = SaveOptions {
        content: ImageContent::Artwork,
        ..SaveOptions::default()
    };
    let saved = save_bytes(&artwork(), "png", &how).unwrap().unwrap();
    let back = load_bytes(&saved.bytes, "x", &LoadOptions::default()).unwrap();
    let palette = regions(&back.design).palette().to_vec();
    let notations: Vec<_> = palette.iter().map(|r| r.fill.notation().unwrap()).collect();
    assert_eq!(notations, ["7/1 satin", "4/4 satin", "1/7 satin"]);
    assert!(back.warnings[0].contains("artwork of 3 colours"));
}

#[test]
fn yarn_maps_go_through_images_into_one_design() {
    let folder = tempfile::tempdir().unwrap();
    let grid = Grid::from_fn(12, 6, |end, pick| {
        YarnId(u16::from((end + pick * 2) % 5 < 2))
    });
    let maps = YarnMaps {
        warp: YarnMap::Order((0..12).map(|end| YarnId(u16::from(end % 4 == 0))).collect()),
        weft: YarnMap::Crossings(grid.unwrap()),
    };
    let yarns = vec![
        Yarn::new("a", Family::Cotton, Srgb(20, 30, 90)),
        Yarn::new("b", Family::Cotton, Srgb(240, 240, 235)),
    ];
    let original = design(weave(12, 6)).with_yarns(yarns, maps).unwrap();
    for (map_ending, ending) in [
        ("bmp", "png"),
        ("tif", "bmp"),
        ("gif", "tif"),
        ("png", "gif"),
    ] {
        let path = |name: &str, ending: &str| folder.path().join(format!("{name}.{ending}"));
        let write = |content, path| {
            let how = SaveOptions {
                content,
                ..SaveOptions::default()
            };
            save(&original, path, &how).unwrap()
        };
        let (pattern, warp, weft) = (
            path("pattern", ending),
            path("warp", map_ending),
            path("weft", map_ending),
        );
        write(ImageContent::Weave, &pattern);
        write(ImageContent::Warp, &warp);
        write(ImageContent::Weft, &weft);
        let none = LoadOptions::default();
        let read = pickglass::formats::load(&pattern, &none).unwrap();
        let files = MapFiles {
            warp: Some(warp.clone()),
            weft: Some(weft),
        };
        let both = with_map_files(read.clone(), &files, &none).unwrap();
        let dressed = &both.design;
        assert_eq!(dressed.weave(), original.weave());
        assert!(matches!(dressed.maps().warp, YarnMap::Order(_)));
        assert!(matches!(dressed.maps().weft, YarnMap::Crossings(_)));
        for pick in 0..6 {
            for end in 0..12 {
                let colour = |design: &Design, id| design.yarn(id).colour;
                assert_eq!(
                    colour(dressed, dressed.warp_yarn(end, pick)),
                    colour(&original, original.warp_yarn(end, pick))
                );
                assert_eq!(
                    colour(dressed, dressed.weft_yarn(end, pick)),
                    colour(&original, original.weft_yarn(end, pick))
                );
            }
        }
        assert_eq!(dressed.yarns().len(), 2, "a colour is one yarn");
        // A map of another size is named with both sizes.
        let small = pickglass::formats::load_bytes(
            &save_bytes(&design(weave(5, 6)), "png", &SaveOptions::default())
                .unwrap()
                .unwrap()
                .bytes,
            "small.png",
            &none,
        );
        let files = MapFiles {
            warp: Some(warp),
            weft: None,
        };
        let error = with_map_files(small.unwrap(), &files, &none).unwrap_err();
        let line = error.to_string();
        assert!(line.contains("5 × 6") && line.contains("12 × 6"), "{line}");
        assert_eq!(line.lines().count(), 1);
    }
}

#[test]
fn what_an_image_does_not_hold_is_named() {
    let lost = |design: &Design, ending: &str, content| {
        let how = SaveOptions {
            content,
            ..SaveOptions::default()
        };
        let saved = save_bytes(design, ending, &how).unwrap().unwrap();
        saved.lost.join("\n")
    };
    let mut noted = design(weave(6, 6));
    noted.notes = "for the blue room".into();
    let text = lost(&noted, "gif", ImageContent::Weave);
    for word in ["yarns", "notes", "sett"] {
        assert!(text.contains(word), "{word}: {text}");
    }
    assert!(!lost(&noted, "png", ImageContent::Weave).contains("sett"));
    assert!(lost(&artwork(), "png", ImageContent::Weave).contains("regions"));
    assert!(lost(&noted, "png", ImageContent::Warp).contains("the weave"));
    assert_eq!(lost(&noted, "ron", ImageContent::Weave), "");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.png");
    let text = save(&noted, &path, &SaveOptions::default())
        .unwrap()
        .join("\n");
    assert!(text.contains("its name, \"matrix\""), "{text}");
    let error = save(
        &noted,
        &folder.path().join("x.psd"),
        &SaveOptions::default(),
    );
    assert!(error.unwrap_err().to_string().contains("end the name"));
}
