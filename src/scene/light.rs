//! Light rigs: suns and a sky, with built-in presets.
//!
//! Every rig is scaled so that a white diffuser that faces up has radiance 1, that is,
//! receives an irradiance of π. White is D65 = (1, 1, 1) in linear sRGB.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};
use std::f32::consts::PI;
use std::sync::Arc;

use super::environment::{Dome, luminance};
use super::environment_image::EnvironmentImage;
use super::pose::Pose;

/// A far, small light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Unit direction towards the light.
    pub towards: Vec3,
    /// Irradiance on a plane that faces it, linear RGB.
    pub irradiance: Vec3,
    /// Angular radius in radians; 0 = a point, the real sun has 0.00465.
    pub angular_radius: f32,
}

impl Sun {
    /// A direction towards the disk of the sun.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Vec3 {
        if self.angular_radius <= 0.0 {
            return self.towards;
        }
        // Uniform on the disk in the tangent plane: right for small disks.
        let (x, y) = crate::random::disk(u);
        let (a, b) = self.towards.any_orthonormal_pair();
        let radius = self.angular_radius.min(1.5).tan();
        (self.towards + (a * x + b * y) * radius).normalize_or(self.towards)
    }
}

/// The light from around.
#[derive(Debug, Clone, PartialEq)]
pub enum Sky {
    /// None.
    Dark,
    /// A smooth dome.
    Dome(Dome),
    /// An equirectangular picture.
    Image(Arc<EnvironmentImage>),
}

/// All the light on a cloth.
#[derive(Debug, Clone, PartialEq)]
pub struct LightRig {
    /// Name of the preset or file.
    pub name: String,
    /// Far lights, reached by shadow rays.
    pub suns: Vec<Sun>,
    /// Light from around.
    pub sky: Sky,
    /// What was remarked on when its file was read, one line each.
    pub warnings: Vec<String>,
    /// How the cloth lies in it.
    pose: Pose,
}

/// Why a rig could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LightError {
    /// A name that no preset has.
    #[error("no light preset {0:?}: choose one of {names}, or give an .exr environment", names = PRESET_NAMES.join(", "))]
    Unknown(String),
    /// A preset that does not parse.
    #[error("light rig {name:?}: {reason}; compare it with a built-in preset")]
    Parse {
        /// The rig.
        name: String,
        /// What is wrong where.
        reason: String,
    },
    /// Light of no strength, or numbers out of range.
    #[error(
        "light rig {0:?} gives a face-up diffuser no finite positive light: check shares and elevations"
    )]
    NoLight(String),
}

/// The names of the built-in rigs, the default first.
pub const PRESET_NAMES: [&str; 6] = [
    "day",
    "overcast",
    "sun",
    "raking-left",
    "raking-top",
    "studio",
];

/// A rig as its RON file tells it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightSpec {
    /// What it is good for, one line.
    pub about: String,
    /// Far lights.
    pub suns: Vec<SunSpec>,
    /// The dome, if any.
    pub sky: Option<SkySpec>,
}

/// A sun as a rig's file tells it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SunSpec {
    /// Degrees from +x (right), counter-clockwise: 90 = top of the cloth, 180 = left.
    pub azimuth: f32,
    /// Degrees above the cloth, above 0.
    pub elevation: f32,
    /// Share of the light on a face-up plane; shares are scaled to add up to 1.
    pub share: f32,
    /// Colour, linear RGB, of luminance about 1.
    pub colour: [f32; 3],
    /// Angular radius in degrees.
    pub radius: f32,
}

/// A dome as a rig's file tells it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkySpec {
    /// Share of the light on a face-up plane.
    pub share: f32,
    /// Relative radiance of zenith, horizon and ground, linear RGB.
    pub zenith: [f32; 3],
    /// At the horizon.
    pub horizon: [f32; 3],
    /// Below it.
    pub ground: [f32; 3],
}

fn preset_text(name: &str) -> Option<&'static str> {
    Some(match name {
        "day" => include_str!("../../presets/lights/day.ron"),
        "overcast" => include_str!("../../presets/lights/overcast.ron"),
        "sun" => include_str!("../../presets/lights/sun.ron"),
        "raking-left" => include_str!("../../presets/lights/raking-left.ron"),
        "raking-top" => include_str!("../../presets/lights/raking-top.ron"),
        "studio" => include_str!("../../presets/lights/studio.ron"),
        _ => return None,
    })
}

impl LightRig {
    /// A built-in rig by name, see [`PRESET_NAMES`].
    pub fn preset(name: &str) -> Result<Self, LightError> {
        let text = preset_text(name).ok_or_else(|| LightError::Unknown(name.to_owned()))?;
        Self::from_ron(name, text)
    }

    /// The default rig with its sun elsewhere: `azimuth` and `elevation` in degrees, as
    /// in [`SunSpec`]; a sun below 3° stands at 3°.
    ///
    /// # Errors
    /// When the default preset is not usable.
    pub fn sun(azimuth: i16, elevation: i16) -> Result<Self, LightError> {
        let name = PRESET_NAMES[0];
        let text = preset_text(name).ok_or_else(|| LightError::Unknown(name.to_owned()))?;
        let mut spec: LightSpec = ron::from_str(text).map_err(|error| LightError::Parse {
            name: name.to_owned(),
            reason: error.to_string(),
        })?;
        for sun in &mut spec.suns {
            sun.azimuth = f32::from(azimuth);
            sun.elevation = f32::from(elevation.clamp(3, 90));
        }
        Self::from_spec("sun where it was put", &spec)
    }

    /// A rig from the text of its RON file.
    pub fn from_ron(name: &str, text: &str) -> Result<Self, LightError> {
        let spec: LightSpec = ron::from_str(text).map_err(|error| LightError::Parse {
            name: name.to_owned(),
            reason: error.to_string(),
        })?;
        Self::from_spec(name, &spec)
    }

    /// A rig from its description, scaled so that a face-up white diffuser has
    /// luminance 1.
    pub fn from_spec(name: &str, spec: &LightSpec) -> Result<Self, LightError> {
        let no_light = || LightError::NoLight(name.to_owned());
        let shares = spec.suns.iter().map(|sun| sun.share).sum::<f32>()
            + spec.sky.as_ref().map_or(0.0, |sky| sky.share);
        if !(shares > 0.0 && shares.is_finite()) {
            return Err(no_light());
        }
        let mut suns = Vec::new();
        for sun in &spec.suns {
            let (sin_e, cos_e) = sun.elevation.to_radians().sin_cos();
            let (sin_a, cos_a) = sun.azimuth.to_radians().sin_cos();
            let colour = Vec3::from_array(sun.colour);
            let strength = PI * sun.share / (shares * sin_e * luminance(colour));
            if !(strength >= 0.0 && strength.is_finite() && sin_e > 0.0) {
                return Err(no_light());
            }
            suns.push(Sun {
                towards: Vec3::new(cos_e * cos_a, cos_e * sin_a, sin_e).normalize_or(Vec3::Z),
                irradiance: colour * strength,
                angular_radius: sun.radius.to_radians().max(0.0),
            });
        }
        let sky = match &spec.sky {
            None => Sky::Dark,
            Some(sky) => {
                let dome = Dome {
                    zenith: Vec3::from_array(sky.zenith),
                    horizon: Vec3::from_array(sky.horizon),
                    ground: Vec3::from_array(sky.ground),
                };
                let k = PI * sky.share / (shares * luminance(dome.irradiance_up()));
                if !(k >= 0.0 && k.is_finite()) {
                    return Err(no_light());
                }
                Sky::Dome(dome.scaled(k))
            }
        };
        Ok(Self {
            name: name.to_owned(),
            suns,
            sky,
            warnings: Vec::new(),
            pose: Pose::FACE,
        })
    }

    /// A rig of one environment picture, scaled like every rig.
    pub fn from_image(name: &str, image: EnvironmentImage) -> Result<Self, LightError> {
        let up = image.irradiance_up();
        let k = std::f64::consts::PI / up.dot(DVec3::new(0.2126, 0.7152, 0.0722));
        if !(k > 0.0 && k.is_finite()) {
            return Err(LightError::NoLight(name.to_owned()));
        }
        let image = image.scaled(k);
        let replaced = image.replaced().to_string();
        let warnings = match replaced.is_empty() {
            true => Vec::new(),
            false => vec![format!("{name}: {replaced}")],
        };
        Ok(Self {
            name: name.to_owned(),
            suns: Vec::new(),
            sky: Sky::Image(Arc::new(image)),
            warnings,
            pose: Pose::FACE,
        })
    }

    /// A rig of given suns and sky, taken as they are.
    pub fn new(name: &str, suns: Vec<Sun>, sky: Sky) -> Self {
        Self {
            name: name.to_owned(),
            suns,
            sky,
            warnings: Vec::new(),
            pose: Pose::FACE,
        }
    }

    /// The rig for cloth that lies like this, or once more so: the light stays with the
    /// viewer, so that in cloth space it turns instead.
    pub fn on(&self, pose: Pose) -> Self {
        let mut rig = self.clone();
        rig.pose = self.pose.and(pose);
        for sun in &mut rig.suns {
            sun.towards *= pose.turn();
        }
        rig
    }

    /// What a direction in cloth space is multiplied by, axis by axis, where it is looked up
    /// in the sky, and one of the sky where it is brought into cloth space.
    pub fn sky_turn(&self) -> Vec3 {
        self.pose.turn()
    }
}
