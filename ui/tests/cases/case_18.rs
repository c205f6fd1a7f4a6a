//! The inputs of tests/cases/18, each with what is wanted of it, and their neighbours.

use crate::program::Place;
use glam::Vec3;
use pickglass::formats::exr::{encode_rgb, read_environment};
use pickglass::scene::{Environment as _, EnvironmentImage};

fn still(place: &Place, light: &str) -> (f32, serde_json::Value) {
    let said = place
        .run(&[
            "still",
            "herringbone",
            "-o",
            "o.exr",
            "--size",
            "24x16",
            "--spp",
            "64",
            "--set",
            "denoise=off",
            "--json",
            "--light",
            light,
        ])
        .done();
    let picture = read_environment(&place.path("o.exr"))
        .expect("a still")
        .image;
    let pixels = (0..24 * 16).map(|k| {
        let (u, v) = (
            ((k % 24) as f32 + 0.5) / 24.0,
            ((k / 24) as f32 + 0.5) / 16.0,
        );
        picture.radiance(EnvironmentImage::direction(u, v)).x
    });
    (pixels.sum::<f32>() / (24.0 * 16.0), said.json())
}

/// The library's tests hold the irradiance to 10⁻⁹; here noise allows a hundredth.
#[test]
fn case_18_two_rows_light_as_five_hundred() {
    let place = Place::of("18");
    let fine = encode_rgb(8, 512, |_, _| Vec3::ONE).expect("encodes");
    std::fs::write(place.path("512.exr"), fine).expect("written");
    let (coarse, report) = still(&place, "2x2.exr");
    let (fine, _) = still(&place, "512.exr");
    assert!((coarse / fine - 1.0).abs() < 0.02, "{coarse} {fine}");
    assert_eq!(report["invalid_samples"], 0);
}

#[test]
fn case_18_extreme_finite_light_makes_no_invalid_samples() {
    let place = Place::of("18");
    let (mean, report) = still(&place, "1e-20 above 1e30 below.exr");
    assert!(mean.is_finite());
    assert_eq!(report["invalid_samples"], 0);
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("taken as that"), "{warnings}");
}
