//! The denoiser brings a noisy picture nearer to the long one and keeps its fibres.

use std::time::Instant;

use crate::render_scenes::{YarnGrid, shoot, silk_satin, wool_twill};
use glam::Vec3;
use pickglass::film::{Denoise, Film, Sample};
use pickglass::job::Job;
use pickglass::render::RenderSettings;
use pickglass::scene::{LightRig, luminance};
use pickglass::volume::Taps;

fn film(scene: &YarnGrid, share: f32, size: u32, spp: u32, seed: u64) -> Film {
    let grid = scene.grid(Taps::Nearest);
    let camera = scene.face_camera(share, size, size);
    let lights = LightRig::preset("day").expect("a preset");
    let settings = RenderSettings {
        spp,
        seed,
        ..RenderSettings::default()
    };
    shoot(&grid, &camera, &lights, &settings).film
}

fn denoised(denoise: Denoise, film: &Film) -> Vec<Vec3> {
    let clean = denoise.apply(film, &Job::new());
    clean.expect("nobody cancels it")
}

/// Relative RMS difference in luminance.
fn error(picture: &[Vec3], reference: &[Vec3]) -> f64 {
    let sum: f64 = picture
        .iter()
        .zip(reference)
        .map(|(a, b)| {
            let (a, b) = (f64::from(luminance(*a)), f64::from(luminance(*b)));
            (a - b) * (a - b) / (b * b + 1e-4)
        })
        .sum();
    (sum / picture.len() as f64).sqrt()
}

/// Strength of detail: RMS difference of horizontal neighbours.
fn detail(picture: &[Vec3], width: usize) -> f64 {
    let (mut sum, mut n) = (0.0f64, 0.0f64);
    for row in picture.chunks_exact(width) {
        for pair in row.windows(2) {
            sum += f64::from(luminance(pair[0] - pair[1])).powi(2);
            n += 1.0;
        }
    }
    (sum / n).sqrt()
}

/// What a filter without guidance does: a box of 7×7.
fn blurred(picture: &[Vec3], width: usize) -> Vec<Vec3> {
    let height = picture.len() / width;
    let at = |x: isize, y: isize| {
        let x = x.clamp(0, width as isize - 1) as usize;
        let y = y.clamp(0, height as isize - 1) as usize;
        picture[y * width + x]
    };
    (0..picture.len())
        .map(|k| {
            let (x, y) = ((k % width) as isize, (k / width) as isize);
            let mut sum = Vec3::ZERO;
            for v in -3..=3 {
                for u in -3..=3 {
                    sum += at(x + u, y + v);
                }
            }
            sum / 49.0
        })
        .collect()
}

#[test]
fn denoising_reduces_the_error_and_keeps_the_detail() {
    for (name, scene, share) in [("silk", silk_satin(5), 0.9), ("wool", wool_twill(4), 0.9)] {
        let size = 64;
        let reference = film(&scene, share, size, 192, 1).means();
        for spp in [4, 16] {
            let noisy = film(&scene, share, size, spp, 0);
            let before = error(&noisy.means(), &reference);
            let clean = denoised(Denoise::default(), &noisy);
            let after = error(&clean, &reference);
            let blur = error(&blurred(&noisy.means(), size as usize), &reference);
            let off = Denoise {
                strength: 0.0,
                ..Denoise::default()
            };
            assert_eq!(denoised(off, &noisy), noisy.means());
            let kept = detail(&clean, size as usize) / detail(&reference, size as usize);
            println!(
                "{name} {spp} spp: {before:.3} -> {after:.3}, box {blur:.3}, detail {kept:.2}"
            );
            assert!(after < 0.75 * before, "{name} {spp}: {before} -> {after}");
            assert!(
                after < blur,
                "{name} {spp}: {after} is no better than a blur ({blur})"
            );
            assert!(kept > 0.5, "{name} {spp}: {kept} of the detail kept");
        }
    }
}

#[test]
fn a_firefly_stays_alone_and_poison_is_harmless() {
    let (width, height) = (24, 17);
    let sample = |value: f32| Sample {
        radiance: Vec3::splat(value),
        alpha: 1.0,
        first: None,
    };
    let mut film = Film::new(width, height);
    for (k, pixel) in film.pixels_mut().iter_mut().enumerate() {
        for index in 0..8 {
            let bright = k == 200 && index == 3;
            let noise = 0.1 * ((k * 7 + index as usize * 13) % 10) as f32 / 10.0;
            pixel.add(index, &sample(if bright { 1e6 } else { 0.5 + noise }));
            pixel.add(index, &sample(f32::NAN));
        }
    }
    let clean = denoised(Denoise::default(), &film);
    assert!(
        clean
            .iter()
            .all(|p| p.is_finite() && p.x > 0.3 && p.x < 1.0)
    );
    // Films of every awkward size, and one that has seen nothing.
    for (width, height) in [(1, 1), (2, 1), (1, 3), (3, 2), (5, 40)] {
        let film = Film::new(width, height);
        for radius in [0, 1, 9, u32::MAX] {
            for strength in [0.0, 1.0, f32::NAN, f32::INFINITY, -1.0] {
                let out = denoised(Denoise { radius, strength }, &film);
                assert!(out.iter().all(|p| *p == Vec3::ZERO));
            }
        }
    }
}

#[test]
fn a_megapixel_is_denoised_soon_or_not_at_all_once_cancelled() {
    let film = Film::new(1024, 1024);
    let begun = Instant::now();
    denoised(Denoise::default(), &film);
    println!("1024x1024: {:.2} s", begun.elapsed().as_secs_f64());
    let job = Job::new();
    job.cancel();
    assert!(Denoise::default().apply(&film, &job).is_err());
}
