//! Card files written: into the hooks of a file there is, or of a preset, and nowhere else.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;

use pickglass::design::{
    Design, Family, Filled, Grid, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMap, YarnMaps,
    usual_sett,
};
use pickglass::formats::jc5::{
    LoomPreset, PRESETS, Role, WriteOptions, Written, parse, template, write_into,
};
use pickglass::formats::{LoadOptions, load_bytes};

const UP: WriteOptions = WriteOptions { face_down: false };
const DOWN: WriteOptions = WriteOptions { face_down: true };

fn fixture(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/looms");
    std::fs::read(folder.join(name)).unwrap()
}

fn read(bytes: &[u8], face_down: bool) -> Design {
    let options = LoadOptions {
        face_down,
        ..LoadOptions::default()
    };
    load_bytes(bytes, "card", &options).unwrap().design
}

fn design(structure: Structure) -> Design {
    let yarns = vec![Yarn::new("a", Family::Cotton, Srgb(20, 30, 90))];
    let maps = YarnMaps::plain(YarnId(0), YarnId(0));
    let sett = usual_sett(&yarns, &maps);
    Design::new("cloth", structure, yarns, maps, sett).unwrap()
}

fn woven(notation: &str, ends: u32, picks: u32) -> Design {
    let fill = Filled::once(notation).unwrap().fill().clone();
    design(Structure::Weave(Filled::new(fill, ends, picks).unwrap()))
}

fn refused(design: &Design) -> String {
    let error = write_into(&fixture("cloth.jc5"), "cloth.jc5", design, UP).unwrap_err();
    let message = error.to_string();
    assert_eq!(message.lines().count(), 1);
    assert!(message.starts_with("cloth.jc5") && message.contains("; "));
    message
}

#[test]
fn an_unchanged_card_file_comes_back_byte_by_byte() {
    for name in ["cloth.jc5", "face_down.jc5", "odd.jc5"] {
        let bytes = fixture(name);
        for options in [UP, DOWN] {
            let mut design = read(&bytes, options.face_down);
            let back = write_into(&bytes, name, &design, options).unwrap().bytes;
            assert!(back == bytes, "{name}");
            let mut weave = design.weave();
            weave.set(5, 3, !weave.get(5, 3));
            design = design.with_structure(Structure::Pattern(weave)).unwrap();
            let other = write_into(&bytes, name, &design, options).unwrap().bytes;
            let bits = |(a, b): (&u8, &u8)| (a ^ b).count_ones();
            assert_eq!(other.len(), bytes.len());
            assert_eq!(other.iter().zip(&bytes).map(bits).sum::<u32>(), 1, "{name}");
        }
    }
}

#[test]
fn another_number_of_picks_keeps_controls_and_continues_the_selvedge() {
    let bytes = fixture("cloth.jc5");
    let design = woven("2/2 twill", 24, 30);
    let Written { bytes, lost } = write_into(&bytes, "cloth.jc5", &design, UP).unwrap();
    assert!(
        lost.iter()
            .any(|line| line.contains("30 picks are no multiple of its 4"))
    );
    let card = parse(&bytes, "written").unwrap();
    assert_eq!(card.picks, 30);
    let roles: Vec<Role> = card.areas.iter().map(|area| area.role).collect();
    assert_eq!(roles, [Role::Controls, Role::Selvedge, Role::Cloth]);
    let first = |area: usize| card.area_rows(&card.areas[area]).next().unwrap().to_vec();
    assert_eq!(first(0), [0x01, 0x02]);
    // Two of four, one hook to the right with every pick.
    let rows: Vec<u8> = card.area_rows(&card.areas[1]).map(|row| row[0]).collect();
    assert_eq!(rows[..5], [0x33, 0x66, 0xcc, 0x99, 0x33]);
    assert_eq!(rows[28..], [0x33, 0x66]);
    assert_eq!(read(&bytes, false).weave(), design.weave());
}

#[test]
fn a_narrow_design_is_repeated_if_it_fits() {
    let bytes = fixture("cloth.jc5");
    let narrow = woven("1/7 satin", 8, 12);
    let written = write_into(&bytes, "cloth.jc5", &narrow, UP).unwrap();
    assert!(
        written
            .lost
            .iter()
            .any(|line| line.contains("repeated 3 times"))
    );
    let expected = narrow.weave().repeated(24, 12, (0, 0));
    assert_eq!(read(&written.bytes, false).weave(), expected);
    assert!(refused(&woven("1/4 satin", 10, 12)).contains("draw it on 8 or 12 ends"));
    assert!(refused(&woven("1/4 satin", 25, 12)).contains("24 hooks, the design 25 ends"));
}

#[test]
fn what_no_loom_weaves_is_listed() {
    let map = Grid::from_fn(24, 12, |end, _| YarnId(u16::from(end == 3))).unwrap();
    let two = |colour| Yarn::new("y", Family::Cotton, colour);
    let yarns = vec![two(Srgb(1, 2, 3)), two(Srgb(9, 9, 9))];
    let maps = YarnMaps {
        warp: YarnMap::Crossings(map),
        weft: YarnMap::single(YarnId(0)),
    };
    let preview = woven("plain", 24, 12).with_yarns(yarns, maps).unwrap();
    let lost = |design: &Design| {
        let written = write_into(&fixture("cloth.jc5"), "x", design, UP).unwrap();
        written.lost.join("\n")
    };
    assert!(lost(&preview).contains("previews only"));
    assert!(!lost(&woven("plain", 24, 12)).contains("previews only"));
    assert!(lost(&woven("plain", 24, 12)).contains("colours"));
}

#[test]
fn presets_make_files_of_their_looms() {
    for (name, _) in PRESETS {
        let preset = LoomPreset::named(name).unwrap().unwrap();
        let blank = template(&preset, name).unwrap();
        let hooks: Vec<u32> = preset.areas.iter().map(|area| area.hooks).collect();
        let card = parse(&blank, name).unwrap();
        let found: Vec<u32> = card.areas.iter().map(|area| area.hooks).collect();
        assert_eq!(hooks, found);
        let cloth = card.cloth().unwrap().hooks;
        let design = woven("1/7 satin", cloth, 64);
        let written = write_into(&blank, name, &design, UP).unwrap();
        assert_eq!(read(&written.bytes, false).weave(), design.weave());
        let roles: Vec<Role> = preset.areas.iter().map(|area| area.role).collect();
        let card = parse(&written.bytes, name).unwrap();
        let proposed: Vec<Role> = card.areas.iter().map(|area| area.role).collect();
        assert_eq!(roles, proposed);
    }
    assert!(LoomPreset::named("nobody's").is_none());
}

#[test]
fn presets_that_cannot_be_are_refused() {
    let wrong = |text: &str| {
        let preset = LoomPreset::parse(text, "own.ron");
        let message = preset.and_then(|preset| template(&preset, "own.ron"));
        message.unwrap_err().to_string()
    };
    let with = |areas: &str| format!("(about: \"\", face_down: false, areas: [{areas}])");
    assert!(wrong("(").starts_with("own.ron"));
    assert!(wrong(&with("")).contains("one area of cloth"));
    assert!(wrong(&with("(role: Cloth, hooks: 12)")).contains("multiple of 8"));
    let odd = "(role: Cloth, hooks: 64), (role: Selvedge, hooks: 8, weave: Some(\"mesh\"))";
    assert!(wrong(&with(odd)).contains("area 2"));
    let far = "(role: Cloth, hooks: 64), (role: Controls, hooks: 8, lifted: [9])";
    assert!(wrong(&with(far)).contains("hook 9 of 8"));
    let good = "(role: Cloth, hooks: 64), (role: Controls, hooks: 8, lifted: [8])";
    let preset = LoomPreset::parse(&with(good), "own.ron").unwrap();
    assert!(template(&preset, "own.ron").is_ok());
}

#[test]
fn sizes_beyond_the_file_are_refused_where_they_stand() {
    let bytes = fixture("cloth.jc5");
    let card = parse(&bytes, "x").unwrap();
    let (picks_at, header) = (card.picks_at, card.header.len());
    let mut far = bytes.clone();
    far[picks_at..picks_at + 4].copy_from_slice(&u32::MAX.to_be_bytes());
    let message = parse(&far, "x").unwrap_err().to_string();
    assert!(message.contains(&format!("byte {picks_at}: ")), "{message}");
    far[picks_at..picks_at + 4].copy_from_slice(&13u32.to_be_bytes());
    let message = parse(&far, "x").unwrap_err().to_string();
    assert!(
        message.contains(&format!("byte {header}: expected 13 rows")),
        "{message}"
    );
    let mut none = WeavePattern::parse("#.\n.#").unwrap();
    none.set(0, 0, false);
    let small = design(Structure::Pattern(none));
    assert!(write_into(b"no card", "x", &small, UP).is_err());
}
