//! Pictures of a volume that was read, and scenes for other programs round one that is
//! written.

use std::path::Path;
use std::time::Instant;

use super::picture::{Pass, Shot, Still, Subject, camera_at, lights, settings};
use super::{StillError, StillRequest};
use crate::formats::volume::{self, Attachment, mitsuba};
use crate::job::Job;
use crate::render::{Background, Bounds, Camera};
use crate::volume::Taps;
use crate::volume::source::Frame;

/// Renders a `.vol`, `.nrrd` or `.mhd` through the same tracer as cloth, and says what was
/// remarked on while reading it. `on_pass` sees the picture after every pass. Without a
/// width in the request the picture is as wide as the volume.
///
/// # Errors
/// When the volume cannot be read, the request is not usable or the job is cancelled.
pub fn render_grid(
    path: &Path,
    request: &StillRequest,
    job: &Job,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<(Still, Vec<String>), StillError> {
    let (cloth, settings, mut effects) = settings(request)?;
    let begun = Instant::now();
    let taps = if cloth.tap {
        Taps::StochasticTrilinear
    } else {
        Taps::Nearest
    };
    let file = volume::read(path, taps, job)?;
    let reading = ("reading".to_owned(), begun.elapsed().as_secs_f64());
    // Only cloth has these.
    effects.retain(|(name, _)| ["shadows", "multiple", "sky", "tap"].contains(&name.as_str()));
    let shot = Shot {
        camera: camera_over(crate::render::Medium::bounds(&file.grid), request)?,
        lights: lights(&request.light, request.view, request.turned)?,
        settings,
        request,
    };
    let outcome = shot.expose(&file.grid, job, on_pass)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let subject = Subject::Volume(name.into_owned());
    Ok((
        shot.develop(outcome, vec![reading], effects, subject),
        file.warnings,
    ))
}

/// The camera of a request over a box: its middle and its width, unless the request says.
fn camera_over(bounds: Bounds, request: &StillRequest) -> Result<Camera, StillError> {
    let middle = (bounds.min + bounds.max) * 0.5;
    camera_at(request, middle, bounds.max.x - bounds.min.x)
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
    let (_, mut settings, _) = settings(request)?;
    settings.background = Background::Sky;
    let scene = mitsuba::Scene {
        camera: &camera_over(frame.bounds(), request)?,
        lights: &lights(&request.light, request.view, request.turned)?,
        settings: &settings,
    };
    Ok(mitsuba::scene(path, frame, &scene)?)
}
