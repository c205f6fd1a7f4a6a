//! A picture for so many seconds, or with so little error: what is left out for it, and what it
//! will come to.

use std::time::Instant;

use super::block_change::{common, relative};
use super::settling::{Eye, some_of};
use crate::engine::{self, Engine, Renderer, StillError, StillRequest, Stop};
use crate::film;
use crate::job::Job;
use crate::plan::{Budget, Effect, Subject};
use crate::render::{BLOCK, BlocksSeen};

/// What a picture will come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Promise {
    /// Seconds of the whole work.
    pub seconds: f64,
    /// Relative error: noise, as [`film::error`](crate::film::error) has it, and what is left out.
    pub error: f64,
    /// The part of the error that no time makes smaller.
    pub bias: f64,
    /// Paths a pixel.
    pub spp: u32,
    /// Scatterings for which light is followed.
    pub order: u32,
}

/// Share of the seconds, at most, that working it out may take.
const LOOKING: f64 = 0.05;
/// Paths a pixel of the first look, and its blocks, at most.
const FIRST: (u32, usize) = (4, 24);
/// Share of the seconds that are left, at most, that it may take, but for its least blocks.
const FIRST_LOOKING: f64 = 0.1;
/// Its blocks, at least.
const LEAST: usize = 6;
/// Paths a pixel of the second, at most: of fewer the noise of dark places is not known, and it
/// comes out too small.
const MOST_SPP: u32 = 64;
/// Blocks of the second, at least.
const FEWEST: f64 = 48.0;
/// Most paths a pixel that are promised.
const MOST_PATHS: f64 = 65_536.0;

/// Settles a picture by a budget: how often light is scattered, and when it ends. Its work began
/// at `begun`. `None` where the engine follows no paths, and of a colour difference: a look says
/// nothing of that.
///
/// # Errors
/// When the request is not usable or the job is cancelled.
pub fn afford(
    engine: &dyn Engine,
    renderer: &Renderer,
    request: &StillRequest,
    (budget, begun): (Budget, Instant),
    job: &Job,
) -> Result<Option<(StillRequest, Promise)>, StillError> {
    if matches!(budget, Budget::DeltaE(_)) {
        return Ok(None);
    }
    let mut eye = Eye::new(renderer, request, job)?;
    let all = std::mem::take(&mut eye.corners);
    eye.corners = some_of(&all, LEAST);
    // What is made at a first glance is no part of a path's time.
    let Some(glance) = eye.look(engine, request, 1, &|_| {})? else {
        return Ok(None);
    };
    let pixels = f64::from(request.width) * f64::from(request.height);
    let per_path = |seen: &BlocksSeen| seen.took.seconds / seen.counters.paths.max(1) as f64;
    // A short time leaves few blocks to look at.
    let blocks = match budget {
        Budget::Seconds(seconds) => {
            let left = (seconds - begun.elapsed().as_secs_f64()).max(0.0);
            let paths = FIRST_LOOKING * left / per_path(&glance);
            (paths / f64::from(FIRST.0 * BLOCK * BLOCK)) as usize
        }
        Budget::Error(_) | Budget::DeltaE(_) => FIRST.1,
    };
    eye.corners = some_of(&all, blocks.clamp(LEAST, FIRST.1));
    let Some(mut seen) = eye.look(engine, request, FIRST.0, &|_| {})? else {
        return Ok(None);
    };
    // A longer look where there is time for it.
    let time = match budget {
        Budget::Seconds(seconds) => seconds,
        Budget::Error(error) => {
            let one = noise_of_one(&seen);
            pixels * per_path(&seen) * (one / error).powi(2)
        }
        Budget::DeltaE(_) => return Ok(None),
    };
    // Noise is known from many paths of few blocks, what is left out from many blocks.
    let paths = LOOKING * time / per_path(&seen) / f64::from(BLOCK * BLOCK);
    let blocks =
        (paths / f64::from(MOST_SPP)).clamp(FEWEST.min(all.len() as f64), all.len() as f64);
    let spp = (paths / blocks).min(f64::from(MOST_SPP)) as u32;
    if spp > FIRST.0 {
        let step = (all.len() as f64 / blocks) as usize;
        eye.corners = all.into_iter().step_by(step.max(1)).collect();
        if let Some(longer) = eye.look(engine, request, spp, &|_| {})? {
            seen = longer;
        }
    }
    let plan = renderer.plan(request, Subject::Cloth)?;
    let asked = plan.render.max_order;
    let model = Model {
        noise: noise_of_one(&seen),
        seconds: pixels * per_path(&seen),
        seen: &seen,
    };
    let fixed = begun.elapsed().as_secs_f64() + engine::finishing_seconds(request);
    let orders = match plan.on(Effect::Multiple) {
        true => (0..16).map(|power| 1 << power).collect(),
        false => Vec::new(),
    };
    let orders = orders.into_iter().filter(|order| *order < asked);
    let promises = (orders.chain([asked])).filter_map(|order| model.promise(order, budget, fixed));
    let better = |one: &Promise, other: &Promise| match budget {
        Budget::Seconds(_) => one.error.total_cmp(&other.error),
        Budget::Error(_) | Budget::DeltaE(_) => one.seconds.total_cmp(&other.seconds),
    };
    // The last one, all orders, can always be promised.
    let Some(promise) = promises.min_by(better) else {
        return Ok(None);
    };
    let mut settled = request.clone();
    if promise.order < asked {
        settled.settings.render.max_order = promise.order;
    }
    settled.stop = Stop::within(budget, promise.bias);
    Ok(Some((settled, promise)))
}

/// Noise of a picture of one path a pixel.
fn noise_of_one(seen: &BlocksSeen) -> f64 {
    let error = film::estimate(&seen.film).error;
    let error = if error.is_finite() { error } else { 1.0 };
    error * f64::from(seen.film.spp()).sqrt()
}

/// What one look says of the picture.
struct Model<'s> {
    /// Noise of one path a pixel.
    noise: f64,
    /// Seconds of one path a pixel, of all orders.
    seconds: f64,
    seen: &'s BlocksSeen,
}

impl Model<'_> {
    /// What is wrong where light is followed for so many scatterings: root mean square of the
    /// blocks' relative light.
    fn bias(&self, order: u32) -> f64 {
        let blocks = self.seen.light.iter();
        let (beyond, light): (Vec<f64>, Vec<f64>) = blocks
            .map(|block| (block.beyond(order), block.mean()))
            .unzip();
        let shares = relative(&beyond, &light);
        common(&shares, &shares)
    }

    /// What the picture comes to; `None` where it cannot be within the budget.
    fn promise(&self, order: u32, budget: Budget, fixed: f64) -> Option<Promise> {
        let bias = self.bias(order);
        let one = self.seconds * self.seen.flights_up_to(order);
        let spp = match budget {
            Budget::Seconds(seconds) => (seconds - fixed) / one,
            Budget::Error(error) => {
                let noise = error * error - bias * bias;
                if noise <= 0.0 {
                    return None;
                }
                self.noise * self.noise / noise
            }
            Budget::DeltaE(_) => return None,
        };
        let spp = spp.clamp(1.0, MOST_PATHS);
        Some(Promise {
            seconds: fixed + spp * one,
            error: (bias * bias + self.noise * self.noise / spp).sqrt(),
            bias,
            spp: spp.round() as u32,
            order,
        })
    }
}
