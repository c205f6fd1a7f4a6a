//! Light from all round: nothing, a dome, or an equirectangular picture.
//!
//! A dome is smooth, so phase sampling finds it; a picture may hold a small sun, so it is
//! sampled by brightness as well and both ways are weighed against each other
//! (multiple importance sampling with the power heuristic, Veach 1997).

use glam::Vec3;
use std::f32::consts::{PI, TAU};

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

/// An equirectangular picture: row 0 is the zenith (+z), the last row the nadir, the
/// middle column is seen towards −y, see [`EnvironmentImage::direction`].
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentImage {
    width: usize,
    height: usize,
    pixels: Vec<Vec3>,
    /// Running sums of luminance·sinθ along each row, `width + 1` per row.
    rows: Vec<f32>,
    /// Running sums of the row totals, `height + 1`.
    columns: Vec<f32>,
}

/// Why a picture cannot be an environment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EnvironmentError {
    /// Pixels do not match the size.
    #[error(
        "environment of {width}x{height} has {pixels} pixels: give width times height, at least 1"
    )]
    Size {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Pixels given.
        pixels: usize,
    },
}

impl EnvironmentImage {
    /// Makes an environment of `width`×`height` linear RGB pixels, top row first. NaN,
    /// infinite and negative values become 0.
    pub fn new(width: usize, height: usize, pixels: Vec<Vec3>) -> Result<Self, EnvironmentError> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(pixels.len()) {
            return Err(EnvironmentError::Size {
                width,
                height,
                pixels: pixels.len(),
            });
        }
        let clean = |v: f32| if v.is_finite() && v > 0.0 { v } else { 0.0 };
        let pixels: Vec<Vec3> = pixels
            .into_iter()
            .map(|p| Vec3::from_array(p.to_array().map(clean)))
            .collect();
        let mut rows = Vec::with_capacity((width + 1) * height);
        let mut columns = vec![0.0];
        let mut total = 0.0f64;
        for (y, row) in pixels.chunks_exact(width).enumerate() {
            let sine = (PI * (y as f32 + 0.5) / height as f32).sin();
            let mut sum = 0.0f64;
            rows.push(0.0);
            for &pixel in row {
                sum += f64::from(luminance(pixel) * sine);
                rows.push(sum as f32);
            }
            total += sum;
            columns.push(total as f32);
        }
        Ok(Self {
            width,
            height,
            pixels,
            rows,
            columns,
        })
    }

    /// The unit direction of picture coordinates in 0..=1: v = 0 is +z, v = 1 is −z;
    /// u = 0.5 is −y (behind the lower edge of the cloth), u = 0.75 is +x.
    pub fn direction(u: f32, v: f32) -> Vec3 {
        let (sin_theta, cos_theta) = (PI * v).sin_cos();
        let (sin_phi, cos_phi) = (TAU * u).sin_cos();
        Vec3::new(-sin_theta * sin_phi, sin_theta * cos_phi, cos_theta)
    }

    /// Irradiance on a plane that faces up.
    pub fn irradiance_up(&self) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for (y, row) in self.pixels.chunks_exact(self.width).enumerate() {
            let (sine, cosine) = (PI * (y as f32 + 0.5) / self.height as f32).sin_cos();
            let solid_angle = sine * (PI / self.height as f32) * (TAU / self.width as f32);
            let mean: Vec3 = row.iter().sum();
            sum += mean * (cosine.max(0.0) * solid_angle);
        }
        sum
    }

    /// The picture with all radiances multiplied by `k`.
    pub fn scaled(mut self, k: f32) -> Self {
        self.pixels.iter_mut().for_each(|p| *p *= k);
        self.rows.iter_mut().for_each(|s| *s *= k);
        self.columns.iter_mut().for_each(|s| *s *= k);
        self
    }

    #[inline]
    fn pixel_of(&self, towards: Vec3) -> (usize, usize) {
        let v = towards.z.clamp(-1.0, 1.0).acos() / PI;
        let u = (-towards.x).atan2(towards.y) / TAU;
        let u = if u < 0.0 { u + 1.0 } else { u };
        // Casts saturate and send NaN to 0.
        let x = ((u * self.width as f32) as usize).min(self.width - 1);
        let y = ((v * self.height as f32) as usize).min(self.height - 1);
        (x, y)
    }

    fn total(&self) -> f32 {
        self.columns[self.height]
    }

    #[inline]
    fn pixel_density(&self, x: usize, y: usize, sin_theta: f32) -> f32 {
        let row = &self.rows[y * (self.width + 1)..][..self.width + 1];
        let share = (row[x + 1] - row[x]) / self.total();
        let cells = (self.width * self.height) as f32;
        share * cells / (2.0 * PI * PI * sin_theta.max(1e-6))
    }
}

/// Draws an interval of a running sum in proportion to its length, and where in it.
#[inline]
fn draw(sums: &[f32], u: f32) -> (usize, f32) {
    let n = sums.len() - 1;
    let target = u * sums[n];
    let k = sums[1..n].partition_point(|&s| s <= target);
    let length = sums[k + 1] - sums[k];
    let within = if length > 0.0 {
        ((target - sums[k]) / length).clamp(0.0, 1.0)
    } else {
        0.5
    };
    (k, within)
}

impl Environment for EnvironmentImage {
    const SAMPLED: bool = true;
    const LIT: bool = true;

    fn radiance(&self, towards: Vec3) -> Vec3 {
        if towards.is_nan() {
            return Vec3::NAN;
        }
        let (x, y) = self.pixel_of(towards);
        self.pixels[y * self.width + x]
    }

    fn sample(&self, u: [f32; 2]) -> Option<EnvironmentSample> {
        let total = self.total();
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let (y, v) = draw(&self.columns, u[1]);
        let (x, h) = draw(&self.rows[y * (self.width + 1)..][..self.width + 1], u[0]);
        let v = (y as f32 + v) / self.height as f32;
        let direction = Self::direction((x as f32 + h) / self.width as f32, v);
        let density = self.pixel_density(x, y, (PI * v).sin());
        (density > 0.0).then(|| EnvironmentSample {
            direction,
            radiance: self.pixels[y * self.width + x],
            density,
        })
    }

    fn density(&self, towards: Vec3) -> f32 {
        let total = self.total();
        if !(total > 0.0 && total.is_finite()) {
            return 0.0;
        }
        let (x, y) = self.pixel_of(towards);
        let sin_theta = (1.0 - towards.z * towards.z).max(0.0).sqrt();
        self.pixel_density(x, y, sin_theta)
    }
}
