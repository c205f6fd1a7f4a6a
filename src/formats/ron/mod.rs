//! The design document: RON with the grids inside it as PNG in base64.
//!
//! ```text
//! (
//!     pickglass: 1,
//!     design: (name: "…", ends: …, picks: …, structure: …, yarns: […], …),
//! )
//! ```
//!
//! The number says which version wrote it; each version has a module of its own, and only
//! the newest is written. A document of a newer program and a damaged one give different
//! errors. Fields this version does not know are skipped.

mod image;
mod v1;

use crate::design::{Design, DesignError};

/// The version this program writes, and the newest it reads.
pub const VERSION: u32 = 1;

/// A document that cannot be read or written: one line with the file, the place, what was
/// expected and what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RonError {
    /// Not a design document at all.
    #[error("{file}: expected a design beginning with \"(pickglass: {VERSION},\"; choose a design")]
    NotADesign {
        /// The file.
        file: String,
    },
    /// Written by a newer program.
    #[error(
        "{file}: this design is of version {version}, newer than this program's {VERSION}; \
         update Pickglass to open it"
    )]
    Newer {
        /// The file.
        file: String,
        /// Its version.
        version: u32,
    },
    /// Not readable as its version promises.
    #[error("{file}, line {line}, column {column}: damaged: {problem}; restore it from a backup")]
    Damaged {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What was expected.
        problem: String,
    },
    /// Readable, but not a design that can be.
    #[error("{file}: {place}: {problem}; correct it or restore the file from a backup")]
    Content {
        /// The file.
        file: String,
        /// Which part of the design.
        place: &'static str,
        /// What is wrong.
        problem: String,
    },
    /// A design that could not be put into a document.
    #[error("{name}: cannot be written: {problem}; report this, please")]
    Unwritable {
        /// The design.
        name: String,
        /// What went wrong.
        problem: String,
    },
}

/// What is wrong with a part of a document, before the file's name is known.
#[derive(Debug)]
struct Fault {
    place: &'static str,
    problem: String,
}

impl Fault {
    fn new(place: &'static str, problem: impl ToString) -> Self {
        let problem = one_line(&problem.to_string());
        Self { place, problem }
    }
}

impl From<DesignError> for Fault {
    fn from(error: DesignError) -> Self {
        Self::new("design", error)
    }
}

/// The version a text says it has; `None` if it is no design document.
pub fn version(text: &str) -> Option<u32> {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    while let Some(comment) = rest.strip_prefix("//") {
        rest = comment.split_once('\n')?.1.trim_start();
    }
    let rest = rest.strip_prefix('(')?.trim_start();
    let rest = rest.strip_prefix("pickglass")?.trim_start();
    let rest = rest.strip_prefix(':')?.trim_start();
    let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    // A number beyond u32 is certainly newer.
    (digits > 0).then(|| rest[..digits].parse().unwrap_or(u32::MAX))
}

/// Reads a design document. `name` is the file's name, for messages.
///
/// # Errors
/// [`RonError`]; a newer version and a damaged file each have their own.
pub fn read(bytes: &[u8], name: &str) -> Result<Design, RonError> {
    Ok(read_told(bytes, name)?.0)
}

/// As [`read`], with what was remarked on: fields of a later program, which are left out.
///
/// # Errors
/// As [`read`].
pub fn read_told(bytes: &[u8], name: &str) -> Result<(Design, Vec<String>), RonError> {
    let file = || name.to_owned();
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => {
            let before = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
            if version(&before).is_none() {
                return Err(RonError::NotADesign { file: file() });
            }
            return Err(RonError::Damaged {
                file: file(),
                line: before.matches('\n').count() + 1,
                column: before
                    .rsplit('\n')
                    .next()
                    .map_or(0, |line| line.chars().count())
                    + 1,
                problem: "expected UTF-8 text".to_owned(),
            });
        }
    };
    match version(text) {
        None => Err(RonError::NotADesign { file: file() }),
        Some(1) => {
            let (document, unknown) = v1::parse(text.trim_start_matches('\u{feff}'))
                .map_err(|error| damaged(file(), &error))?;
            let design = v1::to_design(document).map_err(|fault| RonError::Content {
                file: file(),
                place: fault.place,
                problem: fault.problem,
            })?;
            let told = (!unknown.is_empty()).then(|| {
                let more = unknown.len() > v1::MOST_UNKNOWN;
                let named = unknown.len().min(v1::MOST_UNKNOWN);
                format!(
                    "{name}: fields that are not known here, mistyped or of a later version, are \
                     left out: {}{}",
                    unknown[..named].join(", "),
                    if more { " and more" } else { "" }
                )
            });
            Ok((design, told.into_iter().collect()))
        }
        Some(0) => Err(RonError::NotADesign { file: file() }),
        Some(version) => Err(RonError::Newer {
            file: file(),
            version,
        }),
    }
}

/// A message on one line, whatever it quotes.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn damaged(file: String, error: &::ron::error::SpannedError) -> RonError {
    RonError::Damaged {
        file,
        line: error.span.start.line,
        column: error.span.start.col,
        problem: one_line(&error.code.to_string()),
    }
}

/// Writes a design document of the newest version.
///
/// # Errors
/// [`RonError::Unwritable`], which no whole design should cause.
pub fn write(design: &Design) -> Result<String, RonError> {
    v1::of_design(design)
        .and_then(|document| v1::print(&document))
        .map_err(|problem| RonError::Unwritable {
            name: design.name.clone(),
            problem,
        })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn newer_damaged_and_foreign_files_have_errors_of_their_own() {
        let message = |text: &str| read(text.as_bytes(), "a.ron").unwrap_err().to_string();
        let newer = message("(pickglass: 2, design: what(ever))");
        assert!(
            newer.contains("version 2, newer") && newer.contains("update"),
            "{newer}"
        );
        let damaged = message("(\n  pickglass: 1,\n  design: (name: \"x\"");
        assert!(damaged.starts_with("a.ron, line 3"), "{damaged}");
        assert!(damaged.contains("damaged"), "{damaged}");
        assert!(message("[WIF]\n").contains("choose a design"));
        assert!(message("").contains("choose a design"));
        assert!(message("(pickglass: 99999999999999, x)").contains("newer"));
        let bytes = [b"(pickglass: 1,\n ".as_slice(), &[0xff, 0xfe]].concat();
        let broken = read(&bytes, "a.ron").unwrap_err().to_string();
        assert!(broken.contains("line 2, column 2"), "{broken}");
    }

    #[test]
    fn deep_nesting_is_an_error_and_no_crash() {
        let text = format!("(pickglass: 1, design: {}", "[".repeat(200_000));
        assert!(matches!(
            read(text.as_bytes(), "deep.ron"),
            Err(RonError::Damaged { .. })
        ));
        let text = format!("(pickglass: 1, other: {}", "(a:".repeat(200_000));
        assert!(read(text.as_bytes(), "deep.ron").is_err());
    }
}
