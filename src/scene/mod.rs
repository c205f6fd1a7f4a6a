//! What is looked at from where, in which light: cameras, rays, lamps and skies.
//!
//! Space is the cloth's, in mm: x along the weft, y along the warp, z out of the face. A
//! [`View`] of cloth makes a [`Camera`], a camera the [`Ray`]s of its pixels. A [`Pose`] is the
//! one rule of which side is up and which end is at the right; `View::pose` and
//! `StillRequest::pose` give it. A [`LightRig`] is a [`Sky`] with
//! [`Sun`]s, and any [`Environment`] answers what comes from a direction and chooses directions
//! in proportion.

pub mod camera;
pub mod environment;
mod environment_image;
pub mod light;
mod pose;
mod ray;

pub use camera::{Camera, View};
pub use environment::{Dark, Dome, Environment, EnvironmentSample, luminance};
pub use environment_image::{EnvironmentError, EnvironmentImage, Replaced};
pub use light::{LightError, LightRig, PRESET_NAMES, Sky, Sun};
pub use pose::Pose;
pub use ray::{Bounds, Ray};
