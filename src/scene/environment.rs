//! Light from all round: nothing, a dome, or an equirectangular picture (`environment_image`).
//!
//! A dome is smooth, so phase sampling finds it; a picture may hold a small sun, so it is
//! sampled by brightness as well and both ways are weighed against each other
//! (multiple importance sampling with the power heuristic, Veach 1997).

use glam::Vec3;
use std::f32::consts::PI;

/// The Rec. 709 luminance of linear RGB.
#[inline]
pub fn luminance(colour: Vec3) -> f32 {
    colour.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// A direction drawn towards the light of an [`Environment`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvironmentSample {
    /// Unit direction towards the light.
    pub direction: Vec3,
    /// Radiance that comes from there.
    pub radiance: Vec3,
    /// Density of the direction, 1/sr, above 0.
    pub density: f32,
}

/// Radiance from infinitely far away.
pub trait Environment: Sync {
    /// Whether scatterings should draw directions from the environment.
    const SAMPLED: bool;
    /// Whether there is any light at all.
    const LIT: bool;

    /// Radiance that arrives from the unit direction `towards`.
    fn radiance(&self, towards: Vec3) -> Vec3;

    /// Draws a direction; only asked where [`Environment::SAMPLED`].
    fn sample(&self, u: [f32; 2]) -> Option<EnvironmentSample>;

    /// Density, 1/sr, with which [`Environment::sample`] draws `towards`.
    fn density(&self, towards: Vec3) -> f32;
}

/// No light from around.
#[derive(Debug, Clone, Copy, Default)]
pub struct Dark;

impl Environment for Dark {
    const SAMPLED: bool = false;
    const LIT: bool = false;

    #[inline]
    fn radiance(&self, _: Vec3) -> Vec3 {
        Vec3::ZERO
    }

    fn sample(&self, _: [f32; 2]) -> Option<EnvironmentSample> {
        None
    }

    fn density(&self, _: Vec3) -> f32 {
        0.0
    }
}

/// A smooth sky over the z axis: from the horizon's radiance to the zenith's with the
/// cosine of the zenith angle, and a constant below the horizon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dome {
    /// Radiance straight up.
    pub zenith: Vec3,
    /// Radiance at the horizon.
    pub horizon: Vec3,
    /// Radiance from everywhere below.
    pub ground: Vec3,
}

impl Dome {
    /// The same radiance from everywhere.
    pub fn uniform(radiance: Vec3) -> Self {
        Self {
            zenith: radiance,
            horizon: radiance,
            ground: radiance,
        }
    }

    /// Irradiance on a plane that faces up: π(horizon + 2 zenith)/3.
    pub fn irradiance_up(&self) -> Vec3 {
        (self.horizon + self.zenith * 2.0) * (PI / 3.0)
    }

    /// The dome with all radiances multiplied by `k`.
    pub fn scaled(&self, k: f32) -> Self {
        Self {
            zenith: self.zenith * k,
            horizon: self.horizon * k,
            ground: self.ground * k,
        }
    }
}

impl Environment for Dome {
    const SAMPLED: bool = false;
    const LIT: bool = true;

    #[inline]
    fn radiance(&self, towards: Vec3) -> Vec3 {
        if towards.z >= 0.0 {
            self.horizon + (self.zenith - self.horizon) * towards.z
        } else {
            // Also where z is NaN, which is kept so that the sample is counted.
            self.ground + Vec3::splat(towards.z * 0.0)
        }
    }

    fn sample(&self, _: [f32; 2]) -> Option<EnvironmentSample> {
        None
    }

    fn density(&self, _: Vec3) -> f32 {
        0.0
    }
}
