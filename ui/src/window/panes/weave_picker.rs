//! Choosing a weave from the library by its picture.

use std::collections::BTreeMap;

use egui::{Key, RichText, ScrollArea, Sense, Stroke, TextEdit, TextureHandle, vec2};
use pickglass::design::{Fill, LibraryWeave, library};

use crate::tokens::{self, Palette};
use crate::window::{focus, typing};

/// Crossings along a side of a thumbnail.
const CROSSINGS: usize = 16;
/// Side of a thumbnail, points.
const SIDE: f32 = 12.0 * tokens::GRID;

/// The open picker.
#[derive(Default)]
pub struct WeavePicker {
    search: String,
    /// The field had the keyboard once.
    focused: bool,
    thumbs: BTreeMap<&'static str, TextureHandle>,
}

/// What the person did.
pub enum Picked {
    /// Still looking.
    Nothing,
    Weave(Box<Fill>),
    Closed,
}

impl WeavePicker {
    /// Shows the window; `whose` is what the weave is for.
    pub fn show(&mut self, ctx: &egui::Context, whose: &str) -> Picked {
        let mut picked = Picked::Nothing;
        let mut open = true;
        egui::Window::new(format!("Weave for {whose}"))
            .id(egui::Id::unique("weave picker"))
            .open(&mut open)
            .collapsible(false)
            .default_size([
                100.0 * tokens::GRID,
                tokens::LIST_HEIGHT + 40.0 * tokens::GRID,
            ])
            .show(ctx, |ui| {
                let label = ui.label("Find a weave");
                let field = TextEdit::singleline(&mut self.search).hint_text("satin, honeycomb…");
                let field = ui.add(field).labelled_by(label.id);
                if !self.focused {
                    field.request_focus();
                    self.focused = true;
                }
                let wanted = self.search.to_lowercase();
                let fits = |weave: &&LibraryWeave| {
                    let also = weave
                        .also()
                        .iter()
                        .any(|name| name.to_lowercase().contains(&wanted));
                    also || weave.name().to_lowercase().contains(&wanted)
                        || weave.family().to_lowercase().contains(&wanted)
                };
                let found: Vec<&'static LibraryWeave> = library().iter().filter(fits).collect();
                if typing::entered(ui, &field) {
                    match found.as_slice() {
                        [only] => picked = Picked::Weave(Box::new(fill_of(only))),
                        // The search goes on.
                        _ => field.request_focus(),
                    }
                }
                if found.is_empty() {
                    let quiet = Palette::current(ui).quiet;
                    ui.label(RichText::new("No weave of the library is called this.").color(quiet));
                }
                let across =
                    (ui.available_width() / (SIDE + 20.0 * tokens::GRID)).max(1.0) as usize;
                let rows = found.len().div_ceil(across);
                let height = SIDE + tokens::GAP;
                ScrollArea::vertical().auto_shrink(false).show_rows(
                    ui,
                    height,
                    rows,
                    |ui, shown| {
                        for row in shown {
                            ui.horizontal(|ui| {
                                for weave in found.iter().skip(row * across).take(across) {
                                    if self.thumb_ui(ui, weave) {
                                        picked = Picked::Weave(Box::new(fill_of(weave)));
                                    }
                                }
                            });
                        }
                    },
                );
            });
        if !open || ctx.input(|input| input.key_pressed(Key::Escape)) {
            return Picked::Closed;
        }
        picked
    }

    fn thumb_ui(&mut self, ui: &mut egui::Ui, weave: &'static LibraryWeave) -> bool {
        let texture = (self.thumbs.entry(weave.name()))
            .or_insert_with(|| thumb(ui.ctx(), weave))
            .id();
        let width = SIDE + 19.0 * tokens::GRID;
        let (rect, response) = ui.allocate_exact_size(vec2(width, SIDE), Sense::click());
        let (ends, picks) = weave.repeat();
        let spoken = format!("{}, {ends} × {picks}", weave.name());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &spoken));
        let palette = Palette::current(ui);
        let picture = egui::Rect::from_min_size(rect.min, vec2(SIDE, SIDE));
        let whole = egui::Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
        ui.painter()
            .image(texture, picture, whole, egui::Color32::WHITE);
        let line = if response.hovered() {
            tokens::ACCENT
        } else {
            palette.line
        };
        let inside = egui::StrokeKind::Inside;
        ui.painter()
            .rect_stroke(picture, 0.0, Stroke::new(1.0, line), inside);
        if response.has_focus() {
            focus::ring(ui.painter(), rect, &palette);
        }
        let font = egui::TextStyle::Small.resolve(ui.style());
        let room = width - SIDE - tokens::GAP;
        let text = ui
            .painter()
            .layout(weave.name().to_owned(), font, palette.text, room);
        let at = picture.right_top() + vec2(tokens::GRID, 0.0);
        ui.painter()
            .with_clip_rect(rect)
            .galley(at, text, palette.text);
        response
            .on_hover_text(format!("{spoken}. {}", weave.usual_use()))
            .clicked()
    }
}

/// The fill of a library weave, by its notation where it has one.
fn fill_of(weave: &LibraryWeave) -> Fill {
    match Fill::by_notation(weave.notation()) {
        Ok(fill) if fill.pattern() == weave.pattern() => fill,
        _ => Fill::drawn(weave.pattern().clone()),
    }
}

/// A weave's repeats in black and white.
fn thumb(ctx: &egui::Context, weave: &LibraryWeave) -> TextureHandle {
    let pattern = weave.pattern();
    let pixels = (0..CROSSINGS * CROSSINGS)
        .map(|at| {
            let (row, end) = (at / CROSSINGS, at % CROSSINGS);
            let pick = CROSSINGS - 1 - row;
            if pattern.get_wrapped(end as i64, pick as i64) {
                egui::Color32::BLACK
            } else {
                egui::Color32::WHITE
            }
        })
        .collect();
    let image = egui::ColorImage::new([CROSSINGS, CROSSINGS], pixels);
    ctx.load_texture(weave.name(), image, egui::TextureOptions::NEAREST)
}
