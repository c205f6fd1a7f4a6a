//! Coarse levels that let through and send back as much light as level 0.
//!
//! Averaged voxels are not the cloth they stand for: gaps between yarns close, so less
//! light passes, and fibres no longer shade each other, so more comes back (Zhao 2012
//! §5.5 and Kettunen's survey of level-of-detail volumes name the same two). Each family
//! and coarseness has its correction, measured on white cloths of several weaves, sizes
//! and setts against their own level 0:
//!
//! - **density**: a voxel filled to φ loses the share c⁴/(φ⁴ + c⁴) of its extinction, so
//!   that rims, which averaging spreads into the gaps, get thin while the middle of a yarn
//!   stays dense: mean transmittance is kept and no yarn is seen through another. (An
//!   exponent, φ^γ, keeps the transmittance of coarse levels only where it thins whole
//!   yarns.)
//! - **spread**: how many times as far as averaging says the fibres of a voxel lean apart:
//!   on coarse levels the highlights of silk are too narrow without it.
//! - **gain**: what a fibre sends to the eye is multiplied by a short series, one for
//!   light scattered once and one for the rest (see [`series`]). How often it was
//!   counts most: averaging brightens light that is scattered a few times and not what is
//!   scattered often, so dark yarns err more than pale ones. Each *kind of block* has
//!   factors of its own for that.
//!
//! A picture is linear in the factors of the series, so they are fitted in one pass, for
//! all families together (see [`fit`] and [`solve`]), and kept in `presets/levels.ron`. The coarseness is how many
//! voxels of level 0 a voxel's side is long; between the measured ones the factors are
//! interpolated, from none at 1.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::design::Family;
use crate::exemplar::VoxelGrid;
use crate::render::Arrival;

pub mod fit;
pub mod series;
pub mod solve;

use series::{KINDS, OWN, TERMS, kind, terms};

/// A gain outside is not believed: the series is not meant to run away between the
/// directions that it was measured in.
const GAINS: std::ops::RangeInclusive<f32> = 0.4..=2.5;

/// The correction of one family at one coarseness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LevelCorrection {
    /// The yarns' family.
    pub family: Family,
    /// How many voxels of level 0 a voxel's side is long (geometric mean), above 1.
    pub ratio: f32,
    /// Fill c below which a voxel's extinction is thinned; 0 = none is.
    pub thin: f32,
    /// How many times as far as averaging says the fibres of a voxel lean apart.
    pub spread: f32,
    /// Series of the gain of light that was scattered once, and more often.
    pub gain: [[f32; TERMS]; 2],
    /// What is added to its first factors, by kind of place.
    pub kinds: [[[f32; OWN]; 2]; KINDS],
}

impl LevelCorrection {
    /// What changes nothing.
    pub const fn none(family: Family) -> Self {
        let mut one = [0.0; TERMS];
        one[0] = 1.0;
        Self {
            family,
            ratio: 1.0,
            thin: 0.0,
            spread: 1.0,
            gain: [one; 2],
            kinds: [[[0.0; OWN]; 2]; KINDS],
        }
    }

    /// The correction of a family on a grid; `None` for level 0, which stands for itself,
    /// and where nothing was measured.
    pub fn of(family: Family, grid: &VoxelGrid) -> Option<Self> {
        if grid.level == 0 {
            return None;
        }
        let [coarse, fine] = grid.voxel_um();
        Self::between(table(), family, coarse / fine)
    }

    /// What voxels of a coarseness need, between those of a table; `None` where it has
    /// none for the family.
    pub fn between(rows: &[Self], family: Family, ratio: f32) -> Option<Self> {
        let none = Self::none(family);
        let (mut below, mut above): (&Self, Option<&Self>) = (&none, None);
        for row in rows.iter().filter(|row| row.family == family) {
            if row.ratio <= ratio && below.ratio < row.ratio {
                below = row;
            }
            if row.ratio > ratio && above.is_none_or(|a| a.ratio > row.ratio) {
                above = Some(row);
            }
        }
        match above {
            Some(above) => {
                let t = (ratio / below.ratio).ln() / (above.ratio / below.ratio).ln();
                Some(Self::mixed(below, above, t.clamp(0.0, 1.0)))
            }
            None => (below.ratio > 1.0).then(|| below.clone()),
        }
    }

    fn mixed(a: &Self, b: &Self, t: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * t;
        Self {
            family: a.family,
            ratio: mix(a.ratio, b.ratio),
            thin: mix(a.thin, b.thin),
            spread: mix(a.spread, b.spread),
            gain: std::array::from_fn(|o| std::array::from_fn(|i| mix(a.gain[o][i], b.gain[o][i]))),
            kinds: std::array::from_fn(|k| {
                std::array::from_fn(|o| {
                    std::array::from_fn(|i| mix(a.kinds[k][o][i], b.kinds[k][o][i]))
                })
            }),
        }
    }

    /// What light is multiplied with that arrives so.
    #[inline]
    pub fn gain(&self, arrival: &Arrival) -> f32 {
        let order = usize::from(arrival.order > 1);
        let terms = terms(arrival);
        let sum = |factors: &[f32]| -> f32 { terms.iter().zip(factors).map(|(t, f)| t * f).sum() };
        let own = (self.kinds.get(kind(arrival))).map_or(0.0, |own| sum(&own[order]));
        (sum(&self.gain[order]) + own).clamp(*GAINS.start(), *GAINS.end())
    }

    /// Whether every number of it is one that may be used.
    fn is_sound(&self) -> bool {
        let factors = self.gain.iter().flatten();
        let own = self.kinds.iter().flatten().flatten();
        self.ratio > 1.0
            && (0.0..=1.0).contains(&self.thin)
            && (0.0..=2.0).contains(&self.spread)
            && factors.chain(own).all(|factor| factor.abs() < 2.0)
    }
}

/// The measured corrections.
pub fn table() -> &'static [LevelCorrection] {
    static TABLE: OnceLock<Vec<LevelCorrection>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let text = include_str!("../../../presets/levels.ron");
        let rows: Vec<LevelCorrection> = ron::from_str(text).unwrap_or_else(|error| {
            log::error!("presets/levels.ron: {error}");
            Vec::new()
        });
        (rows.into_iter())
            .filter(LevelCorrection::is_sound)
            .collect()
    })
}

/// How the voxels of a set's warp or weft are read.
#[derive(Clone)]
pub(super) struct Matter {
    /// Extinction (1/mm) by fill in 1/255: rising, 0 at 0.
    by_fill: Box<[f32; 256]>,
    /// How many times as far as they do the fibres of a voxel lean apart.
    pub spread: f32,
}

impl Matter {
    /// Of fibres whose extinction is `full` where a voxel is wholly filled, as the level
    /// is corrected.
    pub fn new(full: f32, correction: Option<&LevelCorrection>) -> Self {
        let (thin, spread) = correction.map_or((0.0, 1.0), |c| (c.thin.powi(4), c.spread));
        let by_fill = Box::new(std::array::from_fn(|fill| {
            let fill = fill as f32 / 255.0;
            let kept = if thin > 0.0 {
                fill.powi(4) / (fill.powi(4) + thin)
            } else {
                1.0
            };
            fill * kept * full
        }));
        Self { by_fill, spread }
    }

    /// Of a voxel of this fill.
    #[inline(always)]
    pub fn at(&self, fill: u8) -> f32 {
        self.by_fill[usize::from(fill)]
    }

    /// Of a voxel wholly filled.
    pub fn most(&self) -> f32 {
        self.at(255)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use glam::Vec3;

    use super::*;

    fn grid(block: usize, level: u32) -> VoxelGrid {
        VoxelGrid {
            block: [block, block, 8],
            voxel_mm: Vec3::splat(0.25 / block as f32),
            level,
        }
    }

    fn arrival(order: u32, z: f32, place: u32) -> Arrival {
        Arrival {
            order,
            optics: place,
            fibre: Vec3::X,
            alpha: 0.2,
            to_eye: Vec3::Z,
            to_light: Vec3::new((1.0 - z * z).sqrt(), 0.0, z),
        }
    }

    #[test]
    fn every_family_is_measured_and_level_zero_stands_for_itself() {
        for family in Family::ALL {
            let rows = || table().iter().filter(|row| row.family == family);
            assert!(rows().count() >= 3, "{family:?}");
            assert_eq!(LevelCorrection::of(family, &grid(44, 0)), None);
            // Half as fine, and as coarse as can be: more is thinned.
            let [half, coarse] = [24, 8].map(|side| LevelCorrection::of(family, &grid(side, 1)));
            assert!(half.unwrap().thin < coarse.unwrap().thin, "{family:?}");
            for row in rows() {
                let found = LevelCorrection::between(table(), family, row.ratio).unwrap();
                assert_eq!(found.gain, row.gain);
            }
            // Beyond the ends the nearest holds; finer than all, hardly anything.
            let far = LevelCorrection::between(table(), family, 1e4).unwrap();
            let near = LevelCorrection::between(table(), family, 1.0 + 1e-4).unwrap();
            assert!(far.ratio < 20.0 && near.thin < 1e-3);
        }
    }

    #[test]
    fn gains_stay_near_one_in_every_direction_at_every_place() {
        let (mut least, mut most) = (1.0f32, 1.0f32);
        for row in table() {
            for key in 0..32u8 {
                for place in series::places(key) {
                    for order in [1, 2, 3, 40] {
                        for step in 0..=10 {
                            let gain = row.gain(&arrival(order, step as f32 / 10.0, place));
                            assert!((0.5..2.0).contains(&gain), "{row:?} at {step}: {gain}");
                            (least, most) = (least.min(gain), most.max(gain));
                        }
                    }
                }
            }
        }
        assert!(least < 0.9 && most > 1.0, "a table that does something");
    }

    #[test]
    fn a_kind_has_its_own_gain() {
        let mut row = LevelCorrection::none(Family::Silk);
        row.kinds[6][0][0] = 0.25;
        let [crown, float] = [0b00001, 0b11001].map(|key| series::places(key)[1]);
        assert_eq!(row.gain(&arrival(1, 0.5, float)), 1.25);
        assert_eq!(row.gain(&arrival(2, 0.5, float)), 1.0);
        assert_eq!(row.gain(&arrival(1, 0.5, crown)), 1.0);
    }

    #[test]
    fn rims_are_thinned_and_middles_are_not() {
        let plain = Matter::new(80.0, None);
        let correction = LevelCorrection {
            thin: 0.3,
            ..LevelCorrection::none(Family::Cotton)
        };
        let thinned = Matter::new(80.0, Some(&correction));
        assert_eq!((plain.at(0), thinned.at(0), plain.most()), (0.0, 0.0, 80.0));
        for fill in 1..=255u8 {
            assert!(thinned.at(fill) > thinned.at(fill - 1));
            assert!(thinned.at(fill) < plain.at(fill));
        }
        assert!(thinned.at(26) < 0.02 * plain.at(26));
        assert!(thinned.at(153) > 0.9 * plain.at(153));
    }
}
