//! What all dials are set to: typed, by system.

use crate::cloth::ClothSettings;
use crate::formats::png::Depth;
use crate::render::RenderSettings;

/// What all dials of a request are set to: the systems' own settings. What is no dial in them
/// is said by a [`Plan`](super::Plan): which effects there are, seeds, what lies behind.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    /// Which block each crossing copies, how seams are closed, and the voxels looked at.
    pub cloth: ClothSettings,
    /// How paths are traced.
    pub render: RenderSettings,
    /// How a film becomes a picture.
    pub showing: ShowingSettings,
}

impl Settings {
    /// The same at another voxel level.
    pub fn at_level(mut self, level: u32) -> Self {
        self.cloth.level = level;
        self
    }
}

/// How a film becomes a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShowingSettings {
    /// Whether the picture is denoised for showing.
    pub denoise: bool,
    /// Bits of a sample of a PNG.
    pub png_depth: Depth,
}

impl Default for ShowingSettings {
    fn default() -> Self {
        Self {
            denoise: true,
            png_depth: Depth::Eight,
        }
    }
}
