//! Threads that give way to the window.

use rayon::{ThreadPool, ThreadPoolBuilder};

/// How much the drawing gives way to the window, as the system counts it.
#[cfg(target_os = "linux")]
const BEHIND: i32 = 10;

/// A pool whose threads the system runs behind those of the window; where that cannot be
/// said, it leaves one processor free.
pub(super) fn pool_behind(name: &'static str) -> Option<ThreadPool> {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if cfg!(target_os = "linux") {
        processors
    } else {
        processors.saturating_sub(1).max(1)
    };
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(move |index| format!("{name} {index}"))
        .start_handler(|_| step_behind())
        .build()
        .ok()
}

/// Lets this thread alone give way. On Linux niceness belongs to a thread.
fn step_behind() {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::nice(BEHIND) {
        log::debug!("drawing threads keep the window's priority: {error}");
    }
}

/// Does `work` with threads of its own that give way to the window and the drawing.
pub(super) fn behind<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match pool_behind("exemplars") {
        Some(pool) => pool.install(work),
        None => work(),
    }
}
