//! How far a picture is from done: `error` = √mean(Var/(mean²+0.01²)) over pixels, where
//! Var is the variance of the pixel's mean luminance, before denoising.

use super::Film;

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
/// A bright sample raises the variance and the mean of its pixel together, so the plain
/// ratio is too small, by a share that falls with 1/n. The ratios of the two halves show
/// how much: twice the whole less the mean of the halves (the jackknife) is free of it.
/// Half the difference of the halves' variances, over the common mean, gives the spread;
/// pixels are independent of each other.
pub fn estimate(film: &Film) -> ErrorEstimate {
    let mut sum = 0.0;
    let mut spread = 0.0;
    for pixel in film.pixels() {
        let (Some((m0, v0)), Some((m1, v1))) = (pixel.half(0), pixel.half(1)) else {
            return ErrorEstimate::UNKNOWN;
        };
        let n = f64::from(pixel.samples());
        let relative = |variance: f64, mean: f64| variance / n / (mean * mean + DARK * DARK);
        let whole = pixel.luminance();
        let of_whole = relative(pixel.variance() * n, whole);
        sum += 2.0 * of_whole - 0.5 * (relative(v0, m0) + relative(v1, m1));
        let difference = 0.5 * relative(v0 - v1, whole);
        spread += difference * difference;
    }
    let n = film.pixels().len() as f64;
    let mean = (sum / n).max(0.0);
    let margin = 1.96 * spread.sqrt() / n;
    ErrorEstimate {
        error: mean.sqrt(),
        low: (mean - margin).max(0.0).sqrt(),
        high: (mean + margin).sqrt(),
    }
}
