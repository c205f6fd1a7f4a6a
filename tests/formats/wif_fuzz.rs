//! Damaged, cut and random files: an answer or an error, never a panic, never for long.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use pickglass::design::{Design, YarnMap};
use pickglass::formats::{FormatError, LoadOptions, load_bytes, ron, wif};
use pickglass::presets;
use pickglass::selftest::damaged;
use proptest::prelude::*;

fn fixtures() -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let mut found: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "wif"))
        .map(|path| (path.clone(), std::fs::read(path).unwrap()))
        .collect();
    found.sort();
    assert!(found.len() > 15);
    found
}

/// Reads bytes as whatever they are; a design must be whole, an error one line.
fn survives(bytes: &[u8]) -> bool {
    let started = Instant::now();
    let answer = load_bytes(bytes, "fuzz", &LoadOptions::default());
    assert!(started.elapsed() < Duration::from_secs(5));
    match answer {
        Ok(imported) => {
            whole(&imported.design);
            true
        }
        Err(error) => {
            let message = error.to_string();
            assert_eq!(message.lines().count(), 1, "{message:?}");
            assert!(message.starts_with("fuzz"), "{message:?}");
            false
        }
    }
}

fn whole(design: &Design) {
    assert!(design.ends() > 0 && design.picks() > 0 && !design.yarns().is_empty());
    assert_eq!(design.sett().fault(), None);
    for map in [&design.maps().warp, &design.maps().weft] {
        assert!(usize::from(map.largest().unwrap().0) < design.yarns().len());
        assert!(!matches!(map, YarnMap::Order(order) if order.is_empty()));
    }
    if u64::from(design.ends()) * u64::from(design.picks()) < 1 << 20 {
        let weave = design.weave();
        assert_eq!(
            (weave.ends(), weave.picks()),
            (design.ends(), design.picks())
        );
    }
}

#[test]
fn a_wif_cut_at_every_length_gives_an_answer() {
    for (path, bytes) in fixtures() {
        let read = (0..bytes.len())
            .filter(|&end| survives(&bytes[..end]))
            .count();
        // Most cuts lose the treadling; the whole file is read.
        assert!(read < bytes.len() / 2, "{}", path.display());
        assert!(survives(&bytes), "{}", path.display());
    }
}

#[test]
fn a_design_cut_at_every_length_is_refused() {
    for name in ["default", "twills-9"] {
        let design = presets::design(name).unwrap().unwrap();
        let text = ron::write(&design).unwrap();
        // The closing bracket is the last byte that matters.
        for end in 0..text.trim_end().len() {
            if text.is_char_boundary(end) {
                assert!(!survives(&text.as_bytes()[..end]), "{name} cut at {end}");
            }
        }
        assert!(survives(text.as_bytes()));
    }
}

/// What is put in at random places.
const PIECES: [&[u8]; 14] = [
    b"=",
    b"\n",
    b"[",
    b"]",
    b";",
    b",",
    b"0",
    b"-1",
    b"99999999999",
    b"NaN",
    b"\\\n",
    b"\xff",
    b"[WARP]\n",
    b"1e39",
];
#[test]
fn mutated_drafts_and_designs_give_an_answer() {
    let mut sources: Vec<Vec<u8>> = fixtures().into_iter().map(|(_, bytes)| bytes).collect();
    for name in presets::names() {
        let design = presets::design(name).unwrap().unwrap();
        sources.push(ron::write(&design).unwrap().into_bytes());
    }
    let mut read = 0;
    let rounds = 300;
    for (index, source) in sources.iter().enumerate() {
        for round in 0..rounds {
            let bytes = damaged(source, (index as u64) << 32 | round, &PIECES);
            read += usize::from(survives(&bytes));
        }
    }
    // Mutations neither all break a file nor all leave it whole.
    let all = sources.len() * rounds as usize;
    assert!(read > all / 10 && read < all * 9 / 10, "{read} of {all}");
}

#[test]
fn what_is_read_can_be_written_and_read_again() {
    for (index, (_, source)) in fixtures().iter().enumerate() {
        for round in 0..60 {
            let bytes = damaged(source, (index as u64) << 32 | round | 1 << 20, &PIECES);
            let Ok(first) = wif::read(&bytes, "x") else {
                continue;
            };
            if u64::from(first.design.ends()) * u64::from(first.design.picks()) > 1 << 20 {
                continue;
            }
            let text = wif::write(&first.design).unwrap().text;
            let second = wif::read(text.as_bytes(), "x").unwrap_or_else(|e| panic!("{e}\n{text}"));
            assert_eq!(first.design.weave(), second.design.weave());
            let text = ron::write(&first.design).unwrap();
            let third = ron::read(text.as_bytes(), "x").unwrap_or_else(|e| panic!("{e}\n{text}"));
            assert!(third == first.design, "{text}");
        }
    }
}

proptest! {
    #[test]
    fn random_bytes_give_an_answer(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        survives(&bytes);
        let _ = ron::read(&bytes, "fuzz").is_ok();
        let _ = wif::read(&bytes, "fuzz").is_ok();
        let mut headed = b"[WEAVING]\nShafts=4\n[THREADING]\n".to_vec();
        headed.extend_from_slice(&bytes);
        survives(&headed);
        let mut headed = b"(pickglass: 1, design: (".to_vec();
        headed.extend_from_slice(&bytes);
        prop_assert!(!survives(&headed));
    }

    #[test]
    fn random_lists_give_an_answer(text in "(\\[(WARP|WEFT|WEAVING|THREADING|TIEUP|LIFTPLAN|WARP COLORS|COLOR TABLE|WARP SPACING)\\]\n|[0-9]{1,6}=[0-9,.;]{0,12}\n|(Threads|Color|Spacing|Units|Shafts)=[0-9a-z]{0,6}\n){0,60}") {
        survives(text.as_bytes());
    }
}

#[test]
fn other_files_are_named() {
    let answer = load_bytes(b"PK\x03\x04", "x.wif", &LoadOptions::default());
    assert!(matches!(answer, Err(FormatError::Unknown { .. })));
}
