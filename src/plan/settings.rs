//! What all dials are set to: typed, one struct a system.

use crate::cloth::ClothSettings;
use crate::formats::png::Depth;
use crate::render::RenderSettings;
use crate::synthesis::{Method, Rank, SynthesisSettings};

/// What all dials of a request are set to, by system.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Settings {
    /// Which block each crossing copies, and how seams are closed.
    pub synthesis: SynthesisDials,
    /// The voxels that are looked at.
    pub cloth: ClothDials,
    /// How paths are traced.
    pub tracing: TracingDials,
    /// How a film becomes a picture.
    pub showing: ShowingDials,
}

impl Settings {
    /// The same at another voxel level.
    pub fn at_level(mut self, level: u32) -> Self {
        self.cloth.level = level;
        self
    }
}

/// What the dials of the synthesis are set to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SynthesisDials {
    /// How blocks are chosen.
    pub method: Method,
    /// How finely seams are closed.
    pub rank: Rank,
    /// Edge of the patches that are randomised together, crossings.
    pub patch: u32,
}

impl Default for SynthesisDials {
    fn default() -> Self {
        let usual = SynthesisSettings::default();
        Self {
            method: usual.method,
            rank: usual.rank,
            patch: usual.patch,
        }
    }
}

impl SynthesisDials {
    pub(super) fn apply(self, settings: &mut SynthesisSettings) {
        settings.method = self.method;
        settings.rank = self.rank;
        settings.patch = self.patch;
    }
}

/// What the dials of the cloth are set to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClothDials {
    /// Voxel level; each further one halves the resolution.
    pub level: u32,
    /// Whether levels above 0 are corrected for what averaging does to light.
    pub correct_levels: bool,
}

impl Default for ClothDials {
    fn default() -> Self {
        let usual = ClothSettings::default();
        Self {
            level: usual.level,
            correct_levels: usual.correct_levels,
        }
    }
}

impl ClothDials {
    pub(super) fn apply(self, settings: &mut ClothSettings) {
        settings.level = self.level;
        settings.correct_levels = self.correct_levels;
    }
}

/// What the dials of the tracer are set to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TracingDials {
    /// Scatterings after which a path ends.
    pub max_order: u32,
    /// Scattering order from which paths play Russian roulette.
    pub roulette_order: u32,
    /// Radiance below which shadow rays play roulette.
    pub shadow_roulette: f32,
    /// Samples a pixel in one pass.
    pub pass_spp: u32,
    /// Layers of the cloth where it lies on itself.
    pub backing_layers: u32,
}

impl Default for TracingDials {
    fn default() -> Self {
        let usual = RenderSettings::default();
        Self {
            max_order: usual.max_order,
            roulette_order: usual.roulette_order,
            shadow_roulette: usual.shadow_roulette,
            pass_spp: usual.pass_spp,
            backing_layers: usual.backing_layers,
        }
    }
}

impl TracingDials {
    pub(super) fn apply(self, settings: &mut RenderSettings) {
        settings.max_order = self.max_order;
        settings.roulette_order = self.roulette_order;
        settings.shadow_roulette = self.shadow_roulette;
        settings.pass_spp = self.pass_spp;
        settings.backing_layers = self.backing_layers;
    }
}

/// What the dials of showing are set to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShowingDials {
    /// Whether the picture is denoised for showing.
    pub denoise: bool,
    /// Bits of a sample of a PNG.
    pub png_depth: Depth,
}

impl Default for ShowingDials {
    fn default() -> Self {
        Self {
            denoise: true,
            png_depth: Depth::Eight,
        }
    }
}
