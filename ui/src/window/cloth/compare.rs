//! A picture that was kept, beside the present one: a slider moves the border.

use std::sync::Arc;

use egui::{
    ColorImage, CursorIcon, Rect, Sense, Stroke, TextureHandle, TextureOptions, pos2, vec2,
};
use pickglass::engine::StillRequest;

use crate::tokens::{self, Palette};
use crate::window::cloth_pane::draw_picture;
use crate::window::focus;
use crate::window::view::ClothView;

/// Width of the border's handle.
const HANDLE: f32 = 4.0 * tokens::GRID;

/// The picture that was kept.
pub struct Compare {
    still: StillRequest,
    texture: TextureHandle,
    /// Where the border is, as a share of the pane.
    border: f32,
}

impl Compare {
    /// Keeps a picture.
    pub fn keep(ctx: &egui::Context, still: StillRequest, image: &Arc<ColorImage>) -> Self {
        let image = egui::ImageData::Color(Arc::clone(image));
        Self {
            still,
            texture: ctx.load_texture("kept cloth", image, TextureOptions::LINEAR),
            border: 0.5,
        }
    }

    /// Draws the kept picture left of the border and moves that as the person asks.
    pub fn show(&mut self, ui: &mut egui::Ui, pane: Rect, view: ClothView) {
        let palette = Palette::current(ui);
        let x = pane.left() + self.border * pane.width();
        let left = Rect::from_min_max(pane.min, pos2(x, pane.bottom()));
        let painter = ui.painter_at(left);
        painter.rect_filled(left, 0.0, tokens::SURROUND);
        draw_picture(&painter, pane, view, &self.still, &self.texture);
        let grip = Rect::from_center_size(pos2(x, pane.center().y), vec2(HANDLE, pane.height()));
        let id = ui.scope_id().with("compare");
        let response = ui.interact(grip, id, Sense::click_and_drag());
        response.widget_info(|| {
            egui::WidgetInfo::slider(true, f64::from(self.border), "Border to the kept picture")
        });
        if response.dragged()
            && let Some(at) = response.interact_pointer_pos()
        {
            self.border = (at.x - pane.left()) / pane.width().max(1.0);
        }
        if response.clicked() {
            response.request_focus();
        }
        self.border += 0.05 * focus::arrows(ui, &response)[0] as f32;
        self.border = self.border.clamp(0.02, 0.98);
        let focused = response.has_focus() || response.hovered();
        let colour = if focused {
            tokens::ACCENT
        } else {
            palette.raised
        };
        let painter = ui.painter_at(pane);
        painter.vline(x, pane.y_range(), Stroke::new(2.0, colour));
        painter.circle(
            pos2(x, pane.center().y),
            2.0 * tokens::GRID,
            colour,
            Stroke::new(1.0, palette.text),
        );
        if response.has_focus() {
            let middle = pos2(x, pane.center().y);
            focus::circle(&painter, middle, 2.0 * tokens::GRID, &palette);
        }
        response.on_hover_cursor(CursorIcon::ResizeHorizontal);
        let font = egui::TextStyle::Small.resolve(ui.style());
        let text = painter.layout_no_wrap("kept".to_owned(), font, palette.text);
        let plate = Rect::from_min_size(
            pos2(
                x - text.size().x - 4.0 * tokens::GRID,
                pane.top() + tokens::GAP,
            ),
            text.size() + vec2(2.0 * tokens::GRID, tokens::GRID),
        );
        painter.rect_filled(plate, tokens::RADIUS, palette.raised);
        painter.galley(
            plate.min + vec2(tokens::GRID, 0.5 * tokens::GRID),
            text,
            palette.text,
        );
    }
}
