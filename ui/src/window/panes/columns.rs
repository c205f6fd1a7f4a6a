//! Columns of a pane, and lists whose rows are widgets: cells of one width, so that what follows
//! them lines up.

use egui::{Align, Layout, Response, TextStyle, Ui, Vec2};
use pickglass::text::visible;

use crate::tokens;

/// A column is no wider than this, points.
const WIDEST: f32 = 60.0 * tokens::GRID;

/// Width that a button of each of these texts needs.
pub fn widest<'t>(ui: &Ui, texts: impl IntoIterator<Item = &'t str>) -> f32 {
    let font = TextStyle::Button.resolve(ui.style());
    let colour = ui.visuals().text_color();
    let width = |text: &str| {
        let text = visible(text).into_owned();
        ui.painter()
            .layout_no_wrap(text, font.clone(), colour)
            .size()
            .x
    };
    let texts = texts.into_iter().map(width).fold(0.0, f32::max);
    (texts + 2.0 * ui.spacing().button_padding.x).min(WIDEST)
}

/// A widget, and the room that is left of its column.
pub fn cell(ui: &mut Ui, width: f32, show: impl FnOnce(&mut Ui) -> Response) -> Response {
    let response = show(ui);
    let left = width - response.rect.width();
    if left > 0.0 {
        ui.add_space(left);
    }
    response
}

/// A column of this size.
pub fn column<R>(ui: &mut Ui, size: Vec2, show: impl FnOnce(&mut Ui) -> R) -> R {
    let layout = Layout::top_down(Align::Min);
    ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.set_min_size(size);
        show(ui)
    })
    .inner
}
