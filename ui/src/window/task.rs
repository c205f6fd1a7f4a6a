//! One piece of work on a thread of its own, whose result the window picks up.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

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
