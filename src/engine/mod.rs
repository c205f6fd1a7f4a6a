//! Draws designs: the table of engines, and the pictures that are taken with them.
//!
//! A [`StillRequest`] says what is asked for. A [`Renderer`], one row of the table (`table.rs`),
//! plans what it simulates of that, and makes an [`Engine`] for the design, whose
//! [`Engine::expose`] gives an [`Exposure`] of a [`Shot`]; developed, that is a [`Still`], which
//! is shown and written. [`render_still`] does all of it, [`render_sheet`] puts all colourways of
//! a design side by side, [`render_grid`] takes a picture of voxels that were read. The path
//! tracer of a [`PreparedCloth`](crate::cloth::PreparedCloth) is the reference; [`FirstSight`]
//! is there at once; [`Standing`] is what a window shows while the one becomes the other.

mod again;
mod carried;
mod developing;
mod exposure;
mod finishing;
mod first_sight;
mod grid;
mod planes;
mod prepare;
mod renderer;
mod request;
mod sheet;
mod shot;
mod standing;
mod still;
mod table;
mod tracer;

pub use again::options;
pub use carried::{Carried, Sighted};
pub use exposure::{Engine, Exposure, Pass};
pub use finishing::finishing_seconds;
pub use first_sight::{FirstSight, SightTables};
pub use grid::{light_warnings, render_grid, scene_files};
pub use prepare::{check_view, coloured, covers, follow, prepare, prepare_woven};
pub use renderer::Renderer;
pub use request::{Heading, LightChoice, StillReport, StillRequest, Stop};
pub use sheet::{ALL_COLOURWAYS, AS_DESIGNED, Sheet, SheetPlace, render_sheet};
pub use shot::{Shot, middle, place_on, usual_width_mm};
pub use standing::Standing;
pub use still::{Settle, Still, draw, render, render_settled, render_still};
pub use table::{RENDERERS, reference, renderer};

use std::path::{Path, PathBuf};

use crate::cloth::ClothError;
use crate::design::ColourwayError;
use crate::exemplar::ExemplarError;
use crate::formats::exr::ExrError;
use crate::formats::png::PngError;
use crate::formats::volume::VolumeFileError;
use crate::formats::volume::mitsuba::SceneError;
use crate::job::Cancelled;
use crate::limits;
use crate::memory::TooMuch;
use crate::plan::DialError;
use crate::scene::LightError;
use crate::synthesis::SynthesisError;

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
    /// A dial that does not take this value.
    #[error(transparent)]
    Dial(#[from] DialError),
    /// A size of picture that cannot be made.
    #[error("a picture of {0} × {1} pixels cannot be made; give {range} each way", range = limits::whole(&limits::PICTURE_SIDE))]
    Size(u32, u32),
    /// A picture that takes more memory than may be used.
    #[error(transparent)]
    Memory(#[from] TooMuch),
    /// A width of cloth that is not a length.
    #[error("a picture {0} mm wide cannot be made; give {range} mm", range = limits::in_words(&limits::PICTURE_MM))]
    Width(f32),
    /// A place that no cloth reaches.
    #[error("a picture round {0},{1} mm cannot be made; give {range} mm each way", range = limits::in_words(&limits::CENTRE_MM))]
    Centre(f32, f32),
    /// A colourway that the design does not have.
    #[error(transparent)]
    Colourway(#[from] ColourwayError),
    /// A sheet of colourways in a format that cannot hold it.
    #[error("{}: a sheet of colourways is written as .png; end the name in that", .0.display())]
    SheetEnding(PathBuf),
    /// No engine has this name.
    #[error("--renderer {0}: this build has no such renderer: use auto, {1}")]
    Renderer(String, String),
    /// An engine that does not draw what is looked at.
    #[error("--renderer {0}: it draws no volume, only the cloth of a design: use auto")]
    Subject(&'static str),
    /// The volume could not be read.
    #[error(transparent)]
    Volume(VolumeFileError),
    /// A volume has no scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The picture could not be written.
    #[error(transparent)]
    Png(#[from] PngError),
    /// A name whose ending is not a format.
    #[error("{}: pictures are written as .png or .exr; end the name in one of them", .0.display())]
    Ending(PathBuf),
}

impl StillError {
    /// Whether the picture takes in more of a very large design than is made into cloth at
    /// once: [`FirstSight`] draws it all the same.
    pub fn is_too_wide(&self) -> bool {
        matches!(
            self,
            Self::Cloth(ClothError::Synthesis(SynthesisError::TooWide { .. }))
        )
    }
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
            | ClothError::Synthesis(SynthesisError::Cancelled(cancelled)) => {
                Self::Cancelled(cancelled)
            }
            other => Self::Cloth(other),
        }
    }
}

/// Refuses a file name for a sheet that does not end in `.png`.
///
/// # Errors
/// [`StillError::SheetEnding`].
pub fn png_ending(path: &Path) -> Result<(), StillError> {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some(ending) if ending.eq_ignore_ascii_case("png") => Ok(()),
        _ => Err(StillError::SheetEnding(path.to_owned())),
    }
}
