//! The reed that a sett asks for, and the sizes of the cloth from loom to finish.

use crate::design::document::Design;

/// Widths and dents of one repeat of the weave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reed {
    /// Width of the ends in the reed, mm: the cloth's and what the picks take up.
    pub width_mm: f64,
    /// Dents of one repeat.
    pub dents: u64,
    /// Dents per cm.
    pub dents_per_cm: f64,
    /// Width and height of the cloth off the loom, mm.
    pub cloth_mm: [f64; 2],
    /// Width and height of the finished cloth, mm.
    pub finished_mm: [f64; 2],
}

/// The reed for a design: `ends_a_dent` in each dent (at least 1), the picks `take_up` more
/// of their length than the cloth is wide, and the cloth shrinking by `shrinkage` (shares
/// across and along, 0 to below 1) when it is finished.
pub fn reed(design: &Design, take_up: f64, ends_a_dent: u32, shrinkage: [f64; 2]) -> Reed {
    let cloth_mm = [
        design.end_positions().start(i64::from(design.ends())),
        design.pick_positions().start(i64::from(design.picks())),
    ];
    let width_mm = cloth_mm[0] * (1.0 + take_up.max(0.0));
    let ends_a_dent = ends_a_dent.max(1);
    let kept = shrinkage.map(|share| 1.0 - share.clamp(0.0, 0.99));
    Reed {
        width_mm,
        dents: u64::from(design.ends().div_ceil(ends_a_dent)),
        dents_per_cm: f64::from(design.ends()) / f64::from(ends_a_dent) / (width_mm * 0.1),
        cloth_mm,
        finished_mm: [cloth_mm[0] * kept[0], cloth_mm[1] * kept[1]],
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::design::{Family, Srgb, Yarn, YarnId};
    use crate::design::{Sett, Structure, WeavePattern, YarnMaps};

    #[test]
    fn a_reed_is_what_a_weaver_reckons() {
        // 480 ends at 24 a cm are 20 cm; 5 % take-up makes that 21 cm in the reed; two in a
        // dent are 240 dents, 240/21 a cm; 10 % shrinkage across leaves 18 cm.
        let design = Design::new(
            "towel",
            Structure::Pattern(WeavePattern::new(480, 200)),
            vec![Yarn::new("flax", Family::Linen, Srgb(200, 190, 160))],
            YarnMaps::plain(YarnId(0), YarnId(0)),
            Sett::per_cm(24.0, 20.0),
        );
        let found = reed(&design.unwrap(), 0.05, 2, [0.1, 0.0]);
        assert!((found.width_mm - 210.0).abs() < 1e-3);
        assert_eq!(found.dents, 240);
        assert!((found.dents_per_cm - 240.0 / 21.0).abs() < 1e-4);
        assert!((found.finished_mm[0] - 180.0).abs() < 1e-3);
        assert!((found.finished_mm[1] - 100.0).abs() < 1e-3);
    }
}
