//! Why a case does not hold.

use crate::engine::StillError;
use crate::job::Cancelled;

/// Why a case does not hold.
#[derive(Debug, thiserror::Error)]
pub(super) enum Fault {
    /// Something came out wrong.
    #[error("{0}")]
    Wrong(String),
    /// A picture that there should be is none.
    #[error("no picture: {0}")]
    Picture(#[from] StillError),
    /// The job was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Fault {
    /// A fault where `sound` is false.
    pub(super) fn unless(sound: bool, wrong: impl FnOnce() -> String) -> Result<(), Self> {
        match sound {
            true => Ok(()),
            false => Err(Self::Wrong(wrong())),
        }
    }
}
