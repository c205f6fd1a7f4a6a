//! The draft pane: threading, tie-up, treadling, colour bars and the drawdown, all to be
//! painted in.
//!
//! [`areas`] divides the pane, [`grid`] says where crossings lie, [`tiles`] and [`draw`]
//! show them, [`zone`] turns pointer and keys into touches, [`strokes`] and [`bands`] turn
//! touches into edits, which go out as actions.

mod areas;
mod bands;
mod draw;
mod grid;
mod navigator;
mod shape;
mod strokes;
mod tiles;
mod zone;

use egui::{Key, PointerButton, Rect, Shape};
use pickglass::design::{Colouring, Structure, WeavePattern, YarnId};
use pickglass::edit::{Change, Document, Rect as Crossings};

use super::action::{Action, Button, Mark};
use super::settings::Settings;
use crate::command_table::{Command, DraftLayout, Tool};
use crate::tokens::{self, Palette};
use areas::Areas;
use bands::Band;
use grid::{CellGrid, Look};
pub use strokes::{Clip, tool_name};
use zone::{Cell, Touch, Zone};

/// Holding a tool's key for longer than this makes it a tool for the moment, s.
const HELD: f64 = 0.3;
/// Points of a wheel's turn that make one step of zoom.
const WHEEL_STEP: f32 = 40.0;
/// Floats over more threads than this are long, where nobody says otherwise.
const USUAL_LIMIT: u32 = 7;

/// What of the draft is shown.
#[derive(Debug, Clone)]
pub struct Showing {
    pub arrangement: DraftLayout,
    pub structure_alone: bool,
    pub grid_lines: bool,
    pub ghosts: bool,
    pub long_floats: bool,
    pub navigator: bool,
}

/// What painting changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layer {
    /// Which thread is on top.
    #[default]
    Weave,
    /// Which region a crossing belongs to.
    Regions,
}

/// A tool that is used while its key is held.
struct Held {
    key: Key,
    before: Tool,
    since: f64,
    used: bool,
}

/// The draft pane's state.
pub struct DraftPane {
    pub show: Showing,
    /// Painting is mirrored left and right, top and bottom.
    pub symmetry: [bool; 2],
    /// Longest floats over picks and over ends that are not marked.
    pub limits: [u32; 2],
    pub mark: Mark,
    pub yarns: [YarnId; 2],
    pub regions: [u16; 2],
    chosen_layer: Layer,
    tool: Tool,
    held: Option<Held>,
    stroke: Option<strokes::Stroke>,
    selection: Option<Crossings>,
    clip: Option<Clip>,
    look: Option<Look>,
    tiles: tiles::Tiles,
    drawdown: Zone,
    bands: [Zone; 5],
    /// The stroke in a band: which, and whether it sets cells.
    band_stroke: Option<(Band, bool, Button, Cell)>,
    navigator: navigator::Navigator,
    hover: Option<(i64, i64)>,
    wheel: f32,
    in_use: bool,
}

impl DraftPane {
    /// A pane that shows what the settings say.
    pub fn of(settings: &Settings) -> Self {
        Self {
            show: Showing {
                arrangement: settings.arrangement,
                structure_alone: false,
                grid_lines: settings.grid_lines,
                ghosts: settings.ghosts,
                long_floats: settings.long_floats,
                navigator: settings.navigator,
            },
            symmetry: [false; 2],
            limits: [USUAL_LIMIT; 2],
            mark: Mark::Nothing,
            yarns: [YarnId(0), YarnId(1)],
            regions: [0, 1],
            chosen_layer: Layer::Weave,
            tool: Tool::Pencil,
            held: None,
            stroke: None,
            selection: None,
            clip: None,
            look: None,
            tiles: tiles::Tiles::default(),
            drawdown: Zone::default(),
            bands: [Zone::default(); 5],
            band_stroke: None,
            navigator: navigator::Navigator::default(),
            hover: None,
            wheel: 0.0,
            in_use: false,
        }
    }

    /// Forgets what was seen: another document is open. What was copied stays.
    pub fn forget(&mut self) {
        self.look = None;
        self.tiles.clear();
        self.navigator.forget();
        self.selection = None;
        self.mark = Mark::Nothing;
        (self.yarns, self.regions) = ([YarnId(0), YarnId(1)], [0, 1]);
        self.give_up();
    }

    /// Ends strokes that were refused.
    pub fn give_up(&mut self) {
        self.stroke = None;
        self.band_stroke = None;
        self.drawdown.give_up();
        self.bands.iter_mut().for_each(Zone::give_up);
    }

    /// Draws again what an edit changed.
    pub fn changed(&mut self, document: &Document, change: &Change) {
        self.tiles.changed(document, change);
        self.navigator.changed(change);
        if change.size {
            self.look = None;
            self.selection = None;
        }
        let yarns = document.design().yarns().len() as u16;
        for yarn in &mut self.yarns {
            yarn.0 = yarn.0.min(yarns.saturating_sub(1));
        }
        if let Structure::Regions(regions) = document.design().structure() {
            let last = (regions.palette().len() as u16).saturating_sub(1);
            for region in &mut self.regions {
                *region = (*region).min(last);
            }
        }
    }

    /// The tool in use.
    pub fn tool(&self) -> Tool {
        self.tool
    }

    /// What the status line says of the tool.
    pub fn tool_words(&self) -> &'static str {
        tool_name(self.tool)
    }

    /// Takes a tool; while its key stays down, for the moment only.
    pub fn take_tool(&mut self, ctx: &egui::Context, tool: Tool) {
        let key = super::menu::key_of(Command::Use(tool));
        let (down, now) =
            ctx.input(|input| (key.is_some_and(|key| input.key_down(key)), input.time));
        if let (Some(key), true) = (key, down) {
            // The key repeats while it is held: what was before stays what it was.
            if self.held.as_ref().is_none_or(|held| held.key != key) {
                self.held = Some(Held {
                    key,
                    before: self.tool,
                    since: now,
                    used: false,
                });
            }
        }
        self.tool = tool;
    }

    fn tool_used(&mut self) {
        if let Some(held) = &mut self.held {
            held.used = true;
        }
    }

    /// Lets a tool that was held for the moment go.
    fn let_go(&mut self, ui: &egui::Ui) {
        let Some(held) = &self.held else { return };
        let (down, now) = ui.input(|input| (input.key_down(held.key), input.time));
        if !down && !self.drawdown.in_stroke() {
            if held.used || now - held.since > HELD {
                self.tool = held.before;
            }
            self.held = None;
        }
    }

    /// The selected crossings.
    pub fn selection(&self) -> Option<Crossings> {
        self.selection
    }

    /// Selects these crossings, or none.
    pub fn select(&mut self, selection: Option<Crossings>) {
        self.selection = selection;
    }

    /// What was copied.
    pub fn clip(&self) -> Option<&Clip> {
        self.clip.as_ref()
    }

    /// Whether anything was copied.
    pub fn has_clip(&self) -> bool {
        self.clip.is_some()
    }

    /// Takes this as copied.
    pub fn copy(&mut self, clip: Clip) {
        self.clip = Some(clip);
    }

    /// The weave that was copied.
    pub fn copied_weave(&self) -> Option<&WeavePattern> {
        self.clip.as_ref().map(|clip| &clip.weave)
    }

    /// What painting changes in this design: regions are there to be painted in artwork.
    pub fn layer(&self, document: &Document) -> Layer {
        match document.design().structure() {
            Structure::Regions(_) => self.chosen_layer,
            _ => Layer::Weave,
        }
    }

    /// Chooses what painting changes.
    pub fn set_layer(&mut self, layer: Layer) {
        self.chosen_layer = layer;
    }

    /// The region a button paints.
    pub fn region(&self, button: Button) -> u16 {
        self.regions[usize::from(button == Button::Second)]
    }

    /// Whether keys such as `F` mean the draft.
    pub fn in_use(&self) -> bool {
        self.in_use
    }

    /// The crossing that any view marks.
    pub fn set_hover(&mut self, hover: Option<(i64, i64)>) {
        self.hover = hover;
    }

    /// Brings a crossing into the middle.
    pub fn look_at(&mut self, end: i64, pick: i64) {
        if let Some(look) = &mut self.look {
            look.centre = [end as f64 + 0.5, pick as f64 + 0.5];
        }
    }

    /// Does what a command of the view menu says.
    pub fn obey(&mut self, command: Command) {
        match (command, &mut self.look) {
            (Command::Fit, look) => *look = None,
            (Command::ActualSize, Some(look)) => look.actual(),
            (Command::ZoomIn, Some(look)) => look.zoom(1, [0.0, 0.0]),
            (Command::ZoomOut, Some(look)) => look.zoom(-1, [0.0, 0.0]),
            _ => {}
        }
    }

    /// Shows the pane.
    pub fn show(&mut self, ui: &mut egui::Ui, document: &Document, actions: &mut Vec<Action>) {
        let pane = ui.available_rect_before_wrap().shrink(tokens::GRID);
        ui.allocate_rect(pane, egui::Sense::hover());
        let density = ui.ctx().pixels_per_point();
        let design = document.design();
        let arrangement = self.show.arrangement;
        let look = *self.look.get_or_insert_with(|| {
            let room = Areas::split(pane, design, arrangement, 16.0, density)
                .drawdown
                .size();
            let room = [room.x, room.y].map(|side| f64::from(side * density));
            Look::fitting(design.ends(), design.picks(), room)
        });
        let areas = Areas::split(pane, design, arrangement, look.cell(), density);
        let grid = CellGrid::new(areas.drawdown, &look, density);
        self.let_go(ui);
        self.drawdown_touches(ui, document, &areas, &grid, actions);
        self.band_touches(ui, document, &areas, &grid, actions);
        self.draw(ui, document, &areas, &grid, &look);
        if self.show.navigator {
            let moved = self.navigator.show(ui, document, &areas, &grid);
            if let (Some(centre), Some(look)) = (moved, &mut self.look) {
                look.centre = centre;
            }
        }
    }

    fn drawdown_touches(
        &mut self,
        ui: &mut egui::Ui,
        document: &Document,
        areas: &Areas,
        grid: &CellGrid,
        actions: &mut Vec<Action>,
    ) {
        let name = format!("Drawdown of {}", document.design().name);
        let panning = self.panning(ui, areas);
        let mut zone = self.drawdown;
        let to_cell = |at| grid.crossing(at);
        let blocked = panning || self.band_stroke.is_some();
        let (response, touches) = zone.touches(
            ui,
            areas.drawdown,
            "drawdown",
            &name,
            to_cell,
            (0, 0),
            blocked,
        );
        let shift = ui.input(|input| input.modifiers.shift);
        if !touches.is_empty() && zone.in_stroke() {
            ui.ctx().request_repaint();
        }
        let moved = zone.cursor != self.drawdown.cursor && response.has_focus();
        self.drawdown = zone;
        for touch in touches {
            self.stroke(document, touch, shift, actions);
        }
        if moved && let Some(cursor) = self.drawdown.cursor {
            self.keep_in_sight(grid, cursor);
            actions.push(Action::Hover(Some(cursor)));
        }
        if response.contains_pointer()
            && let Some(at) = ui.input(|input| input.pointer.hover_pos())
        {
            actions.push(Action::Hover(Some(grid.crossing(at))));
            ui.ctx().set_cursor_icon(if panning {
                egui::CursorIcon::Grab
            } else {
                egui::CursorIcon::Crosshair
            });
        }
        self.in_use = response.hovered() || response.has_focus();
        if response.has_focus()
            && ui.input(|input| input.key_pressed(Key::Escape))
            && self.stroke.is_none()
        {
            self.selection = None;
        }
        self.move_view(ui, document, areas, grid, panning);
        self.menu_of_canvas(ui, &response, actions);
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
        let over = at.is_some_and(|at| areas.drawdown.contains(at));
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
            pan = [delta.x, -delta.y].map(|by| f64::from(by) * grid.density);
        }
        let over = at.filter(|at| areas.drawdown.contains(*at));
        if let Some(at) = over.filter(|_| ui.rect_contains_pointer(areas.drawdown)) {
            if keys.shift {
                pan[0] += f64::from(wheel.x + wheel.y) * grid.density;
            } else {
                self.wheel += wheel.y + (pinch - 1.0) * 200.0;
                let steps = (self.wheel / WHEEL_STEP).trunc();
                self.wheel -= steps * WHEEL_STEP;
                if steps != 0.0 {
                    look.zoom(steps as i32, grid.from_middle(at));
                }
            }
        }
        if pan != [0.0; 2] {
            look.pan(pan, design.ends(), design.picks());
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

    /// The right button paints, so the menu is on Shift+F10.
    fn menu_of_canvas(&self, ui: &egui::Ui, response: &egui::Response, actions: &mut Vec<Action>) {
        let wanted = response.has_focus()
            && ui.input(|input| input.modifiers.shift && input.key_pressed(Key::F10));
        let popup = egui::Popup::from_response(response)
            .id(response.id.with("menu"))
            .open_memory(wanted.then_some(egui::SetOpenCommand::Toggle))
            .close_behavior(egui::PopupCloseBehavior::CloseOnClick);
        popup.show(|ui| {
            for command in CANVAS_MENU {
                let Some(row) = crate::command_table::row_of(command) else {
                    continue;
                };
                if ui.button(row.label).on_hover_text(row.tip).clicked() {
                    actions.push(Action::Command(command));
                }
            }
        });
    }

    fn band_touches(
        &mut self,
        ui: &mut egui::Ui,
        document: &Document,
        areas: &Areas,
        grid: &CellGrid,
        actions: &mut Vec<Action>,
    ) {
        let lift_plan = areas.loom.is_some_and(|loom| loom.lift_plan);
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
            let (response, touches) =
                zone.touches(ui, rect, band.name(false), name, to_cell, (0, 0), blocked);
            self.bands[index] = zone;
            for touch in touches {
                self.band_stroke(ui, document, band, touch, actions);
            }
            self.in_use |= response.hovered() || response.has_focus();
            let at = ui.input(|input| input.pointer.hover_pos());
            if let Some(at) = at.filter(|_| response.contains_pointer()) {
                self.hover = Some(grid.crossing(at));
            }
            response.on_hover_text_at_pointer(band.tip());
        }
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
            Touch::Drag(cell) => {
                if let Some((band, set, button, from)) = self.band_stroke {
                    let mut path: Vec<Cell> = shape::line(from, cell).collect();
                    if band == Band::WarpBar {
                        path.iter_mut().for_each(|cell| cell.1 = 0);
                    }
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

    fn colouring(&self) -> Colouring {
        if self.show.structure_alone {
            Colouring::Structure
        } else {
            Colouring::Yarns
        }
    }

    fn draw(
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
        let colouring = self.colouring();
        self.tiles.show(&painter, grid, look, document, colouring);
        if colouring == Colouring::Yarns
            && let Some(mesh) = draw::thread_edges(grid, design, drawdown)
        {
            painter.add(Shape::mesh(mesh));
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
        self.draw_stamp(&painter, grid);
        let whole = ui.painter();
        bands::show(whole, grid, areas, design, &palette);
        draw::rulers(
            whole,
            grid,
            areas,
            design,
            self.show.arrangement,
            self.hover,
            &palette,
        );
        if let Some(hover) = self.hover {
            draw::crosshair(whole, grid, areas, hover);
        }
        self.draw_focus(ui, areas, grid);
    }

    /// Where a click would put what was copied.
    fn draw_stamp(&self, painter: &egui::Painter, grid: &CellGrid) {
        if let (Tool::Stamp, Some(clip), Some((end, pick))) = (self.tool, &self.clip, self.hover) {
            let (ends, picks) = (clip.weave.ends(), clip.weave.picks());
            let rect = grid.rect(end, pick, i64::from(ends), i64::from(picks));
            draw::outline(painter, rect);
        }
    }

    /// The field with the keyboard, and its cursor.
    fn draw_focus(&self, ui: &egui::Ui, areas: &Areas, grid: &CellGrid) {
        let Some(focused) = ui.memory(|memory| memory.focused()) else {
            return;
        };
        let frame = |rect: Rect, cursor: Option<Rect>| {
            let stroke = egui::Stroke::new(2.0, tokens::ACCENT);
            let painter = ui.painter_at(rect.expand(3.0));
            painter.rect_stroke(rect.expand(1.0), 0.0, stroke, egui::StrokeKind::Middle);
            if let Some(cursor) = cursor {
                draw::outline(&ui.painter_at(rect), cursor);
            }
        };
        if Some(focused) == self.drawdown.id() {
            let cursor = self
                .drawdown
                .cursor
                .map(|(end, pick)| grid.rect(end, pick, 1, 1));
            frame(areas.drawdown, cursor);
        }
        for (band, zone) in Band::ALL.into_iter().zip(&self.bands) {
            if Some(focused) == zone.id() {
                let cursor = zone.cursor.map(|cell| band.place(areas, grid, cell));
                frame(band.rect(areas), cursor);
            }
        }
    }

    /// Gives the keyboard to the drawdown.
    pub fn focus(&self, ctx: &egui::Context) {
        if let Some(id) = self.drawdown.id() {
            ctx.memory_mut(|memory| memory.request_focus(id));
        }
    }

    /// Where a crossing lies on the screen, for tests.
    #[cfg(test)]
    pub fn place_of(
        &self,
        pane: Rect,
        document: &Document,
        cell: Cell,
        density: f32,
    ) -> egui::Pos2 {
        let look = self.look.unwrap_or(Look::fitting(1, 1, [1.0; 2]));
        let areas = Areas::split(
            pane,
            document.design(),
            self.show.arrangement,
            look.cell(),
            density,
        );
        let grid = CellGrid::new(areas.drawdown, &look, density);
        grid.rect(cell.0, cell.1, 1, 1).center()
    }
}

/// Whether the drawdown follows from a shaft draft.
pub fn is_shaft_draft(document: &Document) -> bool {
    matches!(document.design().structure(), Structure::Draft(_))
}

/// What the menu of the canvas offers.
const CANVAS_MENU: [Command; 9] = [
    Command::Undo,
    Command::Redo,
    Command::Cut,
    Command::Copy,
    Command::Paste,
    Command::SelectAll,
    Command::Clear,
    Command::Invert,
    Command::Fit,
];
