//! The room that exemplars take on the disk: how much it is, how much it may be, and how it
//! is given back, the least recently used first.
//!
//! The limit stands in the folder itself, so that the window and the command line keep the
//! same.

use std::path::{Path, PathBuf};
use std::time::SystemTime;
use std::{fs, io};

use super::store::ExemplarStore;
use crate::atomic;

/// Bytes that the folder may hold where nobody said otherwise.
pub const USUAL_LIMIT: u64 = 2_000_000_000;
/// The least and the most that one may ask for.
pub const LIMITS: std::ops::RangeInclusive<u64> = 100_000_000..=1_000_000_000_000;
/// The file in the folder that says another limit, in bytes.
const LIMIT_FILE: &str = "limit";
/// The ending of an exemplar's file.
pub(super) const ENDING: &str = "exemplars";

/// One exemplar's file: when it was used last, its bytes and its path.
type Kept = (SystemTime, u64, PathBuf);

impl ExemplarStore {
    /// The folder, if anything is kept.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Bytes that its files take now.
    pub fn size(&self) -> u64 {
        self.kept().iter().map(|file| file.1).sum()
    }

    /// Bytes that its files may take.
    pub fn limit(&self) -> u64 {
        let said = self.folder.as_ref().and_then(|folder| {
            let text = fs::read_to_string(folder.join(LIMIT_FILE)).ok()?;
            let bytes: u64 = text.trim().parse().ok()?;
            Some(bytes.clamp(*LIMITS.start(), *LIMITS.end()))
        });
        said.unwrap_or(self.usual_limit)
    }

    /// Lets its files take so many bytes, within [`LIMITS`], from now on and in every run;
    /// what is beyond gives way at once, the least recently used first.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn set_limit(&self, bytes: u64) -> io::Result<()> {
        let Some(folder) = &self.folder else {
            return Ok(());
        };
        fs::create_dir_all(folder)?;
        let bytes = bytes.clamp(*LIMITS.start(), *LIMITS.end());
        let path = folder.join(LIMIT_FILE);
        let text = format!("{bytes}\n");
        atomic::write(&path, text.as_bytes())
            .map_err(|error| io::Error::other(error.to_string()))?;
        self.make_room(None);
        Ok(())
    }

    /// Removes all its files; what is needed is built again. Returns the bytes that became
    /// free.
    ///
    /// # Errors
    /// When a file cannot be removed; the others are.
    pub fn empty(&self) -> io::Result<u64> {
        let (mut free, mut failed) = (0, None);
        for (_, length, path) in self.kept() {
            match fs::remove_file(&path) {
                Ok(()) => free += length,
                // Somebody else was faster.
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Err(error) => failed = Some(error),
            }
        }
        failed.map_or(Ok(free), Err)
    }

    /// Removes the least recently used files beyond the limit, never `keep`.
    pub(super) fn make_room(&self, keep: Option<&Path>) {
        if let Some(folder) = &self.folder {
            atomic::sweep(folder);
        }
        let (files, limit) = (self.kept(), self.limit());
        let mut total: u64 = files.iter().map(|file| file.1).sum();
        for (_, length, path) in files {
            if total > limit && Some(path.as_path()) != keep && fs::remove_file(&path).is_ok() {
                total -= length;
            }
        }
    }

    /// Its files, the least recently used first.
    fn kept(&self) -> Vec<Kept> {
        let Some(Ok(entries)) = self.folder.as_ref().map(fs::read_dir) else {
            return Vec::new();
        };
        let mut files: Vec<Kept> = entries
            .flatten()
            .filter(|entry| entry.path().extension().is_some_and(|end| end == ENDING))
            .filter_map(|entry| {
                let metadata = entry.metadata().ok()?;
                Some((metadata.modified().ok()?, metadata.len(), entry.path()))
            })
            .collect();
        files.sort();
        files
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use std::fs::File;
    use std::time::Duration;

    use super::*;

    /// A store with files of a MiB, the first used least recently, and something else.
    fn filled(folder: &Path, files: u64) -> ExemplarStore {
        for number in 0..files {
            let path = folder.join(format!("{number:03}.{ENDING}"));
            let file = File::create(&path).unwrap();
            file.set_len(1 << 20).unwrap();
            let used = SystemTime::UNIX_EPOCH + Duration::from_secs(1000 + number);
            file.set_modified(used).unwrap();
        }
        fs::write(folder.join("notes.txt"), "mine").unwrap();
        ExemplarStore::at(folder, USUAL_LIMIT)
    }

    #[test]
    fn a_smaller_limit_takes_the_least_recently_used_at_once_and_stays() {
        let folder = tempfile::tempdir().unwrap();
        let store = filled(folder.path(), 100);
        assert_eq!((store.size(), store.limit()), (100 << 20, USUAL_LIMIT));
        // Below the least limit, which is what counts.
        store.set_limit(1).unwrap();
        assert_eq!((store.size(), store.limit()), (95 << 20, *LIMITS.start()));
        let there = |number: u64| folder.path().join(format!("{number:03}.{ENDING}")).exists();
        assert!(!there(4) && there(5) && there(99));
        // Another run, another limit: that of the folder holds.
        let again = ExemplarStore::at(folder.path(), USUAL_LIMIT);
        assert_eq!(again.limit(), *LIMITS.start());
        for damaged in ["", "much", "-3"] {
            fs::write(folder.path().join(LIMIT_FILE), damaged).unwrap();
            assert_eq!(store.limit(), USUAL_LIMIT, "{damaged:?}");
        }
    }

    #[test]
    fn emptying_takes_exemplars_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let store = filled(folder.path(), 3);
        assert_eq!(store.empty().unwrap(), 3 << 20);
        assert_eq!(store.size(), 0);
        assert!(folder.path().join("notes.txt").exists());
        assert_eq!(store.empty().unwrap(), 0);
        assert_eq!(ExemplarStore::none().empty().unwrap(), 0);
        assert_eq!(ExemplarStore::none().size(), 0);
    }
}
