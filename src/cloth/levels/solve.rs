//! Finds the factors of the gains from what was measured.
//!
//! Linear least squares of relative errors over all lights, albedos and weaves together: of
//! the light of the whole cloth, and of what each side of the weave adds to it, as a
//! design may show one alone. The lights are single lamps, which are noisy, and rings and
//! the sky of them, which are less so and count more. What the measurements do not ask for
//! is pulled to "nothing changes": gains in the light that was measured, and in any other.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::LevelCorrection;
use super::fit::{ALBEDOS, AZIMUTHS, LAMPS, Light, Products, RINGS, by_place};
use super::gain::{FACTORS, FARTHEST, Gain, first_factors};
use super::series::{OWN, TERMS};

/// Pull of the factors, as a share of the measurements: what no other pull holds.
const RIDGE: f64 = 5e-6;
/// Pull of the mean square of how far gains are from 1, as a share of the measurements: a
/// gain that is far in most light comes to where it is not believed.
const CALM: f64 = 2e-3;
/// The same in light from anywhere to anywhere at all kinds of place: what a measured cloth
/// hardly shows may be most of what another weave of its yarns does.
const ANYWHERE: f64 = 4e-3;
/// What the error of a ring of lamps and that of all lamps count, of a high lamp 1.
const COUNTS: [f64; 2] = [3.0, 6.0];
/// A side of the weave that shows a smaller share of the light than this counts no more.
const LEAST_SIDE: f64 = 1e-3;
/// The factors of warp and weft.
const BOTH: usize = 2 * FACTORS;

/// What is known of a cloth at some level and of the same cloth at level 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// At level 0.
    pub fine: Light,
    /// At the coarse level, its density corrected and its light not.
    pub coarse: Light,
    /// Of the terms in the light of the coarse level.
    pub products: Products,
}

/// Root mean square of the relative errors of the whole cloth under single lamps, without
/// and with the gains.
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
    let views = views();
    let mut put = |(row, missing): &(DVector<f64>, f64), scale: f64| {
        normal.ger(scale * scale, row, row, 1.0);
        right.axpy(scale * scale * missing, row, 1.0);
    };
    for (pair, albedo) in pairs
        .iter()
        .flat_map(|pair| (0..ALBEDOS.len()).map(move |k| (pair, k)))
    {
        for (lamps, count) in &views {
            let of = |light: &Light| light.under(lamps.clone(), albedo);
            let (fine, coarse) = (of(&pair.fine), of(&pair.coarse));
            let lights = fine.each_ref().map(|side| plain(side));
            let wanted: f64 = lights.iter().sum();
            if !(wanted > 0.0) {
                continue;
            }
            let mut whole = (DVector::<f64>::zeros(BOTH), 0.0);
            for ((light, coarse), own) in fine.iter().zip(&coarse).zip(lights) {
                let off = (DVector::from_vec(row(coarse)), plain(light) - plain(coarse));
                whole = (whole.0 + &off.0, whole.1 + off.1);
                // Between what a side's error is of the whole light and of its own.
                put(&off, count / (wanted * own.max(LEAST_SIDE * wanted)).sqrt());
            }
            put(&whole, count / wanted);
            if lamps.len() == 1 {
                rows.push((whole.0 * (count / wanted), whole.1 * (count / wanted)));
            }
        }
    }
    let measurements = rows.len().max(1) as f64;
    for pair in pairs {
        let share = CALM * measurements / pairs.len() as f64;
        add_squares(&pair.products, share, &mut normal);
    }
    add_squares(&Products::anywhere(), ANYWHERE * measurements, &mut normal);
    for i in 0..BOTH {
        normal[(i, i)] += RIDGE * measurements;
    }
    let found = (normal.cholesky()).map_or_else(|| DVector::zeros(BOTH), |f| f.solve(&right));
    let mean_square = |of: &dyn Fn(&DVector<f64>, f64) -> f64| {
        let sum: f64 = rows.iter().map(|(row, miss)| of(row, *miss).powi(2)).sum();
        (sum / measurements).sqrt()
    };
    let gain = |yarn: usize| {
        let own = found.rows(yarn * FACTORS, FACTORS);
        let factors: Vec<f32> = (own.iter())
            .map(|&factor| (factor as f32).clamp(-FARTHEST, FARTHEST))
            .collect();
        Gain::new(&factors).unwrap_or(Gain::NONE)
    };
    correction.gains = [gain(0), gain(1)];
    Residual {
        before: mean_square(&|_, missing| missing),
        after: mean_square(&|row, missing| missing - row.dot(&found)),
    }
}

/// The lamps that are looked at together, and what their error counts: each alone (low ones
/// count less: they light less of any sky), each ring, and all.
fn views() -> Vec<(Range<usize>, f64)> {
    let alone = (0..LAMPS).map(|lamp| {
        let (elevation, _) = RINGS[lamp / AZIMUTHS];
        (
            lamp..lamp + 1,
            f64::from(elevation).to_radians().sin().sqrt(),
        )
    });
    let rings = (0..LAMPS)
        .step_by(AZIMUTHS)
        .map(|first| (first..first + AZIMUTHS, COUNTS[0]));
    alone.chain(rings).chain([(0..LAMPS, COUNTS[1])]).collect()
}

/// Adds so many times what each two factors together add to the mean square of how far a
/// gain is from 1 in all light.
fn add_squares(products: &Products, share: f64, normal: &mut DMatrix<f64>) {
    for ([yarn, kind, order], square) in products.by_place() {
        let [common, own] = first_factors(kind, order).map(|first| yarn * FACTORS + first);
        let factors = |term: usize| {
            let own = (term < OWN).then_some(own + term);
            std::iter::once(common + term).chain(own)
        };
        for (a, row) in square.chunks_exact(TERMS).enumerate() {
            for (b, product) in row.iter().enumerate() {
                for (i, j) in factors(a).flat_map(|i| factors(b).map(move |j| (i, j))) {
                    normal[(i, j)] += share * product;
                }
            }
        }
    }
}

/// Light without a gain.
fn plain(sums: &[f64]) -> f64 {
    sums.iter().step_by(TERMS).sum()
}

/// What each factor of the warp's gain multiplies, then each of the weft's.
fn row(sums: &[f64]) -> Vec<f64> {
    let mut row = vec![0.0; BOTH];
    for ([yarn, kind, order], sums) in by_place(sums) {
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
    use super::super::fit::{EACH, PLACES};
    use super::*;
    use crate::design::Family;
    use crate::random::Random;

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

    /// Terms that hardly go together.
    fn calm() -> Products {
        let square = |i: usize| f64::from(u8::from(i.is_multiple_of(TERMS + 1))) / EACH as f64;
        let square: Vec<f64> = (0..TERMS * TERMS).map(square).collect();
        Products::from_values(square.repeat(PLACES)).unwrap()
    }

    /// The same light with gains on it, all in one number a lamp.
    fn gained(light: &Light, gains: &[Gain; 2]) -> Light {
        let mut values = Vec::with_capacity(light.values().len());
        for sums in light.values().chunks_exact(EACH) {
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
            let products = calm();
            Pair {
                fine,
                coarse,
                products,
            }
        };
        let pairs: Vec<Pair> = (0..8).map(pair).collect();
        let mut found = LevelCorrection::none(Family::Wool);
        let residual = solve(&pairs, &mut found);
        assert!(residual.before > 0.02, "{residual:?}");
        assert!(residual.after < 0.2 * residual.before, "{residual:?}");
        // Light that these pairs do not hold is corrected as well.
        let Pair { fine, coarse, .. } = pair(99);
        let off = |light: &Light| {
            let [fine, light] = [&fine, light].map(|light| light.values().chunks_exact(EACH));
            let pairs = fine.zip(light);
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
            products: calm(),
        });
        let none = LevelCorrection::none(Family::Wool);
        let mut found = none.clone();
        solve(&pairs, &mut found);
        assert_eq!(found, none);
        solve(&[], &mut found);
        assert_eq!(found, none);
    }
}
