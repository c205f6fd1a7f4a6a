//! The inputs of tests/cases/01, each with what is wanted of it.

use pickglass::design::{Design, Srgb, WeavePattern};
use pickglass::formats::{LoadOptions, load};

use crate::program::Place;

const FIRST: Srgb = Srgb(240, 240, 230);
const SECOND: Srgb = Srgb(20, 40, 90);

/// The one warning about colours that `check` prints of a draft, which is plain weave.
fn remark(place: &Place, name: &str) -> String {
    let said = place.run(&["check", name, "--json"]).done();
    let report = said.json();
    assert_eq!((&report["ends"], &report["picks"]), (&4.into(), &4.into()));
    let warnings = report["warnings"].as_array().expect("a list");
    let about: Vec<&str> = warnings
        .iter()
        .filter_map(serde_json::Value::as_str)
        .filter(|line| line.contains("colour"))
        .collect();
    assert_eq!(about.len(), 1, "{warnings:?}");
    let text = place.run(&["check", name]).done().out;
    assert!(text.contains(&format!("warning: {}", about[0])), "{text}");
    about[0].to_owned()
}

fn design(place: &Place, name: &str) -> Design {
    let design = load(&place.path(name), &LoadOptions::default())
        .expect("it opens")
        .design;
    let plain = WeavePattern::from_fn(4, 4, |end, pick| (end + pick) % 2 == 0);
    assert_eq!(design.weave(), plain);
    assert_ne!(design.weave(), plain.inverted());
    design
}

/// Colours of the ends and of the picks.
fn colours(design: &Design) -> [[Srgb; 4]; 2] {
    let threads = [0, 1, 2, 3];
    [
        threads.map(|end| design.yarn(design.warp_yarn(end, 0)).colour),
        threads.map(|pick| design.yarn(design.weft_yarn(0, pick)).colour),
    ]
}

#[test]
fn colours_counted_from_0_are_the_tables_first_and_second() {
    let place = Place::of("01");
    let name = "default-colours-0-and-1.wif";
    assert!(remark(&place, name).contains("counted from 0"));
    assert_eq!(colours(&design(&place, name)), [[FIRST; 4], [SECOND; 4]]);
}

#[test]
fn a_default_that_the_table_lacks_gets_the_directions_own() {
    let place = Place::of("01");
    let name = "default-colour-3-of-2.wif";
    let remark = remark(&place, name);
    assert!(
        remark.contains("4 picks") && remark.contains("colour 3"),
        "{remark}"
    );
    assert!(
        remark.contains("outside the 2 of [COLOR TABLE]"),
        "{remark}"
    );
    assert_eq!(colours(&design(&place, name)), [[FIRST; 4], [SECOND; 4]]);
}

#[test]
fn one_end_that_the_table_lacks_is_counted_and_gets_the_default() {
    let place = Place::of("01");
    let name = "one-end-colour-7-of-2.wif";
    let remark = remark(&place, name);
    assert!(remark.starts_with("line 34: 1 end has"), "{remark}");
    assert!(remark.contains("end 3: colour 7"), "{remark}");
    let design = design(&place, name);
    assert_eq!(colours(&design), [[FIRST; 4], [SECOND; 4]]);
    // It stays a yarn of its own, to be given the right colour.
    assert_ne!(design.warp_yarn(2, 0), design.warp_yarn(0, 0));
}

#[test]
fn numbers_without_any_table_are_white_and_blue() {
    let place = Place::of("01");
    let name = "colours-without-table.wif";
    let remark = remark(&place, name);
    assert!(remark.contains("4 ends and 4 picks"), "{remark}");
    assert!(remark.contains("there is no [COLOR TABLE]"), "{remark}");
    let (white, blue) = (Srgb(255, 255, 255), Srgb(0, 0, 255));
    assert_eq!(colours(&design(&place, name)), [[white; 4], [blue; 4]]);
}

#[test]
fn what_a_table_has_is_not_remarked_on() {
    let place = Place::of("01");
    let name = "one-end-colour-7-of-2.wif";
    let text = std::fs::read_to_string(place.path(name)).expect("a draft");
    std::fs::write(place.path(name), text.replace("3=7", "3=2")).expect("written");
    let report = place.run(&["check", name, "--json"]).done().json();
    assert!(
        !report["warnings"].to_string().contains("colour"),
        "{report}"
    );
    let warp = [FIRST, FIRST, SECOND, FIRST];
    assert_eq!(colours(&design(&place, name)), [warp, [SECOND; 4]]);
}

#[test]
fn a_design_document_stays_strict() {
    let place = Place::of("01");
    let made = "one-end-colour-7-of-2.wif";
    place.run(&["convert", made, "a.ron"]).done();
    let text = std::fs::read_to_string(place.path("a.ron")).expect("a design");
    let wrong = text.replacen("warp: Order(\"", "warp: Order(\"9 ", 1);
    assert_ne!(text, wrong);
    std::fs::write(place.path("a.ron"), wrong).expect("written");
    place.run(&["check", "a.ron"]).refused();
}
