//! The path tracer on the processor: the reference that other engines are measured against.

use std::sync::Arc;

use super::StillError;
use super::exposure::{Engine, Exposure, Pass};
use super::prepare::prepare;
use super::renderer::{Making, Renderer};
use super::request::{StillReport, StillRequest};
use super::shot::{Shot, camera, camera_over, in_view, origin};
use crate::cloth::{ClothVolume, HairLayer, PreparedCloth, REACH_MM};
use crate::design::Design;
use crate::film::Film;
use crate::job::Job;
use crate::plan::Effect;
use crate::render::{self, BlocksSeen, Both, Medium, Scatterer, look_at_blocks};
use crate::scene::{Bounds, Camera};
use crate::volume::DenseGrid;

/// Its row of the table.
pub(super) static CPU: Renderer = Renderer {
    name: NAME,
    about: "the path tracer on the processor",
    effects: Effect::ALL,
    dials: |_| true,
    refines: true,
    make,
    of_voxels: Some(|grid| Box::new(Voxels(grid))),
};

const NAME: &str = "cpu";

fn make(making: &Making<'_>) -> Result<Box<dyn Engine>, StillError> {
    let Making {
        design,
        request,
        store,
        job,
    } = making;
    Ok(Box::new(prepare(design, request, store, job)?))
}

impl Engine for PreparedCloth {
    fn name(&self) -> &'static str {
        NAME
    }

    fn expose(
        &self,
        shot: &Shot<'_>,
        job: &Job,
        on_pass: &mut dyn FnMut(&Pass<'_>),
    ) -> Result<Exposure, StillError> {
        let (camera, cloth) = before(self, shot)?;
        let hairs = hairs(self, &cloth, shot);
        let stages = self.seconds().to_vec();
        let mut exposure = match &hairs {
            Some(hairs) => trace(&Both(&cloth, hairs), &camera, shot, stages, job, on_pass)?,
            None => trace(&cloth, &camera, shot, stages, job, on_pass)?,
        };
        let report = &mut exposure.report;
        report.level = cloth.level();
        report.light_error = cloth.light_error();
        report.warnings.extend(self.check(&shot.plan.cloth));
        (report.warnings).extend(end_in_view(&camera, &Medium::bounds(&cloth), shot.request));
        Ok(exposure)
    }

    fn look_at(
        &self,
        shot: &Shot<'_>,
        corners: &[[u32; 2]],
        spp: u32,
        job: &Job,
    ) -> Result<Option<BlocksSeen>, StillError> {
        let (camera, cloth) = before(self, shot)?;
        let (lights, settings, blocks) = (&shot.lights, &shot.plan.render, (corners, spp));
        let seen = match &hairs(self, &cloth, shot) {
            Some(hairs) => {
                let both = Both(&cloth, hairs);
                look_at_blocks(&both, &camera, lights, settings, blocks, job)?
            }
            None => look_at_blocks(&cloth, &camera, lights, settings, blocks, job)?,
        };
        Ok(Some(seen))
    }

    fn recolour(&mut self, design: &Arc<Design>) -> bool {
        Self::recolour(self, design)
    }
}

/// The camera of a shot, and the cloth before it.
fn before(prepared: &PreparedCloth, shot: &Shot<'_>) -> Result<(Camera, ClothVolume), StillError> {
    let camera = camera(prepared.design(), shot.request)?;
    let (x, y) = in_view(&camera, shot.request);
    let origin = origin(prepared.design(), shot.request);
    let cloth = prepared.cloth().clone().seen_from(origin);
    let cloth = cloth.with_window(x, y);
    Ok((camera, cloth))
}

/// The hairs over a cloth, where there are any and the shot has them.
fn hairs<'c>(
    prepared: &PreparedCloth,
    cloth: &'c ClothVolume,
    shot: &Shot<'_>,
) -> Option<HairLayer<'c>> {
    let on = shot.plan.on(Effect::Hairs);
    on.then(|| prepared.hair_layer(cloth)).flatten()
}

/// Voxels that were read.
struct Voxels(DenseGrid);

impl Engine for Voxels {
    fn name(&self) -> &'static str {
        NAME
    }

    fn expose(
        &self,
        shot: &Shot<'_>,
        job: &Job,
        on_pass: &mut dyn FnMut(&Pass<'_>),
    ) -> Result<Exposure, StillError> {
        let camera = camera_over(Medium::bounds(&self.0), shot.request)?;
        trace(&self.0, &camera, shot, Vec::new(), job, on_pass)
    }

    /// Voxels have the colours that their file gives them.
    fn recolour(&mut self, _: &Arc<Design>) -> bool {
        false
    }
}

/// Traces anything; `stages` is what went before, in seconds.
fn trace<S: Scatterer>(
    scatterer: &S,
    camera: &Camera,
    shot: &Shot<'_>,
    mut stages: Vec<(String, f64)>,
    job: &Job,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<Exposure, StillError> {
    let (request, plan) = (shot.request, &shot.plan);
    let developing = shot.developing();
    let job = request.stop.bounds(job);
    let mut show = |film: &Film, progress: &render::Progress| {
        on_pass(&Pass {
            spp: progress.spp,
            seconds: progress.seconds,
            error: known(progress.error.error),
            film,
            developing,
        });
    };
    let (lights, settings) = (&shot.lights, &plan.render);
    let outcome = render::render(scatterer, camera, lights, settings, &job, &mut show)?;
    stages.push(("render".to_owned(), outcome.seconds));
    let error = known(outcome.error.error);
    let report = StillReport {
        renderer: NAME.to_owned(),
        width: request.width,
        height: request.height,
        spp: outcome.spp,
        total_seconds: stages.iter().map(|stage| stage.1).sum(),
        seconds: stages,
        paths_per_second: outcome.paths_per_second,
        error,
        error_interval: error.map(|_| [outcome.error.low, outcome.error.high]),
        invalid_samples: outcome.counters.invalid_samples,
        majorant_violations: outcome.counters.majorant_violations,
        capped_walks: outcome.counters.capped_walks,
        invalid_rays: outcome.counters.invalid_rays,
        effects: plan.effects.clone(),
        level: 0,
        light_error: Some(0.0),
        warnings: (shot.lights.warnings.iter().cloned())
            .chain(outcome.counters.warnings())
            .collect(),
    };
    Ok(Exposure {
        film: outcome.film,
        report,
        pixels_per_mm: camera.pixels_per_mm(),
    })
}

fn known(error: f64) -> Option<f64> {
    error.is_finite().then_some(error)
}

/// A remark where the picture shows the end of a cloth that repeats without one.
fn end_in_view(camera: &Camera, bounds: &Bounds, request: &StillRequest) -> Option<String> {
    let (width, height) = (request.width as f32, request.height as f32);
    let beyond = |x: f32, y: f32| {
        let ray = camera.ray(x, y);
        let at = ray.at(-ray.origin.z / ray.direction.z);
        // No corner of a picture shows the cloth's own edge by chance: it ends there, or the
        // ray never meets its plane.
        [
            (at.x, bounds.min.x, bounds.max.x),
            (at.y, bounds.min.y, bounds.max.y),
        ]
        .into_iter()
        .any(|(at, low, high)| !(at >= low || low > -REACH_MM) || !(at <= high || high < REACH_MM))
    };
    let corners = [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)];
    corners.into_iter().any(|(x, y)| beyond(x, y)).then(|| {
        format!(
            "the cloth is made {:.0} m to each side of what is looked at: the picture shows \
             where it ends; show less with --mm",
            1e-3 * REACH_MM
        )
    })
}
