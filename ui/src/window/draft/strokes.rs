//! The tools on the drawdown: what a press, a drag and a release of each ask for.

use pickglass::design::{Grid, Structure, WeavePattern};
use pickglass::edit::{Cells, Document, Edit, Rect};

use super::super::action::{Action, Button};
use super::super::toasts::Grade;
use super::shape;
use super::zone::{Cell, Touch};
use super::{DraftPane, Layer};
use crate::command_table::Tool;

/// A stroke that is being made on the drawdown.
#[derive(Debug, Clone)]
pub struct Stroke {
    tool: Tool,
    button: Button,
    from: Cell,
    reached: Cell,
    /// What is moved: its place before, and what lay there.
    moved: Option<(Rect, Clip)>,
}

/// Copied crossings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Clip {
    pub weave: WeavePattern,
    /// Their regions, where they are copied from artwork.
    pub regions: Option<Grid<u16>>,
}

impl Clip {
    /// What lies in a box of the design.
    pub fn of(document: &Document, rect: Rect, layer: Layer) -> Option<Self> {
        let (design, drawdown) = (document.design(), document.drawdown());
        let inside =
            rect.end + rect.ends <= design.ends() && rect.pick + rect.picks <= design.picks();
        if !inside {
            return None;
        }
        let weave = WeavePattern::from_fn(rect.ends, rect.picks, |end, pick| {
            drawdown.get(rect.end + end, rect.pick + pick)
        });
        let regions = match design.structure() {
            Structure::Regions(regions) if layer == Layer::Regions => {
                let map = regions.map();
                Grid::from_fn(rect.ends, rect.picks, |end, pick| {
                    map.get(rect.end + end, rect.pick + pick)
                })
                .ok()
            }
            _ => None,
        };
        Some(Self { weave, regions })
    }

    /// The weave as text, for other programs: `#` = warp up, the last line is pick 0. What
    /// is too large for a text is named instead.
    pub fn text(&self) -> String {
        const MOST: u64 = 1 << 18;
        let (ends, picks) = (self.weave.ends(), self.weave.picks());
        if u64::from(ends) * u64::from(picks) > MOST {
            return format!("{ends} × {picks} crossings");
        }
        self.weave.to_string()
    }

    /// The edit that puts it with its lower left crossing at a place of the cloth.
    pub fn put(&self, document: &Document, (end, pick): Cell) -> Option<Edit> {
        let design = document.design();
        let (ends, picks) = (design.ends(), design.picks());
        let mut cells = Cells::none(ends, picks);
        let mut values = WeavePattern::new(ends, picks);
        let mut regions = match (&self.regions, design.structure()) {
            (Some(_), Structure::Regions(regions)) => Some(regions.map().clone()),
            _ => None,
        };
        for up in 0..self.weave.picks() {
            for right in 0..self.weave.ends() {
                let at = (end + i64::from(right), pick + i64::from(up));
                let Some((e, p)) = design.lattice().wrap(at.0, at.1, ends, picks) else {
                    continue;
                };
                cells.insert(e, p);
                match (&mut regions, &self.regions) {
                    (Some(map), Some(own)) => map.set(e, p, own.get(right, up)),
                    _ => values.set(e, p, self.weave.get(right, up)),
                }
            }
        }
        Some(match regions {
            Some(regions) => Edit::PlaceRegions {
                cells,
                regions: Box::new(regions),
            },
            None => Edit::Place { cells, values },
        })
    }
}

impl DraftPane {
    /// Does what a tool does at one touch of the drawdown.
    pub(super) fn stroke(
        &mut self,
        document: &Document,
        touch: Touch,
        shift: bool,
        actions: &mut Vec<Action>,
    ) {
        match touch {
            Touch::Press(cell, button) => self.press(document, cell, button, actions),
            Touch::Drag(cell) => self.drag(document, cell, shift, actions),
            Touch::Release => {
                if let Some(stroke) = self.stroke.take() {
                    self.release(&stroke, actions);
                }
            }
            Touch::Cancel => {
                self.stroke = None;
                actions.push(Action::Cancel);
            }
            Touch::Key(cell, button) => self.key(document, cell, button, actions),
        }
    }

    /// Keys paint like the tool would; the pencil exchanges warp and weft.
    fn key(&mut self, document: &Document, cell: Cell, button: Button, actions: &mut Vec<Action>) {
        let flip = self.tool() == Tool::Pencil && self.layer(document) == Layer::Weave;
        if flip && let Some(cells) = shape::cells(document, [cell], self.symmetry) {
            actions.push(Action::edit(Edit::Flip(cells)));
            return;
        }
        self.press(document, cell, button, actions);
        if let Some(stroke) = self.stroke.take() {
            self.release(&stroke, actions);
        }
    }

    fn press(
        &mut self,
        document: &Document,
        cell: Cell,
        button: Button,
        actions: &mut Vec<Action>,
    ) {
        let tool = self.tool();
        self.tool_used();
        let mut stroke = Stroke {
            tool,
            button,
            from: cell,
            reached: cell,
            moved: None,
        };
        match tool {
            Tool::Pencil | Tool::Line | Tool::Rectangle => {
                actions.push(Action::Begin(tool_name(tool).to_owned()));
                self.paint(document, [cell], button, actions);
            }
            Tool::Fill | Tool::Replace => {
                let found = match tool {
                    Tool::Fill => shape::fill(document, cell, self.layer(document)),
                    _ => shape::alike(document, cell, self.layer(document)),
                };
                if let Some(cells) = found {
                    actions.push(Action::Begin(tool_name(tool).to_owned()));
                    self.paint_cells(document, cells, button, actions);
                    actions.push(Action::Finish);
                }
                return;
            }
            Tool::Picker => {
                self.pick(document, cell, button, actions);
            }
            Tool::Select => self.select_between(document, cell, cell),
            Tool::Move => match self.selection().and_then(|rect| {
                let clip = Clip::of(document, rect, self.layer(document))?;
                Some((rect, clip))
            }) {
                Some(moved) => {
                    stroke.moved = Some(moved);
                    actions.push(Action::Begin(tool_name(tool).to_owned()));
                }
                None => actions.push(nothing("Nothing is selected: select crossings first (S).")),
            },
            Tool::Stamp => match self.clip().and_then(|clip| clip.put(document, cell)) {
                Some(edit) => {
                    actions.push(Action::Begin(tool_name(tool).to_owned()));
                    actions.push(Action::edit(edit));
                    actions.push(Action::Finish);
                }
                None => actions.push(nothing(
                    "Nothing was copied: select crossings and copy them.",
                )),
            },
        }
        self.stroke = Some(stroke);
    }

    fn drag(&mut self, document: &Document, cell: Cell, shift: bool, actions: &mut Vec<Action>) {
        let Some(mut stroke) = self.stroke.take() else {
            return;
        };
        match stroke.tool {
            Tool::Pencil => {
                let path = shape::line(stroke.reached, cell);
                self.paint(document, path, stroke.button, actions);
            }
            Tool::Line => {
                actions.push(Action::Restart);
                let path = shape::line(stroke.from, cell);
                self.paint(document, path, stroke.button, actions);
            }
            Tool::Rectangle => {
                actions.push(Action::Restart);
                let found = shape::rectangle(document, stroke.from, cell, shift, self.symmetry);
                if let Some(cells) = found {
                    self.paint_cells(document, cells, stroke.button, actions);
                }
            }
            Tool::Select => self.select_between(document, stroke.from, cell),
            Tool::Move => {
                if let Some((rect, clip)) = &stroke.moved {
                    actions.push(Action::Restart);
                    let by = (cell.0 - stroke.from.0, cell.1 - stroke.from.1);
                    self.move_by(document, *rect, clip, by, actions);
                }
            }
            Tool::Picker => self.pick(document, cell, stroke.button, actions),
            Tool::Fill | Tool::Replace | Tool::Stamp => {}
        }
        stroke.reached = cell;
        self.stroke = Some(stroke);
    }

    fn release(&mut self, stroke: &Stroke, actions: &mut Vec<Action>) {
        match stroke.tool {
            Tool::Pencil | Tool::Line | Tool::Rectangle => actions.push(Action::Finish),
            Tool::Move if stroke.moved.is_some() => actions.push(Action::Finish),
            _ => {}
        }
    }

    /// Moves what was selected: weft up is left behind, and the selection goes along.
    fn move_by(
        &mut self,
        document: &Document,
        rect: Rect,
        clip: &Clip,
        by: (i64, i64),
        actions: &mut Vec<Action>,
    ) {
        let design = document.design();
        let (ends, picks) = (design.ends(), design.picks());
        let to = (i64::from(rect.end) + by.0, i64::from(rect.pick) + by.1);
        if clip.regions.is_none() {
            let cells = Cells::of_rect(ends, picks, rect);
            actions.push(Action::edit(Edit::Paint {
                cells,
                warp_up: false,
            }));
        }
        if let Some(edit) = clip.put(document, to) {
            actions.push(Action::edit(edit));
        }
        let last = |size: u32, count: u32| i64::from(size.saturating_sub(count));
        self.select(Some(Rect {
            end: to.0.clamp(0, last(ends, rect.ends)) as u32,
            pick: to.1.clamp(0, last(picks, rect.picks)) as u32,
            ..rect
        }));
    }

    /// Paints crossings of the endless cloth with what a button stands for.
    fn paint(
        &self,
        document: &Document,
        cells: impl IntoIterator<Item = Cell>,
        button: Button,
        actions: &mut Vec<Action>,
    ) {
        if let Some(cells) = shape::cells(document, cells, self.symmetry) {
            self.paint_cells(document, cells, button, actions);
        }
    }

    fn paint_cells(
        &self,
        document: &Document,
        mut cells: Cells,
        button: Button,
        actions: &mut Vec<Action>,
    ) {
        // A selection keeps the paint inside.
        if let Some(rect) = self.selection() {
            let (ends, picks) = cells.size();
            let outside = Cells::of_rect(ends, picks, rect).inverted();
            cells.subtract(&outside);
        }
        if cells.is_empty() {
            return;
        }
        actions.push(Action::edit(match self.layer(document) {
            Layer::Weave => Edit::Paint {
                cells,
                warp_up: button == Button::First,
            },
            Layer::Regions => Edit::PaintRegion {
                cells,
                region: self.region(button),
            },
        }));
    }

    fn pick(&self, document: &Document, cell: Cell, button: Button, actions: &mut Vec<Action>) {
        let design = document.design();
        let (ends, picks) = (design.ends(), design.picks());
        let Some((end, pick)) = design.lattice().wrap(cell.0, cell.1, ends, picks) else {
            return;
        };
        if let (Layer::Regions, Structure::Regions(regions)) =
            (self.layer(document), design.structure())
        {
            let region = regions.map().get(end, pick);
            actions.push(Action::PaintRegion(region, button));
            return;
        }
        let yarn = if document.drawdown().get(end, pick) {
            design.warp_yarn(cell.0, cell.1)
        } else {
            design.weft_yarn(cell.0, cell.1)
        };
        actions.push(Action::PaintYarn(yarn, button));
    }

    fn select_between(&mut self, document: &Document, from: Cell, to: Cell) {
        let design = document.design();
        let along = |a: i64, b: i64, count: u32| {
            let last = i64::from(count) - 1;
            (a.min(b).clamp(0, last), a.max(b).clamp(0, last))
        };
        let (left, right) = along(from.0, to.0, design.ends());
        let (low, high) = along(from.1, to.1, design.picks());
        self.select(Some(Rect {
            end: left as u32,
            pick: low as u32,
            ends: (right - left + 1) as u32,
            picks: (high - low + 1) as u32,
        }));
    }
}

fn nothing(text: &str) -> Action {
    Action::Say(Grade::Warning, text.to_owned(), String::new())
}

/// What the history calls a stroke of a tool.
pub fn tool_name(tool: Tool) -> &'static str {
    match tool {
        Tool::Pencil => "Pencil",
        Tool::Line => "Line",
        Tool::Rectangle => "Rectangle",
        Tool::Fill => "Fill",
        Tool::Replace => "Replace",
        Tool::Picker => "Picker",
        Tool::Select => "Select",
        Tool::Move => "Move",
        Tool::Stamp => "Stamp",
    }
}
