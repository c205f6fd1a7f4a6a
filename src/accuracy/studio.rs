//! Takes pictures of a small piece of the cloth at the picture's own scale, as often as asked.

use std::sync::Arc;

use super::AccuracyError;
use super::axis::Asked;
use super::difference::Pixels;
use super::seen::Shown;
use crate::clock::{Clock, Took};
use crate::cloth::ClothSettings;
use crate::design::Design;
use crate::engine::{self, Engine, Shot, StillRequest};
use crate::exemplar::ExemplarStore;
use crate::film::Tone;
use crate::formats::png::{self, Metadata};
use crate::job::Job;
use crate::plan::Subject;

/// Pixels of the piece, at most.
const PIECE: [u32; 2] = [160, 120];

/// A place where pictures are taken again and again: what is made ready for one stays so for
/// those with the same cloth.
pub struct Studio<'d> {
    design: Arc<Design>,
    store: &'d ExemplarStore,
    ready: Vec<(Key, Box<dyn Engine>)>,
}

/// What an engine was made ready for.
type Key = (&'static str, ClothSettings);

/// A picture that was taken.
pub struct Take {
    /// Premultiplied linear RGB as traced.
    pub traced: Pixels,
    /// The same denoised, where that is asked for.
    pub clean: Option<Pixels>,
    /// Cover of each pixel.
    pub alpha: Vec<f32>,
    /// What the picture took.
    pub took: Took,
    /// The part of it before anything is traced, however many pixels and paths there are.
    pub before: Took,
    /// What bringing it to what is shown took: denoising.
    pub developing: Took,
    /// What encoding it took.
    pub encoding: Took,
}

/// What a picture is taken with.
#[derive(Debug, Clone, Copy)]
pub struct Exposing {
    /// Names the paths.
    pub seed: u64,
    /// Paths a pixel.
    pub spp: u32,
}

/// The piece of a picture that is looked at: its middle, at its own scale.
pub fn piece(design: &Design, request: &StillRequest) -> StillRequest {
    engine::middle(design, request, PIECE)
}

impl<'d> Studio<'d> {
    /// A studio for a design.
    pub fn new(design: Arc<Design>, store: &'d ExemplarStore) -> Self {
        Self {
            design,
            store,
            ready: Vec::new(),
        }
    }

    /// Makes ready what a picture is taken of, if it is not.
    ///
    /// # Errors
    /// When there is no cloth, or the job is cancelled.
    pub fn prepare(&mut self, asked: &Asked, job: &Job) -> Result<(), AccuracyError> {
        let key = Self::key(asked)?;
        if !self.ready.iter().any(|(ready, _)| *ready == key) {
            let request = piece(&self.design, &asked.request);
            let engine = (asked.renderer).engine(&self.design, &request, self.store, job)?;
            self.ready.push((key, engine));
        }
        Ok(())
    }

    /// Forgets all but what `asked` is taken of.
    pub fn clear_but(&mut self, asked: &Asked) {
        let key = Self::key(asked).ok();
        self.ready.retain(|(ready, _)| Some(ready) == key.as_ref());
    }

    fn key(asked: &Asked) -> Result<Key, AccuracyError> {
        let plan = asked.renderer.plan(&asked.request, Subject::Cloth)?;
        Ok((asked.renderer.name, plan.cloth))
    }

    /// Takes a picture of the piece of `asked`.
    ///
    /// # Errors
    /// When there is no picture, or the job is cancelled.
    pub fn take(
        &mut self,
        asked: &Asked,
        exposing: Exposing,
        job: &Job,
    ) -> Result<Take, AccuracyError> {
        self.prepare(asked, job)?;
        let key = Self::key(asked)?;
        let request = piece(&self.design, &asked.request);
        let mut plan = asked.renderer.plan(&request, Subject::Cloth)?;
        plan.render.seed = exposing.seed;
        plan.render.spp = exposing.spp;
        let shot = Shot::new(&request, plan)?;
        let ready = self.ready.iter().find(|(ready, _)| *ready == key);
        let Some((_, engine)) = ready else {
            // It was made ready above.
            return Err(AccuracyError::Idle("renderer"));
        };
        let design = engine::coloured(&self.design, &request)?;
        let begun = Clock::now();
        let still = engine::draw(&**engine, &design, &shot, job, &mut |_| {})?;
        let took = begun.took();
        // One thread's work.
        let seconds = (took.seconds - still.report.stage("render")).max(0.0);
        let before = Took {
            seconds,
            processor_seconds: (took.processor_seconds).map(|worked| worked.min(seconds)),
        };
        let begun = Clock::now();
        let clean = still.clean(job);
        let developing = begun.took();
        job.check()?;
        let picture = still.picture();
        let begun = Clock::now();
        let depth = shot.plan.showing.png_depth;
        png::encode(&picture, depth, &Metadata::default())?;
        let encoding = begun.took();
        Ok(Take {
            traced: still.film.means(),
            clean,
            alpha: still
                .film
                .pixels()
                .iter()
                .map(|pixel| pixel.alpha())
                .collect(),
            took,
            before,
            developing,
            encoding,
        })
    }
}

impl Take {
    /// What is shown of it.
    pub fn shown_pixels(&self) -> &Pixels {
        self.clean.as_ref().unwrap_or(&self.traced)
    }
}

/// Pictures of one setting, with one seed each.
#[derive(Default)]
pub struct Takes(pub Vec<Take>);

impl Takes {
    /// As traced.
    pub fn traced(&self) -> Vec<Pixels> {
        self.0.iter().map(|take| take.traced.clone()).collect()
    }

    /// As shown.
    pub fn clean(&self) -> Vec<Pixels> {
        self.0
            .iter()
            .map(|take| take.shown_pixels().clone())
            .collect()
    }

    /// The picture of `pixels` with these takes' mean cover.
    pub fn shown(&self, width: usize, pixels: &Pixels, tone: Tone) -> Shown {
        let scale = 1.0 / self.0.len().max(1) as f32;
        let alpha: Vec<f32> = (0..pixels.len())
            .map(|at| self.0.iter().map(|take| take.alpha[at]).sum::<f32>() * scale)
            .collect();
        Shown::new(width, pixels, &alpha, tone)
    }
}
