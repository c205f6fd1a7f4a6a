//! Stills: from a design and a request to a picture, for the command line and the window.
//!
//! [`prepare`] makes the cloth (exemplars, synthesis, colours), [`render()`] traces it pass
//! by pass and calls back after each, and [`Still::save`] writes the result.
//! [`render_grid`] does the same with a volume that was read. Both the command line and
//! the window are consumers of the same passes.

mod effects;
mod grid;
mod picture;
mod request;

pub use effects::{DIALS, DialError, EFFECTS};
pub use grid::{render_grid, scene_files};
pub use picture::{Pass, PreparedCloth, Still, prepare, render, render_still, usual_width_mm};
pub use request::{EffectBase, EffectChoice, LightChoice, StillReport, StillRequest, Stop};

use std::path::PathBuf;

use crate::cloth::ClothError;
use crate::exemplar::ExemplarError;
use crate::formats::exr::ExrError;
use crate::formats::png::PngError;
use crate::formats::volume::VolumeFileError;
use crate::job::Cancelled;
use crate::render::LightError;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum StillError {
    /// The owner cancelled the work.
    #[error(transparent)]
    Cancelled(Cancelled),
    /// The cloth could not be made.
    #[error(transparent)]
    Cloth(ClothError),
    /// The light is not known or not usable.
    #[error(transparent)]
    Light(#[from] LightError),
    /// The environment could not be read.
    #[error(transparent)]
    Environment(#[from] ExrError),
    /// A dial or effect that does not exist or does not take this value.
    #[error(transparent)]
    Dial(#[from] DialError),
    /// A size of picture that cannot be made.
    #[error("a picture of {0} × {1} pixels cannot be made; give 1 to 16384 each way")]
    Size(u32, u32),
    /// A width of cloth that is not a length.
    #[error("a picture {0} mm wide cannot be made; give a width between 0.01 and 10000 mm")]
    Width(f32),
    /// The volume could not be read.
    #[error(transparent)]
    Volume(VolumeFileError),
    /// The picture could not be written.
    #[error(transparent)]
    Png(#[from] PngError),
    /// A name whose ending is not a format.
    #[error("{}: pictures are written as .png or .exr; end the name in one of them", .0.display())]
    Ending(PathBuf),
}

impl From<Cancelled> for StillError {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

impl From<VolumeFileError> for StillError {
    fn from(error: VolumeFileError) -> Self {
        match error {
            VolumeFileError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Volume(other),
        }
    }
}

impl From<ClothError> for StillError {
    fn from(error: ClothError) -> Self {
        match error {
            ClothError::Exemplar(ExemplarError::Cancelled(cancelled))
            | ClothError::Synthesis(crate::synthesis::SynthesisError::Cancelled(cancelled)) => {
                Self::Cancelled(cancelled)
            }
            other => Self::Cloth(other),
        }
    }
}
