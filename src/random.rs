//! Random numbers that are a hash of (seed, pixel, sample, dimension).
//!
//! No state is shared, so a picture does not depend on the number of threads or on the
//! order of tiles: the n-th number of a sample of a pixel is always the same. The hash
//! is splitmix64 (Steele, Lea, Flood 2014) over a key of the first three.

use crate::hash::mix;
use glam::Vec3;

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The largest number that [`Random`] returns: 1 − 2⁻²⁴.
pub const LARGEST_BELOW_ONE: f32 = 1.0 - 1.0 / 16_777_216.0;

/// The stream of uniform numbers in [0, 1) of one sample of one pixel.
#[derive(Debug, Clone)]
pub struct Random {
    state: u64,
    step: u64,
}

impl Random {
    /// The stream of `(seed, pixel, sample)`; drawing from it counts the dimensions.
    #[inline]
    pub fn new(seed: u64, pixel: u64, sample: u64) -> Self {
        let key = mix(seed.wrapping_add(GOLDEN));
        let key = mix(key ^ pixel.wrapping_mul(GOLDEN));
        let key = mix(key ^ sample.wrapping_mul(0xd1b5_4a32_d192_ed03));
        Self {
            state: key,
            step: GOLDEN,
        }
    }

    /// A stream that answers the same 64 bits for ever: 0 makes every number 0, all
    /// ones make every number 1 − 2⁻²⁴. For tests of the extremes.
    pub fn stuck_at(bits: u64) -> Self {
        Self {
            state: unmix(bits),
            step: 0,
        }
    }

    /// The next 64 bits.
    #[inline]
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(self.step);
        mix(self.state)
    }

    /// One uniform number.
    #[inline]
    pub fn uniform(&mut self) -> f32 {
        unit(self.bits() >> 40)
    }

    /// Two uniform numbers from one draw.
    #[inline]
    pub fn pair(&mut self) -> [f32; 2] {
        let bits = self.bits();
        [unit(bits >> 40), unit((bits >> 16) & 0xff_ffff)]
    }

    /// Three uniform numbers of 21 bits each, for stochastic filters.
    #[inline]
    pub fn tap(&mut self) -> Vec3 {
        let bits = self.bits();
        let part = |shift: u32| ((bits >> shift) & 0x1f_ffff) as f32 * (1.0 / 2_097_152.0);
        Vec3::new(part(43), part(22), part(1))
    }
}

/// 24 bits as a number in [0, 1).
#[inline]
fn unit(bits: u64) -> f32 {
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

/// The inverse of [`mix`].
fn unmix(bits: u64) -> u64 {
    let undo = |bits: u64, shift: u32| {
        let mut result = bits;
        for _ in 0..64 / shift {
            result = bits ^ (result >> shift);
        }
        result
    };
    let bits = undo(bits, 31).wrapping_mul(0x3196_42b2_d24d_8ec3);
    let bits = undo(bits, 27).wrapping_mul(0x96de_1b17_3f11_9089);
    undo(bits, 30)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stuck_streams_reach_both_ends() {
        let mut low = Random::stuck_at(0);
        let mut high = Random::stuck_at(u64::MAX);
        for _ in 0..3 {
            assert_eq!(low.pair(), [0.0, 0.0]);
            assert_eq!(high.pair(), [LARGEST_BELOW_ONE; 2]);
            assert!(high.tap().max_element() < 1.0);
        }
        assert_eq!(free_path(0.0), 0.0);
        assert!((16.0..17.0).contains(&free_path(LARGEST_BELOW_ONE)));
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
    }
}
