//! Reading and writing images of the largest real loom file's size, 5120 × 6300.
//!
//! `cargo bench --bench formats` prints; nothing is asserted. Goal: each image read into a
//! design within a second. Seconds are those of the processor, so that a busy machine does
//! not count; where the system does not tell them, those of the clock.

use std::time::Instant;

use pickglass::design::{
    Design, Family, Fill, Grid, Region, Regions, Sett, Srgb, Structure, WeavePattern, Yarn, YarnId,
    YarnMaps, satin,
};
use pickglass::formats::image::ImageContent;
use pickglass::formats::{LoadOptions, SaveOptions, load_bytes, save_bytes};

const ENDS: u32 = 5120;
const PICKS: u32 = 6300;

/// Processor seconds of this process so far.
fn seconds(started: Instant) -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = stat
        .rsplit(')')
        .next()
        .unwrap_or("")
        .split_whitespace()
        .collect();
    match (fields.get(11), fields.get(12)) {
        (Some(user), Some(system)) => {
            let ticks = |field: &str| field.parse::<f64>().unwrap_or(0.0);
            (ticks(user) + ticks(system)) / 100.0
        }
        _ => started.elapsed().as_secs_f64(),
    }
}

fn design(structure: Structure) -> Design {
    let yarns = vec![
        Yarn::new("a", Family::Silk, Srgb(20, 30, 90)),
        Yarn::new("b", Family::Silk, Srgb(240, 240, 235)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    Design::new("bench", structure, yarns, maps, Sett::per_cm(100.0, 60.0)).expect("a design")
}

/// Medallions on a ground, in `count` regions.
fn medallion(end: u32, pick: u32, count: u32) -> u32 {
    let (x, y) = ((end % 640) as i32 - 320, (pick % 900) as i32 - 450);
    ((x * x + y * y) as u32 / 9000) % count
}

fn main() {
    let started = Instant::now();
    let weaves = [satin(8, 3), satin(5, 2)].map(|weave| weave.expect("a satin"));
    let pattern = WeavePattern::from_fn(ENDS, PICKS, |end, pick| {
        let weave = &weaves[medallion(end, pick, 2) as usize];
        weave.get_wrapped(i64::from(end), i64::from(pick))
    });
    let map = Grid::from_fn(ENDS, PICKS, |end, pick| medallion(end, pick, 12) as u16);
    let palette = (0..12u8).map(|k| Region {
        locked: false,
        yarns: None,
        name: format!("{k}"),
        colour: Some(Srgb(20 * k, 255 - 20 * k, 100)),
        fill: Fill::by_notation("1/7 satin").expect("a satin"),
        origin: (0, 0),
    });
    let regions = Regions::new(map.expect("a size"), palette.collect(), None).expect("regions");
    let designs = [
        (
            "weave",
            ImageContent::Weave,
            design(Structure::Pattern(pattern)),
        ),
        (
            "artwork",
            ImageContent::Artwork,
            design(Structure::Regions(regions)),
        ),
    ];
    println!("{ENDS} × {PICKS}, processor seconds");
    for (name, content, design) in &designs {
        for ending in ["png", "bmp", "tif", "gif"] {
            let how = SaveOptions {
                content: *content,
                ..SaveOptions::default()
            };
            let before = seconds(started);
            let saved = save_bytes(design, ending, &how)
                .expect("a format")
                .expect("an image");
            let written = seconds(started);
            let back = load_bytes(&saved.bytes, "bench", &LoadOptions::default());
            let read = seconds(started);
            let same = back.expect("a design").design.ends() == ENDS;
            println!(
                "{name:8} {ending}: write {:.2} s, read {:.2} s, {:.1} MB, {}",
                written - before,
                read - written,
                saved.bytes.len() as f64 / 1e6,
                if same { "whole" } else { "of another size" },
            );
        }
    }
}
