//! The drafts of tests/cases/10: how their texts are encoded.

use crate::program::Place;

/// Name and warnings that `check` gives.
fn checked(place: &Place, name: &str) -> (String, Vec<String>) {
    let report = place.run(&["check", name, "--json"]).done().json();
    let warnings = report["warnings"].as_array().expect("a list");
    let texts = warnings.iter().map(|line| line.as_str().expect("a text"));
    let name = report["name"].as_str().expect("a name");
    (name.to_owned(), texts.map(str::to_owned).collect())
}

/// Units of UTF-16 as bytes.
fn wide(text: &str, bytes: fn(u16) -> [u8; 2], mark: bool) -> Vec<u8> {
    let mark = mark.then_some(0xfeff);
    mark.into_iter()
        .chain(text.encode_utf16())
        .flat_map(bytes)
        .collect()
}

#[test]
fn utf_16_with_its_mark_is_read() {
    let place = Place::of("10");
    let bytes = std::fs::read(place.path("utf16.wif")).expect("a draft");
    assert!(bytes.starts_with(b"\xff\xfe"));
    let (name, warnings) = checked(&place, "utf16.wif");
    assert!(
        !warnings.iter().any(|line| line.contains("UTF-16")),
        "{warnings:?}"
    );
    // The same text in UTF-8 is the same draft.
    let units = bytes[2..]
        .chunks_exact(2)
        .map(|unit| u16::from_le_bytes([unit[0], unit[1]]));
    let text: String = char::decode_utf16(units)
        .map(|sign| sign.expect("whole"))
        .collect();
    std::fs::write(place.path("utf8.wif"), text).expect("written");
    let (other, told) = checked(&place, "utf8.wif");
    assert_eq!((name.replace("16", "8"), warnings), (other, told));
}

#[test]
fn signs_of_windows_1252_are_read() {
    let place = Place::of("10");
    let bytes = std::fs::read(place.path("cp1252.wif")).expect("a draft");
    assert!(bytes.contains(&0x96));
    let (name, _) = checked(&place, "cp1252.wif");
    assert!(name.contains('–') && !name.contains('\u{96}'), "{name}");
}

#[test]
fn every_text_format_is_read_in_every_encoding() {
    let place = Place::of("10");
    let looms = place.case().join("../../fixtures/looms");
    let texts = [
        ("dtx", std::fs::read_to_string(looms.join("draft.dtx"))),
        ("dbw", std::fs::read_to_string(looms.join("draft.dbw"))),
        (
            "wif",
            std::fs::read_to_string(looms.join("../plain_twill.wif")),
        ),
    ];
    for (ending, text) in texts {
        let text = text.expect("a draft");
        let plain = format!("plain.{ending}");
        std::fs::write(place.path(&plain), &text).expect("written");
        let known = place.run(&["check", &plain, "--json"]).done().json();
        for mark in [true, false] {
            for order in [u16::to_le_bytes, u16::to_be_bytes] {
                let name = format!("plain.{ending}");
                std::fs::write(place.path(&name), wide(&text, order, mark)).expect("written");
                let read = place.run(&["check", &name, "--json"]).done().json();
                assert_eq!(read, known, "{ending} {mark}");
            }
        }
    }
    // Designs too, which are written in UTF-8 alone.
    place.run(&["convert", "plain.wif", "a.ron"]).done();
    let text = std::fs::read_to_string(place.path("a.ron")).expect("a design");
    let known = place.run(&["check", "a.ron", "--json"]).done().json();
    std::fs::write(place.path("a.ron"), wide(&text, u16::to_le_bytes, true)).expect("written");
    assert_eq!(
        place.run(&["check", "a.ron", "--json"]).done().json(),
        known
    );
}

/// The parts of a line that stand in it more than once.
fn twice(line: &str) -> Vec<&str> {
    let parts: Vec<&str> = line.split([':', ';', ',']).map(str::trim).collect();
    let again = |part: &&str| {
        let count = parts.iter().filter(|other| *other == part).count();
        part.chars().count() > 8 && count > 1
    };
    parts.iter().copied().filter(again).collect()
}

#[test]
fn a_cause_is_said_once_by_every_command() {
    assert_eq!(
        twice("a.mhd: no such file: check it: no such file").len(),
        2
    );
    let place = Place::of("10");
    std::fs::write(place.path("broken.png"), b"\x89PNG\r\n\x1a\nbroken").expect("written");
    std::fs::write(place.path("broken.exr"), b"\x76\x2f\x31\x01broken").expect("written");
    std::fs::write(place.path("broken.ron"), b"(pickglass: 1, design: (").expect("written");
    std::fs::create_dir(place.path("folder.wif")).expect("made");
    for arguments in [
        &["check", "absent.wif"][..],
        &["check", "folder.wif"],
        &["check", "broken.png"],
        &["check", "broken.ron"],
        &["check", "oxford", "--warp-map", "absent.png"],
        &["check", "oxford", "--warp-map", "broken.png"],
        &["convert", "oxford", "folder.wif"],
        &["convert", "oxford", "absent/a.wif"],
        &["convert", "oxford", "/proc/a.wif"],
        &["convert", "oxford", "a.jc5", "--like", "absent.jc5"],
        &["convert", "oxford", "a.jc5", "--loom", "absent.ron"],
        &["posterize", "absent.png", "-o", "a.ron"],
        &["posterize", "broken.png", "-o", "a.ron"],
        &["posterize", "folder.wif", "-o", "a.ron"],
        &["still", "absent.vol", "-o", "a.png"],
        &["still", "absent.nrrd", "-o", "a.png"],
        &["still", "absent.mhd", "-o", "a.png"],
        &["still", "pattern.mhd", "-o", "a.png"],
        &["still", "zero-box.vol", "-o", "a.png"],
        &["still", "oxford", "-o", "a.png", "--light", "absent.exr"],
        &["still", "oxford", "-o", "a.png", "--light", "broken.exr"],
        &["volume", "oxford", "-o", "absent/a.vol"],
        &["synthesize", "absent.ron"],
    ] {
        let line = place.run(arguments).refused();
        assert_eq!(twice(&line), [""; 0], "{line}");
    }
}
