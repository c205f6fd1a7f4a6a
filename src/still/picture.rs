//! The picture of a prepared cloth, pass by pass.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use glam::Vec3;

use super::again::Again;
use super::prepare::{PreparedCloth, prepare};
use super::request::{LightChoice, StillReport, StillRequest};
use super::{StillError, finishing};
use crate::cloth::REACH_MM;
use crate::design::Design;
use crate::exemplar::ExemplarStore;
use crate::film::{Denoise, Film, Pixel, Tone};
use crate::formats::{exr, png};
use crate::job::Job;
use crate::limits;
use crate::memory;
use crate::plan::{Effect, Plan, ShowingDials, Subject};
use crate::render::{self, Both, RenderOutcome, Scatterer};
use crate::scene::{Bounds, Camera, LightRig, View};

/// Degrees across the picture where the eye has a direction of its own.
const FIELD_OF_VIEW: f32 = 30.0;

/// Width of cloth a view shows when none is asked for, mm.
pub fn usual_width_mm(view: View, design: &Design) -> f32 {
    let pitch = design
        .sett()
        .ends
        .mean_pitch_mm()
        .max(design.sett().picks.mean_pitch_mm());
    match view {
        View::Close => pitch * 9.0,
        View::Oblique | View::Grazing => pitch * 24.0,
        View::Face | View::Back => (pitch * design.ends() as f32).clamp(pitch * 24.0, pitch * 72.0),
    }
}

/// The picture so far. What it shows is worked out when it is asked for.
pub struct Pass<'p> {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Samples in every pixel.
    pub spp: u32,
    /// Seconds of rendering.
    pub seconds: f64,
    /// Error so far.
    pub error: Option<f64>,
    pub(super) content: Content<'p>,
}

/// What a pass is made of.
#[derive(Clone, Copy)]
pub(super) enum Content<'p> {
    /// sRGB with straight alpha, top row first.
    Sighted(&'p [u8]),
    /// A film, how it is shown, and whether it is denoised for that.
    Traced(&'p Film, Tone, bool),
}

impl<'p> Pass<'p> {
    /// sRGB with straight alpha, top row first.
    pub fn rgba(&self) -> Cow<'p, [u8]> {
        let (film, tone) = match self.content {
            Content::Sighted(rgba) => return Cow::Borrowed(rgba),
            Content::Traced(film, tone, _) => (film, tone),
        };
        let picture = match self.clean(&Job::new()) {
            Some(clean) => tone.picture_of(film, &clean),
            None => tone.picture(film),
        };
        let pixels = picture.pixels.iter();
        pixels.flat_map(|pixel| pixel.map(byte)).collect()
    }

    /// The film, where anything was traced.
    pub fn film(&self) -> Option<&'p Film> {
        match self.content {
            Content::Sighted(_) => None,
            Content::Traced(film, _, _) => Some(film),
        }
    }

    /// The film's radiances denoised, where they are and the job is not cancelled.
    pub fn clean(&self, job: &Job) -> Option<Vec<Vec3>> {
        match self.content {
            Content::Traced(film, _, true) => Denoise::default().apply(film, job).ok(),
            _ => None,
        }
    }
}

/// The light on a cloth that is seen in a view and, where `turned`, turned by 180°: it stays
/// with the viewer.
pub(super) fn lights(
    choice: &LightChoice,
    view: View,
    turned: bool,
) -> Result<LightRig, StillError> {
    let rig = match choice {
        LightChoice::Preset(name) => LightRig::preset(name)?,
        LightChoice::Sun(heading) => LightRig::sun(heading.azimuth, heading.elevation)?,
        LightChoice::Environment(path) => {
            let read = exr::read_environment(path)?;
            let mut rig = LightRig::from_image(&path.display().to_string(), read.image)?;
            rig.warnings.extend(read.warnings);
            rig
        }
    };
    let rig = if view.turns_over() {
        rig.turned_over()
    } else {
        rig
    };
    Ok(if turned { rig.turned() } else { rig })
}

pub(super) fn camera(design: &Design, request: &StillRequest) -> Result<Camera, StillError> {
    let [x, y] = [
        design.end_positions().repeat_mm(),
        design.pick_positions().repeat_mm(),
    ]
    .map(|repeat| 0.5 * repeat as f32);
    let usual = usual_width_mm(request.view, design);
    camera_at(request, Vec3::new(x, y, 0.0), usual)
}

/// Where a picture of `request` lies on one of `before`, the same cloth seen from the same
/// side without perspective: its upper left corner in pixels of that one, and how many of
/// those a pixel is. `None` where the two are not such views.
pub fn place_on(
    design: &Design,
    before: &StillRequest,
    request: &StillRequest,
) -> Option<([f32; 2], f32)> {
    let straight = |request: &StillRequest| {
        request.eye.is_none() && matches!(request.view, View::Face | View::Back)
    };
    if !(straight(before) && straight(request) && before.view == request.view) {
        return None;
    }
    let cameras = [camera(design, before).ok()?, camera(design, request).ok()?];
    let at = |camera: &Camera, x: f32, y: f32| camera.ray(x, y).origin.truncate();
    let [before, request] = cameras;
    let corner = at(&before, 0.0, 0.0);
    let (across, down) = (
        at(&before, 1.0, 0.0) - corner,
        at(&before, 0.0, 1.0) - corner,
    );
    let offset = at(&request, 0.0, 0.0) - corner;
    let step = at(&request, 1.0, 0.0) - at(&request, 0.0, 0.0);
    let pixels = |vector: glam::Vec2, along: glam::Vec2| vector.dot(along) / along.length_squared();
    let scale = pixels(step, across);
    let place = [pixels(offset, across), pixels(offset, down)];
    let sound = scale > 0.0 && scale.is_finite() && place.iter().all(|at| at.is_finite());
    sound.then_some((place, scale))
}

/// The camera of a request that looks at `middle` and shows `usual` mm where the request
/// does not say.
pub(super) fn camera_at(
    request: &StillRequest,
    middle: Vec3,
    usual: f32,
) -> Result<Camera, StillError> {
    let (width, height) = (request.width, request.height);
    if !limits::PICTURE_SIDE.contains(&width) || !limits::PICTURE_SIDE.contains(&height) {
        return Err(StillError::Size(width, height));
    }
    let width_mm = request.width_mm.unwrap_or(usual);
    if !limits::PICTURE_MM.contains(&width_mm) {
        return Err(StillError::Width(width_mm));
    }
    let [x, y] = request.centre_mm.unwrap_or([middle.x, middle.y]);
    let target = Vec3::new(x, y, middle.z);
    let camera = match request.eye {
        None => request.view.camera(target, width_mm, width, height),
        Some(heading) => {
            let from = heading.towards();
            // The back is seen after turning the cloth over about its y axis.
            let from = match request.view.turns_over() {
                true => Vec3::new(-from.x, from.y, -from.z),
                false => from,
            };
            Camera::perspective(
                target,
                from,
                Vec3::Y,
                FIELD_OF_VIEW,
                width_mm,
                width,
                height,
            )
        }
    };
    Ok(match request.turned {
        true => camera.turned(),
        false => camera,
    })
}

/// Bytes a pixel of a picture that is shown and written: colours, samples, encoded bytes.
pub(super) const SHOWN_BYTES: u64 = 40;

/// Asks for the memory that a picture takes from film to file.
///
/// # Errors
/// [`StillError::Memory`].
pub(super) fn ask_for_picture(width: u32, height: u32) -> Result<(), StillError> {
    let pixel = size_of::<Pixel>() as u64 + Denoise::BYTES + SHOWN_BYTES;
    let pixels = u64::from(width) * u64::from(height);
    memory::ask(pixels.saturating_mul(pixel), || {
        format!("a picture of {width} × {height} pixels")
    })?;
    Ok(())
}

/// Renders one picture; `on_pass` sees it after every pass.
///
/// # Errors
/// When the request is not usable or the job is cancelled.
pub fn render(
    prepared: &PreparedCloth,
    request: &StillRequest,
    job: &Job,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<Still, StillError> {
    let lights = lights(&request.light, request.view, request.turned)?;
    render_lit(prepared, request, lights, job, on_pass)
}

/// As [`render()`], in a light that was read before.
pub(super) fn render_lit(
    prepared: &PreparedCloth,
    request: &StillRequest,
    lights: LightRig,
    job: &Job,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<Still, StillError> {
    let plan = request.plan(Subject::Cloth)?;
    let shot = Shot {
        camera: camera(&prepared.design, request)?,
        lights,
        plan,
        request,
    };
    let (x, y) = in_view(&shot.camera, request);
    let cloth = prepared.cloth().clone().with_window(x, y);
    let hairs = match shot.plan.on(Effect::Hairs) {
        true => prepared.hair_layer(&cloth),
        false => None,
    };
    let outcome = match &hairs {
        Some(hairs) => shot.expose(&Both(&cloth, hairs), job, on_pass)?,
        None => shot.expose(&cloth, job, on_pass)?,
    };
    let mut still = shot.develop(
        outcome,
        prepared.seconds.clone(),
        Shown::Design(Arc::clone(&prepared.design)),
    );
    still.report.level = cloth.level();
    (still.report.warnings).extend(prepared.check(&shot.plan.cloth));
    still.report.light_error = cloth.light_error();
    (still.report.warnings).extend(end_in_view(&shot.camera, &cloth.bounds(), request));
    Ok(still)
}

/// A picture about to be taken.
pub(super) struct Shot<'r> {
    pub camera: Camera,
    pub lights: LightRig,
    pub plan: Plan,
    pub request: &'r StillRequest,
}

impl Shot<'_> {
    /// Traces anything; `on_pass` sees the picture after every pass.
    pub fn expose<S: Scatterer>(
        &self,
        scatterer: &S,
        job: &Job,
        on_pass: &mut dyn FnMut(&Pass<'_>),
    ) -> Result<RenderOutcome, StillError> {
        let Self {
            camera,
            lights,
            plan,
            request,
        } = self;
        ask_for_picture(request.width, request.height)?;
        let tone = self.tone();
        let job = request.stop.bounds(job);
        let denoise = plan.showing.denoise;
        let mut show = |film: &Film, progress: &render::Progress| {
            on_pass(&Pass {
                width: film.width(),
                height: film.height(),
                spp: progress.spp,
                seconds: progress.seconds,
                error: known(progress.error.error),
                content: Content::Traced(film, tone, denoise),
            });
        };
        let outcome = render::render(scatterer, camera, lights, &plan.render, &job, &mut show)?;
        Ok(outcome)
    }

    fn tone(&self) -> Tone {
        Tone {
            exposure: self.request.exposure_ev,
        }
    }

    /// The still of a film: `seconds` before rendering, and what it shows.
    pub fn develop(
        &self,
        outcome: RenderOutcome,
        mut seconds: Vec<(String, f64)>,
        shown: Shown,
    ) -> Still {
        let request = self.request;
        seconds.push(("render".to_owned(), outcome.seconds));
        let report = StillReport {
            renderer: "cpu".to_owned(),
            width: request.width,
            height: request.height,
            spp: outcome.spp,
            total_seconds: seconds.iter().map(|stage| stage.1).sum(),
            seconds,
            paths_per_second: outcome.paths_per_second,
            error: known(outcome.error.error),
            error_interval: known(outcome.error.error)
                .map(|_| [outcome.error.low, outcome.error.high]),
            invalid_samples: outcome.counters.invalid_samples,
            majorant_violations: outcome.counters.majorant_violations,
            capped_walks: outcome.counters.capped_walks,
            invalid_rays: outcome.counters.invalid_rays,
            effects: self.plan.effects.clone(),
            level: 0,
            light_error: Some(0.0),
            warnings: (self.lights.warnings.iter().cloned())
                .chain(outcome.counters.warnings())
                .collect(),
        };
        Still {
            again: Again::new(request, &report),
            report,
            film: outcome.film,
            tone: self.tone(),
            showing: self.plan.showing,
            pixels_per_mm: self.camera.pixels_per_mm(),
            shown,
        }
    }
}

/// The stretch of cloth that a camera sees most of, mm in x and y.
pub(super) fn in_view(
    camera: &Camera,
    request: &StillRequest,
) -> (std::ops::Range<f32>, std::ops::Range<f32>) {
    // A slanting view reaches further.
    let reach = match (request.eye, request.view) {
        (Some(eye), _) => (0.8 / eye.towards().z).min(2.5),
        (None, View::Face | View::Back | View::Close) => 0.6,
        (None, View::Oblique) => 1.2,
        (None, View::Grazing) => 2.5,
    };
    let target = camera.target();
    let across = reach * camera.width() as f32 / camera.pixels_per_mm();
    let along = reach * camera.height() as f32 / camera.pixels_per_mm();
    (
        target.x - across..target.x + across,
        target.y - along..target.y + along,
    )
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
            "the cloth is made {:.0} m to each side of its first crossing: the picture shows \
             where it ends; show less with --mm",
            1e-3 * REACH_MM
        )
    })
}

/// Prepares and renders in one go, with the user's exemplar store.
///
/// # Errors
/// As [`prepare`] and [`render()`].
pub fn render_still(
    design: &Arc<Design>,
    request: &StillRequest,
    job: &Job,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<Still, StillError> {
    ask_for_picture(request.width, request.height)?;
    let job = &finishing::bounded(request, job);
    // What is wrong with the light is said before anything takes long.
    let lights = lights(&request.light, request.view, request.turned)?;
    let cloth = prepare(design, request, &ExemplarStore::user(), job)?;
    render_lit(&cloth, request, lights, job, on_pass)
}

fn known(error: f64) -> Option<f64> {
    error.is_finite().then_some(error)
}

pub(super) fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// Hash of a design's document, hexadecimal.
fn design_hash(design: &Design) -> String {
    match crate::formats::ron::write(design) {
        Ok(text) => blake3::hash(text.as_bytes()).to_hex()[..16].to_owned(),
        Err(_) => "unknown".to_owned(),
    }
}

/// A finished picture with its film.
pub struct Still {
    /// How it came about.
    pub report: StillReport,
    /// Linear means, variances and features.
    pub film: Film,
    tone: Tone,
    pub(super) showing: ShowingDials,
    pub(super) pixels_per_mm: f32,
    shown: Shown,
    again: Again,
}

/// What a still shows.
pub(super) enum Shown {
    /// A design's cloth.
    Design(Arc<Design>),
    /// A volume that was read, by its name.
    Volume(String),
}

impl Still {
    /// The same, of what a command line calls `source`: a file or the name of a preset, with
    /// the options for reading it.
    pub fn made_from(mut self, source: String) -> Self {
        self.again.source = Some(source);
        self
    }

    /// The command line that makes the picture again.
    pub fn command_line(&self) -> String {
        self.again.line()
    }

    /// The film's radiances denoised; `None` where the request said not to, or the job is
    /// cancelled.
    pub fn clean(&self, job: &Job) -> Option<Vec<Vec3>> {
        let clean = (self.showing.denoise).then(|| Denoise::default().apply(&self.film, job));
        clean?.ok()
    }

    /// The picture as shown: denoised unless the request said no, sRGB with straight alpha.
    pub fn picture(&self) -> crate::film::Picture {
        // Nobody cancels this one.
        match self.clean(&Job::new()) {
            Some(clean) => self.tone.picture_of(&self.film, &clean),
            None => self.tone.picture(&self.film),
        }
    }

    /// What the picture's file says of it.
    pub(super) fn texts(&self) -> Vec<(String, String)> {
        // The hash is of the whole document: it is worked out for pictures that are kept.
        let (title, hash) = match &self.shown {
            Shown::Design(design) => (design.name.clone(), design_hash(design)),
            Shown::Volume(name) => (name.clone(), "a volume".to_owned()),
        };
        [
            (
                "Software",
                format!("Pickglass {}", env!("CARGO_PKG_VERSION")),
            ),
            ("Title", title),
            ("Design", hash),
            ("Settings", self.command_line()),
            ("invalid_samples", self.report.invalid_samples.to_string()),
            (
                "majorant_violations",
                self.report.majorant_violations.to_string(),
            ),
            ("capped_walks", self.report.capped_walks.to_string()),
            ("invalid_rays", self.report.invalid_rays.to_string()),
        ]
        .map(|(key, text)| (key.to_owned(), text))
        .to_vec()
    }

    /// Writes `.png` or `.exr`, replacing the file in one step.
    ///
    /// # Errors
    /// When the ending is neither or the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), StillError> {
        match path.extension().and_then(|ending| ending.to_str()) {
            Some(ending) if ending.eq_ignore_ascii_case("png") => {
                let metadata = png::Metadata {
                    pixels_per_mm: Some(self.pixels_per_mm),
                    texts: self.texts(),
                };
                png::write(path, &self.picture(), self.showing.png_depth, &metadata)?;
            }
            Some(ending) if ending.eq_ignore_ascii_case("exr") => {
                exr::write(path, &self.film, self.pixels_per_mm, &self.texts())?;
            }
            _ => return Err(StillError::Ending(path.to_owned())),
        }
        Ok(())
    }
}
