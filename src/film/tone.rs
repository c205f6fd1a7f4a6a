//! From linear radiance to display values: exposure, tone curve, sRGB encoding.

use glam::Vec3;
use rayon::prelude::*;

use super::Film;
use crate::film::Picture;

/// Share of a white diffuser up to which the curve changes nothing.
pub const IDENTITY_UP_TO: f32 = 0.9;

/// Exposure and curve of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tone {
    /// Exposure in stops: radiance is multiplied by 2^EV.
    pub exposure: f32,
}

/// The tone curve: the identity up to 0.9 of a white diffuser, then a shoulder that
/// joins smoothly, rises always and approaches 1. NaN and negative values give 0.
#[inline]
pub fn curve(x: f32) -> f32 {
    if x <= IDENTITY_UP_TO {
        x.max(0.0)
    } else if x > IDENTITY_UP_TO {
        let room = 1.0 - IDENTITY_UP_TO;
        1.0 - room * (-(x - IDENTITY_UP_TO) / room).exp()
    } else {
        0.0
    }
}

/// What the [`curve`] makes `y` of; `y` at or above 1 gives what it makes 0.999 of.
#[inline]
pub fn uncurve(y: f32) -> f32 {
    if y <= IDENTITY_UP_TO {
        return y.max(0.0);
    }
    let room = 1.0 - IDENTITY_UP_TO;
    IDENTITY_UP_TO - room * ((1.0 - y.min(0.999)) / room).ln()
}

/// The sRGB transfer function of a linear value in 0..=1 (IEC 61966-2-1).
#[inline]
pub fn encode_srgb(linear: f32) -> f32 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 {
        linear * 12.92
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// The linear value of an sRGB-encoded one in 0..=1.
#[inline]
pub fn decode_srgb(encoded: f32) -> f32 {
    let encoded = encoded.clamp(0.0, 1.0);
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

impl Tone {
    /// The picture of a film.
    pub fn picture(&self, film: &Film) -> Picture {
        self.picture_of(film, &film.means())
    }

    /// The picture of other radiances (denoised ones) over a film's alpha; one value per
    /// pixel of the film.
    pub fn picture_of(&self, film: &Film, radiance: &[Vec3]) -> Picture {
        let pixels = film
            .pixels()
            .par_iter()
            .zip(radiance)
            .map(|(pixel, &radiance)| self.display(radiance, pixel.alpha()))
            .collect();
        Picture {
            width: film.width(),
            height: film.height(),
            pixels,
        }
    }

    /// Display values (sRGB-encoded, 0..=1) and alpha of premultiplied radiance. The
    /// colour is that of the covered part of the pixel.
    #[inline]
    pub fn display(&self, radiance: Vec3, alpha: f32) -> [f32; 4] {
        let alpha = if alpha > 0.0 { alpha.min(1.0) } else { 0.0 };
        let scale = if alpha > 0.0 {
            self.exposure.exp2() / alpha
        } else {
            0.0
        };
        let [r, g, b] = (radiance * scale).to_array().map(|v| encode_srgb(curve(v)));
        [r, g, b, alpha]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curve_is_the_identity_below_and_smooth_and_monotone_above() {
        for k in 0..=900 {
            let x = k as f32 / 1000.0;
            assert_eq!(curve(x), x);
        }
        let mut last = curve(0.9);
        for k in 1..4000 {
            let x = 0.9 + k as f32 * 1e-3;
            let y = curve(x);
            assert!(y >= last && y <= 1.0, "at {x}");
            last = y;
        }
        let slope = (curve(0.9 + 1e-3) - curve(0.9)) / 1e-3;
        assert!((slope - 1.0).abs() < 0.02, "slope behind the joint {slope}");
    }

    #[test]
    fn the_curve_is_taken_back() {
        for k in 0..=999 {
            let y = k as f32 / 1000.0;
            assert!((curve(uncurve(y)) - y).abs() < 1e-5, "at {y}");
        }
        assert!(uncurve(1.0).is_finite() && uncurve(-1.0) == 0.0);
    }

    #[test]
    fn poison_gives_black_or_white() {
        assert_eq!(curve(f32::NAN), 0.0);
        assert_eq!(curve(f32::INFINITY), 1.0);
        assert_eq!(curve(f32::NEG_INFINITY), 0.0);
        let tone = Tone { exposure: 0.0 };
        assert_eq!(tone.display(Vec3::ONE, 0.0), [0.0; 4]);
        for value in tone.display(Vec3::new(f32::NAN, f32::INFINITY, -1.0), f32::NAN) {
            assert!((0.0..=1.0).contains(&value));
        }
    }

    #[test]
    fn srgb_round_trip() {
        for k in 0..=255 {
            let x = k as f32 / 255.0;
            assert!((encode_srgb(decode_srgb(x)) - x).abs() < 2e-6);
        }
    }
}
