//! The exported scene in mitsuba 3.5.2 and the exported voxels in our own tracer.

use std::process::Command;

use crate::cloth_scenes::{at_level, preset, weave};
use crate::render_scenes::peer::{python, script, write_film};
use crate::render_scenes::shoot;
use glam::UVec3;
use pickglass::cloth::{ClothWindow, Part, Region};
use pickglass::formats::volume;
use pickglass::formats::volume::mitsuba::{Scene, scene};
use pickglass::job::Job;
use pickglass::render::{Background, Medium, RenderSettings};
use pickglass::scene::{LightRig, View};
use pickglass::volume::source::VoxelSource;
use pickglass::volume::{DenseGrid, GridVoxel, Taps};

#[test]
fn mitsuba_renders_the_exported_scene_alike() {
    let Some(python) = python() else {
        assert!(
            std::env::var_os("GOLDEN_REQUIRED").is_none(),
            "mitsuba is required: run tests/run.sh, or set PICKGLASS_MITSUBA_PYTHON"
        );
        println!(
            "not run: no Python with mitsuba==3.5.2; run tests/run.sh, or set PICKGLASS_MITSUBA_PYTHON"
        );
        return;
    };
    let cloth = weave(&preset("denim"), at_level(2));
    let region = Region {
        end: 1,
        pick: 2,
        ends: 3,
        picks: 2,
    };
    let window = ClothWindow::new(&cloth, region, Part::Whole, Some(12)).expect("a window");
    let settings = RenderSettings {
        spp: 1024,
        max_order: 32,
        roulette_order: u32::MAX,
        background: Background::Sky,
        ..RenderSettings::default()
    };
    for view in [View::Face, View::Oblique] {
        let lights = LightRig::preset("day").expect("a preset");
        let bounds = window.frame().bounds();
        let middle = (bounds.min + bounds.max) * 0.5;
        let camera = view.camera(middle, bounds.max.x - bounds.min.x, 18, 12);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("cloth.vol");
        let frame = window.frame();
        let files = scene(
            &path,
            &frame,
            &Scene {
                camera: &camera,
                // Mitsuba's suns are points.
                lights: &points(&lights),
                max_order: settings.max_order,
                roulette_order: settings.roulette_order,
                sky: settings.sky,
            },
        )
        .expect("a scene");
        volume::write(&window, &path, &files, &Job::new()).expect("written");

        // Our tracer on that same file.
        let grid = volume::read(&path, Taps::Nearest, &Job::new())
            .expect("read")
            .grid;
        let film = shoot(&grid, &camera, &points(&lights), &settings).film;
        write_film(folder.path(), "ours", &film);
        // Negative control: a little less matter.
        let thinner = thinner(&grid);
        let film = shoot(&thinner, &camera, &points(&lights), &settings).film;
        write_film(folder.path(), "thinner", &film);
        // The scene's files are those beside it, also where others of their names lie.
        let elsewhere = tempfile::tempdir().expect("a folder");
        let small = ClothWindow::new(&cloth, region, Part::Face, Some(3)).expect("a window");
        let other = elsewhere.path().join("cloth.vol");
        volume::write(&small, &other, &[], &Job::new()).expect("written");
        let output = Command::new(&python)
            .current_dir(elsewhere.path())
            .arg(script())
            .arg("scene")
            .arg(folder.path())
            .arg("cloth.xml")
            .args(["ours", "thinner"])
            .output()
            .expect("python runs");
        println!("{view:?}: {}", String::from_utf8_lossy(&output.stdout));
        println!("{}", String::from_utf8_lossy(&output.stderr));
        assert!(
            output.status.success(),
            "{view:?}: the pictures disagree, or the control agrees"
        );
    }
}

/// The rig with suns that are points.
fn points(lights: &LightRig) -> LightRig {
    let mut rig = lights.clone();
    for sun in &mut rig.suns {
        sun.angular_radius = 0.0;
    }
    rig
}

/// The grid with four fifths of the extinction.
fn thinner(grid: &DenseGrid) -> DenseGrid {
    let optics = grid.all_optics().to_vec();
    DenseGrid::from_fn(
        grid.size(),
        grid.bounds(),
        optics,
        Taps::Nearest,
        |cell: UVec3| {
            let voxel = grid.cell(cell);
            GridVoxel {
                sigma: voxel.sigma * 0.8,
                direction: voxel.direction,
                optics: voxel.optics,
            }
        },
    )
    .expect("sound")
}
