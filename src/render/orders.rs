//! Light by order of scattering: what a medium of any uniform albedo reflects, from one
//! run.
//!
//! A path that scatters n times in a medium of albedo ω carries ωⁿ. With p_n the mean
//! light of order n for albedo 1, the reflectance is Σ p_n ωⁿ: the curve that turns the
//! colour a designer asks for into the albedo of a yarn.

use rayon::prelude::*;

use super::counters::Counters;
use super::effects::{WithPath, with_path};
use super::path::{ByOrder, Path};
use super::settings::RenderSettings;
use super::track::Scatterer;
use crate::job::{Cancelled, Job};
use crate::random::Random;
use crate::scene::Ray;
use crate::scene::environment::Environment;
use crate::scene::light::LightRig;

/// Paths in one task; part of the definition of the result, as sums of sums depend on it.
const CHUNK: u64 = 1024;

/// Mean light by order of scattering for albedo 1.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderHistogram {
    /// `light[n]`: mean luminance that was scattered exactly n times; n = 0 is the
    /// background. Orders above [`RenderSettings::max_order`] are missing.
    pub light: Vec<f64>,
    /// Paths it was measured with.
    pub paths: u64,
    /// What went on.
    pub counters: Counters,
}

impl OrderHistogram {
    /// Mean luminance for a uniform single-scattering albedo ω in 0..=1: Σ p_n ωⁿ.
    pub fn luminance(&self, albedo: f64) -> f64 {
        // Horner's rule from the highest order.
        self.light.iter().rev().fold(0.0, |sum, p| sum * albedo + p)
    }
}

/// Measures the light of `paths` paths whose first rays come from `first_ray`, with all
/// albedos taken as 1. Up to [`RenderSettings::max_order`] orders; backing sheets count
/// as one more scattering. The same bits for any number of threads.
pub fn order_histogram<S: Scatterer>(
    scatterer: &S,
    lights: &LightRig,
    settings: &RenderSettings,
    paths: u64,
    job: &Job,
    first_ray: &(dyn Fn(&mut Random) -> Ray + Sync),
) -> Result<OrderHistogram, Cancelled> {
    let down = first_ray(&mut Random::new(settings.seed, 0, 0)).direction.z <= 0.0;
    let work = Orders {
        settings,
        paths,
        job,
        first_ray,
    };
    with_path(scatterer, lights, settings, !down, work)
}

struct Orders<'s> {
    settings: &'s RenderSettings,
    paths: u64,
    job: &'s Job,
    first_ray: &'s (dyn Fn(&mut Random) -> Ray + Sync),
}

impl WithPath for Orders<'_> {
    type Output = Result<OrderHistogram, Cancelled>;

    fn run<S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>(
        self,
        path: &Path<'_, S, E, SHADOWS, PLANE>,
    ) -> Self::Output {
        let orders = self.settings.max_order.min(1 << 16) as usize + 1;
        let chunks = self.paths.div_ceil(CHUNK);
        let parts: Result<Vec<(Vec<f64>, Counters)>, Cancelled> = (0..chunks)
            .into_par_iter()
            .map(|chunk| {
                self.job.check()?;
                let mut tally = ByOrder(vec![0.0; orders]);
                let mut counters = Counters::default();
                for index in chunk * CHUNK..((chunk + 1) * CHUNK).min(self.paths) {
                    let mut random = Random::new(self.settings.seed, chunk, index);
                    let ray = (self.first_ray)(&mut random);
                    path.trace(ray, &mut tally, &mut random, &mut counters);
                }
                Ok((tally.0, counters))
            })
            .collect();
        let mut light = vec![0.0; orders];
        let mut counters = Counters::default();
        for (part, counts) in parts? {
            for (sum, value) in light.iter_mut().zip(part) {
                *sum += value;
            }
            counters += counts;
        }
        let n = self.paths.max(1) as f64;
        light.iter_mut().for_each(|sum| *sum /= n);
        Ok(OrderHistogram {
            light,
            paths: self.paths,
            counters,
        })
    }
}
