//! Which cloth is drawn: the full one as soon as there is one, until then a coarse one.
//!
//! Both follow edits and make anew only what an edit touches. Where the full cloth needs
//! exemplars that are not there, first sight or, of a slanting view, the coarse one steps in, a thread of its own builds them
//! and the last request is drawn again. A build goes on through edits that need the same
//! exemplars.
//!
//! Of a very large design a cloth has the part around the view, and follows the eye as it
//! follows edits. A view of too much of one stays at first sight.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use pickglass::cloth::{Followed, PreparedCloth, UnfinishedCloth, YarnClasses};
use pickglass::engine::{self, StillError, StillRequest};
use pickglass::job::Job;

use super::{Building, Fibres, Mailbox, Phase, PreviewRequest};

/// Voxel level of the cloth that is drawn until the full one is built.
const COARSE_LEVEL: u32 = 3;

/// A cloth and the request it was made for.
pub(super) type Kept = (PreviewRequest, Arc<PreparedCloth>);

/// The full cloth that is being built.
pub(super) struct Builder {
    request: PreviewRequest,
    classes: YarnClasses,
    pub(super) job: Job,
}

impl Builder {
    /// Whether what is being built also serves another request.
    fn serves(&self, request: &PreviewRequest, classes: &YarnClasses) -> bool {
        self.request.same_settings(request)
            && self.classes.pairs == classes.pairs
            && self.classes.pitch == classes.pitch
    }
}

/// What a full cloth still needs.
enum Wanted {
    /// Some exemplars.
    Exemplars(Box<UnfinishedCloth>),
    /// Everything.
    All,
}

/// Whether first sight shows what a picture is of better than coarse voxels do: these
/// blur yarns into each other. First sight knows nothing of the slant of a view.
pub(super) fn first_sight_serves(still: &StillRequest) -> bool {
    still.is_straight()
}

/// The best cloth at hand for a request, and what it is of; `None` where first sight serves
/// until the full one is built.
pub(super) fn cloth_of(
    mailbox: &Arc<Mailbox>,
    request: &PreviewRequest,
    job: &Job,
    coarse: &mut Option<Kept>,
) -> Result<Option<(Arc<PreparedCloth>, Fibres)>, StillError> {
    engine::check_view(&request.design, &request.still)?;
    let full = mailbox.lock().full.clone();
    let wanted = match full {
        Some((made_for, cloth))
            if made_for.same_cloth(request) && engine::covers(&cloth, &request.still) =>
        {
            return Ok(Some((cloth, Fibres::Full)));
        }
        Some((made_for, cloth)) if made_for.same_settings(request) => {
            match engine::follow(
                &cloth,
                &request.design,
                &request.drawdown,
                &request.still,
                job,
            )? {
                Some(Followed::Ready(cloth)) => {
                    let cloth = Arc::new(cloth);
                    mailbox.lock().full = Some((request.clone(), Arc::clone(&cloth)));
                    return Ok(Some((cloth, Fibres::Full)));
                }
                Some(Followed::Unfinished(cloth)) => Wanted::Exemplars(Box::new(cloth)),
                None => Wanted::All,
            }
        }
        _ => Wanted::All,
    };
    build(mailbox, request, wanted);
    if first_sight_serves(&request.still) && mailbox.lock().builder.is_some() {
        return Ok(None);
    }
    let cloth = coarse_cloth(mailbox, request, job, coarse)?;
    let light_error = cloth.cloth().light_error();
    Ok(Some((cloth, Fibres::Coarse { light_error })))
}

fn coarse_cloth(
    mailbox: &Mailbox,
    request: &PreviewRequest,
    job: &Job,
    coarse: &mut Option<Kept>,
) -> Result<Arc<PreparedCloth>, StillError> {
    let mut still = request.still.clone();
    still.settings.cloth.level = COARSE_LEVEL;
    let followed = match coarse {
        Some((made_for, cloth))
            if made_for.same_cloth(request) && engine::covers(cloth, &still) =>
        {
            return Ok(Arc::clone(cloth));
        }
        Some((made_for, cloth)) if made_for.same_settings(request) => {
            engine::follow(cloth, &request.design, &request.drawdown, &still, job)?
        }
        _ => None,
    };
    let cloth = match followed {
        Some(Followed::Ready(cloth)) => cloth,
        Some(Followed::Unfinished(cloth)) => cloth.complete(&mailbox.store, job)?,
        None => {
            mailbox.set_phase(Phase::Preparing);
            *coarse = None;
            let (design, drawdown) = (&request.design, &request.drawdown);
            engine::prepare_woven(design, drawdown, &still, &mailbox.store, job)?
        }
    };
    let cloth = Arc::new(cloth);
    *coarse = Some((request.clone(), Arc::clone(&cloth)));
    Ok(cloth)
}

/// Builds what the full cloth needs on a thread of its own, unless that is under way; then
/// the last request is drawn again from it.
fn build(mailbox: &Arc<Mailbox>, request: &PreviewRequest, wanted: Wanted) {
    let classes = YarnClasses::new(&request.design);
    let mut shared = mailbox.lock();
    if let Some(builder) = &shared.builder {
        if builder.serves(request, &classes) {
            return;
        }
        builder.job.cancel();
        shared.builder = None;
        shared.building = None;
    }
    let job = listening(mailbox);
    let builder = Builder {
        request: request.clone(),
        classes,
        job: job.clone(),
    };
    let (thread_mailbox, thread_request) = (Arc::clone(mailbox), request.clone());
    let spawned = std::thread::Builder::new()
        .name("exemplars".to_owned())
        .spawn(move || {
            let (mailbox, request) = (thread_mailbox, thread_request);
            let built = catch_unwind(AssertUnwindSafe(|| {
                super::threads::behind(|| match wanted {
                    Wanted::Exemplars(cloth) => Ok(cloth.complete(&mailbox.store, &job)?),
                    Wanted::All => {
                        let (design, drawdown) = (&request.design, &request.drawdown);
                        engine::prepare_woven(
                            design,
                            drawdown,
                            &request.still,
                            &mailbox.store,
                            &job,
                        )
                    }
                })
            }));
            take_built(&mailbox, &job, request, built);
        });
    if spawned.is_ok() {
        shared.builder = Some(builder);
    }
}

/// A job that tells the mailbox how far it is.
fn listening(mailbox: &Arc<Mailbox>) -> Job {
    let report_to = Arc::clone(mailbox);
    Job::new().with_listener(move |stage, fraction| {
        let mut shared = report_to.lock();
        if shared.builder.is_some() {
            shared.building = Some(Building {
                stage: stage.to_owned(),
                fraction,
            });
        }
        drop(shared);
        (report_to.wake)();
    })
}

fn take_built(
    mailbox: &Mailbox,
    job: &Job,
    request: PreviewRequest,
    built: std::thread::Result<Result<PreparedCloth, StillError>>,
) {
    let mut shared = mailbox.lock();
    if job.check().is_err() {
        return;
    }
    shared.builder = None;
    shared.building = None;
    match built {
        Ok(Ok(cloth)) => {
            shared.full = Some((request, Arc::new(cloth)));
            if let Some(current) = &shared.current {
                current.job.cancel();
            }
            if shared.next.is_none() {
                shared.next = shared.last.clone();
            }
        }
        // The coarse cloth stays; what stands in the way of the full one is said.
        Ok(Err(error)) => shared.failure = Some(error.to_string()),
        Err(_) => {
            shared.failure = Some(
                "the exemplars: building them failed unexpectedly: try another sett".to_owned(),
            );
        }
    }
    drop(shared);
    mailbox.changed.notify_all();
    (mailbox.wake)();
}
