//! Yarns: colour, gloss, size and family.

use serde::{Deserialize, Serialize};

/// Index of a yarn in a design's yarn list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct YarnId(pub u16);

/// An 8-bit sRGB colour, as the designer picked it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Srgb(pub u8, pub u8, pub u8);

/// The families of yarn whose recipes are built in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Family {
    /// Ring-spun two-ply cotton.
    Cotton,
    /// Silk filament.
    Silk,
    /// Worsted two-ply wool.
    Wool,
    /// Wet-spun linen.
    Linen,
}

/// One yarn of a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Yarn {
    /// What the designer calls it.
    pub name: String,
    /// The colour thick cloth of this yarn shows.
    pub colour: Srgb,
    /// Uncoloured surface share F of the reflected light, 0..=1.
    pub surface_share: f32,
    /// SGGX roughness α of the fibres, 0.01..=1; `None` = the family's own.
    pub gloss: Option<f32>,
    /// Diameter in mm; `None` = from the count, or the family's usual one.
    pub diameter_mm: Option<f32>,
    /// Linear density in tex of the whole (plied) yarn; `None` = the family's usual one.
    pub tex: Option<f32>,
    /// What it is made of.
    pub family: Family,
}
