//! The draft pane: threading, tie-up, treadling, colour bars and the drawdown, all to be
//! painted in.
//!
//! [`areas`] divides the pane and [`grid`] says where crossings lie. [`picture`] draws all,
//! from [`tiles`], [`draw`] and [`bands_picture`]. [`zone`] turns pointer and keys into touches,
//! which [`input`] hands to [`strokes`] and [`bands`]: they turn them into edits, which go
//! out as actions.

mod areas;
mod bands;
mod bands_picture;
mod draw;
mod grid;
mod held_back;
mod input;
mod navigator;
mod picture;
pub mod reference;
mod strokes;
mod tiles;
mod zone;

use egui::{Event, Key};
use pickglass::design::{Structure, YarnId};
use pickglass::edit::{Change, Clip, Document, Rect as Crossings};

use super::action::{Action, Button, Mark};
use super::laid;
use super::settings::Settings;
use crate::command_table::{Command, DraftLayout, Tool, ZoomCommand};
use crate::tokens;
use areas::Areas;
use bands::Band;
pub use bands::draft as draft_of;
pub use grid::picture_uv;
use grid::{CellGrid, Look};
pub use held_back::HeldBack;
use reference::Reference;
pub use strokes::tool_name;
use zone::{Cell, Zone};

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

/// Steps by which everything that is painted is painted again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Steps {
    pub on: bool,
    /// Ends and picks; 0 = not in this direction.
    pub every: [u32; 2],
}

impl Default for Steps {
    fn default() -> Self {
        Self {
            on: false,
            every: [8; 2],
        }
    }
}

/// A tool whose key is down. It is given back with the key only where it was used
/// meanwhile: how long the key was down says nothing, since between two slow frames a tap
/// is as long as any.
struct Held {
    key: Key,
    before: Tool,
    used: bool,
}

/// The draft pane's state.
pub struct DraftPane {
    pub show: Showing,
    /// Painting is mirrored left and right, top and bottom.
    pub symmetry: [bool; 2],
    /// Painting is repeated in steps.
    pub steps: Steps,
    /// The picture that is drawn by.
    pub reference: Option<Reference>,
    /// Longest floats over picks and over ends that are not marked.
    pub limits: [u32; 2],
    pub mark: Mark,
    /// What a stroke painted on the drawdown of a draft, until it ends.
    pub held_back: Option<HeldBack>,
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
    /// The shaft and the column that bands begin with, where not all of them fit.
    first_shaft: [i64; 2],
    /// What the field under the pointer is for.
    told: Option<&'static str>,
    /// How the pane was divided when it was shown last.
    #[cfg(test)]
    laid: Option<(Areas, CellGrid)>,
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
            steps: Steps::default(),
            reference: None,
            limits: [USUAL_LIMIT; 2],
            mark: Mark::Nothing,
            held_back: None,
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
            first_shaft: [0; 2],
            told: None,
            #[cfg(test)]
            laid: None,
        }
    }

    /// Forgets what was seen: another document is open. What was copied stays.
    pub fn forget(&mut self) {
        self.look = None;
        self.tiles.clear();
        self.navigator.forget();
        self.selection = None;
        self.reference = None;
        self.mark = Mark::Nothing;
        (self.yarns, self.regions) = ([YarnId(0), YarnId(1)], [0, 1]);
        self.give_up();
    }

    /// Ends strokes that were refused.
    pub fn give_up(&mut self) {
        self.stroke = None;
        self.held_back = None;
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

    /// Whether draft and cloth are turned by 180°.
    pub fn turned(&self) -> bool {
        self.show.arrangement.turns()
    }

    /// The tool in use.
    pub fn tool(&self) -> Tool {
        self.tool
    }

    /// What the status line says: what the field under the pointer is for, or the tool.
    pub fn tool_words(&self) -> &'static str {
        self.told.unwrap_or(tool_name(self.tool))
    }

    /// Takes a tool; for the moment only, where it is used while its key is down.
    pub fn take_tool(&mut self, ctx: &egui::Context, tool: Tool) {
        let key = super::menu::key_of(Command::Use(tool));
        // The key repeats while it is held: what was before stays what it was.
        if key.is_none() || self.held.as_ref().map(|held| held.key) != key {
            let down = key.filter(|key| ctx.input(|input| input.key_down(*key)));
            self.held = down.map(|key| Held {
                key,
                before: self.tool,
                used: false,
            });
        }
        self.tool = tool;
    }

    fn tool_used(&mut self) {
        if let Some(held) = &mut self.held {
            held.used = true;
        }
    }

    /// Gives the tool back whose key was let go, if it was used. Where the key went up
    /// after a press of the pointer in the same frame, the press comes first.
    fn let_go(&mut self, ui: &egui::Ui, pressed: bool) {
        let Some(held) = &self.held else { return };
        let (down, waits) = ui.input(|input| {
            let waits = !pressed && pressed_before(&input.events, held.key);
            (input.key_down(held.key), waits)
        });
        if !down && !waits && !self.drawdown.in_stroke() {
            if held.used {
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

    /// Takes this as copied.
    pub fn copy(&mut self, clip: Clip) {
        self.clip = Some(clip);
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

    /// Whether the keyboard is in the drawdown or a field beside it.
    pub fn has_focus(&self, ctx: &egui::Context) -> bool {
        let focused = ctx.memory(|memory| memory.focused());
        let zones = self.bands.iter().chain([&self.drawdown]);
        focused.is_some() && zones.into_iter().any(|zone| zone.id() == focused)
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
    pub fn zoom_as(&mut self, command: ZoomCommand) {
        match (command, &mut self.look) {
            (ZoomCommand::Fit, look) => *look = None,
            (ZoomCommand::ActualSize, Some(look)) => look.actual(),
            (ZoomCommand::In, Some(look)) => look.zoom(1, [0.0, 0.0]),
            (ZoomCommand::Out, Some(look)) => look.zoom(-1, [0.0, 0.0]),
            // It is fitted when it is shown first.
            (ZoomCommand::ActualSize | ZoomCommand::In | ZoomCommand::Out, None) => {}
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
            let areas = Areas::split(pane, design, arrangement, 16.0, density, [0; 2]);
            let room = areas.drawdown.size();
            let room = [room.x, room.y].map(|side| f64::from(side * density));
            let (ends, picks) = laid::whole(design);
            Look::fitting(ends, picks, room)
        });
        let first = self.first_shaft;
        let areas = Areas::split(pane, design, arrangement, look.cell(), density, first);
        let grid = CellGrid::new(areas.drawdown, &look, density, self.turned());
        #[cfg(test)]
        {
            self.laid = Some((areas, grid));
        }
        self.let_go(ui, false);
        self.drawdown_touches(ui, document, &areas, &grid, actions);
        self.let_go(ui, true);
        self.band_touches(ui, document, &areas, &grid, actions);
        self.draw(ui, document, &areas, &grid, &look);
        if let Some(reference) = &mut self.reference
            && !reference.window(ui.ctx())
        {
            self.reference = None;
        }
        if self.show.navigator {
            let moved = self.navigator.show(ui, document, &areas, &grid);
            if let (Some(centre), Some(look)) = (moved, &mut self.look) {
                look.centre = centre;
            }
        }
    }

    /// Gives the keyboard to the drawdown.
    pub fn focus(&self, ctx: &egui::Context) {
        if let Some(id) = self.drawdown.id() {
            ctx.memory_mut(|memory| memory.request_focus(id));
        }
    }
}

#[cfg(test)]
impl DraftPane {
    /// The middle of a crossing on the screen.
    pub fn place_of(&self, (end, pick): Cell) -> egui::Pos2 {
        let (_, grid) = self.laid.expect("shown once");
        grid.rect(end, pick, 1, 1).center()
    }

    /// The crossing at a place of the screen.
    pub fn crossing_at(&self, at: egui::Pos2) -> Cell {
        let (_, grid) = self.laid.expect("shown once");
        grid.crossing(at)
    }

    /// Where the drawdown lies on the screen.
    pub fn drawdown_rect(&self) -> egui::Rect {
        self.laid.expect("shown once").0.drawdown
    }

    /// Physical pixels a crossing.
    pub fn cell(&self) -> f64 {
        self.laid.expect("shown once").1.cell
    }

    /// The middle of a cell of the threading.
    pub fn threading_place(&self, cell: Cell) -> egui::Pos2 {
        let (areas, grid) = self.laid.expect("shown once");
        Band::Threading.place(&areas, &grid, cell).center()
    }

    /// The middle of an end in the colour bar.
    pub fn bar_place(&self, end: i64) -> egui::Pos2 {
        let (areas, grid) = self.laid.expect("shown once");
        Band::WarpBar.place(&areas, &grid, (end, 0)).center()
    }
}

/// Whether the pointer was pressed before this key went up.
fn pressed_before(events: &[Event], up: Key) -> bool {
    let is_up =
        |event: &Event| matches!(event, Event::Key { key, pressed: false, .. } if *key == up);
    let is_press = |event: &Event| matches!(event, Event::PointerButton { pressed: true, .. });
    let mut before = events.iter().take_while(|event| !is_up(event));
    before.any(is_press)
}

/// Whether the drawdown follows from a shaft draft.
pub fn is_shaft_draft(document: &Document) -> bool {
    matches!(document.design().structure(), Structure::Draft(_))
}
