//! Where crossings lie on the screen: cells of whole physical pixels, zoom in steps, and
//! the way from a point to a crossing and back.
//!
//! The endless cloth's end 0 is at x = 0 and its pick 0 at y = 0, y upwards; the screen's
//! y runs down.

use egui::{Pos2, Rect, pos2};

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
    /// middle, y upwards) staying where it is.
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

    /// Moves the cloth by physical pixels, y upwards, but never so far that the first
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
    /// Physical pixel of the lower left corner of crossing (0, 0): from the left, and from
    /// the top, of the screen.
    pub origin: [f64; 2],
}

impl CellGrid {
    /// A look in a pane; corners of cells fall on physical pixels.
    pub fn new(pane: Rect, look: &Look, density: f32) -> Self {
        let density = f64::from(density);
        let cell = look.cell();
        let middle = [pane.center().x, pane.center().y].map(|at| f64::from(at) * density);
        Self {
            pane,
            density,
            cell,
            origin: [
                (middle[0] - look.centre[0] * cell).round(),
                (middle[1] + look.centre[1] * cell).round(),
            ],
        }
    }

    /// Points from the left of the screen to the left border of an end.
    pub fn x(&self, end: i64) -> f32 {
        ((self.origin[0] + end as f64 * self.cell) / self.density) as f32
    }

    /// Points from the top of the screen to the lower border of a pick.
    pub fn y(&self, pick: i64) -> f32 {
        ((self.origin[1] - pick as f64 * self.cell) / self.density) as f32
    }

    /// The crossing (end, pick) under a point.
    pub fn crossing(&self, at: Pos2) -> (i64, i64) {
        let [x, y] = [at.x, at.y].map(|at| f64::from(at) * self.density);
        (
            ((x - self.origin[0]) / self.cell).floor() as i64,
            ((self.origin[1] - y) / self.cell).floor() as i64,
        )
    }

    /// The rectangle of a box of crossings.
    pub fn rect(&self, end: i64, pick: i64, ends: i64, picks: i64) -> Rect {
        Rect::from_min_max(
            pos2(self.x(end), self.y(pick + picks)),
            pos2(self.x(end + ends), self.y(pick)),
        )
    }

    /// First and last crossing, both ways, that can be seen.
    pub fn visible(&self) -> [std::ops::RangeInclusive<i64>; 2] {
        let inner = self.pane.shrink(0.01);
        let (left, top) = self.crossing(inner.left_top());
        let (right, bottom) = self.crossing(inner.right_bottom());
        [left..=right, bottom..=top]
    }

    /// Pixels from the pane's middle, y upwards: what [`Look::zoom`] takes.
    pub fn off_middle(&self, at: Pos2) -> [f64; 2] {
        let offset = at - self.pane.center();
        [
            f64::from(offset.x) * self.density,
            f64::from(-offset.y) * self.density,
        ]
    }

    /// One physical pixel, points.
    pub fn pixel(&self) -> f32 {
        (1.0 / self.density) as f32
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
    fn a_point_of_a_cell_is_in_that_cell_at_every_zoom_and_density() {
        for density in [1.0, 1.25, 2.0] {
            let mut look = Look::fitting(40, 30, [632.0, 464.0]);
            for _ in 0..40 {
                look.zoom(-1, [3.0, 4.0]);
                let grid = CellGrid::new(pane(), &look, density);
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
    fn zoom_keeps_the_crossing_under_the_pointer() {
        let mut look = Look::fitting(400, 300, [632.0, 464.0]);
        let at = pos2(222.0, 333.0);
        for steps in [3, 4, -2, 5] {
            let grid = CellGrid::new(pane(), &look, 1.0);
            let before = grid.crossing(at);
            look.zoom(steps, grid.off_middle(at));
            let after = CellGrid::new(pane(), &look, 1.0).crossing(at);
            // The origin is rounded to a pixel, which may move it by one crossing.
            assert!((before.0 - after.0).abs() <= 1 && (before.1 - after.1).abs() <= 1);
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
