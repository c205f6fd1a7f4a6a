//! Where something is about to be written: tried before the work begins, and never one of
//! the files that the work reads.

use std::path::{Path, PathBuf};

use crate::atomic::{self, WriteError, folder_of};

/// A place that nothing can or shall be written to.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// There is no such folder.
    #[error(
        "{}: the folder {} does not exist: make it, or choose another", .0.display(),
        folder_of(.0).display()
    )]
    NoFolder(PathBuf),
    /// A name that would break out of the texts that name files.
    #[error(
        "{}: a file that is written may have no line break in its name: choose another name", .0.display()
    )]
    Name(PathBuf),
    /// It cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// It is one of the files that are read.
    #[error(
        "{}: this is the file {} that is read, and writing would destroy it: choose another \
         name for what is written", path.display(), input.display()
    )]
    Input {
        /// The file to be written.
        path: PathBuf,
        /// The same file, as it is named where it is read.
        input: PathBuf,
    },
}

/// Says whether a file can be written at `path`, and that it is none of the `inputs`, by
/// whatever name or link. Nothing is left there.
///
/// # Errors
/// [`OutputError`].
pub fn check<'i>(
    path: &Path,
    inputs: impl IntoIterator<Item = &'i Path>,
) -> Result<(), OutputError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if name.contains(['\n', '\r']) {
        return Err(OutputError::Name(path.to_owned()));
    }
    if !folder_of(path).is_dir() {
        return Err(OutputError::NoFolder(path.to_owned()));
    }
    is_no_input(path, inputs)?;
    Ok(atomic::try_out(path)?)
}

/// Refuses a file to be written that is one of the `inputs`, by whatever name or link.
///
/// # Errors
/// [`OutputError::Input`].
pub fn is_no_input<'i>(
    path: &Path,
    inputs: impl IntoIterator<Item = &'i Path>,
) -> Result<(), OutputError> {
    // Only files are opened to be told apart: a pipe would wait for its other end.
    if !path.is_file() {
        return Ok(());
    }
    let same =
        |input: &&Path| input.is_file() && same_file::is_same_file(path, input).unwrap_or(false);
    match inputs.into_iter().find(same) {
        Some(input) => Err(OutputError::Input {
            path: path.to_owned(),
            input: input.to_owned(),
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn an_input_is_known_by_what_it_is_not_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        for name in ["w.png", "other.png"] {
            std::fs::write(place(name), b"a weave").unwrap();
        }
        std::os::unix::fs::symlink("w.png", place("link.png")).unwrap();
        std::fs::hard_link(place("w.png"), place("hard.png")).unwrap();
        let same = [
            place("w.png"),
            place("./w.png"),
            place("link.png"),
            place("hard.png"),
        ];
        for output in &same {
            for input in &same {
                let inputs = [Path::new("absent.exr"), Path::new("/dev/null"), input];
                let refused = check(output, inputs).unwrap_err().to_string();
                assert!(refused.contains("would destroy it"), "{refused}");
            }
            // An equal file is another one.
            assert!(check(output, [&*place("other.png")]).is_ok());
        }
        assert!(check(&place("new.png"), [&*place("w.png")]).is_ok());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 4);
    }

    #[test]
    fn a_name_with_a_line_break_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        for (name, sound) in [
            ("a\nb.obj", false),
            ("a\r.mhd", false),
            ("a\tb.mhd", true),
            ("a b.obj", true),
        ] {
            assert_eq!(
                check(&folder.path().join(name), []).is_ok(),
                sound,
                "{name:?}"
            );
        }
    }

    #[test]
    fn a_place_that_cannot_be_written_is_told_before() {
        for path in ["/no/such/folder/o.png", "/proc/o.png", "/"] {
            assert!(check(Path::new(path), []).is_err(), "{path}");
        }
    }
}
