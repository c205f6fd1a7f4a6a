//! The gain of the light of one yarn: a short series, and what kinds of place add to it.

use serde::{Deserialize, Serialize};

use super::series::{KINDS, OWN, TERMS, kind, terms};
use crate::render::Arrival;

/// Factors of a gain: of all terms for light that was scattered once and for the rest,
/// then of the first terms alone by kind of place, for the two alike.
pub const FACTORS: usize = 2 * TERMS + KINDS * 2 * OWN;
/// A gain outside is not believed: the series is not meant to run away between the
/// directions that it was measured in.
pub(super) const GAINS: std::ops::RangeInclusive<f32> = 0.4..=2.5;
/// A factor beyond is no correction any more.
pub(super) const FARTHEST: f32 = 1.99;

/// Where the factors of light scattered once (0) or more often (1) begin: those of all
/// [`TERMS`], and those of the [`OWN`] of a kind of place.
#[inline]
pub(super) fn first_factors(kind: usize, order: usize) -> [usize; 2] {
    [order * TERMS, 2 * TERMS + (kind * 2 + order) * OWN]
}

/// What light is multiplied with that a yarn's fibres scatter towards the eye: 1 and the
/// terms of a series at their factors. Kept without the zeros at its end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f32>", into = "Vec<f32>")]
pub struct Gain([f32; FACTORS]);

impl Gain {
    /// What changes nothing.
    pub const NONE: Self = Self([0.0; FACTORS]);

    /// From what each factor is; `None` for more than [`FACTORS`] or for one that is no
    /// number or is ±2 or beyond. Factors that are not given are 0.
    pub fn new(factors: &[f32]) -> Option<Self> {
        let mut gain = Self::NONE;
        gain.0.get_mut(..factors.len())?.copy_from_slice(factors);
        (gain.0.iter().all(|factor| factor.abs() <= FARTHEST)).then_some(gain)
    }

    /// The factors.
    pub fn factors(&self) -> &[f32; FACTORS] {
        &self.0
    }

    /// Part of the way, 0 to 1, from this gain to another.
    pub(super) fn mixed(&self, other: &Self, part: f32) -> Self {
        let mix = |i: usize| self.0[i] + (other.0[i] - self.0[i]) * part;
        Self(std::array::from_fn(mix))
    }

    /// What light is multiplied with that arrives so.
    #[inline]
    pub fn at(&self, arrival: &Arrival) -> f32 {
        let terms = terms(arrival);
        let sum = |factors: &[f32]| -> f32 { terms.iter().zip(factors).map(|(t, f)| t * f).sum() };
        let kind = kind(arrival);
        let [common, own] = first_factors(kind, usize::from(arrival.order > 1));
        let common = sum(&self.0[common..common + TERMS]);
        let own = self.0.get(own..own + OWN).map_or(0.0, sum);
        (1.0 + common + own).clamp(*GAINS.start(), *GAINS.end())
    }
}

impl TryFrom<Vec<f32>> for Gain {
    type Error = String;

    fn try_from(factors: Vec<f32>) -> Result<Self, String> {
        Self::new(&factors)
            .ok_or_else(|| format!("a gain has at most {FACTORS} factors between -2 and 2"))
    }
}

impl From<Gain> for Vec<f32> {
    fn from(gain: Gain) -> Self {
        let last = gain.0.iter().rposition(|&factor| factor != 0.0);
        gain.0[..last.map_or(0, |last| last + 1)].to_vec()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn every_factor_has_one_place() {
        let mut seen = [0; FACTORS];
        for order in 0..2 {
            let [common, _] = first_factors(0, order);
            (common..common + TERMS).for_each(|i| seen[i] += 1);
            for kind in 0..KINDS {
                let [_, own] = first_factors(kind, order);
                (own..own + OWN).for_each(|i| seen[i] += 1);
            }
        }
        assert_eq!(seen, [1; FACTORS]);
    }

    #[test]
    fn what_is_kept_is_read_again_and_what_is_no_gain_is_not() {
        for count in [0, 1, TERMS, FACTORS] {
            let factors: Vec<f32> = (0..count).map(|i| 0.004 * (i + 1) as f32).collect();
            let gain = Gain::new(&factors).unwrap();
            let text = ron::to_string(&gain).unwrap();
            assert_eq!(ron::from_str::<Gain>(&text).unwrap(), gain);
            assert_eq!(Vec::from(gain), factors);
        }
        assert_eq!(ron::to_string(&Gain::NONE).unwrap(), "[]");
        assert!(Gain::new(&[0.0; FACTORS + 1]).is_none());
        for wrong in [f32::NAN, f32::INFINITY, -2.0] {
            assert!(Gain::new(&[0.1, wrong]).is_none());
        }
        assert!(ron::from_str::<Gain>("[0.1, 7.0]").is_err());
    }
}
