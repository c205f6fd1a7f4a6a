//! One place of the cloth with an effect and without it, flipped in place.

use egui::{Image, RichText, TextureHandle, TextureOptions, Ui, Vec2, WidgetInfo};
use pickglass::plan::Effect;

use super::looking::Looked;
use super::words;
use crate::tokens::{self, Palette};
use crate::window::picture::image;

/// A picture is shown at most so many times as large as it was taken.
const LARGEST: f32 = 2.0;
/// … and no smaller than this, points down.
const LEAST: f32 = 15.0 * tokens::GRID;

/// What of two pictures is shown.
#[derive(Default)]
pub struct PairView {
    without: bool,
    /// Both pictures of an effect, of the look of this number.
    textures: Option<(u64, Effect, [TextureHandle; 2])>,
}

impl PairView {
    /// Shows the pictures of an effect, no larger than `room`; `number` is that of the look.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        (looked, number): (&Looked, u64),
        effect: Effect,
        room: Vec2,
    ) {
        let Some(pair) = looked.pair(effect) else {
            let told = format!("No pictures: there was nothing of {}.", words::name(effect));
            ui.label(RichText::new(told).color(Palette::current(ui).quiet));
            return;
        };
        let known =
            (self.textures.take()).filter(|(of, known, _)| (*of, *known) == (number, effect));
        let (.., textures) = self.textures.insert(known.unwrap_or_else(|| {
            let load = |picture| {
                let options = TextureOptions::LINEAR;
                ui.ctx().load_texture("effect", image(picture), options)
            };
            (number, effect, [load(&*pair.with), load(&pair.without)])
        }));
        let name = words::name(effect);
        let top = ui.cursor().top();
        ui.horizontal(|ui| {
            let flip = ui.button("Flip");
            flip.widget_info(|| {
                let spoken = format!("Without {name}");
                WidgetInfo::selected(egui::Role::Switch, true, self.without, spoken)
            });
            let flip = flip.on_hover_text("Space flips it as well");
            if flip.clicked() {
                self.without = !self.without;
                // Space goes on where the pointer began.
                flip.request_focus();
            }
            let with = if self.without { "Without" } else { "With" };
            ui.label(RichText::new(format!("{with} {name}")).strong());
        });
        let texture = &textures[usize::from(self.without)];
        let taken = texture.size_vec2();
        let left = room.y - (ui.cursor().top() - top);
        let scale = (room.x / taken.x).min(left.max(LEAST) / taken.y);
        let size = taken * scale.min(LARGEST);
        let picture = ui.add(Image::new(texture).fit_to_exact_size(size));
        picture.widget_info(|| {
            let with = if self.without { "without" } else { "with" };
            WidgetInfo::labeled(egui::Role::Image, true, format!("The cloth {with} {name}"))
        });
    }
}
