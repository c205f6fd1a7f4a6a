//! The same dense grid in mitsuba 3.5.2: pictures agree, and a perturbed grid does not.

use std::process::Command;

use crate::render_scenes::peer::{PeerView, python, script, write_film, write_scene};
use crate::render_scenes::{YarnGrid, shoot, silk_satin};
use glam::Vec3;
use pickglass::render::{Background, RenderSettings};
use pickglass::volume::{GridVoxel, Taps};

#[test]
fn mitsuba_renders_the_same_picture() {
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
    let scene = YarnGrid {
        sigma: 50.0,
        alpha: 0.25,
        twist: 0.3,
        ..silk_satin(5)
    };
    let bounds = scene.bounds();
    let view = PeerView {
        target: bounds.max * 0.5,
        from: Vec3::new(0.1, -0.8, 1.0),
        field_of_view: 30.0,
        width_mm: 0.5,
        width: 32,
        height: 24,
        towards_sun: Vec3::new(-0.5, 0.4, 1.0),
        sun: 2.0,
        sky: 0.4,
    };
    let settings = RenderSettings {
        spp: 1024,
        max_order: 24,
        roulette_order: u32::MAX,
        background: Background::Sky,
        ..RenderSettings::default()
    };
    let folder = tempfile::tempdir().expect("a folder");
    let grid = scene.grid(Taps::Nearest);
    write_scene(folder.path(), &grid, bounds, &view, &settings);
    let film = shoot(&grid, &view.camera(), &view.lights(), &settings).film;
    write_film(folder.path(), "ours", &film);
    // Negative controls: a little less matter, and fibres that lean the other way.
    let thinner = scene.grid_with(Taps::Nearest, |voxel| GridVoxel {
        sigma: voxel.sigma * 0.8,
        ..voxel
    });
    let leaning = scene.grid_with(Taps::Nearest, |voxel| GridVoxel {
        direction: voxel.direction * Vec3::new(-1.0, 1.0, 1.0),
        ..voxel
    });
    for (name, grid) in [("thinner", thinner), ("leaning", leaning)] {
        let film = shoot(&grid, &view.camera(), &view.lights(), &settings).film;
        write_film(folder.path(), name, &film);
    }
    let output = Command::new(python)
        .arg(script())
        .arg("compare")
        .arg(folder.path())
        .args(["ours", "thinner", "leaning"])
        .output()
        .expect("python runs");
    println!("{}", String::from_utf8_lossy(&output.stdout));
    println!("{}", String::from_utf8_lossy(&output.stderr));
    assert!(
        output.status.success(),
        "the pictures disagree, or a control agrees"
    );
}
