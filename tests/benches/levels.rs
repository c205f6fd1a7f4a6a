//! What coarser voxels cost and save, and what corrects their light.
//!
//! `cargo bench --bench levels` prints the time to build the exemplars of each level, and
//! mean radiance and coverage of the cloth against level 0, six designs under four lights,
//! with the correction and without it (`-- NAME` for some designs alone). `-- --fit`
//! measures the corrections and prints the table; `-- --fit --write` puts it in the place
//! of `presets/levels.ron`. Nothing is asserted.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;
use pickglass::cloth::levels::fit::{self, Light};
use pickglass::cloth::levels::{LevelCorrection, TERMS};
use pickglass::cloth::{ClothSettings, ClothVolume, YarnClasses};
use pickglass::design::{Design, Family, Filled, Sett, Srgb, Structure, Yarn, YarnId, YarnMaps};
use pickglass::exemplar::ExemplarStore;
use pickglass::formats::{atomic, presets};
use pickglass::job::Job;
use pickglass::render::{Film, Pixel};
use pickglass::still::{self, LightChoice, StillRequest, Stop};
use pickglass::synthesis::Catalogue;

const DESIGNS: [&str; 6] = [
    "denim",
    "silk-satin",
    "tweed",
    "linen-plain",
    "oxford",
    "damask",
];
const LIGHTS: [&str; 4] = ["day", "studio", "sun", "raking-left"];
const SPP: u32 = 32;

/// Weaves that the corrections are measured on, from both sides.
const WEAVES: [&str; 4] = ["plain", "2/2 twill", "7/1 satin", "1/7 satin"];
/// Layers of cloth on each other in a measurement: alone, and opaque.
const LAYERS: [u32; 2] = [1, 2];
/// Paths and rays a measurement.
const PATHS: u32 = 1 << 13;
const RAYS: u32 = 1 << 15;
/// Exponents of the fill that are tried.
const GAMMAS: [f32; 2] = [0.8, 3.0];

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
fn measured(name: &str, level: u32, corrected: bool) -> (f64, Vec<(f64, f64)>) {
    let design = Arc::new(presets::design(name).expect("there").expect("sound"));
    let switch = if corrected { "on" } else { "off" };
    let request = StillRequest {
        width: 64,
        height: 64,
        width_mm: Some(6.0),
        dials: vec![
            ("level".to_owned(), level.to_string()),
            ("level-correction".to_owned(), switch.to_owned()),
        ],
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

/// Prints what the levels of the chosen designs do to light.
fn compare(chosen: &[String]) {
    println!("mean radiance against level 0 (and difference of coverage): {LIGHTS:?}");
    let mut worst = [0.0f64; 2];
    for name in DESIGNS {
        if !chosen.is_empty() && !chosen.iter().any(|word| word == name) {
            continue;
        }
        let (seconds, fine) = measured(name, 0, false);
        println!("{name:12} level 0  built in {seconds:5.2} s");
        for level in 1..=4 {
            for corrected in [false, true] {
                let (seconds, coarse) = measured(name, level, corrected);
                let errors = (fine.iter().zip(&coarse)).map(|(f, c)| c.0 / f.0 - 1.0);
                for error in errors {
                    let worst = &mut worst[usize::from(corrected)];
                    *worst = worst.max(error.abs());
                }
                let row: Vec<String> = (fine.iter().zip(&coarse))
                    .map(|(f, c)| {
                        format!("{:+6.2} % ({:+.3})", 100.0 * (c.0 / f.0 - 1.0), c.1 - f.1)
                    })
                    .collect();
                println!(
                    "{name:12} level {level} {:9} built in {seconds:5.2} s  {}",
                    if corrected { "corrected" } else { "averaged" },
                    row.join("  ")
                );
            }
        }
    }
    let [before, after] = worst.map(|worst| 100.0 * worst);
    println!("largest error: {before:.2} % averaged, {after:.2} % corrected");
}

/// A weave in one white yarn of a family at its usual size and sett.
fn white(family: Family, weave: &str) -> Design {
    let yarn = Yarn::new("white", family, Srgb(255, 255, 255));
    let maps = YarnMaps::plain(YarnId(0), YarnId(0));
    let sett: Sett = pickglass::design::usual_sett(std::slice::from_ref(&yarn), &maps);
    let structure = Structure::Weave(Filled::once(weave).expect("a weave"));
    Design::new(weave, structure, vec![yarn], maps, sett).expect("a design")
}

fn cloth(design: &Design, level: u32) -> ClothVolume {
    let catalogue = Arc::new(Catalogue::standard());
    let settings = ClothSettings {
        level,
        correct_levels: true,
        ..ClothSettings::default()
    };
    let job = Job::new();
    let (assignment, needed) =
        ClothVolume::assign(design, &catalogue, &settings, &job).expect("blocks");
    let classes = YarnClasses::new(design);
    let grid = ClothVolume::grid_for(&catalogue, &classes, &settings).expect("a grid");
    let store = ExemplarStore::none();
    let sets = (classes.pairs.iter())
        .map(|pair| (store.get(&catalogue, pair, grid, &needed, &job)).expect("exemplars"))
        .collect();
    let albedo = vec![Vec3::ONE; design.yarns().len()];
    ClothVolume::new(
        design, catalogue, classes, assignment, sets, albedo, settings, &job,
    )
    .expect("a cloth")
}

fn transmittance(cloth: &ClothVolume) -> f64 {
    fit::transmittance(cloth, RAYS, &Job::new()).expect("not cancelled")
}

fn light(cloth: &ClothVolume) -> Vec<Light> {
    LAYERS
        .map(|layers| fit::measure(cloth, layers, PATHS, &Job::new()).expect("not cancelled"))
        .into()
}

/// The exponent with which the coarse cloths let through as much light as the fine ones
/// did, all weaves together.
fn gamma(family: Family, voxel_um: f32, cloths: &[ClothVolume], wanted: f64) -> f32 {
    let excess = |gamma: f32| {
        let with = |cloth: &ClothVolume| {
            let correction = LevelCorrection {
                gamma,
                ..LevelCorrection::none(family, voxel_um)
            };
            transmittance(&cloth.clone().with_corrections(|_| correction))
        };
        cloths.iter().map(with).sum::<f64>() - wanted
    };
    let [mut low, mut high] = GAMMAS;
    // More of γ lets through more light.
    for _ in 0..7 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

fn entry(row: &LevelCorrection) -> String {
    let list = |values: [f32; TERMS]| values.map(|value| format!("{value:.4}")).join(", ");
    format!(
        "    (family: {:?}, voxel_um: {:.3}, gamma: {:.3}, single: ({}), multiple: ({})),\n",
        row.family,
        row.voxel_um,
        row.gamma,
        list(row.single),
        list(row.multiple)
    )
}

/// Measures the table of corrections.
fn fit_all(write: bool, chosen: &[String]) {
    let mut table = String::from("[\n");
    for family in Family::ALL {
        if !chosen.is_empty() && !chosen.iter().any(|word| word == family.name()) {
            continue;
        }
        let designs = WEAVES.map(|weave| white(family, weave));
        let begun = Instant::now();
        let cloths = designs.each_ref().map(|design| cloth(design, 0));
        let through: f64 = cloths.iter().map(transmittance).sum();
        let fine: Vec<Light> = cloths.iter().flat_map(light).collect();
        let um = |cloth: &ClothVolume| cloth.sets()[0].grid.voxel_um()[0];
        table += &entry(&LevelCorrection::none(family, um(&cloths[0])));
        eprintln!(
            "{} level 0: voxels of {:.2} µm, lets through {:.4}, {:.0} s",
            family.name(),
            um(&cloths[0]),
            through / WEAVES.len() as f64,
            begun.elapsed().as_secs_f64()
        );
        let mut last = um(&cloths[0]);
        for level in 1..=4 {
            let begun = Instant::now();
            let cloths = designs.each_ref().map(|design| cloth(design, level));
            let voxel_um = um(&cloths[0]);
            // Small blocks have no coarser voxels than eight a side.
            if voxel_um < 1.02 * last {
                continue;
            }
            last = voxel_um;
            let gamma = gamma(family, voxel_um, &cloths, through);
            let density = LevelCorrection {
                gamma,
                ..LevelCorrection::none(family, voxel_um)
            };
            let coarse: Vec<Light> = (cloths.into_iter())
                .map(|cloth| cloth.with_corrections(|_| density))
                .flat_map(|cloth| light(&cloth))
                .collect();
            let pairs: Vec<(Light, Light)> = fine.iter().cloned().zip(coarse).collect();
            let (single, multiple, residual) = fit::solve(&pairs);
            let row = LevelCorrection {
                single,
                multiple,
                ..density
            };
            let [before, after] = [residual.before, residual.after].map(|e| e.map(|e| 100.0 * e));
            eprint!(
                "{} level {level}: error {:.2} % (most {:.2} %), corrected {:.2} % ({:.2} %), {:.0} s\n{}",
                family.name(),
                before[0],
                before[1],
                after[0],
                after[1],
                begun.elapsed().as_secs_f64(),
                entry(&row)
            );
            table += &entry(&row);
        }
    }
    table += "]\n";
    if write && chosen.is_empty() {
        let preset = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/levels.ron");
        atomic::write(&preset, table.as_bytes()).expect("the preset is written");
    } else {
        print!("{table}");
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let is = |name: &str| words.iter().any(|word| word == name);
    let chosen: Vec<String> = (words.iter())
        .filter(|word| !word.starts_with('-'))
        .cloned()
        .collect();
    if is("--fit") {
        fit_all(is("--write"), &chosen);
    } else {
        compare(&chosen);
    }
}
