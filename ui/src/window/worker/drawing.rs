//! The pictures of one request: first sight, then traced ones, each only once it is better
//! than what is shown.

use std::sync::Arc;
use std::time::Instant;

use pickglass::design::WeavePattern;
use pickglass::job::Job;
use pickglass::still::{
    Engine, FirstSight, Pass, SightTables, Sighted, StillError, StillRequest, Stop,
};

use super::{Aim, Desk, Fibres, Picture, PreviewRequest};

/// A preview ends at this error, or after this many passes.
const GOOD_ERROR: f64 = 0.005;
const MOST_PASSES: u32 = 4096;
/// First sight looks about as good as a traced picture of so many paths a pixel.
const SIGHT_WORTH: f64 = 0.25;
/// A picture in which an edit was put in by first sight counts at most as so many paths a
/// pixel, so that the edit is soon traced as well.
const EDITED_WORTH: f64 = 4.0;
/// First sight shows each crossing: where the whole picture could, one of a coarser level
/// is better only with so many pixels a crossing.
const RESOLVED: f32 = 4.0;
/// Beyond this share of changed pixels the whole picture counts as first sight.
const MOSTLY_CHANGED: f64 = 0.2;

/// What is on the screen, to build the next picture on.
pub(super) struct OnScreen {
    still: StillRequest,
    aim: Aim,
    design: Arc<pickglass::design::Design>,
    drawdown: Arc<WeavePattern>,
    /// First sight of the same.
    sight: Arc<Sighted>,
    /// The picture of the request's size, where it has been traced at that size.
    traced: Option<Vec<u8>>,
    /// Paths in the picture.
    paths: f64,
}

impl OnScreen {
    fn same_place(&self, request: &PreviewRequest) -> bool {
        let place = |still: &StillRequest| StillRequest {
            stop: Stop::default(),
            colourway: None,
            ..still.clone()
        };
        self.aim == request.aim && place(&self.still) == place(&request.still)
    }

    fn same_cloth(&self, request: &PreviewRequest) -> bool {
        Arc::ptr_eq(&self.design, &request.design)
            && Arc::ptr_eq(&self.drawdown, &request.drawdown)
            && self.still.colourway == request.still.colourway
    }
}

/// The pictures of one request.
pub(super) struct Drawing<'r> {
    pub desk: &'r Desk,
    pub request: &'r PreviewRequest,
    pub job: &'r Job,
    pub begun: Instant,
}

impl Drawing<'_> {
    fn pixels(&self) -> f64 {
        f64::from(self.request.still.width) * f64::from(self.request.still.height)
    }

    /// Shows the request at first sight; where only an edit is new, what it does not touch
    /// keeps the picture that is shown, and the rest learns from it.
    pub fn first_sight(
        &self,
        tables: &Arc<SightTables>,
        screen: &mut Option<OnScreen>,
    ) -> Result<(), StillError> {
        let request = self.request;
        let known = screen.take().filter(|_| !request.blank);
        if let Some(known) = known.as_ref().filter(|known| known.same_place(request))
            && known.same_cloth(request)
        {
            // The very same picture goes on, after a pause or with better exemplars.
            *screen = Some(OnScreen {
                still: request.still.clone(),
                aim: request.aim,
                design: Arc::clone(&request.design),
                drawdown: Arc::clone(&request.drawdown),
                sight: Arc::clone(&known.sight),
                traced: known.traced.clone(),
                paths: known.paths.min(self.pixels() * EDITED_WORTH),
            });
            return Ok(());
        }
        let engine = FirstSight::new(
            Arc::clone(&request.design),
            Arc::clone(&request.drawdown),
            Arc::clone(tables),
        );
        let sight = engine.look(&request.still, self.job)?;
        let worth = self.pixels() * SIGHT_WORTH;
        let (mut traced, mut paths) = (None, worth);
        let mut under = false;
        if let Some(known) = &known {
            if known.same_place(request) {
                if let Some(picture) = known.traced.as_ref()
                    && let Some(carried) = known.sight.carried_to(&sight, picture)
                {
                    if carried.changed < MOSTLY_CHANGED {
                        paths = known.paths.min(self.pixels() * EDITED_WORTH).max(worth);
                    }
                    traced = Some(carried.rgba);
                }
            } else {
                // The eye moved: the picture that is shown lies over what is new.
                let turned = known.still.turned != request.still.turned;
                under = known.aim == request.aim && known.same_cloth(request) && !turned;
            }
        }
        let shown = traced.as_ref().unwrap_or(&sight.rgba);
        self.send(
            [request.still.width, request.still.height],
            shown,
            0,
            None,
            Fibres::Coarse { light_error: None },
            under,
        );
        *screen = Some(OnScreen {
            still: request.still.clone(),
            aim: request.aim,
            design: Arc::clone(&request.design),
            drawdown: Arc::clone(&request.drawdown),
            sight: Arc::new(sight),
            traced,
            paths,
        });
        Ok(())
    }

    /// Traces at 1/2^level of the size for `seconds`, at least one pass; at level 0 until
    /// the picture is good. Returns the seconds a pass took.
    pub fn trace(
        &self,
        cloth: &dyn Engine,
        fibres: Fibres,
        level: u32,
        seconds: f64,
        screen: &mut Option<OnScreen>,
    ) -> Result<f64, StillError> {
        let mut still = self.request.still.clone();
        still.width = (still.width >> level).max(1);
        still.height = (still.height >> level).max(1);
        still.stop = if level > 0 {
            Stop {
                seconds: Some(seconds.max(0.0)),
                ..Stop::default()
            }
        } else {
            Stop {
                spp: Some(MOST_PASSES),
                error: Some(GOOD_ERROR),
                ..Stop::default()
            }
        };
        let mut pass_seconds = 0.0;
        cloth.draw(&still, self.job, &mut |pass| {
            pass_seconds = pass.seconds / f64::from(pass.spp.max(1));
            let paths = f64::from(pass.spp) * f64::from(pass.width) * f64::from(pass.height);
            let before = screen.as_ref().map_or(0.0, |screen| screen.paths);
            // A finer picture is shown once it is no noisier than the coarser one.
            let better = 2.0 * paths >= before && self.resolves(level);
            if better && self.job.check().is_ok() {
                self.show(pass, level == 0, fibres);
                if let Some(screen) = screen {
                    screen.paths = paths;
                    screen.traced = enlarged(pass, &self.request.still);
                }
            }
        })?;
        Ok(pass_seconds)
    }

    /// Whether a level shows crossings, where they can be told apart at all.
    fn resolves(&self, level: u32) -> bool {
        let still = &self.request.still;
        let Some(width_mm) = still.width_mm else {
            return true;
        };
        let sett = self.request.design.sett();
        let pitch = (sett.ends.mean_pitch_mm()).min(sett.picks.mean_pitch_mm());
        let crossing = pitch / width_mm.max(1e-6) * still.width as f32;
        crossing < RESOLVED || crossing / (1u64 << level.min(32)) as f32 >= RESOLVED
    }

    fn show(&self, pass: &Pass<'_>, full_size: bool, fibres: Fibres) {
        let size = [pass.width, pass.height];
        let error = (pass.error, full_size);
        self.send(size, pass.rgba, pass.spp, Some(error), fibres, false);
    }

    fn send(
        &self,
        size: [u32; 2],
        rgba: &[u8],
        spp: u32,
        traced: Option<(Option<f64>, bool)>,
        fibres: Fibres,
        under: bool,
    ) {
        let size = size.map(|side| side as usize);
        if rgba.len() != size[0] * size[1] * 4 {
            return;
        }
        let picture = Picture {
            generation: self.request.generation,
            image: egui::ColorImage::from_rgba_unmultiplied(size, rgba),
            still: self.request.still.clone(),
            spp,
            seconds: self.begun.elapsed().as_secs_f64(),
            error: traced.and_then(|(error, _)| error),
            full_size: traced.is_some_and(|(_, full_size)| full_size),
            fibres,
            under,
        };
        let mut shared = self.desk.lock();
        match self.request.aim {
            Aim::Pane => shared.picture = Some(picture),
            Aim::Glass => shared.glass = Some(picture),
        }
        drop(shared);
        (self.desk.wake)();
    }
}

/// A picture of a level at the size of the request, between its pixels.
fn enlarged(pass: &Pass<'_>, still: &StillRequest) -> Option<Vec<u8>> {
    let (width, height) = (still.width as usize, still.height as usize);
    let (from_width, from_height) = (pass.width as usize, pass.height as usize);
    if pass.rgba.len() != from_width * from_height * 4 || pass.rgba.is_empty() {
        return None;
    }
    if (from_width, from_height) == (width, height) {
        return Some(pass.rgba.to_vec());
    }
    // Place of a pixel's middle in the smaller picture: two neighbours and how far between.
    let places = |count: usize, from: usize| -> Vec<(usize, usize, u32)> {
        (0..count)
            .map(|at| {
                let place = (at as f32 + 0.5) * from as f32 / count as f32 - 0.5;
                let low = place.floor().clamp(0.0, (from - 1) as f32);
                let share = ((place - low).clamp(0.0, 1.0) * 256.0) as u32;
                (low as usize, (low as usize + 1).min(from - 1), share)
            })
            .collect()
    };
    let (columns, rows) = (places(width, from_width), places(height, from_height));
    let mut rgba = Vec::with_capacity(width * height * 4);
    for (below, above, v) in rows {
        for &(left, right, u) in &columns {
            for channel in 0..4 {
                let at =
                    |x: usize, y: usize| u32::from(pass.rgba[(y * from_width + x) * 4 + channel]);
                let low = at(left, below) * (256 - u) + at(right, below) * u;
                let high = at(left, above) * (256 - u) + at(right, above) * u;
                rgba.push(((low * (256 - v) + high * v) >> 16) as u8);
            }
        }
    }
    Some(rgba)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn enlarging_keeps_flat_colours_and_runs_between_others() {
        let rgba = [[10, 20, 30, 255], [210, 20, 30, 255]].concat();
        let pass = Pass {
            width: 2,
            height: 1,
            rgba: &rgba,
            spp: 1,
            seconds: 0.0,
            error: None,
        };
        let still = StillRequest {
            width: 8,
            height: 3,
            ..StillRequest::default()
        };
        let large = enlarged(&pass, &still).expect("a picture");
        assert_eq!(large.len(), 8 * 3 * 4);
        let reds: Vec<u8> = large[..32].chunks(4).map(|pixel| pixel[0]).collect();
        assert!(
            reds.is_sorted() && reds[0] == 10 && reds[7] == 210,
            "{reds:?}"
        );
        assert!(large.chunks(4).all(|pixel| pixel[1..] == [20, 30, 255]));
    }
}
