//! The pane of the cloth: the newest picture where it belongs, however the eye moved
//! since it was asked for.

use std::sync::Arc;

use egui::{
    Color32, ColorImage, CursorIcon, Painter, PointerButton, Rect, Response, Sense, Stroke,
    TextureHandle, TextureOptions, vec2,
};

use super::draft::picture_uv;
use super::focus;
use super::forecast::Forecast;
use super::pace::Measured;
use super::view::{ClothView, scale_bar};
use super::worker::{Fibres, Picture};
use crate::tokens::{self, Palette};
use pickglass::engine::StillRequest;

/// One notch of a wheel zooms by about this much.
const ZOOM_A_POINT: f32 = 0.004;
/// A key moves the cloth by this share of the pane.
pub const KEY_STEP: f32 = 0.1;

/// The picture on the screen.
pub struct Shown {
    /// The request that it answers.
    #[cfg(test)]
    pub generation: u64,
    pub still: StillRequest,
    pub spp: u32,
    pub seconds: f64,
    pub error: Option<f64>,
    pub full_size: bool,
    pub fibres: Fibres,
    pub image: Arc<ColorImage>,
    texture: TextureHandle,
}

/// The pane's own state.
#[derive(Default)]
pub struct ClothPane {
    pub shown: Option<Shown>,
    forecast: Forecast,
}

/// What is marked on the cloth: a crossing's left, lower, right and upper border, mm.
pub type Marked = [f32; 4];

impl ClothPane {
    /// Forgets its pictures.
    pub fn forget(&mut self) {
        self.shown = None;
    }

    /// How the picture that is shown was traced, if it was.
    pub fn measured(&self) -> Option<Measured> {
        let shown = self.shown.as_ref()?;
        let size = shown.image.size;
        let pixels = size[0] as f64 * size[1] as f64;
        Measured::of(pixels, shown.spp, shown.seconds, shown.error)
    }

    /// When the picture that is shown will be how good, and how good forecasts were so far.
    pub fn foretold(&self) -> Vec<String> {
        let shown = self.shown.as_ref();
        let words = shown.and_then(|shown| self.forecast.words(shown.seconds));
        words.into_iter().chain(self.forecast.record()).collect()
    }

    /// Takes a newer picture.
    pub fn take(&mut self, ctx: &egui::Context, picture: Picture) {
        if let (true, Fibres::Full, Some(error)) =
            (picture.full_size, picture.fibres, picture.error)
        {
            (self.forecast).note(picture.generation, picture.seconds, error);
        }
        let image = Arc::new(picture.image);
        let data = || egui::ImageData::Color(Arc::clone(&image));
        let texture = match self.shown.take() {
            Some(mut shown) => {
                shown.texture.set(data(), TextureOptions::LINEAR);
                shown.texture
            }
            None => ctx.load_texture("cloth", data(), TextureOptions::LINEAR),
        };
        self.shown = Some(Shown {
            #[cfg(test)]
            generation: picture.generation,
            still: picture.still,
            spp: picture.spp,
            seconds: picture.seconds,
            error: picture.error,
            full_size: picture.full_size,
            fibres: picture.fibres,
            image,
            texture,
        });
    }

    /// Shows the pane and moves `view` as the person asks.
    pub fn show(
        &self,
        ui: &mut egui::Ui,
        view: &mut ClothView,
        description: &str,
        marked: Option<Marked>,
    ) -> Response {
        let pane = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(pane, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, description));
        move_view(ui, &response, pane, view);
        let painter = ui.painter_at(pane);
        painter.rect_filled(pane, 0.0, tokens::SURROUND);
        if let Some(shown) = &self.shown {
            draw_picture(&painter, pane, *view, &shown.still, &shown.texture);
            scale_bar_ui(ui, pane, view);
        }
        if let Some([left, low, right, high]) = marked {
            let corners = [[left, low], [right, high]].map(|mm| view.to_screen(pane, mm));
            let rect = Rect::from_two_pos(corners[0], corners[1]).expand(1.0);
            // Light and dark, so that it shows on every yarn.
            painter.rect_stroke(
                rect,
                1.0,
                Stroke::new(3.0, Color32::BLACK),
                egui::StrokeKind::Outside,
            );
            painter.rect_stroke(
                rect,
                1.0,
                Stroke::new(1.0, Color32::WHITE),
                egui::StrokeKind::Outside,
            );
        }
        if response.has_focus() {
            focus::ring(&painter, pane, &Palette::current(ui));
        }
        response.on_hover_cursor(CursorIcon::Grab)
    }
}

/// Draws a picture where it belongs, however the eye moved since it was asked for.
pub fn draw_picture(
    painter: &Painter,
    pane: Rect,
    view: ClothView,
    still: &StillRequest,
    texture: &TextureHandle,
) {
    if let (Some(centre_mm), Some(width_mm)) = (still.centre_mm, still.width_mm) {
        let aspect = still.width as f32 / still.height.max(1) as f32;
        let rect = view.picture_rect(pane, centre_mm, width_mm, aspect);
        // One that was made before the cloth was turned is shown turned.
        let uv = picture_uv(still.turned != view.turned);
        painter.image(texture.id(), rect, uv, Color32::WHITE);
    }
}

/// Drag pans, the wheel and pinching zoom at the pointer, arrow keys pan.
pub fn move_view(ui: &egui::Ui, response: &Response, pane: Rect, view: &mut ClothView) {
    let shift = ui.input(|input| input.modifiers.shift);
    let pans = response.dragged_by(PointerButton::Middle)
        || (response.dragged_by(PointerButton::Primary) && !shift);
    if pans {
        view.pan(response.drag_delta());
        ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
    }
    if response.clicked() {
        response.request_focus();
    }
    if let Some(anchor) = response.hover_pos() {
        let (wheel, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = (wheel * ZOOM_A_POINT).exp() * pinch;
        if (factor - 1.0).abs() > 1e-4 {
            view.zoom(pane, anchor, factor);
        }
    }
    let [right, up] = focus::arrows(ui, response).map(|by| by as f32);
    if right != 0.0 || up != 0.0 {
        view.pan(vec2(-right, up) * pane.size() * KEY_STEP);
    }
}

/// The scale bar on its plate, lower left.
fn scale_bar_ui(ui: &egui::Ui, pane: Rect, view: &ClothView) {
    let palette = Palette::current(ui);
    let (length, caption) = scale_bar(view.mm_per_point, tokens::SCALE_BAR.min(pane.width() * 0.4));
    let painter = ui.painter_at(pane);
    let font = egui::TextStyle::Body.resolve(ui.style());
    let text = painter.layout_no_wrap(caption, font, palette.text);
    let inner = vec2(
        length.max(text.size().x),
        text.size().y + 2.0 * tokens::GRID,
    );
    let plate = Rect::from_min_size(
        pane.left_bottom() + vec2(tokens::PAD, -tokens::PAD - inner.y - 2.0 * tokens::GRID),
        inner + vec2(2.0 * tokens::GAP, 2.0 * tokens::GRID),
    );
    painter.rect_filled(plate, tokens::RADIUS, palette.raised);
    let left = plate.left() + tokens::GAP;
    painter.galley(
        egui::pos2(left, plate.top() + tokens::GRID),
        text,
        palette.text,
    );
    let base = plate.bottom() - tokens::GAP;
    let stroke = Stroke::new(1.5, palette.text);
    painter.hline(left..=left + length, base, stroke);
    for x in [left, left + length] {
        painter.vline(x, base - tokens::GRID..=base + 1.0, stroke);
    }
}
