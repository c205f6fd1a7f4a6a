//! The threads that draw the cloth: latest request wins, every send wakes the window.
//!
//! One thread draws. A request first shows the cloth at first sight, within milliseconds
//! and never interrupted, so that an edit or a drag always shows something; tracing, coarse
//! at first, then adds to it what it knows better (`drawing`), until the picture is as good
//! as the person wants it, and waits while nobody sees the window. A newer request ends the
//! older one. The cloth follows edits; where its exemplars are not at hand yet, a coarse cloth
//! is drawn and a second thread builds them meanwhile (`cloths`). All of it gives way to the
//! window (`threads`). Dropping the worker ends all.

mod cloths;
mod drawing;
#[cfg(test)]
mod never_worse;
#[cfg(test)]
mod stalls;
mod threads;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use pickglass::design::{Design, WeavePattern};
use pickglass::engine::{SightTables, StillError, StillRequest, Stop, usual_width_mm};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::{Cancelled, Job};

use cloths::{Builder, Kept, cloth_of, first_sight_serves};
use drawing::{Drawing, OnScreen, PATIENCE};

/// What a picture is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Aim {
    /// The pane.
    #[default]
    Pane,
    /// The pick glass over it.
    Glass,
}

/// A picture that the window wants to see refine.
#[derive(Clone)]
pub struct PreviewRequest {
    pub generation: u64,
    pub aim: Aim,
    pub design: Arc<Design>,
    /// The design's drawdown.
    pub drawdown: Arc<WeavePattern>,
    /// At full size, with `centre_mm` and `width_mm` given.
    pub still: StillRequest,
    pub quality: Quality,
    /// Nothing is on the screen: whatever was sent before is to be shown anew.
    pub blank: bool,
}

impl PreviewRequest {
    /// Whether both look at the same prepared cloth.
    fn same_cloth(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.design, &other.design)
            && Arc::ptr_eq(&self.drawdown, &other.drawdown)
            && self.still.colourway == other.still.colourway
            && self.same_settings(other)
    }

    /// Whether the cloth of one may follow to that of the other.
    fn same_settings(&self, other: &Self) -> bool {
        self.still.seed == other.still.seed
            && self.still.settings == other.still.settings
            && self.still.effects == other.still.effects
    }
}

/// The exemplars that a picture is drawn from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fibres {
    Full,
    Coarse {
        /// How far their light is off the full ones', where it was measured.
        light_error: Option<f32>,
    },
}

/// A picture so far, with what it shows.
pub struct Picture {
    pub generation: u64,
    pub image: egui::ColorImage,
    pub still: StillRequest,
    pub spp: u32,
    pub seconds: f64,
    pub error: Option<f64>,
    /// The size of the request, not of a coarser level.
    pub full_size: bool,
    pub fibres: Fibres,
}

/// Until when a picture is refined.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum Quality {
    /// Good enough to go on designing.
    Draft,
    #[default]
    Good,
    /// To look at closely.
    Fine,
}

impl Quality {
    /// All, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::Draft, Self::Good, Self::Fine];

    /// The error, before denoising, at which a picture is done.
    pub fn error(self) -> f64 {
        match self {
            Self::Draft => 0.05,
            Self::Good => 0.02,
            Self::Fine => 0.01,
        }
    }

    /// How good that is, in words.
    pub fn says(self) -> String {
        format!("{}: error {:.0} %", self.name(), 100.0 * self.error())
    }

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Good => "good",
            Self::Fine => "fine",
        }
    }
}

/// A picture is refined at most this long, seconds.
pub const LONGEST: f64 = 300.0;

/// Why a picture is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Done {
    /// It is as good as was asked for.
    Good,
    /// It was refined as long as any is.
    Long,
    /// First sight stands until the exemplars are built.
    Waiting,
}

/// What the worker is at.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Phase {
    #[default]
    Idle,
    /// Builds what the first picture needs.
    Preparing,
    Refining,
    /// Refining has ended.
    Done(Done),
    /// First sight, and no more: why the view is not traced.
    AtSight(String),
    /// Cancelled by the person.
    Stopped,
    Failed(String),
}

/// How far the building of exemplars is.
#[derive(Debug, Clone, PartialEq)]
pub struct Building {
    pub stage: String,
    pub fraction: f32,
}

/// The request at work.
struct Current {
    job: Job,
    /// A newer request waits: first sight is being drawn.
    shielded: bool,
}

#[derive(Default)]
struct Shared {
    next: Option<PreviewRequest>,
    current: Option<Current>,
    /// The newest request that was begun.
    last: Option<PreviewRequest>,
    picture: Option<Picture>,
    /// The newest picture for the pick glass.
    glass: Option<Picture>,
    phase: Phase,
    building: Option<Building>,
    /// The full cloth that is being built.
    builder: Option<Builder>,
    full: Option<Kept>,
    /// Why the full cloth cannot be built.
    failure: Option<String>,
    /// Nobody sees the window.
    hidden: bool,
    closing: bool,
}

impl Shared {
    /// Ends the drawing, except of a first sight.
    fn supersede(&mut self) {
        if let Some(current) = &self.current
            && !current.shielded
        {
            current.job.cancel();
        }
    }

    /// Ends all work.
    fn cancel_all(&mut self) {
        if let Some(current) = &self.current {
            current.job.cancel();
        }
        if let Some(builder) = self.builder.take() {
            builder.job.cancel();
            self.building = None;
        }
    }
}

/// What the window and the threads that draw leave for each other.
struct Mailbox {
    shared: Mutex<Shared>,
    changed: Condvar,
    wake: Box<dyn Fn() + Send + Sync>,
    store: ExemplarStore,
}

impl Mailbox {
    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until something of it has changed.
    fn wait<'d>(&'d self, shared: MutexGuard<'d, Shared>) -> MutexGuard<'d, Shared> {
        (self.changed.wait(shared)).unwrap_or_else(PoisonError::into_inner)
    }

    fn set_phase(&self, phase: Phase) {
        self.lock().phase = phase;
        (self.wake)();
    }
}

/// The worker's handle. Dropping it cancels the work.
pub struct ClothWorker {
    mailbox: Arc<Mailbox>,
}

impl ClothWorker {
    /// Starts the thread; `wake` is called after everything it sends.
    pub fn start(
        store: ExemplarStore,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> std::io::Result<Self> {
        let mailbox = Arc::new(Mailbox {
            shared: Mutex::default(),
            changed: Condvar::new(),
            wake: Box::new(wake),
            store,
        });
        let thread_mailbox = Arc::clone(&mailbox);
        std::thread::Builder::new()
            .name("cloth".to_owned())
            .spawn(move || work(&thread_mailbox))?;
        Ok(Self { mailbox })
    }

    /// Asks for a picture; an older request that has not begun never will.
    pub fn request(&self, request: PreviewRequest) {
        let mut shared = self.mailbox.lock();
        shared.supersede();
        shared.next = Some(request);
        drop(shared);
        self.mailbox.changed.notify_all();
    }

    /// Cancels the work until the next request.
    pub fn stop(&self) {
        let mut shared = self.mailbox.lock();
        shared.next = None;
        shared.cancel_all();
        shared.phase = Phase::Stopped;
        drop(shared);
        self.mailbox.changed.notify_all();
    }

    /// Says whether anybody can see the window: refining waits while nobody does.
    pub fn set_hidden(&self, hidden: bool) {
        let mut shared = self.mailbox.lock();
        if shared.hidden != hidden {
            shared.hidden = hidden;
            drop(shared);
            self.mailbox.changed.notify_all();
        }
    }

    /// Whether refining waits to be seen.
    pub fn is_hidden(&self) -> bool {
        self.mailbox.lock().hidden
    }

    /// What the worker is at.
    pub fn phase(&self) -> Phase {
        self.mailbox.lock().phase.clone()
    }

    /// How far the exemplars are, while they are being built.
    pub fn building(&self) -> Option<Building> {
        self.mailbox.lock().building.clone()
    }

    /// Why the full cloth could not be built, once.
    pub fn take_failure(&self) -> Option<String> {
        self.mailbox.lock().failure.take()
    }

    /// The newest picture that was not taken yet.
    pub fn take_picture(&self) -> Option<Picture> {
        self.mailbox.lock().picture.take()
    }

    /// The newest picture for the pick glass that was not taken yet.
    pub fn take_glass(&self) -> Option<Picture> {
        self.mailbox.lock().glass.take()
    }
}

impl Drop for ClothWorker {
    fn drop(&mut self) {
        let mut shared = self.mailbox.lock();
        shared.closing = true;
        shared.next = None;
        shared.cancel_all();
        drop(shared);
        self.mailbox.changed.notify_all();
    }
}

/// Chooses how coarse the first traced picture is, so that it takes about a frame.
#[derive(Debug)]
struct FirstLevel(u32);

impl FirstLevel {
    const COARSEST: u32 = 6;
    const TOO_SLOW_MS: f64 = 33.0;
    const FAST_MS: f64 = 8.0;

    /// Learns from the time the last first picture took. A finer level takes four times
    /// as long, so the two thresholds are further apart than that.
    fn learn(&mut self, milliseconds: f64) {
        if milliseconds > Self::TOO_SLOW_MS {
            self.0 = (self.0 + 1).min(Self::COARSEST);
        } else if milliseconds < Self::FAST_MS {
            self.0 = self.0.saturating_sub(1);
        }
    }
}

/// Pixels a crossing from which a film tells more of it than first sight does.
const TELLING: f32 = 12.0;

/// Samples a pixel of a film that is halved: as long as one of the next size takes.
const COARSE_SAMPLES: u32 = 4;

/// How often a film may be halved so that it still tells more than first sight. What coarse
/// films know of crossings as large as their pixels is worse than that where light and dark
/// yarns lie side by side; of the slant of a view first sight knows nothing.
fn coarsest_film(request: &PreviewRequest) -> u32 {
    let still = &request.still;
    if !first_sight_serves(still) {
        return u32::MAX;
    }
    let sett = request.design.sett();
    let pitch = (sett.ends.mean_pitch_mm()).min(sett.picks.mean_pitch_mm());
    let width = (still.width_mm).unwrap_or_else(|| usual_width_mm(still.view, &request.design));
    let pixels = pitch * still.width as f32 / width;
    // Nothing is halved where the size is none.
    (pixels / TELLING).log2().max(0.0) as u32
}

/// What the drawing thread keeps from one request to the next.
struct WorkerState {
    coarse: Option<Kept>,
    first: FirstLevel,
    tables: Arc<SightTables>,
    /// What is on the screen, in the pane and in the glass.
    screen: Option<OnScreen>,
    glass: Option<OnScreen>,
    /// Threads behind those of the window.
    pool: Option<rayon::ThreadPool>,
}

fn work(mailbox: &Arc<Mailbox>) {
    let mut state = WorkerState {
        coarse: None,
        first: FirstLevel(5),
        tables: Arc::default(),
        screen: None,
        glass: None,
        pool: threads::pool_behind("cloth"),
    };
    while let Some((request, job)) = next_request(mailbox) {
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            serve(mailbox, &request, &job, &mut state)
        }));
        let mut shared = mailbox.lock();
        shared.current = None;
        let phase = match outcome {
            Ok(Ok(done)) => Phase::Done(done),
            // A newer request or the person ended it: nothing to say.
            Ok(Err(StillError::Cancelled(_))) => Phase::Stopped,
            Ok(Err(error)) if error.is_too_wide() => Phase::AtSight(error.to_string()),
            Ok(Err(error)) => Phase::Failed(error.to_string()),
            Err(_) => {
                (state.coarse, state.screen, state.glass) = (None, None, None);
                shared.full = None;
                Phase::Failed(
                    "the picture: drawing it failed unexpectedly: try another view".to_owned(),
                )
            }
        };
        if shared.next.is_none() {
            shared.phase = phase;
        }
        drop(shared);
        (mailbox.wake)();
    }
}

fn next_request(mailbox: &Mailbox) -> Option<(PreviewRequest, Job)> {
    let mut shared = mailbox.lock();
    loop {
        if shared.closing {
            return None;
        }
        if let Some(request) = shared.next.take() {
            let job = Job::new();
            shared.last = Some(request.clone());
            shared.current = Some(Current {
                job: job.clone(),
                shielded: true,
            });
            return Some((request, job));
        }
        shared = mailbox.wait(shared);
    }
}

/// Lets newer requests end this one from here on; an error when one is waiting.
fn lower_shield(mailbox: &Mailbox) -> Result<(), Cancelled> {
    let mut shared = mailbox.lock();
    if shared.closing || shared.next.is_some() {
        return Err(Cancelled);
    }
    if let Some(current) = &mut shared.current {
        current.shielded = false;
    }
    Ok(())
}

fn serve(
    mailbox: &Arc<Mailbox>,
    request: &PreviewRequest,
    job: &Job,
    state: &mut WorkerState,
) -> Result<Done, StillError> {
    let WorkerState {
        coarse,
        first,
        tables,
        screen,
        glass,
        pool,
    } = state;
    let screen = match request.aim {
        Aim::Pane => screen,
        Aim::Glass => glass,
    };
    let drawing = Drawing {
        mailbox,
        request,
        job,
        begun: Instant::now(),
        patience: PATIENCE,
    };
    drawing.first_sight(tables, screen)?;
    lower_shield(mailbox)?;
    let Some((cloth, fibres)) = cloth_of(mailbox, request, job, coarse)? else {
        return Ok(Done::Waiting);
    };
    mailbox.set_phase(Phase::Refining);
    let mut refine = || {
        let coarsest = coarsest_film(request).min(first.0);
        for level in (1..=coarsest).rev() {
            let stop = Stop {
                spp: Some(COARSE_SAMPLES),
                ..Stop::default()
            };
            let traced = drawing.trace(&*cloth, fibres, level, stop, screen)?;
            if level == coarsest {
                first.learn(traced.pass_seconds * 1e3);
            }
        }
        let good = request.quality.error();
        let stop = Stop {
            error: Some(good),
            ..Stop::default()
        };
        let traced = drawing.trace(&*cloth, fibres, 0, stop, screen)?;
        if coarsest == 0 && first.0 == 0 {
            first.learn(traced.pass_seconds * 1e3);
        }
        let is_good = traced.error.is_some_and(|error| error < good);
        Ok(if is_good { Done::Good } else { Done::Long })
    };
    match pool {
        Some(pool) => pool.install(refine),
        None => refine(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::opened::Opened;
    use pickglass::plan::{EffectBase, EffectChoice, Settings};
    use std::time::Duration;

    fn request(generation: u64, design: &Arc<Design>) -> PreviewRequest {
        let still = StillRequest {
            width: 64,
            height: 48,
            effects: EffectChoice {
                base: EffectBase::None,
                ..EffectChoice::default()
            },
            settings: Settings::default().at_level(4),
            ..StillRequest::default()
        };
        PreviewRequest {
            generation,
            aim: Aim::Pane,
            design: Arc::clone(design),
            drawdown: Arc::new(design.weave()),
            still,
            quality: Quality::Good,
            blank: false,
        }
    }

    fn wait_for(worker: &ClothWorker, mut done: impl FnMut(&ClothWorker) -> bool) -> bool {
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(60) {
            if done(worker) {
                return true;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        false
    }

    #[test]
    fn the_latest_request_is_the_one_that_is_drawn() {
        let design = Opened::preset("oxford").expect("a preset").design;
        let worker = ClothWorker::start(ExemplarStore::user(), || {}).expect("a thread");
        for generation in 1..=50 {
            worker.request(request(generation, &design));
        }
        assert!(wait_for(&worker, |worker| {
            worker
                .take_picture()
                .is_some_and(|picture| picture.generation == 50 && picture.full_size)
        }));
    }

    #[test]
    fn stopping_ends_the_work_and_a_request_resumes_it() {
        let design = Opened::preset("oxford").expect("a preset").design;
        let worker = ClothWorker::start(ExemplarStore::user(), || {}).expect("a thread");
        worker.request(request(1, &design));
        worker.stop();
        assert!(wait_for(&worker, |worker| worker.phase() == Phase::Stopped));
        worker.request(request(2, &design));
        assert!(wait_for(&worker, |worker| worker
            .take_picture()
            .is_some_and(|picture| picture.generation == 2)));
    }

    #[test]
    fn refining_ends_when_the_picture_is_as_good_as_was_asked_for() {
        let design = Opened::preset("oxford").expect("a preset").design;
        let worker = ClothWorker::start(ExemplarStore::user(), || {}).expect("a thread");
        let mut small = request(1, &design);
        (small.still.width, small.still.height) = (8, 6);
        small.quality = Quality::Draft;
        worker.request(small);
        // The coarse cloth is done before the full one is there.
        let mut last = None;
        assert!(wait_for(&worker, |worker| {
            last = worker.take_picture().or(last.take());
            let full = last
                .as_ref()
                .is_some_and(|p: &Picture| p.fibres == Fibres::Full);
            full && worker.phase() == Phase::Done(Done::Good)
        }));
        let picture = worker.take_picture().or(last).expect("a picture");
        assert!(
            picture
                .error
                .is_some_and(|error| error < Quality::Draft.error())
        );
        // Then it rests: nothing more comes.
        std::thread::sleep(Duration::from_millis(50));
        assert!(worker.take_picture().is_none());
        assert!(Quality::ALL.is_sorted_by(|a, b| a.error() > b.error()));
    }

    #[test]
    fn refining_waits_while_nobody_sees_it_and_then_goes_on() {
        let design = Opened::preset("oxford").expect("a preset").design;
        let worker = ClothWorker::start(ExemplarStore::user(), || {}).expect("a thread");
        worker.request(request(1, &design));
        let mut spp = 0;
        assert!(wait_for(&worker, |worker| {
            let picture = worker.take_picture().filter(|picture| picture.full_size);
            spp = picture.map_or(spp, |picture| picture.spp);
            spp > 0
        }));
        worker.set_hidden(true);
        // What was under way may still come; then there is silence.
        assert!(wait_for(&worker, |worker| {
            std::thread::sleep(Duration::from_millis(300));
            let picture = worker.take_picture();
            spp = picture.as_ref().map_or(spp, |picture| picture.spp);
            picture.is_none()
        }));
        assert!(
            !matches!(worker.phase(), Phase::Done(_)),
            "it waits, and is not done"
        );
        worker.set_hidden(false);
        let mut after = 0;
        assert!(wait_for(&worker, |worker| {
            after = worker.take_picture().map_or(0, |picture| picture.spp);
            after > 0
        }));
        assert!(after > spp, "the film was kept: {after} after {spp}");
        // A newer request is heard in the dark as well.
        worker.set_hidden(true);
        worker.request(request(2, &design));
        assert!(wait_for(&worker, |worker| worker
            .take_picture()
            .is_some_and(|picture| picture.generation == 2)));
    }

    #[test]
    fn dropping_the_worker_ends_its_thread() {
        let design = Opened::preset("oxford").expect("a preset").design;
        let worker = ClothWorker::start(ExemplarStore::user(), || {}).expect("a thread");
        worker.request(request(1, &design));
        let mailbox = Arc::downgrade(&worker.mailbox);
        drop(worker);
        let start = Instant::now();
        while mailbox.upgrade().is_some() {
            assert!(start.elapsed() < Duration::from_secs(60), "still at work");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    #[test]
    fn an_edit_is_seen_at_once_and_the_rest_of_the_picture_stays() {
        let design = Opened::preset("oxford").expect("a preset").design;
        let worker = ClothWorker::start(ExemplarStore::user(), || {}).expect("a thread");
        let first = request(1, &design);
        worker.request(first.clone());
        let mut traced = None;
        assert!(wait_for(&worker, |worker| {
            traced = worker.take_picture().filter(|picture| picture.full_size);
            traced.is_some()
        }));
        worker.stop();
        let traced = traced.expect("a picture");
        let mut edited = WeavePattern::clone(&first.drawdown);
        edited.set(1, 0, !edited.get(1, 0));
        let weave = pickglass::design::Structure::Pattern(edited.clone());
        let changed = Design::clone(&design)
            .with_structure(weave)
            .expect("a design");
        worker.request(PreviewRequest {
            generation: 2,
            design: Arc::new(changed),
            drawdown: Arc::new(edited),
            ..first.clone()
        });
        let mut seen = None;
        assert!(wait_for(&worker, |worker| {
            seen = worker
                .take_picture()
                .filter(|picture| picture.generation == 2);
            seen.is_some()
        }));
        let seen = seen.expect("a picture");
        // Whatever was traced between the two looks, the edit is first seen without paths.
        assert_eq!(seen.spp, 0);
        let pixels = seen.image.pixels.iter().zip(&traced.image.pixels);
        let changed = pixels.filter(|(a, b)| a != b).count();
        assert!(changed > 0, "nothing was edited");
    }

    #[test]
    fn the_first_level_settles() {
        let mut level = FirstLevel(0);
        // A machine on which level 2 takes 20 ms: neither too slow nor worth a finer one.
        for _ in 0..20 {
            let milliseconds = 20.0 * 4f64.powi(2 - level.0 as i32);
            level.learn(milliseconds);
        }
        assert_eq!(level.0, 2);
    }
}
