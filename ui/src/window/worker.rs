//! The threads that draw the cloth: latest request wins, every send wakes the window.
//!
//! One thread draws. A request first gets a coarse picture, at a size that fits the time
//! of a frame and is never interrupted, so that a drag always shows something; finer
//! sizes follow, each once the time spent so far allows a pass of it. A newer request
//! ends the older one. Where the cloth's full exemplars are not at hand yet, it is drawn
//! from coarse ones, and a second thread builds the full ones meanwhile. Dropping the
//! worker ends all.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use pickglass::design::Design;
use pickglass::exemplar::ExemplarStore;
use pickglass::job::{Cancelled, Job};
use pickglass::still::{self, Pass, PreparedCloth, StillError, StillRequest, Stop};

/// A picture that the window wants to see refine.
#[derive(Clone)]
pub struct PreviewRequest {
    pub generation: u64,
    pub design: Arc<Design>,
    /// At full size, with `centre_mm` and `width_mm` given.
    pub still: StillRequest,
}

impl PreviewRequest {
    /// Whether both look at the same prepared cloth.
    fn same_cloth(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.design, &other.design)
            && self.still.seed == other.still.seed
            && self.still.dials == other.still.dials
    }
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
    /// Drawn from the full exemplars, not from coarse ones.
    pub full_cloth: bool,
}

/// What the worker is at.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Phase {
    #[default]
    Idle,
    /// Builds what the first picture needs.
    Preparing,
    Refining,
    /// The picture is as good as asked for.
    Done,
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
    request: PreviewRequest,
    job: Job,
    /// A newer request for the same cloth waits: the cloth is being prepared, or the
    /// first picture drawn.
    shielded: bool,
}

/// A cloth made from full exemplars, and for which request.
type Prepared = (PreviewRequest, Arc<PreparedCloth>);

#[derive(Default)]
struct Shared {
    next: Option<PreviewRequest>,
    current: Option<Current>,
    /// The newest request that was begun.
    last: Option<PreviewRequest>,
    picture: Option<Picture>,
    phase: Phase,
    building: Option<Building>,
    /// The full cloth that is being built.
    builder: Option<(PreviewRequest, Job)>,
    full: Option<Prepared>,
    /// Why the full cloth cannot be built.
    failure: Option<String>,
    closing: bool,
}

impl Shared {
    /// Ends all work except on the cloth of `keep`.
    fn cancel_all_but(&mut self, keep: Option<&PreviewRequest>) {
        let kept = |request: &PreviewRequest| keep.is_some_and(|keep| keep.same_cloth(request));
        if let Some(current) = &self.current
            && !(current.shielded && kept(&current.request))
        {
            current.job.cancel();
        }
        if let Some((request, job)) = &self.builder
            && !kept(request)
        {
            job.cancel();
            self.builder = None;
            self.building = None;
        }
    }
}

struct Desk {
    shared: Mutex<Shared>,
    bell: Condvar,
    wake: Box<dyn Fn() + Send + Sync>,
    store: ExemplarStore,
}

impl Desk {
    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn set_phase(&self, phase: Phase) {
        self.lock().phase = phase;
        (self.wake)();
    }
}

/// The worker's handle. Dropping it cancels the work.
pub struct ClothWorker {
    desk: Arc<Desk>,
}

impl ClothWorker {
    /// Starts the thread; `wake` is called after everything it sends.
    pub fn start(
        store: ExemplarStore,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> std::io::Result<Self> {
        let desk = Arc::new(Desk {
            shared: Mutex::default(),
            bell: Condvar::new(),
            wake: Box::new(wake),
            store,
        });
        let thread_desk = Arc::clone(&desk);
        std::thread::Builder::new()
            .name("cloth".to_owned())
            .spawn(move || work(&thread_desk))?;
        Ok(Self { desk })
    }

    /// Asks for a picture; an older request that has not begun never will.
    pub fn request(&self, request: PreviewRequest) {
        let mut shared = self.desk.lock();
        shared.cancel_all_but(Some(&request));
        shared.next = Some(request);
        drop(shared);
        self.desk.bell.notify_one();
    }

    /// Cancels the work until the next request.
    pub fn stop(&self) {
        let mut shared = self.desk.lock();
        shared.next = None;
        shared.cancel_all_but(None);
        shared.phase = Phase::Stopped;
    }

    /// What the worker is at.
    pub fn phase(&self) -> Phase {
        self.desk.lock().phase.clone()
    }

    /// How far the exemplars are, while they are being built.
    pub fn building(&self) -> Option<Building> {
        self.desk.lock().building.clone()
    }

    /// Why the full cloth could not be built, once.
    pub fn take_failure(&self) -> Option<String> {
        self.desk.lock().failure.take()
    }

    /// The newest picture that was not taken yet.
    pub fn take_picture(&self) -> Option<Picture> {
        self.desk.lock().picture.take()
    }
}

impl Drop for ClothWorker {
    fn drop(&mut self) {
        let mut shared = self.desk.lock();
        shared.closing = true;
        shared.next = None;
        shared.cancel_all_but(None);
        drop(shared);
        self.desk.bell.notify_one();
    }
}

/// Chooses how coarse the first picture is, so that it takes about a frame.
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

/// A preview ends at this error, or after this many passes.
const GOOD_ERROR: f64 = 0.005;
const MOST_PASSES: u32 = 4096;
/// Voxel level of the cloth that is drawn until the full one is built.
const COARSE_LEVEL: &str = "3";

fn work(desk: &Arc<Desk>) {
    let mut coarse: Option<Prepared> = None;
    let mut first = FirstLevel(5);
    while let Some((request, job)) = next_request(desk) {
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            serve(desk, &request, &job, &mut coarse, &mut first)
        }));
        let mut shared = desk.lock();
        shared.current = None;
        let phase = match outcome {
            Ok(Ok(())) => Phase::Done,
            // A newer request or the person ended it: nothing to say.
            Ok(Err(StillError::Cancelled(_))) => Phase::Stopped,
            Ok(Err(error)) => Phase::Failed(error.to_string()),
            Err(_) => {
                coarse = None;
                Phase::Failed(
                    "the picture: drawing it failed unexpectedly: try another view".to_owned(),
                )
            }
        };
        if shared.next.is_none() {
            shared.phase = phase;
        }
        drop(shared);
        (desk.wake)();
    }
}

fn next_request(desk: &Desk) -> Option<(PreviewRequest, Job)> {
    let mut shared = desk.lock();
    loop {
        if shared.closing {
            return None;
        }
        if let Some(request) = shared.next.take() {
            let job = Job::new();
            shared.last = Some(request.clone());
            shared.current = Some(Current {
                request: request.clone(),
                job: job.clone(),
                shielded: true,
            });
            return Some((request, job));
        }
        shared = desk
            .bell
            .wait(shared)
            .unwrap_or_else(PoisonError::into_inner);
    }
}

/// Lets newer requests end this one from here on; an error when one is waiting.
fn lower_shield(desk: &Desk) -> Result<(), Cancelled> {
    let mut shared = desk.lock();
    if shared.closing || shared.next.is_some() {
        return Err(Cancelled);
    }
    if let Some(current) = &mut shared.current {
        current.shielded = false;
    }
    Ok(())
}

fn serve(
    desk: &Arc<Desk>,
    request: &PreviewRequest,
    job: &Job,
    coarse: &mut Option<Prepared>,
    first: &mut FirstLevel,
) -> Result<(), StillError> {
    let (cloth, full) = cloth_of(desk, request, job, coarse)?;
    desk.set_phase(Phase::Refining);
    let mut drawing = Drawing {
        desk,
        request,
        cloth: &cloth,
        full,
        job,
        begun: Instant::now(),
        shown_paths: 0,
    };
    let mut level = first.0;
    let mut pass_seconds = drawing.draw(level, 0.0)?;
    first.learn(pass_seconds * 1e3);
    lower_shield(desk)?;
    if !full {
        build_full(desk, request);
    }
    while level > 0 {
        level -= 1;
        // Stay until as much time was spent as one pass of the next size will take.
        let next_pass = 16.0 * pass_seconds;
        let left = next_pass - drawing.begun.elapsed().as_secs_f64();
        pass_seconds = drawing.draw(level, left)?;
    }
    Ok(())
}

/// The best cloth at hand for a request, and whether it is the full one.
fn cloth_of(
    desk: &Desk,
    request: &PreviewRequest,
    job: &Job,
    coarse: &mut Option<Prepared>,
) -> Result<(Arc<PreparedCloth>, bool), StillError> {
    let made_for = |prepared: &Prepared| {
        let (made_for, cloth) = prepared;
        made_for.same_cloth(request).then(|| Arc::clone(cloth))
    };
    if let Some(cloth) = desk.lock().full.as_ref().and_then(made_for) {
        return Ok((cloth, true));
    }
    if let Some(cloth) = coarse.as_ref().and_then(made_for) {
        return Ok((cloth, false));
    }
    desk.set_phase(Phase::Preparing);
    *coarse = None;
    let mut still = request.still.clone();
    still
        .dials
        .push(("level".to_owned(), COARSE_LEVEL.to_owned()));
    let cloth = Arc::new(still::prepare(&request.design, &still, &desk.store, job)?);
    *coarse = Some((request.clone(), Arc::clone(&cloth)));
    Ok((cloth, false))
}

/// Builds the full cloth on a thread of its own, unless that is under way; then the last
/// request is drawn again from it.
fn build_full(desk: &Arc<Desk>, request: &PreviewRequest) {
    let mut shared = desk.lock();
    let under_way = |(request_of, _): &(PreviewRequest, Job)| request_of.same_cloth(request);
    if shared.builder.as_ref().is_some_and(under_way) {
        return;
    }
    let report_to = Arc::clone(desk);
    let token = Job::new();
    let job = token.clone().with_listener(move |stage, fraction| {
        let mut shared = report_to.lock();
        if shared.builder.is_some() {
            shared.building = Some(Building {
                stage: stage.to_owned(),
                fraction,
            });
        }
        drop(shared);
        (report_to.wake)();
    });
    let (thread_desk, thread_request) = (Arc::clone(desk), request.clone());
    let spawned = std::thread::Builder::new()
        .name("exemplars".to_owned())
        .spawn(move || {
            let (desk, request) = (thread_desk, thread_request);
            let built = catch_unwind(AssertUnwindSafe(|| {
                in_own_pool(|| still::prepare(&request.design, &request.still, &desk.store, &job))
            }));
            let mut shared = desk.lock();
            if job.check().is_err() {
                return;
            }
            shared.builder = None;
            shared.building = None;
            match built {
                Ok(Ok(cloth)) => {
                    shared.full = Some((request, Arc::new(cloth)));
                    if let Some(current) = &shared.current {
                        current.job.cancel();
                    }
                    if shared.next.is_none() {
                        shared.next = shared.last.clone();
                    }
                }
                // The coarse cloth stays; what stands in the way of the full one is said.
                Ok(Err(error)) => shared.failure = Some(error.to_string()),
                Err(_) => {
                    shared.failure = Some(
                        "the exemplars: building them failed unexpectedly: try another sett"
                            .to_owned(),
                    );
                }
            }
            drop(shared);
            desk.bell.notify_one();
            (desk.wake)();
        });
    if spawned.is_ok() {
        shared.builder = Some((request.clone(), token));
    }
}

/// Does `work` with threads of its own, so that it does not queue up before the drawing.
fn in_own_pool<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}

/// The pictures of one request.
struct Drawing<'r> {
    desk: &'r Desk,
    request: &'r PreviewRequest,
    cloth: &'r PreparedCloth,
    /// Whether the cloth is the full one.
    full: bool,
    job: &'r Job,
    begun: Instant,
    /// Paths in the picture that is shown.
    shown_paths: u64,
}

impl Drawing<'_> {
    /// Draws at 1/2^level of the size for `seconds`, at least one pass; at level 0 until
    /// the picture is good. Returns the seconds a pass took.
    fn draw(&mut self, level: u32, seconds: f64) -> Result<f64, StillError> {
        let mut still = self.request.still.clone();
        still.width = (still.width >> level).max(1);
        still.height = (still.height >> level).max(1);
        still.stop = if level > 0 {
            Stop {
                seconds: Some(seconds.max(0.0)),
                ..Stop::default()
            }
        } else {
            Stop {
                spp: Some(MOST_PASSES),
                error: Some(GOOD_ERROR),
                ..Stop::default()
            }
        };
        let mut pass_seconds = 0.0;
        let (cloth, job) = (self.cloth, self.job);
        let (before, mut shown) = (self.shown_paths, self.shown_paths);
        let drawing = &*self;
        still::render(cloth, &still, job, &mut |pass| {
            pass_seconds = pass.seconds / f64::from(pass.spp.max(1));
            let paths = u64::from(pass.spp) * u64::from(pass.width) * u64::from(pass.height);
            // A finer picture is shown once it is no noisier than the coarser one.
            if 2 * paths >= before {
                drawing.show(pass, level == 0);
                shown = paths;
            }
        })?;
        self.shown_paths = shown;
        Ok(pass_seconds)
    }

    fn show(&self, pass: &Pass<'_>, full_size: bool) {
        let size = [pass.width as usize, pass.height as usize];
        if pass.rgba.len() != size[0] * size[1] * 4 || self.job.check().is_err() {
            return;
        }
        let picture = Picture {
            generation: self.request.generation,
            image: egui::ColorImage::from_rgba_unmultiplied(size, pass.rgba),
            still: self.request.still.clone(),
            spp: pass.spp,
            seconds: self.begun.elapsed().as_secs_f64(),
            error: pass.error,
            full_size,
            full_cloth: self.full,
        };
        self.desk.lock().picture = Some(picture);
        (self.desk.wake)();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::opened::Opened;
    use pickglass::still::{EffectBase, EffectChoice};
    use std::time::Duration;

    fn request(generation: u64, design: &Arc<Design>) -> PreviewRequest {
        let still = StillRequest {
            width: 64,
            height: 48,
            effects: EffectChoice {
                base: EffectBase::None,
                changes: Vec::new(),
            },
            dials: vec![("level".to_owned(), "4".to_owned())],
            ..StillRequest::default()
        };
        PreviewRequest {
            generation,
            design: Arc::clone(design),
            still,
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
    fn dropping_the_worker_ends_its_thread() {
        let design = Opened::preset("oxford").expect("a preset").design;
        let worker = ClothWorker::start(ExemplarStore::user(), || {}).expect("a thread");
        worker.request(request(1, &design));
        let desk = Arc::downgrade(&worker.desk);
        drop(worker);
        let start = Instant::now();
        while desk.upgrade().is_some() {
            assert!(start.elapsed() < Duration::from_secs(60), "still at work");
            std::thread::sleep(Duration::from_millis(2));
        }
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
