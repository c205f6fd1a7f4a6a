//! Small pictures for the eye: the middle of a picture with an effect and without it.

use std::sync::Arc;

use crate::design::Design;
use crate::engine::{self, Engine, Renderer, Shot, StillError, StillRequest};
use crate::film::Picture;
use crate::job::Job;
use crate::plan::{Effect, Subject};

/// Pixels across and down, at most.
const MOST: [u32; 2] = [100, 75];
/// Paths a pixel: what is left of their noise is filtered out.
const SPP: u32 = 4;

/// One place with an effect and without it: the same pixels, and as many paths, which begin
/// alike.
#[derive(Debug, Clone)]
pub struct Pair {
    /// The effect.
    pub effect: Effect,
    /// With all that is asked for; all pairs of a picture share it.
    pub with: Arc<Picture>,
    /// The same without the effect.
    pub without: Picture,
}

/// Takes pairs of one picture.
pub(super) struct Pairing<'p> {
    renderer: &'p Renderer,
    design: &'p Arc<Design>,
    request: &'p StillRequest,
    job: &'p Job,
    with: Option<Arc<Picture>>,
}

impl<'p> Pairing<'p> {
    pub fn new(
        renderer: &'p Renderer,
        design: &'p Arc<Design>,
        request: &'p StillRequest,
        job: &'p Job,
    ) -> Self {
        Self {
            renderer,
            design,
            request,
            job,
            with: None,
        }
    }

    /// The pair of an effect; `engine` is ready for the picture, `other` for `without`.
    pub fn take(
        &mut self,
        effect: Effect,
        (engine, other): (&dyn Engine, &dyn Engine),
        without: &StillRequest,
    ) -> Result<Pair, StillError> {
        let with = match &self.with {
            Some(with) => Arc::clone(with),
            None => Arc::new(self.picture(engine, self.request)?),
        };
        self.with = Some(Arc::clone(&with));
        let without = self.picture(other, without)?;
        Ok(Pair {
            effect,
            with,
            without,
        })
    }

    fn picture(&self, engine: &dyn Engine, request: &StillRequest) -> Result<Picture, StillError> {
        let request = engine::middle(self.design, request, MOST);
        let mut plan = self.renderer.plan(&request, Subject::Cloth)?;
        // Nobody looks at it before it is done.
        (plan.render.spp, plan.render.pass_spp) = (SPP, SPP);
        let shot = Shot::new(&request, plan)?;
        let still = engine::draw(engine, self.design, &shot, self.job, &mut |_| {})?;
        self.job.check()?;
        Ok(still.picture())
    }
}
