//! Why a file could not be opened or written as a design.

/// A file that could not be opened as a design: one line with the file, the place, what
/// was expected and what to do.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The system would not give it.
    #[error("cannot read {file}: {source}; check the name and that you may read it")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Larger than any design.
    #[error("{file}: expected at most {} MiB; this is no design", crate::limits::FILE >> 20)]
    TooLarge {
        /// The file.
        file: String,
    },
    /// Neither a design nor a draft.
    #[error("{file}: expected {expected}, found {found}; choose another file")]
    Unknown {
        /// The file.
        file: String,
        /// What is read.
        expected: String,
        /// What it looks like.
        found: &'static str,
    },
    /// A design document with something wrong.
    #[error(transparent)]
    Ron(#[from] super::ron::RonError),
    /// A WIF with something wrong.
    #[error(transparent)]
    Wif(#[from] super::wif::WifError),
    /// Another draft or a loom file with something wrong.
    #[error(transparent)]
    Sheet(#[from] super::sheet::SheetError),
    /// An image with something wrong, or a design that no image can hold.
    #[error(transparent)]
    Image(#[from] super::image::ImageError),
    /// A name with an ending that no format has.
    #[error("{file}: {written}; end the name in one of them")]
    Ending {
        /// The file.
        file: String,
        /// What is written, and with which endings.
        written: String,
    },
    /// Cards without a loom to write them for.
    #[error(
        "{file}: a loom file needs the hooks of a loom: pickglass convert takes a file of it \
         with --like, or a loom with --loom ({looms})"
    )]
    NoLoom {
        /// The file.
        file: String,
        /// Those that are known.
        looms: String,
    },
    /// No loom has this name.
    #[error("{0}: no loom is called this: give a .ron file, or one of {1}")]
    Loom(String, String),
    /// A file that could not be written.
    #[error(transparent)]
    Write(#[from] crate::atomic::WriteError),
    /// A sett that cannot be woven.
    #[error("{file}: {problem}; give another sett")]
    Sett {
        /// The file.
        file: String,
        /// What is wrong.
        problem: String,
    },
}
