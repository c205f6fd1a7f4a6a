//! What an interrupt (Ctrl-C, or a polite request to end) does to work under way: the first
//! ends it in good order, the second ends the program at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use pickglass::job::Job;

/// What the system is told when the second interrupt ends the program.
const INTERRUPTED: i32 = 130;

/// Watches for interrupts.
#[derive(Clone, Default)]
pub struct Interrupt {
    happened: Arc<AtomicBool>,
    /// Whether there is something by now that is worth keeping.
    kept: Arc<AtomicBool>,
}

impl Interrupt {
    /// From now on the first interrupt cancels `job`; once [`Interrupt::keep`] was called it
    /// lets the job end with what it has.
    pub fn watch(job: &Job) -> Self {
        let interrupt = Self::default();
        let (own, job) = (interrupt.clone(), job.clone());
        // Where no handler can be set an interrupt ends the program at once, as ever.
        let set = ctrlc::set_handler(move || {
            if own.happened.swap(true, Ordering::Relaxed) {
                std::process::exit(INTERRUPTED);
            }
            if own.kept.load(Ordering::Relaxed) {
                job.suffice();
            } else {
                job.cancel();
            }
        });
        if let Err(error) = set {
            log::warn!("no interrupt handler: {error}");
        }
        interrupt
    }

    /// There is something worth keeping now.
    pub fn keep(&self) {
        self.kept.store(true, Ordering::Relaxed);
    }

    /// Whether there was an interrupt.
    pub fn happened(&self) -> bool {
        self.happened.load(Ordering::Relaxed)
    }
}
