//! Whole pictures: grids under the preset lights, through every file format.

use crate::render_scenes::{shoot, silk_satin, wool_twill};
use glam::Vec3;
use pickglass::film::Tone;
use pickglass::formats::png::{self, Depth, Metadata};
use pickglass::render::RenderSettings;
use pickglass::scene::{LightRig, PRESET_NAMES, View};
use pickglass::volume::Taps;

/// Set this to a folder to look at what the tests render.
fn keep(name: &str, outcome: &pickglass::render::RenderOutcome) {
    if let Some(folder) = std::env::var_os("PICKGLASS_TEST_PICTURES") {
        let picture = Tone::default().picture(&outcome.film);
        let path = std::path::Path::new(&folder).join(format!("{name}.png"));
        png::write(&path, &picture, Depth::Eight, &Metadata::default()).expect("written");
    }
}

#[test]
fn every_view_and_light_gives_a_sound_picture() {
    let scene = wool_twill(8);
    let grid = scene.grid(Taps::Nearest);
    let bounds = scene.bounds();
    let target = (bounds.min + bounds.max) * 0.5;
    for (k, view) in View::ALL.iter().enumerate() {
        let camera = view.camera(target, bounds.max.x * 0.8, 96, 72);
        let preset = PRESET_NAMES[k % PRESET_NAMES.len()];
        let lights = LightRig::preset(preset)
            .expect("a preset")
            .on(view.pose(false));
        let settings = RenderSettings {
            spp: 8,
            ..RenderSettings::default()
        };
        let outcome = shoot(&grid, &camera, &lights, &settings);
        keep(&format!("wool-{}-{preset}", view.name()), &outcome);
        println!("{} {preset}: {:?}", view.name(), outcome.counters);
        println!(
            "  {:.0} paths/s, error {:?}",
            outcome.paths_per_second, outcome.error
        );
        assert_eq!(outcome.counters.majorant_violations, 0);
        assert_eq!(outcome.counters.capped_walks, 0);
        assert_eq!(outcome.counters.invalid_samples, 0);
        let mean: Vec3 = outcome.film.means().iter().sum::<Vec3>() / (96.0 * 72.0);
        assert!(
            mean.min_element() > 0.05 && mean.max_element() < 2.0,
            "{mean}"
        );
    }
}

#[test]
fn silk_shines() {
    let scene = silk_satin(20);
    let grid = scene.grid(Taps::Nearest);
    let camera = scene.face_camera(0.9, 128, 128);
    let lights = LightRig::preset("day").expect("a preset");
    let outcome = shoot(&grid, &camera, &lights, &RenderSettings::default());
    keep("silk-face", &outcome);
    println!(
        "{:?}\n{:.0} paths/s {:?}",
        outcome.counters, outcome.paths_per_second, outcome.error
    );
    assert_eq!(outcome.counters.majorant_violations, 0);
}
