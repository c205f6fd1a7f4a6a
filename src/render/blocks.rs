//! Some blocks of a picture, looked at closely: what light they get by order of scattering, how
//! much noise and work a path brings.
//!
//! It follows the first paths of those pixels, the same that [`super::render`] follows. As light
//! of different orders only ever adds up, one run says what each shorter limit of the orders
//! would leave out, with hardly any noise: two runs that are compared would say nothing of less
//! than a few per cent.

use std::cell::Cell;

use glam::Vec3;
use rayon::prelude::*;

use super::counters::Counters;
use super::effects::{WithPath, with_path};
use super::medium::Arrival;
use super::path::{Path, Tally};
use super::settings::RenderSettings;
use super::track::Scatterer;
use crate::clock::{Clock, Took};
use crate::film::{Film, Pixel};
use crate::job::{Cancelled, Job};
use crate::random::Random;
use crate::scene::Camera;
use crate::scene::environment::{Environment, luminance};
use crate::scene::light::LightRig;

/// Edge of a block, pixels.
pub const BLOCK: u32 = 8;

/// What one block gets.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockLight {
    /// `by_order[n]`: mean luminance that was scattered exactly n times; n = 0 is the
    /// background.
    pub by_order: Vec<f64>,
}

impl BlockLight {
    /// Mean luminance.
    pub fn mean(&self) -> f64 {
        self.by_order.iter().sum()
    }

    /// Mean luminance that is scattered more than `order` times.
    pub fn beyond(&self, order: u32) -> f64 {
        // From the smallest on.
        self.by_order.iter().skip(order as usize + 1).rev().sum()
    }
}

/// What was found of some blocks.
#[derive(Debug, Clone)]
pub struct BlocksSeen {
    /// Their pixels, block below block.
    pub film: Film,
    /// Their light, in the order in which they were asked for.
    pub light: Vec<BlockLight>,
    /// `flights[n]`: paths that flew exactly n times.
    pub flights: Vec<u64>,
    /// What went on.
    pub counters: Counters,
    /// What it took.
    pub took: Took,
}

impl BlocksSeen {
    /// Share of all flights that are left where no path is scattered more than `order` times.
    pub fn flights_up_to(&self, order: u32) -> f64 {
        let most = u64::from(order) + 1;
        let counted = self.flights.iter().zip(0u64..);
        let (all, left) = counted.fold((0, 0), |(all, left), (paths, flights)| {
            (all + paths * flights, left + paths * flights.min(most))
        });
        left as f64 / all.max(1) as f64
    }
}

/// Follows `spp` paths through every pixel of some blocks, each given by its upper left corner.
///
/// # Errors
/// When the job is cancelled.
pub fn look_at_blocks<S: Scatterer>(
    scatterer: &S,
    camera: &Camera,
    lights: &LightRig,
    settings: &RenderSettings,
    (corners, spp): (&[[u32; 2]], u32),
    job: &Job,
) -> Result<BlocksSeen, Cancelled> {
    let from_below = camera.forward().z > 0.0;
    let work = Looking {
        camera,
        settings,
        corners,
        spp,
        job,
    };
    with_path(scatterer, lights, settings, from_below, work)
}

struct Looking<'s> {
    camera: &'s Camera,
    settings: &'s RenderSettings,
    corners: &'s [[u32; 2]],
    spp: u32,
    job: &'s Job,
}

/// Light by order, as the picture has it.
struct Orders {
    total: Vec3,
    by_order: Vec<f64>,
    flights: Cell<usize>,
}

impl Tally for Orders {
    #[inline]
    fn albedo<S: Scatterer>(&self, scatterer: &S, optics: u32) -> Vec3 {
        self.flights.set(self.flights.get() + 1);
        scatterer.albedo(optics)
    }

    #[inline]
    fn add(&mut self, order: u32, light: Vec3) {
        self.total += light;
        if let Some(sum) = self.by_order.get_mut(order as usize) {
            *sum += f64::from(luminance(light));
        }
    }

    #[inline]
    fn add_from<S: Scatterer>(&mut self, scatterer: &S, arrival: &Arrival, light: Vec3) {
        self.add(arrival.order, light * scatterer.gain(arrival));
    }
}

/// What one block comes to.
type Seen = (BlockLight, Vec<u64>, Counters);

impl WithPath for Looking<'_> {
    type Output = Result<BlocksSeen, Cancelled>;

    fn run<S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>(
        self,
        path: &Path<'_, S, E, SHADOWS, PLANE>,
    ) -> Self::Output {
        let begun = Clock::now();
        let rows = BLOCK * self.corners.len() as u32;
        let mut film = Film::new(BLOCK, rows);
        let blocks = film.pixels_mut().par_chunks_mut((BLOCK * BLOCK) as usize);
        let seen: Result<Vec<Seen>, Cancelled> = blocks
            .zip(self.corners)
            .map(|(pixels, corner)| self.block(path, pixels, *corner))
            .collect();
        film.finish_pass(self.spp);
        let mut flights = vec![0; self.orders() + 1];
        let mut counters = Counters::default();
        let light = seen?.into_iter().map(|(light, flown, counts)| {
            let sums = flights.iter_mut().zip(flown);
            sums.for_each(|(sum, paths)| *sum += paths);
            counters += counts;
            light
        });
        let light = light.collect();
        Ok(BlocksSeen {
            film,
            light,
            flights,
            counters,
            took: begun.took(),
        })
    }
}

impl Looking<'_> {
    fn orders(&self) -> usize {
        self.settings.max_order.min(1 << 16) as usize + 1
    }

    fn block<S: Scatterer, E: Environment, const SHADOWS: bool, const PLANE: bool>(
        &self,
        path: &Path<'_, S, E, SHADOWS, PLANE>,
        pixels: &mut [Pixel],
        [left, top]: [u32; 2],
    ) -> Result<Seen, Cancelled> {
        let mut counters = Counters::default();
        let mut flights = vec![0; self.orders() + 1];
        let mut tally = Orders {
            total: Vec3::ZERO,
            by_order: vec![0.0; self.orders()],
            flights: Cell::new(0),
        };
        let width = u64::from(self.camera.width());
        for (pixel, place) in pixels.iter_mut().zip(0u32..) {
            self.job.check()?;
            let [x, y] = [left + place % BLOCK, top + place / BLOCK];
            let id = u64::from(y) * width + u64::from(x);
            for index in 0..self.spp {
                let mut random = Random::new(self.settings.seed, id, u64::from(index));
                let [u, v] = random.pair();
                let ray = self.camera.ray(x as f32 + u, y as f32 + v);
                tally.total = Vec3::ZERO;
                // The last flight of a path may end at nothing.
                tally.flights.set(1);
                let mut sample = path.trace(ray, &mut tally, &mut random, &mut counters);
                sample.radiance = tally.total;
                let flown = tally.flights.get().min(flights.len() - 1);
                flights[flown] += 1;
                if !pixel.add(index, &sample) {
                    counters.invalid_samples += 1;
                }
            }
        }
        let scale = 1.0 / (pixels.len() as f64 * f64::from(self.spp.max(1)));
        let mut by_order = tally.by_order;
        by_order.iter_mut().for_each(|sum| *sum *= scale);
        Ok((BlockLight { by_order }, flights, counters))
    }
}
