//! Pictures as planes of numbers: halved, doubled, blurred, cut.

use std::ops::{Add, Mul, Sub};

use rayon::prelude::*;

/// What a plane may hold.
pub trait Value:
    Copy + Default + Send + Sync + Add<Output = Self> + Sub<Output = Self> + Mul<f32, Output = Self>
{
}

impl<T> Value for T where
    T: Copy + Default + Send + Sync + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>
{
}

/// `width` · `height` values, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane<T> {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<T>,
}

impl<T: Value> Plane<T> {
    /// `None` where there are no values, or not as many as the sides say.
    pub fn new(width: usize, height: usize, pixels: Vec<T>) -> Option<Self> {
        let fits = width.checked_mul(height) == Some(pixels.len()) && !pixels.is_empty();
        fits.then_some(Self {
            width,
            height,
            pixels,
        })
    }

    /// A plane of rows that `fill` makes.
    fn rows(width: usize, height: usize, fill: impl Fn(usize, &mut [T]) + Sync) -> Self {
        let mut pixels = vec![T::default(); width * height];
        (pixels.par_chunks_mut(width).enumerate()).for_each(|(y, row)| fill(y, row));
        Self {
            width,
            height,
            pixels,
        }
    }

    fn row(&self, y: usize) -> &[T] {
        &self.pixels[y * self.width..][..self.width]
    }

    /// Value by value; both have the same sides.
    fn with(&self, other: &Self, merge: impl Fn(T, T) -> T + Sync) -> Self {
        Self::rows(self.width, self.height, |y, row| {
            let both = self.row(y).iter().zip(other.row(y));
            for (out, (&a, &b)) in row.iter_mut().zip(both) {
                *out = merge(a, b);
            }
        })
    }

    pub fn plus(&self, other: &Self) -> Self {
        self.with(other, |a, b| a + b)
    }

    pub fn minus(&self, other: &Self) -> Self {
        self.with(other, |a, b| a - b)
    }

    pub fn scaled(mut self, by: f32) -> Self {
        self.pixels
            .iter_mut()
            .for_each(|value| *value = *value * by);
        self
    }

    /// Half as large: means of 2 × 2, of fewer at an odd end.
    pub fn halved(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        Self::rows(width, height, |y, row| {
            let above = self.row(2 * y);
            let below = self.row((2 * y + 1).min(self.height - 1));
            for (x, out) in row.iter_mut().enumerate() {
                let (left, right) = (2 * x, (2 * x + 1).min(self.width - 1));
                *out = (above[left] + above[right] + below[left] + below[right]) * 0.25;
            }
        })
    }

    /// Twice as large, to these sides, between the values.
    pub fn doubled(&self, width: usize, height: usize) -> Self {
        // The middle of a pixel lies a quarter of a larger one off the larger one's middle.
        self.sampled(
            width,
            height,
            |x| (x as f32 + 0.5) * 0.5 - 0.5,
            |y| (y as f32 + 0.5) * 0.5 - 0.5,
        )
    }

    /// Of these sides, between the values.
    pub fn resized(self, width: usize, height: usize) -> Self {
        if (self.width, self.height) == (width, height) {
            return self;
        }
        let [across, down] = [
            self.width as f32 / width as f32,
            self.height as f32 / height as f32,
        ];
        self.sampled(
            width,
            height,
            |x| (x as f32 + 0.5) * across - 0.5,
            |y| (y as f32 + 0.5) * down - 0.5,
        )
    }

    fn sampled(
        &self,
        width: usize,
        height: usize,
        across: impl Fn(usize) -> f32,
        down: impl Fn(usize) -> f32 + Sync,
    ) -> Self {
        let between = |place: f32, sides: usize| {
            let place = place.clamp(0.0, (sides - 1) as f32);
            let low = place as usize;
            (low, (low + 1).min(sides - 1), place - low as f32)
        };
        let columns: Vec<_> = (0..width).map(|x| between(across(x), self.width)).collect();
        Self::rows(width, height, |y, row| {
            let (above, below, v) = between(down(y), self.height);
            let (above, below) = (self.row(above), self.row(below));
            for (out, &(left, right, u)) in row.iter_mut().zip(&columns) {
                let top = above[left] * (1.0 - u) + above[right] * u;
                let bottom = below[left] * (1.0 - u) + below[right] * u;
                *out = top * (1.0 - v) + bottom * v;
            }
        })
    }

    /// Means of what lies within `radius` each way, of what there is of it.
    pub fn blurred(&self, radius: usize) -> Self {
        let along = Self::rows(self.width, self.height, |y, row| {
            means(self.row(y), radius, row);
        });
        // The columns, as rows of the plane turned over its diagonal.
        let turned = along.turned();
        Self::rows(self.height, self.width, |y, row| {
            means(turned.row(y), radius, row);
        })
        .turned()
    }

    fn turned(&self) -> Self {
        Self::rows(self.height, self.width, |y, row| {
            for (x, out) in row.iter_mut().enumerate() {
                *out = self.pixels[x * self.width + y];
            }
        })
    }

    /// Means of squares of `scale` pixels, the first of which has its corner at
    /// (`left`, `top`); nothing where a square is not wholly on the plane.
    pub fn cut(&self, [width, height]: [usize; 2], [left, top]: [f32; 2], scale: f32) -> Self {
        let parts = |start: f32, count: usize, sides: usize| -> Vec<Option<Vec<(usize, f32)>>> {
            (0..count)
                .map(|at| {
                    let low = start + at as f32 * scale;
                    shares(low, low + scale, sides)
                })
                .collect()
        };
        let columns = parts(left, width, self.width);
        let rows = parts(top, height, self.height);
        Self::rows(width, height, |y, row| {
            let Some(rows) = &rows[y] else { return };
            for (out, columns) in row.iter_mut().zip(&columns) {
                let Some(columns) = columns else { continue };
                let mut sum = T::default();
                for &(y, v) in rows {
                    for &(x, u) in columns {
                        sum = sum + self.pixels[y * self.width + x] * (u * v);
                    }
                }
                *out = sum;
            }
        })
    }
}

/// The pixels between two places and their shares, if all lie on the plane.
fn shares(low: f32, high: f32, sides: usize) -> Option<Vec<(usize, f32)>> {
    // A hair of a pixel beyond the edge is the edge.
    const SLACK: f32 = 0.01;
    let inside = low >= -SLACK && high <= sides as f32 + SLACK && high > low;
    if !inside {
        return None;
    }
    let (first, last) = (low.max(0.0) as usize, (high.ceil() as usize).min(sides));
    let covered = |at: usize| (high.min(at as f32 + 1.0) - low.max(at as f32)).max(0.0);
    let all: f32 = (first..last).map(covered).sum();
    (all > 0.0).then(|| (first..last).map(|at| (at, covered(at) / all)).collect())
}

/// Means of a row's values within `radius` of each.
fn means<T: Value>(row: &[T], radius: usize, out: &mut [T]) {
    for (x, out) in out.iter_mut().enumerate() {
        let near = &row[x.saturating_sub(radius)..(x + radius + 1).min(row.len())];
        let sum = near.iter().fold(T::default(), |sum, &value| sum + value);
        *out = sum * (1.0 / near.len() as f32);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn ramp(width: usize, height: usize) -> Plane<f32> {
        let pixels = (0..width * height).map(|at| (at % width) as f32 + 10.0 * (at / width) as f32);
        Plane::new(width, height, pixels.collect()).unwrap()
    }

    #[test]
    fn halving_keeps_the_mean_and_doubling_what_is_flat() {
        let plane = ramp(6, 4);
        let mean =
            |plane: &Plane<f32>| plane.pixels.iter().sum::<f32>() / plane.pixels.len() as f32;
        assert!((mean(&plane.halved()) - mean(&plane)).abs() < 1e-5);
        let flat = Plane::new(3, 2, vec![7.0f32; 6]).unwrap();
        assert_eq!(flat.doubled(5, 3).pixels, vec![7.0; 15]);
        assert_eq!(flat.blurred(4), flat);
        // Odd sides and single pixels.
        for (width, height) in [(1, 1), (1, 7), (5, 3)] {
            let plane = ramp(width, height);
            assert_eq!(
                plane.halved().doubled(width, height).pixels.len(),
                width * height
            );
        }
    }

    #[test]
    fn a_cut_of_whole_pixels_is_a_copy_and_a_larger_one_the_mean() {
        let plane = ramp(6, 4);
        let copy = plane.cut([2, 2], [3.0, 1.0], 1.0);
        assert_eq!(copy.pixels, [13.0, 14.0, 23.0, 24.0]);
        let mean = plane.cut([2, 1], [0.0, 0.0], 2.0);
        assert!((mean.pixels[0] - 5.5).abs() < 1e-5 && (mean.pixels[1] - 7.5).abs() < 1e-5);
        // Off the plane there is nothing.
        assert_eq!(plane.cut([2, 1], [5.0, 0.0], 1.0).pixels, [5.0, 0.0]);
    }
}
