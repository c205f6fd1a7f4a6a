//! The navigator: three by three repeats, small, with a frame round what is seen. Dragging
//! in it moves the view.

use std::ops::RangeInclusive;
use std::sync::Arc;

use egui::{Color32, ColorImage, Rect, Sense, Stroke, TextureHandle, TextureOptions, pos2, vec2};
use pickglass::design::{Colouring, Design, Repeat, SwatchWindow, WeavePattern};
use pickglass::edit::{Change, Document};

use super::super::focus;
use super::super::laid;
use super::super::task::{Outcome, Task};
use super::areas::Areas;
use super::grid::{CellGrid, way};
use super::tiles;
use crate::tokens::{self, Palette};

/// Pixels along the longer side of one repeat.
const SIDE: u32 = 96;
/// An arrow key moves the view by this share of the repeat.
const KEY_STEP: f64 = 0.1;

/// The navigator's picture of one repeat.
#[derive(Default)]
pub struct Navigator {
    made: Option<TextureHandle>,
    stale: bool,
    making: Option<Task<ColorImage>>,
    /// Where it was shown last.
    place: Option<Rect>,
}

impl Navigator {
    /// Forgets the picture.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// The picture is to be made again.
    pub fn changed(&mut self, change: &Change) {
        if change.size {
            self.forget();
        }
        self.stale = true;
    }

    /// Whether a point lies on it, so that nothing below it is meant.
    pub fn covers(&self, at: egui::Pos2) -> bool {
        self.place.is_some_and(|place| place.contains(at))
    }

    /// Has the picture made on a thread, the newest state when the last one is done.
    fn make(&mut self, ctx: &egui::Context, document: &Document) {
        if let Some(making) = &self.making {
            match making.poll() {
                Outcome::Working => return,
                Outcome::Ready(image) => match &mut self.made {
                    Some(texture) => texture.set(image, TextureOptions::LINEAR),
                    None => {
                        let options = TextureOptions::LINEAR;
                        self.made = Some(ctx.load_texture("navigator", image, options));
                    }
                },
                Outcome::Lost => {}
            }
            self.making = None;
        }
        if self.made.is_none() || self.stale {
            let (design, drawdown) = (
                Arc::clone(document.design()),
                Arc::clone(document.drawdown()),
            );
            self.making = Task::start(ctx, "navigator", move || picture(&design, &drawdown)).ok();
            self.stale = false;
        }
    }

    /// Shows it in the lower right corner of the drawdown; returns where to look.
    pub fn show(
        &mut self,
        ui: &egui::Ui,
        document: &Document,
        areas: &Areas,
        grid: &CellGrid,
    ) -> Option<[f64; 2]> {
        self.place = None;
        self.make(ui.ctx(), document);
        let design = document.design();
        let (ends, picks) = laid::whole(design);
        let size = [ends, picks].map(|count| 3 * u64::from(count));
        let longest = size[0].max(size[1]);
        let texture = self.made.as_ref()?.id();
        let scale = tokens::NAVIGATOR / longest as f32;
        let shown = vec2(size[0] as f32 * scale, size[1] as f32 * scale).max(vec2(8.0, 8.0));
        let corner = areas.drawdown.right_bottom() - vec2(tokens::GAP, tokens::GAP);
        let rect = Rect::from_min_max(corner - shown, corner);
        if !areas.drawdown.contains_rect(rect) {
            return None;
        }
        self.place = Some(rect);
        let painter = ui.painter_at(rect.expand(2.0));
        let palette = Palette::current(ui);
        painter.rect_filled(rect.expand(2.0), 0.0, palette.raised);
        // The middle one of three by three repeats is the design itself.
        let (ends, picks) = (f64::from(ends), f64::from(picks));
        let side = |share: f64| if grid.turned { 1.0 - share } else { share };
        let to_screen = |end: f64, pick: f64| {
            pos2(
                rect.left() + side((end + ends) / (3.0 * ends)) as f32 * rect.width(),
                rect.bottom() - side((pick + picks) / (3.0 * picks)) as f32 * rect.height(),
            )
        };
        let inner = painter.with_clip_rect(rect);
        for (end, pick) in repeats(design) {
            let place = Rect::from_two_pos(
                to_screen(end as f64, pick as f64),
                to_screen(end as f64 + ends, pick as f64 + picks),
            );
            inner.image(texture, place, grid.picture_uv(), Color32::WHITE);
        }
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
        if response.clicked() {
            response.request_focus();
        }
        if response.has_focus() {
            focus::ring(&painter, rect.expand(2.0), &palette);
        }
        let way = way(grid.turned);
        let [across, along] = focus::arrows(ui, &response).map(|by| way * f64::from(by));
        if across != 0.0 || along != 0.0 {
            let middle = |seen: &RangeInclusive<i64>| (seen.start() + seen.end() + 1) as f64 / 2.0;
            return Some([
                middle(&seen_ends) + across * ends * KEY_STEP,
                middle(&seen_picks) + along * picks * KEY_STEP,
            ]);
        }
        let at = response.interact_pointer_pos()?;
        let share = (at - rect.left_bottom()) / rect.size();
        Some([
            (side(f64::from(share.x)) * 3.0 - 1.0) * ends,
            (side(f64::from(-share.y)) * 3.0 - 1.0) * picks,
        ])
    }
}

/// Lower left corners of the repeats in and around the design, as its lattice puts them.
fn repeats(design: &Design) -> Vec<(i64, i64)> {
    let (ends, picks) = laid::whole(design);
    let (ends, picks) = (i64::from(ends), i64::from(picks));
    let lattice = design.lattice();
    let reach = |repeat: Repeat| {
        if repeat == Repeat::None {
            0..=0
        } else {
            -2..=2
        }
    };
    let dropped = |repeat: Repeat| match repeat {
        Repeat::Dropped(by) => i64::from(by),
        _ => 0,
    };
    let mut corners = Vec::new();
    for column in reach(lattice.across) {
        for row in reach(lattice.along) {
            corners.push((
                column * ends + row * dropped(lattice.along),
                row * picks + column * dropped(lattice.across),
            ));
        }
    }
    corners
}

fn picture(design: &Design, drawdown: &WeavePattern) -> ColorImage {
    let (ends, picks) = laid::whole(design);
    let longest = ends.max(picks);
    let level = (0..16).find(|level| longest >> level <= SIDE).unwrap_or(16);
    let pixels = |count: u32| (count >> level).max(1) as usize;
    let window = SwatchWindow {
        end: 0,
        pick: 0,
        size: [pixels(ends), pixels(picks)],
        level,
    };
    tiles::image(design, drawdown, window, Colouring::Yarns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::session::blank;
    use pickglass::design::Lattice;

    #[test]
    fn repeats_lie_where_the_lattice_has_the_same_crossing() {
        let dropped = Lattice {
            across: Repeat::Dropped(5),
            along: Repeat::Straight,
        };
        for lattice in [Lattice::default(), dropped] {
            let design = Design::clone(&blank().expect("a design").design);
            let design = design.with_lattice(lattice).expect("a lattice");
            for (end, pick) in repeats(&design) {
                let home = lattice.wrap(end, pick, design.ends(), design.picks());
                assert_eq!(home, Some((0, 0)), "{lattice:?} {end} {pick}");
            }
        }
        let panel = Lattice {
            across: Repeat::None,
            along: Repeat::None,
        };
        let design = Design::clone(&blank().expect("a design").design);
        let design = design.with_lattice(panel).expect("a lattice");
        assert_eq!(repeats(&design), [(0, 0)]);
    }
}
