//! The draft pane drawn: the drawdown in its layers, the bands beside it, and the focus.

use egui::{Rect, Shape};
use pickglass::design::Colouring;
use pickglass::edit::Document;

use super::super::focus;
use super::areas::Areas;
use super::bands::Band;
use super::grid::{CellGrid, Look};
use super::zone::{Cell, Zone};
use super::{DraftPane, Layer, bands_picture, draw};
use crate::command_table::Tool;
use crate::tokens::{self, Palette};

impl DraftPane {
    /// Regions are shown while they are painted, else the yarns or the bare structure.
    fn colouring(&self, document: &Document) -> Colouring {
        match self.layer(document) {
            Layer::Regions => Colouring::Regions,
            Layer::Weave if self.show.structure_alone => Colouring::Structure,
            Layer::Weave => Colouring::Yarns,
        }
    }

    pub(super) fn draw(
        &mut self,
        ui: &egui::Ui,
        document: &Document,
        areas: &Areas,
        grid: &CellGrid,
        look: &Look,
    ) {
        let palette = Palette::current(ui);
        let (design, drawdown) = (document.design(), document.drawdown());
        let painter = ui.painter_at(areas.drawdown);
        painter.rect_filled(areas.drawdown, 0.0, palette.deep);
        let colouring = self.colouring(document);
        self.tiles.show(&painter, grid, look, document, colouring);
        if colouring != Colouring::Structure
            && let Some(mesh) = draw::thread_edges(grid, design, drawdown)
        {
            painter.add(Shape::mesh(mesh));
        }
        if let Some(reference) = &self.reference {
            reference.draw(&painter, grid, design);
        }
        if self.show.grid_lines {
            draw::grid_lines(&painter, grid);
        }
        if self.show.long_floats {
            draw::long_floats(&painter, grid, design, drawdown, self.limits, &palette);
        }
        draw::mark(&painter, grid, document, self.mark);
        draw::ghosts(&painter, grid, design, self.show.ghosts, &palette);
        if let Some(selection) = self.selection {
            draw::selection(&painter, grid, selection);
        }
        if let Some(held) = &self.held_back {
            draw::held_back(&painter, grid, design, &held.warp_up, true);
            draw::held_back(&painter, grid, design, &held.weft_up, false);
        }
        self.draw_stamp(&painter, grid);
        let whole = ui.painter();
        bands_picture::show(whole, grid, areas, design, &palette);
        if let Some(hover) = self.hover {
            draw::crosshair(whole, grid, areas, hover);
        }
        // Over the crosshair, so that its number can be read.
        draw::rulers(whole, grid, areas, design, self.hover, &palette);
        self.draw_focus(ui, areas, grid);
    }

    /// Where a click would put what was copied.
    fn draw_stamp(&self, painter: &egui::Painter, grid: &CellGrid) {
        if let (Tool::Stamp, Some(clip), Some((end, pick))) = (self.tool, &self.clip, self.hover) {
            let (ends, picks) = clip.size();
            let rect = grid.rect(end, pick, i64::from(ends), i64::from(picks));
            draw::outline(painter, rect);
        }
    }

    /// The field with the keyboard, and its cursor.
    fn draw_focus(&self, ui: &egui::Ui, areas: &Areas, grid: &CellGrid) {
        let Some(focused) = ui.memory(|memory| memory.focused()) else {
            return;
        };
        let palette = Palette::current(ui);
        let frame = |rect: Rect, cursor: Option<Rect>| {
            let around = rect.expand(tokens::FOCUS);
            focus::ring(&ui.painter_at(around), around, &palette);
            if let Some(cursor) = cursor {
                draw::outline(&ui.painter_at(rect), cursor);
            }
        };
        if Some(focused) == self.drawdown.id() {
            let place = |(end, pick)| grid.rect(end, pick, 1, 1);
            frame(areas.drawdown, marked(&self.drawdown, place));
        }
        for (band, zone) in Band::ALL.into_iter().zip(&self.bands) {
            if Some(focused) == zone.id() {
                let place = |cell| band.place(areas, grid, cell);
                frame(band.rect(areas), marked(zone, place));
            }
        }
    }
}

/// The keyboard's cell of a field, or its range.
fn marked(zone: &Zone, place: impl Fn(Cell) -> Rect) -> Option<Rect> {
    match zone.shown_range() {
        Some((from, to)) => Some(place(from).union(place(to))),
        None => zone.shown_cursor().map(place),
    }
}
