//! How far a picture is from done: `error` = √mean(Var/(mean²+0.01²)) over pixels, where
//! Var is the variance of the pixel's mean luminance, before denoising.

use super::film::Film;

/// Luminance below which errors count absolutely: 0.01 of a white diffuser.
pub const DARK: f64 = 0.01;

/// The error of a film with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorEstimate {
    /// √mean(Var/(mean²+0.01²)).
    pub error: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl ErrorEstimate {
    /// Nothing is known yet.
    pub const UNKNOWN: Self = Self {
        error: f64::INFINITY,
        low: 0.0,
        high: f64::INFINITY,
    };
}

/// Estimates the error of a film from its even and odd samples.
///
/// Each pixel gives two independent estimates r₀, r₁ of its relative variance, one a
/// half. Their mean estimates the error; half their difference has, over all pixels, the
/// spread of that mean, because pixels are independent too. A bright outlier raises the
/// variance and the mean of its own half together, which would bias a ratio downwards,
/// so each half's variance is set against the other half's mean.
pub fn estimate(film: &Film) -> ErrorEstimate {
    let mut sum = 0.0;
    let mut spread = 0.0;
    for pixel in film.pixels() {
        let (Some((m0, v0)), Some((m1, v1))) = (pixel.half(0), pixel.half(1)) else {
            return ErrorEstimate::UNKNOWN;
        };
        let n = f64::from(pixel.samples());
        let relative = |variance: f64, other_mean: f64, other_variance: f64| {
            // 1/(mean²+c) of a noisy mean is too small by its own variance: take it out
            // (never more than half of it).
            let noise = other_variance * 2.0 / n;
            let square = other_mean * other_mean;
            variance / n / ((square - noise).max(0.5 * square) + DARK * DARK)
        };
        let r0 = relative(v0, m1, v1);
        let r1 = relative(v1, m0, v0);
        sum += 0.5 * (r0 + r1);
        spread += 0.25 * (r0 - r1) * (r0 - r1);
    }
    let n = film.pixels().len() as f64;
    let mean = sum / n;
    let margin = 1.96 * spread.sqrt() / n;
    ErrorEstimate {
        error: mean.sqrt(),
        low: (mean - margin).max(0.0).sqrt(),
        high: (mean + margin).sqrt(),
    }
}
