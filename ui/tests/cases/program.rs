//! The program in a folder of its own, with the files of a case.
#![allow(dead_code, reason = "not every case needs all of it")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of its own, which goes when it is dropped.
pub struct Place {
    folder: tempfile::TempDir,
    case: PathBuf,
}

impl Place {
    /// For the case in `tests/cases/NUMBER`, with copies of its files.
    pub fn of(number: &str) -> Self {
        let case = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../tests/cases")
            .join(number);
        let folder = tempfile::tempdir().expect("a folder");
        for entry in std::fs::read_dir(&case).expect("the case's folder") {
            let from = entry.expect("an entry").path();
            let name = from.file_name().expect("a name");
            std::fs::copy(&from, folder.path().join(name)).expect("a copy");
        }
        Self { folder, case }
    }

    /// Where a file of that name lies.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The case's own folder, not to be written to.
    pub fn case(&self) -> &Path {
        &self.case
    }

    /// The program with these arguments, to add more to before it is run.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pickglass"));
        command
            .args(arguments)
            .current_dir(self.folder.path())
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET")
            .env_remove("RUST_LOG")
            .env_remove("PICKGLASS_MEMORY");
        command
    }

    /// Runs the program.
    pub fn run(&self, arguments: &[&str]) -> Said {
        Said::of(
            self.command(arguments)
                .output()
                .expect("the program starts"),
        )
    }
}

/// What the program said.
#[derive(Debug)]
pub struct Said {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Said {
    pub fn of(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// It did what it was asked for.
    pub fn done(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }

    /// It could not, and said why in one line, which is given.
    pub fn refused(self) -> String {
        assert_eq!(self.code, Some(1), "{self:?}");
        assert_eq!(self.err.trim_end().lines().count(), 1, "{self:?}");
        self.err
    }

    /// The one object that it printed.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(self.out.trim()).expect("one object")
    }
}
