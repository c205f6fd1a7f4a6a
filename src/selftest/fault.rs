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
    /// What an error says.
    pub(super) fn of(error: impl std::fmt::Display) -> Self {
        Self::Wrong(error.to_string())
    }

    /// A fault where lookups were above their bound, or samples or rays are none.
    pub(super) fn unless_counted_clean(
        violations: u64,
        invalid_samples: u64,
        invalid_rays: u64,
    ) -> Result<(), Self> {
        let counted = [
            (violations, "lookups above their bound"),
            (invalid_samples, "samples that are no light"),
            (invalid_rays, "rays that are none"),
        ];
        (counted.into_iter())
            .try_for_each(|(count, what)| Self::unless(count == 0, || format!("{count} {what}")))
    }

    /// A fault where `sound` is false.
    pub(super) fn unless(sound: bool, wrong: impl FnOnce() -> String) -> Result<(), Self> {
        match sound {
            true => Ok(()),
            false => Err(Self::Wrong(wrong())),
        }
    }
}
