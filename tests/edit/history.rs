//! A thousand strokes on the largest design: undone and redone exactly, in little memory.
//!
//! In a process of its own, since peak memory is the process's.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::time::Instant;

use crate::memory;
use pickglass::design::{
    Design, Family, Fill, Grid, Region, Regions, Srgb, Structure, Yarn, YarnId, YarnMaps,
    usual_sett,
};
use pickglass::edit::recovery::{Recovery, Saved};
use pickglass::edit::{Document, Edit, HISTORY_BYTES, Surface, shapes};
use pickglass::formats::{self, LoadOptions, SaveOptions};
use pickglass::hash::mix;

const ENDS: u32 = 5120;
const PICKS: u32 = 6300;
/// Some lie where they change nothing, and are no entries.
const STROKES: usize = 1200;

/// Two weaves in diamonds, and stripes of two yarns.
fn design() -> Design {
    let map = Grid::from_fn(ENDS, PICKS, |end, pick| {
        u16::from((end / 50 + pick / 70) % 2 == 0)
    });
    let region = |name: &str, notation| Region::new(name, Fill::by_notation(notation).unwrap());
    let palette = vec![
        region("ground", "1/7 satin move 3"),
        region("figure", "7/1 satin move 3"),
    ];
    let regions = Regions::new(map.unwrap(), palette, None).unwrap();
    let yarns = vec![
        Yarn::new("navy", Family::Silk, Srgb(20, 30, 90)),
        Yarn::new("cream", Family::Silk, Srgb(240, 240, 235)),
    ];
    let order = (0..ENDS).map(|end| YarnId((end / 40 % 2) as u16)).collect();
    let maps = YarnMaps::orders(order, vec![YarnId(1)]);
    let sett = usual_sett(&yarns, &maps);
    Design::new("panel", Structure::Regions(regions), yarns, maps, sett).unwrap()
}

/// A number for the drawdown, the corrections and a part of the regions.
fn fingerprint(document: &Document) -> u64 {
    let mut hash = 0u64;
    let mut add = |bits: u64| {
        hash = (hash ^ bits)
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .rotate_left(23);
    };
    let Structure::Regions(regions) = document.design().structure() else {
        return 0;
    };
    for pick in 0..PICKS {
        document.drawdown().pick_words(pick).for_each(&mut add);
        if let Some(corrections) = regions.corrections() {
            corrections.mask().pick_words(pick).for_each(&mut add);
            corrections.value().pick_words(pick).for_each(&mut add);
        }
        // The regions of one pick in seventeen, so that the test stays quick.
        if pick % 17 == 0 {
            for word in 0..ENDS / 64 {
                let values = regions.map().pick_values(word, pick).iter();
                add(values.fold(0, |bits, &region| bits << 1 | u64::from(region)));
            }
        }
    }
    mix(hash)
}

/// A pencil stroke of some forty crossings somewhere.
fn stroke(document: &Document, number: usize) -> Edit {
    let dice = |salt: u64, sides: u32| (mix(number as u64 * 7 + salt) % u64::from(sides)) as i64;
    let surface = Surface::of(document.design());
    let from = (dice(1, ENDS), dice(2, PICKS));
    let to = (from.0 + dice(3, 60) - 30, from.1 + dice(4, 60) - 30);
    let cells = surface.cells(shapes::stroke(&surface, &[from, to]));
    match number % 3 {
        0 => Edit::PaintRegion {
            cells,
            region: (number / 3 % 2) as u16,
        },
        1 => Edit::Paint {
            cells,
            warp_up: number.is_multiple_of(2),
        },
        _ => Edit::Flip(cells),
    }
}

/// Saves the design as the window does, keeps it in a recovery copy too, and prints how
/// long each took; what is read back is what was saved.
fn save_and_read(document: &Document) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("panel.ron");
    let design = document.design();
    let clock = Instant::now();
    formats::save(design, &path, &SaveOptions::default()).unwrap();
    let saved = clock.elapsed().as_secs_f64();
    let bytes = std::fs::metadata(&path).unwrap().len();
    let clock = Instant::now();
    let read = formats::load(&path, &LoadOptions::default()).unwrap();
    println!(
        "saved in {saved:.3} s ({bytes} bytes), read in {:.3} s",
        clock.elapsed().as_secs_f64()
    );
    assert!(read.design == **design);
    let mut recovery = Recovery::begin(folder.path()).unwrap();
    let clock = Instant::now();
    let kept = recovery.save(design, Some(&path)).unwrap();
    println!("kept in {:.3} s", clock.elapsed().as_secs_f64());
    assert!(matches!(kept, Saved::Whole { .. }));
}

#[test]
fn a_thousand_strokes_are_undone_and_redone() {
    let test = concat!(module_path!(), "::a_thousand_strokes_are_undone_and_redone");
    if memory::alone(test, &[""]).is_none() {
        return;
    }
    let mut document = Document::new(design());
    let before = memory::reset_peak();
    let mut prints = vec![fingerprint(&document)];
    let (mut longest, mut total) = (0.0f64, 0.0);
    for number in 0..STROKES {
        let edit = stroke(&document, number);
        let clock = Instant::now();
        document.begin("pencil");
        document.apply(edit).unwrap();
        document.finish();
        let seconds = clock.elapsed().as_secs_f64();
        longest = longest.max(seconds);
        total += seconds;
        if document.entries().len() > prints.len() {
            prints.push(fingerprint(&document));
        }
    }
    let counted = document.history_bytes();
    println!(
        "{} entries, {counted} bytes counted; a stroke took {:.3} ms, the longest {:.3} ms",
        document.entries().len(),
        1e3 * total / STROKES as f64,
        1e3 * longest
    );
    assert!(
        document.entries().len() > 1000,
        "too many that changed nothing"
    );
    assert_eq!(document.entries()[0].name(), "opened");
    assert!(counted <= HISTORY_BYTES);
    for print in prints.iter().rev().skip(1) {
        document.undo().unwrap();
        assert_eq!(fingerprint(&document), *print);
    }
    assert!(document.undo().is_none() && !document.is_modified());
    for print in &prints[1..] {
        document.redo().unwrap();
        assert_eq!(fingerprint(&document), *print);
    }
    assert!(document.redo().is_none());
    let peak = memory::peak();
    save_and_read(&document);
    // Different states have different fingerprints: the comparison can fail.
    let different: std::collections::BTreeSet<u64> = prints.iter().copied().collect();
    assert!(different.len() > prints.len() * 9 / 10);
    let (Some(before), Some(peak)) = (before, peak) else {
        println!("not measured: this system does not say how much memory is in use");
        return;
    };
    let grown = peak.saturating_sub(before);
    println!("{grown} bytes more in memory");
    assert!(grown <= HISTORY_BYTES as u64, "{grown}");
    // What is counted is what is used, within the allocator's own needs.
    assert!(
        grown < 2 * counted as u64 + (16 << 20),
        "{grown} against {counted}"
    );
    assert!(
        (counted as u64) < 2 * grown + (16 << 20),
        "{grown} against {counted}"
    );
}
