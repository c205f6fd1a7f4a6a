//! The thread that draws the cloth: latest request wins, every send wakes the window.
//!
//! A request first gets a coarse picture, at a level that fits the time of a frame and
//! is never interrupted, so that a drag always shows something; finer levels follow,
//! then passes at full size until the picture is good. A newer request ends the finer
//! levels, but not the preparation of the same cloth. Dropping the worker ends all.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use pickglass::design::Design;
use pickglass::job::{Cancelled, Job};

use crate::stub::still::{self, Pass, PreparedCloth, StillError, StillRequest, Stop};

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
}

/// What the worker is at.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Phase {
    #[default]
    Idle,
    /// Builds what all pictures of the cloth need.
    Preparing {
        stage: String,
        fraction: f32,
    },
    Refining,
    /// The picture is as good as asked for.
    Done,
    /// Cancelled by the person.
    Stopped,
    Failed(String),
}

/// The request at work.
struct Current {
    request: PreviewRequest,
    job: Job,
    /// A newer request for the same cloth waits: the cloth is being prepared, or the
    /// first picture drawn.
    shielded: bool,
}

#[derive(Default)]
struct Shared {
    next: Option<PreviewRequest>,
    current: Option<Current>,
    picture: Option<Picture>,
    phase: Phase,
    closing: bool,
}

struct Desk {
    shared: Mutex<Shared>,
    bell: Condvar,
    wake: Box<dyn Fn() + Send + Sync>,
}

impl Desk {
    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn set_phase(&self, phase: Phase) {
        self.lock().phase = phase;
        (self.wake)();
    }

    fn superseded(&self) -> bool {
        let shared = self.lock();
        shared.closing || shared.next.is_some()
    }
}

/// The worker's handle. Dropping it cancels the work.
pub struct ClothWorker {
    desk: Arc<Desk>,
}

impl ClothWorker {
    /// Starts the thread; `wake` is called after everything it sends.
    pub fn start(wake: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let desk = Arc::new(Desk {
            shared: Mutex::default(),
            bell: Condvar::new(),
            wake: Box::new(wake),
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
        if let Some(current) = &shared.current
            && !(current.shielded && current.request.same_cloth(&request))
        {
            current.job.cancel();
        }
        shared.next = Some(request);
        drop(shared);
        self.desk.bell.notify_one();
    }

    /// Cancels the work until the next request.
    pub fn stop(&self) {
        let mut shared = self.desk.lock();
        shared.next = None;
        if let Some(current) = &shared.current {
            current.job.cancel();
        }
        shared.phase = Phase::Stopped;
    }

    /// What the worker is at.
    pub fn phase(&self) -> Phase {
        self.desk.lock().phase.clone()
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
        if let Some(current) = &shared.current {
            current.job.cancel();
        }
        drop(shared);
        self.desk.bell.notify_one();
    }
}

/// Chooses how coarse the first picture is, so that it takes about a frame.
#[derive(Debug)]
struct FirstLevel(u32);

impl FirstLevel {
    const COARSEST: u32 = 5;
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

fn work(desk: &Arc<Desk>) {
    let mut prepared: Option<(PreviewRequest, PreparedCloth)> = None;
    let mut first = FirstLevel(3);
    while let Some((request, job)) = next_request(desk) {
        let generation = request.generation;
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            serve(desk, &request, &job, &mut prepared, &mut first)
        }));
        let mut shared = desk.lock();
        shared.current = None;
        let phase = match outcome {
            Ok(Ok(())) => Phase::Done,
            // A newer request or the person ended it: nothing to say.
            Ok(Err(StillError::Cancelled(_))) => Phase::Stopped,
            Ok(Err(error)) => Phase::Failed(error.to_string()),
            Err(_) => {
                prepared = None;
                Phase::Failed(
                    "the picture: drawing it failed unexpectedly: try another view".to_owned(),
                )
            }
        };
        if shared.next.is_none() {
            log::debug!("request {generation} ended: {phase:?}");
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
    prepared: &mut Option<(PreviewRequest, PreparedCloth)>,
    first: &mut FirstLevel,
) -> Result<(), StillError> {
    if !prepared
        .as_ref()
        .is_some_and(|(of, _)| of.same_cloth(request))
    {
        *prepared = None;
        *prepared = Some((request.clone(), prepare(desk, request, job)?));
    }
    let Some((_, cloth)) = prepared else {
        return Ok(());
    };
    desk.set_phase(Phase::Refining);

    let mut level = first.0;
    let begun = Instant::now();
    draw_level(desk, request, cloth, level, job)?;
    first.learn(begun.elapsed().as_secs_f64() * 1e3);
    lower_shield(desk)?;
    while level > 0 {
        level -= 1;
        draw_level(desk, request, cloth, level, job)?;
    }
    Ok(())
}

fn prepare(
    desk: &Arc<Desk>,
    request: &PreviewRequest,
    job: &Job,
) -> Result<PreparedCloth, StillError> {
    let report_to = Arc::clone(desk);
    let report = move |stage: &str, fraction: f32| {
        report_to.set_phase(Phase::Preparing {
            stage: stage.to_owned(),
            fraction,
        });
    };
    report("preparing the cloth", 0.0);
    still::prepare(
        &request.design,
        &request.still,
        &job.clone().with_listener(report),
    )
}

/// Draws at 1/2^level of the size: one pass for coarse levels, all of them at level 0.
fn draw_level(
    desk: &Arc<Desk>,
    request: &PreviewRequest,
    cloth: &PreparedCloth,
    level: u32,
    job: &Job,
) -> Result<(), StillError> {
    let mut still = request.still.clone();
    still.width = (still.width >> level).max(1);
    still.height = (still.height >> level).max(1);
    still.stop = if level > 0 {
        Stop {
            spp: Some(1),
            ..Stop::default()
        }
    } else {
        Stop {
            spp: Some(MOST_PASSES),
            error: Some(GOOD_ERROR),
            ..Stop::default()
        }
    };
    still::render(cloth, &still, job, &mut |pass| {
        if level > 0 || !desk.superseded() {
            show(desk, request, pass, level == 0);
        }
    })
    .map(drop)
}

fn show(desk: &Desk, request: &PreviewRequest, pass: &Pass<'_>, full_size: bool) {
    let size = [pass.width as usize, pass.height as usize];
    if pass.rgba.len() != size[0] * size[1] * 4 {
        return;
    }
    let picture = Picture {
        generation: request.generation,
        image: egui::ColorImage::from_rgba_unmultiplied(size, pass.rgba),
        still: request.still.clone(),
        spp: pass.spp,
        seconds: pass.seconds,
        error: pass.error,
        full_size,
    };
    desk.lock().picture = Some(picture);
    (desk.wake)();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stub::design;
    use std::time::Duration;

    fn request(generation: u64, design: &Arc<Design>) -> PreviewRequest {
        let still = StillRequest {
            width: 64,
            height: 48,
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
        let design = Arc::new(design::preset("plain").expect("a preset"));
        let worker = ClothWorker::start(|| {}).expect("a thread");
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
        let design = Arc::new(design::preset("plain").expect("a preset"));
        let worker = ClothWorker::start(|| {}).expect("a thread");
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
        let design = Arc::new(design::preset("plain").expect("a preset"));
        let worker = ClothWorker::start(|| {}).expect("a thread");
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
