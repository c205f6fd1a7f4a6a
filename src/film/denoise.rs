//! A denoiser for previews: non-local means guided by features (after Rousselle 2012 and
//! 2013). It never touches what EXR files get.
//!
//! A pixel becomes the weighted mean of its neighbours. A neighbour counts as far as the
//! 3×3 patches of the two differ by no more than their noise, and as far as albedo,
//! normal, depth and yarn agree. Lone bright pixels are first brought down to the
//! brightest of their neighbours, so that none spreads.

use glam::Vec3;
use rayon::prelude::*;

use super::{Film, Pixel};
use crate::job::{Cancelled, Job};
use crate::scene::environment::luminance;

/// How strongly to denoise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Denoise {
    /// Pixels to each side that are looked at. Crude 1, reference 7; time grows with its
    /// square.
    pub radius: u32,
    /// How many standard deviations patches may differ. 0 = no denoising, 1 = strong.
    pub strength: f32,
}

impl Default for Denoise {
    fn default() -> Self {
        Self {
            radius: 3,
            strength: 0.6,
        }
    }
}

/// Samples below which a pixel's own variance is not to be trusted.
const FEW: u32 = 4;
/// Rows that one task takes.
const BAND: usize = 16;
/// Squared feature differences that count as one unit.
const ALBEDO_SCALE: f32 = 0.02;
const NORMAL_SCALE: f32 = 0.12;
/// Unit taken off the weight of a neighbour on another yarn.
const OTHER_YARN: f32 = 1.5;

/// A film as separate planes, so that the inner loops are simple ones.
struct Planes {
    width: usize,
    height: usize,
    colour: [Vec<f32>; 3],
    luminance: Vec<f32>,
    variance: Vec<f32>,
    /// Albedo, normal across the view and depth, scaled so that a squared difference of 1 is one unit.
    features: [Vec<f32>; 6],
    yarn: Vec<u32>,
}

impl Denoise {
    /// Bytes a pixel while it denoises.
    pub const BYTES: u64 = size_of::<Vec3>() as u64 + 12 * size_of::<f32>() as u64;

    /// The film's mean radiances, denoised; premultiplied, row by row from the top.
    ///
    /// # Errors
    /// When the job is cancelled.
    pub fn apply(&self, film: &Film, job: &Job) -> Result<Vec<Vec3>, Cancelled> {
        let mut result = film.means();
        if result.is_empty() || self.strength <= 0.0 || self.strength.is_nan() {
            return Ok(result);
        }
        job.check()?;
        let planes = Planes::new(film);
        let radius = self.radius.min(16) as isize;
        let strength = self.strength.min(4.0);
        result
            .par_chunks_mut(planes.width * BAND)
            .enumerate()
            .try_for_each(|(band, rows)| {
                job.check()?;
                planes.filter(rows, band * BAND, radius, strength);
                Ok(())
            })?;
        Ok(result)
    }
}

impl Planes {
    fn new(film: &Film) -> Self {
        let (width, height) = (film.width() as usize, film.height() as usize);
        let pixels = film.pixels();
        let clean = |v: f32| if v.is_finite() { v } else { 0.0 };
        let plane = |value: &(dyn Fn(&Pixel) -> f32 + Sync)| -> Vec<f32> {
            pixels.par_iter().map(|p| clean(value(p))).collect()
        };
        let mut planes = Self {
            width,
            height,
            colour: [
                plane(&|p| p.mean().x),
                plane(&|p| p.mean().y),
                plane(&|p| p.mean().z),
            ],
            luminance: plane(&|p| luminance(p.mean())),
            variance: plane(&|p| p.variance() as f32),
            features: [
                plane(&|p| p.albedo().x / ALBEDO_SCALE.sqrt()),
                plane(&|p| p.albedo().y / ALBEDO_SCALE.sqrt()),
                plane(&|p| p.albedo().z / ALBEDO_SCALE.sqrt()),
                plane(&|p| p.normal().x / NORMAL_SCALE.sqrt()),
                plane(&|p| p.normal().y / NORMAL_SCALE.sqrt()),
                plane(&|p| p.depth()),
            ],
            yarn: pixels
                .par_iter()
                .map(|p| p.optics().unwrap_or(u32::MAX))
                .collect(),
        };
        planes.scale_depth();
        planes.calm_fireflies();
        planes.settle_variance(film);
        planes
    }

    /// Depth counts against its usual step from pixel to pixel.
    fn scale_depth(&mut self) {
        let depth = &mut self.features[5];
        let (mut sum, mut n) = (0.0f64, 0u32);
        for row in depth.chunks_exact(self.width.max(1)) {
            for pair in row.windows(2) {
                let step = (pair[0] - pair[1]).abs();
                if step > 0.0 && pair[0] > 0.0 && pair[1] > 0.0 {
                    sum += f64::from(step);
                    n += 1;
                }
            }
        }
        let usual = if n > 0 { sum / f64::from(n) } else { 1.0 };
        let scale = (1.0 / (4.0 * usual).max(1e-12)) as f32;
        depth.iter_mut().for_each(|d| *d *= scale);
    }

    /// Values of a plane in the 3×3 patch around a pixel, itself left out.
    fn neighbours<'p>(
        &self,
        plane: &'p [f32],
        x: usize,
        y: usize,
    ) -> impl Iterator<Item = f32> + use<'p> {
        let width = self.width;
        let (x0, x1) = (x.saturating_sub(1), (x + 1).min(self.width - 1));
        let (y0, y1) = (y.saturating_sub(1), (y + 1).min(self.height - 1));
        (y0..=y1).flat_map(move |v| {
            (x0..=x1)
                .filter(move |&u| (u, v) != (x, y))
                .map(move |u| plane[v * width + u])
        })
    }

    /// Brings pixels that stand out of their neighbours by more than their own noise can
    /// vouch for down to the brightest neighbour.
    fn calm_fireflies(&mut self) {
        let calmed: Vec<Option<f32>> = (0..self.luminance.len())
            .into_par_iter()
            .map(|k| {
                let (x, y) = (k % self.width, k / self.width);
                let top = self
                    .neighbours(&self.luminance, x, y)
                    .fold(0.0f32, f32::max);
                let excess = self.luminance[k] - top;
                let doubtful = excess * excess < 9.0 * self.variance[k] || self.variance[k] == 0.0;
                (excess > 0.0 && doubtful && self.luminance[k] > 0.0)
                    .then(|| top / self.luminance[k])
            })
            .collect();
        for (k, scale) in calmed.into_iter().enumerate() {
            if let Some(scale) = scale {
                self.luminance[k] *= scale;
                self.variance[k] *= scale * scale;
                for plane in &mut self.colour {
                    plane[k] *= scale;
                }
            }
        }
    }

    /// Variances are noisy themselves: each becomes the mean of its patch. With few
    /// samples the spread within the patch stands in.
    fn settle_variance(&mut self, film: &Film) {
        let settled = (0..self.luminance.len())
            .into_par_iter()
            .map(|k| {
                let (x, y) = (k % self.width, k / self.width);
                let plane = if film.pixels()[k].samples() >= FEW {
                    let sum: f32 = self.neighbours(&self.variance, x, y).sum();
                    let n = self.neighbours(&self.variance, x, y).count() as f32;
                    (sum + 2.0 * self.variance[k]) / (n + 2.0)
                } else {
                    let n = self.neighbours(&self.luminance, x, y).count() as f32 + 1.0;
                    let own = self.luminance[k];
                    let sum: f32 = self.neighbours(&self.luminance, x, y).sum::<f32>() + own;
                    let squares: f32 = self
                        .neighbours(&self.luminance, x, y)
                        .map(|l| l * l)
                        .sum::<f32>();
                    ((squares + own * own) / n - (sum / n) * (sum / n)).max(0.0)
                };
                if plane.is_finite() { plane } else { 0.0 }
            })
            .collect();
        self.variance = settled;
    }

    /// Filters the rows from `top` on into `out`.
    fn filter(&self, out: &mut [Vec3], top: usize, radius: isize, strength: f32) {
        let width = self.width;
        let rows = out.len() / width;
        let mut weights = vec![0.0f32; out.len()];
        let mut sums: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0.0f32; out.len()]);
        // Distances of the band and a row above and below it, then summed along x.
        let mut distances = vec![0.0f32; (rows + 2) * width];
        let mut weight = vec![0.0f32; width];
        let mut line = vec![0.0f32; width];
        for dy in -radius..=radius {
            for dx in -radius..=radius {
                let (x0, x1) = self.columns(dx);
                if x0 == x1 {
                    continue;
                }
                let allowed = strength * strength;
                self.distances(&mut distances, &mut line, top, [dx, dy], allowed);
                for row in 0..rows {
                    let patch = [row, row + 1, row + 2].map(|r| &distances[r * width..][..width]);
                    self.weigh(&mut weight, patch, top + row, dx, dy);
                    let at = row * width..(row + 1) * width;
                    let y = (top + row) as isize + dy;
                    if y < 0 || y >= self.height as isize {
                        continue;
                    }
                    let from = (y * width as isize + x0 as isize + dx) as usize;
                    let n = x1 - x0;
                    let weight = &weight[x0..x1];
                    let all = &mut weights[at.clone()][x0..x1];
                    for (sum, w) in all.iter_mut().zip(weight) {
                        *sum += w;
                    }
                    for (sums, plane) in sums.iter_mut().zip(&self.colour) {
                        let sums = &mut sums[at.clone()][x0..x1];
                        for ((sum, w), value) in
                            sums.iter_mut().zip(weight).zip(&plane[from..][..n])
                        {
                            *sum += w * value;
                        }
                    }
                }
            }
        }
        for (k, out) in out.iter_mut().enumerate() {
            // The pixel itself always counts, so that no weight is 0.
            let total = weights[k].max(1e-6);
            *out = Vec3::new(sums[0][k], sums[1][k], sums[2][k]) / total;
        }
    }

    /// Columns whose neighbour at `dx` lies on the film.
    fn columns(&self, dx: isize) -> (usize, usize) {
        let width = self.width as isize;
        let from = (-dx).clamp(0, width);
        let to = (width - dx).clamp(from, width);
        (from as usize, to as usize)
    }

    /// Squared differences beyond noise between pixels and their neighbours at (dx, dy),
    /// in units of the noise allowed, summed over three columns.
    fn distances(
        &self,
        out: &mut [f32],
        line: &mut [f32],
        top: usize,
        [dx, dy]: [isize; 2],
        allowed: f32,
    ) {
        let width = self.width;
        for (k, out) in out.chunks_exact_mut(width).enumerate() {
            // Rows beyond the film repeat its edge.
            let y = (top as isize + k as isize - 1).clamp(0, self.height as isize - 1);
            let v = (y + dy).clamp(0, self.height as isize - 1) as usize * width;
            let y = y as usize * width;
            line.fill(0.0);
            let (x0, x1) = self.columns(dx);
            let n = x1 - x0;
            let from = (v as isize + x0 as isize + dx) as usize;
            let here = (
                &self.luminance[y + x0..][..n],
                &self.variance[y + x0..][..n],
            );
            let there = (&self.luminance[from..][..n], &self.variance[from..][..n]);
            for (k, d) in line[x0..x1].iter_mut().enumerate() {
                let (vp, vq) = (here.1[k], there.1[k]);
                let difference = here.0[k] - there.0[k];
                let beyond = difference * difference - (vp + vp.min(vq));
                *d = beyond / (1e-7 + allowed * (vp + vq));
            }
            out[0] = line[0] + line[0] + line[width.min(2) - 1];
            for (k, three) in line.windows(3).enumerate() {
                out[k + 1] = three[0] + three[1] + three[2];
            }
            if width > 1 {
                out[width - 1] = line[width - 2] + line[width - 1] + line[width - 1];
            }
        }
    }

    /// Weights of the neighbours at (dx, dy) of one row; `patch` holds the distances of
    /// the three rows around it.
    fn weigh(&self, out: &mut [f32], patch: [&[f32]; 3], y: usize, dx: isize, dy: isize) {
        let v = y as isize + dy;
        if v < 0 || v >= self.height as isize {
            return;
        }
        let (x0, x1) = self.columns(dx);
        let n = x1 - x0;
        let here = y * self.width + x0;
        let there = (v * self.width as isize + x0 as isize + dx) as usize;
        let out = &mut out[x0..x1];
        for (k, w) in out.iter_mut().enumerate() {
            let sum = patch[0][x0 + k] + patch[1][x0 + k] + patch[2][x0 + k];
            *w = (sum * (1.0 / 9.0)).max(0.0);
        }
        for plane in &self.features {
            let (a, b) = (&plane[here..][..n], &plane[there..][..n]);
            for ((w, a), b) in out.iter_mut().zip(a).zip(b) {
                *w += (a - b) * (a - b);
            }
        }
        let (a, b) = (&self.yarn[here..][..n], &self.yarn[there..][..n]);
        for ((w, a), b) in out.iter_mut().zip(a).zip(b) {
            let other = if a == b { 0.0 } else { OTHER_YARN };
            // (1 − x/4)⁴ follows e^−x and ends at 4.
            let t = (1.0 - 0.25 * (*w + other)).max(0.0);
            *w = (t * t) * (t * t);
        }
        if dx == 0 && dy == 0 {
            out.fill(1.0);
        }
    }
}
