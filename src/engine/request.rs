//! What picture is asked for, and how it came about.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::job::Job;
use crate::plan::{Budget, DialError, EffectChoice, Plan, Planned, Settings, Subject};
use crate::render::Backing;
use crate::scene::{PRESET_NAMES, Pose, View};

/// What lights the cloth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LightChoice {
    /// A rig by name, one of [`PRESET_NAMES`].
    Preset(String),
    /// An equirectangular `.exr`.
    Environment(PathBuf),
    /// A sun from a direction that the person points out, under a soft sky.
    Sun(Heading),
}

impl LightChoice {
    /// The file that it is read from, if any.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Environment(path) => Some(path),
            Self::Preset(_) | Self::Sun(_) => None,
        }
    }
}

/// A direction over the side of the cloth that is looked at, in whole degrees.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Heading {
    /// From the right of the picture counter-clockwise: 90 = top, 180 = left.
    pub azimuth: i16,
    /// Above the cloth.
    pub elevation: i16,
}

impl Heading {
    /// The direction, z out of the side that is looked at, at least a degree above it.
    pub fn towards(self) -> glam::Vec3 {
        let (sine, cosine) = f32::from(self.elevation.clamp(1, 90))
            .to_radians()
            .sin_cos();
        let (across, along) = {
            let (sine, cosine) = f32::from(self.azimuth).to_radians().sin_cos();
            (cosine, sine)
        };
        glam::Vec3::new(cosine * across, cosine * along, sine)
    }
}

impl fmt::Display for Heading {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "{},{}", self.azimuth, self.elevation)
    }
}

impl Default for LightChoice {
    fn default() -> Self {
        Self::Preset(PRESET_NAMES[0].to_owned())
    }
}

/// When to stop refining: at the first that is reached; where none is said, after the paths
/// of [`crate::render::RenderSettings::spp`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stop {
    /// Samples in every pixel.
    pub spp: Option<u32>,
    /// Seconds of the whole work, from making the cloth to denoising and writing; a picture
    /// has one sample in every pixel even where that takes longer.
    pub seconds: Option<f64>,
    /// Error, see [`crate::film::error`].
    pub error: Option<f64>,
}

impl Stop {
    /// When a budget is used up, of a picture that is wrong by `bias` whatever its paths: at its
    /// seconds, or once its noise is what is left of its error. A colour difference ends none.
    pub fn within(budget: Budget, bias: f64) -> Self {
        let noise = |error: f64| (error * error - bias * bias).max(1e-12).sqrt();
        Self {
            spp: None,
            seconds: match budget {
                Budget::Seconds(seconds) => Some(seconds),
                _ => None,
            },
            error: match budget {
                Budget::Error(error) => Some(noise(error)),
                _ => None,
            },
        }
    }

    /// A job that ends when the seconds have passed from now on, or when it did before.
    pub(super) fn bounds(&self, job: &Job) -> Job {
        let time = self
            .seconds
            .and_then(|s| Duration::try_from_secs_f64(s).ok());
        match time.and_then(|time| Instant::now().checked_add(time)) {
            Some(deadline) => job.clone().with_deadline(deadline),
            None => job.clone(),
        }
    }
}

/// A picture that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct StillRequest {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// From where.
    pub view: View,
    /// The eye's own direction instead of the view's: from there the same side is seen in
    /// perspective.
    pub eye: Option<Heading>,
    /// The cloth is turned by 180° as it lies, end 1 at the right and pick 1 at the top: a
    /// view straight on it is turned by 180°. The light stays where it is.
    pub turned: bool,
    /// Width of cloth the picture shows, mm; `None` = the view's own.
    pub width_mm: Option<f32>,
    /// The point of the cloth in the picture's middle, mm; `None` = the design's middle.
    pub centre_mm: Option<[f32; 2]>,
    /// What lights the cloth.
    pub light: LightChoice,
    /// Exposure in stops.
    pub exposure_ev: f32,
    /// What lies behind the cloth; unsaid: nothing, as where its colours were measured.
    /// Pictures that are kept show more of the cloth itself through its gaps.
    pub backing: Backing,
    /// Which effects are simulated.
    pub effects: EffectChoice,
    /// What the dials are set to.
    pub settings: Settings,
    /// Seed of every random choice.
    pub seed: u64,
    /// When to stop.
    pub stop: Stop,
    /// Which of a design's named yarn sets; `None` = the design's own yarns.
    pub colourway: Option<String>,
}

impl Default for StillRequest {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 960,
            view: View::Face,
            eye: None,
            turned: false,
            width_mm: None,
            centre_mm: None,
            light: LightChoice::default(),
            exposure_ev: 0.0,
            backing: Backing::None,
            effects: EffectChoice::default(),
            settings: Settings::default(),
            seed: 0,
            stop: Stop::default(),
            colourway: None,
        }
    }
}

impl StillRequest {
    /// How the cloth lies before the eye.
    pub fn pose(&self) -> Pose {
        self.view.pose(self.turned)
    }

    /// Whether the eye looks straight on the cloth, without perspective.
    pub fn is_straight(&self) -> bool {
        self.eye.is_none() && self.view.is_straight()
    }

    /// What each system takes for this picture of `subject`.
    ///
    /// # Errors
    /// When a setting lies outside of what its dial takes.
    pub fn plan(&self, subject: Subject) -> Result<Plan, DialError> {
        let plan = Plan::new(&self.settings, &self.effects, subject)?;
        let mut plan = plan.seeded(self.seed).before(self.backing);
        plan.render.spp = match (self.stop.spp, self.stop.seconds, self.stop.error) {
            (Some(spp), ..) => spp,
            (None, None, None) => plan.render.spp,
            _ => u32::MAX,
        };
        plan.render.error = self.stop.error.unwrap_or(0.0) as f32;
        Ok(plan)
    }
}

/// How a picture came about.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StillReport {
    /// The engine.
    pub renderer: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Samples in every pixel.
    pub spp: u32,
    /// Stages in order, without the total.
    pub seconds: Vec<(String, f64)>,
    /// All stages.
    pub total_seconds: f64,
    /// Camera paths per second of rendering.
    pub paths_per_second: f64,
    /// Error before denoising; `None` when nothing is known of it.
    pub error: Option<f64>,
    /// Its 95 % confidence interval.
    pub error_interval: Option<[f64; 2]>,
    /// Samples dropped because they were not finite.
    pub invalid_samples: u64,
    /// Lookups above their bound.
    pub majorant_violations: u64,
    /// Walks given up, which count as absorbed.
    pub capped_walks: u64,
    /// Rays that were not walked because they had no place or direction.
    pub invalid_rays: u64,
    /// Of each effect, whether it was simulated and who decided.
    pub effects: Vec<Planned>,
    /// The cloth's level; 0 of what is no cloth.
    pub level: u32,
    /// See [`crate::cloth::ClothVolume::light_error`].
    pub light_error: Option<f32>,
    /// One line each: what was replaced, cut short or not followed.
    pub warnings: Vec<String>,
}

impl StillReport {
    /// Seconds of a stage; 0 where there was none of that name.
    pub fn stage(&self, name: &str) -> f64 {
        let stage = self.seconds.iter().find(|(known, _)| known == name);
        stage.map_or(0.0, |(_, seconds)| *seconds)
    }
}
