//! The reference: a picture over the drawdown that one draws by. It belongs to the window,
//! is found again by its path, and never gets into the weave.

use std::path::PathBuf;

use egui::{Color32, Painter, Rect, RichText, Slider, TextureHandle, TextureOptions};
use pickglass::design::{Design, SourceImage};
use pickglass::text::visible;

use super::super::picture::shrunk;
use super::grid::CellGrid;
use crate::tokens::Palette;

/// Longer side of its texture, pixels.
const LONGEST: usize = 2048;

/// A picture to draw by.
pub struct Reference {
    pub path: PathBuf,
    /// Drawn; else it only waits.
    pub shown: bool,
    /// Share of it that shows, 0..=1.
    pub opacity: f32,
    /// Over the whole repeat; else in its own shape, as large as it fits.
    pub stretched: bool,
    /// The window of its settings is open.
    pub window_open: bool,
    /// Width over height.
    aspect: f32,
    texture: TextureHandle,
}

impl Reference {
    /// A picture that was read.
    pub fn new(ctx: &egui::Context, path: PathBuf, source: &SourceImage) -> Self {
        let image = shrunk(
            source,
            LONGEST.min(ctx.input(|input| input.max_texture_side)),
        );
        Self {
            path,
            shown: true,
            opacity: 0.5,
            stretched: false,
            window_open: true,
            aspect: source.width() as f32 / source.height().max(1) as f32,
            texture: ctx.load_texture("reference", image, TextureOptions::LINEAR),
        }
    }

    /// Lies as it lay before.
    pub fn lie(&mut self, opacity: f32, stretched: bool) {
        if opacity.is_finite() {
            self.opacity = opacity.clamp(0.0, 1.0);
        }
        self.stretched = stretched;
    }

    /// Draws it over the first repeat.
    pub fn draw(&self, painter: &Painter, grid: &CellGrid, design: &Design) {
        if !self.shown {
            return;
        }
        let home = grid.rect(0, 0, design.ends().into(), design.picks().into());
        let place = self.place(home, design);
        // It lies on the cloth, and turns with it.
        let tint = Color32::WHITE.gamma_multiply(self.opacity);
        painter.image(self.texture.id(), place, grid.picture_uv(), tint);
    }

    /// Where it lies in the rectangle of the first repeat. Crossings need not be square:
    /// in its own shape it is that on the cloth, not on the grid.
    fn place(&self, home: Rect, design: &Design) -> Rect {
        if self.stretched {
            return home;
        }
        let sett = design.sett();
        let width = design.ends() as f32 * sett.ends.mean_pitch_mm();
        let height = design.picks() as f32 * sett.picks.mean_pitch_mm();
        let scale = (width / self.aspect).min(height);
        let share = egui::vec2(self.aspect * scale / width, scale / height);
        Rect::from_center_size(home.center(), home.size() * share)
    }

    /// The window of its settings, if it is open. False once the picture is let go.
    pub fn window(&mut self, ctx: &egui::Context) -> bool {
        let mut kept = true;
        let mut open = self.window_open;
        egui::Window::new("Reference image")
            .open(&mut open)
            .collapsible(false)
            .resizable(false)
            .show(ctx, |ui| {
                let name = self.path.file_name().unwrap_or(self.path.as_os_str());
                let quiet = Palette::current(ui).quiet;
                ui.label(RichText::new(visible(&name.to_string_lossy())).color(quiet))
                    .on_hover_text(visible(&self.path.display().to_string()));
                let label = ui.label("Strength");
                let percent = Slider::new(&mut self.opacity, 0.0..=1.0)
                    .custom_formatter(|share, _| format!("{:.0} %", share * 100.0))
                    .custom_parser(|text| {
                        let number = text.trim().trim_end_matches('%').trim();
                        number.parse::<f64>().ok().map(|percent| percent / 100.0)
                    });
                ui.add(percent).labelled_by(label.id);
                ui.checkbox(&mut self.stretched, "Stretch it over the repeat")
                    .on_hover_text("Else it keeps its shape on the cloth");
                ui.checkbox(&mut self.shown, "Show the picture");
                if ui.button("Take it away").clicked() {
                    kept = false;
                }
            });
        self.window_open = open;
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::session::blank;
    use egui::pos2;
    use pickglass::design::Sett;

    #[test]
    fn a_reference_keeps_its_shape_on_the_cloth() {
        let ctx = egui::Context::default();
        let source = SourceImage::new(40, 10, vec![[9, 9, 9]; 400]).expect("a picture");
        let mut reference = Reference::new(&ctx, PathBuf::from("a.png"), &source);
        let design = Design::clone(&blank().expect("a design").design);
        let home = Rect::from_min_max(pos2(100.0, 50.0), pos2(260.0, 210.0));
        // Twice as many picks as ends in a cm: a crossing is twice as wide as high.
        let design = design.with_sett(Sett::per_cm(10.0, 20.0)).expect("a sett");
        let place = reference.place(home, &design);
        assert!((place.width() - home.width()).abs() < 0.01);
        // 16 picks are half as high as 16 ends are wide: 1/4 of the width is half of that.
        assert!((place.height() - 80.0).abs() < 0.1, "{place:?}");
        assert_eq!(place.center(), home.center());
        reference.stretched = true;
        assert_eq!(reference.place(home, &design), home);
    }
}
