//! Files made to take memory or time: neither may grow far beyond file and design.
//!
//! One test in a process of its own, since peak memory is the process's.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::fmt::Write;
use std::time::{Duration, Instant};

use crate::floods::read_flood;
use crate::memory::alone;
use pickglass::formats::{LoadOptions, load_bytes};

const HEAD: &str = "[WEAVING]\nShafts=4\nTreadles=4\n[WARP]\nThreads=4\n[WEFT]\nThreads=4\n";
const DRAFT: &str = "[THREADING]\n1=1\n2=2\n[LIFTPLAN]\n1=1\n2=2\n";

/// A draft with `lines` in the middle.
fn with(lines: &str) -> String {
    format!("{HEAD}{lines}{DRAFT}")
}

fn many(line: &str) -> String {
    line.repeat(6_000_000 / line.len())
}

fn all_threads() -> String {
    let mut text = format!("{HEAD}[THREADING]\n");
    for thread in 0..100_000 {
        let _ = writeln!(text, "{thread}=1");
    }
    text + DRAFT
}

fn long_lists() -> String {
    let mut text = HEAD.replacen("Threads=4", "Threads=2684", 1);
    text = text.replace("Threads=4\n", "Threads=100000\n") + "[THREADING]\n1=1\n[LIFTPLAN]\n";
    for thread in 0..100_000 {
        let _ = writeln!(text, "{thread}=1,2,3,4,5,6,7,8,9,1,2,3,4,5,6,7,8,9,1,2,3,4");
    }
    text
}

/// A file of a few megabytes of one thing, made when asked for.
type Flood = (&'static str, fn() -> String);

const FLOODS: [Flood; 13] = [
    ("the same thread", || {
        with(&format!("[THREADING]\n{}", many("1=1\n")))
    }),
    ("one long list", || {
        with(&format!("[LIFTPLAN]\n1={}\n", many("1,")))
    }),
    ("all threads", all_threads),
    ("long lists", long_lists),
    ("blank lines", || with(&format!("[X]\n{}", many("\n")))),
    ("private lines", || with(&format!("[X]\n{}", many("a\n")))),
    ("notes", || with(&format!("[NOTES]\n{}", many("7=a\n")))),
    ("colours", || {
        with(&format!("[COLOR TABLE]\n{}", many("1=1,1,1\n")))
    }),
    ("lines without =", || {
        with(&format!("[WARP]\n{}", many("x\n")))
    }),
    ("latin-1", || with(&format!("[X]\n{}", many("\u{e9}")))),
    ("ron lists", || {
        format!("(pickglass: 1, design: (yarns: [{}", many("1,"))
    }),
    ("ron notes", || {
        format!("(pickglass: 1, design: (notes: \"{}", many("\\n"))
    }),
    ("ron sections", || {
        format!(
            "(pickglass: 1, design: (origin: Some((sections: [{}",
            many("(name:\"\",text:\"\"),")
        )
    }),
];

#[test]
fn floods_take_neither_memory_nor_time() {
    // A process for each, so that none profits from memory another has left behind.
    let names = FLOODS.map(|flood| flood.0);
    let test = concat!(module_path!(), "::floods_take_neither_memory_nor_time");
    if let Some(name) = alone(test, &names) {
        let (name, make) = FLOODS.iter().find(|flood| flood.0 == name).unwrap();
        let mut bytes = make().into_bytes();
        if *name == "latin-1" {
            bytes.retain(|&byte| byte != 0xc3);
        }
        read_flood(name, &bytes);
    }
}

#[test]
fn treadles_tied_to_every_shaft_do_not_hang_the_drawdown() {
    let mut text = String::from("[WEAVING]\nShafts=65000\nTreadles=40\n");
    text.push_str("[WARP]\nThreads=2600\n[WEFT]\nThreads=100000\n[THREADING]\n");
    for end in 1..=2600 {
        let _ = writeln!(text, "{end}={}", end * 24);
    }
    text.push_str("[TIEUP]\n");
    for treadle in 1..=40 {
        let shafts: Vec<String> = (1..=65_000)
            .filter(|shaft| (shaft / treadle) % 2 == 0)
            .map(|shaft: u32| shaft.to_string())
            .collect();
        let _ = writeln!(text, "{treadle}={}", shafts.join(","));
    }
    text.push_str("[TREADLING]\n");
    for pick in 1..=100_000u32 {
        // Another set of treadles for each pick.
        let set = (1..=17).filter(|bit| pick >> (bit - 1) & 1 == 1);
        let set: Vec<String> = set.map(|bit| (bit + 20).to_string()).collect();
        let _ = writeln!(text, "{pick}={}", set.join(","));
    }
    let started = Instant::now();
    let imported = load_bytes(text.as_bytes(), "knot", &LoadOptions::default()).unwrap();
    let weave = imported.design.weave();
    assert_eq!((weave.ends(), weave.picks()), (2600, 100_000));
    assert!(
        started.elapsed() < Duration::from_secs(20),
        "{:?}",
        started.elapsed()
    );
}
