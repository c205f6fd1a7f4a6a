//! Light from an equirectangular picture, drawn by its brightness.
//!
//! Solid angles and irradiances of rows are integrals in closed form, so that a picture of
//! two rows lights like one of two thousand.

use glam::{DVec3, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;

use super::environment::{Environment, EnvironmentSample};

/// What infinite pixels count as where no pixel is brighter: the largest half number, at
/// which most pictures overflow.
const LARGEST_HALF: f32 = 65_504.0;

/// The largest radiance there is: its square is still a number, and so is that of a path.
const MOST: f64 = 1e18;

/// An equirectangular picture: row 0 is the zenith (+z), the last row the nadir, the
/// middle column is seen towards −y and the column at a quarter towards +x, as from inside
/// (OpenEXR's latitude-longitude rule); see [`EnvironmentImage::direction`].
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentImage {
    width: usize,
    height: usize,
    pixels: Vec<Vec3>,
    /// Running sums of a pixel's share of the light along each row, `width + 1` per row; all
    /// rows together add up to about 1.
    rows: Vec<f32>,
    /// Running sums of the rows' shares, `height + 1`.
    columns: Vec<f32>,
    replaced: Replaced,
}

/// Pixels whose values are none that light can have, and what they were taken as.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Replaced {
    /// Pixels with +∞, taken as [`Replaced::most`].
    pub infinite: u64,
    /// The largest finite value of the picture, or the largest half number if that is more.
    pub most: f32,
    /// Pixels with a NaN, taken as 0.
    pub not_a_number: u64,
    /// Pixels with a value below 0, taken as 0.
    pub negative: u64,
    /// Pixels more than 10¹⁸ times as bright as white, taken as that.
    pub dazzling: u64,
}

impl fmt::Display for Replaced {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pixels = |count: u64| match count {
            1 => "1 pixel is".to_owned(),
            more => format!("{more} pixels are"),
        };
        let kinds = [
            (
                self.infinite,
                format!("infinite and taken as {}", self.most),
            ),
            (
                self.not_a_number,
                "no number (NaN) and taken as 0".to_owned(),
            ),
            (self.negative, "negative and taken as 0".to_owned()),
            (
                self.dazzling,
                format!("above {MOST:e} times white and taken as that"),
            ),
        ];
        let said: Vec<String> = kinds
            .iter()
            .filter(|kind| kind.0 > 0)
            .map(|(count, what)| format!("{} {what}", pixels(*count)))
            .collect();
        out.write_str(&said.join(", "))
    }
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
    /// Makes an environment of `width`×`height` linear RGB pixels, top row first. Values
    /// that light cannot have are replaced and counted, see [`EnvironmentImage::replaced`].
    pub fn new(
        width: usize,
        height: usize,
        mut pixels: Vec<Vec3>,
    ) -> Result<Self, EnvironmentError> {
        if width == 0 || height == 0 || width.checked_mul(height) != Some(pixels.len()) {
            return Err(EnvironmentError::Size {
                width,
                height,
                pixels: pixels.len(),
            });
        }
        let replaced = clean(&mut pixels);
        let (rows, columns) = shares(width, height, &pixels);
        Ok(Self {
            width,
            height,
            pixels,
            rows,
            columns,
            replaced,
        })
    }

    /// Bytes that a picture of so many pixels takes.
    pub fn bytes(pixels: u64) -> u64 {
        pixels.saturating_mul((size_of::<Vec3>() + size_of::<f32>()) as u64)
    }

    /// What was replaced in its pixels.
    pub fn replaced(&self) -> Replaced {
        self.replaced
    }

    /// The unit direction of picture coordinates in 0..=1: v = 0 is +z, v = 1 is −z;
    /// u = 0.5 is −y (behind the lower edge of the cloth), u = 0.25 is +x.
    pub fn direction(u: f32, v: f32) -> Vec3 {
        let (sin_theta, cos_theta) = (PI as f32 * v).sin_cos();
        let (sin_phi, cos_phi) = (TAU as f32 * u).sin_cos();
        Vec3::new(sin_theta * sin_phi, sin_theta * cos_phi, cos_theta)
    }

    /// Irradiance on a plane that faces up: the integral of the cosine over each row above
    /// the horizon, (sin²θ₁ − sin²θ₀)/2 a radian of azimuth.
    pub fn irradiance_up(&self) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for (y, row) in self.pixels.chunks_exact(self.width).enumerate() {
            let [above, below] = [y, y + 1].map(|edge| {
                let theta = (PI * edge as f64 / self.height as f64).min(FRAC_PI_2);
                theta.sin().powi(2)
            });
            let light: DVec3 = row.iter().map(|pixel| pixel.as_dvec3()).sum();
            sum += light * (0.5 * (below - above));
        }
        sum * (TAU / self.width as f64)
    }

    /// The picture with all radiances multiplied by `k`.
    pub fn scaled(mut self, k: f64) -> Self {
        let mut dazzling = 0;
        for pixel in &mut self.pixels {
            let scaled = pixel.as_dvec3() * k;
            dazzling += u64::from(scaled.max_element() > MOST);
            *pixel = scaled.min(DVec3::splat(MOST)).as_vec3();
        }
        if dazzling > 0 {
            self.replaced.dazzling = dazzling;
            (self.rows, self.columns) = shares(self.width, self.height, &self.pixels);
        }
        self
    }

    #[inline]
    fn pixel_of(&self, towards: Vec3) -> (usize, usize) {
        const PI: f32 = std::f32::consts::PI;
        // Near the poles an arc cosine would lose half of its digits.
        let v = towards.x.hypot(towards.y).atan2(towards.z) / PI;
        let u = towards.x.atan2(towards.y) / (2.0 * PI);
        let u = if u < 0.0 { u + 1.0 } else { u };
        // Casts saturate and send NaN to 0.
        let x = ((u * self.width as f32) as usize).min(self.width - 1);
        let y = ((v * self.height as f32) as usize).min(self.height - 1);
        (x, y)
    }

    fn total(&self) -> f32 {
        self.columns[self.height]
    }

    /// Density, 1/sr, within a pixel: the same everywhere in it.
    #[inline]
    fn pixel_density(&self, x: usize, y: usize) -> f32 {
        let row = &self.rows[y * (self.width + 1)..][..self.width + 1];
        let share = (row[x + 1] - row[x]) / self.total();
        let solid_angle = band(y, self.height) * TAU / self.width as f64;
        (f64::from(share) / solid_angle) as f32
    }
}

/// Solid angle of row `y` of `height` a radian of azimuth: cos θ₀ − cos θ₁, as a product that
/// keeps its digits at the poles.
#[inline]
fn band(y: usize, height: usize) -> f64 {
    let step = PI / height as f64;
    2.0 * (0.5 * step).sin() * ((y as f64 + 0.5) * step).sin()
}

/// Replaces what no light has, and counts the pixels.
fn clean(pixels: &mut [Vec3]) -> Replaced {
    let finite = |v: &f32| v.is_finite();
    let values = pixels.iter().flat_map(|pixel| pixel.to_array());
    let most = values.filter(finite).fold(LARGEST_HALF, f32::max);
    let mut replaced = Replaced {
        most,
        ..Replaced::default()
    };
    for pixel in pixels {
        let values = pixel.to_array();
        replaced.infinite += u64::from(values.contains(&f32::INFINITY));
        replaced.not_a_number += u64::from(pixel.is_nan());
        replaced.negative += u64::from(values.iter().any(|&v| v < 0.0));
        *pixel = Vec3::from_array(values.map(|v| match v {
            f32::INFINITY => most,
            v if v > 0.0 => v,
            _ => 0.0,
        }));
    }
    replaced
}

/// Running sums of each pixel's share of the whole light along the rows, and of the rows.
fn shares(width: usize, height: usize, pixels: &[Vec3]) -> (Vec<f32>, Vec<f32>) {
    let light = |pixel: &Vec3| pixel.as_dvec3().dot(DVec3::new(0.2126, 0.7152, 0.0722));
    let of_row = |y: usize, row: &[Vec3]| row.iter().map(light).sum::<f64>() * band(y, height);
    let all: f64 = pixels
        .chunks_exact(width)
        .enumerate()
        .map(|(y, row)| of_row(y, row))
        .sum();
    let scale = if all > 0.0 { 1.0 / all } else { 0.0 };
    let mut rows = Vec::with_capacity((width + 1) * height);
    let mut columns = Vec::with_capacity(height + 1);
    columns.push(0.0);
    let mut total = 0.0f64;
    for (y, row) in pixels.chunks_exact(width).enumerate() {
        let band = band(y, height) * scale;
        let mut sum = 0.0f64;
        rows.push(0.0);
        for pixel in row {
            sum += light(pixel) * band;
            rows.push(sum as f32);
        }
        total += sum;
        columns.push(total as f32);
    }
    (rows, columns)
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
        // Uniform over the pixel's solid angle: sin²(θ/2) is linear in the share of the band.
        let [above, below] = [y, y + 1].map(|edge| {
            let half = 0.5 * PI * edge as f64 / self.height as f64;
            half.sin().powi(2)
        });
        let half = above + (below - above) * f64::from(v);
        let (cosine, sine) = (
            1.0 - 2.0 * half,
            2.0 * (half * (1.0 - half)).max(0.0).sqrt(),
        );
        let (sin_phi, cos_phi) = (TAU * (x as f64 + f64::from(h)) / self.width as f64).sin_cos();
        let direction = DVec3::new(sine * sin_phi, sine * cos_phi, cosine).as_vec3();
        let density = self.pixel_density(x, y);
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
        self.pixel_density(x, y)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn flat(rows: usize, value: f32) -> EnvironmentImage {
        EnvironmentImage::new(3, rows, vec![Vec3::splat(value); 3 * rows]).unwrap()
    }

    #[test]
    fn a_quarter_of_the_picture_is_plus_x_and_the_middle_minus_y() {
        for (u, towards) in [
            (0.25, Vec3::X),
            (0.5, Vec3::NEG_Y),
            (0.75, Vec3::NEG_X),
            (0.0, Vec3::Y),
        ] {
            let found = EnvironmentImage::direction(u, 0.5);
            assert!((found - towards).length() < 1e-6, "{u}: {found}");
        }
        let mut pixels = vec![Vec3::ZERO; 8 * 4];
        pixels[8 + 2] = Vec3::ONE;
        let picture = EnvironmentImage::new(8, 4, pixels).unwrap();
        let towards = EnvironmentImage::direction(2.5 / 8.0, 1.5 / 4.0);
        assert_eq!(picture.radiance(towards), Vec3::ONE);
        assert!(towards.x > 0.0 && towards.y < 0.0 && towards.z > 0.0);
        let mirrored = towards * Vec3::new(-1.0, 1.0, 1.0);
        assert_eq!(picture.radiance(mirrored), Vec3::ZERO);
        let drawn = picture.sample([0.5, 0.5]).unwrap();
        assert_eq!(drawn.radiance, Vec3::ONE);
        assert_eq!(picture.radiance(drawn.direction), Vec3::ONE);
    }

    /// The irradiance of radiance 1 is π, whatever the rows.
    #[test]
    fn constant_light_is_the_same_for_any_number_of_rows() {
        for rows in [1, 2, 3, 4, 5, 16, 37, 512, 2048] {
            let found = flat(rows, 1.0).irradiance_up() / PI;
            assert!(
                (found - DVec3::ONE).abs().max_element() < 1e-9,
                "{rows}: {found}"
            );
        }
        // Negative control: the midpoint rule of two rows is a third off.
        let midpoint = (FRAC_PI_2 / 2.0).sin_cos();
        let two = midpoint.0 * midpoint.1 * FRAC_PI_2 * TAU / PI;
        assert!((two - 1.0).abs() > 0.3);
    }

    #[test]
    fn directions_are_drawn_with_the_density_that_is_told() {
        let light = |k: usize| Vec3::splat([0.0, 1.0, 7.0, 0.1, 3.0][k % 5]);
        let picture = EnvironmentImage::new(4, 5, (0..20).map(light).collect()).unwrap();
        let n = 256;
        // ∫ p dω = 1 over the sphere, and E[1/p] over lit pixels is their solid angle.
        let mut inverse = 0.0f64;
        for k in 0..n * n {
            let u = [(k % n) as f32 + 0.5, (k / n) as f32 + 0.5].map(|v| v / n as f32);
            let drawn = picture.sample(u).unwrap();
            assert!((drawn.direction.length() - 1.0).abs() < 1e-6);
            let told = picture.density(drawn.direction);
            assert!(
                (told / drawn.density - 1.0).abs() < 1e-4,
                "{told} {}",
                drawn.density
            );
            inverse += f64::from(1.0 / drawn.density) / (n * n) as f64;
        }
        let lit: f64 = (0..20)
            .filter(|&k| light(k).x > 0.0)
            .map(|k| band(k / 4, 5) * TAU / 4.0)
            .sum();
        assert!((inverse / lit - 1.0).abs() < 0.01, "{inverse} {lit}");
        let sphere: f64 = (0..5).map(|y| band(y, 5) * TAU).sum();
        assert!((sphere / (4.0 * PI) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn values_that_no_light_has_are_replaced_and_counted() {
        let (inf, nan) = (f32::INFINITY, f32::NAN);
        let pixels = vec![
            Vec3::new(inf, 1.0, inf),
            Vec3::new(nan, 2.0, -1.0),
            Vec3::new(-inf, 0.0, 0.5),
            Vec3::splat(3.0),
        ];
        let picture = EnvironmentImage::new(2, 2, pixels).unwrap();
        assert_eq!(picture.pixels[0], Vec3::new(65_504.0, 1.0, 65_504.0));
        assert_eq!(picture.pixels[1], Vec3::new(0.0, 2.0, 0.0));
        assert_eq!(picture.pixels[2], Vec3::new(0.0, 0.0, 0.5));
        let replaced = picture.replaced();
        assert_eq!(
            replaced.to_string(),
            "1 pixel is infinite and taken as 65504, 1 pixel is no number (NaN) and taken as 0, \
             2 pixels are negative and taken as 0"
        );
        // A brighter picture's own brightest pixel counts.
        let bright = EnvironmentImage::new(2, 1, vec![Vec3::splat(1e6), Vec3::splat(inf)]);
        assert_eq!(bright.unwrap().pixels[1], Vec3::splat(1e6));
        assert_eq!(flat(2, 1.0).replaced().to_string(), "");
    }

    #[test]
    fn extreme_finite_values_give_finite_light() {
        for [above, below] in [
            [1e-20, 1e30],
            [f32::MAX, f32::MAX],
            [1e-45, f32::MAX],
            [f32::MAX, 1e-45],
            [1e-45, 1e-45],
        ] {
            let pixels = [above, above, below, below].map(Vec3::splat).to_vec();
            let rig = crate::scene::LightRig::from_image(
                "x",
                EnvironmentImage::new(2, 2, pixels).unwrap(),
            );
            let crate::scene::Sky::Image(picture) = rig.unwrap().sky else {
                panic!("a picture")
            };
            let up = picture.radiance(Vec3::Z);
            assert!((up - Vec3::ONE).abs().max_element() < 1e-5, "{above}: {up}");
            assert!(picture.radiance(Vec3::NEG_Z).is_finite());
            let drawn = picture.sample([0.5, 0.9]).unwrap();
            let brought = drawn.radiance / drawn.density;
            assert!(brought.is_finite() && (drawn.density * drawn.density).is_finite());
        }
    }
}
