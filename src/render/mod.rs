//! Path tracing of participating media made of fibres (Zhao 2012 §6, after Jakob 2010
//! and Heitz 2015).
//!
//! A [`Medium`] answers two questions: what is at a point, and how much can be on a
//! stretch of a ray. [`track`] makes free flights and shadows of that for anything that
//! is a [`Scatterer`]; [`path`] strings flights to paths with [`sggx`] scattering under a
//! [`LightRig`]; [`still::render`] sums paths seen by a [`Camera`] on a [`Film`], pass by
//! pass, with the [`error`] reached; [`tone`] and [`mod@denoise`] make a picture of it.

pub mod camera;
pub mod counters;
pub mod denoise;
pub mod effects;
pub mod environment;
mod environment_image;
pub mod error;
pub mod film;
pub mod light;
mod medium;
pub mod orders;
pub mod path;
pub mod random;
pub mod settings;
pub mod sggx;
pub mod stack;
pub mod still;
pub mod tone;
pub mod track;

pub use camera::{Camera, View};
pub use counters::Counters;
pub use denoise::Denoise;
pub use environment::{Dark, Dome, Environment, luminance};
pub use environment_image::{EnvironmentError, EnvironmentImage, Replaced};
pub use error::{ErrorEstimate, estimate};
pub use film::{Film, FirstHit, Pixel, Sample};
pub use light::{LightError, LightRig, PRESET_NAMES, Sky, Sun};
pub use medium::{Arrival, Bounds, MajorantWalk, Medium, PLACE, Ray, SYSTEM, Stretch, Voxel};
pub use orders::{OrderHistogram, order_histogram};
pub use random::Random;
pub use settings::{Background, Backing, RenderSettings};
pub use sggx::Fibre;
pub use stack::Stack;
pub use still::{Progress, RenderOutcome, render};
pub use tone::Tone;
pub use track::{Both, Collision, Nothing, SECOND, Scatterer};
