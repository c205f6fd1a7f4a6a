//! The pick glass: while it is held, a round loupe at the pointer shows that spot ten
//! times closer, traced at once; the rest stays as it is.

use egui::epaint::{Mesh, Vertex};
use egui::{Color32, Key, Pos2, Rect, Shape, Stroke, TextureHandle, TextureOptions, pos2, vec2};
use pickglass::engine::StillRequest;

use crate::tokens::{self, Palette};
use crate::window::view::{ClothView, scale_bar};
use crate::window::worker::Picture;

/// The key that holds the glass over the cloth.
pub const KEY: Key = Key::Q;
/// How much closer the glass shows the cloth.
pub const CLOSER: f32 = 10.0;
/// Corners of the round picture.
const CORNERS: u32 = 96;

/// The glass and what it shows.
#[derive(Default)]
pub struct Glass {
    /// Where it is held.
    held: Option<Pos2>,
    /// It is held without a key.
    pinned: bool,
    asked: Option<StillRequest>,
    shown: Option<(StillRequest, TextureHandle)>,
}

/// What holding or letting go of the glass asks of the worker.
pub enum Wish {
    /// This picture, now.
    Look(Box<StillRequest>),
    /// The pane's picture again.
    Leave,
}

impl Glass {
    /// Whether it is held.
    pub fn is_held(&self) -> bool {
        self.held.is_some()
    }

    /// Holds it without a key, or lets go.
    pub fn pin(&mut self) {
        self.pinned = !self.pinned;
    }

    /// Takes a newer picture.
    pub fn take(&mut self, ctx: &egui::Context, picture: Picture) {
        let texture = match self.shown.take() {
            Some((_, mut texture)) => {
                texture.set(picture.image, TextureOptions::LINEAR);
                texture
            }
            None => ctx.load_texture("glass", picture.image, TextureOptions::LINEAR),
        };
        self.shown = Some((picture.still, texture));
    }

    /// Follows the pointer while the key is down or the pane is pressed with Shift. Where the
    /// pointer is elsewhere, the keyboard's glass stands in the middle. `still` is what the
    /// pane shows.
    pub fn hold(
        &mut self,
        ui: &egui::Ui,
        response: &egui::Response,
        pane: Rect,
        view: ClothView,
        still: Option<&StillRequest>,
    ) -> Option<Wish> {
        let typing = ui.ctx().text_edit_focused();
        let (key, pressed, escape) = ui.input(|input| {
            let pressed = input.modifiers.shift && input.pointer.primary_down();
            let key = input.key_down(KEY) && !input.modifiers.any();
            (key && !typing, pressed, input.key_pressed(Key::Escape))
        });
        self.pinned &= !escape;
        let pointer = response
            .hover_pos()
            .or_else(|| response.interact_pointer_pos());
        let pointer = pointer.filter(|at| pane.contains(*at));
        let by_hand = key || (pressed && response.is_pointer_button_down_on());
        let by_keyboard = self.pinned || (key && response.has_focus());
        let here = pointer
            .filter(|_| by_hand || by_keyboard)
            .or_else(|| by_keyboard.then(|| pane.center()));
        let was_held = self.held.is_some();
        self.held = here;
        let Some(at) = here else {
            self.shown = None;
            self.asked = None;
            return was_held.then_some(Wish::Leave);
        };
        let still = still?;
        let radius = radius(pane);
        let side = (2.0 * radius * ui.ctx().pixels_per_point()).round() as u32;
        let wanted = StillRequest {
            width: side.max(1),
            height: side.max(1),
            centre_mm: Some(view.to_cloth(pane, at)),
            width_mm: Some((2.0 * radius * view.mm_per_point / CLOSER).max(0.02)),
            ..still.clone()
        };
        if self.asked.as_ref() == Some(&wanted) {
            return None;
        }
        self.asked = Some(wanted.clone());
        Some(Wish::Look(Box::new(wanted)))
    }

    /// Draws it over the pane.
    pub fn show(&self, ui: &egui::Ui, pane: Rect, view: ClothView) {
        let Some(at) = self.held else {
            return;
        };
        let palette = Palette::current(ui);
        let painter = ui.painter_at(pane);
        let radius = radius(pane);
        painter.circle_filled(at, radius, tokens::SURROUND);
        if let Some((still, texture)) = &self.shown
            && let (Some(centre), Some(width)) = (still.centre_mm, still.width_mm)
        {
            // The newest picture may be of where the pointer was a moment ago.
            let off = (at - view.to_screen(pane, centre)) * (view.mm_per_point / width.max(1e-6));
            painter.add(round_picture(at, radius, texture.id(), off));
        }
        painter.circle_stroke(at, radius, Stroke::new(3.0, palette.raised));
        painter.circle_stroke(at, radius + 2.0, Stroke::new(1.0, palette.text));
        let (length, caption) = scale_bar(view.mm_per_point / CLOSER, radius);
        let font = egui::TextStyle::Small.resolve(ui.style());
        let text = painter.layout_no_wrap(format!("×10 · {caption}"), font, palette.text);
        let plate = Rect::from_center_size(
            at + vec2(0.0, radius - 2.0 * tokens::PAD),
            vec2(text.size().x.max(length), text.size().y + tokens::GRID)
                + vec2(2.0 * tokens::GAP, tokens::GAP),
        );
        painter.rect_filled(plate, tokens::RADIUS, palette.raised);
        painter.galley(
            pos2(
                plate.center().x - 0.5 * text.size().x,
                plate.top() + 0.5 * tokens::GRID,
            ),
            text,
            palette.text,
        );
        let left = plate.center().x - 0.5 * length;
        let base = plate.bottom() - tokens::GRID;
        painter.hline(left..=left + length, base, Stroke::new(1.5, palette.text));
    }

    /// Whether a picture is in it.
    pub fn has_picture(&self) -> bool {
        self.shown.is_some()
    }
}

fn radius(pane: Rect) -> f32 {
    (0.22 * pane.size().min_elem()).clamp(48.0, 160.0)
}

/// A disc cut out of a square picture whose middle lies `off` (in widths) beside its own.
fn round_picture(middle: Pos2, radius: f32, texture: egui::TextureId, off: egui::Vec2) -> Shape {
    let mut mesh = Mesh::with_texture(texture);
    let place = |direction: egui::Vec2| Vertex {
        pos: middle + direction * radius,
        uv: pos2(0.5, 0.5) + 0.5 * direction + off,
        color: Color32::WHITE,
    };
    mesh.vertices.push(place(egui::Vec2::ZERO));
    for corner in 0..CORNERS {
        let angle = corner as f32 * std::f32::consts::TAU / CORNERS as f32;
        mesh.vertices.push(place(egui::Vec2::angled(angle)));
        mesh.add_triangle(0, 1 + corner, 1 + (corner + 1) % CORNERS);
    }
    Shape::mesh(mesh)
}
