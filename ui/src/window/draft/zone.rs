//! A field of cells one can paint in, with the pointer and with the keyboard: what the
//! drawdown, the threading, the tie-up, the treadling and the colour bars share.

use egui::{Event, Key, PointerButton, Pos2, Rect, Response, Sense};

use super::super::action::Button;

/// A cell: column from the left and row from below, in the field's own numbers.
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
}

/// A field's own state.
#[derive(Debug, Clone, Copy, Default)]
pub struct Zone {
    /// The cell that keys act on.
    pub cursor: Option<Cell>,
    /// The stroke that is being made, and the cell it has reached.
    stroke: Option<(PointerButton, Cell)>,
    /// The widget, once it was shown.
    id: Option<egui::Id>,
    /// The pointer was used last: the keyboard's cursor would only be in the way.
    by_pointer: bool,
    /// Space was used to move the view: letting it go paints nothing.
    space_used: bool,
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
        self.space_used = true;
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
        } = *field;
        let id = egui::Id::unique(("field", key));
        self.id = Some(id);
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
        let mut touches = Vec::new();
        self.pointer(ui, &response, &to_cell, blocked, &mut touches);
        if response.has_focus() {
            self.keys(ui, &response, &mut touches);
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

    fn keys(&mut self, ui: &egui::Ui, response: &Response, touches: &mut Vec<Touch>) {
        let filter = egui::EventFilter {
            horizontal_arrows: true,
            vertical_arrows: true,
            escape: true,
            ..Default::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let cursor = self.cursor.get_or_insert((0, 0));
        ui.input(|input| {
            if input.modifiers.alt || input.modifiers.command {
                return;
            }
            // Shift goes further at once.
            let step = if input.modifiers.shift { 8 } else { 1 };
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
                let button = if modifiers.shift {
                    Button::Second
                } else {
                    Button::First
                };
                self.by_pointer = false;
                match (key, pressed) {
                    (Key::ArrowLeft, true) => cursor.0 -= step,
                    (Key::ArrowRight, true) => cursor.0 += step,
                    (Key::ArrowUp, true) => cursor.1 += step,
                    (Key::ArrowDown, true) => cursor.1 -= step,
                    (Key::Enter, true) if !repeat => touches.push(Touch::Key(*cursor, button)),
                    // Space may also move the view: it paints when it is let go.
                    (Key::Space, true) if !repeat => self.space_used = false,
                    (Key::Space, false) if !self.space_used => {
                        touches.push(Touch::Key(*cursor, button));
                    }
                    _ => {}
                }
            }
        });
    }
}
