//! A picture, pass by pass: one loop for the command line and the window.

use rayon::prelude::*;
use std::time::Instant;

use super::camera::Camera;
use super::counters::Counters;
use super::environment::{Dark, Environment};
use super::error::{ErrorEstimate, estimate};
use super::film::{Film, Pixel};
use super::light::{LightRig, Sky};
use super::path::{Path, Plane, Total};
use super::random::Random;
use super::settings::{Backing, RenderSettings};
use super::stack::Stack;
use super::track::Scatterer;
use crate::job::{Cancelled, Job};
use glam::Vec3;

/// Rows that one task takes; their pixels are visited in squares of this edge.
const TILE: u32 = 8;

/// A finished (or interrupted by its deadline) picture.
#[derive(Debug, Clone)]
pub struct RenderOutcome {
    /// The film.
    pub film: Film,
    /// What went on.
    pub counters: Counters,
    /// Samples in every pixel.
    pub spp: u32,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Camera paths per second.
    pub paths_per_second: f64,
    /// How far it is from done.
    pub error: ErrorEstimate,
}

/// What is known after a pass.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// Samples in every pixel so far.
    pub spp: u32,
    /// Seconds so far.
    pub seconds: f64,
    /// Error so far.
    pub error: ErrorEstimate,
    /// Counts so far.
    pub counters: Counters,
}

/// Renders until the samples, the error or the job's deadline are reached, and calls
/// `on_pass` after each pass with the film so far. The first pass is always finished.
pub fn render<S: Scatterer>(
    scatterer: &S,
    camera: &Camera,
    lights: &LightRig,
    settings: &RenderSettings,
    job: &Job,
    on_pass: &mut dyn FnMut(&Film, &Progress),
) -> Result<RenderOutcome, Cancelled> {
    let scene = Scene {
        camera,
        lights,
        settings,
        job,
    };
    match settings.backing {
        Backing::None => scene.with_sky::<S, false>(scatterer, 0.0, on_pass),
        Backing::White => scene.with_sky::<S, true>(scatterer, 0.95, on_pass),
        Backing::Black => scene.with_sky::<S, true>(scatterer, 0.0, on_pass),
        Backing::Itself => {
            let away = camera.forward().z.is_sign_positive();
            let slide = settings.backing_slide_mm.into();
            let stack = Stack::behind(scatterer, settings.backing_layers, slide, away);
            scene.with_sky::<_, false>(&stack, 0.0, on_pass)
        }
    }
}

/// What stays the same while the effects are chosen.
struct Scene<'s> {
    camera: &'s Camera,
    lights: &'s LightRig,
    settings: &'s RenderSettings,
    job: &'s Job,
}

impl Scene<'_> {
    fn with_sky<S: Scatterer, const PLANE: bool>(
        &self,
        scatterer: &S,
        sheet_albedo: f32,
        on_pass: &mut dyn FnMut(&Film, &Progress),
    ) -> Result<RenderOutcome, Cancelled> {
        let sky = if self.settings.sky {
            &self.lights.sky
        } else {
            &Sky::Dark
        };
        match sky {
            Sky::Dark => self.with_shadows::<_, _, PLANE>(scatterer, &Dark, sheet_albedo, on_pass),
            Sky::Dome(dome) => {
                self.with_shadows::<_, _, PLANE>(scatterer, dome, sheet_albedo, on_pass)
            }
            Sky::Image(image) => {
                self.with_shadows::<_, _, PLANE>(scatterer, &**image, sheet_albedo, on_pass)
            }
        }
    }

    fn with_shadows<S: Scatterer, E: Environment, const PLANE: bool>(
        &self,
        scatterer: &S,
        environment: &E,
        sheet_albedo: f32,
        on_pass: &mut dyn FnMut(&Film, &Progress),
    ) -> Result<RenderOutcome, Cancelled> {
        if self.settings.shadows {
            let path = self.path::<S, E, true, PLANE>(scatterer, environment, sheet_albedo);
            self.passes(&path, on_pass)
        } else {
            let path = self.path::<S, E, false, PLANE>(scatterer, environment, sheet_albedo);
            self.passes(&path, on_pass)
        }
    }

    fn path<'a, S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>(
        &'a self,
        scatterer: &'a S,
        environment: &'a E,
        sheet_albedo: f32,
    ) -> Path<'a, S, E, SHADOWS, PLANE> {
        let bounds = scatterer.bounds();
        let from_above = self.camera.forward().z <= 0.0;
        Path {
            scatterer,
            suns: &self.lights.suns,
            environment,
            turn: if self.lights.is_turned_over() {
                Vec3::new(-1.0, 1.0, -1.0)
            } else {
                Vec3::ONE
            },
            plane: Plane {
                z: if from_above {
                    bounds.min.z
                } else {
                    bounds.max.z
                },
                facing: if from_above { 1.0 } else { -1.0 },
                albedo: sheet_albedo,
            },
            max_order: self.settings.max_order,
            roulette_order: self.settings.roulette_order,
            shadow_roulette: self.settings.shadow_roulette.max(0.0),
            background: self.settings.background,
        }
    }

    fn passes<S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>(
        &self,
        path: &Path<'_, S, E, SHADOWS, PLANE>,
        on_pass: &mut dyn FnMut(&Film, &Progress),
    ) -> Result<RenderOutcome, Cancelled> {
        let begun = Instant::now();
        let mut film = Film::new(self.camera.width(), self.camera.height());
        let mut counters = Counters::default();
        let mut error = ErrorEstimate::UNKNOWN;
        let wanted = self.settings.spp.max(1);
        while film.spp() < wanted {
            let spp = self.settings.pass_spp.clamp(1, wanted - film.spp());
            counters += self.pass(path, &mut film, spp)?;
            error = estimate(&film);
            let progress = Progress {
                spp: film.spp(),
                seconds: begun.elapsed().as_secs_f64(),
                error,
                counters,
            };
            self.job.report("render", film.spp() as f32 / wanted as f32);
            on_pass(&film, &progress);
            self.job.check()?;
            if error.error < f64::from(self.settings.error) || self.job.expired() {
                break;
            }
        }
        let seconds = begun.elapsed().as_secs_f64();
        Ok(RenderOutcome {
            spp: film.spp(),
            paths_per_second: counters.paths as f64 / seconds.max(1e-9),
            film,
            counters,
            seconds,
            error,
        })
    }

    /// One pass of `spp` samples in every pixel. Every pixel's random numbers and sums
    /// are its own, so threads and their order change nothing.
    fn pass<S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>(
        &self,
        path: &Path<'_, S, E, SHADOWS, PLANE>,
        film: &mut Film,
        spp: u32,
    ) -> Result<Counters, Cancelled> {
        let width = film.width();
        let first = film.spp();
        let counts: Result<Vec<Counters>, Cancelled> = film
            .pixels_mut()
            .par_chunks_mut((width * TILE).max(1) as usize)
            .enumerate()
            .map(|(band, pixels)| {
                self.job.check()?;
                let mut counters = Counters::default();
                let top = band as u32 * TILE;
                let rows = pixels.len() as u32 / width;
                for left in (0..width).step_by(TILE as usize) {
                    for row in 0..rows {
                        for x in left..(left + TILE).min(width) {
                            let pixel = &mut pixels[(row * width + x) as usize];
                            self.expose(path, pixel, [x, top + row], first, spp, &mut counters);
                        }
                    }
                }
                Ok(counters)
            })
            .collect();
        film.finish_pass(spp);
        Ok(counts?.into_iter().sum())
    }

    #[inline]
    fn expose<S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>(
        &self,
        path: &Path<'_, S, E, SHADOWS, PLANE>,
        pixel: &mut Pixel,
        [x, y]: [u32; 2],
        first: u32,
        spp: u32,
        counters: &mut Counters,
    ) {
        let id = u64::from(y) * u64::from(self.camera.width()) + u64::from(x);
        for index in first..first + spp {
            let mut random = Random::new(self.settings.seed, id, u64::from(index));
            let [u, v] = random.pair();
            let ray = self.camera.ray(x as f32 + u, y as f32 + v);
            let mut total = Total::default();
            let mut sample = path.trace(ray, &mut total, &mut random, counters);
            sample.radiance = total.0;
            if !pixel.add(index, &sample) {
                counters.invalid_samples += 1;
            }
        }
    }
}
