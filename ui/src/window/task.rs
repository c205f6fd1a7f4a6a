//! One piece of work on a thread of its own, whose result the window picks up, how far it
//! is and how long it will still take.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use pickglass::job::Job;

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

/// Says how far a piece of work is, in words, and wakes the window.
#[derive(Clone)]
pub struct Teller {
    ctx: egui::Context,
    told: Arc<Mutex<String>>,
}

impl Teller {
    pub fn tell(&self, text: String) {
        *self.told.lock().unwrap_or_else(PoisonError::into_inner) = text;
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
            told: Arc::new(Mutex::new("preparing".to_owned())),
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
        told.unwrap_or_else(PoisonError::into_inner).clone()
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
        minutes if minutes >= 120.0 => format!(" · {:.0} min left", minutes / 60.0),
        seconds => format!(" · {seconds:.0} s left"),
    }
}

#[cfg(test)]
mod tests {
    use super::left;

    #[test]
    fn time_left_follows_from_what_is_done() {
        assert_eq!(left(10.0, 0.25), " · 30 s left");
        assert_eq!(left(600.0, 0.25), " · 30 min left");
        assert_eq!(left(10.0, 1.0), " · 0 s left");
        for (seconds, share) in [(0.5, 0.5), (10.0, 0.0), (10.0, f64::NAN), (f64::NAN, 0.5)] {
            assert_eq!(left(seconds, share), "");
        }
    }
}
