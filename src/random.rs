//! Random numbers that are a hash of (seed, pixel, sample, dimension).
//!
//! No state is shared, so a picture does not depend on the number of threads or on the
//! order of tiles: the n-th number of a sample of a pixel is always the same. The hash is
//! pcg4d (Jarzynski & Olano, *Hash Functions for GPU Rendering*, JCGT 9.3, 2020), of 32-bit
//! words alone, so that a shader can draw the very same numbers.

use glam::Vec3;

/// Multiplier and increment of the words' generator (Knuth's).
const MULTIPLIER: u32 = 1_664_525;
const INCREMENT: u32 = 1_013_904_223;

/// The largest number that [`Random`] returns: 1 − 2⁻²⁴.
pub const LARGEST_BELOW_ONE: f32 = 1.0 - 1.0 / 16_777_216.0;

/// A bijection of four words in which every bit moves about half of all others.
#[inline(always)]
fn pcg4d(words: [u32; 4]) -> [u32; 4] {
    let words = words.map(|word| word.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT));
    stir(stir(words).map(|word| word ^ (word >> 16)))
}

/// Adds to each word the product of two others.
#[inline(always)]
fn stir([mut x, mut y, mut z, mut w]: [u32; 4]) -> [u32; 4] {
    x = x.wrapping_add(y.wrapping_mul(w));
    y = y.wrapping_add(z.wrapping_mul(x));
    z = z.wrapping_add(x.wrapping_mul(y));
    w = w.wrapping_add(y.wrapping_mul(z));
    [x, y, z, w]
}

/// The stream of uniform numbers in [0, 1) of one sample of one pixel.
#[derive(Debug, Clone)]
pub struct Random {
    key: [u32; 3],
    /// Numbers drawn so far.
    dimension: u32,
    step: u32,
}

/// What one step of a walk through matter draws.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// Where about its place it looks, for stochastic filters.
    pub tap: Vec3,
    /// Whether it goes on.
    pub accept: f32,
    /// How far.
    pub flight: f32,
}

impl Random {
    /// The stream of `(seed, pixel, sample)`; drawing from it counts the dimensions.
    #[inline]
    pub fn new(seed: u64, pixel: u64, sample: u64) -> Self {
        let low = [seed, pixel, sample].map(|word| word as u32);
        let high = [seed, pixel, sample].map(|word| (word >> 32) as u32);
        let [x, y, z, _] = pcg4d([low[0], low[1], low[2], 0]);
        // Most have no upper halves; those that have are stirred in after the lower ones.
        let key = match high {
            [0, 0, 0] => [x, y, z],
            _ => {
                let [a, b, c, _] = pcg4d([x ^ high[0], y ^ high[1], z ^ high[2], 1]);
                [a, b, c]
            }
        };
        Self {
            key,
            dimension: 0,
            step: 1,
        }
    }

    /// A stream that answers the same 64 bits for ever: 0 makes every number 0, all
    /// ones make every number 1 − 2⁻²⁴. For tests of the extremes.
    pub fn stuck_at(bits: u64) -> Self {
        let [high, low] = [bits >> 32, bits].map(|word| word as u32);
        let [x, y, z, dimension] = undo_pcg4d([high, low, high, low]);
        Self {
            key: [x, y, z],
            dimension,
            step: 0,
        }
    }

    /// The next four words.
    #[inline]
    fn words(&mut self) -> [u32; 4] {
        let [x, y, z] = self.key;
        let words = pcg4d([x, y, z, self.dimension]);
        self.dimension = self.dimension.wrapping_add(self.step);
        words
    }

    /// The next 64 bits.
    #[inline]
    pub fn bits(&mut self) -> u64 {
        let [x, y, ..] = self.words();
        u64::from(x) << 32 | u64::from(y)
    }

    /// One uniform number.
    #[inline]
    pub fn uniform(&mut self) -> f32 {
        unit(self.words()[0] >> 8)
    }

    /// Two uniform numbers from one draw.
    #[inline]
    pub fn pair(&mut self) -> [f32; 2] {
        let [x, y, ..] = self.words();
        [unit(x >> 8), unit(y >> 8)]
    }

    /// Five uniform numbers of 24 bits from one draw.
    #[inline]
    pub fn step(&mut self) -> Step {
        let [x, y, z, w] = self.words();
        let rest = (x & 0xff) << 16 | (y & 0xff) << 8 | (z & 0xff);
        Step {
            tap: Vec3::new(unit(x >> 8), unit(y >> 8), unit(z >> 8)),
            accept: unit(w >> 8),
            flight: unit(rest),
        }
    }
}

/// 24 bits as a number in [0, 1).
#[inline]
fn unit(bits: u32) -> f32 {
    bits as f32 * (1.0 / 16_777_216.0)
}

/// The optical depth of a free flight: −ln(1−u) for u in [0, 1); 0 for u = 0 and 16.6
/// at most. The logarithm is right to 1e-6 relative (for flights above 1e-4, absolutely
/// to 1e-7): the exponent is taken from the bits, the rest by the series of artanh.
#[inline(always)]
pub fn free_path(u: f32) -> f32 {
    let x = 1.0 - u;
    // x = 2^e · m with m in [√½, √2).
    let bits = x.to_bits().wrapping_add(0x3f80_0000 - 0x3f35_04f3);
    let exponent = (bits >> 23) as i32 - 127;
    let m = f32::from_bits((bits & 0x007f_ffff) + 0x3f35_04f3);
    let s = (m - 1.0) / (m + 1.0);
    let s2 = s * s;
    let series = 2.0 + s2 * (0.666_666_7 + s2 * (0.4 + s2 * (0.285_714_3 + s2 * 0.222_222_2)));
    -(exponent as f32 * std::f32::consts::LN_2 + s * series)
}

/// A point uniform on the unit disk, by angle and radius.
#[inline(always)]
pub fn disk(u: [f32; 2]) -> (f32, f32) {
    let radius = u[0].sqrt();
    // Half the angle, −π/2..π/2, where sine and cosine have short series; then doubled.
    let half = (u[1] - 0.5) * std::f32::consts::PI;
    let h2 = half * half;
    let sine = half
        * (1.0
            + h2 * (-0.166_666_67
                + h2 * (0.008_333_333
                    + h2 * (-1.984_127e-4 + h2 * (2.755_732e-6 - h2 * 2.505_211e-8)))));
    let cosine = 1.0
        + h2 * (-0.5
            + h2 * (0.041_666_668
                + h2 * (-1.388_889e-3
                    + h2 * (2.480_159e-5 + h2 * (-2.755_732e-7 + h2 * 2.087_676e-9)))));
    let (x, y) = (cosine * cosine - sine * sine, 2.0 * sine * cosine);
    (radius * x, radius * y)
}

/// The inverse of [`pcg4d`].
fn undo_pcg4d(words: [u32; 4]) -> [u32; 4] {
    let undo_stir = |[mut x, mut y, mut z, mut w]: [u32; 4]| {
        w = w.wrapping_sub(y.wrapping_mul(z));
        z = z.wrapping_sub(x.wrapping_mul(y));
        y = y.wrapping_sub(z.wrapping_mul(x));
        x = x.wrapping_sub(y.wrapping_mul(w));
        [x, y, z, w]
    };
    // Newton's iteration for the multiplier's inverse: each round doubles its right bits.
    let mut inverse = MULTIPLIER;
    for _ in 0..5 {
        let left = 2u32.wrapping_sub(MULTIPLIER.wrapping_mul(inverse));
        inverse = inverse.wrapping_mul(left);
    }
    undo_stir(undo_stir(words).map(|word| word ^ (word >> 16)))
        .map(|word| word.wrapping_sub(INCREMENT).wrapping_mul(inverse))
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: [[u32; 4]; 2] = [
        [0x0f02_f829, 0x2d56_8769, 0x32b0_c43b, 0xd325_48ea],
        [0x3622_cd16, 0xf114_71d8, 0xe110_9b3f, 0x02b9_4c2f],
    ];

    #[test]
    fn stuck_streams_reach_both_ends() {
        let mut low = Random::stuck_at(0);
        let mut high = Random::stuck_at(u64::MAX);
        for _ in 0..3 {
            assert_eq!(low.pair(), [0.0, 0.0]);
            assert_eq!(high.pair(), [LARGEST_BELOW_ONE; 2]);
            let Step {
                tap,
                accept,
                flight,
            } = high.step();
            assert_eq!(
                (tap, accept, flight),
                (
                    Vec3::splat(LARGEST_BELOW_ONE),
                    LARGEST_BELOW_ONE,
                    LARGEST_BELOW_ONE
                )
            );
            let Step {
                tap,
                accept,
                flight,
            } = low.step();
            assert_eq!((tap, accept, flight), (Vec3::ZERO, 0.0, 0.0));
        }
        assert_eq!(free_path(0.0), 0.0);
        assert!((16.0..17.0).contains(&free_path(LARGEST_BELOW_ONE)));
    }

    #[test]
    fn words_are_those_of_the_paper_and_come_back() {
        // Worked out apart from this, in whole numbers without end.
        assert_eq!(pcg4d([0; 4]), KNOWN[0]);
        assert_eq!(pcg4d([1, 2, 3, 4]), KNOWN[1]);
        for words in [[0; 4], [u32::MAX; 4], [1, 2, 3, 4], KNOWN[0]] {
            assert_eq!(undo_pcg4d(pcg4d(words)), words);
        }
    }

    /// Correlation of the numbers of neighbouring pixels, samples, seeds and dimensions, and
    /// of the five numbers of a step with each other, in standard errors; `draw` answers the
    /// numbers of a (seed, pixel, sample).
    fn correlations(draw: impl Fn(u64, u64, u64) -> [f32; 10]) -> Vec<f64> {
        let (pixels, samples) = (400u64, 400u64);
        let n = (pixels * samples) as f64;
        let mut sums = Vec::new();
        for pixel in 0..pixels {
            for sample in 0..samples {
                let all = draw(3, pixel, sample);
                let others = [
                    draw(3, pixel + 1, sample),
                    draw(3, pixel, sample + 1),
                    draw(4, pixel, sample),
                ];
                let beside = others.iter().flat_map(|other| all.iter().zip(other));
                let within = (0..10).flat_map(|a| (0..a).map(move |b| (a, b)));
                let pairs =
                    (beside.map(|(a, b)| (*a, *b))).chain(within.map(|(a, b)| (all[a], all[b])));
                let products: Vec<f64> = pairs
                    .map(|(a, b)| f64::from(a - 0.5) * f64::from(b - 0.5))
                    .collect();
                sums.resize(products.len(), 0.0);
                sums.iter_mut()
                    .zip(products)
                    .for_each(|(sum, own)| *sum += own);
            }
        }
        sums.iter().map(|sum| sum / n.sqrt() * 12.0).collect()
    }

    /// The numbers of two steps.
    fn two_steps(random: &mut Random) -> [f32; 10] {
        let [a, b] = [random.step(), random.step()];
        let of = |step: Step| {
            let [x, y, z] = step.tap.to_array();
            [x, y, z, step.accept, step.flight]
        };
        let (a, b) = (of(a), of(b));
        std::array::from_fn(|at| if at < 5 { a[at] } else { b[at - 5] })
    }

    #[test]
    fn neighbouring_streams_have_nothing_in_common() {
        let drawn =
            correlations(|seed, pixel, sample| two_steps(&mut Random::new(seed, pixel, sample)));
        assert!(drawn.iter().all(|z| z.abs() < 4.5), "{drawn:?}");
        // Control: the generator without its second round is seen through.
        let weak = correlations(|seed, pixel, sample| {
            let words = [seed as u32, pixel as u32, sample as u32, 0];
            let [x, y, z, w] =
                stir(words.map(|word| word.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT)));
            let [x, y, z, w] = [x, y, z, w].map(|word| unit(word >> 8));
            [x, y, z, w, x, y, z, w, x, y]
        });
        assert!(weak.iter().any(|z| z.abs() > 20.0));
    }

    #[test]
    fn every_part_of_the_square_is_met_as_often() {
        // χ² of 64 × 64 cells over pairs, and over (accept, flight) of a step.
        let count = 400_000u64;
        for kind in 0..3 {
            let mut cells = vec![0u32; 4096];
            for index in 0..count {
                let mut random = Random::new(0, index / 16, index % 16);
                let [u, v] = match kind {
                    0 => random.pair(),
                    1 => {
                        let step = random.step();
                        [step.accept, step.flight]
                    }
                    _ => [random.uniform(), random.uniform()],
                };
                cells[(u * 64.0) as usize * 64 + (v * 64.0) as usize] += 1;
            }
            let expected = count as f64 / 4096.0;
            let chi: f64 = (cells.iter())
                .map(|&cell| (f64::from(cell) - expected).powi(2) / expected)
                .sum();
            // 4095 degrees of freedom: mean 4095, standard deviation 90.5.
            assert!((chi - 4095.0).abs() < 4.5 * 90.5, "kind {kind}: {chi}");
        }
    }

    #[test]
    fn short_series_are_right_to_float_precision() {
        for k in 0..=1_000_000u64 {
            let u = (k as f32 / 1_000_001.0).min(LARGEST_BELOW_ONE);
            let exact = -(1.0 - f64::from(u)).ln();
            // 1 − u itself is rounded to 6e-8.
            let got = f64::from(free_path(u));
            assert!(
                (got - exact).abs() < 2e-7 + 1e-6 * exact,
                "{u}: {got} {exact}"
            );
            let (x, y) = disk([1.0, u]);
            let (sin, cos) = (std::f64::consts::TAU * (f64::from(u) - 0.5)).sin_cos();
            assert!((f64::from(x) - cos).abs() < 2e-6 && (f64::from(y) - sin).abs() < 2e-6);
        }
    }

    #[test]
    fn numbers_are_uniform_and_differ_by_every_key() {
        let mut sum = [0.0f64; 2];
        let mut squares = 0.0f64;
        let n = 200_000;
        for k in 0..n {
            let [a, b] = Random::new(1, k, k / 7).pair();
            sum[0] += f64::from(a);
            sum[1] += f64::from(b);
            squares += f64::from(a) * f64::from(b);
        }
        let n = n as f64;
        // Standard error of a mean of uniforms is 0.289/sqrt(n).
        assert!((sum[0] / n - 0.5).abs() < 5.0 * 0.289 / n.sqrt());
        assert!((sum[1] / n - 0.5).abs() < 5.0 * 0.289 / n.sqrt());
        assert!((squares / n - 0.25).abs() < 5.0 * 0.25 / n.sqrt());
        let first = |s, p, k| Random::new(s, p, k).bits();
        assert_ne!(first(0, 0, 0), first(1, 0, 0));
        assert_ne!(first(0, 0, 0), first(0, 1, 0));
        assert_ne!(first(0, 0, 0), first(0, 0, 1));
        for high in [(1 << 32, 0, 0), (0, 1 << 32, 0), (0, 0, 1 << 32)] {
            assert_ne!(first(0, 0, 0), first(high.0, high.1, high.2));
        }
    }
}
