//! A yarn's colour as a button that opens a picker, and as a plain field.

use egui::{Response, Sense, Stroke, vec2};
use pickglass::design::Srgb;
use pickglass::text::visible;

use crate::tokens::{self, Palette};
use crate::window::focus;

/// Side of a swatch.
pub const SIDE: f32 = 6.0 * tokens::GRID;

/// A plain field of a colour.
pub fn field(ui: &mut egui::Ui, colour: Srgb, name: &str) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(SIDE, SIDE), Sense::click());
    let Srgb(red, green, blue) = colour;
    let line = Stroke::new(1.0, Palette::current(ui).line);
    let fill = tokens::yarn_colour(red, green, blue);
    let inside = egui::StrokeKind::Inside;
    ui.painter().rect(rect, tokens::RADIUS, fill, line, inside);
    if response.has_focus() {
        focus::ring(ui.painter(), rect, &Palette::current(ui));
    }
    let spoken = visible(&format!("{name}, {colour}")).into_owned();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &spoken));
    response
}

/// A button of a colour that opens a picker.
pub fn button(ui: &mut egui::Ui, colour: &mut Srgb, name: &str) -> Response {
    let mut bytes = [colour.0, colour.1, colour.2];
    let response = ui.color_edit_button_srgb(&mut bytes);
    *colour = Srgb(bytes[0], bytes[1], bytes[2]);
    let spoken = visible(&format!("Colour of {name}")).into_owned();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ColorWell, true, &spoken));
    response
}
