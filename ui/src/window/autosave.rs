//! Recovery copies of the open document, written on a thread of their own, and what an
//! earlier run left behind.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

use pickglass::design::Design;
use pickglass::edit::recovery::{self, Found, Recovery, RecoveryError};

use super::session::Session;
use super::task::{Outcome, Task};

/// Changed work is on the disk after at most about this long; 10 s are promised.
const EVERY: Duration = Duration::from_secs(5);
// The other half is for the writing.
const _: () = assert!(EVERY.as_secs() <= 5);

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
        open: Open,
        /// An earlier run's copy of the same work, taken away once this one is written.
        instead_of: Option<PathBuf>,
    },
    /// Nothing is unsaved any more.
    Clear,
    /// The window is lost: bring what is open to safety now, then do this.
    Rescue(Arc<dyn Fn(Rescued) + Send + Sync>),
    /// The window closes.
    End,
}

/// What is open, as the window left it last.
#[derive(Clone)]
struct Open {
    design: Arc<Design>,
    original: Option<PathBuf>,
    modified: bool,
}

/// What was brought to safety when the window was lost.
#[derive(Debug, PartialEq, Eq)]
pub enum Rescued {
    /// Nothing was open.
    Nothing,
    /// All of it is in this file of the person's own.
    File(PathBuf),
    /// A recovery copy.
    Copy(PathBuf),
    /// It could not be written: one line that says why.
    Failed(String),
}

/// Brings what is open to safety, from whatever thread finds the window lost.
#[derive(Clone)]
pub struct Rescuer(Sender<Order>);

impl Rescuer {
    /// Has what is open written and then `then` done, on the thread of the copies: the
    /// window's own thread may hang or break meanwhile.
    pub fn rescue(&self, then: Arc<dyn Fn(Rescued) + Send + Sync>) {
        // Without that thread the window is closed, and nothing is open.
        let _ = self.0.send(Order::Rescue(then));
    }
}

/// The copies of this run, and those of earlier ones.
pub struct Autosave {
    folder: RecoveryFolder,
    orders: Option<Sender<Order>>,
    thread: Option<JoinHandle<()>>,
    failures: Option<Receiver<String>>,
    /// What a rescue writes.
    open: Arc<Mutex<Option<Open>>>,
    /// How long changes may wait.
    every: Duration,
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
            open: Arc::default(),
            every: EVERY,
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
            // What this run was started on is open, not left.
            self.found
                .retain(|found| Some(&found.path) != self.reopened.as_ref());
            told.extend(damaged);
            self.listing = None;
        }
        told
    }

    /// Copies unsaved work now and then; forgets the copy of what is saved.
    pub fn keep(&mut self, ctx: &egui::Context, session: &Session) {
        let document = &session.document;
        let revision = document.revision();
        if !document.is_modified() {
            if self.sent.take().is_some() {
                self.send(Order::Clear);
            }
            return;
        }
        let due = match self.sent {
            Some((sent, _)) if sent == revision => return,
            Some((_, at)) => at + self.every,
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
            open: Open::of(session),
            instead_of,
        });
    }

    /// Takes note of what is open, for a rescue: cheap, and done at the end of each frame.
    pub fn note(&self, session: Option<&Session>) {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        *open = session.map(Open::of);
    }

    fn has_unsaved(&self) -> bool {
        let open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.as_ref().is_some_and(|open| open.modified)
    }

    /// Who brings what is open to safety when the window is lost.
    pub fn rescuer(&mut self) -> Option<Rescuer> {
        self.start();
        self.orders.clone().map(Rescuer)
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
        self.start();
        if let Some(orders) = &self.orders {
            let _ = orders.send(order);
        }
    }

    fn start(&mut self) {
        if self.orders.is_some() {
            return;
        }
        let (orders, wanted) = channel::<Order>();
        let (tell, failures) = channel();
        let copies = Copies {
            folder: self.folder.0.clone(),
            open: Arc::clone(&self.open),
            copy: None,
            needed: false,
        };
        let thread = std::thread::Builder::new().name("recovery".to_owned());
        match thread.spawn(move || copies.write(&wanted, &tell)) {
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
        if let Some(orders) = self.orders.take() {
            let _ = orders.send(Order::End);
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Open {
    fn of(session: &Session) -> Self {
        Self {
            design: session.design(),
            original: session.path.clone(),
            modified: session.document.is_modified(),
        }
    }
}

impl Drop for Autosave {
    fn drop(&mut self) {
        // What breaks the window costs nothing of the work.
        if std::thread::panicking() && self.has_unsaved() {
            self.send(Order::Rescue(Arc::new(|_| {})));
        }
        self.finish();
    }
}

/// The thread of the copies.
struct Copies {
    folder: Option<PathBuf>,
    open: Arc<Mutex<Option<Open>>>,
    copy: Option<Recovery>,
    /// Something unsaved is in the copy.
    needed: bool,
}

impl Copies {
    /// Writes what is ordered until the window closes. A copy that is not needed any more
    /// is taken away; one of unsaved work stays behind.
    fn write(mut self, wanted: &Receiver<Order>, tell: &Sender<String>) {
        while let Ok(order) = wanted.recv() {
            let done = match order {
                Order::Save { open, instead_of } => self.save(&open, instead_of.as_deref()),
                Order::Clear => {
                    self.needed = false;
                    self.copy.as_mut().map_or(Ok(()), Recovery::clear)
                }
                Order::Rescue(then) => {
                    let rescued = self.rescue();
                    // The lock on the copy ends here: who opens it next may be at it now.
                    self.copy = None;
                    then(rescued);
                    Ok(())
                }
                Order::End => break,
            };
            if let Err(error) = done {
                let _ = tell.send(error.to_string());
            }
        }
        if !self.needed
            && let Some(copy) = self.copy
            && let Err(error) = copy.close()
        {
            log::warn!("{error}");
        }
    }

    fn save(&mut self, open: &Open, instead_of: Option<&Path>) -> Result<(), RecoveryError> {
        let Some(folder) = &self.folder else {
            return Ok(());
        };
        let copy = match &mut self.copy {
            Some(copy) => copy,
            None => self.copy.insert(Recovery::begin(folder)?),
        };
        copy.save(&open.design, open.original.as_deref())?;
        self.needed = true;
        if let Some(earlier) = instead_of {
            discard(earlier);
        }
        Ok(())
    }

    fn rescue(&mut self) -> Rescued {
        let open = (self.open.lock().unwrap_or_else(PoisonError::into_inner)).clone();
        let Some(open) = open else {
            return Rescued::Nothing;
        };
        match &open.original {
            Some(file) if !open.modified => Rescued::File(file.clone()),
            _ => match (self.save(&open, None), &self.copy) {
                (Ok(()), Some(copy)) => Rescued::Copy(copy.path().to_owned()),
                (Ok(()), None) => Rescued::Failed("there is no folder for copies".to_owned()),
                (Err(error), _) => Rescued::Failed(error.to_string()),
            },
        }
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

#[cfg(test)]
impl Autosave {
    /// Changes are copied at once.
    pub fn without_waiting(&mut self) {
        self.every = Duration::ZERO;
    }
}
