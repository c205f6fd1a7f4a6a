//! How a picture is to be posterised, and the panel that follows from it.

use super::PosteriseError;
use super::resample::{Layout, MAX_PANEL};
use crate::design::{Family, Sett, Srgb, check_size};
use strum::{Display, EnumMessage, EnumString, IntoStaticStr, VariantArray};

/// The most colours a picture is reduced to.
pub const MAX_COLOURS: u16 = 256;
/// Ends of a panel nobody gave a size.
const USUAL_ENDS: u32 = 960;
/// Threads of the weaves that are proposed, in both directions.
const REPEAT: f64 = 8.0;

/// How the picture is brought to the panel's shape.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    Display,
    EnumMessage,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[strum(serialize_all = "kebab-case")]
pub enum Fit {
    /// It fills the panel; what stands over is cut off, alike on both sides.
    #[default]
    Crop,
    /// It lies in the panel whole, with white around it.
    Pad,
    /// It is stretched.
    Stretch,
}

/// How a picture becomes a design.
#[derive(Debug, Clone, PartialEq)]
pub struct PosteriseSettings {
    /// What the design is called.
    pub name: String,
    /// Colours to reduce to, 2 to [`MAX_COLOURS`]; fewer if the picture has fewer.
    pub colours: u16,
    /// Ends of the panel; `None` = from the picks and the picture's shape, or 960.
    pub ends: Option<u32>,
    /// Picks of the panel; `None` = from the ends and the picture's shape.
    pub picks: Option<u32>,
    /// Ends per cm.
    pub ends_per_cm: f32,
    /// Picks per cm.
    pub picks_per_cm: f32,
    /// How the picture is brought to the panel's shape.
    pub fit: Fit,
    /// Whether colours between those of the palette are dithered.
    pub dither: bool,
    /// Patches of fewer crossings are merged into a neighbour.
    pub speck: u32,
    /// Whether regions get yarns of their own, which no loom can do.
    pub preview_only: bool,
    /// Floats between regions longer than this are bound, in crossings; `None` = left.
    pub bind: Option<u32>,
    /// What the yarns are made of.
    pub family: Family,
    /// Colours of the warp and the weft; `None` = chosen from the picture.
    pub yarns: Option<[Srgb; 2]>,
}

impl Default for PosteriseSettings {
    fn default() -> Self {
        Self {
            name: "posterised".to_owned(),
            colours: 8,
            ends: None,
            picks: None,
            ends_per_cm: 60.0 / 2.54,
            picks_per_cm: 60.0 / 2.54,
            fit: Fit::default(),
            dither: false,
            speck: 6,
            preview_only: false,
            bind: None,
            // Filaments cover: nothing behind the cloth shows through.
            family: Family::Silk,
            yarns: None,
        }
    }
}

impl PosteriseSettings {
    /// The panel for a picture of `width` × `height` pixels.
    ///
    /// # Errors
    /// [`PosteriseError`] for colours, a sett or a size that cannot be.
    pub fn layout(&self, width: u32, height: u32) -> Result<Layout, PosteriseError> {
        if !(2..=MAX_COLOURS).contains(&self.colours) {
            return Err(PosteriseError::Colours(self.colours));
        }
        let sett = Sett::per_cm(self.ends_per_cm, self.picks_per_cm);
        if let Some(fault) = sett.fault() {
            return Err(PosteriseError::Sett(fault));
        }
        // Picks for each end of a panel that has the picture's own shape.
        let per_end = f64::from(height) / f64::from(width) * f64::from(self.picks_per_cm)
            / f64::from(self.ends_per_cm);
        let whole = |threads: f64| ((threads / REPEAT).round().max(1.0) * REPEAT) as u32;
        let (ends, picks) = match (self.ends, self.picks) {
            (Some(ends), Some(picks)) => (ends, picks),
            (Some(ends), None) => (ends, whole(f64::from(ends) * per_end)),
            (None, Some(picks)) => (whole(f64::from(picks) / per_end), picks),
            (None, None) => (USUAL_ENDS, whole(f64::from(USUAL_ENDS) * per_end)),
        };
        check_size(u64::from(ends), u64::from(picks))?;
        if u64::from(ends) * u64::from(picks) > MAX_PANEL {
            return Err(PosteriseError::TooLarge { ends, picks });
        }
        Ok(Layout {
            ends,
            picks,
            fit: self.fit,
            sett,
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn a_size_that_is_left_out_follows_from_the_shape_on_cloth() {
        let settings = PosteriseSettings {
            ends_per_cm: 24.0,
            picks_per_cm: 40.0,
            ends: Some(960),
            ..PosteriseSettings::default()
        };
        // A square picture on a cloth with 40 picks for 24 ends.
        assert_eq!(settings.layout(512, 512).unwrap().picks, 1600);
        let by_picks = PosteriseSettings {
            ends: None,
            picks: Some(1600),
            ..settings
        };
        assert_eq!(by_picks.layout(512, 512).unwrap().ends, 960);
        assert_eq!(by_picks.layout(1024, 512).unwrap().ends, 1920);
    }

    #[test]
    fn numbers_that_cannot_be_are_refused_in_one_line() {
        let wrong = |change: &dyn Fn(&mut PosteriseSettings)| {
            let mut settings = PosteriseSettings::default();
            change(&mut settings);
            let message = settings.layout(9, 9).unwrap_err().to_string();
            assert_eq!(message.lines().count(), 1);
            message
        };
        assert!(wrong(&|s| s.colours = 1).contains("2 to 256"));
        assert!(wrong(&|s| s.colours = 257).contains("2 to 256"));
        assert!(wrong(&|s| s.ends = Some(0)).contains("no cloth"));
        assert!(wrong(&|s| s.ends = Some(u32::MAX)).contains("too many"));
        assert!(wrong(&|s| (s.ends, s.picks) = (Some(1 << 14), Some(1 << 13))).contains("picture"));
        for value in [f32::NAN, f32::INFINITY, 0.0, -1.0] {
            assert!(wrong(&|s| s.ends_per_cm = value).contains("ends per cm"));
        }
    }
}
