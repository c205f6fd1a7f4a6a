//! Writing volumes: speed of each format beside the disk's own, peak memory of a window of
//! 2 GB, and how a window's picture differs from the cloth's. Printed and never asserted:
//! `cargo bench --bench volume`. `PICKGLASS_BENCH_FOLDER` chooses the disk.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use pickglass::cloth::{ClothVolume, ClothWindow, Part, Region};
use pickglass::engine::{self, StillRequest};
use pickglass::exemplar::ExemplarStore;
use pickglass::formats::volume;
use pickglass::job::Job;
use pickglass::presets;
use pickglass::render::{Background, RenderSettings, Scatterer, render};
use pickglass::scene::{Camera, LightRig, View, luminance};
use pickglass::volume::Taps;
use pickglass::volume::source::{CellBox, SourceVoxel, VoxelSource};

/// Peak resident memory since the last reset, MB.
fn peak() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok());
    kilobytes.unwrap_or(f64::NAN) / 1e3
}

fn reset_peak() {
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Processor seconds of this process.
fn cpu() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks: f64 = (stat.rsplit(')').next().unwrap_or_default())
        .split_whitespace()
        .skip(11)
        .take(2)
        .filter_map(|word| word.parse::<f64>().ok())
        .sum();
    ticks / 100.0
}

/// MB/s of writing zeros in large pieces and bringing them to the disk.
fn disk(folder: &Path, megabytes: usize) -> f64 {
    let mut file = tempfile::tempfile_in(folder).expect("a file");
    let piece = vec![1u8; 1 << 20];
    let begun = Instant::now();
    for _ in 0..megabytes {
        file.write_all(&piece).expect("room");
    }
    file.sync_all().expect("synced");
    megabytes as f64 * 1.048_576 / begun.elapsed().as_secs_f64()
}

fn cloth_of(name: &str) -> ClothVolume {
    let design = presets::design(name).expect("there").expect("sound");
    let request = StillRequest::default();
    let prepared = engine::prepare(
        &Arc::new(design),
        &request,
        &ExemplarStore::user(),
        &Job::new(),
    );
    prepared.expect("a cloth").cloth().clone()
}

fn square(count: u32) -> Region {
    Region {
        end: 0,
        pick: 0,
        ends: count,
        picks: count,
    }
}

fn write(cloth: &ClothVolume, folder: &Path, ending: &str, count: u32, raw: f64) {
    let window = ClothWindow::new(cloth, square(count), Part::Whole, None).expect("a window");
    let path = folder.join(format!("cloth.{ending}"));
    reset_peak();
    let before = peak();
    let (begun, spent) = (Instant::now(), cpu());
    let written = volume::write(&window, &path, &[], &Job::new()).expect("written");
    let (seconds, spent) = (begun.elapsed().as_secs_f64(), cpu() - spent);
    let megabytes = written.bytes as f64 / 1e6;
    println!(
        "{ending:<5} {count:>3}² crossings {:>6.1} M voxels {megabytes:>8.1} MB {seconds:>7.2} s \
         ({spent:.2} s cpu) {:>7.1} MB/s ({:.1} M voxels/s), disk {raw:.0} MB/s, \
         peak {:.0} MB (+{:.0})",
        written.voxels as f64 / 1e6,
        megabytes / seconds,
        written.voxels as f64 / 1e6 / seconds,
        peak(),
        peak() - before,
    );
    for file in written.files {
        fs::remove_file(file).expect("removed");
    }
}

fn mean<S: Scatterer>(what: &S, camera: &Camera) -> (f64, f64) {
    let lights = LightRig::preset("day").expect("a preset");
    let settings = RenderSettings {
        spp: 64,
        background: Background::Sky,
        ..RenderSettings::default()
    };
    let outcome = render(
        what,
        camera,
        &lights,
        &settings,
        &Job::new(),
        &mut |_, _| {},
    );
    let film = outcome.expect("rendered").film;
    let count = film.pixels().len() as f64;
    let sum =
        |of: &dyn Fn(&pickglass::film::Pixel) -> f64| film.pixels().iter().map(of).sum::<f64>();
    (
        sum(&|p| f64::from(luminance(p.mean()))) / count,
        sum(&|p| p.variance()).sqrt() / count,
    )
}

/// Mean luminance of the middle of a window against that of the cloth itself.
fn difference(cloth: &ClothVolume, folder: &Path, name: &str) {
    let middle = [cloth.ends().start(4) as f32, cloth.picks().start(4) as f32];
    let width = (cloth.ends().start(5) - cloth.ends().start(3)) as f32;
    let camera = View::Face.camera(glam::Vec3::new(middle[0], middle[1], 0.0), width, 64, 64);
    let (own, own_error) = mean(cloth, &camera);
    println!("{name}: mean luminance of the cloth {own:.4} ± {own_error:.4}");
    for per_crossing in [Some(4), Some(8), Some(16), Some(32), None] {
        let window = ClothWindow::new(cloth, square(8), Part::Whole, per_crossing).expect("one");
        let path: PathBuf = folder.join("cloth.vol");
        let written = volume::write(&window, &path, &[], &Job::new()).expect("written");
        let grid = volume::read(&path, Taps::StochasticTrilinear, &Job::new())
            .expect("read")
            .grid;
        let (of_file, error) = mean(&grid, &camera);
        println!(
            "  {:>3} voxels a crossing, {:>7.2} MB: {of_file:.4} ± {error:.4}, {:+.1} %",
            window.frame().size.x / 8,
            written.bytes as f64 / 1e6,
            100.0 * (of_file / own - 1.0),
        );
        for file in written.files {
            fs::remove_file(file).expect("removed");
        }
    }
}

fn main() {
    let base =
        std::env::var_os("PICKGLASS_BENCH_FOLDER").map_or_else(std::env::temp_dir, PathBuf::from);
    let folder = tempfile::tempdir_in(base).expect("a folder");
    let folder = folder.path();
    let cloth = cloth_of("default");
    let raw = disk(folder, 1024);
    // Sampling alone.
    let window = ClothWindow::new(&cloth, square(12), Part::Whole, None).expect("a window");
    let size = window.frame().size;
    let cells = CellBox {
        low: glam::UVec3::ZERO,
        size: size.min(glam::UVec3::new(512, 64, 512)),
    };
    let mut voxels = vec![SourceVoxel::EMPTY; cells.voxels()];
    window.fill(cells, &mut voxels);
    let (begun, spent) = (Instant::now(), cpu());
    for _ in 0..4 {
        window.fill(cells, &mut voxels);
    }
    let count = 4.0 * voxels.len() as f64 / 1e6;
    println!(
        "sampling alone: {:.1} M voxels/s, {:.1} M voxels a cpu second",
        count / begun.elapsed().as_secs_f64(),
        count / (cpu() - spent),
    );
    drop(voxels);
    for ending in ["vol", "vdb", "nrrd", "mhd", "tif"] {
        write(&cloth, folder, ending, 8, raw);
    }
    if std::env::args().any(|argument| argument == "--large") {
        // About 2 GB.
        write(&cloth, folder, "vol", 14, raw);
    }
    difference(&cloth, folder, "default");
}
