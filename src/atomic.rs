//! Writing files so that nothing is ever half-written.
//!
//! What is written stands in a temporary file in the same folder until it is whole. That
//! file is locked as long as its writer lives: [`sweep`] removes those that a killed program
//! left, and no others. A link is followed, so that it stays one; pipes, devices and folders
//! are never replaced.

use std::fs::{self, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// What the names of temporary files begin and end with.
const TEMPORARY: [&str; 2] = [".pickglass-", ".tmp"];

/// Links that are followed, one leading to the next.
const MOST_LINKS: u32 = 40;

/// A file that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}; {}", path.display(), self.remedy())]
pub struct WriteError {
    /// The file that was to be written; what was there before is unchanged.
    pub path: PathBuf,
    /// What the system said.
    pub source: io::Error,
}

impl WriteError {
    fn remedy(&self) -> &'static str {
        match self.source.kind() {
            io::ErrorKind::NotFound => "make its folder first",
            io::ErrorKind::IsADirectory | io::ErrorKind::InvalidInput => {
                "name a file that is to be written"
            }
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                "choose a folder you may write to"
            }
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                "free some space or choose another disk"
            }
            _ => "what was there before is unchanged",
        }
    }
}

/// Puts `bytes` at `path`, whole or not at all: written to a temporary file in the same
/// folder, brought to the disk, then renamed over `path`.
///
/// # Errors
/// [`WriteError`]; the temporary file is removed and `path` is as it was.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_with(path, |out| out.write_all(bytes))
}

/// As [`write()`], with the bytes produced by `fill` into a buffered file.
///
/// # Errors
/// [`WriteError`]; also what `fill` returns.
pub fn write_with(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    put(path, fill).map_err(|source| WriteError {
        path: path.to_owned(),
        source,
    })
}

fn put(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let target = target(path)?;
    let mut pending = create(&target)?;
    {
        let mut out = io::BufWriter::new(pending.as_file_mut());
        fill(&mut out)?;
        out.flush()?;
    }
    finish(pending, &target)
}

/// Tries whether a file can be written at `path`, and leaves nothing but what was there;
/// also sweeps the folder.
///
/// # Errors
/// [`WriteError`] where it cannot.
pub fn try_out(path: &Path) -> Result<(), WriteError> {
    let tried = target(path).and_then(|target| {
        sweep(folder_of(&target));
        create(&target).map(drop)
    });
    tried.map_err(|source| WriteError {
        path: path.to_owned(),
        source,
    })
}

/// A file that is being written and is nowhere until [`Pending::commit`]; dropping it
/// leaves everything as it was.
#[derive(Debug)]
pub struct Pending {
    file: NamedTempFile,
    path: PathBuf,
    /// Where `path` leads.
    target: PathBuf,
}

impl Pending {
    /// Begins a file that shall stand at `path`.
    ///
    /// # Errors
    /// [`WriteError`] where the folder cannot be written.
    pub fn create(path: &Path) -> Result<Self, WriteError> {
        let path = path.to_owned();
        let created = target(&path).and_then(|target| Ok((create(&target)?, target)));
        match created {
            Ok((file, target)) => Ok(Self { file, path, target }),
            Err(source) => Err(WriteError { path, source }),
        }
    }

    /// Where it shall stand.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file, to be written anywhere in it.
    pub fn file(&mut self) -> &mut std::fs::File {
        self.file.as_file_mut()
    }

    /// What the system said, with the file's name.
    pub fn failed(&self, source: io::Error) -> WriteError {
        let path = self.path.clone();
        WriteError { path, source }
    }

    /// Brings the file to the disk and puts it in its place.
    ///
    /// # Errors
    /// [`WriteError`]; what was there before is then unchanged.
    pub fn commit(self) -> Result<(), WriteError> {
        let Self { file, path, target } = self;
        finish(file, &target).map_err(|source| WriteError { path, source })
    }
}

/// The folder that a file stands in.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Where a file stands that is written to `path`: links are followed, also one whose file
/// is not there yet.
fn target(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(about) = fs::symlink_metadata(&path) else {
            return Ok(path);
        };
        if !about.is_symlink() {
            return match about {
                about if about.is_file() => Ok(path),
                about if about.is_dir() => {
                    let text = "it is a folder";
                    Err(io::Error::new(io::ErrorKind::IsADirectory, text))
                }
                _ => Err(io::Error::new(
                    io::ErrorKind::InvalidInput,
                    "it is a pipe, a device or a socket",
                )),
            };
        }
        let to = fs::read_link(&path)?;
        path = folder_of(&path).join(to);
    }
    Err(io::Error::new(
        io::ErrorKind::InvalidInput,
        "links lead from one to the next without end",
    ))
}

/// A temporary file in `folder`, locked for as long as it is open; where the system has no
/// locks it is not, and no sweep touches it.
pub(crate) fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let mut options = tempfile::Builder::new();
    options.prefix(TEMPORARY[0]).suffix(TEMPORARY[1]);
    #[cfg(unix)]
    {
        // As any new file: readable by whom the umask allows; an old file keeps its own.
        use std::os::unix::fs::PermissionsExt;
        options.permissions(fs::Permissions::from_mode(0o666));
    }
    loop {
        let file = options.tempfile_in(folder)?;
        // Another program's sweep may take it before it is locked.
        let taken = matches!(file.as_file().try_lock(), Err(TryLockError::WouldBlock));
        if !taken && file.path().exists() {
            return Ok(file);
        }
    }
}

/// Removes the temporary files in `folder` that no living program holds, and says how many
/// they were.
pub fn sweep(folder: &Path) -> usize {
    let Ok(entries) = fs::read_dir(folder) else {
        return 0;
    };
    let [before, after] = TEMPORARY;
    let orphan = |entry: &fs::DirEntry| {
        let name = entry.file_name();
        let named = (name.to_str()).is_some_and(|n| n.starts_with(before) && n.ends_with(after));
        if !named || !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            return false;
        }
        let opened = fs::File::options().write(true).open(entry.path());
        // It goes while it is locked, so that nobody begins to write into it meanwhile.
        opened.is_ok_and(|file| file.try_lock().is_ok() && fs::remove_file(entry.path()).is_ok())
    };
    entries.flatten().filter(orphan).count()
}

fn create(target: &Path) -> io::Result<NamedTempFile> {
    let file = temporary(folder_of(target))?;
    if let Ok(old) = fs::metadata(target)
        && old.is_file()
    {
        file.as_file().set_permissions(old.permissions())?;
    }
    Ok(file)
}

fn finish(file: NamedTempFile, path: &Path) -> io::Result<()> {
    file.as_file().sync_all()?;
    file.persist(path).map_err(|failed| failed.error)?;
    // The rename itself lasts once the folder is on the disk; not every system can do it.
    #[cfg(unix)]
    if let Ok(folder) = std::fs::File::open(folder_of(path)) {
        let _ = folder.sync_all();
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    }

    #[test]
    fn a_file_is_replaced_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("design.ron");
        write(&path, b"old").unwrap();
        write(&path, b"new and longer").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new and longer");
        assert_eq!(names(folder.path()), ["design.ron"]);
    }

    #[test]
    fn a_failure_half_way_leaves_the_old_file_and_no_rubbish() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("design.ron");
        write(&path, b"old").unwrap();
        let failed = write_with(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("the pen broke"))
        });
        let message = failed.unwrap_err().to_string();
        assert!(message.contains("design.ron") && message.contains("the pen broke"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["design.ron"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_named_with_a_remedy_and_keeps_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("design.ron");
        write(&path, b"old").unwrap();
        // The device that is always full.
        let failed = write_with(&path, |out| {
            out.write_all(b"half")?;
            std::fs::OpenOptions::new()
                .write(true)
                .open("/dev/full")?
                .write_all(b"more")
        });
        let message = failed.unwrap_err().to_string();
        assert!(message.contains("free some space"), "{message}");
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["design.ron"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_stay_links() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        std::fs::create_dir(place("kept")).unwrap();
        write(&place("kept/design.ron"), b"old").unwrap();
        symlink("kept/design.ron", place("first.ron")).unwrap();
        symlink(place("first.ron"), place("second.ron")).unwrap();
        // One that leads to a file that is not there yet.
        symlink("kept/new.ron", place("third.ron")).unwrap();
        for (link, file) in [
            ("second.ron", "kept/design.ron"),
            ("third.ron", "kept/new.ron"),
        ] {
            write(&place(link), link.as_bytes()).unwrap();
            let mut pending = Pending::create(&place(link)).unwrap();
            pending.file().write_all(b"through ").unwrap();
            pending.file().write_all(link.as_bytes()).unwrap();
            pending.commit().unwrap();
            let read = std::fs::read_to_string(place(file)).unwrap();
            assert_eq!(read, format!("through {link}"));
            assert!(std::fs::symlink_metadata(place(link)).unwrap().is_symlink());
        }
        symlink("round.ron", place("round.ron")).unwrap();
        assert!(write(&place("round.ron"), b"").is_err());
    }

    #[cfg(unix)]
    #[test]
    fn pipes_sockets_devices_and_folders_are_refused_and_stay() {
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("socket");
        let listening = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        for path in [&socket, Path::new("/dev/null"), folder.path()] {
            for failed in [write(path, b"x").unwrap_err(), try_out(path).unwrap_err()] {
                let message = failed.to_string();
                assert!(message.contains("name a file that is to be"), "{message}");
            }
        }
        let kind = std::fs::metadata(&socket).unwrap().file_type();
        assert!(kind.is_socket());
        drop(listening);
    }

    #[test]
    fn only_what_nobody_holds_is_swept() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let held = Pending::create(&place("design.ron")).unwrap();
        std::fs::write(place(".pickglass-gone.tmp"), b"half").unwrap();
        std::fs::write(place(".other.tmp"), b"").unwrap();
        assert_eq!(sweep(folder.path()), 1);
        held.commit().unwrap();
        let mut left = names(folder.path());
        left.sort();
        assert_eq!(left, [".other.tmp", "design.ron"]);
        // Trying a place out sweeps too, and leaves nothing.
        std::fs::write(place(".pickglass-gone.tmp"), b"half").unwrap();
        try_out(&place("new.ron")).unwrap();
        assert_eq!(names(folder.path()).len(), 2);
    }

    #[test]
    fn a_missing_folder_is_named_with_a_remedy() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing/design.ron");
        let message = write(&path, b"").unwrap_err().to_string();
        assert!(message.contains("make its folder first"), "{message}");
    }
}
