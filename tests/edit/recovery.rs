//! The program is killed while it writes recovery copies: what it said was written is there.
//!
//! The writer is this test in a process of its own. It counts on a weave, a bit at a time,
//! and says each number once it is on the disk.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use pickglass::design::{
    Design, Family, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps, usual_sett,
};
use pickglass::edit::recovery::{self, Recovery};
use pickglass::edit::{Cells, Document, Edit, Rect};

/// Names the folder to the process that writes.
const FOLDER: &str = "PICKGLASS_TEST_RECOVERY";
const TEST: &str = "recovery::a_killed_writer_loses_nothing_that_was_written";
/// Several tiles, so that a copy is not written at once.
const ENDS: u32 = 700;
const PICKS: u32 = 500;
/// Ends that hold the number, on pick 0.
const BITS: u32 = 32;

/// A weave that no coding makes small; pick 0 begins with the bits of a number.
fn weave(number: u32) -> WeavePattern {
    WeavePattern::from_fn(ENDS, PICKS, |end, pick| match (end, pick) {
        (0..BITS, 0) => number >> end & 1 == 1,
        _ => {
            let mixed = (end ^ pick.rotate_left(16)).wrapping_mul(0x9e37_79b9);
            (mixed ^ mixed >> 15).wrapping_mul(0x85eb_ca6b) >> 31 == 1
        }
    })
}

/// The number of a step; from one step to the next a single bit changes.
fn gray(step: u32) -> u32 {
    step ^ step >> 1
}

/// The step at which this weave was written; all of it must be as it was then.
fn step_of(design: &Design) -> u32 {
    let found = design.weave();
    let number = (0..BITS).fold(0, |bits, end| bits | u32::from(found.get(end, 0)) << end);
    assert!(found == weave(number), "the weave is damaged");
    let step = (0..BITS).fold(0, |step, shift| step ^ number >> shift);
    assert_eq!(gray(step), number);
    step
}

fn write_for_ever(folder: &Path) {
    let yarns = vec![
        Yarn::new("navy", Family::Cotton, Srgb(38, 52, 94)),
        Yarn::new("cream", Family::Cotton, Srgb(236, 226, 203)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let sett = usual_sett(&yarns, &maps);
    let design = Design::new("count", Structure::Pattern(weave(0)), yarns, maps, sett).unwrap();
    let mut document = Document::new(design);
    let mut copy = Recovery::begin(folder).unwrap();
    for step in 0u32.. {
        if step > 0 {
            let bit = Rect {
                end: step.trailing_zeros(),
                pick: 0,
                ends: 1,
                picks: 1,
            };
            let cells = Cells::of_rect(ENDS, PICKS, bit);
            document.apply(Edit::Flip(cells)).unwrap();
        }
        copy.save(&Arc::clone(document.design()), None).unwrap();
        eprintln!("written {step}");
    }
}

#[test]
fn a_killed_writer_loses_nothing_that_was_written() {
    if let Some(folder) = std::env::var_os(FOLDER) {
        return write_for_ever(Path::new(&folder));
    }
    for (run, target) in [0, 1, 2, 5, 20, 60, 150].into_iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", TEST, "--nocapture"])
            .env(FOLDER, folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(writer.stderr.take().unwrap()).lines();
        let mut steps = lines
            .map_while(Result::ok)
            .filter_map(|line| line.strip_prefix("written ")?.parse::<u32>().ok());
        let mut next = || steps.next();
        let mut said = next().unwrap();
        while said < target {
            said = next().unwrap();
        }
        // At another moment of a write each time.
        std::thread::sleep(Duration::from_micros(700 * run as u64));
        writer.kill().unwrap();
        writer.wait().unwrap();
        // What it said before it ended.
        while let Some(step) = next() {
            said = step;
        }

        let listing = recovery::list(folder.path());
        assert!(listing.damaged.is_empty(), "{:?}", listing.damaged);
        let [found] = listing.found.as_slice() else {
            panic!("{listing:?}")
        };
        let step = step_of(&recovery::load(&found.path).unwrap().design);
        assert!(
            (said..=said + 1).contains(&step),
            "{said} was written, {step} is there"
        );
        // The last byte of a copy counts: without it, it is an earlier one or none.
        let whole = std::fs::read(&found.path).unwrap();
        let past = whole.len() - 1;
        std::fs::write(&found.path, &whole[..past]).unwrap();
        if let Ok(earlier) = recovery::load(&found.path)
            && earlier.lost.is_some()
        {
            assert!(step_of(&earlier.design) <= step);
        }
    }
}
