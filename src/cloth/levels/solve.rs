//! Finds the factors of the gains from what was measured.
//!
//! Linear least squares of relative errors over all lamps, albedos and weaves together. A
//! ridge pulls all factors to "nothing changes", those of single kinds of block more than
//! the common ones.

use nalgebra::{DMatrix, DVector};

use super::LevelCorrection;
use super::fit::{ALBEDOS, AZIMUTHS, Light, RINGS};
use super::gain::{FACTORS, Gain, first_factors};
use super::series::{KINDS, OWN, TERMS};

/// Pull of the common factors and of those of a kind of place, as a share of the
/// measurements. With less of it the gains of light that hardly any path of a measured
/// cloth brings run away.
const RIDGE: [f64; 2] = [1e-4, 1e-3];
/// A factor beyond is no correction any more.
const MOST: f32 = 1.9;
/// The factors of warp and weft.
const BOTH: usize = 2 * FACTORS;

/// Light of a cloth at some level and of the same cloth at level 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// At level 0.
    pub fine: Light,
    /// At the coarse level, its density corrected and its light not.
    pub coarse: Light,
}

/// Root mean square of the relative errors without and with the gains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Without.
    pub before: f64,
    /// With.
    pub after: f64,
}

/// Puts into `correction` the gains with which the coarse lights are nearest to the fine
/// ones.
pub fn solve(pairs: &[Pair], correction: &mut LevelCorrection) -> Residual {
    let mut normal = DMatrix::<f64>::zeros(BOTH, BOTH);
    let mut right = DVector::<f64>::zeros(BOTH);
    let mut rows = Vec::new();
    for pair in pairs {
        for (index, (fine, coarse)) in pair.fine.each().zip(pair.coarse.each()).enumerate() {
            let wanted = plain(fine);
            if !(wanted > 0.0) {
                continue;
            }
            let weight = weight(index);
            let missing = weight * (1.0 - plain(coarse) / wanted);
            let row = DVector::from_vec(row(coarse)) * (weight / wanted);
            normal.ger(1.0, &row, &row, 1.0);
            right.axpy(missing, &row, 1.0);
            rows.push((row, missing));
        }
    }
    let measurements = rows.len().max(1) as f64;
    for i in 0..BOTH {
        let pull = RIDGE[usize::from(i % FACTORS >= 2 * TERMS)];
        normal[(i, i)] += pull * measurements;
    }
    let found = (normal.cholesky()).map_or_else(|| DVector::zeros(BOTH), |f| f.solve(&right));
    let mean_square = |of: &dyn Fn(&DVector<f64>, f64) -> f64| {
        let sum: f64 = rows.iter().map(|(row, miss)| of(row, *miss).powi(2)).sum();
        (sum / measurements).sqrt()
    };
    let gain = |yarn: usize| {
        let own = found.rows(yarn * FACTORS, FACTORS);
        let factors: Vec<f32> = (own.iter())
            .map(|&factor| (factor as f32).clamp(-MOST, MOST))
            .collect();
        Gain::new(&factors).unwrap_or(Gain::NONE)
    };
    correction.gains = [gain(0), gain(1)];
    Residual {
        before: mean_square(&|_, missing| missing),
        after: mean_square(&|row, missing| missing - row.dot(&found)),
    }
}

/// Low lamps count less: they light less of any sky.
fn weight(index: usize) -> f64 {
    let (elevation, _) = RINGS[index / ALBEDOS.len() / AZIMUTHS];
    f64::from(elevation).to_radians().sin().sqrt()
}

/// Light without a gain.
fn plain(sums: &[f64]) -> f64 {
    sums.iter().step_by(TERMS).sum()
}

/// What each factor of the warp's gain multiplies, then each of the weft's.
fn row(sums: &[f64]) -> Vec<f64> {
    let mut row = vec![0.0; BOTH];
    for (place, sums) in sums.chunks_exact(TERMS).enumerate() {
        let (yarn, kind, order) = (place / 2 / KINDS, place / 2 % KINDS, place % 2);
        let [common, own] = first_factors(kind, order).map(|first| yarn * FACTORS + first);
        for (term, sum) in sums.iter().enumerate() {
            row[common + term] += sum;
            if term < OWN {
                row[own + term] += sum;
            }
        }
    }
    row
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::super::fit::EACH;
    use super::*;
    use crate::design::Family;
    use crate::render::Random;

    /// Light whose terms are unlike each other.
    fn light(seed: u64) -> Light {
        let mut random = Random::new(seed, 0, 0);
        let count = Light::dark().values().len();
        let value = |i: usize| {
            let term = i % TERMS;
            let share = if term == 0 { 1.0 } else { 0.7 };
            share * f64::from(random.uniform())
        };
        Light::from_values((0..count).map(value).collect()).unwrap()
    }

    /// The same light with gains on it, all in one number a lamp.
    fn gained(light: &Light, gains: &[Gain; 2]) -> Light {
        let mut values = Vec::with_capacity(light.values().len());
        for sums in light.each() {
            let factors = gains.iter().flat_map(Gain::factors);
            let more: f64 = row(sums)
                .iter()
                .zip(factors)
                .map(|(x, f)| x * f64::from(*f))
                .sum();
            let mut one = vec![0.0; EACH];
            one[0] = plain(sums) + more;
            values.extend(one);
        }
        Light::from_values(values).unwrap()
    }

    #[test]
    fn known_gains_of_warp_and_weft_are_found_again() {
        let mut warp = [0.0; FACTORS];
        for (term, factor) in [
            (0, -0.15),
            (2, 0.15),
            (3, -0.15),
            (5, 0.22),
            (8, 0.15),
            (11, 0.15),
        ] {
            warp[term] = factor;
        }
        let mut weft = warp.map(|factor| -0.5 * factor);
        weft[first_factors(6, 0)[1]] = 0.3;
        let wanted = [warp, weft].map(|factors| Gain::new(&factors).unwrap());
        let pair = |seed| {
            let coarse = light(seed);
            let fine = gained(&coarse, &wanted);
            Pair { fine, coarse }
        };
        let pairs: Vec<Pair> = (0..8).map(pair).collect();
        let mut found = LevelCorrection::none(Family::Wool);
        let residual = solve(&pairs, &mut found);
        assert!(residual.before > 0.02, "{residual:?}");
        assert!(residual.after < 0.2 * residual.before, "{residual:?}");
        // Light that these pairs do not hold is corrected as well.
        let Pair { fine, coarse } = pair(99);
        let off = |light: &Light| {
            let pairs = fine.each().zip(light.each());
            let errors = pairs.map(|(a, b)| (plain(b) / a[0] - 1.0).powi(2));
            errors.sum::<f64>().sqrt()
        };
        assert!(off(&gained(&coarse, &found.gains)) < 0.6 * off(&coarse));
        // Warp's and weft's are not each other's.
        let [a, b] = found.gains.clone();
        assert!(off(&gained(&coarse, &[b, a])) > 2.0 * off(&gained(&coarse, &found.gains)));
    }

    #[test]
    fn equal_light_needs_no_gain_and_no_light_gives_none() {
        let pairs = [light(4), Light::dark()].map(|light| Pair {
            fine: light.clone(),
            coarse: light,
        });
        let none = LevelCorrection::none(Family::Wool);
        let mut found = none.clone();
        solve(&pairs, &mut found);
        assert_eq!(found, none);
        solve(&[], &mut found);
        assert_eq!(found, none);
    }
}
