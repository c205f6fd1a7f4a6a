//! From a film to a picture: noise filtered out, light shown.

use glam::Vec3;

use crate::film::{Denoise, Film, Picture, Tone};
use crate::job::Job;

/// How a film is shown.
#[derive(Debug, Clone, Copy)]
pub(super) struct Developing {
    pub tone: Tone,
    /// Whether noise is filtered out.
    pub denoise: bool,
}

impl Developing {
    /// The film's radiances denoised; `None` where they are not to be, or the job is cancelled.
    pub fn clean(self, film: &Film, job: &Job) -> Option<Vec<Vec3>> {
        let clean = (self.denoise).then(|| Denoise::default().apply(film, job));
        clean?.ok()
    }

    /// The picture: sRGB with straight alpha.
    pub fn picture(self, film: &Film) -> Picture {
        // Nobody cancels this one.
        match self.clean(film, &Job::new()) {
            Some(clean) => self.tone.picture_of(film, &clean),
            None => self.tone.picture(film),
        }
    }
}
