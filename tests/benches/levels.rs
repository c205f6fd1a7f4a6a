//! What coarser voxels cost and save: time to build the exemplars of each level, and mean
//! radiance and coverage of the cloth against level 0, six designs under four lights.
//! Printed and never asserted: `cargo bench --bench levels` (`-- NAME` for one design).

use std::sync::Arc;
use std::time::Instant;

use pickglass::exemplar::ExemplarStore;
use pickglass::formats::presets;
use pickglass::job::Job;
use pickglass::render::{Film, Pixel};
use pickglass::still::{self, LightChoice, StillRequest, Stop};

const DESIGNS: [&str; 6] = [
    "denim",
    "silk-satin",
    "tweed",
    "linen-plain",
    "oxford",
    "damask",
];
const LIGHTS: [&str; 4] = ["day", "studio", "sun", "raking-left"];
const SPP: u32 = 24;

/// Mean radiance (over pixels and channels) and mean coverage of a picture.
fn means(film: &Film) -> (f64, f64) {
    let count = film.pixels().len() as f64;
    let mean = |of: &dyn Fn(&Pixel) -> f64| film.pixels().iter().map(of).sum::<f64>() / count;
    (
        mean(&|pixel| f64::from(pixel.mean().element_sum()) / 3.0),
        mean(&|pixel| f64::from(pixel.alpha())),
    )
}

/// Seconds to build the exemplars, and the means under each light.
fn measured(name: &str, level: u32) -> (f64, Vec<(f64, f64)>) {
    let design = Arc::new(presets::design(name).expect("there").expect("sound"));
    let request = StillRequest {
        width: 64,
        height: 64,
        width_mm: Some(6.0),
        dials: vec![("level".to_owned(), level.to_string())],
        stop: Stop {
            spp: Some(SPP),
            ..Stop::default()
        },
        ..StillRequest::default()
    };
    let begun = Instant::now();
    let cloth = still::prepare(&design, &request, &ExemplarStore::none(), &Job::new());
    let cloth = cloth.expect("a cloth");
    let seconds = begun.elapsed().as_secs_f64();
    let under = |light: &&str| {
        let light = LightChoice::Preset((*light).to_owned());
        let request = StillRequest {
            light,
            ..request.clone()
        };
        let still = still::render(&cloth, &request, &Job::new(), &mut |_| {});
        means(&still.expect("a picture").film)
    };
    (seconds, LIGHTS.iter().map(under).collect())
}

fn main() {
    let chosen: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with('-'))
        .collect();
    println!("mean radiance against level 0 (and difference of coverage): {LIGHTS:?}");
    for name in DESIGNS {
        if !chosen.is_empty() && !chosen.iter().any(|word| word == name) {
            continue;
        }
        let (seconds, fine) = measured(name, 0);
        println!("{name:12} level 0  built in {seconds:5.2} s");
        for level in 1..=4 {
            let (seconds, coarse) = measured(name, level);
            let row: Vec<String> = (fine.iter().zip(&coarse))
                .map(|(f, c)| format!("{:+6.2} % ({:+.3})", 100.0 * (c.0 / f.0 - 1.0), c.1 - f.1))
                .collect();
            println!(
                "{name:12} level {level}  built in {seconds:5.2} s  {}",
                row.join("  ")
            );
        }
    }
}
