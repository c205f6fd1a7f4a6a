//! Measures what corrects a coarse level.
//!
//! A picture is linear in the factors of the gain's series. One run of the tracer over a
//! coarse cloth therefore gives what each term alone would show under each lamp, and the
//! factors are those with which all lamps, weaves and albedos together come nearest to
//! level 0, by linear least squares of relative errors.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::{TERMS, terms};
use crate::cloth::ClothVolume;
use crate::cloth::colour::{first_ray, path_to};
use crate::job::{Cancelled, Job};
use crate::render::path::Tally;
use crate::render::{Arrival, Counters, Random, RenderSettings, Scatterer, Stack, Sun};

/// Elevations of the lamps, degrees, and their azimuths round the cloth.
const ELEVATIONS: [f32; 5] = [12.0, 22.0, 40.0, 60.0, 85.0];
const AZIMUTHS: usize = 4;
/// Lamps of a measurement.
pub const LAMPS: usize = ELEVATIONS.len() * AZIMUTHS;
/// Albedos for which light is summed.
const ALBEDOS: [f32; 3] = [0.5, 0.9, 0.985];
/// Light of higher order is left out, from both sides of the comparison.
const MOST_ORDERS: u32 = 192;
/// Starts of paths along a side of the square that one task follows.
const ROW: u32 = 16;
/// Light below which shadow rays play roulette.
const SHADOW_ROULETTE: f32 = 0.1;
/// Pull of the factors towards "nothing changes", as a share of the measurements.
const RIDGE: f64 = 2e-4;

/// Mean light by lamp and albedo: of each term, scattered once and more often.
#[derive(Debug, Clone, PartialEq)]
pub struct Light(Vec<[f64; 2 * TERMS]>);

impl Light {
    fn dark() -> Self {
        Self(vec![[0.0; 2 * TERMS]; LAMPS * ALBEDOS.len()])
    }

    /// Mean light of each lamp and albedo, with `gain` on its terms.
    fn with(&self, gain: &[f64; 2 * TERMS]) -> impl Iterator<Item = f64> + '_ {
        let gain = *gain;
        (self.0.iter()).map(move |sums| sums.iter().zip(&gain).map(|(sum, g)| sum * g).sum())
    }
}

/// The gain that changes nothing.
const NEUTRAL: [f64; 2 * TERMS] = {
    let mut one = [0.0; 2 * TERMS];
    one[0] = 1.0;
    one[TERMS] = 1.0;
    one
};

/// Sums by lamp, which it knows by the light's direction.
struct Terms<'l> {
    suns: &'l [Sun],
    sums: Light,
}

impl Tally for Terms<'_> {
    #[inline]
    fn albedo<S: Scatterer>(&self, _: &S, _: u32) -> Vec3 {
        Vec3::ONE
    }

    fn add(&mut self, _: u32, _: Vec3) {}

    #[inline]
    fn add_from<S: Scatterer>(&mut self, _: &S, arrival: &Arrival, light: Vec3) {
        let Some(lamp) = (self.suns.iter()).position(|sun| sun.towards == arrival.to_light) else {
            return;
        };
        let (first, terms) = (usize::from(arrival.order > 1) * TERMS, terms(arrival));
        for (k, albedo) in ALBEDOS.iter().enumerate() {
            let light = light.x * albedo.powi(arrival.order as i32);
            let sums = &mut self.sums.0[lamp * ALBEDOS.len() + k][first..first + TERMS];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += f64::from(light * term);
            }
        }
    }
}

/// The lamps: a white diffuser under any one of them has radiance 1.
pub fn lamps() -> [Sun; LAMPS] {
    std::array::from_fn(|lamp| {
        let elevation = ELEVATIONS[lamp / AZIMUTHS].to_radians();
        // Every elevation starts elsewhere, so that no two share an azimuth.
        let part = lamp as f32 / LAMPS as f32 + (lamp % AZIMUTHS) as f32;
        let (sine, cosine) = (TAU * (part + 0.03) / AZIMUTHS as f32).sin_cos();
        let (up, aside) = elevation.sin_cos();
        Sun {
            towards: Vec3::new(aside * cosine, aside * sine, up),
            irradiance: Vec3::splat(PI / up),
            angular_radius: 0.0,
        }
    })
}

/// Measures the light of a cloth seen from above, `layers` of it on each other. Its own
/// colours do not matter.
///
/// # Errors
/// [`Cancelled`] when the job was.
pub fn measure(
    cloth: &ClothVolume,
    layers: u32,
    paths: u32,
    job: &Job,
) -> Result<Light, Cancelled> {
    let slide = RenderSettings::default().backing_slide_mm;
    let stack = Stack::new(cloth, layers, slide.into());
    let suns = lamps();
    let roulette = SHADOW_ROULETTE * LAMPS as f32;
    let path = path_to(&suns, &stack, MOST_ORDERS, roulette);
    let batches: Vec<Light> = (0..paths.div_ceil(ROW * ROW).max(2))
        .into_par_iter()
        .map(|batch| {
            job.check()?;
            let mut tally = Terms {
                suns: &suns,
                sums: Light::dark(),
            };
            let mut counters = Counters::default();
            for index in 0..ROW * ROW {
                let mut random = Random::new(11, u64::from(batch), u64::from(index));
                let ray = first_ray(cloth, ROW, index, Vec3::NEG_Z, &mut random);
                path.trace(ray, &mut tally, &mut random, &mut counters);
            }
            Ok(tally.sums)
        })
        .collect::<Result<_, Cancelled>>()?;
    let paths = (batches.len() as u32 * ROW * ROW) as f64;
    let mut mean = Light::dark();
    for part in &batches {
        for (sums, more) in mean.0.iter_mut().zip(&part.0) {
            sums.iter_mut()
                .zip(more)
                .for_each(|(sum, more)| *sum += more / paths);
        }
    }
    Ok(mean)
}

/// Mean transmittance of a cloth, straight on and at 45° from two sides.
///
/// # Errors
/// [`Cancelled`] when the job was.
pub fn transmittance(cloth: &ClothVolume, rays: u32, job: &Job) -> Result<f64, Cancelled> {
    let slant = std::f32::consts::FRAC_1_SQRT_2;
    let directions = [
        Vec3::NEG_Z,
        Vec3::new(slant, 0.0, -slant),
        Vec3::new(0.0, slant, -slant),
    ];
    let batches = rays.div_ceil(ROW * ROW).max(1);
    let sums: Vec<f64> = (0..batches)
        .into_par_iter()
        .map(|batch| {
            job.check()?;
            let mut sum = 0.0;
            let mut counters = Counters::default();
            for index in 0..ROW * ROW {
                let mut random = Random::new(12, u64::from(batch), u64::from(index));
                let direction = directions[(batch as usize + index as usize) % 3];
                let ray = first_ray(cloth, ROW, index, direction, &mut random);
                let share = Scatterer::transmittance(
                    cloth,
                    &ray,
                    f32::INFINITY,
                    0.0,
                    &mut random,
                    &mut counters,
                );
                sum += f64::from(share);
            }
            Ok(sum)
        })
        .collect::<Result<_, Cancelled>>()?;
    Ok(sums.iter().sum::<f64>() / f64::from(batches * ROW * ROW))
}

/// What the fitted gain leaves and what there was before it: root mean square and largest
/// relative error over all lamps, weaves and albedos.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Without a correction.
    pub before: [f64; 2],
    /// With it.
    pub after: [f64; 2],
}

/// The series (scattered once, more often) with which `coarse` is nearest to `fine`,
/// pair by pair.
pub fn solve(pairs: &[(Light, Light)]) -> ([f32; TERMS], [f32; TERMS], Residual) {
    let rows: usize = pairs.iter().map(|(fine, _)| fine.0.len()).sum();
    let columns = 2 * TERMS;
    let mut normal = DMatrix::<f64>::zeros(columns, columns);
    let mut right = DVector::<f64>::zeros(columns);
    for (fine, coarse) in pairs {
        for (wanted, sums) in fine.with(&NEUTRAL).zip(&coarse.0) {
            if !(wanted > 0.0) {
                continue;
            }
            // What is missing with the neutral gain, relative.
            let row = sums.map(|sum| sum / wanted);
            let missing = 1.0 - (row.iter().zip(&NEUTRAL)).map(|(r, n)| r * n).sum::<f64>();
            for i in 0..columns {
                right[i] += row[i] * missing;
                for j in 0..columns {
                    normal[(i, j)] += row[i] * row[j];
                }
            }
        }
    }
    for i in 0..columns {
        normal[(i, i)] += RIDGE * rows as f64;
    }
    let change = normal.cholesky().map(|factor| factor.solve(&right));
    let gain: [f64; 2 * TERMS] = std::array::from_fn(|i| {
        let change = change.as_ref().map_or(0.0, |change| change[i]);
        NEUTRAL[i] + if change.is_finite() { change } else { 0.0 }
    });
    let errors = |gain: &[f64; 2 * TERMS]| {
        let (mut squares, mut worst, mut count) = (0.0f64, 0.0f64, 0.0f64);
        for (fine, coarse) in pairs {
            for (wanted, got) in fine.with(&NEUTRAL).zip(coarse.with(gain)) {
                let error = got / wanted - 1.0;
                squares += error * error;
                worst = worst.max(error.abs());
                count += 1.0;
            }
        }
        [(squares / count.max(1.0)).sqrt(), worst]
    };
    let residual = Residual {
        before: errors(&NEUTRAL),
        after: errors(&gain),
    };
    let part = |first: usize| std::array::from_fn(|i| gain[first + i] as f32);
    (part(0), part(TERMS), residual)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light whose terms are unlike each other.
    fn light(seed: u64) -> Light {
        let mut random = Random::new(seed, 0, 0);
        let mut light = Light::dark();
        for sums in &mut light.0 {
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum = f64::from(random.uniform()) / (1 + i % TERMS) as f64;
            }
        }
        light
    }

    #[test]
    fn a_known_gain_is_found_again() {
        let gain: [f64; 2 * TERMS] = [0.9, 0.1, -0.05, 0.2, 0.0, 1.1, 0.0, 0.05, -0.1, 0.1];
        let coarse = [light(1), light(2), light(3)];
        let pairs: Vec<(Light, Light)> = (coarse.into_iter())
            .map(|coarse| {
                let mut fine = Light::dark();
                for (sums, wanted) in fine.0.iter_mut().zip(coarse.with(&gain)) {
                    sums[0] = wanted;
                }
                (fine, coarse)
            })
            .collect();
        let (single, multiple, residual) = solve(&pairs);
        let found = single.iter().chain(&multiple);
        for (found, gain) in found.zip(gain) {
            assert!(
                (f64::from(*found) - gain).abs() < 0.03,
                "{found} for {gain}"
            );
        }
        assert!(
            residual.after[1] < 0.01 && residual.before[1] > 0.05,
            "{residual:?}"
        );
    }

    #[test]
    fn equal_light_needs_no_gain() {
        let mut fine = light(4);
        for sums in &mut fine.0 {
            let sum = sums[0] + sums[TERMS];
            *sums = [0.0; 2 * TERMS];
            sums[0] = sum;
        }
        let (single, multiple, _) = solve(&[(fine.clone(), fine)]);
        assert!((single[0] - 1.0).abs() < 1e-6 && (multiple[0] - 1.0).abs() < 1e-6);
        assert!(
            single[1..]
                .iter()
                .chain(&multiple[1..])
                .all(|f| f.abs() < 1e-6)
        );
    }

    #[test]
    fn lamps_stand_all_round() {
        let sum: Vec3 = lamps().iter().map(|sun| sun.towards).sum();
        // More lamps than azimuths an elevation: nearly balanced.
        assert!(sum.truncate().length() < 0.08 * sum.z, "{sum}");
        assert!(
            lamps()
                .iter()
                .all(|sun| (sun.towards.length() - 1.0).abs() < 1e-5)
        );
    }
}
