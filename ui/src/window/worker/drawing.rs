//! The pictures of one request: first sight, then what tracing adds to it. What is shown
//! never gets worse: [`Standing`] decides how much of a traced picture is believed.

use std::sync::Arc;
use std::time::{Duration, Instant};

use pickglass::design::WeavePattern;
use pickglass::engine::{
    Engine, FirstSight, Shot, SightTables, Sighted, Standing, StillError, StillRequest, Stop, draw,
    place_on,
};
use pickglass::job::Job;
use pickglass::plan::Subject;

use super::{Aim, Fibres, LONGEST, Mailbox, Picture, PreviewRequest};

/// Tracing goes on so many times as long as it takes to show what it found, before it is
/// shown again.
pub(super) const PATIENCE: u32 = 4;
/// Samples a pixel from which a film's own halves tell how noisy it is.
const LEAST_SAMPLES: u32 = 3;
/// An old picture serves as it is where its pixels are as large as the new ones, within what
/// nobody sees.
const AS_SHARP: f32 = 0.98;
/// From further away it would lie in the middle as a patch of another look.
const AS_LARGE: f32 = 1.02;

/// What is on the screen, to build the next picture on.
pub(super) struct OnScreen {
    still: StillRequest,
    aim: Aim,
    design: Arc<pickglass::design::Design>,
    drawdown: Arc<WeavePattern>,
    /// First sight of the same.
    sight: Arc<Sighted>,
    standing: Standing,
    /// Whether anything of it was traced.
    traced: bool,
}

impl OnScreen {
    fn same_place(&self, request: &PreviewRequest) -> bool {
        self.same_look(request)
            && (self.still.width, self.still.height) == (request.still.width, request.still.height)
            && (self.still.centre_mm, self.still.width_mm)
                == (request.still.centre_mm, request.still.width_mm)
    }

    /// The same side in the same light, wherever and from whatever distance.
    fn same_look(&self, request: &PreviewRequest) -> bool {
        let look = |still: &StillRequest| StillRequest {
            stop: Stop::default(),
            colourway: None,
            width: 0,
            height: 0,
            centre_mm: None,
            width_mm: None,
            ..still.clone()
        };
        self.aim == request.aim && look(&self.still) == look(&request.still)
    }

    fn same_cloth(&self, request: &PreviewRequest) -> bool {
        Arc::ptr_eq(&self.design, &request.design)
            && Arc::ptr_eq(&self.drawdown, &request.drawdown)
            && self.still.colourway == request.still.colourway
    }

    /// What is known of a new first sight from this picture; `None` = nothing.
    fn carried(&self, request: &PreviewRequest, sight: &Sighted) -> Option<Standing> {
        if !self.traced {
            return None;
        }
        let [width, height] = [request.still.width, request.still.height];
        if self.same_place(request) {
            let carried = self.sight.carried_to(sight, &self.standing.rgba())?;
            return Standing::of_rgba(width, height, &carried.rgba);
        }
        if !(self.same_look(request) && self.same_cloth(request)) {
            return None;
        }
        // The eye moved. Colours are those of tracing; where the old picture is as sharp,
        // it is cut, where it is coarser, it tells of large places alone, and where it is
        // but a part of what is seen now, of no more than the colours.
        let rgba = sight.as_traced(&self.sight, &self.standing.rgba())?;
        let new = Standing::of_rgba(width, height, &rgba)?;
        let Some((corner, scale)) = place_on(&request.design, &self.still, &request.still) else {
            return Some(new);
        };
        if scale > AS_LARGE {
            return Some(new);
        }
        let old = self.standing.seen_from([width, height], corner, scale);
        Some(if scale >= AS_SHARP {
            old.over(&new)
        } else {
            new.coloured_as(&old, 2.0 / scale)
        })
    }
}

/// The pictures of one request.
pub(super) struct Drawing<'r> {
    pub mailbox: &'r Mailbox,
    pub request: &'r PreviewRequest,
    pub job: &'r Job,
    pub begun: Instant,
    /// [`PATIENCE`]; 0 = every pass is shown.
    pub patience: u32,
}

/// What tracing came to.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Traced {
    /// Seconds a pass took.
    pub pass_seconds: f64,
    /// Samples a pixel.
    pub spp: u32,
    /// Error of the film.
    pub error: Option<f64>,
}

impl Drawing<'_> {
    /// Shows the request at first sight; where the eye moved, or only an edit is new, what
    /// is known from the picture that is shown goes into it.
    pub fn first_sight(
        &self,
        tables: &Arc<SightTables>,
        screen: &mut Option<OnScreen>,
    ) -> Result<(), StillError> {
        let request = self.request;
        if !request.blank
            && let Some(known) = screen.as_mut()
            && known.same_place(request)
            && known.same_cloth(request)
        {
            // The very same picture goes on, after a pause or with better exemplars.
            known.still = request.still.clone();
            return Ok(());
        }
        let known = screen.take().filter(|_| !request.blank);
        let engine = FirstSight::new(
            Arc::clone(&request.design),
            Arc::clone(&request.drawdown),
            Arc::clone(tables),
        );
        let sight = engine.look(&request.still, self.job)?;
        let carried = known.and_then(|known| known.carried(request, &sight));
        let traced = carried.is_some();
        let [width, height] = [request.still.width, request.still.height];
        let Some(standing) = carried.or_else(|| Standing::of_rgba(width, height, &sight.rgba))
        else {
            return Ok(());
        };
        let nothing = Traced::default();
        self.show(
            &standing,
            &nothing,
            false,
            Fibres::Coarse { light_error: None },
        );
        *screen = Some(OnScreen {
            still: request.still.clone(),
            aim: request.aim,
            design: Arc::clone(&request.design),
            drawdown: Arc::clone(&request.drawdown),
            sight: Arc::new(sight),
            standing,
            traced,
        });
        Ok(())
    }

    /// Traces at 1/2^level of the size until `stop`, at least one pass, and shows what that
    /// adds to the picture that stands.
    pub fn trace(
        &self,
        engine: &dyn Engine,
        fibres: Fibres,
        level: u32,
        stop: Stop,
        screen: &mut Option<OnScreen>,
    ) -> Result<Traced, StillError> {
        let mut still = self.request.still.clone();
        still.width = (still.width >> level).max(1);
        still.height = (still.height >> level).max(1);
        still.stop = stop;
        let mut outcome = Traced::default();
        let mut better: Option<Standing> = None;
        let mut last: Option<(Instant, Duration)> = None;
        let (begun, mut hidden, mut long) = (Instant::now(), Duration::ZERO, false);
        let (mut last_shown, mut failed, exposure) = (0, None, still.exposure_ev);
        let stands = screen.as_ref().map(|screen| screen.standing.clone());
        let shot = Shot::new(&still, still.plan(Subject::Cloth)?)?;
        let drawn = draw(engine, &self.request.design, &shot, self.job, &mut |pass| {
            outcome = Traced {
                pass_seconds: pass.seconds / f64::from(pass.spp.max(1)),
                spp: pass.spp,
                error: pass.error,
            };
            hidden += self.wait_while_hidden();
            // Time in which nobody looked does not count.
            if (begun.elapsed() - hidden).as_secs_f64() > LONGEST {
                long = true;
                last = None;
            }
            let due = |&(when, cost): &(Instant, Duration)| when.elapsed() >= self.patience * cost;
            let unsure = pass.spp < LEAST_SAMPLES;
            if unsure || !last.as_ref().is_none_or(due) || self.job.check().is_err() {
                return;
            }
            let showing = Instant::now();
            let improved = stands.as_ref().and_then(|stands| {
                let clean = if level == 0 {
                    pass.clean(self.job)
                } else {
                    None
                };
                stands.improved(pass.film, clean.as_deref(), exposure)
            });
            if let Some(improved) = improved {
                self.show(&improved, &outcome, level == 0, fibres);
                better = Some(improved);
                last_shown = outcome.spp;
            }
            if long {
                self.job.cancel();
            }
            last = Some((Instant::now(), showing.elapsed()));
        });
        match drawn {
            // The newest pass was perhaps not shown for want of time.
            Ok(still) if last_shown != outcome.spp => {
                let clean = still.clean(self.job);
                let improved = stands
                    .as_ref()
                    .and_then(|stands| stands.improved(&still.film, clean.as_deref(), exposure));
                if let Some(improved) = improved {
                    self.show(&improved, &outcome, level == 0, fibres);
                    better = Some(improved);
                }
            }
            Err(error) if !long => failed = Some(error),
            _ => {}
        }
        if let (Some(screen), Some(better)) = (screen, better) {
            screen.standing = better;
            screen.traced = true;
        }
        failed.map_or(Ok(outcome), Err)
    }

    /// Nobody looks: the film waits, with all that it has. Returns how long it did.
    fn wait_while_hidden(&self) -> Duration {
        let begun = Instant::now();
        let mut shared = self.mailbox.lock();
        while shared.hidden && self.job.check().is_ok() {
            shared = self.mailbox.wait(shared);
        }
        begun.elapsed()
    }

    fn show(&self, picture: &Standing, traced: &Traced, full_size: bool, fibres: Fibres) {
        let size = picture.size().map(|side| side as usize);
        let rgba = picture.rgba();
        if rgba.len() != size[0] * size[1] * 4 {
            return;
        }
        let picture = Picture {
            generation: self.request.generation,
            image: egui::ColorImage::from_rgba_unmultiplied(size, &rgba),
            still: self.request.still.clone(),
            spp: traced.spp,
            seconds: self.begun.elapsed().as_secs_f64(),
            error: traced.error,
            full_size,
            fibres,
        };
        let mut shared = self.mailbox.lock();
        match self.request.aim {
            Aim::Pane => shared.picture = Some(picture),
            Aim::Glass => shared.glass = Some(picture),
        }
        drop(shared);
        (self.mailbox.wake)();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::opened::Opened;
    use crate::window::worker::Quality;

    const SIZE: [u32; 2] = [64, 48];

    fn request(width_mm: f32) -> PreviewRequest {
        let design = Opened::preset("oxford").expect("a preset").design;
        PreviewRequest {
            generation: 1,
            aim: Aim::Pane,
            drawdown: Arc::new(design.weave()),
            design,
            still: StillRequest {
                width: SIZE[0],
                height: SIZE[1],
                width_mm: Some(width_mm),
                centre_mm: Some([0.0; 2]),
                ..StillRequest::default()
            },
            quality: Quality::Good,
            blank: false,
        }
    }

    fn sight(request: &PreviewRequest) -> Sighted {
        let (design, drawdown) = (Arc::clone(&request.design), Arc::clone(&request.drawdown));
        let engine = FirstSight::new(design, drawdown, Arc::default());
        engine
            .look(&request.still, &Job::new())
            .expect("first sight")
    }

    /// What is shown of a view `wider` times as wide as one that was traced, of which
    /// tracing made one green.
    fn carried(wider: f32) -> Vec<u8> {
        const GREEN: [u8; 4] = [30, 200, 60, 255];
        let (before, mut after) = (request(4.0), request(4.0 * wider));
        (after.design, after.drawdown) = (before.design.clone(), before.drawdown.clone());
        let screen = OnScreen {
            still: before.still.clone(),
            aim: Aim::Pane,
            design: Arc::clone(&before.design),
            drawdown: Arc::clone(&before.drawdown),
            sight: Arc::new(sight(&before)),
            standing: Standing::of_rgba(SIZE[0], SIZE[1], &GREEN.repeat(64 * 48)).expect("whole"),
            traced: true,
        };
        let carried = screen.carried(&after, &sight(&after)).expect("known");
        carried.rgba()
    }

    /// How uneven the pixels of a part of the picture are, from its middle outwards.
    fn uneven(rgba: &[u8], within: std::ops::Range<u32>) -> u32 {
        let greens = (0..SIZE[0] * SIZE[1]).filter_map(|at| {
            let away = (at % SIZE[0]).abs_diff(SIZE[0] / 2);
            let beside = (at / SIZE[0]).abs_diff(SIZE[1] / 2);
            let is_there = within.contains(&(away.max(beside * 4 / 3)));
            is_there.then(|| u32::from(rgba[at as usize * 4 + 1]))
        });
        let (low, high) = greens.fold((255, 0), |(low, high), g| (low.min(g), high.max(g)));
        high - low
    }

    #[test]
    fn from_further_away_the_old_picture_is_no_patch() {
        let wide = carried(2.0);
        let (inside, outside) = (uneven(&wide, 0..14), uneven(&wide, 18..32));
        assert!(
            inside.abs_diff(outside) <= 12,
            "the middle is another picture: {inside} {outside}"
        );
        // Control: moved by nothing, it is the old picture as it was.
        assert!(uneven(&carried(1.0), 0..32) <= 1);
        assert!(outside > 12, "threads are seen: {outside}");
    }
}
