//! The cloth that a request looks at: its design in the colourway that it names, as much of
//! it as is in view.

use std::ops::Range;
use std::sync::Arc;

use super::shot::{camera, in_view, origin};
use super::{StillError, StillRequest};
use crate::cloth::{self, Followed, PreparedCloth};
use crate::design::{Design, Positions, WeavePattern};
use crate::exemplar::ExemplarStore;
use crate::job::Job;
use crate::plan::Subject;
use crate::synthesis::Stretch;

/// The design in the colourway that a request names.
///
/// # Errors
/// When it has no such colourway.
pub fn coloured(design: &Arc<Design>, request: &StillRequest) -> Result<Arc<Design>, StillError> {
    match &request.colourway {
        None => Ok(Arc::clone(design)),
        Some(name) => Ok(Arc::new(Design::clone(design).with_colourway(name)?)),
    }
}

/// The crossings that a request looks at.
///
/// # Errors
/// When the request is not usable.
fn extent(design: &Design, request: &StillRequest) -> Result<Stretch, StillError> {
    let (x, y) = in_view(&camera(design, request)?, request);
    let [from_x, from_y] = origin(design, request);
    let threads = |positions: Positions, range: Range<f32>| {
        let [from, to] = [range.start, range.end].map(|mm| positions.locate(mm.into()).0);
        from..to.saturating_add(1)
    };
    Ok(Stretch {
        ends: threads(design.end_positions().seen_from(from_x), x),
        picks: threads(design.pick_positions().seen_from(from_y), y),
    })
}

/// Refuses a picture that takes in more of a very large design than is made into cloth at
/// once, before anything is made.
///
/// # Errors
/// [`StillError::is_too_wide`], or when the request is not usable.
pub fn check_view(design: &Arc<Design>, request: &StillRequest) -> Result<(), StillError> {
    let design = coloured(design, request)?;
    Ok(cloth::check_extent(&design, &extent(&design, request)?)?)
}

/// Whether a picture finds all it shows in this cloth; else the cloth is to [`follow`] the eye.
pub fn covers(cloth: &PreparedCloth, request: &StillRequest) -> bool {
    let design = cloth.design();
    extent(design, request).is_ok_and(|seen| cloth.covers(design, &seen))
}

/// Builds what every picture of a design needs; `request` gives the settings, the seed, the
/// colourway and what is in view.
///
/// # Errors
/// When the design cannot be made into cloth, the request is not usable, or the job is
/// cancelled.
pub fn prepare(
    design: &Arc<Design>,
    request: &StillRequest,
    store: &ExemplarStore,
    job: &Job,
) -> Result<PreparedCloth, StillError> {
    prepare_woven(design, &Arc::new(design.weave()), request, store, job)
}

/// As [`prepare`] for a design whose drawdown is known already.
///
/// # Errors
/// As [`prepare`].
pub fn prepare_woven(
    design: &Arc<Design>,
    drawdown: &Arc<WeavePattern>,
    request: &StillRequest,
    store: &ExemplarStore,
    job: &Job,
) -> Result<PreparedCloth, StillError> {
    let settings = request.plan(Subject::Cloth)?.cloth;
    let design = coloured(design, request)?;
    let seen = extent(&design, request)?;
    let made = cloth::prepare_woven(&design, drawdown, &settings, &seen, store, job);
    Ok(made?)
}

/// The cloth of an edited design, as [`PreparedCloth::follow`] has it, seen as `request` says.
///
/// # Errors
/// When the request is not usable, or the job is cancelled.
pub fn follow(
    cloth: &PreparedCloth,
    design: &Arc<Design>,
    drawdown: &Arc<WeavePattern>,
    request: &StillRequest,
    job: &Job,
) -> Result<Option<Followed>, StillError> {
    let settings = request.plan(Subject::Cloth)?.cloth;
    let design = coloured(design, request)?;
    let seen = extent(&design, request)?;
    Ok(cloth.follow(&design, drawdown, &settings, &seen, job)?)
}
