//! Pictures from files: what is odd about them is handled or said in one line.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;

use pickglass::formats::photo;

fn fixture(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fixtures")
        .join(name)
}

#[test]
fn four_inks_become_colours_and_are_remarked_on() {
    // Left no ink at all, right magenta and yellow in full: red.
    let photo = photo::load(&fixture("four_inks.jpg")).unwrap();
    assert_eq!((photo.source.width(), photo.source.height()), (16, 16));
    let [left, right] = [2, 13].map(|x| photo.source.pixels()[8 * 16 + x]);
    assert!(left.iter().all(|&code| code > 245), "{left:?}");
    assert!(
        right[0] > 200 && right[1] < 60 && right[2] < 60,
        "{right:?}"
    );
    assert_eq!(photo.warnings.len(), 1, "{:?}", photo.warnings);
    assert!(photo.warnings[0].contains("CMYK"));
}

#[test]
fn damaged_bytes_give_a_picture_or_one_line() {
    let whole = std::fs::read(fixture("four_inks.jpg")).unwrap();
    for cut in (0..whole.len()).step_by(7) {
        check(&whole[..cut]);
        let mut bent = whole.clone();
        bent[cut] ^= 0x5b;
        check(&bent);
    }
}

fn check(bytes: &[u8]) {
    match photo::read(bytes, "x") {
        Ok(photo) => assert!(photo.source.width() > 0),
        Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error}"),
    }
}

#[test]
fn missing_files_and_texts_are_said_with_a_remedy() {
    let missing = photo::load(Path::new("/no/such/picture.png")).unwrap_err();
    assert!(missing.to_string().contains("check the name"));
    let draft = photo::load(&fixture("plain_twill.wif")).unwrap_err();
    assert!(draft.to_string().contains("choose another file"));
}

/// Pictures of all kinds, sound and damaged, where the checkout has them beside it.
#[test]
fn every_picture_at_hand_is_read_or_refused_in_one_line() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/images");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("not run: {} is not there", folder.display());
        return;
    };
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        match photo::load(&path) {
            Ok(photo) => println!(
                "{}: {} × {} {:?}",
                path.display(),
                photo.source.width(),
                photo.source.height(),
                photo.warnings
            ),
            Err(error) => {
                println!("{error}");
                assert_eq!(error.to_string().lines().count(), 1);
            }
        }
    }
}
