//! What coarser voxels cost and save, and what corrects their light.
//!
//! `cargo bench --bench levels` prints the time to build the exemplars of each level, and
//! mean radiance (with the standard error of the difference) and coverage of the cloth
//! against level 0, six designs under four lights, with the correction and without it
//! (`-- NAME` for some designs or lights alone, `--spp N` for less noise, `--corrected`
//! without the rows of averaging alone). `-- --fit DIR` measures the corrections, keeping
//! what is measured in a folder, and prints the table; `-- --fit DIR --write` puts it in
//! the place of `presets/levels.ron`; `--paths N` takes more of them for what is not kept
//! yet; with names of presets the table has those alone, and is not written. Nothing is
//! asserted.

#[path = "levels/fit.rs"]
mod fit;

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use pickglass::engine::{self, LightChoice, StillRequest, Stop};
use pickglass::exemplar::{COARSEST_LEVEL, ExemplarStore};
use pickglass::film::{Film, Pixel};
use pickglass::job::Job;
use pickglass::plan::Settings;
use pickglass::{atomic, presets};

const DESIGNS: [&str; 6] = [
    "denim",
    "silk-satin",
    "tweed",
    "linen-plain",
    "oxford",
    "damask",
];
const LIGHTS: [&str; 4] = ["day", "studio", "sun", "raking-left"];
/// Samples a pixel where none are asked for: differences are then known to 0.3 to 0.6 %.
const SPP: u32 = 128;

/// What a picture shows.
struct Shown {
    /// Mean radiance over pixels and channels.
    light: f64,
    /// Mean coverage.
    cover: f64,
    /// Standard error of the mean luminance, as a share of it.
    noise: f64,
}

impl Shown {
    fn of(film: &Film) -> Self {
        let sum = |of: &dyn Fn(&Pixel) -> f64| film.pixels().iter().map(of).sum::<f64>();
        let count = film.pixels().len() as f64;
        let noise = sum(&|pixel| pixel.variance());
        Self {
            light: sum(&|pixel| f64::from(pixel.mean().element_sum()) / 3.0) / count,
            cover: sum(&|pixel| f64::from(pixel.alpha())) / count,
            noise: noise.sqrt() / sum(&|pixel| pixel.luminance()),
        }
    }
}

/// A cloth at a level.
struct Measured {
    /// Seconds to make it.
    seconds: f64,
    /// Voxels of a block.
    block: [usize; 3],
    /// What is seen under each light.
    shown: Vec<Shown>,
}

/// Makes a design at a level and looks at it under each light.
fn measured(name: &str, level: u32, corrected: bool, lights: &[&str], spp: u32) -> Measured {
    let design = Arc::new(presets::design(name).expect("there").expect("sound"));
    let mut settings = Settings::default().at_level(level);
    settings.cloth.correct_levels = corrected;
    let request = StillRequest {
        width: 64,
        height: 64,
        width_mm: Some(6.0),
        settings,
        stop: Stop {
            spp: Some(spp),
            ..Stop::default()
        },
        ..StillRequest::default()
    };
    let begun = Instant::now();
    let cloth = engine::prepare(&design, &request, &ExemplarStore::none(), &Job::new());
    let cloth = cloth.expect("a cloth");
    let seconds = begun.elapsed().as_secs_f64();
    let under = |light: &&str| {
        let light = LightChoice::Preset((*light).to_owned());
        let request = StillRequest {
            light,
            ..request.clone()
        };
        let still = engine::render(&cloth, &request, &Job::new(), &mut |_| {});
        Shown::of(&still.expect("a picture").film)
    };
    Measured {
        seconds,
        block: cloth.cloth().sets()[0].grid.block,
        shown: lights.iter().map(under).collect(),
    }
}

/// Prints what the levels of the chosen designs do to light. Small blocks have no voxels
/// coarser than eight a side: there level 4 is level 3.
fn compare(chosen: &[String], spp: u32, corrected_alone: bool) {
    let is_chosen = |name: &&str| chosen.iter().any(|word| word == name);
    // What is not named at all is looked at as a whole.
    let of = |all: &[&'static str]| -> Vec<&'static str> {
        let some: Vec<_> = all.iter().copied().filter(is_chosen).collect();
        if some.is_empty() { all.to_vec() } else { some }
    };
    let (designs, lights) = (of(&DESIGNS), of(&LIGHTS));
    println!(
        "mean radiance against level 0 ± its standard error (and difference of coverage): \
         {lights:?}, {spp} spp"
    );
    let mut worst = [0.0f64; 2];
    for name in designs {
        let measured = |level, corrected| measured(name, level, corrected, &lights, spp);
        let fine = measured(0, false);
        println!("{name:12} level 0  built in {:5.2} s", fine.seconds);
        let mut last = fine.block;
        for level in 1..=COARSEST_LEVEL {
            let coarse = measured(level, true);
            if coarse.block == last {
                println!("{name:12} level {level} is level {}", level - 1);
                continue;
            }
            last = coarse.block;
            let mut both = vec![("corrected", coarse)];
            if !corrected_alone {
                both.insert(0, ("averaged", measured(level, false)));
            }
            for (way, coarse) in &both {
                let pairs = || fine.shown.iter().zip(&coarse.shown);
                let worst = &mut worst[usize::from(*way == "corrected")];
                for (f, c) in pairs() {
                    *worst = worst.max((c.light / f.light - 1.0).abs());
                }
                let row: Vec<String> = pairs()
                    .map(|(f, c)| {
                        format!(
                            "{:+6.2} ±{:.2} % ({:+.3})",
                            100.0 * (c.light / f.light - 1.0),
                            100.0 * c.noise.hypot(f.noise),
                            c.cover - f.cover
                        )
                    })
                    .collect();
                println!(
                    "{name:12} level {level} {way:9} built in {:5.2} s  {}",
                    coarse.seconds,
                    row.join("  ")
                );
            }
        }
    }
    let [before, after] = worst.map(|worst| 100.0 * worst);
    if !corrected_alone {
        println!("largest error of averaging: {before:.2} %");
    }
    println!("largest error: {after:.2} %");
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |name: &str| {
        let place = words.iter().position(|word| word == name)?;
        words.get(place + 1)?.parse().ok()
    };
    let fit = words.iter().position(|word| word == "--fit");
    if let Some(place) = fit {
        let kept = words
            .get(place + 1)
            .map_or("levels-measured", String::as_str);
        let mut names: Vec<&str> = (presets::names())
            .filter(|name| words.iter().any(|word| word == name))
            .collect();
        let all = names.is_empty();
        if all {
            names.extend(presets::names());
        }
        let paths = number("--paths").unwrap_or(fit::PATHS);
        let table = fit::table(&names, Path::new(kept), paths);
        if all && words.iter().any(|word| word == "--write") {
            let preset = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/levels.ron");
            atomic::write(&preset, table.as_bytes()).expect("the preset is written");
        } else {
            print!("{table}");
        }
    } else {
        let spp = number("--spp").unwrap_or(SPP);
        let alone = words.iter().any(|word| word == "--corrected");
        compare(&words, spp, alone);
    }
}
