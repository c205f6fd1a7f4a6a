//! Recovery copies: what is left of unsaved work when the program ends before it is saved.
//!
//! Every open document has a file of its own in the recovery folder: a whole design, and
//! after it the tiles that changed since, appended with a checksum each (`journal`). A file
//! next to it is locked as long as its program runs, so that another program neither offers
//! nor touches the work of one that is alive.
//!
//! What is damaged is told and skipped; a torn end costs what was appended last.

mod journal;

use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use crate::atomic::{self, WriteError};
use crate::design::Design;
use crate::formats::ron::{self, RonError};
use journal::{Head, Kind};

/// The ending of a recovery file's name.
const ENDING: &str = "recovery";
/// The ending of the file that is locked while its program runs.
const LOCK_ENDING: &str = "lock";
/// The largest recovery file that is read.
const MOST_BYTES: u64 = 1 << 31;

/// A recovery copy that cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum RecoveryError {
    /// The folder or a file in it cannot be written.
    #[error("recovery copy: {0}")]
    Write(#[from] WriteError),
    /// The design cannot be put into a document.
    #[error("recovery copy: {0}")]
    Design(#[from] RonError),
    /// A file that cannot be read.
    #[error("recovery copy {}: {source}; choose another or discard it", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file that is not what it should be.
    #[error("recovery copy {}: damaged: {problem}; discard it", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
}

/// What [`Recovery::save`] did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Saved {
    /// Nothing: the design is the one that was saved last.
    Unchanged,
    /// Changed tiles were added to the file.
    Tiles {
        /// Bytes written.
        bytes: u64,
    },
    /// The whole design was written.
    Whole {
        /// Bytes written.
        bytes: u64,
    },
}

/// The recovery copy of one open document. Leaves its file behind when it is dropped, as a
/// crash would; [`Recovery::clear`] takes it away.
#[derive(Debug)]
pub struct Recovery {
    path: PathBuf,
    lock_path: PathBuf,
    /// Held, and with it the lock, until the program ends.
    _lock: File,
    /// What the file holds.
    written: Option<Arc<Design>>,
    original: Option<PathBuf>,
    /// Bytes of the whole design at the head of the file, and of all of the file.
    base: u64,
    length: u64,
}

impl Recovery {
    /// A recovery copy in a folder, which is made if it is not there.
    ///
    /// # Errors
    /// [`RecoveryError::Write`] where the folder cannot be made or written.
    pub fn begin(folder: &Path) -> Result<Self, RecoveryError> {
        let failed = |source| WriteError {
            path: folder.to_owned(),
            source,
        };
        std::fs::create_dir_all(folder).map_err(failed)?;
        let mut names = tempfile::Builder::new();
        names.prefix("design-").suffix(".lock");
        let unique = names.tempfile_in(folder).map_err(failed)?;
        let (lock, lock_path) = unique.keep().map_err(|error| failed(error.error))?;
        // Where files cannot be locked, names alone keep programs apart.
        let _ = lock.try_lock();
        Ok(Self {
            path: lock_path.with_extension(ENDING),
            lock_path,
            _lock: lock,
            written: None,
            original: None,
            base: 0,
            length: 0,
        })
    }

    /// The recovery file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Brings a design to the disk: only the tiles that changed where nothing else did.
    /// `original` is the file it was opened from or saved as.
    ///
    /// # Errors
    /// [`RecoveryError`]; what was on the disk before can still be recovered.
    pub fn save(
        &mut self,
        design: &Arc<Design>,
        original: Option<&Path>,
    ) -> Result<Saved, RecoveryError> {
        let same_file = self.original.as_deref() == original;
        if let Some(written) = &self.written
            && same_file
            && self.path.exists()
        {
            if Arc::ptr_eq(written, design) || written == design {
                return Ok(Saved::Unchanged);
            }
            // Tiles are worth it while they stay below the design they follow.
            let room = (2 * self.base).saturating_sub(self.length).max(1 << 16);
            if let Some(tiles) = journal::changed_tiles(written, design, room) {
                let bytes = self.append(&journal::record(Kind::Tiles, &tiles))?;
                self.written = Some(Arc::clone(design));
                return Ok(Saved::Tiles { bytes });
            }
        }
        let head = Head::now(&design.name, original);
        let mut bytes = journal::MAGIC.to_vec();
        bytes.extend(journal::record(Kind::Head, &head.bytes()));
        bytes.extend(journal::record(
            Kind::Design,
            ron::write(design)?.as_bytes(),
        ));
        atomic::write(&self.path, &bytes)?;
        self.written = Some(Arc::clone(design));
        self.original = original.map(Path::to_owned);
        (self.base, self.length) = (bytes.len() as u64, bytes.len() as u64);
        let bytes = self.base;
        Ok(Saved::Whole { bytes })
    }

    /// Adds a record; after a failure the file is cut back to what was whole.
    fn append(&mut self, record: &[u8]) -> Result<u64, RecoveryError> {
        let append = || -> std::io::Result<()> {
            let mut file = OpenOptions::new().write(true).open(&self.path)?;
            let done = file
                .seek(SeekFrom::Start(self.length))
                .and_then(|_| file.write_all(record))
                .and_then(|()| file.sync_data());
            if done.is_err() {
                let _ = file.set_len(self.length);
            }
            done
        };
        append().map_err(|source| WriteError {
            path: self.path.clone(),
            source,
        })?;
        self.length += record.len() as u64;
        Ok(record.len() as u64)
    }

    /// Takes the copy away: the document was saved, or its changes were given up.
    ///
    /// # Errors
    /// [`RecoveryError::Write`] if it cannot be removed.
    pub fn clear(&mut self) -> Result<(), RecoveryError> {
        self.written = None;
        Ok(remove(&self.path)?)
    }

    /// [`Recovery::clear`], for a document that is closed.
    ///
    /// # Errors
    /// [`RecoveryError::Write`] if it cannot be removed.
    pub fn close(mut self) -> Result<(), RecoveryError> {
        self.clear()?;
        Ok(remove(&self.lock_path)?)
    }
}

fn remove(path: &Path) -> Result<(), WriteError> {
    match std::fs::remove_file(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => Err(WriteError {
            path: path.to_owned(),
            source,
        }),
        _ => Ok(()),
    }
}

/// A recovery copy that some earlier run left behind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// The recovery file.
    pub path: PathBuf,
    /// What the design was called.
    pub name: String,
    /// The file it was opened from or saved as, if any.
    pub original: Option<PathBuf>,
    /// When it was written last.
    pub time: SystemTime,
}

/// What a recovery folder holds.
#[derive(Debug, Default)]
pub struct Listing {
    /// Copies that can be offered, the newest first.
    pub found: Vec<Found>,
    /// Files that cannot be read, each with the reason.
    pub damaged: Vec<RecoveryError>,
}

/// The copies in a folder whose programs are gone. A folder that is not there, or cannot be
/// read, holds none.
pub fn list(folder: &Path) -> Listing {
    let mut listing = Listing::default();
    let Ok(entries) = std::fs::read_dir(folder) else {
        return listing;
    };
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.extension().is_none_or(|ending| ending != ENDING) || alive(&path) {
            continue;
        }
        match describe(&path) {
            Ok(found) => listing.found.push(found),
            Err(error) => listing.damaged.push(error),
        }
    }
    listing
        .found
        .sort_by(|a, b| b.time.cmp(&a.time).then_with(|| a.path.cmp(&b.path)));
    listing
}

/// Whether the program that writes a copy still runs.
fn alive(path: &Path) -> bool {
    match File::open(path.with_extension(LOCK_ENDING)) {
        Ok(lock) => matches!(lock.try_lock(), Err(std::fs::TryLockError::WouldBlock)),
        Err(_) => false,
    }
}

/// What is known of a copy without reading its design, whether its program runs or not.
///
/// # Errors
/// [`RecoveryError`] if it cannot be read or is no copy.
pub fn describe(path: &Path) -> Result<Found, RecoveryError> {
    let unreadable = |source| RecoveryError::Read {
        path: path.to_owned(),
        source,
    };
    let file = File::open(path).map_err(unreadable)?;
    let time = file
        .metadata()
        .and_then(|known| known.modified())
        .map_err(unreadable)?;
    let mut bytes = Vec::new();
    file.take(journal::MOST_HEAD)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    let head = journal::head(&bytes).map_err(|problem| damaged(path, problem))?;
    Ok(Found {
        path: path.to_owned(),
        name: head.name,
        original: head.original.map(PathBuf::from),
        time,
    })
}

fn damaged(path: &Path, problem: String) -> RecoveryError {
    let path = path.to_owned();
    RecoveryError::Damaged { path, problem }
}

/// A design as it was recovered.
#[derive(Debug)]
pub struct Recovered {
    /// The design.
    pub design: Design,
    /// What could not be read after it, for a person.
    pub lost: Option<String>,
}

/// Reads a copy: the design, and as many of the changes after it as are whole.
///
/// # Errors
/// [`RecoveryError`] if there is not even the design.
pub fn load(path: &Path) -> Result<Recovered, RecoveryError> {
    let unreadable = |source| RecoveryError::Read {
        path: path.to_owned(),
        source,
    };
    let file = File::open(path).map_err(unreadable)?;
    if file.metadata().map_err(unreadable)?.len() > MOST_BYTES {
        return Err(damaged(path, format!("more than {MOST_BYTES} bytes")));
    }
    let mut bytes = Vec::new();
    file.take(MOST_BYTES)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    let (design, lost) = journal::read(&bytes).map_err(|problem| damaged(path, problem))?;
    Ok(Recovered { design, lost })
}

/// Takes a copy that was found away for good.
///
/// # Errors
/// [`RecoveryError::Write`] if it cannot be removed.
pub fn discard(path: &Path) -> Result<(), RecoveryError> {
    remove(path)?;
    Ok(remove(&path.with_extension(LOCK_ENDING))?)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests;
