//! The tools on the drawdown: what a press, a drag and a release of each ask for.

use pickglass::design::Structure;
use pickglass::edit::fill::{Alike, everywhere, flood};
use pickglass::edit::shapes::{line, rectangle};
use pickglass::edit::{Cells, Document, Edit, MOST_COPIES, Rect, Span, Surface, Symmetry};

use super::super::action::{Action, Button};
use super::super::toasts::Grade;
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
    /// What is moved, at its place before.
    moved: Option<Rect>,
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
            Touch::Range(from, to, button) => self.range(document, from, to, button, actions),
        }
    }

    /// What a key does with a range: as if the tool had been drawn from one corner to the
    /// other, except that the pencil fills the range.
    fn range(
        &mut self,
        document: &Document,
        from: Cell,
        to: Cell,
        button: Button,
        actions: &mut Vec<Action>,
    ) {
        let tool = self.tool();
        let surface = self.surface(document);
        match tool {
            Tool::Pencil | Tool::Line | Tool::Rectangle => {
                let path = match tool {
                    Tool::Line => line(&surface, from, to),
                    _ => rectangle(&surface, from, to, true),
                };
                self.tool_used();
                actions.push(Action::Begin(tool_name(tool).to_owned()));
                self.paint(document, path, button, actions);
                actions.push(Action::Finish);
            }
            Tool::Select => self.select_between(document, from, to),
            Tool::Move => match self.selection() {
                Some(rect) => {
                    actions.push(Action::Begin(tool_name(tool).to_owned()));
                    self.move_by(document, rect, (to.0 - from.0, to.1 - from.1), actions);
                    actions.push(Action::Finish);
                }
                None => actions.push(nothing("Nothing is selected: select crossings first (S).")),
            },
            Tool::Fill | Tool::Replace | Tool::Picker | Tool::Stamp => {
                self.key(document, to, button, actions);
            }
        }
    }

    /// Keys paint like the tool would; the pencil exchanges warp and weft.
    fn key(&mut self, document: &Document, cell: Cell, button: Button, actions: &mut Vec<Action>) {
        let flip = self.tool() == Tool::Pencil && self.layer(document) == Layer::Weave;
        if let Some(problem) = self.steps_problem(document).filter(|_| flip) {
            actions.push(nothing(&problem));
            return;
        }
        if flip {
            let surface = self.surface(document);
            let cells = surface.cells(line(&surface, cell, cell));
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
        if let (Tool::Pencil | Tool::Line | Tool::Rectangle, Some(problem)) =
            (tool, self.steps_problem(document))
        {
            actions.push(nothing(&problem));
            return;
        }
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
                let surface = self.surface(document);
                self.paint(document, line(&surface, cell, cell), button, actions);
            }
            Tool::Fill | Tool::Replace => {
                let Some(start) = self.surface(document).wrap(cell) else {
                    return;
                };
                let alike = match self.layer(document) {
                    Layer::Weave => Alike::Drawdown,
                    Layer::Regions => Alike::Region,
                };
                let limits = self.selected_cells(document);
                let find = if tool == Tool::Fill {
                    flood
                } else {
                    everywhere
                };
                let cells = find(document, start, alike, limits.as_ref());
                actions.push(Action::Begin(tool_name(tool).to_owned()));
                self.paint_cells(document, cells, button, actions);
                actions.push(Action::Finish);
                return;
            }
            Tool::Picker => {
                self.pick(document, cell, button, actions);
            }
            Tool::Select => self.select_between(document, cell, cell),
            Tool::Move => match self.selection() {
                Some(rect) => {
                    stroke.moved = Some(rect);
                    actions.push(Action::Begin(tool_name(tool).to_owned()));
                }
                None => actions.push(nothing("Nothing is selected: select crossings first (S).")),
            },
            Tool::Stamp => match self.clip() {
                Some(clip) => {
                    let surface = Surface::of(document.design());
                    let regions = match self.layer(document) {
                        Layer::Regions => clip.paste_regions(&surface, cell),
                        Layer::Weave => None,
                    };
                    let edit = regions.unwrap_or_else(|| clip.paste(&surface, cell));
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
        let surface = self.surface(document);
        match stroke.tool {
            Tool::Pencil => {
                let path = line(&surface, stroke.reached, cell);
                self.paint(document, path, stroke.button, actions);
            }
            Tool::Line => {
                actions.push(Action::Restart);
                let path = line(&surface, stroke.from, cell);
                self.paint(document, path, stroke.button, actions);
            }
            Tool::Rectangle => {
                actions.push(Action::Restart);
                let path = rectangle(&surface, stroke.from, cell, !shift);
                self.paint(document, path, stroke.button, actions);
            }
            Tool::Select => self.select_between(document, stroke.from, cell),
            Tool::Move => {
                if let Some(rect) = stroke.moved {
                    actions.push(Action::Restart);
                    let by = (cell.0 - stroke.from.0, cell.1 - stroke.from.1);
                    self.move_by(document, rect, by, actions);
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

    /// Moves what was selected, and the selection with it.
    fn move_by(
        &mut self,
        document: &Document,
        rect: Rect,
        by: (i64, i64),
        actions: &mut Vec<Action>,
    ) {
        let design = document.design();
        let (ends, picks) = (design.ends(), design.picks());
        let cells = Cells::of_rect(ends, picks, rect);
        let behind = match self.layer(document) {
            Layer::Weave => None,
            Layer::Regions => Some(self.region(Button::Second)),
        };
        // The document still shows the last step of the drag: what is moved is what lay
        // there when the gesture began, which it is after the restart.
        actions.push(Action::Move {
            cells: Box::new(cells),
            by,
            behind,
        });
        let to = (i64::from(rect.end) + by.0, i64::from(rect.pick) + by.1);
        let last = |size: u32, count: u32| i64::from(size.saturating_sub(count));
        self.select(Some(Rect {
            end: to.0.clamp(0, last(ends, rect.ends)) as u32,
            pick: to.1.clamp(0, last(picks, rect.picks)) as u32,
            ..rect
        }));
    }

    /// Ends and picks after which painting is repeated; 0 = not at all.
    fn every(&self) -> (u32, u32) {
        match self.steps.on {
            true => (self.steps.every[0], self.steps.every[1]),
            false => (0, 0),
        }
    }

    /// What stands against painting in the steps that are chosen, if anything does.
    fn steps_problem(&self, document: &Document) -> Option<String> {
        let copies = Surface::of(document.design()).copies(self.every());
        (copies > MOST_COPIES).then(|| {
            format!(
                "These steps would paint everything {copies} times (the most is {MOST_COPIES}): \
                 choose larger ones."
            )
        })
    }

    /// The design to paint on, with the symmetries that are on.
    fn surface(&self, document: &Document) -> Surface {
        let design = document.design();
        let middle = |on: bool, count: u32| on.then(|| i64::from(count) - 1);
        Surface::of(design).with_symmetry(Symmetry {
            mirror_ends: middle(self.symmetry[0], design.ends()),
            mirror_picks: middle(self.symmetry[1], design.picks()),
            every: self.every(),
        })
    }

    /// The selection, which keeps paint inside.
    fn selected_cells(&self, document: &Document) -> Option<Cells> {
        let design = document.design();
        let cells = |rect| Cells::of_rect(design.ends(), design.picks(), rect);
        self.selection().map(cells)
    }

    /// Paints crossings of the endless cloth with what a button stands for.
    fn paint(
        &self,
        document: &Document,
        spans: Vec<Span>,
        button: Button,
        actions: &mut Vec<Action>,
    ) {
        let cells = self.surface(document).cells(spans);
        self.paint_cells(document, cells, button, actions);
    }

    fn paint_cells(
        &self,
        document: &Document,
        mut cells: Cells,
        button: Button,
        actions: &mut Vec<Action>,
    ) {
        if let Some(selected) = self.selected_cells(document) {
            cells.subtract(&selected.inverted());
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
    Action::Say(Grade::Note, text.to_owned(), String::new())
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
