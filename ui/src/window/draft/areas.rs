//! How a pane is divided: drawdown, threading, tie-up, treadling, colour bars and rulers,
//! in the layout the weaver reads.

use egui::{Rect, pos2};
use pickglass::design::{Design, Lifting, Structure};

use crate::command_table::DraftLayout;
use crate::tokens;

/// Width of the ruler of the picks, and height of that of the ends.
const RULER: [f32; 2] = [34.0, 18.0];
/// Thickness of a colour bar.
const BAR: f32 = 14.0;
/// Threading and treadling take at most this share of the pane.
const LARGEST_BAND: f32 = 0.4;
/// Physical pixels of a shaft or treadle: at least and at most.
const SHAFT: [f64; 2] = [9.0, 24.0];

/// The shafts and treadles that are shown, and how large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loom {
    pub shafts: u32,
    /// Columns beside the drawdown: treadles, or the shafts of a lift plan.
    pub columns: u32,
    pub lift_plan: bool,
    /// Points of a shaft or treadle.
    pub cell: f32,
    /// The first shaft and column that are shown, where not all of them fit.
    pub first: [i64; 2],
}

/// The parts of the pane; empty ones have no room.
#[derive(Debug, Clone, Copy)]
pub struct Areas {
    pub drawdown: Rect,
    pub threading: Rect,
    pub tieup: Rect,
    pub treadling: Rect,
    pub warp_bar: Rect,
    pub weft_bar: Rect,
    pub end_ruler: Rect,
    pub pick_ruler: Rect,
    pub loom: Option<Loom>,
    /// Threading and tie-up lie above the drawdown.
    pub above: bool,
}

impl Areas {
    /// Divides a pane. `cell` = physical pixels a crossing, `density` = pixels a point,
    /// `first` = the shaft and the column to begin with where not all of them fit.
    pub fn split(
        pane: Rect,
        design: &Design,
        arrangement: DraftLayout,
        cell: f64,
        density: f32,
        first: [i64; 2],
    ) -> Self {
        let above = arrangement != DraftLayout::Scandinavian;
        let mut loom = match (design.structure(), arrangement) {
            (_, DraftLayout::Jacquard) => None,
            (Structure::Draft(draft), _) => {
                let lift_plan = matches!(draft.lifting(), Lifting::LiftPlan(_));
                let columns = if lift_plan {
                    draft.shafts()
                } else {
                    draft.treadles()
                };
                Some(Loom {
                    shafts: draft.shafts(),
                    columns,
                    lift_plan,
                    cell: (cell.clamp(SHAFT[0], SHAFT[1]) / f64::from(density)) as f32,
                    first: [0; 2],
                })
            }
            _ => None,
        };
        let gap = tokens::GRID;
        let band = |count: u32, room: f32| {
            let wanted = loom.map_or(0.0, |loom| count as f32 * loom.cell);
            let fits = wanted.min(room * LARGEST_BAND);
            // Whole shafts only.
            loom.map_or(0.0, |loom| (fits / loom.cell).floor() * loom.cell)
        };
        let across = band(loom.map_or(0, |loom| loom.columns), pane.width());
        let along = band(loom.map_or(0, |loom| loom.shafts), pane.height());
        if let Some(loom) = &mut loom {
            for (axis, (band, count)) in [(along, loom.shafts), (across, loom.columns)]
                .into_iter()
                .enumerate()
            {
                let fits = (band / loom.cell).round() as i64;
                loom.first[axis] = first[axis].min(i64::from(count) - fits).max(0);
            }
        }
        let pad = |band: f32| if band > 0.0 { band + gap } else { 0.0 };

        let left = pane.left() + RULER[0];
        let right = pane.right() - BAR - gap - pad(across);
        let (inner, outer) = (pad(along) + BAR + gap, RULER[1]);
        let (top, bottom) = if above {
            (pane.top() + inner, pane.bottom() - outer)
        } else {
            (pane.top() + outer, pane.bottom() - inner)
        };
        let drawdown = Rect::from_min_max(
            pos2(left, top),
            pos2(right.max(left + 1.0), bottom.max(top + 1.0)),
        );
        let beside = |from: f32, width: f32| {
            let far = drawdown.right() + from;
            Rect::from_min_max(
                pos2(far, drawdown.top()),
                pos2(far + width, drawdown.bottom()),
            )
        };
        // A band at a distance from the drawdown, on the side of the threading.
        let beyond = |left: f32, right: f32, from: f32, height: f32| {
            let (near, far) = if above {
                (drawdown.top() - from, drawdown.top() - from - height)
            } else {
                (drawdown.bottom() + from, drawdown.bottom() + from + height)
            };
            Rect::from_min_max(pos2(left, near.min(far)), pos2(right, near.max(far)))
        };
        let treadling = beside(gap, across);
        Self {
            drawdown,
            threading: beyond(drawdown.left(), drawdown.right(), gap, along),
            tieup: beyond(treadling.left(), treadling.right(), gap, along),
            treadling,
            warp_bar: beyond(drawdown.left(), drawdown.right(), pad(along) + gap, BAR),
            weft_bar: beside(pad(across) + gap, BAR),
            end_ruler: {
                let top = if above { drawdown.bottom() } else { pane.top() };
                Rect::from_min_max(
                    pos2(drawdown.left(), top),
                    pos2(drawdown.right(), top + RULER[1]),
                )
            },
            pick_ruler: Rect::from_min_max(
                pos2(pane.left(), drawdown.top()),
                drawdown.left_bottom(),
            ),
            loom,
            above,
        }
    }

    /// The row of the threading, from the drawdown outwards, at a height on the screen.
    pub fn shaft_at(&self, y: f32) -> i64 {
        let Some(loom) = self.loom else { return 0 };
        let distance = if self.above {
            self.threading.bottom() - y
        } else {
            y - self.threading.top()
        };
        (distance / loom.cell).floor() as i64 + loom.first[0]
    }

    /// The column of the treadling at a place on the screen.
    pub fn treadle_at(&self, x: f32) -> i64 {
        let Some(loom) = self.loom else { return 0 };
        ((x - self.treadling.left()) / loom.cell).floor() as i64 + loom.first[1]
    }

    /// Top of a shaft's row and left of a treadle's column.
    pub fn shaft_top(&self, shaft: i64) -> f32 {
        let (cell, first) = self
            .loom
            .map_or((0.0, 0), |loom| (loom.cell, loom.first[0]));
        let row = (shaft - first) as f32;
        if self.above {
            self.threading.bottom() - (row + 1.0) * cell
        } else {
            self.threading.top() + row * cell
        }
    }

    /// Left of a treadle's column.
    pub fn treadle_left(&self, treadle: i64) -> f32 {
        let (cell, first) = self
            .loom
            .map_or((0.0, 0), |loom| (loom.cell, loom.first[1]));
        self.treadling.left() + (treadle - first) as f32 * cell
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::session::blank;
    use egui::vec2;

    #[test]
    fn parts_lie_in_the_pane_apart_from_each_other_and_in_line() {
        let opened = blank().expect("a design");
        for (arrangement, size) in [
            (DraftLayout::Us, vec2(600.0, 500.0)),
            (DraftLayout::Scandinavian, vec2(600.0, 500.0)),
            (DraftLayout::Us, vec2(300.0, 200.0)),
        ] {
            let pane = Rect::from_min_size(pos2(40.0, 30.0), size);
            let areas = Areas::split(pane, &opened.design, arrangement, 16.0, 1.0, [0; 2]);
            let parts = [
                areas.drawdown,
                areas.threading,
                areas.tieup,
                areas.treadling,
                areas.warp_bar,
                areas.weft_bar,
                areas.end_ruler,
                areas.pick_ruler,
            ];
            for (index, one) in parts.iter().enumerate() {
                assert!(
                    one.is_positive() && pane.expand(0.1).contains_rect(*one),
                    "{index}"
                );
                for other in &parts[index + 1..] {
                    assert!(!one.shrink(0.5).intersects(other.shrink(0.5)), "{index}");
                }
            }
            assert_eq!(areas.threading.x_range(), areas.drawdown.x_range());
            assert_eq!(areas.treadling.y_range(), areas.drawdown.y_range());
            for shaft in 0..4 {
                let middle = areas.shaft_top(shaft) + 8.0;
                assert_eq!(areas.shaft_at(middle), shaft);
            }
        }
    }

    #[test]
    fn shafts_that_do_not_fit_are_reached_by_moving_on() {
        let opened = blank().expect("a design");
        // 80 points leave room for two of the four shafts of 16.
        let pane = Rect::from_min_size(pos2(0.0, 0.0), vec2(600.0, 80.0));
        let split = |first| {
            let layout = DraftLayout::Us;
            Areas::split(pane, &opened.design, layout, 16.0, 1.0, [first, 0])
        };
        let (start, end) = (split(0), split(99));
        assert_eq!(start.shaft_at(start.threading.bottom() - 1.0), 0);
        assert_eq!(end.shaft_at(end.threading.top() + 1.0), 3);
        assert!(end.shaft_top(3) >= end.threading.top() - 0.1);
    }

    #[test]
    fn the_drawdown_alone_has_neither_threading_nor_treadling() {
        let opened = blank().expect("a design");
        let pane = Rect::from_min_size(pos2(0.0, 0.0), vec2(600.0, 500.0));
        let areas = Areas::split(
            pane,
            &opened.design,
            DraftLayout::Jacquard,
            16.0,
            1.0,
            [0; 2],
        );
        assert!(areas.loom.is_none() && areas.threading.height() < 0.1);
        assert!(areas.warp_bar.height() > 10.0);
    }
}
