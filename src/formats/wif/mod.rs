//! WIF 1.1, the weavers' interchange format: reading and writing drafts.
//!
//! `text` splits the file into sections and entries, `read` makes a design of them,
//! `write` makes a file of a design. Where the specification is silent or real programs
//! differ from it, this is what is done here:
//!
//! * **Text**: as `encoding` says (UTF-8, UTF-16, Windows-1252); any line ending; section names
//!   and keys in any case; lines that begin with `;` are comments, and so is what follows
//!   a `;` behind a number or boolean; `\` at the end of a list continues it. Junk before
//!   the first section, a missing `[WIF]`, lines without `=` and repeated keys (the last
//!   counts) are warned about. A remark behind a header of WIF's own is refused: such files
//!   are notes, not drafts. `[CONTENTS]` is only a hint and is not believed.
//! * **Sparse lists**: there are `Threads` threads; whatever no line mentions has the
//!   default (shaft 0 = none, the default colour and spacing). Lines beyond `Threads` are
//!   ignored with a warning.
//! * **Tie-up and treadling against lift plan**: with both, both drawdowns are made; if
//!   they differ the tie-up counts, unless `[WEAVING]` says `Loom Type=Lift Plan`. A lift
//!   plan alone stands for a direct tie-up.
//! * **Shed**: `Rising Shed` missing means rising; `0` means that named shafts sink.
//! * **Numbering**: end 1 is the left column and pick 1 the bottom row, seen on the face.
//!   A file whose threading has a thread 0 counts everything from 0.
//! * **Counts**: shafts and treadles grow to what is used, with a warning; a treadle that
//!   is pressed but neither declared nor tied up is refused. Thread counts are checked
//!   before memory is asked for.
//! * **Colours**: channels are scaled from `Range`; no palette at all means white warp and
//!   blue weft; a missing default index is 1 for the warp and 2 for the weft. A number that
//!   the table lacks gets a colour that stands in (the direction's default, else the table's
//!   first for the warp and second for the weft), counted in one warning. Where colour 0 is
//!   named and all numbers have a colour one further on, the file counts colours from 0.
//! * **Spacing** is the pitch, **thickness** the drawn width: a thickness above the spacing
//!   means that yarns touch. `Units` missing: the numbers say nothing about size and only
//!   their ratios are used. 0.212 cm is Fiberworks' and TempoWeave's default, not a sett:
//!   it gives way to what is usual for the yarn, and is written back if nobody chooses one.
//! * **The rest**: titles and notes are kept, addresses are not; private and unknown
//!   sections are kept word for word and written back.

mod colours;
mod fields;
mod read;
mod text;
mod threads;
mod write;

pub use fields::FIELDS;
pub use read::{read, read_with};
pub use write::{Written, write};

/// The most ends or picks a file may declare.
pub const MAX_THREADS: u32 = crate::limits::DRAFT_THREADS;

/// A file that is no draft, or a design that no WIF can hold: one line with the file, the
/// line, what was expected and what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub struct WifError {
    /// The file, as the reader was told.
    pub file: String,
    /// The line, from 1, where one line is to blame.
    pub line: Option<u32>,
    /// What was expected and what was found.
    pub problem: String,
    /// What to do about it.
    pub remedy: String,
}

impl WifError {
    pub(super) fn at(
        file: &str,
        line: u32,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            file: file.to_owned(),
            line: Some(line),
            problem: problem.into(),
            remedy: remedy.into(),
        }
    }

    pub(super) fn whole(file: &str, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            file: file.to_owned(),
            line: None,
            problem: problem.into(),
            remedy: remedy.into(),
        }
    }

    fn message(&self) -> String {
        let place = match self.line {
            Some(line) => format!("{}, line {line}", self.file),
            None => self.file.clone(),
        };
        format!("{place}: {}; {}", self.problem, self.remedy)
    }
}
