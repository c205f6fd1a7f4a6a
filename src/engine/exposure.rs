//! What engines give: the picture while it refines, and the film that it ends with.

use std::sync::Arc;

use glam::Vec3;

use super::StillError;
use super::developing::Developing;
use super::request::StillReport;
use super::shot::Shot;
use crate::design::Design;
use crate::film::Film;
use crate::job::Job;
use crate::render::BlocksSeen;

/// Draws one subject: the cloth of a design, or voxels that were read.
pub trait Engine: Send + Sync {
    /// What it is called in reports and on the command line.
    fn name(&self) -> &'static str;

    /// Draws what `shot` asks for; `on_pass` sees the picture whenever it is better.
    ///
    /// # Errors
    /// When the request is not usable or the job is cancelled.
    fn expose(
        &self,
        shot: &Shot<'_>,
        job: &Job,
        on_pass: &mut dyn FnMut(&Pass<'_>),
    ) -> Result<Exposure, StillError>;

    /// Looks closely at some blocks of the picture, each given by its upper left corner, with
    /// `spp` paths through every pixel; `None` where it follows no paths.
    ///
    /// # Errors
    /// When the request is not usable or the job is cancelled.
    fn look_at(
        &self,
        _shot: &Shot<'_>,
        _corners: &[[u32; 2]],
        _spp: u32,
        _job: &Job,
    ) -> Result<Option<BlocksSeen>, StillError> {
        Ok(None)
    }

    /// Draws `design`, the same in another colourway, from now on. False, and nothing changed,
    /// where that takes as much as making the engine anew.
    fn recolour(&mut self, design: &Arc<Design>) -> bool;
}

/// What an engine made of a shot.
pub struct Exposure {
    /// Linear means, variances and features.
    pub film: Film,
    /// Its stages, counters, error and remarks.
    pub report: StillReport,
    /// Scale of the picture.
    pub pixels_per_mm: f32,
}

/// The picture so far. What it shows is worked out when it is asked for.
pub struct Pass<'p> {
    /// Samples in every pixel.
    pub spp: u32,
    /// Seconds of rendering.
    pub seconds: f64,
    /// Error so far.
    pub error: Option<f64>,
    /// Linear means, variances and features.
    pub film: &'p Film,
    pub(super) developing: Developing,
}

impl Pass<'_> {
    /// sRGB with straight alpha, top row first.
    pub fn rgba(&self) -> Vec<u8> {
        let picture = self.developing.picture(self.film);
        let pixels = picture.pixels.iter();
        pixels.flat_map(|pixel| pixel.map(byte)).collect()
    }

    /// The film's radiances denoised, where they are and the job is not cancelled.
    pub fn clean(&self, job: &Job) -> Option<Vec<Vec3>> {
        self.developing.clean(self.film, job)
    }
}

pub(super) fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}
