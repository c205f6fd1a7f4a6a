//! One piece of work on a thread of its own, whose result the window picks up, and how long
//! it will still take.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

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

    /// Looks without waiting.
    pub fn poll(&self) -> Outcome<T> {
        match self.result.try_recv() {
            Ok(value) => Outcome::Ready(value),
            Err(TryRecvError::Empty) => Outcome::Working,
            Err(TryRecvError::Disconnected) => Outcome::Lost,
        }
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
