//! One piece of work on a thread of its own, whose result the window picks up, how far it
//! is and how long it will still take.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use pickglass::job::Job;

use super::pace;

/// How often what is left is said anew.
const TICK: Duration = Duration::from_millis(500);

/// Work under way. Dropping it forgets the result.
pub struct Task<T> {
    result: Receiver<T>,
}

/// What became of a task.
pub enum Outcome<T> {
    Working,
    Ready(T),
    /// The thread ended without a result.
    Lost,
}

impl<T: Send + 'static> Task<T> {
    /// Starts `work` and wakes the window when it is done.
    pub fn start(
        ctx: &egui::Context,
        name: &str,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> std::io::Result<Self> {
        let (sender, result) = sync_channel(1);
        let ctx = ctx.clone();
        std::thread::Builder::new()
            .name(name.to_owned())
            .spawn(move || {
                if let Ok(value) = catch_unwind(AssertUnwindSafe(work)) {
                    let _ = sender.send(value);
                }
                drop(sender);
                ctx.request_repaint();
            })?;
        Ok(Self { result })
    }
}

impl<T> Task<T> {
    /// Looks without waiting.
    pub fn poll(&self) -> Outcome<T> {
        match self.result.try_recv() {
            Ok(value) => Outcome::Ready(value),
            Err(TryRecvError::Empty) => Outcome::Working,
            Err(TryRecvError::Disconnected) => Outcome::Lost,
        }
    }
}

/// Work under way that says how far it is. Dropping it cancels it.
pub struct Running<T> {
    job: Job,
    teller: Teller,
    task: Task<T>,
}

/// How far a piece of work is.
struct Told {
    text: String,
    /// When what takes longest is over; what is left after that is short.
    until: Option<Instant>,
}

impl Told {
    /// In words, as it is at this moment.
    fn words(&self, now: Instant) -> String {
        let Some(until) = self.until else {
            return self.text.clone();
        };
        match until.saturating_duration_since(now).as_secs_f64() {
            over if over <= 0.0 => format!("{} · finishing", self.text),
            left => format!("{} · {} left", self.text, pace::in_words(left)),
        }
    }
}

/// Says how far a piece of work is, in words, and wakes the window.
#[derive(Clone)]
pub struct Teller {
    ctx: egui::Context,
    told: Arc<Mutex<Told>>,
}

impl Teller {
    /// Says how far it is.
    pub fn tell(&self, text: String) {
        self.put(Told { text, until: None });
    }

    /// Says how far it is, and in how many seconds only the finishing is left.
    pub fn tell_left(&self, text: String, left: Option<f64>) {
        let left = left.and_then(|left| Duration::try_from_secs_f64(left.max(0.0)).ok());
        let until = left.and_then(|left| Instant::now().checked_add(left));
        self.put(Told { text, until });
    }

    fn put(&self, told: Told) {
        *self.told.lock().unwrap_or_else(PoisonError::into_inner) = told;
        self.ctx.request_repaint();
    }
}

impl<T: Send + 'static> Running<T> {
    /// Starts `work`, whose job's stages are told.
    pub fn start(
        ctx: &egui::Context,
        name: &str,
        work: impl FnOnce(&Job, &Teller) -> T + Send + 'static,
    ) -> std::io::Result<Self> {
        let teller = Teller {
            ctx: ctx.clone(),
            told: Arc::new(Mutex::new(Told {
                text: "preparing".to_owned(),
                until: None,
            })),
        };
        let (stages, pace) = (teller.clone(), Pace::default());
        let job = Job::new()
            .with_listener(move |stage, fraction| stages.tell(pace.told(stage, fraction)));
        let (own_job, own_teller) = (job.clone(), teller.clone());
        let task = Task::start(ctx, name, move || work(&own_job, &own_teller))?;
        Ok(Self { job, teller, task })
    }
}

impl<T> Running<T> {
    /// How far it is.
    pub fn progress(&self) -> String {
        let told = self.teller.told.lock();
        let told = told.unwrap_or_else(PoisonError::into_inner);
        if told.until.is_some() {
            self.teller.ctx.request_repaint_after(TICK);
        }
        told.words(Instant::now())
    }

    pub fn cancel(&self) {
        self.job.cancel();
    }

    /// Looks without waiting.
    pub fn poll(&self) -> Outcome<T> {
        self.task.poll()
    }
}

impl<T> Drop for Running<T> {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// How fast a job goes, stage by stage.
#[derive(Default)]
pub struct Pace(Mutex<Option<(String, Instant)>>);

impl Pace {
    /// A stage and how far it is, in words, with the time it will still take.
    pub fn told(&self, stage: &str, fraction: f32) -> String {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let begun = match &*known {
            Some((name, begun)) if name == stage => *begun,
            _ => {
                let now = Instant::now();
                *known = Some((stage.to_owned(), now));
                now
            }
        };
        let left = left(begun.elapsed().as_secs_f64(), f64::from(fraction));
        format!("{stage} {:.0} %{left}", fraction * 100.0)
    }
}

/// What is left of work that took so many seconds for a share of it, in words; nothing
/// while too little is known.
pub fn left(seconds: f64, share: f64) -> String {
    let left = seconds * (1.0 - share) / share;
    if !(seconds > 1.0 && share > 0.01 && left.is_finite()) {
        return String::new();
    }
    match left.max(0.0).ceil() {
        over if over < 1.0 => " · finishing".to_owned(),
        seconds => format!(" · {} left", pace::in_words(seconds)),
    }
}

#[cfg(test)]
mod tests {
    use super::{Duration, Instant, Told, left};

    #[test]
    fn what_is_left_is_told_as_it_is_now_and_never_as_nothing() {
        let now = Instant::now();
        let told = Told {
            text: "8 spp".to_owned(),
            until: Some(now + Duration::from_secs(45)),
        };
        let after = |seconds: f64| told.words(now + Duration::from_secs_f64(seconds));
        assert_eq!(after(0.0), "8 spp · 45 s left");
        assert_eq!(after(44.5), "8 spp · 1 s left");
        // Denoising and writing may take a minute more.
        assert_eq!(after(45.0), "8 spp · finishing");
        assert_eq!(after(105.0), "8 spp · finishing");
    }

    #[test]
    fn time_left_follows_from_what_is_done() {
        assert_eq!(left(10.0, 0.25), " · 30 s left");
        assert_eq!(left(600.0, 0.25), " · 30 min left");
        assert_eq!(left(10.0, 1.0), " · finishing");
        for (seconds, share) in [(0.5, 0.5), (10.0, 0.0), (10.0, f64::NAN), (f64::NAN, 0.5)] {
            assert_eq!(left(seconds, share), "");
        }
    }
}
