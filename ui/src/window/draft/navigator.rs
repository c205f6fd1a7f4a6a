//! The navigator: three by three repeats, small, with a frame round what is seen. Dragging
//! in it moves the view.

use egui::{Color32, ColorImage, Rect, Sense, Stroke, TextureHandle, TextureOptions, pos2, vec2};
use pickglass::design::{Colouring, SwatchWindow};
use pickglass::edit::{Change, Document};

use super::areas::Areas;
use super::grid::CellGrid;
use super::tiles;
use crate::tokens::{self, Palette};

/// Pixels along the longer side of the picture.
const SIDE: u64 = 192;
/// A picture from more crossings than this is not made while the design changes.
const AT_ONCE: u64 = 1 << 20;

/// The navigator's picture.
#[derive(Default)]
pub struct Navigator {
    made: Option<TextureHandle>,
    stale: bool,
}

impl Navigator {
    /// Forgets the picture.
    pub fn forget(&mut self) {
        self.made = None;
    }

    /// The picture is to be made again.
    pub fn changed(&mut self, change: &Change) {
        if change.size {
            self.made = None;
        }
        self.stale = true;
    }

    /// Shows it in the lower right corner of the drawdown; returns where to look.
    pub fn show(
        &mut self,
        ui: &egui::Ui,
        document: &Document,
        areas: &Areas,
        grid: &CellGrid,
    ) -> Option<[f64; 2]> {
        let design = document.design();
        let size = [design.ends(), design.picks()].map(|count| 3 * u64::from(count));
        let longest = size[0].max(size[1]);
        let level = (0..16).find(|level| longest >> level <= SIDE).unwrap_or(16);
        let pixels = size.map(|side| ((side >> level).max(1)) as usize);
        let still = ui.input(|input| !input.pointer.any_down());
        let large = size[0] * size[1] > AT_ONCE;
        if self.made.is_none() || self.stale && (still || !large) {
            let image = picture(document, pixels, level);
            match &mut self.made {
                Some(texture) => texture.set(image, TextureOptions::LINEAR),
                None => {
                    let load = |image| {
                        ui.ctx()
                            .load_texture("navigator", image, TextureOptions::LINEAR)
                    };
                    self.made = Some(load(image));
                }
            }
            self.stale = false;
        }
        let texture = self.made.as_ref()?;
        let scale = tokens::NAVIGATOR / longest as f32;
        let shown = vec2(size[0] as f32 * scale, size[1] as f32 * scale).max(vec2(8.0, 8.0));
        let corner = areas.drawdown.right_bottom() - vec2(tokens::GAP, tokens::GAP);
        let rect = Rect::from_min_max(corner - shown, corner);
        if !areas.drawdown.contains_rect(rect) {
            return None;
        }
        let painter = ui.painter_at(rect.expand(2.0));
        let palette = Palette::current(ui);
        painter.rect_filled(rect.expand(2.0), 0.0, palette.raised);
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture.id(), rect, whole, Color32::WHITE);
        // The picture begins one repeat to the left of, and below, the first.
        let (ends, picks) = (f64::from(design.ends()), f64::from(design.picks()));
        let to_screen = |end: f64, pick: f64| {
            pos2(
                rect.left() + ((end + ends) / (3.0 * ends)) as f32 * rect.width(),
                rect.bottom() - ((pick + picks) / (3.0 * picks)) as f32 * rect.height(),
            )
        };
        let [seen_ends, seen_picks] = grid.visible();
        let seen = Rect::from_two_pos(
            to_screen(*seen_ends.start() as f64, *seen_picks.start() as f64),
            to_screen(
                *seen_ends.end() as f64 + 1.0,
                *seen_picks.end() as f64 + 1.0,
            ),
        );
        let stroke = Stroke::new(2.0, tokens::ACCENT);
        painter.rect_stroke(seen.intersect(rect), 0.0, stroke, egui::StrokeKind::Inside);

        let id = egui::Id::unique("navigator");
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Navigator"));
        let at = response.interact_pointer_pos()?;
        let share = (at - rect.left_bottom()) / rect.size();
        Some([
            (f64::from(share.x) * 3.0 - 1.0) * ends,
            (f64::from(-share.y) * 3.0 - 1.0) * picks,
        ])
    }
}

fn picture(document: &Document, size: [usize; 2], level: u32) -> ColorImage {
    let design = document.design();
    let window = SwatchWindow {
        end: -i64::from(design.ends()),
        pick: -i64::from(design.picks()),
        size,
        level,
    };
    tiles::image(design, document.drawdown(), window, Colouring::Yarns)
}
