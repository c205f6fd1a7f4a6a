//! Recovery copies of the open document, written on a thread of their own, and what an
//! earlier run left behind.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

use pickglass::design::Design;
use pickglass::edit::recovery::{self, Found, Recovery};

use super::session::Session;
use super::task::{Outcome, Task};

/// Changed work is on the disk after at most about this long.
const EVERY: Duration = Duration::from_secs(5);

/// Where recovery copies are; `None` = none are kept.
#[derive(Debug, Clone, Default)]
pub struct RecoveryFolder(Option<PathBuf>);

impl RecoveryFolder {
    /// The user's own.
    pub fn of_user() -> Self {
        let folders = directories::ProjectDirs::from("", "", "pickglass");
        Self(folders.map(|folders| folders.data_local_dir().join("recovery")))
    }

    /// A folder of one's own.
    #[cfg(test)]
    pub fn at(path: PathBuf) -> Self {
        Self(Some(path))
    }
}

/// What the thread is asked for.
enum Order {
    Save {
        design: Arc<Design>,
        original: Option<PathBuf>,
        /// An earlier run's copy of the same work, taken away once this one is written.
        instead_of: Option<PathBuf>,
    },
    /// Nothing is unsaved any more.
    Clear,
}

/// The copies of this run, and those of earlier ones.
pub struct Autosave {
    folder: RecoveryFolder,
    orders: Option<Sender<Order>>,
    thread: Option<JoinHandle<()>>,
    failures: Option<Receiver<String>>,
    /// The revision that was sent last, and when.
    sent: Option<(u64, Instant)>,
    listing: Option<Task<(Vec<Found>, Vec<String>)>>,
    pub found: Vec<Found>,
    /// A copy that is open again, to be taken away once it is copied anew.
    reopened: Option<PathBuf>,
}

impl Autosave {
    /// Looks for what earlier runs left in the folder.
    pub fn new(ctx: &egui::Context, folder: RecoveryFolder) -> Self {
        let listing = folder.0.clone().and_then(|folder| {
            Task::start(ctx, "recovery", move || {
                let listing = recovery::list(&folder);
                let damaged = listing.damaged.iter().map(ToString::to_string);
                (listing.found, damaged.collect())
            })
            .ok()
        });
        Self {
            folder,
            orders: None,
            thread: None,
            failures: None,
            sent: None,
            listing,
            found: Vec::new(),
            reopened: None,
        }
    }

    /// What was found damaged, and what could not be written: one line each.
    pub fn poll(&mut self) -> Vec<String> {
        let mut told: Vec<String> = (self.failures.iter())
            .flat_map(|failures| failures.try_iter())
            .collect();
        if let Some(listing) = &self.listing
            && let Outcome::Ready((found, damaged)) = listing.poll()
        {
            self.found = found;
            told.extend(damaged);
            self.listing = None;
        }
        told
    }

    /// Copies unsaved work now and then; forgets the copy of what is saved.
    pub fn keep(&mut self, ctx: &egui::Context, session: &Session) {
        let document = &session.document;
        let revision = document.revision();
        if document.in_gesture() {
            return;
        }
        if !document.is_modified() {
            if self.sent.take().is_some() {
                self.send(Order::Clear);
            }
            return;
        }
        let due = match self.sent {
            Some((sent, _)) if sent == revision => return,
            Some((_, at)) => at + EVERY,
            None => Instant::now(),
        };
        let now = Instant::now();
        if now < due {
            ctx.request_repaint_after(due - now);
            return;
        }
        self.sent = Some((revision, now));
        let instead_of = self.reopened.take();
        self.send(Order::Save {
            design: session.design(),
            original: session.path.clone(),
            instead_of,
        });
    }

    /// The document is left, saved or not: its copy is not needed.
    pub fn leave(&mut self) {
        if self.sent.take().is_some() {
            self.send(Order::Clear);
        }
        if let Some(path) = self.reopened.take() {
            self.discard(&path);
        }
    }

    /// Says that a copy is open again.
    pub fn reopened(&mut self, path: PathBuf) {
        self.found.retain(|found| found.path != path);
        self.reopened = Some(path);
    }

    /// Takes a copy of an earlier run away.
    pub fn discard(&mut self, path: &Path) {
        self.found.retain(|found| found.path != path);
        discard(path);
    }

    fn send(&mut self, order: Order) {
        if self.orders.is_none() {
            self.start();
        }
        if let Some(orders) = &self.orders {
            let _ = orders.send(order);
        }
    }

    fn start(&mut self) {
        let Some(folder) = self.folder.0.clone() else {
            return;
        };
        let (orders, wanted) = channel::<Order>();
        let (tell, failures) = channel();
        let thread = std::thread::Builder::new().name("recovery".to_owned());
        match thread.spawn(move || write_copies(&folder, &wanted, &tell)) {
            Ok(thread) => {
                self.orders = Some(orders);
                self.failures = Some(failures);
                self.thread = Some(thread);
            }
            Err(error) => log::warn!("recovery copies cannot be written: {error}"),
        }
    }

    /// Waits until what was asked for is on the disk; the window is closing.
    pub fn finish(&mut self) {
        self.orders = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for Autosave {
    fn drop(&mut self) {
        self.finish();
    }
}

/// Writes what is ordered until the window closes. A copy that is not needed any more is
/// taken away; one of unsaved work stays behind.
fn write_copies(folder: &Path, wanted: &Receiver<Order>, tell: &Sender<String>) {
    let mut copy = match Recovery::begin(folder) {
        Ok(copy) => copy,
        Err(error) => {
            let _ = tell.send(error.to_string());
            return;
        }
    };
    let mut needed = false;
    while let Ok(order) = wanted.recv() {
        let done = match order {
            Order::Save {
                design,
                original,
                instead_of,
            } => {
                needed = true;
                let saved = copy.save(&design, original.as_deref());
                if let (Ok(_), Some(earlier)) = (&saved, instead_of) {
                    discard(&earlier);
                }
                saved.map(drop)
            }
            Order::Clear => {
                needed = false;
                copy.clear()
            }
        };
        if let Err(error) = done {
            let _ = tell.send(error.to_string());
        }
    }
    if !needed && let Err(error) = copy.close() {
        log::warn!("{error}");
    }
}

fn discard(path: &Path) {
    if let Err(error) = recovery::discard(path) {
        log::warn!("{error}");
    }
}

/// How long ago something was, in words.
pub fn ago(time: SystemTime) -> String {
    let seconds = time.elapsed().map_or(0, |elapsed| elapsed.as_secs());
    match seconds {
        0..60 => "just now".to_owned(),
        60..3600 => format!("{} min ago", seconds / 60),
        3600..86_400 => format!("{} h ago", seconds / 3600),
        _ => format!("{} days ago", seconds / 86_400),
    }
}
