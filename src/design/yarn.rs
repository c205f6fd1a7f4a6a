//! Yarns: colour, gloss, size and family.

use std::f32::consts::PI;
use std::fmt;
use std::str::FromStr;

use glam::Vec3;
use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

/// Index of a yarn in a design's yarn list.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize,
)]
pub struct YarnId(pub u16);

/// An 8-bit sRGB colour, as the designer picked it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Srgb(pub u8, pub u8, pub u8);

impl Srgb {
    /// Linear Rec. 709 components in 0..=1 (IEC 61966-2-1).
    pub fn to_linear(self) -> Vec3 {
        let channel = |value: u8| {
            let value = f32::from(value) / 255.0;
            if value <= 0.040_45 {
                value / 12.92
            } else {
                ((value + 0.055) / 1.055).powf(2.4)
            }
        };
        Vec3::new(channel(self.0), channel(self.1), channel(self.2))
    }

    /// The nearest colour to linear Rec. 709 components; values outside 0..=1 are cut off
    /// and NaN is black.
    pub fn from_linear(linear: Vec3) -> Self {
        let channel = |value: f32| {
            let value = value.clamp(0.0, 1.0);
            let encoded = if value <= 0.003_130_8 {
                value * 12.92
            } else {
                1.055 * value.powf(1.0 / 2.4) - 0.055
            };
            // A float cast saturates and turns NaN into 0.
            (encoded * 255.0).round() as u8
        };
        Self(channel(linear.x), channel(linear.y), channel(linear.z))
    }
}

impl fmt::Display for Srgb {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// A text that is not a colour.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is not a colour: write it as #rrggbb, for instance #1d3a6b")]
pub struct ColourError(pub String);

impl FromStr for Srgb {
    type Err = ColourError;

    fn from_str(text: &str) -> Result<Self, ColourError> {
        let wrong = || ColourError(text.chars().take(40).collect());
        let digits = text.trim().strip_prefix('#').ok_or_else(wrong)?;
        if digits.len() != 6 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
            return Err(wrong());
        }
        let value = u32::from_str_radix(digits, 16).map_err(|_| wrong())?;
        let [_, red, green, blue] = value.to_be_bytes();
        Ok(Self(red, green, blue))
    }
}

/// The families of yarn whose recipes are built in.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Hash,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    IntoStaticStr,
    VariantArray,
)]
#[strum(serialize_all = "lowercase")]
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

/// What is usual for a family: the middle of the ranges that spinners give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FamilyNumbers {
    /// Linear density of the whole yarn in tex (g/km).
    pub tex: f32,
    /// Density of the yarn (fibre density × packing) in g/cm³.
    pub yarn_density: f32,
    /// SGGX roughness α of its fibres.
    pub alpha: f32,
    /// Diameter over pitch of an ordinary cloth of it, in each direction.
    pub cover: f32,
    /// The colour of the undyed yarn in thick cloth.
    pub undyed: Srgb,
}

impl Family {
    /// Every family.
    pub const ALL: &'static [Self] = Self::VARIANTS;

    /// The family's usual count, density, gloss and cover.
    pub fn numbers(self) -> FamilyNumbers {
        let (tex, yarn_density, alpha, cover, undyed) = match self {
            // 40/2 Ne.
            Self::Cotton => (29.5, 0.88, 0.22, 0.82, Srgb(238, 233, 222)),
            // Four threads of 20/22 denier.
            Self::Silk => (9.3, 0.98, 0.08, 0.88, Srgb(243, 238, 226)),
            // 48/2 Nm.
            Self::Wool => (41.7, 0.60, 0.30, 0.85, Srgb(231, 222, 204)),
            // 26 Nm.
            Self::Linen => (38.5, 0.92, 0.18, 0.80, Srgb(216, 203, 178)),
        };
        FamilyNumbers {
            tex,
            yarn_density,
            alpha,
            cover,
            undyed,
        }
    }

    /// The family's name as commands and messages write it.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

impl FromStr for Family {
    type Err = FamilyError;

    fn from_str(text: &str) -> Result<Self, FamilyError> {
        (Self::ALL.iter().copied())
            .find(|family| text.trim().eq_ignore_ascii_case(family.name()))
            .ok_or_else(|| FamilyError(text.chars().take(40).collect()))
    }
}

/// A name that is no yarn family.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is not a yarn family: use {names}", names = names())]
pub struct FamilyError(pub String);

/// All families: "cotton, silk, wool or linen".
fn names() -> String {
    let names: Vec<&str> = Family::ALL.iter().map(|family| family.name()).collect();
    match names.split_last() {
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
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
    /// Linear density in tex of the whole (plied) yarn; `None` = from the diameter, or the
    /// family's usual one.
    pub tex: Option<f32>,
    /// What it is made of.
    pub family: Family,
}

/// The surface share of a yarn nobody said anything about.
pub const USUAL_SURFACE_SHARE: f32 = 0.05;

impl Yarn {
    /// A yarn of the family's usual size and gloss in this colour.
    pub fn new(name: impl Into<String>, family: Family, colour: Srgb) -> Self {
        Self {
            name: name.into(),
            colour,
            surface_share: USUAL_SURFACE_SHARE,
            gloss: None,
            diameter_mm: None,
            tex: None,
            family,
        }
    }

    /// The same yarn at another linear density (tex).
    pub fn with_tex(mut self, tex: f32) -> Self {
        self.tex = Some(tex);
        self.diameter_mm = None;
        self
    }

    /// Diameter in mm: as given, or 2√(tex·10⁻³/(πρ)) of the count or the family's count.
    pub fn diameter(&self) -> f32 {
        let numbers = self.family.numbers();
        self.diameter_mm.unwrap_or_else(|| {
            let tex = self.tex.unwrap_or(numbers.tex);
            2.0 * (tex * 1e-3 / (PI * numbers.yarn_density)).sqrt()
        })
    }

    /// Linear density in tex: as given, or that of the diameter, or the family's.
    pub fn linear_density(&self) -> f32 {
        let numbers = self.family.numbers();
        match (self.tex, self.diameter_mm) {
            (Some(tex), _) => tex,
            (None, Some(diameter)) => 1e3 * numbers.yarn_density * PI * diameter * diameter / 4.0,
            (None, None) => numbers.tex,
        }
    }

    /// SGGX roughness α, floored at 0.01 (below it the microflake numbers lose precision).
    pub fn alpha(&self) -> f32 {
        self.gloss
            .unwrap_or(self.family.numbers().alpha)
            .clamp(0.01, 1.0)
    }

    /// The first number that cannot be, as a line for the designer; `None` if all can.
    pub fn fault(&self) -> Option<String> {
        let within = |what: &str, value: Option<f32>, low: f32, high: f32| match value {
            Some(value) if !(low..=high).contains(&value) => Some(format!(
                "yarn \"{}\": {what} is {value}, but must lie in {low} to {high}",
                self.name
            )),
            _ => None,
        };
        within("surface_share", Some(self.surface_share), 0.0, 1.0)
            .or_else(|| within("gloss", self.gloss, 0.0, 1.0))
            .or_else(|| within("diameter_mm", self.diameter_mm, 0.001, 100.0))
            .or_else(|| within("tex", self.tex, 0.01, 1e6))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn colours_survive_text_and_linear_light() {
        for value in 0..=255 {
            let colour = Srgb(value, 255 - value, value ^ 0x55);
            assert_eq!(colour.to_string().parse(), Ok(colour));
            assert_eq!(Srgb::from_linear(colour.to_linear()), colour);
        }
        // Middle grey of the standard: 0.2140 linear at 50 %.
        assert!((Srgb(128, 0, 0).to_linear().x - 0.2159).abs() < 1e-4);
    }

    #[test]
    fn bad_colours_are_refused_and_wild_light_is_cut_off() {
        for text in ["", "#", "123456", "#12345", "#12345g", "#+12345", "#äöü"] {
            assert!(text.parse::<Srgb>().is_err(), "{text}");
        }
        let wild = Vec3::new(f32::NAN, f32::INFINITY, -3.0);
        assert_eq!(Srgb::from_linear(wild), Srgb(0, 255, 0));
    }

    #[test]
    fn sizes_follow_the_count() {
        let cotton = Yarn::new("c", Family::Cotton, Srgb(0, 0, 0));
        // 29.5 tex at 0.88 g/cm³: area 0.03352 mm².
        assert!((cotton.diameter() - 0.2066).abs() < 1e-3);
        let thick = cotton.clone().with_tex(4.0 * 29.5);
        assert!((thick.diameter() / cotton.diameter() - 2.0).abs() < 1e-5);
        let measured = Yarn {
            diameter_mm: Some(0.2066),
            ..cotton
        };
        assert!((measured.linear_density() - 29.5).abs() < 0.1);
    }

    #[test]
    fn impossible_numbers_are_named() {
        let mut yarn = Yarn::new("odd", Family::Silk, Srgb(0, 0, 0));
        assert_eq!(yarn.fault(), None);
        for value in [f32::NAN, f32::INFINITY, -1.0, 0.0] {
            yarn.diameter_mm = Some(value);
            assert!(yarn.fault().unwrap().contains("diameter_mm"));
        }
    }
}
