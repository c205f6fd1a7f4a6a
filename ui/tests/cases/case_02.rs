//! The inputs of tests/cases/02, each with what is wanted of it, and their neighbours.

use crate::program::Place;
use glam::Vec3;
use pickglass::formats::exr::read_environment;
use pickglass::scene::{Environment as _, EnvironmentImage};

/// Brightness of the left and the right edge of the bar, as `sides.py` measures it.
fn sides(place: &Place, light: &str) -> [f32; 2] {
    let (width, height) = (96, 64);
    place
        .run(&[
            "still",
            "bar.nrrd",
            "-o",
            "a.exr",
            "--size",
            "96x64",
            "--spp",
            "32",
            "--set",
            "denoise=off",
            "--light",
            light,
        ])
        .done();
    let picture = read_environment(&place.path("a.exr"))
        .expect("a still")
        .image;
    let mean = |columns: std::ops::Range<usize>| {
        let mut sum = (0.0, 0);
        for y in height / 3..2 * height / 3 {
            for x in columns.clone() {
                let at = [(x, width), (y, height)].map(|(k, n)| (k as f32 + 0.5) / n as f32);
                let pixel = picture.radiance(EnvironmentImage::direction(at[0], at[1]));
                sum = (sum.0 + pixel.element_sum(), sum.1 + 1);
            }
        }
        sum.0 / sum.1 as f32
    };
    let (third, edge) = (width / 3, width / 12);
    [mean(third..third + edge), mean(2 * third - edge..2 * third)]
}

#[test]
fn case_02_a_lamp_at_a_quarter_lights_the_right_and_one_at_three_quarters_the_left() {
    let place = Place::of("02");
    let [left, right] = sides(&place, "lamp-at-a-quarter.exr");
    assert!(right > 2.0 * left, "left {left}, right {right}");
    let [left, right] = sides(&place, "lamp-at-three-quarters.exr");
    assert!(left > 2.0 * right, "left {left}, right {right}");
}

/// Mitsuba's pictures run as ours, so the exported sky is lit where the lamp is.
#[test]
fn case_02_an_exported_scene_uses_the_picture_unmirrored() {
    let place = Place::of("02");
    place
        .run(&[
            "volume",
            "herringbone",
            "-o",
            "cloth.vol",
            "--region",
            "0,0,2,2",
            "--light",
            "lamp-at-a-quarter.exr",
        ])
        .done();
    let sky = read_environment(&place.path("cloth.sky.exr"))
        .expect("a sky")
        .image;
    let lamp = read_environment(&place.path("lamp-at-a-quarter.exr"))
        .expect("a lamp")
        .image;
    let bright = |picture: &EnvironmentImage| {
        let mut side = Vec3::ZERO;
        for k in 0..64 * 32 {
            let at = [(k % 64) as f32 / 64.0, (k / 64) as f32 / 32.0].map(|v| v + 0.004);
            let towards = EnvironmentImage::direction(at[0], at[1]);
            side += towards * picture.radiance(towards).x;
        }
        side.normalize_or(Vec3::ZERO)
    };
    let (exported, own) = (bright(&sky), bright(&lamp));
    assert!(own.x > 0.5, "{own}");
    assert!(exported.dot(own) > 0.99, "{exported} for {own}");
}
