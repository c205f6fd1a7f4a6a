//! Writing files so that nothing is ever half-written.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

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
    let mut pending = create(path)?;
    {
        let mut out = io::BufWriter::new(pending.as_file_mut());
        fill(&mut out)?;
        out.flush()?;
    }
    finish(pending, path)
}

/// A file that is being written and is nowhere until [`Pending::commit`]; dropping it
/// leaves everything as it was.
#[derive(Debug)]
pub struct Pending {
    file: tempfile::NamedTempFile,
    path: PathBuf,
}

impl Pending {
    /// Begins a file that shall stand at `path`.
    ///
    /// # Errors
    /// [`WriteError`] where the folder cannot be written.
    pub fn create(path: &Path) -> Result<Self, WriteError> {
        let path = path.to_owned();
        match create(&path) {
            Ok(file) => Ok(Self { file, path }),
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
        let Self { file, path } = self;
        finish(file, &path).map_err(|source| WriteError { path, source })
    }
}

/// The folder that a file stands in.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn create(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let folder = folder_of(path);
    let mut options = tempfile::Builder::new();
    options.prefix(".pickglass-").suffix(".tmp");
    #[cfg(unix)]
    {
        // As any new file: readable by whom the umask allows; an old file keeps its own.
        use std::os::unix::fs::PermissionsExt;
        options.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let file = options.tempfile_in(folder)?;
    if let Ok(old) = std::fs::metadata(path)
        && old.is_file()
    {
        file.as_file().set_permissions(old.permissions())?;
    }
    Ok(file)
}

fn finish(file: tempfile::NamedTempFile, path: &Path) -> io::Result<()> {
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

    #[test]
    fn a_missing_folder_is_named_with_a_remedy() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing/design.ron");
        let message = write(&path, b"").unwrap_err().to_string();
        assert!(message.contains("make its folder first"), "{message}");
    }
}
