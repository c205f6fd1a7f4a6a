//! What pointer, wheel and keys do in the draft pane.

use egui::{Key, PointerButton};
use pickglass::edit::shapes::line;
use pickglass::edit::{Document, Surface};
use pickglass::text::visible;

use super::super::action::{Action, Button};
use super::super::laid;
use super::DraftPane;
use super::areas::Areas;
use super::bands::{self, Band};
use super::grid::CellGrid;
use super::zone::{Cell, Field, Touch};
use crate::command_table::{Command, Tool, WeaveCommand, ZoomCommand, row_of};

/// Points of a wheel's turn that make one step of zoom.
const WHEEL_STEP: f32 = 40.0;

/// What the menu of the canvas offers.
const CANVAS_MENU: [Command; 9] = [
    Command::Undo,
    Command::Redo,
    Command::Weave(WeaveCommand::Cut),
    Command::Weave(WeaveCommand::Copy),
    Command::Weave(WeaveCommand::Paste),
    Command::Weave(WeaveCommand::SelectAll),
    Command::Weave(WeaveCommand::Clear),
    Command::Weave(WeaveCommand::Invert),
    Command::Zoom(ZoomCommand::Fit),
];

impl DraftPane {
    pub(super) fn drawdown_touches(
        &mut self,
        ui: &mut egui::Ui,
        document: &Document,
        areas: &Areas,
        grid: &CellGrid,
        actions: &mut Vec<Action>,
    ) {
        let name = format!("Drawdown of {}", visible(&document.design().name));
        let panning = self.panning(ui, areas);
        let mut zone = self.drawdown;
        let to_cell = |at| grid.crossing(at);
        let covered = self.covered(ui);
        let blocked = panning || covered || self.band_stroke.is_some();
        let (response, touches) = zone.touches(
            ui,
            &Field {
                rect: areas.drawdown,
                key: "drawdown",
                name: &name,
                blocked,
                arrows: arrows(grid, areas, None),
            },
            to_cell,
        );
        let shift = ui.input(|input| input.modifiers.shift);
        if !touches.is_empty() && zone.in_stroke() {
            ui.ctx().request_repaint();
        }
        let by_keys = zone.shown_cursor().is_some() && response.has_focus();
        let moved = by_keys && zone.cursor != self.drawdown.cursor;
        self.drawdown = zone;
        for touch in touches {
            self.stroke(document, touch, shift, actions);
        }
        let focused = response.has_focus();
        if moved && let Some(cursor) = self.drawdown.cursor {
            self.keep_in_sight(grid, cursor);
        }
        let at = ui.input(|input| input.pointer.hover_pos());
        let at = at.filter(|_| response.contains_pointer());
        if at.is_some() {
            ui.ctx().set_cursor_icon(if panning {
                egui::CursorIcon::Grab
            } else {
                egui::CursorIcon::Crosshair
            });
        }
        // Without a pointer the keyboard's cursor is what is looked at.
        let looked_at = match at {
            Some(at) if !moved => Some(grid.crossing(at)),
            _ if focused => self.drawdown.shown_cursor(),
            _ => None,
        };
        if looked_at.is_some() {
            self.hover = looked_at;
            actions.push(Action::Hover(looked_at));
        }
        if response.has_focus()
            && ui.input(|input| input.key_pressed(Key::Escape))
            && self.stroke.is_none()
        {
            self.selection = None;
        }
        self.move_view(ui, document, areas, grid, panning);
        self.menu_of_canvas(ui, &response, grid, actions);
    }

    /// Whether the pointer is on the navigator, which lies over the drawdown.
    fn covered(&self, ui: &egui::Ui) -> bool {
        let at = ui.input(|input| input.pointer.hover_pos());
        self.show.navigator && at.is_some_and(|at| self.navigator.covers(at))
    }

    /// Whether the pointer moves the cloth: the middle button, or Space, over the canvas.
    fn panning(&mut self, ui: &egui::Ui, areas: &Areas) -> bool {
        let typing = ui.ctx().text_edit_focused();
        let (space, middle, at, moving) = ui.input(|input| {
            (
                input.key_down(Key::Space),
                input.pointer.button_down(PointerButton::Middle),
                input.pointer.hover_pos(),
                input.pointer.any_down(),
            )
        });
        let over = at.is_some_and(|at| areas.drawdown.contains(at)) && !self.covered(ui);
        let space = space && !typing && over;
        if space && moving {
            self.drawdown.space_used();
        }
        (space || middle) && (over || moving) && self.stroke.is_none()
    }

    fn move_view(
        &mut self,
        ui: &egui::Ui,
        document: &Document,
        areas: &Areas,
        grid: &CellGrid,
        panning: bool,
    ) {
        let design = document.design();
        let covered = self.covered(ui);
        let Some(look) = &mut self.look else { return };
        let (at, delta, down, wheel, pinch, keys) = ui.input(|input| {
            (
                input.pointer.hover_pos(),
                input.pointer.delta(),
                input.pointer.any_down(),
                input.smooth_scroll_delta(),
                input.zoom_delta(),
                input.modifiers,
            )
        });
        let mut pan = [0.0; 2];
        if panning && down {
            pan = grid.over_cloth(delta);
        }
        let over = at.filter(|at| areas.drawdown.contains(*at) && !covered);
        if let Some(at) = over.filter(|_| ui.rect_contains_pointer(areas.drawdown)) {
            if keys.shift {
                pan[0] += grid.over_cloth(egui::vec2(wheel.x + wheel.y, 0.0))[0];
            } else {
                self.wheel += wheel.y + (pinch - 1.0) * 200.0;
                let steps = (self.wheel / WHEEL_STEP).trunc();
                self.wheel -= steps * WHEEL_STEP;
                if steps != 0.0 {
                    look.zoom(steps as i32, grid.off_middle(at));
                }
            }
        }
        if pan != [0.0; 2] {
            let (ends, picks) = laid::whole(design);
            look.pan(pan, ends, picks);
        }
    }

    /// Moves the view so that the keyboard's cursor stays in it.
    fn keep_in_sight(&mut self, grid: &CellGrid, (end, pick): Cell) {
        let [ends, picks] = grid.visible();
        let Some(look) = &mut self.look else { return };
        let into = |at: i64, seen: &std::ops::RangeInclusive<i64>| {
            let (low, high) = (at - (seen.start() + 1), at - (seen.end() - 1));
            if low < 0 { low } else { high.max(0) }
        };
        look.centre[0] += into(end, &ends) as f64;
        look.centre[1] += into(pick, &picks) as f64;
    }

    /// As [`Self::keep_in_sight`], in a band: its threads, and its shafts and treadles.
    fn keep_band_in_sight(&mut self, areas: &Areas, grid: &CellGrid, band: Band, (x, y): Cell) {
        let middle = grid.crossing(areas.drawdown.center());
        match band {
            Band::Threading | Band::WarpBar => self.keep_in_sight(grid, (x, middle.1)),
            Band::Treadling | Band::WeftBar => self.keep_in_sight(grid, (middle.0, y)),
            Band::TieUp => {}
        }
        let Some(loom) = areas.loom else { return };
        let mut show = |axis: usize, at: i64, length: f32| {
            let fits = ((length / loom.cell).round() as i64).max(1);
            let first = loom.first[axis];
            self.first_shaft[axis] = first.min(at).max(at - fits + 1).max(0);
        };
        if matches!(band, Band::Threading | Band::TieUp) {
            show(0, y, areas.threading.height());
        }
        if matches!(band, Band::Treadling | Band::TieUp) {
            show(1, x, areas.treadling.width());
        }
    }

    /// The right button paints, so the menu is on its own key and on Shift+F10.
    fn menu_of_canvas(
        &self,
        ui: &egui::Ui,
        response: &egui::Response,
        grid: &CellGrid,
        actions: &mut Vec<Action>,
    ) {
        let (end, pick) = self.drawdown.cursor.unwrap_or((0, 0));
        let wanted = response.has_focus()
            && ui.input(|input| {
                let shifted = input.modifiers.shift && input.key_pressed(Key::F10);
                shifted || input.key_pressed(Key::Menu)
            });
        let id = response.id.with("menu");
        let was_open = egui::Popup::is_id_open(ui.ctx(), id);
        let popup = egui::Popup::from_response(response)
            .id(id)
            .at_position(grid.rect(end, pick, 1, 1).right_bottom())
            .open_memory(wanted.then_some(egui::SetOpenCommand::Toggle))
            .close_behavior(egui::PopupCloseBehavior::CloseOnClick);
        popup.show(|ui| {
            for (place, command) in CANVAS_MENU.into_iter().enumerate() {
                let Some(row) = row_of(command) else {
                    continue;
                };
                let button = ui.button(row.label).on_hover_text(row.tip);
                if button.clicked() {
                    actions.push(Action::Command(command));
                    ui.close();
                }
                // The menu has the keyboard as long as it is open.
                if place == 0 && ui.memory(|memory| memory.has_focus(response.id)) {
                    button.request_focus();
                }
            }
        });
        // Whoever used the keys goes on where the menu was opened.
        let by_keys = !ui.input(|input| input.pointer.any_down() || input.pointer.any_released());
        if was_open && by_keys && !egui::Popup::is_id_open(ui.ctx(), id) {
            response.request_focus();
        }
    }

    pub(super) fn band_touches(
        &mut self,
        ui: &mut egui::Ui,
        document: &Document,
        areas: &Areas,
        grid: &CellGrid,
        actions: &mut Vec<Action>,
    ) {
        let lift_plan = areas.loom.is_some_and(|loom| loom.lift_plan);
        self.told = None;
        for (index, band) in Band::ALL.into_iter().enumerate() {
            let rect = band.rect(areas);
            let blank = band == Band::TieUp && lift_plan;
            if !rect.is_positive() || blank {
                continue;
            }
            let name = band.name(lift_plan);
            let mut zone = self.bands[index];
            let to_cell = |at| band.cell(areas, grid, at);
            let blocked = self.stroke.is_some();
            let (response, touches) = zone.touches(
                ui,
                &Field {
                    rect,
                    key: band.name(false),
                    name,
                    blocked,
                    arrows: arrows(grid, areas, Some(band)),
                },
                to_cell,
            );
            let moved = zone.shown_cursor() != self.bands[index].shown_cursor();
            self.bands[index] = zone;
            if let Some(cursor) = zone.shown_cursor().filter(|_| moved) {
                self.keep_band_in_sight(areas, grid, band, cursor);
            }
            for touch in touches {
                self.band_stroke(ui, document, band, touch, actions);
            }
            let at = ui.input(|input| input.pointer.hover_pos());
            if let Some(at) = at.filter(|_| response.contains_pointer()) {
                self.hover = Some(grid.crossing(at));
                self.told = Some(band.tip());
                self.scroll_band(ui, areas, band);
            }
        }
    }

    /// The wheel moves through shafts and treadles that do not fit.
    fn scroll_band(&mut self, ui: &egui::Ui, areas: &Areas, band: Band) {
        let Some(loom) = areas.loom else { return };
        self.wheel += ui.input(|input| input.smooth_scroll_delta().y);
        let steps = (self.wheel / WHEEL_STEP).trunc();
        self.wheel -= steps * WHEEL_STEP;
        let axis = usize::from(band != Band::Threading);
        self.first_shaft[axis] = (loom.first[axis] + steps as i64).max(0);
    }

    fn band_stroke(
        &mut self,
        ui: &egui::Ui,
        document: &Document,
        band: Band,
        touch: Touch,
        actions: &mut Vec<Action>,
    ) {
        let design = document.design();
        let lift_plan = bands::draft(design).is_some_and(|draft| {
            matches!(draft.lifting(), pickglass::design::Lifting::LiftPlan(_))
        });
        let more = ui.input(|input| input.modifiers.command);
        let edit = |cells: &[Cell], set: bool, button: Button| match band {
            Band::WarpBar | Band::WeftBar => {
                let yarn = self.yarns[usize::from(button == Button::Second)];
                bands::bar_edit(design, band, cells, yarn)
            }
            _ => bands::edit(design, band, cells, set, more),
        };
        match touch {
            Touch::Press(cell, button) | Touch::Key(cell, button) => {
                let bar = matches!(band, Band::WarpBar | Band::WeftBar);
                if bar && self.tool == Tool::Picker {
                    let yarn = bands::yarn_of(design, band, cell);
                    actions.push(Action::PaintYarn(yarn, button));
                    return;
                }
                let key = matches!(touch, Touch::Key(..));
                // A key exchanges, so that one key is enough.
                let set = if key {
                    !bands::is_set(design, band, cell)
                } else {
                    bands::sets(design, band, cell, button)
                };
                actions.push(Action::Begin(band.name(lift_plan).to_owned()));
                actions.extend(edit(&[cell], set, button).map(Action::edit));
                if key {
                    actions.push(Action::Finish);
                } else {
                    self.band_stroke = Some((band, set, button, cell));
                }
            }
            Touch::Range(from, to, button) => {
                let set = bands::sets(design, band, to, button);
                actions.push(Action::Begin(band.name(lift_plan).to_owned()));
                let path = cells_between(document, from, to);
                actions.extend(edit(&path, set, button).map(Action::edit));
                actions.push(Action::Finish);
            }
            Touch::Drag(cell) => {
                if let Some((band, set, button, from)) = self.band_stroke {
                    let path = cells_between(document, from, cell);
                    actions.extend(edit(&path, set, button).map(Action::edit));
                    self.band_stroke = Some((band, set, button, cell));
                }
            }
            Touch::Release => {
                if self.band_stroke.take().is_some() {
                    actions.push(Action::Finish);
                }
            }
            Touch::Cancel => {
                self.band_stroke = None;
                actions.push(Action::Cancel);
            }
        }
    }
}

/// Which way an arrow to the right and one upwards go over the cells of a band, or of the
/// drawdown: +1 to higher numbers. Shafts and treadles are counted away from the drawdown.
fn arrows(grid: &CellGrid, areas: &Areas, band: Option<Band>) -> [i64; 2] {
    let thread = if grid.turned { -1 } else { 1 };
    let shaft = if areas.above { 1 } else { -1 };
    match band {
        None | Some(Band::WarpBar | Band::WeftBar) => [thread, thread],
        Some(Band::Threading) => [thread, shaft],
        Some(Band::TieUp) => [1, shaft],
        Some(Band::Treadling) => [1, thread],
    }
}

/// The cells of a straight stroke in a band.
fn cells_between(document: &Document, from: Cell, to: Cell) -> Vec<Cell> {
    let spans = line(&Surface::of(document.design()), from, to);
    let row = |span: pickglass::edit::Span| (span.from..span.to).map(move |end| (end, span.pick));
    spans.into_iter().flat_map(row).collect()
}
