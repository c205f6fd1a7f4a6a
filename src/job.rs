//! Progress, cancelling and deadlines: every long function takes a [`Job`].

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// The work was cancelled by its owner: a value, not a message on the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled before it was done: nothing was written")]
pub struct Cancelled;

type Listener = dyn Fn(&str, f32) + Send + Sync;

/// A handle that a long function polls and reports to. Clones share one token.
#[derive(Clone, Default)]
pub struct Job {
    cancelled: Arc<AtomicBool>,
    enough: Arc<AtomicBool>,
    deadline: Option<Instant>,
    listener: Option<Arc<Listener>>,
}

impl Job {
    /// A job that is never cancelled and reports to nobody.
    pub fn new() -> Self {
        Self::default()
    }

    /// The same job with a listener for `(stage, fraction in 0..=1)`.
    pub fn with_listener(mut self, listener: impl Fn(&str, f32) + Send + Sync + 'static) -> Self {
        self.listener = Some(Arc::new(listener));
        self
    }

    /// The same job with a moment after which progressive work stops refining; the earlier
    /// one where it has one already.
    pub fn with_deadline(mut self, deadline: Instant) -> Self {
        self.deadline = Some(self.deadline.map_or(deadline, |known| known.min(deadline)));
        self
    }

    /// The moment after which progressive work stops refining.
    pub fn deadline(&self) -> Option<Instant> {
        self.deadline
    }

    /// Asks progressive work to stop refining and give what it has, as a deadline that has
    /// passed does.
    pub fn suffice(&self) {
        self.enough.store(true, Ordering::Relaxed);
    }

    /// Asks the work to stop at its next check.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// `Err(Cancelled)` once [`Job::cancel`] was called on any clone.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.cancelled.load(Ordering::Relaxed) {
            Err(Cancelled)
        } else {
            Ok(())
        }
    }

    /// True once the deadline has passed or [`Job::suffice`] was called on any clone.
    pub fn expired(&self) -> bool {
        self.enough.load(Ordering::Relaxed)
            || self
                .deadline
                .is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// Reports how far a stage has come.
    pub fn report(&self, stage: &str, fraction: f32) {
        if let Some(listener) = &self.listener {
            listener(stage, fraction);
        }
    }
}
