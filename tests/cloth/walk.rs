//! Walking a cloth crossing by crossing is marching through it voxel by voxel, whatever
//! is made ready in advance and however many threads there are.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use crate::cloth_scenes::{
    at_level, cotton, direction, marched, voxel_mm, wavy_twill, weave, woven,
};
use glam::Vec3;
use pickglass::cloth::ClothVolume;
use pickglass::design::{Lattice, Repeat, Sett, WeavePattern};
use pickglass::job::Job;
use pickglass::random::Random;
use pickglass::render::{
    Background, Counters, Medium, RenderOutcome, RenderSettings, Scatterer, render,
};
use pickglass::scene::{LightRig, Ray, View};

/// Sum of squares of (tracked − marched)/error over `rays` rays; the marched ones moved
/// aside by `slide` mm.
fn chi_squared(cloth: &ClothVolume, rays: u64, slide: f32) -> f64 {
    let (low, high) = cloth.height_range();
    let step = voxel_mm(cloth).z / 24.0;
    let mut sum = 0.0;
    let mut used = 0u64;
    let mut k = 0;
    while used < rays {
        k += 1;
        let mut random = Random::new(21, 0, k);
        let towards = direction(&mut random);
        let [x, y] = random.pair().map(|u| 4.0 * u);
        let ray = Ray {
            origin: Vec3::new(x, y, low + (high - low) * random.uniform()),
            direction: towards,
        };
        let aside = Ray {
            origin: ray.origin + Vec3::X * slide,
            ..ray
        };
        let t_max = 0.04 + 0.1 * random.uniform();
        let expected = marched(cloth, &aside, t_max, step);
        if slide == 0.0 && !(0.02..0.98).contains(&expected) {
            continue;
        }
        used += 1;
        let n = 3000;
        let (mut mean, mut square, mut counters) = (0.0, 0.0, Counters::default());
        for _ in 0..n {
            let through = cloth.transmittance(&ray, t_max, 0.0, &mut random, &mut counters);
            mean += f64::from(through);
            square += f64::from(through * through);
        }
        mean /= f64::from(n);
        let variance = (square / f64::from(n) - mean * mean) / f64::from(n);
        // The march itself is right to about a step at each face of a voxel.
        let error = variance + 0.004f64.powi(2);
        sum += (mean - expected).powi(2) / error;
    }
    sum
}

#[test]
fn a_walk_is_a_march() {
    let mut sett = Sett::per_cm(34.0, 32.0);
    sett.ends.pitches_mm = Some(vec![0.3, 0.2, 0.4]);
    let mut settings = at_level(1);
    settings.tap = false;
    let cloth = weave(&woven(wavy_twill(96, 96), sett), settings);
    let rays = 60;
    let found = chi_squared(&cloth, rays, 0.0);
    println!("χ² {found:.1} over {rays} rays");
    // 60 ± 11 expected of a perfect march.
    assert!(found < 105.0, "{found}");
    let control = chi_squared(&cloth, rays, 0.05);
    assert!(control > 10.0 * found, "{control} against {found}");
}

fn picture(cloth: &ClothVolume, view: View) -> RenderOutcome {
    let camera = view.camera(Vec3::new(3.0, 3.0, 0.0), 4.0, 40, 30);
    let lights = LightRig::preset("day").unwrap().on(view.pose(false));
    let settings = RenderSettings {
        spp: 4,
        ..RenderSettings::default()
    };
    render(
        cloth,
        &camera,
        &lights,
        &settings,
        &Job::new(),
        &mut |_, _| {},
    )
    .unwrap()
}

#[test]
fn windows_and_threads_change_no_bit() {
    let cloth = weave(&cotton(wavy_twill(96, 96)), at_level(2));
    let ready = cloth.clone().with_window(1.5..4.0, 2.0..3.5);
    for view in [View::Face, View::Back, View::Oblique, View::Grazing] {
        let on = |threads: usize, cloth: &ClothVolume| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| picture(cloth, view))
        };
        let one = on(1, &cloth);
        assert!(one.film == on(2, &cloth).film, "threads, {view:?}");
        assert!(one.film == on(2, &ready).film, "window, {view:?}");
        assert_eq!(one.counters.invalid_samples, 0);
        assert_eq!(one.counters.majorant_violations, 0);
    }
    // Control: another seed of the synthesis is another film.
    let mut other = at_level(2);
    other.synthesis.seed = 9;
    let other = weave(&cotton(wavy_twill(96, 96)), other);
    assert!(picture(&cloth, View::Face).film != picture(&other, View::Face).film);
}

#[test]
fn beyond_a_panel_there_is_nothing() {
    let none = Lattice {
        across: Repeat::None,
        along: Repeat::None,
    };
    let pattern = WeavePattern::from_fn(8, 8, |end, pick| (end + pick) % 2 == 0);
    let cloth = weave(&cotton(pattern).with_lattice(none).unwrap(), at_level(2));
    let bounds = Medium::bounds(&cloth);
    let (width, height) = (
        cloth.ends().repeat_mm() as f32,
        cloth.picks().repeat_mm() as f32,
    );
    assert_eq!((bounds.max.x, bounds.max.y), (width, height));
    let mut counters = Counters::default();
    let hits = |x: f32, y: f32, counters: &mut Counters| {
        let ray = Ray {
            origin: Vec3::new(x, y, 1.0),
            direction: Vec3::NEG_Z,
        };
        (0..32)
            .filter(|&k| {
                let mut random = Random::new(3, 0, k);
                cloth.collide(&ray, 9.0, &mut random, counters).is_some()
            })
            .count()
    };
    for along in [0.1, 0.37, 0.8] {
        for beyond in [1e-4, 0.01, 0.5, 100.0] {
            for (x, y) in [
                (-beyond, along * height),
                (width + beyond, along * height),
                (along * width, -beyond),
                (along * width, height + beyond),
            ] {
                assert_eq!(hits(x, y, &mut counters), 0, "({x}, {y})");
            }
        }
    }
    let inside = (
        cloth.ends().centre(3) as f32,
        cloth.picks().centre(3) as f32,
    );
    assert!(hits(inside.0, inside.1, &mut counters) > 28);

    // The picture shows the background there, exactly, and cloth in its middle.
    let colour = Vec3::new(0.25, 0.5, 0.125);
    let settings = RenderSettings {
        spp: 2,
        background: Background::Colour(colour),
        ..RenderSettings::default()
    };
    let target = Vec3::new(0.5 * width, 0.5 * height, 0.0);
    let camera = View::Face.camera(target, 2.0 * width, 32, 32);
    let lights = LightRig::preset("day").unwrap();
    let film = render(
        &cloth,
        &camera,
        &lights,
        &settings,
        &Job::new(),
        &mut |_, _| {},
    )
    .unwrap()
    .film;
    for y in 0..32 {
        for x in 0..32 {
            let outside = !(8..24).contains(&x) || !(7..25).contains(&y);
            if outside {
                assert_eq!(film.pixel(x, y).mean(), colour, "({x}, {y})");
            }
        }
    }
    assert_ne!(film.pixel(16, 16).mean(), colour);
}
