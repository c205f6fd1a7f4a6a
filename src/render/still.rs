//! A picture, pass by pass: one loop for the command line and the window.

use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::counters::Counters;
use super::effects::{WithPath, with_path};
use super::path::{Path, Total};
use super::settings::RenderSettings;
use super::track::Scatterer;
use crate::film::error::{ErrorEstimate, estimate};
use crate::film::{Film, Pixel};
use crate::job::{Cancelled, Job};
use crate::random::Random;
use crate::scene::camera::Camera;
use crate::scene::environment::Environment;
use crate::scene::light::LightRig;

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
    let from_below = camera.forward().z > 0.0;
    let frame = Frame {
        camera,
        settings,
        job,
    };
    let passes = Passes { frame, on_pass };
    with_path(scatterer, lights, settings, from_below, passes)
}

/// The passes over a film, once the effects are chosen.
struct Passes<'s> {
    frame: Frame<'s>,
    on_pass: &'s mut dyn FnMut(&Film, &Progress),
}

/// What a single pass needs.
#[derive(Clone, Copy)]
struct Frame<'s> {
    camera: &'s Camera,
    settings: &'s RenderSettings,
    job: &'s Job,
}

impl WithPath for Passes<'_> {
    type Output = Result<RenderOutcome, Cancelled>;

    fn run<S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>(
        self,
        path: &Path<'_, S, E, SHADOWS, PLANE>,
    ) -> Result<RenderOutcome, Cancelled> {
        let Frame {
            camera,
            settings,
            job,
        } = self.frame;
        let begun = Instant::now();
        let mut film = Film::new(camera.width(), camera.height());
        let mut counters = Counters::default();
        let mut error = ErrorEstimate::UNKNOWN;
        let wanted = settings.spp.max(1);
        while film.spp() < wanted {
            // 1, 1, 2, 4, … up to the size of a pass: the first picture comes soon.
            let spp = film.spp().clamp(1, settings.pass_spp.max(1));
            let spp = spp.min(wanted - film.spp());
            counters += self.frame.pass(path, &mut film, spp)?;
            error = estimate(&film);
            let progress = Progress {
                spp: film.spp(),
                seconds: begun.elapsed().as_secs_f64(),
                error,
                counters,
            };
            job.report("render", film.spp() as f32 / wanted as f32);
            (self.on_pass)(&film, &progress);
            job.check()?;
            if error.error < f64::from(settings.error) || job.expired() {
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
}

impl Frame<'_> {
    /// One pass of `spp` samples in every pixel. Every pixel's random numbers and sums
    /// are its own, so threads and their order change nothing. When the deadline passes,
    /// the squares not yet begun keep what they have.
    fn pass<S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>(
        &self,
        path: &Path<'_, S, E, SHADOWS, PLANE>,
        film: &mut Film,
        spp: u32,
    ) -> Result<Counters, Cancelled> {
        let width = film.width();
        let first = film.spp();
        let unfinished = AtomicBool::new(false);
        let counts: Result<Vec<Counters>, Cancelled> = film
            .pixels_mut()
            .par_chunks_mut((width * TILE).max(1) as usize)
            .enumerate()
            .map(|(band, pixels)| {
                let mut counters = Counters::default();
                let top = band as u32 * TILE;
                let rows = pixels.len() as u32 / width;
                for left in (0..width).step_by(TILE as usize) {
                    if first > 0 && self.job.expired() {
                        unfinished.store(true, Ordering::Relaxed);
                        return Ok(counters);
                    }
                    for row in 0..rows {
                        for x in left..(left + TILE).min(width) {
                            // A pass of dense cloth takes seconds; an edit must not wait.
                            self.job.check()?;
                            let pixel = &mut pixels[(row * width + x) as usize];
                            self.expose(path, pixel, [x, top + row], first, spp, &mut counters);
                        }
                    }
                }
                Ok(counters)
            })
            .collect();
        if !unfinished.load(Ordering::Relaxed) {
            film.finish_pass(spp);
        }
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
