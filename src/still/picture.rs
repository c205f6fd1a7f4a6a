//! The picture of a prepared cloth, pass by pass.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::Vec3;

use super::prepare::{PreparedCloth, prepare};
use super::request::{LightChoice, StillReport, StillRequest};
use super::{StillError, effects};
use crate::cloth::ClothSettings;
use crate::design::Design;
use crate::exemplar::ExemplarStore;
use crate::formats::{exr, png};
use crate::job::Job;
use crate::render::{
    self, Both, Camera, Denoise, Film, LightRig, RenderOutcome, RenderSettings, Scatterer, Tone,
    View,
};

/// Degrees across the picture where the eye has a direction of its own.
const FIELD_OF_VIEW: f32 = 30.0;
/// Samples a pixel when a request gives no way to stop.
const USUAL_SPP: u32 = 64;

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

/// The picture so far.
pub struct Pass<'p> {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// sRGB with straight alpha, top row first.
    pub rgba: &'p [u8],
    /// Samples in every pixel.
    pub spp: u32,
    /// Seconds of rendering.
    pub seconds: f64,
    /// Error so far.
    pub error: Option<f64>,
}

/// Effects by name, and whether they are simulated.
pub(super) type SwitchedEffects = Vec<(String, bool)>;

/// The settings that a request makes of the defaults.
pub(super) fn settings(
    request: &StillRequest,
) -> Result<(ClothSettings, RenderSettings, SwitchedEffects), StillError> {
    let mut cloth = ClothSettings::default();
    let mut render = RenderSettings {
        seed: request.seed,
        backing: request.backing,
        spp: request
            .stop
            .spp
            .unwrap_or(match (request.stop.seconds, request.stop.error) {
                (None, None) => USUAL_SPP,
                _ => u32::MAX,
            }),
        error: request.stop.error.unwrap_or(0.0) as f32,
        ..RenderSettings::default()
    };
    cloth.synthesis.seed = request.seed;
    effects::turn(&request.dials, &mut cloth, &mut render)?;
    let on = effects::choose(&request.effects, &mut cloth, &mut render)?;
    Ok((cloth, render, on))
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
            LightRig::from_image(&path.display().to_string(), exr::read_environment(path)?)?
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

/// The camera of a request that looks at `middle` and shows `usual` mm where the request
/// does not say.
pub(super) fn camera_at(
    request: &StillRequest,
    middle: Vec3,
    usual: f32,
) -> Result<Camera, StillError> {
    let (width, height) = (request.width, request.height);
    if !(1..=16_384).contains(&width) || !(1..=16_384).contains(&height) {
        return Err(StillError::Size(width, height));
    }
    let width_mm = request.width_mm.unwrap_or(usual);
    if !(0.01..=100_000.0).contains(&width_mm) {
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
    let (_, settings, _) = settings(request)?;
    let shot = Shot {
        camera: camera(&prepared.design, request)?,
        lights: lights(&request.light, request.view, request.turned)?,
        settings,
        request,
    };
    let (x, y) = in_view(&shot.camera, request);
    let cloth = prepared.cloth().clone().with_window(x, y);
    let hairs = prepared.hair_layer(&cloth);
    let outcome = match &hairs {
        Some(hairs) => shot.expose(&Both(&cloth, hairs), job, on_pass)?,
        None => shot.expose(&cloth, job, on_pass)?,
    };
    let mut still = shot.develop(
        outcome,
        prepared.seconds.clone(),
        prepared.effects.clone(),
        Subject::Design(Arc::clone(&prepared.design)),
    );
    still.report.level = cloth.level();
    still.report.light_error = cloth.light_error();
    Ok(still)
}

/// A picture about to be taken.
pub(super) struct Shot<'r> {
    pub camera: Camera,
    pub lights: LightRig,
    pub settings: RenderSettings,
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
            settings,
            request,
        } = self;
        let tone = self.tone();
        let job = match request
            .stop
            .seconds
            .and_then(|s| Duration::try_from_secs_f64(s).ok())
        {
            Some(time) => job.clone().with_deadline(Instant::now() + time),
            None => job.clone(),
        };
        let denoise = effects::denoises(&request.dials);
        // A preview is denoised only as often as that takes a small part of the time.
        let mut denoised: Option<(Instant, Duration)> = None;
        let mut show = |film: &Film, progress: &render::Progress| {
            let due = denoised.is_none_or(|(when, cost)| when.elapsed() > 4 * cost);
            if denoise && !due && progress.spp < settings.spp {
                return;
            }
            let picture = if denoise {
                let begun = Instant::now();
                let Ok(clean) = Denoise::default().apply(film, &job) else {
                    return;
                };
                let picture = tone.picture_of(film, &clean);
                denoised = Some((Instant::now(), begun.elapsed()));
                picture
            } else {
                tone.picture(film)
            };
            let rgba: Vec<u8> = picture
                .pixels
                .iter()
                .flat_map(|pixel| pixel.map(byte))
                .collect();
            on_pass(&Pass {
                width: picture.width,
                height: picture.height,
                rgba: &rgba,
                spp: progress.spp,
                seconds: progress.seconds,
                error: known(progress.error.error),
            });
        };
        let outcome = render::render(scatterer, camera, lights, settings, &job, &mut show)?;
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
        effects: SwitchedEffects,
        subject: Subject,
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
            effects,
            level: 0,
            light_error: Some(0.0),
            warnings: Vec::new(),
        };
        Still {
            report,
            film: outcome.film,
            tone: self.tone(),
            denoise: effects::denoises(&request.dials),
            depth: effects::png_depth(&request.dials),
            pixels_per_mm: self.camera.pixels_per_mm(),
            subject,
            settings: format!("{request:?}"),
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
    let cloth = prepare(design, request, &ExemplarStore::user(), job)?;
    render(&cloth, request, job, on_pass)
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
    denoise: bool,
    depth: png::Depth,
    pub(super) pixels_per_mm: f32,
    subject: Subject,
    settings: String,
}

/// What a still shows.
pub(super) enum Subject {
    /// A design's cloth.
    Design(Arc<Design>),
    /// A volume that was read, by its name.
    Volume(String),
}

impl Still {
    /// The picture as shown: denoised unless the request said no, sRGB with straight alpha.
    pub fn picture(&self) -> png::Picture {
        if self.denoise {
            // Nobody cancels this one.
            if let Ok(clean) = Denoise::default().apply(&self.film, &Job::new()) {
                return self.tone.picture_of(&self.film, &clean);
            }
        }
        self.tone.picture(&self.film)
    }

    /// What the picture's file says of it.
    pub(super) fn texts(&self) -> Vec<(String, String)> {
        // The hash is of the whole document: it is worked out for pictures that are kept.
        let (title, hash) = match &self.subject {
            Subject::Design(design) => (design.name.clone(), design_hash(design)),
            Subject::Volume(name) => (name.clone(), "a volume".to_owned()),
        };
        [
            (
                "Software",
                format!("Pickglass {}", env!("CARGO_PKG_VERSION")),
            ),
            ("Title", title),
            ("Design", hash),
            ("Settings", self.settings.clone()),
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
                png::write(path, &self.picture(), self.depth, &metadata)?;
            }
            Some(ending) if ending.eq_ignore_ascii_case("exr") => {
                exr::write(path, &self.film, self.pixels_per_mm, &self.texts())?;
            }
            _ => return Err(StillError::Ending(path.to_owned())),
        }
        Ok(())
    }
}
