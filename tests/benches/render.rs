//! Time to equal error against mitsuba 3.5.2, and our own path rate.
//!
//! `cargo bench --bench render` prints; nothing is asserted. Four grids fill a frame of
//! 512²: a thin silk satin and a thick wool twill, each once sampled from the cloth that
//! the program makes of a design and once from procedural yarns. Both renderers are set against one
//! reference of ours (their agreement is a test of its own); error² falls with 1/time, so
//! the ratio of error²·seconds is the ratio of times to equal error. It is printed for all
//! pixels, and again without the worst thousandth of each picture's pixels, since a few
//! extreme samples can outweigh all others. For mitsuba's
//! compiled variant name LLVM in `DRJIT_LIBLLVM_PATH`. `quick` in the arguments leaves
//! out the peer, `exemplars`, `procedural`, `silk` or `wool` all other grids.

#[path = "../common/render_scenes/mod.rs"]
mod render_scenes;

use std::path::Path;
use std::process::Command;

use std::sync::Arc;

use glam::{UVec3, Vec3};
use pickglass::design::{Design, Family, Filled, Structure, Yarn, YarnId, YarnMaps, usual_sett};
use pickglass::engine::{StillRequest, prepare};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::presets;
use pickglass::render::{Background, Medium, RenderSettings};
use pickglass::scene::Bounds;
use pickglass::volume::{DenseGrid, GridVoxel, Optics, Taps};
use render_scenes::peer::{PeerView, python, relative_mse, script, write_film, write_scene};
use render_scenes::{shoot, silk_satin, wool_twill};

const SIZE: u32 = 512;
const SPP: u32 = 8;
const REFERENCE_SPP: u32 = 48;
const PEER_SPP: u32 = 2;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let quick = arguments.iter().any(|argument| argument == "quick");
    let words = ["exemplars", "procedural", "silk", "wool"];
    let asked: Vec<&str> = (words.into_iter())
        .filter(|word| arguments.iter().any(|argument| argument == word))
        .collect();
    let wanted = |name: &str| asked.iter().all(|word| name.contains(word));
    for (name, design, side, voxel_mm) in [
        ("silk satin of exemplars", silk_design(), 2.6, 0.006),
        ("wool twill of exemplars", wool_design(), 7.0, 0.016),
    ] {
        if wanted(name) {
            let (grid, bounds) = sampled(&design, side, voxel_mm);
            measure(name, &grid, bounds, quick);
        }
    }
    for (name, scene) in [
        ("procedural silk satin", silk_satin(20)),
        ("procedural wool twill", wool_twill(8)),
    ] {
        if wanted(name) {
            measure(name, &scene.grid(Taps::Nearest), scene.bounds(), quick);
        }
    }
}

/// The preset silk satin.
fn silk_design() -> Design {
    let preset = presets::design("silk-satin").expect("a preset");
    preset.expect("the preset reads")
}

/// An undyed 2/2 twill of heavy wool.
fn wool_design() -> Design {
    let mut yarn = Yarn::new("wool", Family::Wool, Family::Wool.numbers().undyed);
    yarn.tex = Some(180.0);
    let maps = YarnMaps::plain(YarnId(0), YarnId(0));
    let yarns = vec![yarn];
    let sett = usual_sett(&yarns, &maps);
    let twill = Structure::Weave(Filled::once("2/2 twill").expect("a notation"));
    Design::new("wool twill", twill, yarns, maps, sett).expect("a design")
}

/// A square of a design's cloth as a dense grid of cubic voxels; sides in mm.
fn sampled(design: &Design, side: f32, voxel_mm: f32) -> (DenseGrid, Bounds) {
    let request = StillRequest::default();
    let store = ExemplarStore::user();
    let design = Arc::new(design.clone());
    let prepared = prepare(&design, &request, &store, &Job::new()).expect("a cloth");
    let cloth = prepared.cloth().clone().with_window(0.0..side, 0.0..side);
    let (low, high) = cloth.height_range();
    let size = (Vec3::new(side, side, high - low) / voxel_mm).ceil();
    let bounds = Bounds {
        min: Vec3::ZERO,
        max: size * voxel_mm,
    };
    let optics = (0..design.yarns().len() as u32)
        .map(|yarn| Optics {
            albedo: Medium::albedo(&cloth, yarn),
            alpha: design.yarns()[yarn as usize].alpha(),
        })
        .collect();
    let voxel = |cell: UVec3| {
        let voxel = cloth.voxel_at((cell.as_vec3() + 0.5) * voxel_mm + Vec3::Z * low);
        GridVoxel {
            sigma: voxel.sigma,
            direction: voxel.direction,
            optics: voxel.optics,
        }
    };
    let grid = DenseGrid::from_fn(size.as_uvec3(), bounds, optics, Taps::Nearest, voxel);
    (grid.expect("the cloth is sound"), bounds)
}

fn measure(name: &str, grid: &DenseGrid, bounds: Bounds, quick: bool) {
    let view = PeerView {
        target: bounds.max * 0.5,
        from: Vec3::new(0.0, -0.3, 1.0),
        field_of_view: 20.0,
        width_mm: bounds.max.x * 0.7,
        width: SIZE,
        height: SIZE,
        towards_sun: Vec3::new(-0.5, 0.5, 0.7),
        sun: 2.2,
        sky: 0.4,
    };
    let settings = RenderSettings {
        spp: SPP,
        pass_spp: SPP,
        max_order: 64,
        background: Background::Sky,
        ..RenderSettings::default()
    };
    let (camera, lights) = (view.camera(), view.lights());
    let before = cpu_seconds();
    let ours = shoot(grid, &camera, &lights, &settings);
    let cpu = cpu_seconds() - before;
    let counters = ours.counters;
    let per_path = |count: u64| count as f64 / counters.paths as f64;
    println!(
        "{name}: {:.2} s for {SPP} spp, {:.0} paths/s; a path: {:.1} scatterings, {:.1} shadow rays, {:.1} lookups; error {:.3}",
        ours.seconds,
        ours.paths_per_second,
        per_path(counters.scatterings),
        per_path(counters.shadow_rays),
        per_path(counters.lookups),
        ours.error.error,
    );
    let efficiency = ours.error.error.powi(2) * ours.seconds;
    println!("  error²·s by our own estimate: {efficiency:.4}");
    if quick {
        return;
    }
    let Some(python) = python() else {
        println!("  no peer: run tests/run.sh, or set PICKGLASS_MITSUBA_PYTHON");
        return;
    };
    let long = RenderSettings {
        seed: 1,
        spp: REFERENCE_SPP,
        ..settings.clone()
    };
    let reference = shoot(grid, &camera, &lights, &long).film;
    let mse = relative_mse(&ours.film, &reference);
    println!(
        "  ours: {:.2} s ({cpu:.2} s of processors), mse {:.4}, of most pixels {:.4}",
        ours.seconds, mse[0], mse[1]
    );
    let folder = tempfile::tempdir().expect("a folder");
    write_scene(folder.path(), grid, bounds, &view, &settings);
    write_film(folder.path(), "reference", &reference);
    for variant in ["scalar_rgb", "llvm_ad_rgb"] {
        match peer(&python, folder.path(), variant) {
            Some(peer) => {
                println!("  {}", peer.line);
                for (pixels, theirs, ours_mse) in [
                    ("all pixels", peer.mse[0], mse[0]),
                    ("most pixels", peer.mse[1], mse[1]),
                ] {
                    println!(
                        "  {variant}, {pixels}: {:.1} times our time to equal error, {:.1} times our processor time",
                        theirs * peer.seconds / (ours_mse * ours.seconds),
                        theirs * peer.cpu_seconds / (ours_mse * cpu),
                    );
                }
            }
            None => println!("  {variant}: did not run"),
        }
    }
}

/// Processor time of this process so far, seconds; meaningful beside other work, where
/// the wall clock is not. 0 where the system does not tell.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = text.rsplit(')').next().unwrap_or_default();
    let ticks = fields.split_whitespace().nth(11);
    ticks.and_then(|t| t.parse::<f64>().ok()).unwrap_or(0.0) / 100.0
}

/// What a variant of mitsuba needed and reached.
struct Peer {
    seconds: f64,
    cpu_seconds: f64,
    /// Of all pixels and of most, as [`relative_mse`].
    mse: [f64; 2],
    line: String,
}

fn peer(python: &Path, folder: &Path, variant: &str) -> Option<Peer> {
    let spp = PEER_SPP.to_string();
    let output = Command::new(python)
        .arg(script())
        .arg("bench")
        .arg(folder)
        .args([variant, &spp])
        .output()
        .ok()?;
    if !output.status.success() {
        println!("  {}", String::from_utf8_lossy(&output.stderr));
        return None;
    }
    let line = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    let field = |key: &str| {
        let rest = line.split(&format!("\"{key}\": ")).nth(1)?;
        rest.split([',', '}']).next()?.trim().parse().ok()
    };
    Some(Peer {
        seconds: field("seconds")?,
        cpu_seconds: field("cpu_seconds")?,
        mse: [field("mse")?, field("most_mse")?],
        line: line.clone(),
    })
}
