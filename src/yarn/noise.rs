//! Hash-based random numbers: the same for any order of evaluation.

use crate::hash::mix;

/// A 64-bit hash of a seed and a counter (splitmix64's finaliser).
pub fn hash(seed: u64, counter: u64) -> u64 {
    mix(seed.wrapping_add(counter.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15)))
}

/// A uniform number in 0..1 from a hash.
pub fn unit(hash: u64) -> f32 {
    (hash >> 40) as f32 / 16_777_216.0
}

/// A number in −1..1, uniform, from a seed and a counter.
pub(crate) fn signed(seed: u64, counter: u64) -> f32 {
    unit(hash(seed, counter)) * 2.0 - 1.0
}

/// A bump over one crossing: 0 with zero slope at its borders, 1 in the middle.
///
/// Irregularity is multiplied by it, so that blocks copied from different places of an
/// exemplar still meet at their borders.
pub(crate) fn crossing_window(fraction: f32) -> f32 {
    let product = fraction * (1.0 - fraction);
    16.0 * product * product
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn window_vanishes_with_its_slope_at_the_borders() {
        assert_eq!(crossing_window(0.0), 0.0);
        assert_eq!(crossing_window(1.0), 0.0);
        assert!((crossing_window(0.5) - 1.0).abs() < 1e-6);
        assert!(crossing_window(1e-3) / 1e-3 < 0.05);
    }

    #[test]
    fn hashed_numbers_are_uniform() {
        let mean: f32 = (0..10_000).map(|i| unit(hash(7, i))).sum::<f32>() / 10_000.0;
        assert!((mean - 0.5).abs() < 0.02, "mean {mean}");
    }
}
