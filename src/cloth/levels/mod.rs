//! Coarse levels that let through and send back as much light as level 0.
//!
//! Averaged voxels are not the cloth they stand for: gaps between yarns close, so less
//! light passes, and fibres no longer shade each other, so more comes back (Zhao 2012
//! §5.5 and Kettunen's survey of level-of-detail volumes name the same two). Each family,
//! and each set of exemplars that was measured, has its correction at each coarseness,
//! found against its own level 0:
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
//!   factors of its own for that, and for the side that the light comes from; and warp and
//!   weft have a gain each: where one of them is nearly black, all light is the other's.
//!   Averaged voxels also pass more light from the one to the other: light that both
//!   scattered has terms of its own.
//!
//! The first two hold for a family. The gain hangs on how the yarns lie: highlights of
//! silk come from slopes that differ from sett to sett, and the gain of one is no gain for
//! another. So it is kept by the sizes of the exemplars it was measured on, those of the
//! presets; others have the first two alone. A picture is linear in the factors of the
//! series, so they are found in one pass (see [`fit`] and [`solve`]) and kept in
//! `presets/levels.ron`. The coarseness is how many voxels of level 0 a voxel's side is
//! long; between the measured ones the factors are interpolated, from none at 1.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::design::Family;
use crate::exemplar::ExemplarSet;

pub mod fit;
mod gain;
pub mod series;
pub mod solve;

pub use gain::{FACTORS, Gain};

/// The sizes of a set of exemplars whose yarns are of one family.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sizes {
    /// Diameters of the warp's and the weft's yarn, mm.
    pub diameters_mm: [f32; 2],
    /// Spacing of ends and of picks, mm.
    pub pitch_mm: [f32; 2],
}

impl Sizes {
    /// Sizes within this share of each other are the same: exemplars are built for sizes
    /// rounded to 5 %.
    const SAME: f32 = 0.03;

    /// Those of a set; `None` where warp and weft are of two families.
    pub fn of(set: &ExemplarSet) -> Option<Self> {
        let pair = &set.pair;
        (pair.warp.family == pair.weft.family).then(|| Self {
            diameters_mm: [pair.warp.diameter_mm, pair.weft.diameter_mm],
            pitch_mm: set.grid.pitch().to_array(),
        })
    }

    fn same(&self, other: &Self) -> bool {
        let all = |sizes: &Self| {
            let [[a, b], [c, d]] = [sizes.diameters_mm, sizes.pitch_mm];
            [a, b, c, d]
        };
        let pairs = all(self).into_iter().zip(all(other));
        pairs
            .into_iter()
            .all(|(a, b)| (a - b).abs() <= Self::SAME * b)
    }
}

/// The correction of one family at one coarseness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LevelCorrection {
    /// The yarns' family.
    pub family: Family,
    /// The exemplars that it was measured on and is for; `None`: any of the family.
    pub sizes: Option<Sizes>,
    /// How many voxels of level 0 a voxel's side is long (geometric mean), above 1.
    pub ratio: f32,
    /// Fill c below which a voxel's extinction is thinned; 0 = none is.
    pub thin: f32,
    /// How many times as far as averaging says the fibres of a voxel lean apart.
    pub spread: f32,
    /// Of the light of the warp and of the weft.
    pub gains: [Gain; 2],
    /// What is left with them: root mean square over lamps and albedos of how far light is
    /// off level 0's, as a share of it, with the noise of measuring it. `None`: not
    /// measured.
    #[serde(default)]
    pub residual: Option<f32>,
}

impl LevelCorrection {
    /// What changes nothing.
    pub const fn none(family: Family) -> Self {
        Self {
            family,
            sizes: None,
            ratio: 1.0,
            thin: 0.0,
            spread: 1.0,
            gains: [Gain::NONE; 2],
            residual: None,
        }
    }

    /// The correction of a family's yarns in a set, its own where it was measured; `None`
    /// for level 0, which stands for itself, and where nothing was measured.
    pub fn of(family: Family, set: &ExemplarSet) -> Option<Self> {
        if set.grid.level == 0 {
            return None;
        }
        let [coarse, fine] = set.grid.voxel_um();
        let sizes = Sizes::of(set);
        Self::between(table(), family, sizes.as_ref(), coarse / fine)
    }

    /// What voxels of a coarseness need, between those of a table: of the rows for these
    /// sizes, or where there are none of those for any; `None` where it has none for the
    /// family.
    pub fn between(
        rows: &[Self],
        family: Family,
        sizes: Option<&Sizes>,
        ratio: f32,
    ) -> Option<Self> {
        let own = |row: &&Self| match (&row.sizes, sizes) {
            (Some(measured), Some(sizes)) => row.family == family && measured.same(sizes),
            _ => false,
        };
        let measured = rows.iter().any(|row| own(&row));
        let none = Self::none(family);
        let (mut below, mut above): (&Self, Option<&Self>) = (&none, None);
        for row in rows.iter().filter(|row| match measured {
            true => own(row),
            false => row.family == family && row.sizes.is_none(),
        }) {
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
            sizes: b.sizes,
            ratio: mix(a.ratio, b.ratio),
            thin: mix(a.thin, b.thin),
            spread: mix(a.spread, b.spread),
            gains: std::array::from_fn(|yarn| a.gains[yarn].mixed(&b.gains[yarn], t)),
            residual: b.residual.map(|b| mix(a.residual.unwrap_or(0.0), b)),
        }
    }

    /// Whether every number of it is one that may be used.
    fn is_sound(&self) -> bool {
        self.ratio > 1.0
            && (0.0..=1.0).contains(&self.thin)
            && (0.0..=2.0).contains(&self.spread)
            && (self.residual).is_none_or(|residual| (0.0..1.0).contains(&residual))
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
    /// Which correction its light gets, as bits of [`crate::render::PLACE`].
    pub corrected: u32,
}

impl Matter {
    /// Of fibres whose extinction is `full` where a voxel is wholly filled, as the level
    /// is corrected; `corrected` as [`series::correction`] reads it.
    pub fn new(full: f32, correction: Option<&LevelCorrection>, corrected: u32) -> Self {
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
        Self {
            by_fill,
            spread,
            corrected,
        }
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
    use crate::exemplar::{Pair, VoxelGrid};
    use crate::render::Arrival;
    use crate::synthesis::Catalogue;
    use crate::yarn::YarnRecipe;

    /// A set of yarns of 0.2 mm on blocks of so many voxels a side.
    fn set(family: Family, block: usize, level: u32) -> ExemplarSet {
        let grid = VoxelGrid {
            block: [block, block, 8],
            voxel_mm: Vec3::splat(0.25 / block as f32),
            level,
        };
        let yarn = YarnRecipe::family(family, 0.2);
        let pair = Pair {
            warp: yarn.clone(),
            weft: yarn,
        };
        ExemplarSet::new(&Catalogue::standard(), &pair, grid).unwrap()
    }

    fn arrival(order: u32, z: f32, place: u32) -> Arrival {
        Arrival {
            order,
            mixed: false,
            optics: place,
            fibre: Vec3::X,
            alpha: 0.2,
            to_eye: Vec3::Z,
            to_light: Vec3::new((1.0 - z * z).sqrt(), 0.0, z),
        }
    }

    #[test]
    fn every_family_is_measured_and_level_zero_stands_for_itself() {
        for &family in Family::ALL {
            let rows = || table().iter().filter(|row| row.family == family);
            assert!(rows().count() >= 3, "{family:?}");
            assert_eq!(LevelCorrection::of(family, &set(family, 44, 0)), None);
            // Half as fine, and as coarse as can be: more is thinned.
            let [half, coarse] =
                [24, 8].map(|side| LevelCorrection::of(family, &set(family, side, 1)).unwrap());
            assert!(half.thin < coarse.thin, "{family:?}");
            for row in rows() {
                let of = |ratio| {
                    LevelCorrection::between(table(), family, row.sizes.as_ref(), ratio).unwrap()
                };
                let found = of(row.ratio);
                assert_eq!(found.gains, row.gains);
                // The light of exemplars that were measured is right to a few per cent.
                assert_eq!(found.residual, row.residual);
                assert_eq!(row.residual.is_some(), row.sizes.is_some());
                assert!(
                    row.residual.is_none_or(|residual| residual < 0.03),
                    "{row:?}"
                );
                // Beyond the ends the nearest holds; finer than all, hardly anything.
                assert!(of(1e4).ratio < 20.0 && of(1.0 + 1e-4).thin < 1e-3);
            }
        }
    }

    #[test]
    fn gains_stay_near_one_in_nearly_every_direction_at_every_place() {
        let (mut all, mut far, mut sum) = (0u32, 0u32, 0.0);
        for row in table().iter().filter(|row| row.sizes.is_some()) {
            for place in (0..32).flat_map(series::places) {
                for (order, step) in (0..44).map(|i| ([1, 2, 3, 40][i % 4], i / 4)) {
                    for gain in &row.gains {
                        let arrival = arrival(order, step as f32 / 10.0, place);
                        let gain = gain.at(&Arrival {
                            mixed: order > 1 && step % 2 == 0,
                            ..arrival
                        });
                        assert!(gain::GAINS.contains(&gain), "{row:?} at {step}: {gain}");
                        far += u32::from(!(0.6..1.6).contains(&gain));
                        (all, sum) = (all + 1, sum + f64::from(gain.ln().abs()));
                    }
                }
            }
        }
        let mean = sum / f64::from(all);
        assert!(
            (0.02..0.2).contains(&mean),
            "a table that does something: {mean}"
        );
        assert!(far < all / 20, "{far} of {all}");
    }

    #[test]
    fn exemplars_that_were_measured_have_their_own_correction() {
        let sizes = Sizes {
            diameters_mm: [0.2, 0.3],
            pitch_mm: [0.25, 0.3],
        };
        let row = |sizes, thin| LevelCorrection {
            sizes,
            thin,
            ratio: 4.0,
            ..LevelCorrection::none(Family::Linen)
        };
        let rows = [row(None, 0.2), row(Some(sizes), 0.4)];
        let thin = |family, sizes: Option<&Sizes>| {
            LevelCorrection::between(&rows, family, sizes, 4.0).map(|row| row.thin)
        };
        assert_eq!(thin(Family::Linen, Some(&sizes)), Some(0.4));
        assert_eq!(thin(Family::Linen, None), Some(0.2));
        assert_eq!(thin(Family::Wool, Some(&sizes)), None);
        let [mut near, mut other] = [sizes; 2];
        near.pitch_mm[1] *= 1.02;
        other.diameters_mm[0] *= 1.05;
        assert_eq!(thin(Family::Linen, Some(&near)), Some(0.4));
        assert_eq!(thin(Family::Linen, Some(&other)), Some(0.2));
    }

    #[test]
    fn a_kind_has_its_own_gain() {
        let mut factors = [0.0; FACTORS];
        factors[gain::first_factors(6, 0)[1]] = 0.25;
        let gain = Gain::new(&factors).unwrap();
        let [crown, float] = [0b00001, 0b11001].map(|key| series::places(key)[1]);
        assert_eq!(gain.at(&arrival(1, 0.5, float)), 1.25);
        assert_eq!(gain.at(&arrival(2, 0.5, float)), 1.0);
        assert_eq!(gain.at(&arrival(1, 0.5, crown)), 1.0);
    }

    #[test]
    fn rims_are_thinned_and_middles_are_not() {
        let plain = Matter::new(80.0, None, 0);
        let correction = LevelCorrection {
            thin: 0.3,
            ..LevelCorrection::none(Family::Cotton)
        };
        let thinned = Matter::new(80.0, Some(&correction), 0);
        assert_eq!((plain.at(0), thinned.at(0), plain.most()), (0.0, 0.0, 80.0));
        for fill in 1..=255u8 {
            assert!(thinned.at(fill) > thinned.at(fill - 1));
            assert!(thinned.at(fill) < plain.at(fill));
        }
        assert!(thinned.at(26) < 0.02 * plain.at(26));
        assert!(thinned.at(153) > 0.9 * plain.at(153));
    }
}
