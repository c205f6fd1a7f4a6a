//! Time to equal error against mitsuba 3.5.2, and our own path rate.
//!
//! `cargo bench --bench render` prints; nothing is asserted. Two grids fill a frame of
//! 512²: a thin silk satin and a thick wool twill. Both renderers are set against one
//! reference of ours (their agreement is a test of its own); error² falls with 1/time, so
//! the ratio of error²·seconds is the ratio of times to equal error. For mitsuba's
//! compiled variant name LLVM in `DRJIT_LIBLLVM_PATH`. `quick` in the arguments leaves
//! out the peer.

#[path = "../render_scenes/mod.rs"]
mod render_scenes;

use std::path::Path;
use std::process::Command;

use glam::Vec3;
use pickglass::render::{Background, RenderSettings};
use pickglass::volume::Taps;
use render_scenes::peer::{PeerView, python, relative_mse, script, write_film, write_scene};
use render_scenes::{YarnGrid, shoot, silk_satin, wool_twill};

const SIZE: u32 = 512;
const SPP: u32 = 8;
const REFERENCE_SPP: u32 = 48;
const PEER_SPP: u32 = 2;

fn main() {
    let quick = std::env::args().any(|argument| argument == "quick");
    for (name, scene) in [
        ("silk satin", silk_satin(20)),
        ("wool twill", wool_twill(8)),
    ] {
        measure(name, &scene, quick);
    }
}

fn measure(name: &str, scene: &YarnGrid, quick: bool) {
    let bounds = scene.bounds();
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
    let grid = scene.grid(Taps::Nearest);
    let (camera, lights) = (view.camera(), view.lights());
    let before = cpu_seconds();
    let ours = shoot(&grid, &camera, &lights, &settings);
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
    let reference = shoot(&grid, &camera, &lights, &long).film;
    let mse = relative_mse(&ours.film, &reference);
    let (product, cpu_product) = (mse * ours.seconds, mse * cpu);
    println!(
        "  ours: {:.2} s ({cpu:.2} s of processors), mse {mse:.4}, mse·s {product:.4}",
        ours.seconds
    );
    let folder = tempfile::tempdir().expect("a folder");
    write_scene(folder.path(), &grid, bounds, &view, &settings);
    write_film(folder.path(), "reference", &reference);
    for variant in ["scalar_rgb", "llvm_ad_rgb"] {
        match peer(&python, folder.path(), variant) {
            Some(peer) => println!(
                "  {}\n  {variant}: {:.1} times our time to equal error, {:.1} times our processor time",
                peer.line,
                peer.mse * peer.seconds / product,
                peer.mse * peer.cpu_seconds / cpu_product
            ),
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
    mse: f64,
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
        mse: field("mse")?,
        line: line.clone(),
    })
}
