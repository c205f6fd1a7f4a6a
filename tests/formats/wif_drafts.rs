//! Real drafts of many programs: each is read, warned about or refused as its folder says.
//!
//! The drafts are not part of the project. They are looked for in `PICKGLASS_DRAFTS`, else
//! beside the project; where they are absent these tests say so and pass, unless
//! `GOLDEN_REQUIRED=1` demands them.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::{Path, PathBuf};

use crate::collection::folder;
use pickglass::design::{FloatLengths, longest_float};
use pickglass::formats::{Imported, wif};

/// The folder of drafts, or `None` after saying what is missing.
fn drafts() -> Option<PathBuf> {
    folder("PICKGLASS_DRAFTS", "../shared/drafts")
}

fn wifs(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|ending| ending == "wif") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn read(path: &Path) -> Result<Imported, wif::WifError> {
    let bytes = std::fs::read(path).unwrap();
    wif::read(&bytes, &path.file_name().unwrap().to_string_lossy())
}

const PASTED: &str = "many color liftplan and zeros.wpo.wif";

#[test]
fn every_draft_is_read_warned_about_or_refused_as_its_folder_says() {
    let Some(folder) = drafts() else { return };
    let (mut good, mut bad, mut warned) = (0, 0, 0);
    for path in wifs(&folder) {
        let shown = path.display();
        let bad_wif = path.to_string_lossy().contains("bad_wif");
        let stood_in = bad_wif && shown.to_string().contains("color");
        let refused = (bad_wif && !stood_in) || path.ends_with(PASTED);
        match read(&path) {
            Ok(_) if refused => panic!("{shown} must be refused"),
            Err(error) if !refused => panic!("{shown}: {error}"),
            Ok(imported) => {
                good += 1;
                println!("{shown}: {:#?}", imported.warnings);
                let stand_ins = imported.warnings.iter();
                let told = stand_ins
                    .filter(|line| line.contains("taken instead"))
                    .count();
                assert_eq!(told, usize::from(stood_in), "{shown}");
                if path.to_string_lossy().contains("warn_wif") {
                    warned += 1;
                    let about = |line: &String| line.contains("default colour");
                    assert!(imported.warnings.iter().any(about), "{shown}");
                }
            }
            Err(error) => {
                bad += 1;
                let message = error.to_string();
                println!("{message}");
                assert_eq!(message.lines().count(), 1);
                assert!(message.contains("expected") && message.contains("; "));
                assert!(message.starts_with(&*path.file_name().unwrap().to_string_lossy()));
            }
        }
    }
    assert!(
        good >= 35 && bad >= 5 && warned == 4,
        "{good} {bad} {warned}"
    );
}

#[test]
fn refusals_name_the_line() {
    let Some(folder) = drafts() else { return };
    let bad = folder.join("dtx_to_wif/bad_wif");
    let line = |name: &str| read(&bad.join(name)).unwrap_err().line;
    assert!(line("too many treadles in treadline.wif").is_some());
}

#[test]
fn floats_are_those_counted_independently() {
    let Some(folder) = drafts() else { return };
    let expected = |weft_face, weft_back, warp_face, warp_back| FloatLengths {
        warp_face,
        warp_back,
        weft_face,
        weft_back,
    };
    for (name, lengths) in [
        ("thunderloom/8452.wif", expected(12, 7, 8, 10)),
        ("pyweaving2/schort.wif", expected(2, 2, 5, 5)),
        ("warptracker/Overshot_Honeysuckle.wif", expected(2, 7, 3, 3)),
        (
            "warptracker/Overshot_Honeysuckle-LP.wif",
            expected(2, 7, 3, 3),
        ),
    ] {
        let design = read(&folder.join(name)).unwrap().design;
        assert_eq!(longest_float(&design.weave()), lengths, "{name}");
        // Turned over, face and back change places.
        let back = longest_float(&design.weave().inverted());
        let turned = expected(
            lengths.weft_back,
            lengths.weft_face,
            lengths.warp_back,
            lengths.warp_face,
        );
        assert_eq!(back, turned, "{name}");
    }
}

#[test]
fn two_ways_of_writing_one_cloth_weave_the_same() {
    let Some(folder) = drafts() else { return };
    let weave = |name: &str| read(&folder.join(name)).unwrap().design.weave();
    let byte = "dtx_to_wif/desired_basic_wif/multi-byte";
    for (one, other) in [
        (
            "warptracker/Overshot_Honeysuckle.wif".to_owned(),
            "warptracker/Overshot_Honeysuckle-LP.wif".to_owned(),
        ),
        (
            format!("{byte} liftplan.wif"),
            format!("{byte} single treadled.wif"),
        ),
    ] {
        assert_eq!(weave(&one), weave(&other));
        let mut changed = weave(&one);
        changed.set(3, 5, !changed.get(3, 5));
        assert_ne!(changed, weave(&other));
    }
    assert_ne!(
        weave("warptracker/Overshot_Honeysuckle.wif"),
        weave("thunderloom/8452.wif")
    );
}

/// Colour of every end and pick.
fn colours(imported: &Imported) -> (Vec<String>, Vec<String>) {
    let design = &imported.design;
    let maps = design.maps();
    let colour = |id| design.yarn(id).colour.to_string();
    (
        (0..i64::from(design.ends()))
            .map(|end| colour(maps.warp(end, 0)))
            .collect(),
        (0..i64::from(design.picks()))
            .map(|pick| colour(maps.weft(0, pick)))
            .collect(),
    )
}

#[test]
fn a_draft_survives_design_and_back() {
    let Some(folder) = drafts() else { return };
    for path in wifs(&folder) {
        let Ok(first) = read(&path) else { continue };
        let written = wif::write(&first.design).unwrap();
        let second = wif::read(written.text.as_bytes(), "again.wif")
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let (before, after) = (&first.design, &second.design);
        assert_eq!(before.weave(), after.weave(), "{}", path.display());
        assert_eq!(before.structure(), after.structure(), "{}", path.display());
        assert_eq!(colours(&first), colours(&second));
        assert_eq!(before.sett(), after.sett(), "{}", path.display());
        assert_eq!(before.origin.sections, after.origin.sections);
        assert_eq!(before.origin.ends, after.origin.ends);
        assert_eq!(before.origin.picks, after.origin.picks);
        assert_eq!(before.notes, after.notes);
        // Stand-ins are written as colours of the table, where they had none.
        let stands_in = |line: &String| line.contains("taken instead");
        if !first.warnings.iter().any(stands_in) {
            assert_eq!(before.origin.palette, after.origin.palette);
            assert_eq!(before.yarns().len(), after.yarns().len());
        }
        // And the text itself does not change any more.
        assert_eq!(wif::write(after).unwrap().text, written.text);
    }
}

#[test]
fn private_sections_come_back_word_for_word() {
    let Some(folder) = drafts() else { return };
    let name = "dtx_to_wif/basic_wif/treadles with defaults and private sections.wif";
    let design = read(&folder.join(name)).unwrap().design;
    let text = wif::write(&design).unwrap().text;
    for line in [
        "[PRIVATE SOMETHING]",
        "empty_something_else1=",
        "190=value of key 190",
    ] {
        assert!(text.contains(line), "{line}");
    }
    assert_eq!(design.origin.sections.len(), 3);
    assert_eq!(design.notes.lines().count(), 3);
    let honeysuckle = read(&folder.join("warptracker/Overshot_Honeysuckle.wif")).unwrap();
    let text = wif::write(&honeysuckle.design).unwrap().text;
    assert!(text.contains("[TW PROJECT]\nShowGridOverlay=true\n"));
}
