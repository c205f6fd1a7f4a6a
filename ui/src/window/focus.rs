//! What has the keyboard, where a pane draws its own widgets: the frame round it, and the
//! arrow keys.

use egui::{EventFilter, Key, Modifiers, Painter, Pos2, Rect, Response, Stroke, StrokeKind};

use crate::tokens::{self, Palette};

/// Draws the frame just inside a rectangle: two lines, so that it is seen on any yarn.
pub fn ring(painter: &Painter, rect: Rect, palette: &Palette) {
    let inside = StrokeKind::Inside;
    let frame = Stroke::new(tokens::FOCUS, palette.focus);
    painter.rect_stroke(rect, tokens::RADIUS, frame, inside);
    let edge = Stroke::new(1.0, palette.focus_edge);
    painter.rect_stroke(rect.shrink(tokens::FOCUS), tokens::RADIUS, edge, inside);
}

/// As [`ring`], round a disc.
pub fn circle(painter: &Painter, middle: Pos2, radius: f32, palette: &Palette) {
    let frame = Stroke::new(tokens::FOCUS, palette.focus);
    painter.circle_stroke(middle, radius + tokens::FOCUS, frame);
    let edge = Stroke::new(1.0, palette.focus_edge);
    painter.circle_stroke(middle, radius + 0.5, edge);
}

/// How often the arrow keys were pressed to the right and upwards, less those to the left
/// and downwards. While the widget has the keyboard, arrows are its own and move no focus.
pub fn arrows(ui: &egui::Ui, response: &Response) -> [i32; 2] {
    if !response.has_focus() {
        return [0; 2];
    }
    let arrows = EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        ..Default::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    ui.input_mut(|input| {
        let mut pressed = |key| input.count_and_consume_key(Modifiers::NONE, key) as i32;
        [
            pressed(Key::ArrowRight) - pressed(Key::ArrowLeft),
            pressed(Key::ArrowUp) - pressed(Key::ArrowDown),
        ]
    })
}
