//! Looks at the open design's picture on a thread of its own, and keeps what was found.

use std::sync::Arc;

use pickglass::design::Design;
use pickglass::edit::Document;
use pickglass::engine::{self, StillError, StillRequest};
use pickglass::exemplar::ExemplarStore;
use pickglass::job::Job;
use pickglass::needs::{self, Need, Needs, Pair};
use pickglass::plan::{Decider, Effect};

use super::words;
use crate::window::panes::of_design::OfDesign;
use crate::window::task::Running;

/// A look that is under way; `None` = it was stopped.
pub type Look = Running<Result<Option<Looked>, String>>;

/// What a look found.
pub struct Looked {
    /// The design that it is of.
    of: OfDesign,
    /// The picture that was looked at, and with what allowance.
    request: StillRequest,
    pub tolerance: f64,
    pub needs: Needs,
    pub pairs: Vec<Pair>,
    /// Scatterings after which what comes later does not show, where that is fewer than were
    /// asked for.
    pub order: Option<u32>,
}

/// Why what was found is not of what is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stale {
    Design,
    View,
    /// The same picture with other effects, or another allowance.
    Switched,
}

/// Looks from now on at a picture of a document.
///
/// # Errors
/// When there is no thread to look on.
pub fn start(
    ctx: &egui::Context,
    document: &Document,
    request: StillRequest,
    tolerance: f64,
) -> std::io::Result<Look> {
    let (design, of) = (Arc::clone(document.design()), OfDesign::new(document));
    Running::start(ctx, "effects", move |job, teller| {
        let teller = teller.clone();
        let tell = move |stage: &str, share: f32| teller.tell(words::stage(stage, share));
        let job = job.clone().with_listener(tell);
        look(&design, of, request, tolerance, &job)
    })
}

fn look(
    design: &Arc<Design>,
    of: OfDesign,
    request: StillRequest,
    tolerance: f64,
    job: &Job,
) -> Result<Option<Looked>, String> {
    let (renderer, store) = (engine::reference(), ExemplarStore::user());
    let found = needs::survey_in_pictures(design, renderer, &request, tolerance, &store, job);
    let (settled, needs, pairs) = match found {
        Ok(found) => found,
        Err(StillError::Cancelled(_)) => return Ok(None),
        Err(error) => return Err(error.to_string()),
    };
    let followed = settled.settings.render.max_order;
    Ok(Some(Looked {
        order: (followed < request.settings.render.max_order).then_some(followed),
        of,
        request,
        tolerance,
        needs,
        pairs,
    }))
}

impl Looked {
    /// What was found of an effect.
    pub fn need(&self, effect: Effect) -> Option<&Need> {
        self.needs.effects.iter().find(|need| need.effect == effect)
    }

    /// The pictures with an effect and without it.
    pub fn pair(&self, effect: Effect) -> Option<&Pair> {
        self.pairs.iter().find(|pair| pair.effect == effect)
    }

    /// Effects that may be left out, with what is known of them.
    pub fn unseen(&self) -> impl Iterator<Item = &Need> {
        let effects = self.needs.effects.iter();
        effects.filter(|need| !need.on && need.by == Decider::Scene)
    }

    /// The effect that takes most of the work, and its share of it.
    pub fn dearest(&self) -> Option<(Effect, f64)> {
        let costs = self.needs.effects.iter();
        let costs = costs.filter_map(|need| Some((need.effect, need.cost?)));
        costs.max_by(|one, other| one.1.total_cmp(&other.1))
    }

    /// Whether that is not what is shown, as `asked`, of a document.
    pub fn stale(
        &self,
        asked: &StillRequest,
        document: &Document,
        tolerance: f64,
    ) -> Option<Stale> {
        let mut switched = asked.clone();
        switched.effects.clone_from(&self.request.effects);
        switched.settings.render.max_order = self.request.settings.render.max_order;
        if !self.of.is(document) {
            Some(Stale::Design)
        } else if switched != self.request {
            Some(Stale::View)
        } else if *asked != self.request || tolerance.to_bits() != self.tolerance.to_bits() {
            Some(Stale::Switched)
        } else {
            None
        }
    }
}
