//! How different two pictures look: after the blur of an eye at reading distance, in the
//! colour difference that people see (ΔE₀₀) and in structure (SSIM).
//!
//! An eye at 30 cm tells one minute of arc apart, 0.087 mm on the cloth: without that blur a
//! difference of noisy pictures is one of their noise.

use crate::design::{delta_e_00, lab};
use crate::film::tone::{decode_srgb, encode_srgb};
use crate::film::{Picture, Tone};
use crate::scene::environment::luminance;
use glam::Vec3;

/// Width at half its height of an eye's blur at 30 cm: one minute of arc, mm on the cloth.
pub const EYE_MM: f32 = 300.0 * std::f32::consts::PI / (180.0 * 60.0);
/// What lies behind where there is no cloth, when pictures are compared: mid-grey, linear.
const BEHIND: f32 = 0.184;

/// Edge of a square whose structure is compared, pixels, and the step to the next one.
const SQUARE: usize = 8;
const STRIDE: usize = 4;
/// (0.01)² and (0.03)², of white.
const C1: f64 = 1e-4;
const C2: f64 = 9e-4;

/// A picture as it is shown: linear RGB up to 1, with nothing behind it shown grey.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    /// Pixels across.
    pub width: usize,
    /// Row by row.
    pub pixels: Vec<Vec3>,
}

/// How different two pictures look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Mean ΔE₀₀ over pixels.
    pub delta_e: f64,
    /// Mean structural similarity of brightness, 1 = the same (Wang et al. 2004, eq. 13 with
    /// their constants, over squares of 8 × 8 pixels as in their §III.B).
    pub ssim: f64,
}

impl Shown {
    /// Premultiplied radiance over `alpha`, brought to display values by `tone`.
    pub fn new(width: usize, radiance: &[Vec3], alpha: &[f32], tone: Tone) -> Self {
        let pixels = (radiance.iter().zip(alpha))
            .map(|(radiance, alpha)| {
                let [r, g, b, alpha] = tone.display(*radiance, *alpha);
                let colour = Vec3::from_array([r, g, b].map(decode_srgb));
                colour * alpha + Vec3::splat(BEHIND) * (1.0 - alpha)
            })
            .collect();
        Self { width, pixels }
    }

    /// The same as an eye at 30 cm sees it.
    pub fn at_reading_distance(&self, pixels_per_mm: f32) -> Self {
        // A normal curve is 2.355 standard deviations wide at half its height.
        self.blurred(EYE_MM * pixels_per_mm / 2.355)
    }

    /// The same blurred by a normal curve of standard deviation `sigma` pixels; what lies
    /// beyond the edge is not counted.
    fn blurred(&self, sigma: f32) -> Self {
        if !(sigma > 0.2) {
            return self.clone();
        }
        let reach = (3.0 * sigma).ceil().min(64.0) as usize;
        let weights: Vec<f32> = (0..=reach)
            .map(|step| (-0.5 * (step as f32 / sigma).powi(2)).exp())
            .collect();
        let (width, height) = (self.width, self.pixels.len() / self.width.max(1));
        let pass = |from: &[Vec3], length: usize, at: &dyn Fn(usize, usize) -> usize| {
            let mut to = vec![Vec3::ZERO; from.len()];
            for line in 0..from.len() / length.max(1) {
                for x in 0..length {
                    let (first, last) = (x.saturating_sub(reach), (x + reach).min(length - 1));
                    let mut sum = (Vec3::ZERO, 0.0f32);
                    for other in first..=last {
                        let weight = weights[other.abs_diff(x)];
                        sum.0 += from[at(line, other)] * weight;
                        sum.1 += weight;
                    }
                    to[at(line, x)] = sum.0 / sum.1;
                }
            }
            to
        };
        let rows = pass(&self.pixels, width, &|line, x| line * width + x);
        let pixels = pass(&rows, height, &|line, y| y * width + line);
        Self { width, pixels }
    }

    /// How different another one of the same size looks.
    pub fn difference(&self, other: &Self) -> Difference {
        let sum: f64 = (self.pixels.iter().zip(&other.pixels))
            .map(|(one, other)| delta_e_00(lab(*one), lab(*other)))
            .sum();
        Difference {
            delta_e: sum / self.pixels.len().max(1) as f64,
            ssim: similarity(&self.brightness(), &other.brightness(), self.width),
        }
    }

    /// It as a picture.
    pub fn picture(&self) -> Picture {
        let pixels = (self.pixels.iter())
            .map(|colour| {
                let [r, g, b] = colour.to_array().map(encode_srgb);
                [r, g, b, 1.0]
            })
            .collect();
        Picture {
            width: self.width as u32,
            height: (self.pixels.len() / self.width.max(1)) as u32,
            pixels,
        }
    }

    /// Its brightness as display values, 0 to 1.
    fn brightness(&self) -> Vec<f64> {
        let light = self.pixels.iter().map(|colour| luminance(*colour));
        light.map(|light| encode_srgb(light).into()).collect()
    }
}

/// Mean structural similarity of two planes of the same size, `width` across.
fn similarity(one: &[f64], other: &[f64], width: usize) -> f64 {
    let height = one.len() / width.max(1);
    let (mut sum, mut count) = (0.0, 0u32);
    for top in (0..height).step_by(STRIDE) {
        for left in (0..width).step_by(STRIDE) {
            let rows = top..(top + SQUARE).min(height);
            let places =
                rows.flat_map(|y| (left..(left + SQUARE).min(width)).map(move |x| y * width + x));
            sum += of_square(places.map(|place| (one[place], other[place])));
            count += 1;
        }
    }
    sum / f64::from(count.max(1))
}

/// Structural similarity over one square.
fn of_square(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let [mut n, mut x, mut y, mut xx, mut yy, mut xy] = [0.0; 6];
    for (one, other) in pairs {
        n += 1.0;
        x += one;
        y += other;
        xx += one * one;
        yy += other * other;
        xy += one * other;
    }
    let [x, y] = [x / n, y / n];
    let [xx, yy, xy] = [xx / n - x * x, yy / n - y * y, xy / n - x * y];
    let light = (2.0 * x * y + C1) / (x * x + y * y + C1);
    light * (2.0 * xy + C2) / (xx + yy + C2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const WIDTH: usize = 64;

    fn stripes(contrast: f32, noise: f32, seed: u64) -> Shown {
        let pixels = (0..WIDTH * 48)
            .map(|pixel| {
                let mut random = Random::new(seed, pixel as u64, 0);
                let stripe = if ((pixel % WIDTH) / 16).is_multiple_of(2) {
                    0.5
                } else {
                    -0.5
                };
                Vec3::splat(0.4 + contrast * stripe + noise * (random.pair()[0] - 0.5))
            })
            .collect();
        Shown {
            width: WIDTH,
            pixels,
        }
    }

    #[test]
    fn the_same_looks_the_same_and_an_eye_does_not_see_fine_noise() {
        let clean = stripes(0.3, 0.0, 0);
        let same = clean.difference(&clean);
        assert!(
            same.delta_e < 1e-9 && (same.ssim - 1.0).abs() < 1e-6,
            "{same:?}"
        );
        let noisy = stripes(0.3, 0.2, 1);
        let near = clean.difference(&noisy);
        // At 40 pixels a millimetre an eye's blur is 1.5 pixels.
        let [clean_far, noisy_far] = [&clean, &noisy].map(|one| one.at_reading_distance(40.0));
        let far = clean_far.difference(&noisy_far);
        assert!(far.delta_e < 0.35 * near.delta_e, "{near:?} {far:?}");
        assert!(far.ssim > near.ssim, "{near:?} {far:?}");
        // The control: what is wrong over whole threads is seen all the same.
        let flat = stripes(0.1, 0.0, 0).at_reading_distance(40.0);
        let wrong = clean_far.difference(&flat);
        assert!(wrong.delta_e > 5.0 && wrong.ssim < 0.9, "{wrong:?}");
    }

    #[test]
    fn a_blur_keeps_the_light_and_a_known_colour_difference_is_told() {
        let one = stripes(0.3, 0.2, 3);
        let mean = |shown: &Shown| shown.pixels.iter().map(|p| p.x).sum::<f32>();
        let blurred = one.blurred(2.0);
        assert!((mean(&blurred) / mean(&one) - 1.0).abs() < 0.01);
        assert_eq!(one.blurred(0.0), one);
        assert_eq!(one.blurred(f32::NAN), one);
        // Greys: L* 50 and 60 differ by ΔE₀₀ = 10 / S_L(55) = 10 / 1.0559.
        let grey = |l: f32| Shown {
            width: 2,
            pixels: vec![Vec3::splat(((l + 16.0) / 116.0).powi(3)); 4],
        };
        let seen = grey(50.0).difference(&grey(60.0));
        assert!((seen.delta_e - 9.4706).abs() < 0.02, "{seen:?}");
    }

    #[test]
    fn similarity_is_that_of_the_paper() {
        // Flat planes: light alone.
        let [dark, pale] = [vec![0.4; 256], vec![0.6; 256]];
        let wanted = (2.0 * 0.24 + C1) / (0.16 + 0.36 + C1);
        assert!((similarity(&dark, &pale, 16) - wanted).abs() < 1e-9);
        // The same mean, the opposite structure: ±0.2 has a variance of 0.04.
        let board = |sign: f64| -> Vec<f64> {
            let square = |at: usize| {
                if (at + at / 16).is_multiple_of(2) {
                    sign
                } else {
                    -sign
                }
            };
            (0..256).map(|at| 0.5 + 0.2 * square(at)).collect()
        };
        let wanted = (C2 - 0.08) / (0.08 + C2);
        assert!((similarity(&board(1.0), &board(-1.0), 16) - wanted).abs() < 1e-9);
        assert_eq!(similarity(&[], &[], 0), 0.0);
        assert!((similarity(&board(1.0)[..9], &board(1.0)[..9], 3) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn nothing_behind_is_grey_whatever_the_exposure() {
        let tone = Tone { exposure: 3.0 };
        let shown = Shown::new(2, &[Vec3::ZERO, Vec3::splat(0.2)], &[0.0, 1.0], tone);
        assert!((shown.pixels[0].x - BEHIND).abs() < 1e-5);
        assert!(shown.pixels[1].x > 0.8 && shown.pixels[1].x <= 1.0);
    }
}
