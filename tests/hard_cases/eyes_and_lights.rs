//! Eyes and lights where rays hardly ever leave the cloth, or hardly ever meet it.

use std::sync::OnceLock;

use crate::cloth_scenes::{at_level, preset, weave};
use glam::Vec3;
use pickglass::cloth::{ClothVolume, HairLayer};
use pickglass::job::Job;
use pickglass::render::{Both, RenderOutcome, RenderSettings, render};
use pickglass::scene::{Camera, LightRig, Sky, Sun};

const AT: Vec3 = Vec3::new(9.3, 7.1, 0.0);

/// Tweed: the hairiest of the presets.
fn tweed() -> &'static ClothVolume {
    static TWEED: OnceLock<ClothVolume> = OnceLock::new();
    TWEED.get_or_init(|| weave(&preset("tweed"), at_level(3)))
}

fn look(camera: &Camera, lights: &LightRig, spp: u32) -> RenderOutcome {
    let cloth = tweed();
    let hairs = HairLayer::new(cloth, vec![true; 8]).expect("hairs");
    let settings = RenderSettings {
        spp,
        ..RenderSettings::default()
    };
    let both = Both(cloth, &hairs);
    let outcome = render(
        &both,
        camera,
        lights,
        &settings,
        &Job::new(),
        &mut |_, _| {},
    );
    let outcome = outcome.expect("not cancelled");
    let counters = outcome.counters;
    assert_eq!(counters.majorant_violations, 0);
    assert_eq!((counters.invalid_samples, counters.invalid_rays), (0, 0));
    // What goes along the cloth meets nothing for long, and counts as absorbed at last.
    assert!(2 * counters.capped_walks <= counters.paths, "{counters:?}");
    let light = |mean: Vec3| mean.is_finite() && mean.min_element() >= 0.0;
    assert!(outcome.film.means().into_iter().all(light));
    outcome
}

/// How much of the picture is covered.
fn covered(outcome: &RenderOutcome) -> f64 {
    let pixels = outcome.film.pixels();
    let covered = pixels.iter().map(|pixel| f64::from(pixel.alpha()));
    covered.sum::<f64>() / pixels.len() as f64
}

#[test]
fn eyes_at_a_tenth_of_a_degree_and_inside() {
    let lights = LightRig::preset("day").expect("a preset");
    for degrees in [0.1f32, 0.01, 0.0, -0.1] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        for from in [
            Vec3::new(0.0, -cosine, sine),
            Vec3::new(cosine, 0.0, sine),
            Vec3::new(-0.6 * cosine, 0.8 * cosine, sine),
        ] {
            let straight = Camera::orthographic(AT, from, Vec3::Z, 6.0, 16, 16);
            let covered = covered(&look(&straight, &lights, 4));
            // Some rays pass over the cloth or below it, others go along in it.
            assert!((0.05..0.95).contains(&covered), "{degrees}°: {covered}");
            let near = Camera::perspective(AT, from, Vec3::Z, 60.0, 1.0, 16, 16);
            look(&near, &lights, 4);
        }
    }
    // Inside of a yarn, and between yarns, whichever way it looks.
    for step in 0..24u8 {
        let turn = f32::from(step) * 0.7;
        let from = Vec3::new(turn.cos(), turn.sin(), (2.3 * turn).sin());
        let at = AT + Vec3::new(0.05 * f32::from(step), 0.03 * f32::from(step), 0.0);
        let inside = Camera::perspective(at, from, Vec3::Y, 100.0, 0.01, 8, 8);
        let covered = covered(&look(&inside, &lights, 4));
        assert!(covered > 0.5, "step {step}: {covered}");
    }
}

/// A sun at these degrees over the cloth, of irradiance 1.
fn sun(degrees: f32, radius: f32) -> LightRig {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let towards = Vec3::new(0.8 * cosine, 0.6 * cosine, sine);
    let sun = Sun {
        towards,
        irradiance: Vec3::ONE,
        angular_radius: radius,
    };
    LightRig::new("sun", vec![sun], Sky::Dark)
}

#[test]
fn a_sun_on_the_horizon_is_like_one_beside_it() {
    let camera = Camera::orthographic(AT, Vec3::new(0.1, -0.3, 1.0), Vec3::Y, 4.0, 32, 32);
    let at = |degrees| look(&camera, &sun(degrees, 0.0), 64).film.mean_luminance();
    let (on, error) = at(0.0);
    assert!(on >= 0.0);
    for degrees in [1e-3, -1e-3] {
        let (beside, other) = at(degrees);
        let sigma = (error * error + other * other).sqrt();
        println!("0°: {on:.5} ± {error:.5}, {degrees}°: {beside:.5} ± {other:.5}");
        assert!((on - beside).abs() < 5.0 * sigma + 1e-6, "{on} {beside}");
    }
    // Control: higher up there is more light.
    let (high, other) = at(30.0);
    assert!(high - on > 5.0 * (error + other), "{on} {high}");
}

#[test]
fn a_point_lamp_through_hairs_is_a_small_lamp() {
    let camera = Camera::orthographic(AT, Vec3::new(0.4, -0.3, 1.0), Vec3::Y, 3.0, 32, 32);
    for degrees in [80.0, 25.0, 4.0] {
        let (point, error) = look(&camera, &sun(degrees, 0.0), 64).film.mean_luminance();
        let (small, other) = look(&camera, &sun(degrees, 1e-3), 64).film.mean_luminance();
        let sigma = (error * error + other * other).sqrt();
        println!("{degrees}°: {point:.5} ± {error:.5}, {small:.5} ± {other:.5}");
        assert!(
            point > 0.0 && (point - small).abs() < 5.0 * sigma,
            "{degrees}"
        );
    }
}
