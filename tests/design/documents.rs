//! Design documents: what is written is what is read, and nothing else is accepted.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::sync::Arc;

use pickglass::design::{
    Corrections, Density, Design, Family, Fill, FirstEnd, ForeignSection, Grid, Lattice, Region,
    RegionYarns, Regions, Repeat, Sett, SourceImage, Srgb, Structure, WeavePattern, Yarn, YarnId,
    YarnMap, YarnMaps,
};
use pickglass::formats::{LoadOptions, load, ron};
use pickglass::{atomic, presets};

/// A design that uses everything a document can hold.
fn everything() -> Design {
    let map = Grid::from_fn(70, 33, |end, pick| ((end / 9 + pick / 7) % 3) as u16).unwrap();
    let drawn = WeavePattern::parse("##.\n.##\n#.#").unwrap();
    let region = |name: &str, fill, origin| Region {
        colour: Some(Srgb(200, 30, 4)),
        origin,
        ..Region::new(name, fill)
    };
    let mut palette = vec![
        region(
            "ground \"one\"",
            Fill::by_notation("1/7 satin").unwrap(),
            (0, 0),
        ),
        region("drawn", Fill::drawn(drawn), (-5, 9)),
        region("blüte", Fill::by_notation("s 3/1 twill").unwrap(), (2, -3)),
    ];
    palette[1].locked = true;
    palette[2].yarns = Some(RegionYarns {
        warp: YarnId(0),
        weft: YarnId(2),
    });
    let mut mask = WeavePattern::new(70, 33);
    mask.set(69, 32, true);
    let corrections = Corrections::new(mask.clone(), mask).unwrap();
    let regions = Regions::new(map, palette, Some(corrections)).unwrap();
    let picture: Vec<_> = (0..35u8).map(|k| [k, 255 - k, 7 * k]).collect();
    let source = SourceImage::new(5, 7, picture).unwrap();
    let regions = regions.with_source(Some(Arc::new(source)));
    let yarns = vec![
        Yarn::new("a", Family::Wool, Srgb(1, 2, 3)),
        Yarn {
            gloss: Some(0.11),
            diameter_mm: Some(0.31),
            surface_share: 0.0,
            ..Yarn::new("b", Family::Linen, Srgb(255, 0, 128))
        },
        Yarn::new("c", Family::Silk, Srgb(0, 0, 0)).with_tex(7.25),
    ];
    let weft = Grid::from_fn(70, 33, |end, _| YarnId(u16::from(end > 30))).unwrap();
    let maps = YarnMaps {
        warp: YarnMap::Order(vec![YarnId(2), YarnId(2), YarnId(0)]),
        weft: YarnMap::Crossings(weft),
    };
    let sett = Sett {
        ends: Density {
            per_cm: 31.7,
            pitches_mm: Some(vec![0.3, 0.35, 0.1]),
        },
        picks: Density::per_cm(28.25),
        assumed: true,
    };
    let mut design = Design::new("All of it", Structure::Regions(regions), yarns, maps, sett)
        .unwrap()
        .with_lattice(Lattice {
            across: Repeat::Dropped(11),
            along: Repeat::None,
        })
        .unwrap();
    design.notes = "first\nsecond \\ \"quoted\"".into();
    let origin = std::sync::Arc::make_mut(&mut design.origin);
    origin.first_end = FirstEnd::Right;
    origin.program = Some("Other".into());
    origin.palette = vec![Srgb(9, 8, 7)];
    origin.sections = vec![ForeignSection {
        name: "PRIVATE X".into(),
        text: "a=b\n;".into(),
    }];
    design
}

#[test]
fn everything_a_design_holds_survives() {
    let design = everything();
    let text = ron::write(&design).unwrap();
    let read = ron::read(text.as_bytes(), "x").unwrap();
    assert!(read == design, "{text}");
    assert!(!read.weavable());
    assert!(read.weave().get(69, 32));
    // Another design does not compare equal.
    let other = presets::design("default").unwrap().unwrap();
    assert!(read != other);
}

#[test]
fn documents_are_opened_by_content_whatever_they_are_called() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("design.wif");
    let design = everything();
    let text = ron::write(&design).unwrap();
    atomic::write(&path, text.as_bytes()).unwrap();
    let options = LoadOptions::default();
    assert!(load(&path, &options).unwrap().design == design);
    let finer = LoadOptions {
        sett: Some((63.4, 50.0)),
        ..options
    };
    let finer = load(&path, &finer).unwrap().design;
    assert!(
        (finer.sett().ends.pitch_of(1) - 0.175).abs() < 1e-6,
        "ratios stay"
    );
    assert!((finer.sett().pick_pitch_mm() - 0.2).abs() < 1e-6);
    let wrong = LoadOptions {
        sett: Some((f32::NAN, 1.0)),
        ..LoadOptions::default()
    };
    assert!(
        load(&path, &wrong)
            .unwrap_err()
            .to_string()
            .contains("give another sett")
    );
}

/// The error of the all-in-one document with one text replaced.
fn refusal(from: &str, to: &str) -> String {
    let text = ron::write(&everything()).unwrap();
    assert!(text.contains(from), "{from} in {text}");
    let message = ron::read(text.replacen(from, to, 1).as_bytes(), "x.ron")
        .unwrap_err()
        .to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.starts_with("x.ron"), "{message}");
    message
}

#[test]
fn numbers_that_cannot_be_are_refused_with_their_name() {
    assert!(refusal("ends_per_cm: 31.7", "ends_per_cm: NaN").contains("ends per cm"));
    assert!(refusal("ends_per_cm: 31.7", "ends_per_cm: inf").contains("ends per cm"));
    assert!(refusal("ends_per_cm: 31.7", "ends_per_cm: -2.0").contains("ends per cm"));
    assert!(refusal("0.35", "-0.35").contains("pitch 2 of the ends"));
    assert!(refusal("Some(0.31)", "Some(1e30)").contains("diameter_mm"));
    assert!(refusal("Some(0.11)", "Some(-inf)").contains("gloss"));
    assert!(refusal("ends: 70", "ends: 0").contains("no cloth"));
    assert!(refusal("ends: 70", "ends: 4294967295").contains("too many crossings"));
    assert!(refusal("ends: 70", "ends: -70").contains("damaged"));
    assert!(refusal("ends: 70", "ends: 71").contains("70 × 33 pixels"));
    assert!(refusal("2*2 0", "2*2 3").contains("warp names yarn 3"));
    assert!(refusal("2*2 0", "2*4000000000 0").contains("at most"));
    assert!(refusal("2*2 0", "").contains("empty order"));
    assert!(refusal("#ff0080", "pink").contains("#rrggbb"));
    assert!(refusal("\"linen\"", "\"hemp\"").contains("cotton, silk, wool or linen"));
    assert!(refusal("s 3/1 twill", "s 3/1 twist").contains("no weave known"));
    assert!(refusal("yarns: Some((0, 2))", "yarns: Some((0, 3))").contains("yarn 3"));
    assert!(refusal("along: Once", "along: Dropped(3)").contains("both directions"));
}

#[test]
fn the_source_picture_is_bounded_and_documents_without_one_are_read() {
    let text = ron::write(&everything()).unwrap();
    let start = text.find("source: Some(\"").unwrap();
    let end = start + text[start..].find("\"),").unwrap() + 3;
    let without = format!("{}{}", &text[..start], &text[end..]);
    let read = ron::read(without.as_bytes(), "x").unwrap();
    assert!(read != everything());
    let Structure::Regions(regions) = read.structure() else {
        panic!("regions stay regions")
    };
    assert!(regions.source().is_none());
    let older = without
        .replace("locked: true,", "")
        .replace("yarns: Some((0, 2)),", "");
    assert!(older.len() < without.len() - 20);
    assert!(ron::read(older.as_bytes(), "x").is_ok());
    // A weave's PNG is no picture.
    let weave = text.split("mask: \"").nth(1).unwrap();
    let weave = weave.split('"').next().unwrap();
    let picture = &text[start + "source: Some(\"".len()..end - 3];
    assert!(refusal(picture, weave).contains("source"));
    assert!(refusal(picture, "aGVsbG8=").contains("source"));
}

#[test]
fn fields_of_later_programs_are_skipped_and_told() {
    let text = ron::write(&everything()).unwrap();
    let later = text.replacen("ends: 70", "mood: [(1, \"calm\")], ends: 70", 1);
    let (design, told) = ron::read_told(later.as_bytes(), "x").unwrap();
    assert!(design == everything());
    assert!(
        told.len() == 1 && told[0].contains("design.mood"),
        "{told:?}"
    );
    // Control: what is known is not told of.
    assert!(ron::read_told(text.as_bytes(), "x").unwrap().1.is_empty());
    let newer = text.replacen("pickglass: 1", "pickglass: 2", 1);
    let message = ron::read(newer.as_bytes(), "x").unwrap_err().to_string();
    assert!(message.contains("newer than"), "{message}");
}
