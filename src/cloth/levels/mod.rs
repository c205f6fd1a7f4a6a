//! Coarse levels that let through and send back as much light as level 0.
//!
//! Averaged voxels are not the cloth they stand for: gaps between fibres close, so less
//! light passes, and fibres no longer shade each other, so more comes back (Zhao 2012
//! §5.5 and Kettunen's survey of level-of-detail volumes name the same two). Each family
//! and voxel size has two corrections, measured on plain weave, twill and satin against
//! level 0:
//!
//! - **density**: a voxel filled to φ has the extinction of φ^γ, γ ≥ 1, so that thin rims
//!   get thinner while yarns stay opaque and mean transmittance is kept;
//! - **gain**: what a fibre sends to the eye is multiplied by a short series in the angle
//!   of the light over the cloth and of the half vector along the fibre, one series for
//!   light scattered once and one for the rest.
//!
//! Both are linear or monotone in what they correct, so they are fitted in one pass (see
//! [`fit`]) and kept in `presets/levels.ron`; between the measured voxel sizes they are
//! interpolated.

use std::sync::OnceLock;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::design::Family;
use crate::exemplar::VoxelGrid;
use crate::render::Arrival;

pub mod fit;

/// Terms of a gain's series.
pub const TERMS: usize = 5;

/// The coarsest level that is corrected. Beyond it the exponents that keep the
/// transmittance would let the lower yarn be seen through the upper one.
pub const COARSEST: u32 = 2;

/// A gain outside is not believed: the series is not meant to run away between the
/// directions that it was measured in.
const GAINS: std::ops::RangeInclusive<f32> = 0.4..=2.5;

/// The correction of one family at one voxel size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LevelCorrection {
    /// The yarns' family.
    pub family: Family,
    /// Geometric mean of a voxel's sides, µm.
    pub voxel_um: f32,
    /// Exponent γ of the fill.
    pub gamma: f32,
    /// Gain of light that was scattered once.
    pub single: [f32; TERMS],
    /// Gain of light that was scattered more often.
    pub multiple: [f32; TERMS],
}

impl LevelCorrection {
    /// What changes nothing.
    pub const fn none(family: Family, voxel_um: f32) -> Self {
        let mut one = [0.0; TERMS];
        one[0] = 1.0;
        Self {
            family,
            voxel_um,
            gamma: 1.0,
            single: one,
            multiple: one,
        }
    }

    /// The correction of a family on a grid; `None` for level 0, which stands for itself,
    /// beyond [`COARSEST`], and where nothing was measured. Where level 0 is itself coarser
    /// than the voxels that the table starts from, what it would need is taken off.
    pub fn of(family: Family, grid: &VoxelGrid) -> Option<Self> {
        if grid.level == 0 || grid.level > COARSEST {
            return None;
        }
        let [coarse, fine] = grid.voxel_um();
        let (coarse, fine) = (Self::at(family, coarse)?, Self::at(family, fine)?);
        let one = Self::none(family, coarse.voxel_um);
        let over = |coarse: [f32; TERMS], fine: [f32; TERMS], one: [f32; TERMS]| {
            std::array::from_fn(|i| coarse[i] - fine[i] + one[i])
        };
        Some(Self {
            gamma: coarse.gamma / fine.gamma,
            single: over(coarse.single, fine.single, one.single),
            multiple: over(coarse.multiple, fine.multiple, one.multiple),
            ..one
        })
    }

    /// What voxels of a size need, between the measured sizes.
    fn at(family: Family, voxel_um: f32) -> Option<Self> {
        let own = table().iter().filter(|row| row.family == family);
        let (mut below, mut above): (Option<&Self>, Option<&Self>) = (None, None);
        for row in own {
            if row.voxel_um <= voxel_um && below.is_none_or(|b| b.voxel_um < row.voxel_um) {
                below = Some(row);
            }
            if row.voxel_um > voxel_um && above.is_none_or(|a| a.voxel_um > row.voxel_um) {
                above = Some(row);
            }
        }
        match (below, above) {
            (Some(a), Some(b)) => {
                let t = (voxel_um / a.voxel_um).ln() / (b.voxel_um / a.voxel_um).ln();
                Some(Self::mixed(a, b, t.clamp(0.0, 1.0)))
            }
            (Some(end), None) | (None, Some(end)) => Some(*end),
            (None, None) => None,
        }
    }

    fn mixed(a: &Self, b: &Self, t: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * t;
        Self {
            family: a.family,
            voxel_um: mix(a.voxel_um, b.voxel_um),
            gamma: mix(a.gamma, b.gamma),
            single: std::array::from_fn(|i| mix(a.single[i], b.single[i])),
            multiple: std::array::from_fn(|i| mix(a.multiple[i], b.multiple[i])),
        }
    }

    /// What light is multiplied with that arrives so.
    #[inline]
    pub fn gain(&self, arrival: &Arrival) -> f32 {
        let series = if arrival.order > 1 {
            &self.multiple
        } else {
            &self.single
        };
        let terms = terms(arrival);
        let gain = (terms.iter().zip(series)).fold(0.0, |sum, (term, factor)| sum + term * factor);
        gain.clamp(*GAINS.start(), *GAINS.end())
    }
}

/// The terms of the series: how low the light stands over the cloth, and how far the half
/// vector leans along the fibre (0: a mirror's direction).
#[inline]
pub fn terms(arrival: &Arrival) -> [f32; TERMS] {
    let low = 1.0 - arrival.to_light.z.abs().min(1.0);
    let half = (arrival.to_eye + arrival.to_light).normalize_or(Vec3::Z);
    let lean = half.dot(arrival.fibre).powi(2);
    [1.0, low, low * low, lean, low * lean]
}

/// The measured corrections.
pub fn table() -> &'static [LevelCorrection] {
    static TABLE: OnceLock<Vec<LevelCorrection>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let text = include_str!("../../../presets/levels.ron");
        let rows: Vec<LevelCorrection> = ron::from_str(text).unwrap_or_default();
        (rows.into_iter())
            .filter(|row| row.voxel_um > 0.0 && row.gamma >= 0.1)
            .collect()
    })
}

/// Extinction (1/mm) by fill in 1/255: rising, 0 at 0.
#[derive(Clone)]
pub(super) struct Extinction(Box<[f32; 256]>);

impl Extinction {
    /// Of matter whose extinction is `full` where a voxel is wholly filled; γ = 1 corrects
    /// nothing.
    pub fn new(full: f32, gamma: f32) -> Self {
        Self(Box::new(std::array::from_fn(|fill| {
            (fill as f32 / 255.0).powf(gamma) * full
        })))
    }

    /// Of a voxel of this fill.
    #[inline(always)]
    pub fn at(&self, fill: u8) -> f32 {
        self.0[usize::from(fill)]
    }

    /// Of a voxel wholly filled.
    pub fn most(&self) -> f32 {
        self.at(255)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn grid(voxel_um: f32, level: u32) -> VoxelGrid {
        VoxelGrid {
            block: [8, 8, 8],
            voxel_mm: Vec3::splat(voxel_um / 1000.0),
            level,
        }
    }

    #[test]
    fn every_family_is_measured_and_level_zero_stands_for_itself() {
        for family in Family::ALL {
            let rows = table().iter().filter(|row| row.family == family);
            assert!(rows.count() >= 3, "{family:?}");
            assert_eq!(LevelCorrection::of(family, &grid(5.0, 0)), None);
            assert_eq!(LevelCorrection::of(family, &grid(40.0, 3)), None);
            for row in table().iter().filter(|row| row.family == family) {
                let found = LevelCorrection::of(family, &grid(row.voxel_um, 1)).unwrap();
                assert!((found.gamma - row.gamma).abs() < 1e-3, "{row:?} {found:?}");
            }
            // Beyond the ends the nearest holds.
            let far = LevelCorrection::of(family, &grid(1e4, 2)).unwrap();
            assert!(far.gain(&arrival(1, 0.7)).is_finite());
        }
    }

    fn arrival(order: u32, z: f32) -> Arrival {
        Arrival {
            order,
            optics: 0,
            fibre: Vec3::X,
            to_eye: Vec3::Z,
            to_light: Vec3::new((1.0 - z * z).sqrt(), 0.0, z),
        }
    }

    #[test]
    fn gains_stay_near_one_in_every_direction() {
        for row in table() {
            for order in [1, 2] {
                for step in 0..=20 {
                    let gain = row.gain(&arrival(order, step as f32 / 20.0));
                    assert!((0.5..2.0).contains(&gain), "{row:?} at {step}: {gain}");
                }
            }
        }
    }

    #[test]
    fn extinction_rises_with_the_fill_and_keeps_its_ends() {
        let plain = Extinction::new(80.0, 1.0);
        let thinned = Extinction::new(80.0, 1.3);
        assert_eq!((plain.at(0), thinned.at(0)), (0.0, 0.0));
        assert_eq!((plain.most(), thinned.most()), (80.0, 80.0));
        for fill in 1..255u8 {
            assert!(thinned.at(fill) > thinned.at(fill - 1));
            assert!(thinned.at(fill) < plain.at(fill));
        }
    }
}
