//! Fields that are typed in: keys are theirs until they are left on purpose.
//!
//! Enter leaves a field only where what was typed can be used; else the field keeps the
//! keyboard and the text, so that the correction goes where the mistake stands and is not
//! taken for commands. Esc leaves a field always.

use std::cell::Cell;

use egui::{Context, DragValue, Event, Key, Response, RichText, Stroke, StrokeKind, Ui};

use crate::tokens::{self, Palette};

/// Whether Enter was pressed in a field, which has lost the keyboard by that. Where what
/// was typed cannot be used, the field is to have it [`Response::request_focus`] again.
pub fn entered(ui: &Ui, field: &Response) -> bool {
    field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
}

/// Whether Esc was pressed in a field.
pub fn given_up(ui: &Ui, field: &Response) -> bool {
    field.lost_focus() && ui.input(|input| input.key_pressed(Key::Escape))
}

/// A field for a number. Text that is none is framed and told, and Enter does not leave it.
pub fn number(ui: &mut Ui, field: DragValue<'_>) -> Response {
    number_by(ui, field, parsed)
}

/// As [`number`], where `read` tells the number of a text.
pub fn number_by(
    ui: &mut Ui,
    field: DragValue<'_>,
    read: impl Fn(&str) -> Option<f64>,
) -> Response {
    // The text is read whenever it changes.
    let reads = Cell::new(None);
    let response = ui.add(field.custom_parser(|text| {
        let number = read(text);
        reads.set(Some(number.is_some()));
        number
    }));
    let key = response.id.with("no number");
    let known = ui.data(|kept| kept.get_temp::<NoNumber>(key));
    let mut state = known.unwrap_or_default();
    if response.gained_focus() {
        state = NoNumber::default();
    } else if let Some(reads) = reads.get() {
        state.is = !reads;
        state.told &= state.is;
    }
    if state.is && entered(ui, &response) {
        response.request_focus();
        state.told = true;
    } else if !response.has_focus() {
        state = NoNumber::default();
    }
    if known.is_some() || state.is {
        ui.data_mut(|kept| kept.insert_temp(key, state));
    }
    if state.told {
        tell(ui, &response);
    }
    response
}

/// Whether the text in a field is no number, and whether Enter was pressed on it.
#[derive(Clone, Copy, Default)]
struct NoNumber {
    is: bool,
    told: bool,
}

/// Says that there is no number in a field.
fn tell(ui: &Ui, field: &Response) {
    let palette = Palette::current(ui);
    let frame = Stroke::new(tokens::FOCUS, palette.error);
    ui.painter()
        .rect_stroke(field.rect, tokens::RADIUS, frame, StrokeKind::Outside);
    let text = "Error: this is no number: type digits, for instance 12.5; Esc leaves the field";
    egui::Tooltip::always_open(
        ui.ctx().clone(),
        ui.layer_id(),
        field.id.with("no number"),
        field.rect,
    )
    .show(|ui| ui.label(RichText::new(text).color(palette.error)));
}

/// The number that a text says; spaces between its digits and a true minus are allowed.
pub fn parsed(text: &str) -> Option<f64> {
    let spaceless: String = (text.chars())
        .filter(|letter| !letter.is_whitespace())
        .map(|letter| if letter == '−' { '-' } else { letter })
        .collect();
    spaceless
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite())
}

/// Keys that came in one slow frame with one that changes what the next are meant for:
/// they wait for the next frame.
#[derive(Default)]
pub struct Keys {
    put_off: Vec<Event>,
    typing: bool,
}

impl Keys {
    /// To be called first in a frame: what was put off comes first, and what was typed
    /// after Enter, or into a field that Esc gave up, is no command.
    pub fn begin(&mut self, ctx: &Context) {
        let before = std::mem::take(&mut self.put_off);
        ctx.input_mut(|input| drop(input.events.splice(0..0, before)));
        let typing = ctx.text_edit_focused();
        let pressed = |wanted: Key| {
            let is = |event: &Event| matches!(event, Event::Key { key, pressed: true, .. } if *key == wanted);
            ctx.input(|input| input.events.iter().position(is))
        };
        if typing && let Some(enter) = pressed(Key::Enter) {
            self.put_off(ctx, enter + 1);
        }
        if self.typing
            && !typing
            && let Some(escape) = pressed(Key::Escape)
        {
            let mut place = 0;
            ctx.input_mut(|input| {
                input.events.retain(|event| {
                    place += 1;
                    place > escape || !of_keyboard(event)
                });
            });
        }
        self.typing = typing;
    }

    /// Keeps what was typed from this place of the frame's events on for the next frame.
    pub fn put_off(&mut self, ctx: &Context, from: usize) {
        ctx.input_mut(|input| {
            let mut place = 0;
            let later = input.events.extract_if(.., |event| {
                place += 1;
                place > from && of_keyboard(event)
            });
            self.put_off.extend(later);
        });
        if !self.put_off.is_empty() {
            ctx.request_repaint();
        }
    }
}

fn of_keyboard(event: &Event) -> bool {
    matches!(event, Event::Key { .. } | Event::Text(_) | Event::Paste(_))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_people_write_them() {
        assert_eq!(parsed(" 1 200.5"), Some(1200.5));
        assert_eq!(parsed("−3"), Some(-3.0));
        for wrong in ["", "12x", "1,5", "inf", "NaN", "twelve"] {
            assert_eq!(parsed(wrong), None, "{wrong}");
        }
    }
}
