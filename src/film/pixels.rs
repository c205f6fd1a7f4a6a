//! The film: sums per pixel in 64 bits, from which means, variances and features come.
//!
//! Radiance is premultiplied by alpha. Luminance is summed in two halves (even and odd
//! samples), so that the error estimate has an error estimate of its own.

use glam::{DVec3, Vec3};

use crate::scene::environment::luminance;

/// What one path brings home.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// Radiance, linear RGB, premultiplied.
    pub radiance: Vec3,
    /// 1 where the path met anything, else 0.
    pub alpha: f32,
    /// The first scattering, if any.
    pub first: Option<FirstHit>,
}

/// The first scattering of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstHit {
    /// Single-scattering albedo.
    pub albedo: Vec3,
    /// Unit vector across the fibre that faces the viewer.
    pub normal: Vec3,
    /// Distance from the camera, mm.
    pub depth: f32,
    /// Optics id: which yarn.
    pub optics: u32,
}

/// The sums of one pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Pixel {
    radiance: [f64; 3],
    /// Luminance of even and odd samples.
    luminance: [f64; 2],
    luminance_squared: [f64; 2],
    counts: [u32; 2],
    hits: u32,
    alpha: f64,
    albedo: DVec3,
    normal: DVec3,
    depth: f64,
    /// Boyer and Moore's majority vote over the optics of first hits.
    optics: u32,
    votes: u32,
}

impl Pixel {
    /// Adds the `index`-th sample; answers whether it was finite and so taken.
    #[inline]
    pub fn add(&mut self, index: u32, sample: &Sample) -> bool {
        let colour = sample.radiance;
        if !(colour.is_finite() && sample.alpha.is_finite()) {
            return false;
        }
        for (sum, value) in self.radiance.iter_mut().zip(colour.to_array()) {
            *sum += f64::from(value);
        }
        let half = (index & 1) as usize;
        let l = f64::from(luminance(colour));
        self.luminance[half] += l;
        self.luminance_squared[half] += l * l;
        self.counts[half] += 1;
        self.alpha += f64::from(sample.alpha);
        if let Some(first) = &sample.first {
            self.hits += 1;
            self.albedo += first.albedo.as_dvec3();
            self.normal += first.normal.as_dvec3();
            self.depth += f64::from(first.depth);
            if self.votes == 0 {
                self.optics = first.optics;
            }
            if self.optics == first.optics {
                self.votes += 1;
            } else {
                self.votes -= 1;
            }
        }
        true
    }

    /// Samples taken.
    pub fn samples(&self) -> u32 {
        self.counts[0] + self.counts[1]
    }

    /// Mean radiance, premultiplied; 0 before the first sample.
    pub fn mean(&self) -> Vec3 {
        let n = f64::from(self.samples().max(1));
        Vec3::from_array(self.radiance.map(|sum| (sum / n) as f32))
    }

    /// Share of the pixel that is not background.
    pub fn alpha(&self) -> f32 {
        (self.alpha / f64::from(self.samples().max(1))) as f32
    }

    /// Mean luminance.
    pub fn luminance(&self) -> f64 {
        (self.luminance[0] + self.luminance[1]) / f64::from(self.samples().max(1))
    }

    /// Variance of the mean luminance; infinite with fewer than two samples.
    pub fn variance(&self) -> f64 {
        let sum = self.luminance[0] + self.luminance[1];
        let squares = self.luminance_squared[0] + self.luminance_squared[1];
        variance_of_mean(sum, squares, self.samples())
    }

    /// Mean luminance and variance *of one sample* in the even or odd half; `None` with
    /// fewer than two samples in it.
    pub fn half(&self, half: usize) -> Option<(f64, f64)> {
        let n = self.counts[half];
        (n >= 2).then(|| {
            let of_mean = variance_of_mean(self.luminance[half], self.luminance_squared[half], n);
            let n = f64::from(n);
            (self.luminance[half] / n, of_mean * n)
        })
    }

    /// A random error as large as that of the mean luminance: half the difference of the
    /// means of even and odd samples. `None` while one of them has none.
    pub fn noise(&self) -> Option<f32> {
        let [even, odd] = self.counts.map(f64::from);
        if even == 0.0 || odd == 0.0 {
            return None;
        }
        let half = 0.5 * (self.luminance[0] / even - self.luminance[1] / odd);
        // Halves of unequal size differ a little more than the mean wavers.
        let unequal = 2.0 * (even * odd).sqrt() / (even + odd);
        Some((half * unequal) as f32)
    }

    /// Mean albedo of the first hits; 0 where there are none.
    pub fn albedo(&self) -> Vec3 {
        (self.albedo / f64::from(self.hits.max(1))).as_vec3()
    }

    /// Mean normal of the first hits, unit length; 0 where there are none.
    pub fn normal(&self) -> Vec3 {
        self.normal.normalize_or_zero().as_vec3()
    }

    /// Mean distance of the first hits, mm; infinite where there are none.
    pub fn depth(&self) -> f32 {
        if self.hits > 0 {
            (self.depth / f64::from(self.hits)) as f32
        } else {
            f32::INFINITY
        }
    }

    /// The optics met most often first, if anything was met.
    pub fn optics(&self) -> Option<u32> {
        (self.hits > 0).then_some(self.optics)
    }
}

/// Variance of a mean from sums over `n` samples.
fn variance_of_mean(sum: f64, squares: f64, n: u32) -> f64 {
    if n < 2 {
        return f64::INFINITY;
    }
    let n = f64::from(n);
    ((squares - sum * sum / n) / (n - 1.0)).max(0.0) / n
}

/// A film of pixels, top row first.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    /// Samples per pixel asked of every pixel so far.
    spp: u32,
    pixels: Vec<Pixel>,
}

impl Film {
    /// An unexposed film.
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            spp: 0,
            pixels: vec![Pixel::default(); width as usize * height as usize],
        }
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Samples per pixel so far.
    pub fn spp(&self) -> u32 {
        self.spp
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }

    /// The pixel at column x and row y (0 = top), which must lie inside.
    pub fn pixel(&self, x: u32, y: u32) -> &Pixel {
        &self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// Mean radiance per pixel, premultiplied linear RGB.
    pub fn means(&self) -> Vec<Vec3> {
        self.pixels.iter().map(Pixel::mean).collect()
    }

    /// Mean luminance of all pixels, and its standard error.
    pub fn mean_luminance(&self) -> (f64, f64) {
        let n = self.pixels.len() as f64;
        let mean = self.pixels.iter().map(Pixel::luminance).sum::<f64>() / n;
        let variance = self.pixels.iter().map(Pixel::variance).sum::<f64>();
        (mean, variance.sqrt() / n)
    }

    /// The pixels, to be exposed by hand.
    pub fn pixels_mut(&mut self) -> &mut [Pixel] {
        &mut self.pixels
    }

    pub(crate) fn finish_pass(&mut self, spp: u32) {
        self.spp += spp;
    }
}
