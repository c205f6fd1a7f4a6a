//! What a yarn is made of: fibres, plies, twist, irregularity.

use serde::{Deserialize, Serialize};

use crate::design::Family;

/// Why a recipe cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RecipeError {
    /// A size is not a positive, finite number.
    #[error("the {what} of the {family:?} recipe is {value}; give a positive number")]
    Size {
        /// Which size.
        what: &'static str,
        /// Which recipe.
        family: Family,
        /// What it was.
        value: f32,
    },
}

/// A yarn as a spinner would describe it. Lengths in mm unless the name says otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct YarnRecipe {
    /// Family the recipe belongs to.
    pub family: Family,
    /// Yarn diameter, mm.
    pub diameter_mm: f32,
    /// Fibre diameter, µm.
    pub fibre_um: f32,
    /// Number of plies twisted together (1 = singles or filament).
    pub plies: u32,
    /// Twist of the singles, turns a metre, positive = Z.
    pub singles_twist: f32,
    /// Twist of the plies round each other, turns a metre, positive = Z.
    pub ply_twist: f32,
    /// Share of the yarn's cross-section that is fibre, 0..1.
    pub packing: f32,
    /// How far fibres wander across the section, in yarn radii.
    pub migration: f32,
    /// Share of the outermost fibres that stand off the surface inside a crossing.
    pub looseness: f32,
    /// Relative irregularity of thickness.
    pub unevenness: f32,
    /// How far the twist runs ahead or behind inside a crossing, turns.
    pub twist_unevenness: f32,
    /// Width over height where yarns cross.
    pub crossing_aspect: f32,
    /// Width over height in the middle of a float.
    pub float_aspect: f32,
    /// How far the middle of a float rises, in yarn radii.
    pub float_bulge: f32,
    /// Flyaway hairs a mm of yarn.
    pub hairs_per_mm: f32,
    /// Shortest and longest hair, mm.
    pub hair_length_mm: [f32; 2],
}

impl YarnRecipe {
    /// The usual yarn of a family at a given diameter (mm). Numbers: usual ranges of
    /// counts, twist and hairiness of each fibre; twist follows t = K/√tex.
    pub fn family(family: Family, diameter_mm: f32) -> Self {
        let base = match family {
            Family::Cotton => Self {
                family,
                diameter_mm,
                fibre_um: 12.5,
                plies: 2,
                singles_twist: 900.0,
                ply_twist: -600.0,
                packing: 0.55,
                migration: 0.10,
                looseness: 0.35,
                unevenness: 0.07,
                twist_unevenness: 0.035,
                crossing_aspect: 1.45,
                float_aspect: 1.3,
                float_bulge: 0.22,
                hairs_per_mm: 5.0,
                hair_length_mm: [0.25, 1.6],
            },
            Family::Silk => Self {
                family,
                diameter_mm,
                fibre_um: 11.0,
                plies: 1,
                singles_twist: 120.0,
                ply_twist: 0.0,
                packing: 0.7,
                migration: 0.09,
                looseness: 0.0,
                unevenness: 0.03,
                twist_unevenness: 0.006,
                crossing_aspect: 1.9,
                float_aspect: 1.7,
                float_bulge: 0.3,
                hairs_per_mm: 0.05,
                hair_length_mm: [0.3, 1.0],
            },
            Family::Wool => Self {
                family,
                diameter_mm,
                fibre_um: 21.0,
                plies: 2,
                singles_twist: 420.0,
                ply_twist: -300.0,
                packing: 0.42,
                migration: 0.17,
                looseness: 0.6,
                unevenness: 0.08,
                twist_unevenness: 0.04,
                crossing_aspect: 1.4,
                float_aspect: 1.25,
                float_bulge: 0.25,
                hairs_per_mm: 11.0,
                hair_length_mm: [0.8, 4.0],
            },
            Family::Linen => Self {
                family,
                diameter_mm,
                fibre_um: 18.0,
                plies: 1,
                singles_twist: 480.0,
                ply_twist: 0.0,
                packing: 0.6,
                migration: 0.10,
                looseness: 0.2,
                unevenness: 0.14,
                twist_unevenness: 0.03,
                crossing_aspect: 1.5,
                float_aspect: 1.35,
                float_bulge: 0.15,
                hairs_per_mm: 3.0,
                hair_length_mm: [0.4, 1.8],
            },
        };
        // The families' numbers are for their usual yarns; thinner yarns are twisted more.
        let usual = match family {
            Family::Cotton => 0.25,
            Family::Silk => 0.11,
            Family::Wool => 0.40,
            Family::Linen => 0.26,
        };
        let twist = (usual / diameter_mm.max(1e-3)).clamp(0.25, 4.0);
        Self {
            singles_twist: base.singles_twist * twist,
            ply_twist: base.ply_twist * twist,
            ..base
        }
    }

    /// Checks that every size is usable.
    ///
    /// # Errors
    /// [`RecipeError::Size`] names the first one that is not.
    pub fn check(&self) -> Result<(), RecipeError> {
        let sizes = [
            ("diameter", self.diameter_mm),
            ("fibre diameter", self.fibre_um),
            ("packing", self.packing),
            ("crossing aspect", self.crossing_aspect),
            ("float aspect", self.float_aspect),
        ];
        for (what, value) in sizes {
            if !(value.is_finite() && value > 0.0) {
                return Err(RecipeError::Size {
                    what,
                    family: self.family,
                    value,
                });
            }
        }
        Ok(())
    }

    /// Fibres in a cross-section: packing × (yarn diameter / fibre diameter)².
    pub fn fibres(&self) -> u32 {
        let ratio = self.diameter_mm * 1000.0 / self.fibre_um;
        ((self.packing * ratio * ratio).round() as u32).clamp(6, 4000)
    }

    /// Extinction of a voxel wholly inside fibre, across it: 4/(π d), 1/mm.
    pub fn full_extinction(&self) -> f32 {
        4.0 / (std::f32::consts::PI * self.fibre_um * 1e-3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thicker_yarn_has_more_fibres_not_thicker_ones() {
        let (thin, thick) = (
            YarnRecipe::family(Family::Cotton, 0.2),
            YarnRecipe::family(Family::Cotton, 0.4),
        );
        assert_eq!(thin.fibre_um, thick.fibre_um);
        assert!((thick.fibres() as f32 / thin.fibres() as f32 - 4.0).abs() < 0.05);
    }

    #[test]
    fn extinction_of_packed_cotton_is_the_textbook_value() {
        let cotton = YarnRecipe {
            fibre_um: 12.0,
            ..YarnRecipe::family(Family::Cotton, 0.25)
        };
        assert!((cotton.full_extinction() * 0.55 - 58.0).abs() < 1.0);
    }

    #[test]
    fn bad_sizes_are_named() {
        for value in [f32::NAN, f32::INFINITY, 0.0, -1.0] {
            let recipe = YarnRecipe {
                diameter_mm: value,
                ..YarnRecipe::family(Family::Wool, 0.4)
            };
            assert!(recipe.check().unwrap_err().to_string().contains("diameter"));
        }
        assert_eq!(YarnRecipe::family(Family::Wool, 0.4).check(), Ok(()));
    }
}
