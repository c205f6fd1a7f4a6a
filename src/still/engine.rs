//! Something that draws the cloth.

use super::picture::{Pass, render};
use super::prepare::PreparedCloth;
use super::{StillError, StillRequest};
use crate::job::Job;

/// Draws the cloth of one design, from a first sight to a picture that keeps refining.
pub trait Engine {
    /// What it is called in reports.
    fn name(&self) -> &'static str;

    /// Draws what `request` asks for; `on_pass` sees the picture whenever it is better.
    ///
    /// # Errors
    /// When the request is not usable or the job is cancelled.
    fn draw(
        &self,
        request: &StillRequest,
        job: &Job,
        on_pass: &mut dyn FnMut(&Pass<'_>),
    ) -> Result<(), StillError>;
}

impl Engine for PreparedCloth {
    fn name(&self) -> &'static str {
        "cpu"
    }

    fn draw(
        &self,
        request: &StillRequest,
        job: &Job,
        on_pass: &mut dyn FnMut(&Pass<'_>),
    ) -> Result<(), StillError> {
        render(self, request, job, on_pass).map(drop)
    }
}
