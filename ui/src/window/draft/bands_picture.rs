//! Threading, tie-up, treadling and the colour bars drawn.

use egui::{Color32, Mesh, Painter, Rect, Shape, Stroke, pos2, vec2};
use pickglass::design::{Design, Lifting, Srgb, YarnId, YarnMap};

use super::super::laid;
use super::areas::{Areas, Loom};
use super::bands::{Band, draft, wrapped};
use super::grid::CellGrid;
use crate::tokens::{self, Palette};

/// Marks beyond this number are not drawn: they would be smaller than a pixel.
const MOST_MARKS: usize = 60_000;
/// Threads whose mean a pixel of a bar is, at most.
const MOST_MEANT: usize = 16;

/// Draws all bands.
pub fn show(painter: &Painter, grid: &CellGrid, areas: &Areas, design: &Design, palette: &Palette) {
    bars(painter, grid, areas, design, palette);
    let (Some(draft), Some(loom)) = (draft(design), areas.loom) else {
        veils(painter, grid, areas, design, palette);
        return;
    };
    for area in [areas.threading, areas.tieup, areas.treadling] {
        painter.rect_filled(area, 0.0, palette.paper);
    }
    let mut marks = Marks {
        mesh: Mesh::default(),
        left: MOST_MARKS,
        colour: palette.ink,
        gap: if loom.cell > 6.0 {
            2.0 * grid.pixel()
        } else {
            0.0
        },
    };
    let [ends, picks] = grid.visible();
    for end in ends.clone() {
        for &shaft in draft
            .threading()
            .row(wrapped(draft, Band::Threading, (end, 0)).0 as usize)
        {
            let cell = (end, i64::from(shaft));
            marks.put(Band::Threading.place(areas, grid, cell), areas.threading);
        }
    }
    match draft.lifting() {
        Lifting::Treadled { tieup, treadling } => {
            for (treadle, shafts) in tieup.iter().enumerate() {
                for &shaft in shafts {
                    let cell = (treadle as i64, i64::from(shaft));
                    marks.put(Band::TieUp.place(areas, grid, cell), areas.tieup);
                }
            }
            for pick in picks.clone() {
                let home = wrapped(draft, Band::Treadling, (0, pick)).1;
                for &treadle in treadling.row(home as usize) {
                    let cell = (i64::from(treadle), pick);
                    marks.put(Band::Treadling.place(areas, grid, cell), areas.treadling);
                }
            }
        }
        Lifting::LiftPlan(plan) => {
            for pick in picks.clone() {
                let home = wrapped(draft, Band::Treadling, (0, pick)).1;
                for &shaft in plan.row(home as usize) {
                    let cell = (i64::from(shaft), pick);
                    marks.put(Band::Treadling.place(areas, grid, cell), areas.treadling);
                }
            }
            for shaft in 0..i64::from(loom.shafts) {
                marks.put(Band::TieUp.place(areas, grid, (shaft, shaft)), areas.tieup);
            }
        }
    }
    painter.add(Shape::mesh(marks.mesh));
    lines(painter, grid, areas, &loom, palette);
    veils(painter, grid, areas, design, palette);
}

/// Squares for set cells.
struct Marks {
    mesh: Mesh,
    left: usize,
    colour: Color32,
    gap: f32,
}

impl Marks {
    fn put(&mut self, place: Rect, within: Rect) {
        let inside = place.shrink(self.gap).intersect(within);
        if self.left > 0 && inside.is_positive() {
            self.left -= 1;
            self.mesh.add_colored_rect(inside, self.colour);
        }
    }
}

/// Lines between shafts, treadles, ends and picks.
fn lines(painter: &Painter, grid: &CellGrid, areas: &Areas, loom: &Loom, palette: &Palette) {
    let pixel = grid.pixel();
    let mut mesh = Mesh::default();
    let mut rows = |area: Rect, at: f32| {
        let line = Rect::from_min_size(pos2(area.left(), at), vec2(area.width(), pixel));
        if line.intersect(area).is_positive() {
            mesh.add_colored_rect(line.intersect(area), palette.rule);
        }
    };
    // Only as many as can be seen at all.
    let shown = |first: i64, count: u32| first..i64::from(count).min(first + 1000);
    for shaft in shown(loom.first[0], loom.shafts) {
        for area in [areas.threading, areas.tieup] {
            rows(area, areas.shaft_top(shaft));
        }
    }
    let [ends, picks] = grid.visible();
    if grid.cell >= 6.0 {
        for pick in picks {
            rows(areas.treadling, grid.line_y(pick));
        }
    }
    let mut columns = |area: Rect, at: f32| {
        let line = Rect::from_min_size(pos2(at, area.top()), vec2(pixel, area.height()));
        if line.intersect(area).is_positive() {
            mesh.add_colored_rect(line.intersect(area), palette.rule);
        }
    };
    for treadle in shown(loom.first[1], loom.columns) {
        for area in [areas.tieup, areas.treadling] {
            columns(area, areas.treadle_left(treadle));
        }
    }
    if grid.cell >= 6.0 {
        for end in ends {
            columns(areas.threading, grid.line_x(end));
        }
    }
    painter.add(Shape::mesh(mesh));
    for area in [areas.threading, areas.tieup, areas.treadling] {
        let stroke = Stroke::new(pixel, palette.rule);
        painter.rect_stroke(area, 0.0, stroke, egui::StrokeKind::Outside);
    }
}

/// Fades what lies beside the first repeat, that of the colours beside the bars.
fn veils(painter: &Painter, grid: &CellGrid, areas: &Areas, design: &Design, palette: &Palette) {
    let weave = grid.rect(0, 0, i64::from(design.ends()), i64::from(design.picks()));
    let (ends, picks) = laid::whole(design);
    let whole = grid.rect(0, 0, ends.into(), picks.into());
    let veil = palette.deep.gamma_multiply(0.6);
    for (area, home) in [(areas.threading, weave), (areas.warp_bar, whole)] {
        for side in [area.with_max_x(home.left()), area.with_min_x(home.right())] {
            if side.intersect(area).is_positive() {
                painter.rect_filled(side.intersect(area), 0.0, veil);
            }
        }
    }
    for (area, home) in [(areas.treadling, weave), (areas.weft_bar, whole)] {
        for side in [area.with_max_y(home.top()), area.with_min_y(home.bottom())] {
            if side.intersect(area).is_positive() {
                painter.rect_filled(side.intersect(area), 0.0, veil);
            }
        }
    }
}

/// The yarns of ends and picks.
fn bars(painter: &Painter, grid: &CellGrid, areas: &Areas, design: &Design, palette: &Palette) {
    let [ends, picks] = grid.visible();
    // A pixel shows the mean of its threads, as the drawdown does.
    let skip = (1.0 / grid.cell).ceil().max(1.0) as usize;
    let mut mesh = Mesh::default();
    let mean = |first: i64, yarn: &dyn Fn(i64) -> YarnId| {
        let step = (skip / MOST_MEANT).max(1);
        let threads = (first..first + skip as i64).step_by(step);
        let count = threads.clone().count().max(1) as f32;
        let sum = threads
            .map(|thread| design.yarn(yarn(thread)).colour.to_linear())
            .reduce(|sum, colour| sum + colour);
        let Srgb(red, green, blue) = Srgb::from_linear(sum.unwrap_or_default() / count);
        tokens::yarn_colour(red, green, blue)
    };
    let crossings = |map: &YarnMap| matches!(map, YarnMap::Crossings(_));
    let maps = design.maps();
    for end in ends.step_by(skip) {
        let place = Band::WarpBar
            .place(areas, grid, (end, 0))
            .intersect(areas.warp_bar);
        let place = place.with_max_x(place.right().max(place.left() + grid.pixel()));
        if !crossings(&maps.warp) && place.is_positive() {
            mesh.add_colored_rect(place, mean(end, &|end| design.warp_yarn(end, 0)));
        }
    }
    for pick in picks.step_by(skip) {
        let place = Band::WeftBar
            .place(areas, grid, (0, pick))
            .intersect(areas.weft_bar);
        let place = place.with_max_y(place.bottom().max(place.top() + grid.pixel()));
        if !crossings(&maps.weft) && place.is_positive() {
            mesh.add_colored_rect(place, mean(pick, &|pick| design.weft_yarn(0, pick)));
        }
    }
    painter.add(Shape::mesh(mesh));
    for bar in [areas.warp_bar, areas.weft_bar] {
        let stroke = Stroke::new(grid.pixel(), palette.rule);
        painter.rect_stroke(bar, 0.0, stroke, egui::StrokeKind::Outside);
    }
}
