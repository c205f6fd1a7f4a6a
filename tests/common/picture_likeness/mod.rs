//! How alike two pictures look: at a quarter of the size, by structure and by colour.
#![allow(dead_code, reason = "not every test uses all of it")]

use glam::Vec3;
use pickglass::design::{Srgb, delta_e_00, lab};
use pickglass::film::tone::{decode_srgb, encode_srgb};

/// A picture in linear light over the mid grey that surrounds cloth.
pub struct Looked {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<Vec3>,
}

impl Looked {
    /// From sRGB bytes with straight alpha, each side `shrink` times smaller.
    pub fn at(width: u32, height: u32, rgba: &[u8], shrink: usize) -> Self {
        let (width, height) = (width as usize, height as usize);
        let grey = Vec3::splat(decode_srgb(119.0 / 255.0));
        let pixel = |x: usize, y: usize| {
            let at = &rgba[(y * width + x) * 4..][..4];
            let colour = Srgb(at[0], at[1], at[2]).to_linear();
            grey.lerp(colour, f32::from(at[3]) / 255.0)
        };
        let (small_width, small_height) = (width / shrink, height / shrink);
        let mean = |x: usize, y: usize| {
            let sum: Vec3 = (0..shrink * shrink)
                .map(|k| pixel(x * shrink + k % shrink, y * shrink + k / shrink))
                .sum();
            sum / (shrink * shrink) as f32
        };
        Self {
            width: small_width,
            height: small_height,
            pixels: (0..small_width * small_height)
                .map(|k| mean(k % small_width, k / small_width))
                .collect(),
        }
    }

    fn lightness(&self) -> Vec<f64> {
        let luma = Vec3::new(0.2126, 0.7152, 0.0722);
        (self.pixels.iter())
            .map(|pixel| f64::from(encode_srgb(pixel.dot(luma))) * 255.0)
            .collect()
    }
}

/// Mean structural similarity of the lightness (Wang 2004), windows of 7×7.
pub fn ssim(a: &Looked, b: &Looked) -> f64 {
    const SIDE: usize = 7;
    let (c1, c2) = ((0.01f64 * 255.0).powi(2), (0.03f64 * 255.0).powi(2));
    let (x, y) = (a.lightness(), b.lightness());
    let mut sum = 0.0;
    let mut count = 0.0;
    for top in 0..=a.height - SIDE {
        for left in 0..=a.width - SIDE {
            let n = (SIDE * SIDE) as f64;
            let (mut sx, mut sy, mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for k in 0..SIDE * SIDE {
                let at = (top + k / SIDE) * a.width + left + k % SIDE;
                let (p, q) = (x[at], y[at]);
                (sx, sy) = (sx + p, sy + q);
                (xx, yy, xy) = (xx + p * p, yy + q * q, xy + p * q);
            }
            let (mx, my) = (sx / n, sy / n);
            let unbiased = n / (n - 1.0);
            let (vx, vy) = ((xx / n - mx * mx) * unbiased, (yy / n - my * my) * unbiased);
            let cov = (xy / n - mx * my) * unbiased;
            sum += (2.0 * mx * my + c1) * (2.0 * cov + c2)
                / ((mx * mx + my * my + c1) * (vx + vy + c2));
            count += 1.0;
        }
    }
    sum / count
}

/// Mean ΔE₀₀ over the pixels.
pub fn mean_delta_e(a: &Looked, b: &Looked) -> f64 {
    let sum: f64 = (a.pixels.iter().zip(&b.pixels))
        .map(|(&a, &b)| delta_e_00(lab(a), lab(b)))
        .sum();
    sum / a.pixels.len() as f64
}
