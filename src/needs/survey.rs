//! Looks at every effect of a picture, with it and without: what it changes, what it costs.

use std::sync::Arc;

use super::block_change::{DARK, common, upper_percentile};
use super::pair::{Pair, Pairing};
use super::settling::{BLOCKS, Eye, Need, Needs, settle_by};
use crate::design::Design;
use crate::engine::{Engine, Renderer, StillError, StillRequest};
use crate::exemplar::ExemplarStore;
use crate::job::Job;
use crate::plan::{Decider, Effect, Subject};
use crate::render::BlocksSeen;

/// How closely a picture is looked at.
#[derive(Clone, Copy)]
struct Closeness {
    /// Blocks, at most.
    blocks: usize,
    /// Paths a pixel of each of two looks.
    spp: u32,
}

const CLOSE: Closeness = Closeness {
    blocks: BLOCKS as usize,
    spp: 12,
};
/// For somebody who waits: as few blocks as percentiles can be told of.
const QUICK: Closeness = Closeness { blocks: 64, spp: 5 };

/// What a picture of a design calls for, settled as [`settle`](super::settle) does, and what
/// each effect that is on changes and costs. Times are of this machine now.
///
/// # Errors
/// When the request is not usable or the job is cancelled.
pub fn survey(
    design: &Arc<Design>,
    renderer: &Renderer,
    request: &StillRequest,
    tolerance: f64,
    store: &ExemplarStore,
    job: &Job,
) -> Result<(StillRequest, Needs), StillError> {
    let asked = (request, tolerance, CLOSE);
    surveyed(design, renderer, asked, (store, job), None)
}

/// As [`survey`], of fewer places and quicker, with a small picture of each effect that is on,
/// and one without it.
///
/// # Errors
/// As [`survey`].
pub fn survey_in_pictures(
    design: &Arc<Design>,
    renderer: &Renderer,
    request: &StillRequest,
    tolerance: f64,
    store: &ExemplarStore,
    job: &Job,
) -> Result<(StillRequest, Needs, Vec<Pair>), StillError> {
    let mut pairs = Vec::new();
    let (asked, keep) = ((request, tolerance, QUICK), Some(&mut pairs));
    let (settled, needs) = surveyed(design, renderer, asked, (store, job), keep)?;
    Ok((settled, needs, pairs))
}

/// Surveys, and keeps pictures where that is asked for.
fn surveyed(
    design: &Arc<Design>,
    renderer: &Renderer,
    (request, tolerance, closeness): (&StillRequest, f64, Closeness),
    (store, job): (&ExemplarStore, &Job),
    mut keep: Option<&mut Vec<Pair>>,
) -> Result<(StillRequest, Needs), StillError> {
    let begun = std::time::Instant::now();
    let quiet = &job.clone().with_listener(|_, _| {});
    job.report("making the cloth", 0.0);
    let design = &crate::engine::coloured(design, request)?;
    let engine = renderer.engine(design, request, store, quiet)?;
    job.report("looking at the light", 0.1);
    let eye = Eye::new(renderer, request, quiet)?.at_most(closeness.blocks);
    let (settled, mut needs) = settle_by(&eye, &*engine, design, request, tolerance)?;
    let plan = renderer.plan(request, Subject::Cloth)?;
    let mut surveying = Surveying {
        eye,
        spp: closeness.spp,
        request,
        with: None,
    };
    let mut pairing = Pairing::new(renderer, design, request, quiet);
    let count = needs.effects.len() as f32;
    for (number, need) in needs.effects.iter_mut().enumerate() {
        // What there is nothing of, and what somebody left out, has nothing to be looked at.
        if !plan.on(need.effect) || need.bound == Some(0.0) {
            continue;
        }
        job.report(
            &format!("without {}", need.effect),
            0.2 + 0.8 * number as f32 / count,
        );
        let mut without = request.clone();
        without.effects.switch(need.effect, Some(false));
        let same = renderer.plan(&without, Subject::Cloth)?.cloth == plan.cloth;
        let other = match same {
            true => None,
            false => Some(renderer.engine(design, &without, store, quiet)?),
        };
        let other = other.as_deref().unwrap_or(&*engine);
        let engines = (&*engine, other);
        surveying.tell(need, engines, &without)?;
        if let Some(pairs) = &mut keep {
            pairs.push(pairing.take(need.effect, engines, &without)?);
        }
    }
    needs.seconds = begun.elapsed().as_secs_f64();
    Ok((settled, needs))
}

/// Two looks at the same blocks, with other paths each.
type Looks = [BlocksSeen; 2];

struct Surveying<'s> {
    eye: Eye<'s>,
    /// Paths a pixel of each look.
    spp: u32,
    request: &'s StillRequest,
    /// The picture as it is asked for, once it was looked at.
    with: Option<Looks>,
}

impl Surveying<'_> {
    fn looks(
        &self,
        engine: &dyn Engine,
        request: &StillRequest,
    ) -> Result<Option<Looks>, StillError> {
        // What is made at the first look is no part of its time.
        if self.eye.look(engine, request, 1, &|_| {})?.is_none() {
            return Ok(None);
        }
        let look = |other_paths: u64| {
            self.eye.look(engine, request, self.spp, &|shot| {
                shot.plan.render.seed = shot.plan.render.seed.wrapping_add(other_paths);
            })
        };
        let (one, other) = (look(1)?, look(2)?);
        Ok(one.zip(other).map(|(one, other)| [one, other]))
    }

    /// What leaving an effect out changes and saves.
    fn tell(
        &mut self,
        need: &mut Need,
        (engine, other): (&dyn Engine, &dyn Engine),
        without: &StillRequest,
    ) -> Result<(), StillError> {
        if self.with.is_none() {
            self.with = self.looks(engine, self.request)?;
        }
        let without = self.looks(other, without)?;
        let (Some(with), Some(without)) = (&self.with, &without) else {
            return Ok(());
        };
        let light: Vec<f64> = (with[0].light.iter().zip(&with[1].light))
            .map(|(one, other)| 0.5 * (one.mean() + other.mean()))
            .collect();
        let change = |at: usize| -> Vec<f64> {
            let both = without[at].light.iter().zip(&with[at].light);
            both.zip(&light)
                .map(|((without, with), light)| (without.mean() - with.mean()) / (light + DARK))
                .collect()
        };
        let (one, other) = (change(0), change(1));
        let change = common(&one, &other);
        need.change = Some(change);
        let apart: Vec<f64> = (one.iter().zip(&other))
            .map(|(one, other)| 0.5 * (one - other))
            .collect();
        need.noise = Some(common(&apart, &apart));
        let [with, without] = [work(with), work(without)];
        let saved = |without: f64, with: f64| 1.0 - without / with.max(1e-9);
        need.cost = Some(saved(without[0], with[0]));
        need.cost_interval = Some([saved(without[1], with[0]), saved(without[0], with[1])]);
        if need.bound.is_none() {
            let both: Vec<f64> = (one.iter().zip(&other))
                .map(|(one, other)| (0.5 * (one + other)).abs())
                .collect();
            let bound = upper_percentile(&both);
            need.bound = Some(bound);
            if need.by == Decider::Scene {
                let changes = need.changes().unwrap_or_default();
                need.why = format!("{}: {changes}", lacking(need.effect));
            }
        }
        Ok(())
    }
}

/// What two looks took, the shorter one first: seconds of processors where the system tells
/// them, as other programs have no share in these.
fn work(looks: &Looks) -> [f64; 2] {
    let of = |seen: &BlocksSeen| seen.took.processor_seconds.unwrap_or(seen.took.seconds);
    let [one, other] = [of(&looks[0]), of(&looks[1])];
    [one.min(other), one.max(other)]
}

/// What a picture is like without an effect.
fn lacking(effect: Effect) -> &'static str {
    match effect {
        Effect::Shadows => "without them places are lit alike, and too bright",
        Effect::Hairs => "without them the faces are bare",
        Effect::EdgeFixing => "without it yarns break at the borders of crossings",
        Effect::Randomisation => "without it every repeat looks the same",
        Effect::Tap => "without it voxels show as steps",
        Effect::Multiple | Effect::Sky => "without it there is less light",
    }
}
