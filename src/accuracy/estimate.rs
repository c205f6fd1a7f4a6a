//! A value with what is known of it: medians of times, means over blocks of a picture.

use serde::{Deserialize, Serialize};

/// A value with its 95 % confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// Two-sided 95 % points of Student's t by degrees of freedom, from 1 on.
const T95: [f64; 12] = [
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179,
];

impl Estimate {
    /// A value that is no estimate.
    pub const fn exact(value: f64) -> Self {
        Self {
            value,
            low: value,
            high: value,
        }
    }

    /// The median of some measurements. Its interval goes from the k-th smallest to the k-th
    /// largest, k the largest for which the median lies outside in at most 1 of 20 cases
    /// (binomial); fewer than six measurements cannot say so much, and their whole range
    /// stands there. Nothing was measured: not a number.
    pub fn median(values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let count = sorted.len();
        if count == 0 {
            return Self::exact(f64::NAN);
        }
        let value = 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
        let outside = outside_of_median(count);
        Self {
            value,
            low: sorted[outside],
            high: sorted[count - 1 - outside],
        }
    }

    /// The mean of independent measurements, its interval by Student's t. One measurement says
    /// nothing of its spread: its interval is endless.
    pub fn mean(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let value = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|one| (one - value) * (one - value)).sum();
        let t = match values.len() {
            0 | 1 => f64::INFINITY,
            n => T95
                .get(n - 2)
                .copied()
                .unwrap_or(1.96 + 2.4 / (count - 1.0)),
        };
        let margin = t * (squares / (count - 1.0).max(1.0) / count).sqrt();
        let margin = if margin.is_nan() {
            f64::INFINITY
        } else {
            margin
        };
        Self {
            value,
            low: value - margin,
            high: value + margin,
        }
    }

    /// The same in another unit.
    pub fn scaled(self, scale: f64) -> Self {
        Self {
            value: self.value * scale,
            low: self.low * scale,
            high: self.high * scale,
        }
    }

    /// The root of a mean square; an estimate below 0 is one of nothing.
    pub fn root(self) -> Self {
        let root = |square: f64| square.max(0.0).sqrt();
        Self {
            value: root(self.value),
            low: root(self.low),
            high: root(self.high),
        }
    }

    /// The square of what is not below 0.
    pub fn squared(self) -> Self {
        let square = |root: f64| root * root;
        Self {
            value: square(self.value),
            low: square(self.low),
            high: square(self.high),
        }
    }

    /// The sum of two independent estimates.
    pub fn plus(self, other: Self) -> Self {
        let margin = |one: f64, two: f64| one.hypot(two);
        let value = self.value + other.value;
        Self {
            value,
            low: value - margin(self.value - self.low, other.value - other.low),
            high: value + margin(self.high - self.value, other.high - other.value),
        }
    }
}

/// How many of `count` measurements, the smallest and as many of the largest, lie outside of
/// the median's interval.
fn outside_of_median(count: usize) -> usize {
    let mut chance = 0.5f64.powi(i32::try_from(count).unwrap_or(i32::MAX));
    let (mut outside, mut sum) = (0, chance);
    for k in 1..=count / 2 {
        chance *= (count + 1 - k) as f64 / k as f64;
        // Measurements k and count − 1 − k bound the interval; the median lies outside of it
        // where no more than k of them are on one side.
        if 2.0 * (sum + chance) > 0.05 || 2 * k >= count {
            break;
        }
        sum += chance;
        outside = k;
    }
    outside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn the_median_of_few_is_bounded_by_all_and_that_of_many_by_the_middle() {
        let few = Estimate::median(&[3.0, 1.0, 2.0]);
        assert_eq!((few.value, few.low, few.high), (2.0, 1.0, 3.0));
        // By the table of the sign test: of 10 the second smallest and largest, of 20 the sixth.
        assert_eq!(outside_of_median(5), 0);
        assert_eq!(outside_of_median(10), 1);
        assert_eq!(outside_of_median(20), 5);
        assert!(Estimate::median(&[]).value.is_nan());
    }

    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        const TRIALS: u64 = 4000;
        let mut held = [0u32; 2];
        for trial in 0..TRIALS {
            let mut random = Random::new(7, trial, 0);
            let values: Vec<f64> = (0..8)
                .map(|_| (0..6).map(|_| f64::from(random.pair()[0])).sum::<f64>() - 3.0)
                .collect();
            for (held, estimate) in held
                .iter_mut()
                .zip([Estimate::mean(&values), Estimate::median(&values)])
            {
                *held += u32::from(estimate.low <= 0.0 && estimate.high >= 0.0);
            }
        }
        let share = held.map(|held| f64::from(held) / TRIALS as f64);
        assert!((share[0] - 0.95).abs() < 0.015, "{share:?}");
        // Order statistics come in steps: the range of eight holds it in 99 of 100.
        assert!(share[1] > 0.98, "{share:?}");
        // The control: an interval of half the width holds it much less often.
        let mut narrow = 0u32;
        for trial in 0..TRIALS {
            let mut random = Random::new(7, trial, 0);
            let values: Vec<f64> = (0..8)
                .map(|_| (0..6).map(|_| f64::from(random.pair()[0])).sum::<f64>() - 3.0)
                .collect();
            let mean = Estimate::mean(&values);
            narrow += u32::from(2.0 * mean.value.abs() <= mean.high - mean.value);
        }
        assert!(f64::from(narrow) / (TRIALS as f64) < 0.8, "{narrow}");
    }

    #[test]
    fn one_measurement_says_nothing_of_its_spread() {
        let one = Estimate::mean(&[2.0]);
        assert!(one.value == 2.0 && one.high.is_infinite() && one.low.is_infinite());
        assert_eq!(Estimate::exact(-1.0).root(), Estimate::exact(0.0));
    }
}
