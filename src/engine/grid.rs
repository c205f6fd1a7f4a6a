//! Pictures of a volume that was read, and scenes for other programs round one that is
//! written.

use std::path::Path;
use std::time::Instant;

use super::exposure::Pass;
use super::renderer::Renderer;
use super::shot::{Shot, camera_over, lights};
use super::still::{Shown, Still, develop};
use super::{StillError, StillRequest, finishing};
use crate::formats::volume::{self, Attachment, mitsuba};
use crate::job::Job;
use crate::plan::{Effect, Subject};
use crate::volume::Taps;
use crate::volume::source::Frame;

/// Renders a volume through the same tracer as cloth, and says what was remarked on while
/// reading it. `on_pass` sees the picture after every pass. Without a width in the request
/// the picture is as wide as the volume. `voxel_mm` is the edge of a voxel along x, where the
/// file does not say it.
///
/// A point is the voxel that holds it, as in the scenes that go out with a volume; filtered
/// where the request turns the effect `tap` on by name.
///
/// # Errors
/// When the volume cannot be read, the request is not usable or the job is cancelled.
pub fn render_grid(
    (path, voxel_mm): (&Path, Option<f64>),
    request: &StillRequest,
    renderer: &Renderer,
    job: &Job,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<(Still, Vec<String>), StillError> {
    renderer.check(Subject::Voxels)?;
    let shot = Shot::new(request, renderer.plan(request, Subject::Voxels)?)?;
    let begun = Instant::now();
    let taps = match shot.plan.on(Effect::Tap) {
        true => Taps::StochasticTrilinear,
        false => Taps::Nearest,
    };
    let job = &finishing::bounded(request, job);
    let file = volume::read_scaled(path, taps, voxel_mm, job)?;
    let reading = begun.elapsed().as_secs_f64();
    let engine = renderer.over(file.grid)?;
    let mut exposure = engine.expose(&shot, job, on_pass)?;
    let report = &mut exposure.report;
    report.seconds.insert(0, ("reading".to_owned(), reading));
    report.total_seconds += reading;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let shown = Shown::Volume(name.into_owned());
    Ok((develop(&shot, exposure, shown), file.warnings))
}

/// What stands beside an exported `.vol` so that Mitsuba shows it as `request` does.
///
/// # Errors
/// When the request is not usable.
pub fn scene_files(
    path: &Path,
    frame: &Frame,
    request: &StillRequest,
) -> Result<Vec<Attachment>, StillError> {
    let settings = request.plan(Subject::Voxels)?.render;
    let scene = mitsuba::Scene {
        camera: &camera_over(frame.bounds(), request)?,
        lights: &lights(&request.light, request.pose())?,
        max_order: settings.max_order,
        roulette_order: settings.roulette_order,
        sky: settings.sky,
    };
    Ok(mitsuba::scene(path, frame, &scene)?)
}

/// What is remarked on about a light's file, one line each.
///
/// # Errors
/// When the light is not usable.
pub fn light_warnings(request: &StillRequest) -> Result<Vec<String>, StillError> {
    Ok(lights(&request.light, request.pose())?.warnings)
}
