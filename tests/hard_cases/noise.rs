//! Two pictures of other random numbers differ pixel by pixel as their noise says.

use crate::cloth_scenes::{at_level, preset, weave};
use pickglass::cloth::ClothSettings;
use pickglass::film::Film;
use pickglass::job::Job;
use pickglass::render::{RenderSettings, render};
use pickglass::scene::{LightRig, View};

/// Mean and mean square of the differences of two films, in standard errors of each pixel;
/// the light of the second times `scale`.
fn z(one: &Film, other: &Film, scale: f64) -> (f64, f64) {
    let pairs = one.pixels().iter().zip(other.pixels());
    let z: Vec<f64> = pairs
        .filter_map(|(one, other)| {
            let variance = one.variance() + scale * scale * other.variance();
            let apart = one.luminance() - scale * other.luminance();
            (variance > 0.0).then(|| apart / variance.sqrt())
        })
        .collect();
    let n = z.len() as f64;
    (
        z.iter().sum::<f64>() / n,
        z.iter().map(|z| z * z).sum::<f64>() / n,
    )
}

#[test]
fn pixels_differ_by_their_noise() {
    for tap in [true, false] {
        let settings = ClothSettings { tap, ..at_level(2) };
        let cloth = weave(&preset("denim"), settings);
        let camera = View::Oblique.camera(glam::Vec3::new(5.0, 5.0, 0.0), 6.0, 48, 48);
        let lights = LightRig::preset("day").expect("a preset");
        let film = |seed| {
            let settings = RenderSettings {
                spp: 128,
                seed,
                ..RenderSettings::default()
            };
            let job = Job::new();
            render(&cloth, &camera, &lights, &settings, &job, &mut |_, _| {})
                .expect("not cancelled")
                .film
        };
        let (one, other) = (film(1), film(2));
        let (mean, square) = z(&one, &other, 1.0);
        let n = one.pixels().len() as f64;
        println!(
            "tap {tap}: mean {:.2} of its error, mean square {square:.3}",
            mean * n.sqrt()
        );
        assert!((mean * n.sqrt()).abs() < 4.5, "tap {tap}: {mean}");
        assert!((0.85..1.2).contains(&square), "tap {tap}: {square}");
        // Control: a picture that is lighter by a twentieth differs.
        let (lighter, _) = z(&one, &other, 1.05);
        assert!((lighter * n.sqrt()).abs() > 6.0, "tap {tap}: {lighter}");
    }
}
