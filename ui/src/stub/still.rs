//! A picture of cloth, from a design to the passes of a film.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use pickglass::design::Design;
use pickglass::job::{Cancelled, Job};
use pickglass::render::{Backing, PRESET_NAMES, View};

/// Width of cloth a view shows when none is asked for, mm.
pub fn usual_width_mm(view: View, design: &Design) -> f32 {
    let pitch = design.sett().end_pitch_mm();
    match view {
        View::Close => pitch * 8.0,
        _ => (pitch * design.ends() as f32).clamp(pitch * 24.0, pitch * 64.0),
    }
}

/// What lights the cloth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LightChoice {
    /// A rig by name, one of [`PRESET_NAMES`].
    Preset(String),
    /// An equirectangular `.exr`.
    Environment(PathBuf),
}

impl Default for LightChoice {
    fn default() -> Self {
        Self::Preset(PRESET_NAMES[0].to_owned())
    }
}

/// Which effects to start from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EffectBase {
    #[default]
    Auto,
    All,
    None,
}

/// Which effects are simulated.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct EffectChoice {
    pub base: EffectBase,
    pub changes: Vec<(String, bool)>,
}

/// When to stop refining: at the first that is reached.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stop {
    pub spp: Option<u32>,
    pub seconds: Option<f64>,
    pub error: Option<f64>,
}

/// A picture that is asked for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StillRequest {
    /// Pixels.
    pub width: u32,
    pub height: u32,
    pub view: View,
    /// Width of cloth the picture shows, mm; `None` = the view's own.
    pub width_mm: Option<f32>,
    /// The point of the cloth in the picture's middle, mm; `None` = the design's middle.
    pub centre_mm: Option<[f32; 2]>,
    pub light: LightChoice,
    pub exposure_ev: f32,
    pub backing: Backing,
    pub effects: EffectChoice,
    pub dials: Vec<(String, String)>,
    pub seed: u64,
    pub stop: Stop,
}

/// How a picture came about.
#[derive(Debug, Clone, Default)]
pub struct StillReport {
    pub renderer: String,
    pub width: u32,
    pub height: u32,
    pub spp: u32,
    /// Stages in order, without the total.
    pub seconds: Vec<(String, f64)>,
    pub total_seconds: f64,
    pub paths_per_second: f64,
    pub error: Option<f64>,
    pub invalid_samples: u64,
    pub majorant_violations: u64,
    pub effects: Vec<(String, bool)>,
}

/// The picture so far.
pub struct Pass<'p> {
    pub width: u32,
    pub height: u32,
    /// sRGB with straight alpha, top row first.
    pub rgba: &'p [u8],
    pub spp: u32,
    pub seconds: f64,
    pub error: Option<f64>,
}

#[derive(Debug, thiserror::Error)]
pub enum StillError {
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    #[error("{path}: {problem}: choose another place with -o")]
    Write { path: String, problem: String },
}

/// A finished picture with its film.
pub struct Still {
    pub report: StillReport,
    rgba: Vec<u8>,
}

impl Still {
    /// Writes `.png` or `.exr`, replacing the file in one step.
    pub fn save(&self, path: &Path) -> Result<(), StillError> {
        let wrong = |problem: String| StillError::Write {
            path: path.display().to_string(),
            problem,
        };
        let picture =
            image::RgbaImage::from_raw(self.report.width, self.report.height, self.rgba.clone())
                .ok_or_else(|| wrong("wrong size".to_owned()))?;
        let part = path.with_extension("part");
        picture
            .save_with_format(&part, image::ImageFormat::Png)
            .map_err(|error| wrong(error.to_string()))?;
        std::fs::rename(&part, path).map_err(|error| wrong(error.to_string()))
    }
}

/// A cloth that can be looked at: exemplars built, blocks assigned, edges fixed.
pub struct PreparedCloth {
    design: Arc<Design>,
    weave: pickglass::design::WeavePattern,
    seconds: Vec<(String, f64)>,
}

/// Builds what every picture of a design needs; `request` gives the dials and the seed.
pub fn prepare(
    design: &Arc<Design>,
    _request: &StillRequest,
    job: &Job,
) -> Result<PreparedCloth, StillError> {
    let start = Instant::now();
    for step in 0..10 {
        job.check()?;
        job.report("building exemplars", step as f32 / 10.0);
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    Ok(PreparedCloth {
        design: Arc::clone(design),
        weave: design.weave(),
        seconds: vec![("exemplars".to_owned(), start.elapsed().as_secs_f64())],
    })
}

/// Renders one picture; `on_pass` sees it after every pass.
pub fn render(
    cloth: &PreparedCloth,
    request: &StillRequest,
    job: &Job,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<Still, StillError> {
    let start = Instant::now();
    let (width, height) = (request.width, request.height);
    let mut sums = vec![[0.0f32; 4]; (width * height) as usize];
    let mut rgba = vec![0u8; sums.len() * 4];
    let limit = request.stop.spp.unwrap_or(u32::MAX);
    let mut spp = 0;
    let mut error = None;
    while spp < limit.max(1) {
        for (row, line) in sums.chunks_mut(width as usize).enumerate() {
            if spp > 0 && job.check().is_err() {
                return Err(Cancelled.into());
            }
            shade_row(cloth, request, row as u32, spp, line);
        }
        spp += 1;
        for (sum, pixel) in sums.iter().zip(rgba.chunks_exact_mut(4)) {
            for (value, byte) in sum.iter().zip(pixel) {
                *byte = (value / spp as f32).clamp(0.0, 255.0) as u8;
            }
        }
        let seconds = start.elapsed().as_secs_f64();
        let now = 0.3 / f64::from(spp).sqrt();
        error = Some(now);
        on_pass(&Pass {
            width,
            height,
            rgba: &rgba,
            spp,
            seconds,
            error,
        });
        let time_is_up = request.stop.seconds.is_some_and(|limit| seconds >= limit);
        if time_is_up || job.expired() || request.stop.error.is_some_and(|goal| now <= goal) {
            break;
        }
    }
    let render_seconds = start.elapsed().as_secs_f64();
    let mut seconds = cloth.seconds.clone();
    seconds.push(("render".to_owned(), render_seconds));
    Ok(Still {
        report: StillReport {
            renderer: "cpu".to_owned(),
            width,
            height,
            spp,
            total_seconds: seconds.iter().map(|(_, seconds)| seconds).sum(),
            seconds,
            paths_per_second: f64::from(spp) * f64::from(width) * f64::from(height)
                / render_seconds.max(1e-9),
            error,
            ..StillReport::default()
        },
        rgba,
    })
}

/// Prepares and renders in one go.
pub fn render_still(
    design: &Arc<Design>,
    request: &StillRequest,
    job: &Job,
    on_pass: &mut dyn FnMut(&Pass<'_>),
) -> Result<Still, StillError> {
    let cloth = prepare(design, request, job)?;
    render(&cloth, request, job, on_pass)
}

fn shade_row(
    cloth: &PreparedCloth,
    request: &StillRequest,
    row: u32,
    sample: u32,
    line: &mut [[f32; 4]],
) {
    let design = &cloth.design;
    let pitch = [design.sett().end_pitch_mm(), design.sett().pick_pitch_mm()];
    let width_mm = request
        .width_mm
        .unwrap_or_else(|| usual_width_mm(request.view, design));
    let scale = width_mm / request.width as f32;
    let centre = request.centre_mm.unwrap_or_default();
    let sign = if request.view.turns_over() { -1.0 } else { 1.0 };
    for (column, sum) in line.iter_mut().enumerate() {
        let mut hash = (column as u32)
            .wrapping_mul(0x9E37_79B9)
            .wrapping_add(row.wrapping_mul(0x85EB_CA6B))
            .wrapping_add(sample.wrapping_mul(0xC2B2_AE35));
        hash ^= hash >> 15;
        hash = hash.wrapping_mul(0x2C1B_3C6D);
        hash ^= hash >> 12;
        let noise = (hash & 0xffff) as f32 / 65536.0;
        let x = centre[0] + sign * (column as f32 + noise - request.width as f32 / 2.0) * scale;
        let y = centre[1] - (row as f32 + 0.5 - request.height as f32 / 2.0) * scale;
        let (u, v) = (x / pitch[0], y / pitch[1]);
        let (end, pick) = (u.floor() as i64, v.floor() as i64);
        let up = cloth.weave.get_wrapped(end, pick) != request.view.turns_over();
        let yarn = if up {
            design.maps().warp(end, pick)
        } else {
            design.maps().weft(end, pick)
        };
        let colour = design.yarn(yarn).colour;
        let across = if up { u - u.floor() } else { v - v.floor() };
        let round = (1.0 - (2.0 * across - 1.0).powi(2)).max(0.0).sqrt();
        let shade = (0.25 + 0.75 * round) * (0.7 + 0.6 * noise);
        for (value, channel) in sum.iter_mut().zip([colour.0, colour.1, colour.2]) {
            *value += f32::from(channel) * shade;
        }
        sum[3] += 255.0;
    }
}
