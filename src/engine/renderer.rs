//! One row of the table of engines: what it can draw, and how it is made.

use std::fmt;
use std::sync::Arc;

use super::StillError;
use super::exposure::Engine;
use super::request::StillRequest;
use crate::design::Design;
use crate::exemplar::ExemplarStore;
use crate::job::Job;
use crate::plan::{Decider, Dial, DialError, Effect, Plan, Subject};

/// One engine.
pub struct Renderer {
    /// Its name for `--renderer`.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// What it draws.
    pub subjects: &'static [Subject],
    /// The effects that it can simulate.
    pub effects: &'static [Effect],
    /// Whether a dial changes what it draws.
    pub dials: fn(&Dial) -> bool,
    /// Whether more time makes a better picture of it.
    pub refines: bool,
    pub(super) make: fn(&Making<'_>) -> Result<Box<dyn Engine>, StillError>,
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
        match self.subjects.contains(&subject) {
            true => Ok(()),
            false => Err(StillError::Subject(self.name)),
        }
    }

    /// What it simulates of a request.
    ///
    /// # Errors
    /// When a setting lies outside of what its dial takes.
    pub fn plan(&self, request: &StillRequest, subject: Subject) -> Result<Plan, DialError> {
        let mut plan = request.plan(subject)?;
        for planned in &mut plan.effects {
            if planned.on && !self.effects.contains(&planned.effect) {
                planned.on = false;
                planned.why = "this renderer has none of it";
                planned.by = Decider::Scene;
            }
        }
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
