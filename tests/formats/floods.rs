//! What reading a file takes that was made to take memory or time: measured the same for every
//! format.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::time::{Duration, Instant};

use crate::memory::{alone, peak, reset_peak};
use pickglass::formats::{LoadOptions, load_bytes};

/// Reads one flood in this process and prints what it took; whether it is a design.
pub fn read_flood(name: &str, bytes: &[u8]) -> bool {
    let before = reset_peak();
    let started = Instant::now();
    let answer = load_bytes(bytes, "flood", &LoadOptions::default());
    let seconds = started.elapsed();
    assert!(seconds < Duration::from_secs(10), "{name}: {seconds:?}");
    let crossings = answer.as_ref().map_or(0, |imported| {
        let design = &imported.design;
        u64::from(design.ends()) * u64::from(design.picks())
    });
    let (Some(before), Some(after)) = (before, peak()) else {
        println!("not measured: this system does not tell peak memory");
        return answer.is_ok();
    };
    let taken = after.saturating_sub(before);
    let read = answer.is_ok();
    println!(
        "{name}: {} KiB file, {} KiB taken, {seconds:?}, {}",
        bytes.len() >> 10,
        taken >> 10,
        answer.map_or_else(|error| error.to_string(), |_| "read".to_owned())
    );
    // A few MiB are the allocator's and the program's own pages.
    let allowed = 4 * (bytes.len() as u64 + crossings / 8) + (4 << 20);
    assert!(taken <= allowed, "{name}: {taken} of {allowed} bytes");
    read
}

#[test]
fn the_measure_of_memory_can_fail() {
    let test = concat!(module_path!(), "::the_measure_of_memory_can_fail");
    if alone(test, &[""]).is_none() {
        return;
    }
    let Some(before) = reset_peak() else { return };
    let large = vec![1u8; 48_000_000];
    assert!(std::hint::black_box(&large).len() > 1);
    assert!(peak().unwrap() - before > 4 * 6_000_000 + (4 << 20));
}
