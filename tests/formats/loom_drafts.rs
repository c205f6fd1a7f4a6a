//! Real drafts of Fiberworks and WeavePoint against their twins in WIF.
//!
//! The drafts are not part of the project. They are looked for in `PICKGLASS_DRAFTS`, else
//! beside the project; where they are absent these tests say so and pass, unless
//! `GOLDEN_REQUIRED=1` demands them.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::{Path, PathBuf};

use crate::collection::folder;
use pickglass::design::{Design, Srgb, WeavePattern};
use pickglass::formats::{Imported, LoadOptions, Place, load, wif};

/// The folder of drafts, or `None` after saying what is missing.
fn drafts() -> Option<PathBuf> {
    folder("PICKGLASS_DRAFTS", "../shared/drafts").map(|folder| folder.join("dtx_to_wif"))
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|found| found == ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    assert!(!found.is_empty());
    found
}

fn read(path: &Path) -> Imported {
    load(path, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Colours of the first ends and picks.
fn colours(design: &Design, ends: u32, picks: u32) -> (Vec<Srgb>, Vec<Srgb>) {
    let maps = design.maps();
    (
        (0..i64::from(ends))
            .map(|end| design.yarn(maps.warp(end, 0)).colour)
            .collect(),
        (0..i64::from(picks))
            .map(|pick| design.yarn(maps.weft(0, pick)).colour)
            .collect(),
    )
}

/// The corner of a drawdown, and whether everything outside it is weft up: idle.
fn corner(weave: &WeavePattern, ends: u32, picks: u32) -> (WeavePattern, bool) {
    let part = WeavePattern::from_fn(ends, picks, |end, pick| weave.get(end, pick));
    let idle = part.count_warp_up() == weave.count_warp_up();
    (part, idle)
}

/// Whether a design is its twin, as far as the twin's threads do anything.
fn same_cloth(ours: &Design, twin: &Design) -> bool {
    let (ends, picks) = (ours.ends(), ours.picks());
    if ends > twin.ends() || picks > twin.picks() {
        return false;
    }
    let (part, idle) = corner(&twin.weave(), ends, picks);
    let same_colours = colours(ours, ends, picks) == colours(twin, ends, picks);
    idle && part == ours.weave() && same_colours
}

/// The draft's twin: beside it, or in the folder of what it should become.
fn twin(path: &Path) -> Option<PathBuf> {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    let beside = path.with_file_name(format!("{name}.wif"));
    let desired = path
        .ancestors()
        .find(|folder| folder.ends_with("dtx_to_wif"))
        .unwrap()
        .join("desired_basic_wif")
        .join(name)
        .with_extension("wif");
    // One file beside is no WIF: notes are pasted into it.
    [beside, desired]
        .into_iter()
        .find(|path| path.exists() && wif::read(&std::fs::read(path).unwrap(), "x").is_ok())
}

/// The same design with one crossing, or one colour, changed.
fn changed(design: &Design, colour: bool) -> Design {
    if colour {
        let mut yarns = design.yarns().to_vec();
        let used = design.maps().warp(0, 0);
        yarns[usize::from(used.0)].colour = Srgb(1, 2, 3);
        return design
            .clone()
            .with_yarns(yarns, design.maps().clone())
            .unwrap();
    }
    let mut weave = design.weave();
    weave.set(0, 0, !weave.get(0, 0));
    let structure = pickglass::design::Structure::Pattern(weave);
    design.clone().with_structure(structure).unwrap()
}

#[test]
fn every_draft_is_its_twin() {
    let Some(folder) = drafts() else { return };
    let mut compared = 0;
    for ending in ["basic_dtx/dtx", "basic_wpo/wpo"] {
        let (sub, ending) = ending.split_once('/').unwrap();
        for path in files(&folder.join(sub), ending) {
            let shown = path.display();
            let ours = read(&path);
            println!("{shown}: {:#?}", ours.warnings);
            let twin = read(&twin(&path).unwrap()).design;
            assert!(same_cloth(&ours.design, &twin), "{shown}");
            if ending == "dtx" {
                // These say how many threads they have; sheets of WeavePoint do not.
                let size = |design: &Design| (design.ends(), design.picks());
                assert_eq!(size(&ours.design), size(&twin), "{shown}");
                assert_eq!(ours.design.sett(), twin.sett(), "{shown}");
            }
            for colour in [false, true] {
                let other = changed(&ours.design, colour);
                assert!(!same_cloth(&other, &twin), "{shown}");
            }
            compared += 1;
        }
    }
    assert_eq!(compared, 6 + 9);
}

#[test]
fn the_sett_of_weavepoint_is_that_of_its_twin() {
    let Some(folder) = drafts() else { return };
    let path = folder.join("basic_wpo/level2/two color liftplan.wpo");
    let (ours, twin) = (read(&path), read(&twin(&path).unwrap()));
    assert_eq!(ours.design.sett(), twin.design.sett());
    assert!((ours.design.sett().end_pitch_mm() - 25.4 / 5.0).abs() < 1e-4);
}

#[test]
fn drafts_that_are_wrong_are_refused_with_the_line() {
    let Some(folder) = drafts() else { return };
    let bad = files(&folder.join("bad_dtx"), "dtx");
    assert_eq!(bad.len(), 10);
    for path in bad {
        let shown = path.file_name().unwrap().to_string_lossy().into_owned();
        // A colour that is not there costs a colour, not the draft.
        if shown.contains("color") {
            let read = load(&path, &LoadOptions::default()).unwrap();
            assert!(
                read.warnings
                    .iter()
                    .any(|line| line.contains("colour number"))
            );
            continue;
        }
        let message = load(&path, &LoadOptions::default())
            .unwrap_err()
            .to_string();
        println!("{message}");
        assert_eq!(message.lines().count(), 1);
        assert!(message.contains(&shown) && message.contains("expected") && message.contains("; "));
        let line = message.contains(", line ");
        assert_eq!(line, !shown.starts_with("missing liftplan"), "{message}");
    }
    assert_eq!(Place::Line(3).to_string(), "line 3");
}

#[test]
fn drafts_go_on_to_wif_and_back() {
    let Some(folder) = drafts() else { return };
    for (sub, ending) in [("basic_dtx", "dtx"), ("basic_wpo", "wpo")] {
        for path in files(&folder.join(sub), ending) {
            let design = read(&path).design;
            let text = wif::write(&design).unwrap().text;
            let again = wif::read(text.as_bytes(), "again").unwrap().design;
            assert!(same_cloth(&again, &design), "{}", path.display());
            assert_eq!(again.structure(), design.structure());
            assert_eq!(again.sett(), design.sett());
        }
    }
}
