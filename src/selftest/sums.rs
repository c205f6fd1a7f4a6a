//! Sums of paths in a film: their digits, and that threads change nothing.

use glam::Vec3;

use super::fault::Fault;
use super::walks::{cube, shoot, sound};
use crate::engine::StillError;
use crate::film::{FirstHit, Pixel, Sample};
use crate::job::Job;
use crate::render::RenderSettings;
use crate::scene::{LightRig, View};

pub(super) fn a_million_samples(_: &Job) -> Result<String, Fault> {
    const SAMPLES: u32 = 1_000_000;
    let sample = Sample {
        radiance: Vec3::new(0.1, 1000.0, 1e-6),
        alpha: 0.1,
        first: Some(FirstHit {
            albedo: Vec3::new(0.1, 0.7, 0.3),
            normal: Vec3::new(0.6, 0.0, 0.8),
            depth: 123.4,
            optics: 3,
        }),
    };
    let mut pixel = Pixel::default();
    for index in 0..SAMPLES {
        pixel.add(index, &sample);
    }
    let (mean, variance) = (pixel.mean(), pixel.variance());
    Fault::unless(mean == sample.radiance && pixel.alpha() == 0.1, || {
        format!("the mean drifted to {mean}, cover {}", pixel.alpha())
    })?;
    let spread = variance.sqrt() / pixel.luminance();
    Fault::unless(spread < 1e-6, || {
        format!("equal samples have a spread of {spread:.1e}")
    })?;
    Ok(format!("equal to the last bit, spread {spread:.0e}"))
}

pub(super) fn poisoned_samples(_: &Job) -> Result<String, Fault> {
    let mut pixel = Pixel::default();
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let mut radiance = Vec3::splat(0.5);
            radiance[axis] = value;
            let sample = Sample {
                radiance,
                ..Sample::default()
            };
            Fault::unless(!pixel.add(0, &sample), || format!("{radiance} was taken"))?;
        }
    }
    Fault::unless(pixel == Pixel::default(), || {
        "a sample that was refused left something behind".to_owned()
    })?;
    Ok("all refused".to_owned())
}

pub(super) fn threads(job: &Job) -> Result<String, Fault> {
    let grid = cube(20, (0.2, 0.9), |cell| {
        let id = u64::from(cell.x + 32 * (cell.y + 32 * cell.z));
        let turn = crate::hash::mix(id) as u8;
        (f32::from(turn % 7), Vec3::new(1.0, f32::from(turn), 50.0))
    })?;
    let camera = View::Close.camera(Vec3::ZERO, 1.2, 45, 37);
    let lights = LightRig::preset("studio").map_err(StillError::from)?;
    let with = |threads: usize, pass_spp, seed| {
        let settings = RenderSettings {
            spp: 12,
            pass_spp,
            seed,
            ..RenderSettings::default()
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| Fault::Wrong(format!("no {threads} threads: {error}")))?;
        pool.install(|| shoot(&grid, &camera, &lights, &settings, job))
    };
    let one = with(1, 4, 0)?;
    sound(&one)?;
    for (threads, pass_spp) in [(2, 4), (5, 1)] {
        let other = with(threads, pass_spp, 0)?;
        let same = (&other.film, other.counters) == (&one.film, one.counters);
        Fault::unless(same, || format!("{threads} threads make another picture"))?;
    }
    // What would be said of two pictures that differ.
    Fault::unless(with(1, 4, 1)?.film != one.film, || {
        "other random numbers make the same picture".to_owned()
    })?;
    Ok(format!("{} paths, equal bits", one.counters.paths))
}
