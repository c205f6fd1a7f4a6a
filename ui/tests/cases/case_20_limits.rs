//! What tests/cases/20 wants of limits and of empty variables.

use crate::program::{Place, Said};

/// Files and options that state a sett, all at the same doors.
fn documents(place: &Place, sett: &str) -> [Said; 3] {
    let option = place.run(&["check", "oxford", "--sett", sett]);
    place.run(&["convert", "oxford", "a.ron"]).done();
    let text = std::fs::read_to_string(place.path("a.ron")).expect("a design");
    let at = text.find("sett: (").expect("a sett");
    let end = at + text[at..].find(')').expect("its end");
    let stated = format!("sett: (ends_per_cm: {sett}, picks_per_cm: {sett}");
    let text = format!("{}{stated}{}", &text[..at], &text[end..]);
    std::fs::write(place.path("a.ron"), text).expect("written");
    let document = place.run(&["check", "a.ron"]);
    let inches = (sett.parse::<f64>().expect("a number") * 2.54).to_string();
    place.run(&["convert", "oxford", "a.png"]).done();
    let picture = place.run(&[
        "posterize",
        "a.png",
        "-o",
        "b.ron",
        "--ends",
        "8",
        "--picks",
        "8",
        "--colours",
        "2",
        "--epi",
        &inches,
    ]);
    [option, document, picture]
}

#[test]
fn a_sett_is_let_in_by_every_door_or_by_none() {
    let place = Place::of("20");
    for within in ["0.5", "0.6", "24", "500"] {
        for said in documents(&place, within) {
            said.done();
        }
    }
    for beyond in ["0.49", "0.1", "501", "10000"] {
        for (door, said) in documents(&place, beyond).into_iter().enumerate() {
            assert_ne!(said.code, Some(0), "{beyond} at door {door}: {said:?}");
            let limit = if door == 2 {
                "1.27 to 1270"
            } else {
                "0.5 to 500"
            };
            assert!(said.err.contains(limit), "{beyond}: {}", said.err);
        }
    }
}

#[test]
fn yarns_of_as_many_crossings_as_are_promised_are_laid() {
    let place = Place::of("20");
    let yarns = |region: &str| place.run(&["volume", "oxford", "-o", "a.glb", "--region", region]);
    let refused = yarns("0,0,1,65537").refused();
    assert!(refused.contains("at most 65536 crossings"), "{refused}");
    // A thin window is no larger than it says, whatever is laid around it.
    yarns("0,0,1,7400").done();
}

#[test]
fn an_empty_variable_is_no_variable() {
    let place = Place::of("20");
    let said = place
        .command(&["synthesize", "oxford"])
        .env("PICKGLASS_CACHE", "")
        .env("PICKGLASS_MEMORY", "")
        .env("RUST_LOG", "")
        .output();
    let said = Said::of(said.expect("it starts")).done();
    assert_eq!(said.err, "");
    let left: Vec<_> = std::fs::read_dir(place.path("."))
        .expect("a folder")
        .collect();
    assert_eq!(left.len(), 1, "{left:?}");
}
