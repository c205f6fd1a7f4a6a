//! The inputs of tests/cases/03, each with what is wanted of it, and their neighbours.

use crate::program::{Place, Said};
use pickglass::formats::exr::read_environment;
use pickglass::scene::{Environment as _, EnvironmentImage};

fn still(place: &Place, light: &str) -> (Vec<f32>, Said) {
    let said = place
        .run(&[
            "still",
            "herringbone",
            "-o",
            "a.exr",
            "--size",
            "48x36",
            "--spp",
            "16",
            "--view",
            "close",
            "--set",
            "denoise=off",
            "--light",
            light,
        ])
        .done();
    let picture = read_environment(&place.path("a.exr"))
        .expect("a still")
        .image;
    let pixels = (0..48 * 36).map(|k| {
        let (u, v) = (
            ((k % 48) as f32 + 0.5) / 48.0,
            ((k / 48) as f32 + 0.5) / 36.0,
        );
        picture.radiance(EnvironmentImage::direction(u, v)).x
    });
    (pixels.collect(), said)
}

#[test]
fn case_03_infinite_pixels_are_the_largest_finite_value_and_are_told() {
    let place = Place::of("03");
    let (largest, silent) = still(&place, "sun-largest-half.exr");
    let (infinite, told) = still(&place, "sun-overflows-half.exr");
    let (dark, none) = still(&place, "no-sun.exr");
    assert_eq!(infinite, largest);
    assert_ne!(dark, largest);
    for said in [silent, none] {
        assert!(!said.err.contains("sun-"), "{}", said.err);
    }
    let warnings: Vec<&str> = (told.err.lines())
        .filter(|line| line.contains("warning") && line.contains("sun-"))
        .collect();
    assert_eq!(warnings.len(), 1, "{}", told.err);
    assert!(
        warnings[0].contains("sun-overflows-half.exr"),
        "{warnings:?}"
    );
    assert!(
        warnings[0].contains("infinite and taken as 65504"),
        "{warnings:?}"
    );
}
