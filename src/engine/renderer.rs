//! One row of the table of engines: what it can draw, and how it is made.

use std::fmt;
use std::sync::Arc;

use super::StillError;
use super::exposure::Engine;
use super::request::StillRequest;
use crate::design::Design;
use crate::exemplar::ExemplarStore;
use crate::job::Job;
use crate::plan::{Dial, DialError, Effect, Plan, Subject};
use crate::volume::DenseGrid;

/// One engine.
pub struct Renderer {
    /// Its name for `--renderer`.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// The effects that it can simulate.
    pub effects: &'static [Effect],
    /// Whether a dial changes what it draws.
    pub dials: fn(&Dial) -> bool,
    /// Whether it begins with noise, and more time makes a better picture of it.
    pub refines: bool,
    /// How it is made for the cloth of a design.
    pub(super) make: fn(&Making<'_>) -> Result<Box<dyn Engine>, StillError>,
    /// How it is made for voxels that were read, where it draws them.
    pub(super) of_voxels: Option<fn(DenseGrid) -> Box<dyn Engine>>,
}

/// What an engine for the cloth of a design is made from.
pub(super) struct Making<'m> {
    pub design: &'m Arc<Design>,
    pub request: &'m StillRequest,
    pub store: &'m ExemplarStore,
    pub job: &'m Job,
}

impl Renderer {
    /// Refuses what it does not draw.
    ///
    /// # Errors
    /// [`StillError::Subject`].
    pub fn check(&self, subject: Subject) -> Result<(), StillError> {
        match subject == Subject::Cloth || self.of_voxels.is_some() {
            true => Ok(()),
            false => Err(StillError::Subject(self.name)),
        }
    }

    /// What it simulates of a request.
    ///
    /// # Errors
    /// When a setting lies outside of what its dial takes.
    pub fn plan(&self, request: &StillRequest, subject: Subject) -> Result<Plan, DialError> {
        let mut plan = request.plan(subject)?.limited_to(self.effects);
        // What does not refine has no noise to filter out.
        plan.showing.denoise &= self.refines;
        Ok(plan)
    }

    /// Makes it ready to draw the cloth of a design as `request` has it.
    ///
    /// # Errors
    /// When the cloth cannot be made, the request is not usable or the job is cancelled.
    pub fn engine(
        &self,
        design: &Arc<Design>,
        request: &StillRequest,
        store: &ExemplarStore,
        job: &Job,
    ) -> Result<Box<dyn Engine>, StillError> {
        (self.make)(&Making {
            design,
            request,
            store,
            job,
        })
    }

    /// Makes it ready to draw voxels.
    ///
    /// # Errors
    /// [`StillError::Subject`] where it draws none.
    pub(super) fn over(&self, grid: DenseGrid) -> Result<Box<dyn Engine>, StillError> {
        let make = self.of_voxels.ok_or(StillError::Subject(self.name))?;
        Ok(make(grid))
    }
}

impl fmt::Debug for Renderer {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(self.name)
    }
}

impl PartialEq for Renderer {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}
