//! What the tracer simulates and how closely.

use glam::Vec3;
use strum::{Display, EnumMessage, EnumString, IntoStaticStr, VariantArray};

/// What lies behind the cloth.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    Display,
    EnumString,
    EnumMessage,
    IntoStaticStr,
    VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum Backing {
    /// Nothing: the background shows through.
    #[default]
    None,
    /// A white diffuser (albedo 0.95: a sheet of good paper).
    White,
    /// A black sheet that reflects nothing.
    Black,
    /// More layers of the cloth itself.
    #[strum(serialize = "self")]
    Itself,
}

/// What a camera ray that meets nothing brings home.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Background {
    /// Nothing, with alpha 0.
    #[default]
    Transparent,
    /// The sky of the light rig, opaque.
    Sky,
    /// A linear RGB radiance, opaque.
    Colour(Vec3),
}

/// What a picture simulates, how closely, and when it is done. Some are dials (see
/// [`crate::plan`]): their crude end is fast and wrong or noisy, their reference end is what
/// everything else is measured against.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderSettings {
    /// Names the random numbers; same seed and settings, same picture bit for bit.
    pub seed: u64,
    /// Scatterings along a path after which it ends. Crude 1 (single scattering: dark and
    /// saturated), reference 1024. Undyed cotton still gains 1 % beyond order 100.
    pub max_order: u32,
    /// Whether light is blocked on its way to a scattering. Crude `false` (flat, far too
    /// bright), reference `true`. Off means no shadow ray is walked.
    pub shadows: bool,
    /// Whether the sky lights the cloth. Off means black surroundings.
    pub sky: bool,
    /// Scattering order from which paths play Russian roulette by their throughput.
    /// Unbiased; crude 1 (noisy, fast), reference `u32::MAX` (never).
    pub roulette_order: u32,
    /// Shadow rays that can add less than this radiance (white diffuser = 1) play
    /// roulette before and while they are walked. Unbiased; crude 1 (noisy), reference 0.
    pub shadow_roulette: f32,
    /// Samples per pixel in one pass; affects only how often progress is shown.
    pub pass_spp: u32,
    /// Samples per pixel after which the picture is done. Crude 1, reference 4096.
    pub spp: u32,
    /// Error (see [`crate::film::error`]) below which the picture is done; 0 = go on to `spp`.
    pub error: f32,
    /// What lies behind the cloth.
    pub backing: Backing,
    /// Layers that [`Backing::Itself`] piles up, the visible one included.
    pub backing_layers: u32,
    /// How far each of those layers is slid against the one above, mm in x and y.
    pub backing_slide_mm: [f32; 2],
    /// What shows where there is nothing.
    pub background: Background,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            seed: 0,
            max_order: 256,
            shadows: true,
            sky: true,
            roulette_order: 8,
            shadow_roulette: 0.1,
            pass_spp: 4,
            spp: 64,
            error: 0.0,
            backing: Backing::None,
            backing_layers: 4,
            backing_slide_mm: [0.37, 0.23],
            background: Background::Transparent,
        }
    }
}
