//! Finds the factors of the gains from what was measured.
//!
//! Linear least squares of relative errors over all lamps, albedos, weaves and levels
//! together: between its nodes a correction is interpolated, so a measurement at any
//! coarseness says something about the two nodes around it. A ridge pulls all factors to
//! "nothing changes", those of single kinds of block more than the common ones.

use nalgebra::{DMatrix, DVector};

use super::LevelCorrection;
use super::fit::{ALBEDOS, AZIMUTHS, EACH, Light, RINGS};
use super::series::{KINDS, OWN, TERMS};

/// Pull of the common factors and of those of a kind of block, as a share of the
/// measurements.
const RIDGE: [f64; 2] = [1e-4, 1e-3];
/// The terms that are the same from all directions come first; they are pulled less.
const OF_ORDERS: usize = 3;
/// Common factors, once and more often scattered, then those of the kinds.
const COMMON: usize = 2 * TERMS;
const FACTORS: usize = COMMON + KINDS * 2 * OWN;

/// Light of a cloth at some level and of the same cloth at level 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// How many voxels of level 0 a voxel's side is long.
    pub ratio: f32,
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

/// Puts into `nodes`, corrections by rising coarseness, the gains with which the coarse
/// lights are nearest to the fine ones.
pub fn solve(pairs: &[Pair], nodes: &mut [LevelCorrection]) -> Residual {
    let size = FACTORS * nodes.len();
    let mut normal = DMatrix::<f64>::zeros(size, size);
    let mut right = DVector::<f64>::zeros(size);
    let mut rows = Vec::new();
    for pair in pairs {
        let shares = shares(nodes, pair.ratio);
        for (index, (fine, coarse)) in pair.fine.each().zip(pair.coarse.each()).enumerate() {
            let wanted = plain(fine);
            if !(wanted > 0.0) {
                continue;
            }
            let weight = weight(index);
            let missing = weight * (1.0 - plain(coarse) / wanted);
            let row = row(coarse).map(|sum| weight * sum / wanted);
            rows.push((shares.clone(), row, missing));
        }
    }
    for (shares, row, missing) in &rows {
        let parts = || shares.iter().enumerate().filter(|(_, share)| **share > 0.0);
        for (a, share_a) in parts() {
            for (i, x) in row.iter().enumerate() {
                right[a * FACTORS + i] += share_a * x * missing;
                for (b, share_b) in parts() {
                    let both = share_a * share_b * x;
                    for (j, y) in row.iter().enumerate() {
                        normal[(a * FACTORS + i, b * FACTORS + j)] += both * y;
                    }
                }
            }
        }
    }
    let measurements = rows.len() as f64 / nodes.len().max(1) as f64;
    for i in 0..size {
        let pull = match i % FACTORS {
            first if first < COMMON && first % TERMS < OF_ORDERS => 0.1 * RIDGE[0],
            common if common < COMMON => RIDGE[0],
            _ => RIDGE[1],
        };
        normal[(i, i)] += pull * measurements.max(1.0);
    }
    let found = (normal.cholesky()).map_or_else(|| DVector::zeros(size), |f| f.solve(&right));
    let mut squares = [0.0; 2];
    for (shares, row, missing) in &rows {
        let made: f64 = (shares.iter().enumerate())
            .map(|(node, share)| {
                let factors = found.rows(node * FACTORS, FACTORS);
                share
                    * row
                        .iter()
                        .zip(factors.iter())
                        .map(|(x, f)| x * f)
                        .sum::<f64>()
            })
            .sum();
        squares[0] += missing * missing;
        squares[1] += (missing - made).powi(2);
    }
    for (node, correction) in nodes.iter_mut().enumerate() {
        put(correction, found.rows(node * FACTORS, FACTORS).as_slice());
    }
    let [before, after] = squares.map(|sum| (sum / rows.len().max(1) as f64).sqrt());
    Residual { before, after }
}

/// How much of each node's correction a coarseness takes; see [`LevelCorrection::of`].
fn shares(nodes: &[LevelCorrection], ratio: f32) -> Vec<f64> {
    let place = |ratio: f32| f64::from(ratio.max(1.0)).ln();
    let at = |node: usize| place(nodes[node].ratio);
    let ratio = place(ratio);
    (0..nodes.len())
        .map(|node| {
            let before = if node == 0 { 0.0 } else { at(node - 1) };
            if ratio <= at(node) {
                ((ratio - before) / (at(node) - before)).clamp(0.0, 1.0)
            } else if node + 1 < nodes.len() {
                ((at(node + 1) - ratio) / (at(node + 1) - at(node))).clamp(0.0, 1.0)
            } else {
                1.0
            }
        })
        .collect()
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

/// What each factor multiplies.
fn row(sums: &[f64]) -> [f64; FACTORS] {
    debug_assert_eq!(sums.len(), EACH);
    let mut row = [0.0; FACTORS];
    for (i, &sum) in sums.iter().enumerate() {
        let (kind, order, term) = (i / TERMS / 2, i / TERMS % 2, i % TERMS);
        row[order * TERMS + term] += sum;
        if term < OWN {
            row[COMMON + (kind * 2 + order) * OWN + term] = sum;
        }
    }
    row
}

/// Puts a node's factors where they belong; what is no number changes nothing.
fn put(correction: &mut LevelCorrection, found: &[f64]) {
    let none = LevelCorrection::none(correction.family);
    let change = |i: usize| (found[i] as f32).clamp(-1.9, 0.9);
    let finite = |i: usize| if found[i].is_finite() { change(i) } else { 0.0 };
    for order in 0..2 {
        for term in 0..TERMS {
            let factor = none.gain[order][term] + finite(order * TERMS + term);
            correction.gain[order][term] = factor;
        }
        for kind in 0..KINDS {
            for term in 0..OWN {
                let factor = finite(COMMON + (kind * 2 + order) * OWN + term);
                correction.kinds[kind][order][term] = factor;
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
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

    fn nodes() -> Vec<LevelCorrection> {
        [2.0, 6.0]
            .map(|ratio| LevelCorrection {
                ratio,
                ..LevelCorrection::none(Family::Wool)
            })
            .into()
    }

    /// The same light with a gain on it, all in one number a lamp.
    fn gained(light: &Light, gain: &LevelCorrection) -> Light {
        let mut values = Vec::with_capacity(light.values().len());
        for sums in light.each() {
            let mut sum = 0.0;
            for (i, value) in sums.iter().enumerate() {
                let (kind, order, term) = (i / TERMS / 2, i / TERMS % 2, i % TERMS);
                let mut factor = gain.gain[order][term];
                if term < OWN {
                    factor += gain.kinds[kind][order][term];
                }
                sum += value * f64::from(factor);
            }
            let mut one = vec![0.0; EACH];
            one[0] = sum;
            values.extend(one);
        }
        Light::from_values(values).unwrap()
    }

    #[test]
    fn a_known_gain_is_found_again_between_its_nodes() {
        let mut wanted = LevelCorrection::none(Family::Wool);
        for (term, factor) in [
            (0, 0.9),
            (2, 0.1),
            (3, -0.1),
            (5, 0.15),
            (8, 0.1),
            (11, 0.1),
        ] {
            wanted.gain[0][term] = factor;
        }
        wanted.gain[1][0] = 1.1;
        wanted.kinds[6][0][0] = 0.2;
        let pairs: Vec<Pair> = (0..40)
            .map(|seed| {
                let coarse = light(seed);
                let fine = gained(&coarse, &wanted);
                let ratio = 2.0 + (seed % 5) as f32;
                Pair {
                    ratio,
                    fine,
                    coarse,
                }
            })
            .collect();
        let mut nodes = nodes();
        let residual = solve(&pairs, &mut nodes);
        assert!(residual.before > 0.02, "{residual:?}");
        assert!(residual.after < 0.5 * residual.before, "{residual:?}");
        // Light that these pairs do not hold is corrected as well.
        let coarse = light(99);
        let fine = gained(&coarse, &wanted);
        let both = LevelCorrection::between(&nodes, Family::Wool, None, 3.0).unwrap();
        let off = |light: &Light| {
            let pairs = fine.each().zip(light.each());
            let errors = pairs.map(|(a, b)| (plain(b) / a[0] - 1.0).powi(2));
            errors.sum::<f64>().sqrt()
        };
        assert!(off(&gained(&coarse, &both)) < 0.6 * off(&coarse));
    }

    #[test]
    fn equal_light_needs_no_gain_and_no_light_gives_none() {
        let fine = light(4);
        let pairs = [(2.0, fine.clone()), (3.0, Light::dark())].map(|(ratio, fine)| Pair {
            ratio,
            coarse: fine.clone(),
            fine,
        });
        let mut found = nodes();
        solve(&pairs, &mut found);
        assert_eq!(found, nodes());
        solve(&[], &mut found);
        assert_eq!(found, nodes());
    }

    #[test]
    fn shares_are_those_of_the_interpolation() {
        for ratio in [1.0, 1.3, 2.0, 3.0, 5.9, 6.0, 20.0] {
            let mut nodes = nodes();
            nodes[0].thin = 0.25;
            nodes[1].thin = 0.5;
            let shares = shares(&nodes, ratio);
            let thin = 0.25 * shares[0] + 0.5 * shares[1];
            let found = LevelCorrection::between(&nodes, Family::Wool, None, ratio);
            let expected = found.map_or(0.0, |found| f64::from(found.thin));
            assert!(
                (thin - expected).abs() < 1e-5,
                "{ratio}: {thin}, {expected}"
            );
        }
    }
}
