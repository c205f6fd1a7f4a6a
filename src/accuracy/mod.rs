//! What accuracy costs: time and error of every setting of every dial, measured on this machine
//! and on one design.
//!
//! An [`Axis`] is one way to be more or less accurate: a dial of [`crate::plan`], an effect, the
//! engine. [`measure`] asks for the picture with each of its settings in turn (`studio.rs` takes
//! pictures of a small piece of the cloth at the picture's own scale, `woven.rs` looks at the
//! synthesis), with several seeds of the paths, setting after setting so that what else the
//! machine does falls on all alike. `difference.rs` tells errors apart from noise, `seen.rs`
//! says how different two pictures look, `estimate.rs` gives all of it its interval. The outcome
//! is an [`Accuracy`]: curves of error over time, which `report.rs` writes as text and
//! `plot.rs` as pictures.

mod axis;
mod curve;
mod difference;
mod digits;
mod estimate;
mod front;
mod measuring;
mod model;
mod picture;
mod plot;
mod report;
mod seen;
mod studio;
mod within;
mod woven;

pub use axis::{Asked, Axis};
pub use curve::{Accuracy, Curve, Machine, Point, Trial};
pub use digits::number;
pub use estimate::Estimate;
pub use measuring::{Crops, Effort, Measuring, measure};
pub use model::Choice;
pub use picture::options;
pub use report::{markdown, read, write};
pub use seen::EYE_MM;
pub use woven::{Synthesised, Woven};

use std::path::PathBuf;

use crate::atomic::WriteError;
use crate::cloth::ClothError;
use crate::engine::StillError;
use crate::exemplar::ExemplarError;
use crate::formats::png::PngError;
use crate::job::Cancelled;
use crate::plan::DialError;
use crate::synthesis::SynthesisError;

/// Why accuracy could not be measured, or what was measured not be kept.
#[derive(Debug, thiserror::Error)]
pub enum AccuracyError {
    /// The owner cancelled the work.
    #[error(transparent)]
    Cancelled(Cancelled),
    /// Nothing of this name can be more or less accurate.
    #[error("nothing that is measured is called {0:?}; there are {1}")]
    Unknown(String, String),
    /// What is asked for changes nothing of this picture.
    #[error("{0}: it changes nothing of this picture: leave it out")]
    Idle(&'static str),
    /// A setting that is not taken.
    #[error(transparent)]
    Dial(#[from] DialError),
    /// There is no picture.
    #[error(transparent)]
    Still(StillError),
    /// There is no cloth.
    #[error(transparent)]
    Cloth(ClothError),
    /// What was measured could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A picture could not be written.
    #[error(transparent)]
    Png(#[from] PngError),
    /// A plot could not be drawn.
    #[error("{}: the plot could not be drawn ({why})", .0.display(), why = .1)]
    Plot(PathBuf, String),
}

impl From<Cancelled> for AccuracyError {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

impl From<StillError> for AccuracyError {
    fn from(error: StillError) -> Self {
        match error {
            StillError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Still(other),
        }
    }
}

impl From<ClothError> for AccuracyError {
    fn from(error: ClothError) -> Self {
        // As for a picture: one door for what was cancelled.
        match StillError::from(error) {
            StillError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            StillError::Cloth(cloth) => Self::Cloth(cloth),
            other => Self::Still(other),
        }
    }
}

impl From<ExemplarError> for AccuracyError {
    fn from(error: ExemplarError) -> Self {
        ClothError::from(error).into()
    }
}

impl From<SynthesisError> for AccuracyError {
    fn from(error: SynthesisError) -> Self {
        ClothError::from(error).into()
    }
}
