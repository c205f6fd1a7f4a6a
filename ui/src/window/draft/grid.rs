//! Where crossings lie on the screen: cells of whole physical pixels, zoom in steps, and
//! the way from a point to a crossing and back.
//!
//! The endless cloth's end 0 is at x = 0 and its pick 0 at y = 0, y upwards; the screen's
//! y runs down. A cloth that is turned by 180° has its ends from the right and its picks
//! from above: whatever maps a place to a crossing asks [`CellGrid`], which alone knows.

use egui::{Pos2, Rect, Vec2, pos2};

/// Physical pixels a crossing, from the furthest look to the closest. Below one pixel the
/// steps halve, so that a pixel is a whole square of crossings.
const STEPS: [f64; 22] = [
    1.0 / 64.0,
    1.0 / 32.0,
    1.0 / 16.0,
    1.0 / 8.0,
    1.0 / 4.0,
    1.0 / 2.0,
    1.0,
    2.0,
    3.0,
    4.0,
    5.0,
    6.0,
    8.0,
    10.0,
    12.0,
    16.0,
    20.0,
    24.0,
    32.0,
    40.0,
    48.0,
    64.0,
];
/// The step of one pixel a crossing.
const ONE: usize = 6;
/// Small designs are seen no smaller than at this step: 2 pixels a crossing.
const SMALL: usize = 7;
/// A design that fits is drawn no larger than this step: 24 pixels a crossing.
const LARGEST_FIT: usize = 17;

/// What part of the cloth is looked at, whatever the pane's size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// The point in the middle, in crossings.
    pub centre: [f64; 2],
    step: usize,
    /// The furthest step: beyond, the design itself would be lost among its repeats.
    least: usize,
}

impl Look {
    /// All of `ends` × `picks` crossings in `room` physical pixels, or as much as can be.
    pub fn fitting(ends: u32, picks: u32, room: [f64; 2]) -> Self {
        let fits = |&step: &usize| {
            let cell = STEPS[step];
            f64::from(ends) * cell <= room[0] && f64::from(picks) * cell <= room[1]
        };
        let step = (0..=LARGEST_FIT).rev().find(fits).unwrap_or(0);
        Self {
            centre: [f64::from(ends) / 2.0, f64::from(picks) / 2.0],
            step,
            least: step.saturating_sub(2).min(SMALL),
        }
    }

    /// Physical pixels a crossing.
    pub fn cell(&self) -> f64 {
        STEPS[self.step]
    }

    /// log₂ of the crossings along the side of a pixel; 0 from one pixel a crossing on.
    pub fn level(&self) -> u32 {
        ONE.saturating_sub(self.step) as u32
    }

    /// One pixel a crossing.
    pub fn actual(&mut self) {
        self.step = ONE;
    }

    /// Looks so many steps closer, with the crossing at `anchor` (in pixels from the
    /// middle, along ends and picks) staying where it is.
    pub fn zoom(&mut self, steps: i32, anchor: [f64; 2]) {
        let before = self.cell();
        let last = STEPS.len() as i32 - 1;
        self.step = (self.step as i32)
            .saturating_add(steps)
            .clamp(self.least as i32, last) as usize;
        for (centre, anchor) in self.centre.iter_mut().zip(anchor) {
            *centre += anchor / before - anchor / STEPS[self.step];
        }
    }

    /// Moves the cloth by physical pixels, along ends and picks, but never so far that the first
    /// repeat of `ends` × `picks` and its neighbours are lost from sight.
    pub fn pan(&mut self, by: [f64; 2], ends: u32, picks: u32) {
        let cell = self.cell();
        for (axis, size) in [ends, picks].into_iter().enumerate() {
            let moved = self.centre[axis] - by[axis] / cell;
            let size = f64::from(size);
            self.centre[axis] = moved.clamp(-size, 2.0 * size);
        }
    }
}

/// A look in a pane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellGrid {
    /// The pane of the drawdown, points.
    pub pane: Rect,
    /// Physical pixels a point.
    pub density: f64,
    /// Physical pixels a crossing.
    pub cell: f64,
    /// Physical pixel of the corner of crossing (0, 0) where both threads are counted from:
    /// from the left, and from the top, of the screen.
    pub origin: [f64; 2],
    /// The cloth is turned by 180°: ends run to the left and picks downwards.
    pub turned: bool,
}

impl CellGrid {
    /// A look in a pane; corners of cells fall on physical pixels.
    pub fn new(pane: Rect, look: &Look, density: f32, turned: bool) -> Self {
        let way = way(turned);
        let density = f64::from(density);
        let cell = look.cell();
        let middle = [pane.center().x, pane.center().y].map(|at| f64::from(at) * density);
        Self {
            pane,
            density,
            cell,
            origin: [
                (middle[0] - way * look.centre[0] * cell).round(),
                (middle[1] + way * look.centre[1] * cell).round(),
            ],
            turned,
        }
    }

    /// Points from the left of the screen to the border between an end and the one before.
    pub fn x(&self, end: i64) -> f32 {
        ((self.origin[0] + way(self.turned) * end as f64 * self.cell) / self.density) as f32
    }

    /// Points from the top of the screen to the border between a pick and the one before.
    pub fn y(&self, pick: i64) -> f32 {
        ((self.origin[1] - way(self.turned) * pick as f64 * self.cell) / self.density) as f32
    }

    /// Left of a line of one pixel on the border before an end, within that end.
    pub fn line_x(&self, end: i64) -> f32 {
        self.x(end) - if self.turned { self.pixel() } else { 0.0 }
    }

    /// Top of a line of one pixel on the border before a pick, within that pick.
    pub fn line_y(&self, pick: i64) -> f32 {
        self.y(pick) - if self.turned { 0.0 } else { self.pixel() }
    }

    /// What of a picture of the cloth, unturned, its upper left and lower right corner on
    /// the screen show.
    pub fn picture_uv(&self) -> Rect {
        picture_uv(self.turned)
    }

    /// The crossing (end, pick) under a point.
    pub fn crossing(&self, at: Pos2) -> (i64, i64) {
        let [x, y] = [at.x, at.y].map(|at| f64::from(at) * self.density);
        (
            (way(self.turned) * (x - self.origin[0]) / self.cell).floor() as i64,
            (way(self.turned) * (self.origin[1] - y) / self.cell).floor() as i64,
        )
    }

    /// The rectangle of a box of crossings.
    pub fn rect(&self, end: i64, pick: i64, ends: i64, picks: i64) -> Rect {
        Rect::from_two_pos(
            pos2(self.x(end), self.y(pick)),
            pos2(self.x(end + ends), self.y(pick + picks)),
        )
    }

    /// First and last crossing, both ways, that can be seen.
    pub fn visible(&self) -> [std::ops::RangeInclusive<i64>; 2] {
        let inner = self.pane.shrink(0.01);
        let mut corners = [inner.left_bottom(), inner.right_top()].map(|at| self.crossing(at));
        if self.turned {
            corners.reverse();
        }
        let [(first_end, first_pick), (last_end, last_pick)] = corners;
        [first_end..=last_end, first_pick..=last_pick]
    }

    /// A way on the screen, in points, as one over the cloth, in physical pixels along ends
    /// and picks: what [`Look::pan`] takes.
    pub fn over_cloth(&self, by: Vec2) -> [f64; 2] {
        [by.x, -by.y].map(|by| way(self.turned) * f64::from(by) * self.density)
    }

    /// Pixels from the pane's middle, along ends and picks: what [`Look::zoom`] takes.
    pub fn off_middle(&self, at: Pos2) -> [f64; 2] {
        self.over_cloth(at - self.pane.center())
    }

    /// One physical pixel, points.
    pub fn pixel(&self) -> f32 {
        (1.0 / self.density) as f32
    }
}

/// Which way ends run to the right and picks upwards: +1, or −1 where the cloth is turned.
pub fn way(turned: bool) -> f64 {
    if turned { -1.0 } else { 1.0 }
}

/// As [`CellGrid::picture_uv`], for any view of a cloth.
pub fn picture_uv(turned: bool) -> Rect {
    let corners = [Pos2::ZERO, pos2(1.0, 1.0)];
    let [first, last] = if turned {
        [corners[1], corners[0]]
    } else {
        corners
    };
    Rect {
        min: first,
        max: last,
    }
}

/// The step of numbers along a ruler: 1, 2 or 5 × 10ⁿ threads, so that a number of the
/// given width in pixels fits into each.
pub fn ruler_step(cell: f64, width: f64) -> i64 {
    let least = (width / cell.max(1e-6)).min(1e15);
    let mut unit = 1i64;
    loop {
        for factor in [1, 2, 5] {
            if (factor * unit) as f64 >= least {
                return factor * unit;
            }
        }
        unit *= 10;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pane() -> Rect {
        Rect::from_min_max(pos2(101.0, 53.0), pos2(733.0, 517.0))
    }

    #[test]
    fn a_point_of_a_cell_is_in_that_cell_at_every_zoom_density_and_turn() {
        for (density, turned) in [1.0, 1.25, 2.0]
            .into_iter()
            .flat_map(|d| [(d, false), (d, true)])
        {
            let mut look = Look::fitting(40, 30, [632.0, 464.0]);
            for _ in 0..40 {
                look.zoom(-1, [3.0, 4.0]);
                let grid = CellGrid::new(pane(), &look, density, turned);
                for (end, pick) in [(0, 0), (-7, 12), (1000, -3)] {
                    let middle = grid.rect(end, pick, 1, 1).center();
                    if grid.cell >= 1.0 {
                        assert_eq!(grid.crossing(middle), (end, pick));
                    }
                }
                let corner = f64::from(grid.x(5)) * grid.density;
                assert!(grid.cell < 1.0 || (corner - corner.round()).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn a_turned_cloth_lies_as_the_other_does_turned_about_the_panes_middle() {
        // Of whole pixels both ways, so that both origins are rounded alike.
        let pane = Rect::from_min_max(pos2(100.0, 52.0), pos2(732.0, 516.0));
        let look = Look::fitting(40, 30, [632.0, 464.0]);
        let plain = CellGrid::new(pane, &look, 1.0, false);
        let turned = CellGrid::new(pane, &look, 1.0, true);
        for (end, pick) in [(0, 0), (39, 29), (-7, 12), (100, -3)] {
            let there = plain.rect(end, pick, 1, 1);
            let here = turned.rect(end, pick, 1, 1);
            let about = |at: Pos2| pane.center() + (pane.center() - at);
            assert!((about(there.min) - here.max).length() < 1e-3);
            assert!((about(there.max) - here.min).length() < 1e-3);
        }
        // End 0 lies at the right and pick 0 at the top.
        let (first, last) = (turned.rect(0, 0, 1, 1), turned.rect(39, 29, 1, 1));
        assert!(first.left() > last.right() && first.bottom() < last.top());
        assert_eq!(plain.visible(), turned.visible());
    }

    #[test]
    fn the_cloth_goes_with_the_pointer_whichever_way_it_lies() {
        for turned in [false, true] {
            let mut look = Look::fitting(40, 30, [632.0, 464.0]);
            let grid = CellGrid::new(pane(), &look, 2.0, turned);
            let before = grid.rect(3, 4, 1, 1).center();
            let by = egui::vec2(24.0, -36.0);
            look.pan(grid.over_cloth(by), 40, 30);
            let after = CellGrid::new(pane(), &look, 2.0, turned).rect(3, 4, 1, 1);
            assert!((after.center() - before - by).length() < 1.0, "{turned}");
        }
    }

    #[test]
    fn zoom_keeps_the_crossing_under_the_pointer() {
        for turned in [false, true] {
            let mut look = Look::fitting(400, 300, [632.0, 464.0]);
            let at = pos2(222.0, 333.0);
            for steps in [3, 4, -2, 5] {
                let grid = CellGrid::new(pane(), &look, 1.0, turned);
                let before = grid.crossing(at);
                look.zoom(steps, grid.off_middle(at));
                let after = CellGrid::new(pane(), &look, 1.0, turned).crossing(at);
                // The origin is rounded to a pixel, which may move it by one crossing.
                assert!((before.0 - after.0).abs() <= 1 && (before.1 - after.1).abs() <= 1);
            }
        }
    }

    #[test]
    fn a_design_that_fits_is_seen_whole_and_the_work_cannot_be_lost() {
        let mut look = Look::fitting(16, 16, [632.0, 464.0]);
        assert!((look.cell() - 24.0).abs() < 1e-9);
        let huge = Look::fitting(16_000, 20_000, [632.0, 464.0]);
        assert!((huge.cell() - 1.0 / 64.0).abs() < 1e-9 && huge.level() == 6);
        // Two steps further than the whole design, no more.
        look.zoom(-99, [0.0, 0.0]);
        assert!((look.cell() - 2.0).abs() < 1e-9);
        look.pan([1e9, f64::MIN], 16, 16);
        assert_eq!(look.centre, [-16.0, 32.0]);
    }

    #[test]
    fn rulers_count_by_1_2_5() {
        assert_eq!(ruler_step(24.0, 20.0), 1);
        assert_eq!(ruler_step(8.0, 20.0), 5);
        assert_eq!(ruler_step(1.0, 30.0), 50);
        assert_eq!(ruler_step(1.0 / 64.0, 40.0), 5000);
        assert!(ruler_step(0.0, f64::INFINITY) > 0);
    }
}
