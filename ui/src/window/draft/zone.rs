//! A field of cells one can paint in, with the pointer and with the keyboard: what the
//! drawdown, the threading, the tie-up, the treadling and the colour bars share.

use egui::{Event, Key, PointerButton, Pos2, Rect, Response, Sense};

use super::super::action::Button;

/// Cells that an arrow key goes with Ctrl.
const FAR: i64 = 8;

/// A cell: column and row in the field's own numbers, those of its threads, shafts and
/// treadles wherever they lie.
pub type Cell = (i64, i64);

/// What a person did in a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Touch {
    /// A button went down on a cell.
    Press(Cell, Button),
    /// The pointer went to another cell with the button down.
    Drag(Cell),
    /// The button was let go.
    Release,
    /// The stroke was given up.
    Cancel,
    /// A key paints the cell under the keyboard's cursor.
    Key(Cell, Button),
    /// A key paints from one corner of a range to the other, where the cursor is.
    Range(Cell, Cell, Button),
}

/// Where a field lies and what it is called.
#[derive(Debug, Clone, Copy)]
pub struct Field<'n> {
    pub rect: Rect,
    /// Which field it is, always the same.
    pub key: &'static str,
    /// What assistive technology calls it.
    pub name: &'n str,
    /// No stroke begins in it now.
    pub blocked: bool,
    /// Which way an arrow to the right and one upwards go: +1 to higher numbers, or −1.
    pub arrows: [i64; 2],
}

/// A field's own state.
#[derive(Debug, Clone, Copy, Default)]
pub struct Zone {
    /// The cell that keys act on.
    pub cursor: Option<Cell>,
    /// Where the range begins that Shift and the arrow keys made.
    anchor: Option<Cell>,
    /// The stroke that is being made, and the cell it has reached.
    stroke: Option<(PointerButton, Cell)>,
    /// The widget, once it was shown.
    id: Option<egui::Id>,
    /// The pointer was used last: the keyboard's cursor would only be in the way.
    by_pointer: bool,
    /// Space went down here and has not moved the view: letting it go paints.
    space_held: bool,
}

impl Zone {
    /// The widget, once it was shown.
    pub fn id(&self) -> Option<egui::Id> {
        self.id
    }

    /// The cell that keys act on, while keys are used.
    pub fn shown_cursor(&self) -> Option<Cell> {
        self.cursor.filter(|_| !self.by_pointer)
    }

    /// The range of cells that keys act on, if there is one: two corners.
    pub fn shown_range(&self) -> Option<(Cell, Cell)> {
        self.anchor.zip(self.shown_cursor())
    }

    /// Whether a stroke is being made.
    pub fn in_stroke(&self) -> bool {
        self.stroke.is_some()
    }

    /// The stroke is of no use any more.
    pub fn give_up(&mut self) {
        self.stroke = None;
    }

    /// Says that Space moved the view.
    pub fn space_used(&mut self) {
        self.space_held = false;
    }

    /// Makes a field of the screen; `to_cell` tells the cell under a point.
    pub fn touches(
        &mut self,
        ui: &egui::Ui,
        field: &Field<'_>,
        to_cell: impl Fn(Pos2) -> Cell,
    ) -> (Response, Vec<Touch>) {
        let Field {
            rect,
            key,
            name,
            blocked,
            arrows,
        } = *field;
        let id = egui::Id::unique(("field", key));
        self.id = Some(id);
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
        let mut touches = Vec::new();
        self.pointer(ui, &response, &to_cell, blocked, &mut touches);
        if response.has_focus() {
            self.keys(ui, &response, arrows, &mut touches);
        }
        (response, touches)
    }

    fn pointer(
        &mut self,
        ui: &egui::Ui,
        response: &Response,
        to_cell: &impl Fn(Pos2) -> Cell,
        blocked: bool,
        touches: &mut Vec<Touch>,
    ) {
        let hovered = response.contains_pointer();
        let escape = ui.input(|input| input.key_pressed(Key::Escape));
        if escape && self.stroke.take().is_some() {
            touches.push(Touch::Cancel);
        }
        ui.input(|input| {
            for event in &input.events {
                match *event {
                    Event::PointerButton {
                        pos,
                        button,
                        pressed: true,
                        ..
                    } if hovered && !blocked && self.stroke.is_none() => {
                        let side = match button {
                            PointerButton::Primary => Button::First,
                            PointerButton::Secondary => Button::Second,
                            _ => continue,
                        };
                        let cell = to_cell(pos);
                        self.stroke = Some((button, cell));
                        self.by_pointer = true;
                        self.cursor = Some(cell);
                        self.anchor = None;
                        touches.push(Touch::Press(cell, side));
                    }
                    Event::PointerMoved(pos) => {
                        if let Some((_, reached)) = &mut self.stroke {
                            let cell = to_cell(pos);
                            if cell != *reached {
                                *reached = cell;
                                self.cursor = Some(cell);
                                touches.push(Touch::Drag(cell));
                            }
                        }
                    }
                    Event::PointerButton {
                        button,
                        pressed: false,
                        ..
                    } if self.stroke.is_some_and(|(held, _)| held == button) => {
                        self.stroke = None;
                        touches.push(Touch::Release);
                    }
                    _ => {}
                }
            }
        });
        let lost = self.stroke.is_some() && !ui.input(|input| input.pointer.any_down());
        if lost {
            self.stroke = None;
            touches.push(Touch::Release);
        }
        if touches
            .iter()
            .any(|touch| matches!(touch, Touch::Press(..)))
        {
            response.request_focus();
        }
    }

    fn keys(
        &mut self,
        ui: &egui::Ui,
        response: &Response,
        [right, up]: [i64; 2],
        touches: &mut Vec<Touch>,
    ) {
        let filter = egui::EventFilter {
            horizontal_arrows: true,
            vertical_arrows: true,
            escape: true,
            ..Default::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        ui.input(|input| {
            if input.modifiers.alt {
                return;
            }
            for event in &input.events {
                let Event::Key {
                    key,
                    pressed,
                    repeat,
                    modifiers,
                    ..
                } = *event
                else {
                    continue;
                };
                let arrow = match key {
                    Key::ArrowLeft => Some((-right, 0)),
                    Key::ArrowRight => Some((right, 0)),
                    Key::ArrowUp => Some((0, up)),
                    Key::ArrowDown => Some((0, -up)),
                    _ => None,
                };
                if let Some(by) = arrow.filter(|_| pressed) {
                    self.step(by, modifiers);
                    continue;
                }
                if !modifiers.command || key == Key::Enter {
                    self.paint_key(key, pressed && !repeat, pressed, modifiers.shift, touches);
                }
            }
        });
    }

    /// Moves the cursor: Ctrl goes further at once, Shift makes a range.
    fn step(&mut self, (x, y): Cell, modifiers: egui::Modifiers) {
        let cursor = self.cursor.get_or_insert((0, 0));
        if modifiers.shift {
            self.anchor.get_or_insert(*cursor);
        } else {
            self.anchor = None;
        }
        let far = if modifiers.command { FAR } else { 1 };
        *cursor = (cursor.0 + x * far, cursor.1 + y * far);
        self.by_pointer = false;
    }

    /// Enter paints, and Space when it is let go, since Space may also move the view.
    fn paint_key(
        &mut self,
        key: Key,
        struck: bool,
        pressed: bool,
        shift: bool,
        touches: &mut Vec<Touch>,
    ) {
        match (key, pressed) {
            (Key::Space, true) if struck => {
                self.space_held = true;
                return;
            }
            (Key::Escape, true) => {
                self.anchor = None;
                return;
            }
            (Key::Enter, true) if struck => {}
            (Key::Space, false) if std::mem::take(&mut self.space_held) => {}
            _ => return,
        }
        self.by_pointer = false;
        let button = if shift { Button::Second } else { Button::First };
        let cursor = *self.cursor.get_or_insert((0, 0));
        touches.push(match self.anchor.take() {
            Some(from) => Touch::Range(from, cursor, button),
            None => Touch::Key(cursor, button),
        });
    }
}
