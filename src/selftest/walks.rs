//! Walks of light through voxels, against closed forms.

use std::sync::Arc;

use glam::{UVec3, Vec3};

use super::fault::Fault;
use crate::job::Job;
use crate::random::Random;
use crate::render::{Background, Counters, RenderOutcome, RenderSettings, Scatterer, render};
use crate::scene::{Bounds, Camera, Dome, EnvironmentImage, LightRig, Ray, Sky, View};
use crate::volume::{DenseGrid, GridVoxel, Optics, Taps};

/// How many standard errors a mean may be off: one of a million sound ones is further.
pub(super) const SURE: f64 = 4.9;

/// A cube of `n`³ voxels, 1 mm wide, centred on the origin.
pub(super) fn cube(
    n: u32,
    (alpha, albedo): (f32, f32),
    voxel: impl Fn(UVec3) -> (f32, Vec3) + Sync,
) -> Result<DenseGrid, Fault> {
    let bounds = Bounds {
        min: Vec3::splat(-0.5),
        max: Vec3::splat(0.5),
    };
    let optics = vec![Optics {
        albedo: Vec3::splat(albedo),
        alpha,
    }];
    let voxel = |cell| {
        let (sigma, direction) = voxel(cell);
        GridVoxel {
            sigma,
            direction,
            optics: 0,
        }
    };
    DenseGrid::from_fn(UVec3::splat(n), bounds, optics, Taps::Nearest, voxel).map_err(Fault::of)
}

/// Even light of radiance 1 from everywhere.
pub(super) fn even_light() -> LightRig {
    let sky = Sky::Dome(Dome::uniform(Vec3::ONE));
    LightRig::new("even", Vec::new(), sky)
}

pub(super) fn shoot<S: Scatterer>(
    scatterer: &S,
    camera: &Camera,
    lights: &LightRig,
    settings: &RenderSettings,
    job: &Job,
) -> Result<RenderOutcome, Fault> {
    Ok(render(
        scatterer,
        camera,
        lights,
        settings,
        job,
        &mut |_, _| {},
    )?)
}

/// Refuses a film with anything in it that is no light, and counts that should be 0.
pub(super) fn sound(outcome: &RenderOutcome) -> Result<(), Fault> {
    let counters = &outcome.counters;
    Fault::unless_counted_clean(
        counters.majorant_violations,
        counters.invalid_samples,
        counters.invalid_rays,
    )?;
    let light = |mean: Vec3| mean.is_finite() && mean.min_element() >= 0.0;
    Fault::unless(outcome.film.means().into_iter().all(light), || {
        "pixels that are no light".to_owned()
    })
}

pub(super) fn rays_that_are_none(_: &Job) -> Result<String, Fault> {
    let grid = cube(9, (0.1, 0.9), |_| (5.0, Vec3::Y))?;
    let mut rays = vec![(Vec3::ZERO, Vec3::ZERO), (Vec3::ZERO, Vec3::splat(1e30))];
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let mut none = Vec3::X;
            none[axis] = value;
            rays.extend([(Vec3::ZERO, none), (none, Vec3::X)]);
        }
    }
    let (mut counters, mut random) = (Counters::default(), Random::new(0, 0, 0));
    for (origin, direction) in &rays {
        let ray = Ray {
            origin: *origin,
            direction: *direction,
        };
        let hit = grid.collide(&ray, f32::INFINITY, &mut random, &mut counters);
        let through = grid.transmittance(&ray, 1.0, 0.0, &mut random, &mut counters);
        Fault::unless(hit.is_none() && through == 0.0, || {
            format!("the ray from {origin} along {direction} was walked")
        })?;
    }
    let (counted, walks) = (counters.invalid_rays, 2 * rays.len() as u64);
    Fault::unless(counted == walks, || {
        format!("{counted} of {walks} were counted")
    })?;
    Ok(format!("{walks} walks ended and counted"))
}

pub(super) fn rays_along_axes(_: &Job) -> Result<String, Fault> {
    const WALKS: u64 = 4096;
    const SIGMA: f32 = 1.5;
    // Fibres of every direction at once: a ray is dimmed by how far it goes alone.
    let grid = cube(21, (1.0, 0.5), |_| (SIGMA, Vec3::Z))?;
    let mut rays = Vec::new();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            for zero in [0.0, -0.0] {
                let mut direction = Vec3::splat(zero);
                direction[axis] = sign;
                // From outside, from a face, and from within.
                for (back, length) in [(3.0, 1.0), (0.5, 1.0), (0.0, 0.5)] {
                    let aside = Vec3::ONE - direction.abs();
                    rays.push((aside * 0.013 - direction * back, direction, length));
                }
            }
        }
    }
    let diagonal = Vec3::ONE.normalize_or(Vec3::Z);
    rays.push((Vec3::splat(-0.5), diagonal, 3f32.sqrt()));
    rays.push((Vec3::splat(-2.0), diagonal, 3f32.sqrt()));
    let (mut counters, mut furthest) = (Counters::default(), 0.0f64);
    for (number, (origin, direction, length)) in rays.iter().enumerate() {
        let ray = Ray {
            origin: *origin,
            direction: *direction,
        };
        let through = (0..WALKS).map(|walk| {
            let mut random = Random::new(7, number as u64, walk);
            let through = grid.transmittance(&ray, 99.0, 0.0, &mut random, &mut counters);
            f64::from(through)
        });
        let mean = through.sum::<f64>() / WALKS as f64;
        let known = f64::from(-SIGMA * length).exp();
        let error = (known * (1.0 - known) / WALKS as f64).sqrt();
        let off = (mean - known).abs() / error;
        Fault::unless(off < SURE, || {
            format!("the ray from {origin} along {direction} keeps {mean:.4}, not {known:.4}")
        })?;
        furthest = furthest.max(off);
    }
    Ok(format!(
        "{} rays, the furthest off by {furthest:.1} standard errors",
        rays.len()
    ))
}

pub(super) fn extreme_random_numbers(_: &Job) -> Result<String, Fault> {
    let grid = cube(9, (0.1, 0.9), |_| (5.0, Vec3::Y))?;
    let through = Ray {
        origin: Vec3::new(-3.0, 0.1, 0.1),
        direction: Vec3::X,
    };
    for bits in [0, u64::MAX] {
        let (mut counters, mut random) = (Counters::default(), Random::stuck_at(bits));
        let hit = grid.collide(&through, f32::INFINITY, &mut random, &mut counters);
        let within = hit.is_none_or(|hit| hit.t >= 2.49 && hit.t <= 3.51);
        let kept = grid.transmittance(&through, f32::INFINITY, 0.1, &mut random, &mut counters);
        Fault::unless(within && (0.0..=1.0).contains(&kept), || {
            format!("bits {bits:x}: a place outside of the cube, or {kept} of the light")
        })?;
    }
    Ok("both walks ended within the cube".to_owned())
}

pub(super) fn densest_matter(job: &Job) -> Result<String, Fault> {
    let grid = cube(24, (0.05, 0.95), |cell| {
        let id = u64::from(cell.x + 32 * (cell.y + 32 * cell.z));
        let full = crate::hash::mix(id).is_multiple_of(3);
        (if full { 8e7 } else { 0.0 }, Vec3::new(1.0, 0.3, -0.2))
    })?;
    let camera = View::Oblique.camera(Vec3::ZERO, 1.5, 24, 24);
    let settings = RenderSettings {
        spp: 8,
        ..RenderSettings::default()
    };
    let lights = LightRig::preset("day").map_err(crate::engine::StillError::from)?;
    let outcome = shoot(&grid, &camera, &lights, &settings, job)?;
    sound(&outcome)?;
    Fault::unless(outcome.counters.capped_walks == 0, || {
        format!("{} walks had no end", outcome.counters.capped_walks)
    })?;
    Ok(format!(
        "{} lookups within their bounds",
        outcome.counters.lookups
    ))
}

pub(super) fn empty_volume(job: &Job) -> Result<String, Fault> {
    let grid = cube(9, (0.1, 0.9), |_| (0.0, Vec3::Y))?;
    let camera = View::Face.camera(Vec3::ZERO, 2.0, 16, 16);
    let colour = Vec3::new(0.5, 0.25, 1.0);
    for (background, shown, cover) in [
        (Background::Transparent, Vec3::ZERO, 0.0),
        (Background::Colour(colour), colour, 1.0),
        (Background::Sky, Vec3::ONE, 1.0),
    ] {
        let settings = RenderSettings {
            spp: 5,
            background,
            ..RenderSettings::default()
        };
        let outcome = shoot(&grid, &camera, &even_light(), &settings, job)?;
        let pixels = outcome.film.pixels();
        let exact = |pixel: &crate::film::Pixel| (pixel.mean(), pixel.alpha()) == (shown, cover);
        Fault::unless(pixels.iter().all(exact), || {
            format!("{background:?}: another light than {shown}")
        })?;
    }
    Ok("exact to the last bit".to_owned())
}

/// How a cube is looked at in the furnace.
fn furnace() -> (Camera, RenderSettings) {
    let settings = RenderSettings {
        spp: 24,
        max_order: 10_000,
        background: Background::Sky,
        ..RenderSettings::default()
    };
    (View::Oblique.camera(Vec3::ZERO, 0.6, 12, 12), settings)
}

pub(super) fn white_furnace(job: &Job) -> Result<String, Fault> {
    let picture = EnvironmentImage::new(16, 8, vec![Vec3::ONE; 128]).map_err(Fault::of)?;
    // As a picture the light is sampled, and weighed against what the fibres sample.
    let sampled = LightRig::new("picture", Vec::new(), Sky::Image(Arc::new(picture)));
    let (camera, settings) = furnace();
    let fibres = [
        Vec3::new(1.0, 2.0, 3.0),
        Vec3::new(-3.0, 1.0, 0.5),
        Vec3::new(0.2, -1.0, 4.0),
        Vec3::new(5.0, -0.3, -1.0),
        Vec3::new(-1.0, -1.0, -1.0),
        Vec3::new(0.02, 3.0, -0.9),
    ];
    let (mut worst, mut cubes) = (0.0f64, 0);
    for alpha in [0.01, 0.3, 1.0] {
        for fibre in fibres {
            let grid = cube(9, (alpha, 1.0), |_| (4.0, fibre.normalize_or(Vec3::Z)))?;
            let outcome = shoot(&grid, &camera, &sampled, &settings, job)?;
            sound(&outcome)?;
            let (mean, error) = outcome.film.mean_luminance();
            Fault::unless((mean - 1.0).abs() < SURE * error + 1e-4, || {
                format!("gloss {alpha}, fibres along {fibre}: {mean:.4} ± {error:.4}")
            })?;
            worst = worst.max((mean - 1.0).abs());
            cubes += 1;
        }
    }
    Ok(format!(
        "{cubes} cubes, the worst off by {:.2} %",
        100.0 * worst
    ))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_white_is_seen_in_the_furnace() {
        // Control of what the furnace measures: fibres that keep a twentieth of the light.
        let grid = cube(9, (0.3, 0.95), |_| (4.0, Vec3::X)).unwrap();
        let (camera, settings) = furnace();
        let outcome = shoot(&grid, &camera, &even_light(), &settings, &Job::new()).unwrap();
        let (mean, _) = outcome.film.mean_luminance();
        assert!(mean < 0.95, "{mean}");
        sound(&outcome).unwrap();
    }

    #[test]
    fn counts_of_what_went_wrong_are_a_fault() {
        let grid = cube(4, (0.3, 0.5), |_| (1.0, Vec3::X)).unwrap();
        let camera = View::Face.camera(Vec3::ZERO, 1.0, 4, 4);
        let settings = RenderSettings::default();
        let outcome = shoot(&grid, &camera, &even_light(), &settings, &Job::new()).unwrap();
        sound(&outcome).unwrap();
        for spoil in [
            |counters: &mut Counters| counters.majorant_violations += 1,
            |counters: &mut Counters| counters.invalid_samples += 1,
            |counters: &mut Counters| counters.invalid_rays += 1,
        ] {
            let mut spoilt = outcome.clone();
            spoil(&mut spoilt.counters);
            assert!(sound(&spoilt).unwrap_err().to_string().starts_with('1'));
        }
    }
}
