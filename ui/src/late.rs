//! Says at once that a cloth takes longer to make, its exemplars above all, than the time
//! that was given for its picture.

use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::out::{self, Progress};

/// The stage that takes the time, as jobs call it.
const EXEMPLARS: &str = "exemplars";
/// The stage that ends the waiting.
const RENDER: &str = "render";

/// The work that is left by the stage's pace may be overrated this often over: the first
/// exemplars are done at the same time as others.
const DOUBT: f64 = 2.0;

/// Watches for the time to run out before there is a picture.
#[derive(Clone)]
pub struct Late(Option<Arc<Watch>>);

struct Watch {
    begun: Instant,
    deadline: Instant,
    progress: Progress,
    /// Dropped when there is nothing more to tell; the waiting thread ends with it.
    waiting: Mutex<Option<Sender<()>>>,
}

impl Late {
    /// Watches until `deadline`, if there is one.
    pub fn watch(deadline: Option<Instant>, progress: &Progress) -> Self {
        let Some(deadline) = deadline else {
            return Self(None);
        };
        let (sender, receiver) = channel::<()>();
        let watch = Arc::new(Watch {
            begun: Instant::now(),
            deadline,
            progress: progress.clone(),
            waiting: Mutex::new(Some(sender)),
        });
        let waiting = Arc::downgrade(&watch);
        // Without the thread it is told with the next exemplar.
        let started = std::thread::Builder::new()
            .name("late".to_owned())
            .spawn(move || {
                let left = deadline.saturating_duration_since(Instant::now());
                if receiver.recv_timeout(left) == Err(RecvTimeoutError::Timeout)
                    && let Some(watch) = waiting.upgrade()
                {
                    watch.tell();
                }
            });
        if let Err(error) = started {
            log::warn!("no thread to watch the time: {error}");
        }
        Self(Some(watch))
    }

    /// There is a picture: nothing more is told.
    pub fn in_time(&self) {
        if let Some(watch) = &self.0 {
            watch.waiting().take();
        }
    }

    /// What listens to a job's stages.
    pub fn listener(&self) -> impl Fn(&str, f32) + Send + Sync + 'static {
        let watch = self.0.clone();
        move |stage, fraction| {
            let Some(watch) = &watch else { return };
            match stage {
                RENDER => drop(watch.waiting().take()),
                EXEMPLARS if is_late(watch.begun.elapsed(), fraction.into(), watch.left()) => {
                    watch.tell();
                }
                _ => {}
            }
        }
    }
}

impl Watch {
    fn waiting(&self) -> std::sync::MutexGuard<'_, Option<Sender<()>>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn left(&self) -> Duration {
        self.deadline.saturating_duration_since(Instant::now())
    }

    /// Tells it once.
    fn tell(&self) {
        if self.waiting().take().is_some() {
            self.progress.finish();
            out::note(
                "making the cloth takes longer than --seconds: the picture gets one pass; later \
                 ones find its exemplars in the cache",
            );
        }
    }
}

/// Whether work that took so long for a share of it is sure to take longer than what is left.
fn is_late(taken: Duration, share: f64, left: Duration) -> bool {
    let share = share.clamp(0.0, 1.0);
    let rest = taken.as_secs_f64() * (1.0 - share) / share.max(1e-6);
    rest / DOUBT > left.as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_told_when_it_is_sure() {
        let seconds = Duration::from_secs;
        // A tenth took 10 s: 90 s are left, perhaps half of that.
        assert!(is_late(seconds(10), 0.1, seconds(40)));
        assert!(!is_late(seconds(10), 0.1, seconds(50)));
        assert!(!is_late(seconds(10), 1.0, seconds(0)));
        assert!(is_late(seconds(10), 0.9, seconds(0)));
    }
}
