//! What real programs do to WIF, one small file each.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;

use pickglass::design::{Lifting, Structure, WeavePattern};
use pickglass::formats::{Imported, LoadOptions, wif};

fn bytes(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    std::fs::read(folder.join(name)).unwrap()
}

fn fixture(name: &str) -> Imported {
    wif::read(&bytes(name), name).unwrap_or_else(|error| panic!("{error}"))
}

/// The plain twill with one text replaced by another.
fn changed(from: &str, to: &str) -> Result<Imported, wif::WifError> {
    let text = String::from_utf8(bytes("plain_twill.wif")).unwrap();
    assert!(text.contains(from), "{from}");
    wif::read(text.replacen(from, to, 1).as_bytes(), "changed.wif")
}

fn refusal(from: &str, to: &str) -> String {
    let message = changed(from, to).unwrap_err().to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.starts_with("changed.wif"), "{message}");
    message
}

fn warned(imported: &Imported, about: &str) {
    let list = &imported.warnings;
    assert!(
        list.iter().any(|line| line.contains(about)),
        "{about}: {list:#?}"
    );
}

const TWILL: &str = "#..#\n..##\n.##.\n##..\n";

#[test]
fn files_that_say_the_same_in_other_ways_weave_the_same() {
    for name in [
        "plain_twill.wif",
        "no_header.wif",
        "both_agree.wif",
        "counts_from_zero.wif",
        "range_999.wif",
        "crlf_blank_lines.wif",
        "latin_1.wif",
        "byte_order_mark.wif",
        "comments_and_case.wif",
        "continued_lines.wif",
        "wrong_counts.wif",
        "missing_threads.wif",
        "odd_lines.wif",
        "decipoints.wif",
        "no_units.wif",
        "private_sections.wif",
    ] {
        assert_eq!(fixture(name).design.weave().to_string(), TWILL, "{name}");
    }
    // And one that does not.
    assert_ne!(
        fixture("both_differ_lift_plan_loom.wif")
            .design
            .weave()
            .to_string(),
        TWILL
    );
}

#[test]
fn a_clean_file_gives_no_warning() {
    assert_eq!(fixture("plain_twill.wif").warnings, Vec::<String>::new());
    assert_eq!(fixture("both_agree.wif").warnings, Vec::<String>::new());
    warned(&fixture("no_header.wif"), "no [WIF]");
}

#[test]
fn a_sinking_shed_turns_the_cloth_over() {
    let twill = WeavePattern::parse(TWILL).unwrap();
    let sinking = fixture("sinking_shed.wif").design;
    assert_eq!(sinking.weave(), twill.inverted());
    let text = wif::write(&sinking).unwrap().text;
    assert!(text.contains("Rising Shed=false"));
    assert_eq!(
        wif::read(text.as_bytes(), "x").unwrap().design.weave(),
        twill.inverted()
    );
}

#[test]
fn tie_up_wins_over_a_lift_plan_that_differs() {
    let differ = fixture("both_differ.wif");
    assert_eq!(differ.design.weave().to_string(), TWILL);
    warned(&differ, "lift plan weaves another cloth");
    let loom = fixture("both_differ_lift_plan_loom.wif").design;
    assert_eq!(loom.weave().to_string(), format!(".#..\n{}", &TWILL[5..]));
}

#[test]
fn several_shafts_and_treadles_are_joined() {
    let weave = fixture("several_shafts_and_treadles.wif").design.weave();
    assert_eq!(weave.to_string(), "....\n##.#\n.#.#\n##..\n");
}

#[test]
fn counts_grow_to_what_is_used() {
    let wrong = fixture("wrong_counts.wif");
    let Structure::Draft(draft) = wrong.design.structure() else {
        panic!("a draft");
    };
    assert_eq!(draft.shafts(), 4);
    assert!(matches!(draft.lifting(), Lifting::LiftPlan(_)));
    warned(&wrong, "Shafts=2 is declared, but 4 are used");
    warned(&wrong, "thread 5 in [LIFTPLAN] is beyond the last");
    warned(&fixture("missing_threads.wif"), "declares no Threads");
}

#[test]
fn odd_lines_are_named_and_passed_over() {
    let odd = fixture("odd_lines.wif");
    warned(&odd, "line 1: text before the first section");
    warned(&odd, "\"3\" has no \"=\"");
    warned(&odd, "thread 2 in [THREADING] stands there again");
    warned(&odd, "\"five\" in [THREADING] is no thread");
    warned(&odd, "thread 9 in [THREADING] is beyond");
}

#[test]
fn texts_are_read_in_either_encoding_and_addresses_left_out() {
    let latin = fixture("latin_1.wif");
    assert_eq!(latin.design.name, "Körper für Zoë");
    warned(&latin, "Author is personal");
    let text = wif::write(&latin.design).unwrap().text;
    assert!(text.contains("Title=Körper für Zoë"));
    assert!(!text.contains("zoe@example.org") && !text.contains("Author"));
    assert_eq!(fixture("byte_order_mark.wif").design.name, "Körper");
    assert_eq!(fixture("plain_twill.wif").design.name, "plain_twill");
}

fn colours(imported: &Imported, warp: bool) -> Vec<String> {
    let design = &imported.design;
    (0..4)
        .map(|thread| {
            let id = match warp {
                true => design.maps().warp(thread, 0),
                false => design.maps().weft(0, thread),
            };
            design.yarn(id).colour.to_string()
        })
        .collect()
}

#[test]
fn colours_follow_range_table_and_defaults() {
    let wide = fixture("range_999.wif");
    assert_eq!(colours(&wide, true), ["#ff0080"; 4]);
    assert_eq!(colours(&wide, false), ["#00ffff"; 4]);
    let none = fixture("no_header.wif");
    assert_eq!(colours(&none, true), ["#ffffff"; 4]);
    assert_eq!(colours(&none, false), ["#0000ff"; 4]);
    let channels = fixture("colour_with_channels.wif");
    assert_eq!(
        colours(&channels, true),
        ["#c80a14", "#c80a14", "#0a1e5a", "#c80a14"]
    );
    let moved = changed("Range=0,255", "Range=10,210").unwrap();
    assert_eq!(colours(&moved, false), ["#001a66"; 4]);
    warned(
        &changed("Range=0,255", "Range=0,100").unwrap(),
        "outside Range",
    );
    warned(
        &changed("Range=0,255", "Range=9").unwrap(),
        "no usable Range",
    );
}

#[test]
fn spacing_is_the_pitch_in_its_unit() {
    let sett = |name| fixture(name).design.sett().clone();
    assert!((sett("crlf_blank_lines.wif").end_pitch_mm() - 1.27).abs() < 1e-5);
    assert!((sett("decipoints.wif").end_pitch_mm() - 1.27).abs() < 1e-5);
    warned(&fixture("decipoints.wif"), "Decipoints");
    let inches = fixture("crlf_blank_lines.wif").design;
    let diameter = |thread| inches.yarn(inches.maps().warp(thread, 0)).diameter();
    assert!(
        (diameter(0) - 1.016).abs() < 1e-4,
        "thickness is the drawn width"
    );
}

#[test]
fn a_programs_default_spacing_gives_way_and_comes_back() {
    let imported = fixture("default_spacing.wif");
    warned(&imported, "drawing program's default");
    let design = imported.design;
    assert!(design.sett().assumed);
    let pitch = design.sett().end_pitch_mm();
    assert!((0.2..0.3).contains(&pitch), "usual for cotton: {pitch}");
    // Ratios between single threads are kept.
    assert!((design.sett().ends.pitch_of(1) / pitch - 0.5).abs() < 1e-5);
    let text = wif::write(&design).unwrap().text;
    assert!(text.contains("Spacing=0.212") && text.contains("[WARP SPACING]\n2=0.106\n"));
    // A sett that somebody gives is believed and written.
    let options = LoadOptions {
        sett: Some((24.0, 20.0)),
        ..LoadOptions::default()
    };
    let given = wif::read_with(&bytes("default_spacing.wif"), "x.wif", &options).unwrap();
    assert!((given.design.sett().pick_pitch_mm() - 0.5).abs() < 1e-6);
    let text = wif::write(&given.design).unwrap().text;
    assert!(
        text.contains("Spacing=0.05\n") && !text.contains("0.212"),
        "{text}"
    );
    // The sett makes cloth, not a basket.
    let yarn = given.design.yarn(given.design.maps().weft(0, 0));
    assert!(yarn.diameter() / 0.5 > 0.7);
}

#[test]
fn spacing_without_a_unit_keeps_only_its_ratios() {
    let imported = fixture("no_units.wif");
    warned(&imported, "without Units");
    let ends = &imported.design.sett().ends;
    assert!(ends.pitch_mm() < 0.5);
    assert!((ends.pitch_of(1) / ends.pitch_of(0) - 2.0).abs() < 1e-5);
}

#[test]
fn thickness_above_spacing_is_yarns_that_touch() {
    let imported = fixture("thickness_above_spacing.wif");
    warned(&imported, "Thickness is greater");
    let design = imported.design;
    let cover = design.yarns()[0].diameter() / design.sett().end_pitch_mm();
    assert!((0.9..=1.0).contains(&cover), "{cover}");
    assert!(
        wif::write(&design)
            .unwrap()
            .text
            .contains("Thickness=0.0213")
    );
}

#[test]
fn private_sections_and_notes_survive() {
    let design = fixture("private_sections.wif").design;
    assert_eq!(design.notes, "first ; with a semicolon\nsecond");
    let text = wif::write(&design).unwrap().text;
    let kept = "[PRIVATE SHOP LOOM]\nreed = 12/1\n; keep me\n5=;not a comment\n";
    assert!(text.contains(kept), "{text}");
    assert!(text.contains("[TW PROJECT]\nSett=24\n") && text.contains("[WARP SYMBOLS]"));
    let again = wif::read(text.as_bytes(), "x").unwrap().design;
    assert_eq!(again.origin.sections, design.origin.sections);
    assert_eq!(again.notes, design.notes);
}

#[test]
fn refusals_say_where_what_and_what_to_do() {
    let message = refusal("3=3\n4=4\n[TIEUP]", "3=x\n4=4\n[TIEUP]");
    assert!(message.contains("line 22: expected numbers"), "{message}");
    assert!(refusal("1=200,10,20", "1=200,10").contains("number=red,green,blue"));
    assert!(refusal("Shafts=4", "Shafts=many").contains("whole number"));
    assert!(refusal("Shafts=4", "Shafts=-4").contains("whole number"));
    assert!(refusal("Threads=4", "Threads=99999999").contains("up to 100000"));
    assert!(refusal("[THREADING]", "[THREADS]").contains("[THREADING]"));
    assert!(refusal("[WARP]", "[WARP] and [WEFT]").contains("end after [WARP]"));
    assert!(refusal("1=1,2\n", "1=1,4294967295\n").contains("up to 65535"));
    assert!(refusal("Threads=4", "Threads=4\nSpacing=wide").contains("Spacing"));
    assert!(refusal("Threads=4", "Threads=4\nSpacing=1e999").contains("Spacing"));
    assert!(refusal("Threads=4", "Threads=4\nColor=red").contains("colour's number"));
    let nothing = wif::read(b"hello", "h.wif").unwrap_err().to_string();
    assert!(
        nothing.contains("found none; choose a .wif file"),
        "{nothing}"
    );
}

#[test]
fn sizes_are_checked_before_memory_is_asked_for() {
    let text = String::from_utf8(bytes("plain_twill.wif")).unwrap();
    let bomb = text.replace("Threads=4", "Threads=100000");
    let message = wif::read(bomb.as_bytes(), "bomb.wif")
        .unwrap_err()
        .to_string();
    assert!(message.contains("too many crossings"), "{message}");
    let wide = text.replacen("Threads=4", "Threads=100000", 1);
    assert_eq!(
        wif::read(wide.as_bytes(), "wide.wif")
            .unwrap()
            .design
            .ends(),
        100_000
    );
    let headers = "[A]\n".repeat(1_000_000);
    assert!(wif::read(headers.as_bytes(), "headers.wif").is_err());
}

#[test]
fn what_a_wif_cannot_hold_is_listed() {
    use pickglass::presets;
    let design = presets::design("twill-satin").unwrap().unwrap();
    let written = wif::write(&design).unwrap();
    let lost = written.lost.join("\n");
    assert!(
        lost.contains("regions") && lost.contains("made of"),
        "{lost}"
    );
    let back = wif::read(written.text.as_bytes(), "x").unwrap().design;
    assert_eq!(back.weave(), design.weave());
    // Orders of another period than the weave are written out whole.
    let check = presets::design("default").unwrap().unwrap();
    let back = wif::read(wif::write(&check).unwrap().text.as_bytes(), "x").unwrap();
    assert_eq!(back.design.ends(), 64);
    for thread in 0..64 {
        let colour = |design: &pickglass::design::Design| {
            let maps = design.maps();
            let (warp, weft) = (maps.warp(thread, 0), maps.weft(0, thread));
            (design.yarn(warp).colour, design.yarn(weft).colour)
        };
        assert_eq!(colour(&check), colour(&back.design));
    }
    let sett = |design: &pickglass::design::Design| design.sett().end_pitch_mm();
    assert!((sett(&check) / sett(&back.design) - 1.0).abs() < 1e-5);
}

#[test]
fn colours_outside_the_table_or_the_range_are_replaced_and_counted() {
    // A table with a hole: 2 is not there.
    let hole = changed("1=200,10,20\n2=", "1=200,10,20\n3=").unwrap();
    warned(&hole, "no colour 2; ");
    let beyond = changed("Threads=4", "Threads=4\nColor=-3").unwrap();
    warned(&beyond, "4 ends have colour numbers");
    warned(&beyond, "colour -3");
    let huge = changed("Threads=4", "Threads=4\nColor=99999999999999999999").unwrap();
    assert_eq!(colours(&huge, true), colours(&beyond, true));
    assert_eq!(colours(&huge, true), ["#c80a14"; 4]);
    // The channels behind a number that the table lacks are the colour.
    let channels = changed("Threads=4", "Threads=4\nColor=9,1,2,3").unwrap();
    assert_eq!(colours(&channels, true), ["#010203"; 4]);
    let infinite = changed("1=200,10,20", "1=inf,-1e40,20").unwrap();
    assert_eq!(colours(&infinite, true), ["#ff0014"; 4]);
    warned(&infinite, "a colour lies outside Range=0,255: cut off");
    assert!(refusal("1=200,10,20", "1=nan,10,20").contains("number=red,green,blue"));
}

#[test]
fn colours_count_from_0_only_where_all_of_them_fit() {
    let with = |weft: &str| {
        let threads = "[WEFT]\nThreads=4";
        changed(
            threads,
            &format!("{threads}\nColor=0\n[WEFT COLORS]\n{weft}"),
        )
        .unwrap()
    };
    let from_zero = with("1=1\n");
    warned(&from_zero, "counted from 0");
    let (first, second) = (
        "#c80a14".to_owned(),
        colours(&fixture("plain_twill.wif"), false)[0].clone(),
    );
    assert_eq!(colours(&from_zero, false)[..2], [second, first]);
    // Colour 2 would be a third: the file counts from 1, and 0 is a colour it lacks.
    let from_one = with("1=2\n");
    warned(&from_one, "3 picks have colour numbers outside the 2");
}
