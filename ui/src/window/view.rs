//! Where the cloth lies on the screen: pan and zoom as plain arithmetic.
//!
//! Cloth coordinates are mm, x to the right and y up on the face (pick 0 lowest); the
//! screen's y runs down. Seen from the back, x runs to the left; of a cloth that is turned by
//! 180°, both run the other way.

use egui::{Pos2, Rect, Vec2, pos2, vec2};
use pickglass::scene::Pose;

/// Closest and furthest look, mm of cloth a point of screen.
const SCALE_RANGE: std::ops::RangeInclusive<f32> = 0.0002..=25.0;

/// The part of the cloth that a pane shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClothView {
    /// The point of the cloth in the pane's middle, mm.
    pub centre_mm: [f32; 2],
    /// Millimetres of cloth a point of screen.
    pub mm_per_point: f32,
    /// Seen from behind.
    pub mirrored: bool,
    /// Turned by 180° as it lies.
    pub turned: bool,
}

impl ClothView {
    /// What is fitted into a pane is so much smaller than that.
    pub const MARGIN: f32 = 1.06;

    /// `width_mm` of cloth round `centre_mm` across a pane.
    pub fn across(pane: Rect, centre_mm: [f32; 2], width_mm: f32) -> Self {
        let mut view = Self {
            centre_mm,
            mm_per_point: 1.0,
            mirrored: false,
            turned: false,
        };
        view.set_scale(width_mm / pane.width().max(1.0));
        view
    }

    /// A whole `size_mm` in the pane, with a margin.
    pub fn fitting(pane: Rect, centre_mm: [f32; 2], size_mm: [f32; 2]) -> Self {
        let aspect = pane.width().max(1.0) / pane.height().max(1.0);
        let width_mm = Self::MARGIN * size_mm[0].max(size_mm[1] * aspect);
        Self::across(pane, centre_mm, width_mm)
    }

    /// Width of cloth across a pane, mm.
    pub fn width_mm(&self, pane: Rect) -> f32 {
        self.mm_per_point * pane.width()
    }

    /// Which way x runs to the right and y upwards: +1 or −1.
    fn ways(&self) -> [f32; 2] {
        let (back, turned) = (self.mirrored, self.turned);
        Pose { back, turned }.ways()
    }

    /// Where a point of the cloth lies on the screen.
    pub fn to_screen(self, pane: Rect, cloth_mm: [f32; 2]) -> Pos2 {
        let (middle, [right, up]) = (pane.center(), self.ways());
        pos2(
            middle.x + right * (cloth_mm[0] - self.centre_mm[0]) / self.mm_per_point,
            middle.y - up * (cloth_mm[1] - self.centre_mm[1]) / self.mm_per_point,
        )
    }

    /// Which point of the cloth lies under a point of the screen.
    pub fn to_cloth(self, pane: Rect, screen: Pos2) -> [f32; 2] {
        let (offset, [right, up]) = (screen - pane.center(), self.ways());
        [
            self.centre_mm[0] + right * offset.x * self.mm_per_point,
            self.centre_mm[1] - up * offset.y * self.mm_per_point,
        ]
    }

    /// Moves the cloth with the pointer.
    pub fn pan(&mut self, delta: Vec2) {
        let [right, up] = self.ways();
        self.centre_mm[0] -= right * delta.x * self.mm_per_point;
        self.centre_mm[1] += up * delta.y * self.mm_per_point;
    }

    /// Looks `factor` times closer, with the cloth under `anchor` staying there.
    pub fn zoom(&mut self, pane: Rect, anchor: Pos2, factor: f32) {
        let before = self.to_cloth(pane, anchor);
        self.set_scale(self.mm_per_point / factor);
        let after = self.to_cloth(pane, anchor);
        for axis in 0..2 {
            self.centre_mm[axis] += before[axis] - after[axis];
        }
    }

    /// The screen rectangle of a picture of `width_mm` round `centre_mm`.
    pub fn picture_rect(self, pane: Rect, centre_mm: [f32; 2], width_mm: f32, aspect: f32) -> Rect {
        let width = width_mm / self.mm_per_point;
        Rect::from_center_size(
            self.to_screen(pane, centre_mm),
            vec2(width, width / aspect.max(1e-6)),
        )
    }

    fn set_scale(&mut self, mm_per_point: f32) {
        if mm_per_point.is_finite() {
            self.mm_per_point = mm_per_point.clamp(*SCALE_RANGE.start(), *SCALE_RANGE.end());
        }
    }
}

/// The longest bar of 1, 2 or 5 × 10ⁿ mm that is at most `longest` points long.
/// Returns its length in points and its caption.
pub fn scale_bar(mm_per_point: f32, longest: f32) -> (f32, String) {
    let available = f64::from(mm_per_point * longest).clamp(1e-6, 1e9);
    let decade = available.log10().floor();
    let unit = 10f64.powf(decade);
    let step = [5.0, 2.0, 1.0]
        .into_iter()
        .find(|step| step * unit <= available * (1.0 + 1e-6))
        .unwrap_or(1.0);
    let mm = step * unit;
    let caption = if mm < 0.1 - 1e-9 {
        format!("{} µm", (mm * 1000.0 * 1e3).round() / 1e3)
    } else if mm >= 10.0 - 1e-9 {
        format!("{} cm", (mm / 10.0).round())
    } else {
        format!("{} mm", (mm * 10.0).round() / 10.0)
    };
    ((mm / f64::from(mm_per_point)) as f32, caption)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pane() -> Rect {
        Rect::from_min_size(pos2(100.0, 50.0), vec2(800.0, 600.0))
    }

    /// Seen from the face and from behind, unturned and turned.
    fn all_ways() -> [ClothView; 4] {
        [(false, false), (true, false), (false, true), (true, true)].map(|(mirrored, turned)| {
            ClothView {
                centre_mm: [3.0, -2.0],
                mm_per_point: 0.02,
                mirrored,
                turned,
            }
        })
    }

    #[test]
    fn screen_and_cloth_are_inverse() {
        for view in all_ways() {
            let cloth = view.to_cloth(pane(), pos2(333.0, 77.0));
            let screen = view.to_screen(pane(), cloth);
            assert!((screen - pos2(333.0, 77.0)).length() < 1e-2);
        }
    }

    #[test]
    fn zoom_keeps_what_is_under_the_pointer() {
        for mut view in all_ways() {
            let anchor = pos2(700.0, 120.0);
            let before = view.to_cloth(pane(), anchor);
            view.zoom(pane(), anchor, 1.7);
            let after = view.to_cloth(pane(), anchor);
            assert!((before[0] - after[0]).abs() < 1e-4 && (before[1] - after[1]).abs() < 1e-4);
        }
    }

    #[test]
    fn zoom_ends_somewhere_and_ignores_nonsense() {
        let mut view = ClothView::across(pane(), [0.0, 0.0], 10.0);
        for factor in [0.0, f32::NAN, f32::INFINITY, 1e-30, 1e30, -1.0] {
            view.zoom(pane(), pane().center(), factor);
            assert!(SCALE_RANGE.contains(&view.mm_per_point), "{factor}");
            assert!(view.centre_mm.iter().all(|mm| mm.is_finite()), "{factor}");
        }
    }

    #[test]
    fn the_cloth_follows_the_pointer() {
        for mut view in all_ways() {
            let before = view.to_cloth(pane(), pos2(200.0, 200.0));
            view.pan(vec2(30.0, -20.0));
            let after = view.to_cloth(pane(), pos2(230.0, 180.0));
            assert!((before[0] - after[0]).abs() < 1e-4 && (before[1] - after[1]).abs() < 1e-4);
        }
    }

    #[test]
    fn a_turned_cloth_begins_at_the_upper_right() {
        let [plain, _, turned, turned_back] = all_ways();
        for (x, y) in [(0.0, 0.0), (5.0, -1.0)] {
            let there = plain.to_screen(pane(), [x, y]) - pane().center();
            let here = turned.to_screen(pane(), [x, y]) - pane().center();
            assert!((there + here).length() < 1e-3, "turned by 180°");
            // Turned over as one turns a page, and then turned.
            let back = turned_back.to_screen(pane(), [x, y]) - pane().center();
            assert!((back.x + here.x).abs() < 1e-3 && (back.y - here.y).abs() < 1e-3);
        }
    }

    #[test]
    fn bars_are_1_2_5() {
        for (scale, caption) in [
            (0.05, "5 mm"),
            (0.02, "2 mm"),
            (0.0063, "1 mm"),
            (0.002, "0.2 mm"),
            (0.0003, "20 µm"),
            (0.5, "5 cm"),
        ] {
            let (length, text) = scale_bar(scale, 160.0);
            assert_eq!(text, caption);
            assert!(length <= 160.1 && length > 60.0, "{length}");
        }
    }
}
