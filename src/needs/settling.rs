//! Leaves out what changes hardly anything, before the picture is traced.

use super::block_change::{relative, upper_percentile};
use crate::cloth::HairLayer;
use crate::design::Design;
use crate::engine::{Engine, Renderer, Shot, StillError, StillRequest};
use crate::job::Job;
use crate::plan::{Decider, Effect, Found, Plan, Subject};
use crate::random::Random;
use crate::render::{BLOCK, BlocksSeen};
use crate::scene::light::{LightRig, Sky};

/// Blocks that are looked at, at most.
pub(super) const BLOCKS: u32 = 192;
/// Paths a pixel of a look.
const SPP: u32 = 16;
/// Shares of the work that differ by no more are told as one.
const HARDLY: f64 = 0.02;
/// Changes below this share of a look's noise are not told apart from it.
const HIDDEN: f64 = 0.5;

/// Changes by more than this share of their light are not told in numbers.
const ALTOGETHER: f64 = 1.0;

/// What was found out about one effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Need {
    /// The effect.
    pub effect: Effect,
    /// Whether it is simulated.
    pub on: bool,
    /// Who decided.
    pub by: Decider,
    /// Why, in a designer's words.
    pub why: String,
    /// What leaving it out changes at most of 95 of 100 blocks, relative to their light; of
    /// an effect that is on and only partly left out, what that changes. `None` where it was not
    /// looked at.
    pub bound: Option<f64>,
    /// What leaving it out changes, root mean square over the blocks, free of noise; `None` where
    /// it was not looked at.
    pub change: Option<f64>,
    /// What two looks at the same places do not agree in, root mean square: changes far below
    /// it are not seen. `None` where it was not looked at twice.
    pub noise: Option<f64>,
    /// Share of the tracing that it takes; of what is left out, that it would take.
    pub cost: Option<f64>,
    /// The least and the most that it was, look by look; `None` where it follows from counts.
    pub cost_interval: Option<[f64; 2]>,
}

impl Need {
    /// How far the looks differed in what it costs, in words to stand behind that share; nothing
    /// where they hardly did.
    pub fn cost_range(&self) -> String {
        let [low, high] = self.cost_interval.unwrap_or_default();
        match high - low > HARDLY {
            true => format!(" ({:.0} to {:.0})", 100.0 * low.max(0.0), 100.0 * high),
            false => String::new(),
        }
    }

    /// What leaving it out changes, in words; `None` where it was not looked at.
    pub fn changes(&self) -> Option<String> {
        let (change, bound) = (self.change?, self.bound?);
        let hidden = self.noise.filter(|noise| change < HIDDEN * noise);
        Some(match hidden {
            Some(noise) => format!(
                "a place changes by less than the noise of this look, {}",
                at_most(noise)
            ),
            None if change > ALTOGETHER => "most places change altogether".to_owned(),
            None => format!(
                "a place typically changes by {}, 95 of 100 by {} at most",
                at_most(change),
                at_most(bound)
            ),
        })
    }
}

/// What a picture calls for.
#[derive(Debug, Clone, PartialEq)]
pub struct Needs {
    /// Of each effect that the picture can have.
    pub effects: Vec<Need>,
    /// Blocks that were looked at.
    pub blocks: usize,
    /// The largest change that was allowed.
    pub tolerance: f64,
    /// What all that is left out changes together at most of 95 of 100 blocks.
    pub left_out: f64,
    /// Share of the tracing that is saved.
    pub saved: f64,
    /// Seconds that looking took.
    pub seconds: f64,
}

/// Looks at blocks of a picture.
pub(super) struct Eye<'e> {
    pub renderer: &'e Renderer,
    pub corners: Vec<[u32; 2]>,
    pub job: &'e Job,
    /// The light, read once.
    lights: LightRig,
}

impl<'e> Eye<'e> {
    /// An eye for pictures like `request`, whatever is left out of them.
    pub fn new(
        renderer: &'e Renderer,
        request: &StillRequest,
        job: &'e Job,
    ) -> Result<Self, StillError> {
        let plan = renderer.plan(request, Subject::Cloth)?;
        Ok(Self {
            renderer,
            corners: corners(request.width, request.height),
            job,
            lights: Shot::new(request, plan)?.lights,
        })
    }

    /// The same with so many blocks at most, still from all over the picture.
    pub fn at_most(mut self, blocks: usize) -> Self {
        self.corners = some_of(&self.corners, blocks);
        self
    }

    /// What a plan of a picture comes to; `None` where the engine follows no paths. `alter` may
    /// change the shot.
    pub fn look(
        &self,
        engine: &dyn Engine,
        request: &StillRequest,
        spp: u32,
        alter: &dyn Fn(&mut Shot<'_>),
    ) -> Result<Option<BlocksSeen>, StillError> {
        let plan = self.renderer.plan(request, Subject::Cloth)?;
        let mut shot = Shot {
            request,
            lights: self.lights.clone(),
            plan,
        };
        alter(&mut shot);
        engine.look_at(&shot, &self.corners, spp, self.job)
    }
}

/// Every so many of blocks, so that there are no more than `most`.
pub(super) fn some_of(corners: &[[u32; 2]], most: usize) -> Vec<[u32; 2]> {
    let step = corners.len().div_ceil(most.max(1)).max(1);
    corners.iter().copied().step_by(step).collect()
}

/// Upper left corners of blocks scattered over a picture: one at random in each of up to
/// [`BLOCKS`] equal parts of it.
pub(super) fn corners(width: u32, height: u32) -> Vec<[u32; 2]> {
    let [across, down] = [width, height].map(|pixels| pixels.div_ceil(BLOCK).max(1));
    let shape = f64::from(across) / f64::from(down);
    let columns = (f64::from(BLOCKS) * shape).sqrt().round().max(1.0);
    let columns = (columns as u32).clamp(1, across.min(BLOCKS));
    let rows = (BLOCKS / columns).clamp(1, down);
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
    places
        .map(|[column, row]| {
            let mut random = Random::new(u64::from(row), u64::from(column), 0);
            let within = |part: u32, parts: u32, blocks: u32, u: f32| {
                let [from, to] = [part, part + 1].map(|part| part * blocks / parts);
                BLOCK * (from + ((to - from) as f32 * u) as u32).min(to - 1)
            };
            let [u, v] = random.pair();
            [
                within(column, columns, across, u),
                within(row, rows, down, v),
            ]
        })
        .collect()
}

/// Settles what a picture of `request` leaves out, where whoever asks for it says nothing: no
/// more than changes 95 of 100 blocks by less than `tolerance`, relative to their light.
/// `engine` is ready for the request; what comes back needs no other, and has the same light.
///
/// # Errors
/// When the request is not usable or the job is cancelled.
pub fn settle(
    engine: &dyn Engine,
    renderer: &Renderer,
    design: &Design,
    request: &StillRequest,
    tolerance: f64,
    job: &Job,
) -> Result<(StillRequest, Needs), StillError> {
    let eye = Eye::new(renderer, request, job)?;
    settle_by(&eye, engine, design, request, tolerance)
}

/// As [`settle`], by the blocks that an eye looks at.
pub(super) fn settle_by(
    eye: &Eye<'_>,
    engine: &dyn Engine,
    design: &Design,
    request: &StillRequest,
    tolerance: f64,
) -> Result<(StillRequest, Needs), StillError> {
    let begun = std::time::Instant::now();
    let mut settled = request.clone();
    settled.effects.found.clear();
    let plan = eye.renderer.plan(&settled, Subject::Cloth)?;
    let mut settling = Settling {
        needs: planned(&plan),
        tolerance: tolerance.max(0.0),
        light: Vec::new(),
        out: Vec::new(),
    };
    let lights = Shot::new(request, plan.clone())?.lights;
    if !HairLayer::hairy(design.yarns()).contains(&true) {
        settling.nothing(Effect::Hairs, "no yarn of this design has hairs");
    }
    if matches!(lights.sky, Sky::Dark) {
        settling.nothing(Effect::Sky, "this light has no sky");
    }
    let mut saved = 0.0;
    if tolerance > 0.0
        && let Some(seen) = eye.look(engine, &settled, SPP, &|_| {})?
    {
        settling.see(&seen);
        if settling.is_open(Effect::Sky)
            && let Some(alone) =
                eye.look(engine, &settled, SPP, &|shot| shot.lights.suns.clear())?
        {
            settling.sky(&alone);
        }
        let asked = plan.render.max_order;
        if settling.is_open(Effect::Multiple) && asked > 1 {
            let followed = settling.follow(&seen, asked);
            saved = 1.0 - seen.flights_up_to(followed);
            if followed > 1 {
                settled.settings.render.max_order = followed;
            }
        }
    }
    let needs = Needs {
        blocks: settling.light.len(),
        tolerance,
        left_out: settling.bound(None),
        saved,
        seconds: begun.elapsed().as_secs_f64(),
        effects: settling.needs,
    };
    let by_scene = (needs.effects.iter()).filter(|need| need.by == Decider::Scene);
    settled.effects.found = by_scene
        .map(|need| Found {
            effect: need.effect,
            on: need.on,
            why: need.why.clone(),
        })
        .collect();
    Ok((settled, needs))
}

/// The effects of a plan, before anything is looked at.
fn planned(plan: &Plan) -> Vec<Need> {
    let needs = plan.effects.iter().map(|planned| Need {
        effect: planned.effect,
        on: planned.on,
        by: planned.by,
        why: planned.why.clone().into_owned(),
        bound: None,
        change: None,
        noise: None,
        cost: None,
        cost_interval: None,
    });
    needs.collect()
}

/// What is being settled.
struct Settling {
    needs: Vec<Need>,
    tolerance: f64,
    /// Mean luminance of each block.
    light: Vec<f64>,
    /// What of that is left out so far.
    out: Vec<f64>,
}

impl Settling {
    /// The need of an effect that is on, and nobody's wish.
    fn open(&mut self, effect: Effect) -> Option<&mut Need> {
        let open = |need: &&mut Need| need.effect == effect && need.on && need.by == Decider::Scene;
        self.needs.iter_mut().find(open)
    }

    fn is_open(&mut self, effect: Effect) -> bool {
        self.open(effect).is_some()
    }

    /// There is nothing of an effect here.
    fn nothing(&mut self, effect: Effect, why: &str) {
        if let Some(need) = self.open(effect) {
            (need.on, need.why) = (false, why.to_owned());
            need.bound = Some(0.0);
        }
    }

    fn see(&mut self, seen: &BlocksSeen) {
        self.light = seen.light.iter().map(|block| block.mean()).collect();
        self.out = vec![0.0; self.light.len()];
    }

    /// What is left out at most of 95 of 100 blocks, with `parts` of them as well.
    fn bound(&self, parts: Option<&[f64]>) -> f64 {
        let with = |block: usize| self.out[block] + parts.map_or(0.0, |parts| parts[block]);
        let out: Vec<f64> = (0..self.out.len()).map(with).collect();
        match out.is_empty() {
            true => 0.0,
            false => upper_percentile(&relative(&out, &self.light)),
        }
    }

    fn take_out(&mut self, parts: &[f64]) {
        let out = self.out.iter_mut().zip(parts);
        out.for_each(|(out, part)| *out += part);
    }

    /// Whether the sky is left out; `alone` is what it brings.
    fn sky(&mut self, alone: &BlocksSeen) {
        let parts: Vec<f64> = alone.light.iter().map(|block| block.mean()).collect();
        let own = upper_percentile(&relative(&parts, &self.light));
        let out = self.bound(Some(&parts)) <= self.tolerance;
        if let Some(need) = self.open(Effect::Sky) {
            need.on = !out;
            need.bound = Some(own);
            need.why = match out {
                true => format!(
                    "light from all round is at most {} of this picture",
                    at_most(own)
                ),
                false => format!("it is up to {} of this picture", at_most(own)),
            };
        }
        if out {
            self.take_out(&parts);
        }
    }

    /// For how many scatterings light is followed, of those that are `asked` for.
    fn follow(&mut self, seen: &BlocksSeen, asked: u32) -> u32 {
        let beyond = |order| -> Vec<f64> {
            let blocks = seen.light.iter();
            blocks.map(|block| block.beyond(order)).collect()
        };
        let will_do = |order| self.bound(Some(&beyond(order))) <= self.tolerance;
        let followed = least(asked, will_do);
        let parts = beyond(followed);
        let own = upper_percentile(&relative(&parts, &self.light));
        let single = upper_percentile(&relative(&beyond(1), &self.light));
        if let Some(need) = self.open(Effect::Multiple) {
            need.on = followed > 1;
            need.cost = Some(1.0 - seen.flights_up_to(1));
            need.bound = Some(if followed < asked { own } else { single });
            need.why = match followed {
                1 => format!(
                    "what is scattered more than once is at most {} of this picture",
                    at_most(own)
                ),
                _ if followed < asked => format!(
                    "what is scattered more than once is up to {} of this picture; it is followed for {followed} scatterings, and what comes later is at most {}",
                    at_most(single),
                    at_most(own)
                ),
                _ => format!(
                    "what is scattered more than once is up to {} of this picture",
                    at_most(single)
                ),
            };
        }
        if followed < asked {
            self.take_out(&parts);
        }
        followed
    }
}

/// A share that is not exceeded, in words.
pub fn at_most(share: f64) -> String {
    match share {
        share if share < 1e-3 => "under 0.1 %".to_owned(),
        share if share < 0.0995 => format!("{:.1} %", 100.0 * share),
        share if share < 2.0 => format!("{:.0} %", 100.0 * share),
        share => format!("{share:.0} times its light"),
    }
}

/// The least order from 1 on that will do; more are as good.
fn least(most: u32, will_do: impl Fn(u32) -> bool) -> u32 {
    let (mut low, mut high) = (1, most);
    while low < high {
        let middle = low + (high - low) / 2;
        match will_do(middle) {
            true => high = middle,
            false => low = middle + 1,
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_lie_in_the_picture_each_in_a_part_of_its_own() {
        for (width, height) in [(1280, 720), (64, 48), (1, 1), (16_384, 8), (9, 1000)] {
            let corners = corners(width, height);
            assert!(!corners.is_empty() && corners.len() <= BLOCKS as usize);
            let mut seen = corners.clone();
            seen.sort_unstable();
            seen.dedup();
            assert_eq!(seen.len(), corners.len(), "{width} × {height}");
            assert!(corners.iter().all(|[x, y]| *x < width && *y < height));
        }
        let wide = corners(1280, 720);
        assert!(wide.len() > 150, "{}", wide.len());
        let right = wide.iter().filter(|[x, _]| *x >= 640).count();
        assert!(
            right.abs_diff(wide.len() / 2) < 20,
            "{right} of {}",
            wide.len()
        );
    }

    #[test]
    fn the_least_order_that_will_do_is_found() {
        for wanted in [1, 2, 17, 255, 256] {
            assert_eq!(least(256, |order| order >= wanted), wanted);
        }
        assert_eq!(least(1, |_| false), 1);
    }
}
