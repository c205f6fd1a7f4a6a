//! A cut through the cloth along an end or a pick: how the threads pass over and under.

use egui::{RichText, Sense, Shape, Stroke, pos2, vec2};
use pickglass::design::{Direction, Srgb, YarnId};
use pickglass::edit::Document;
use pickglass::text::visible;
use pickglass::yarn::{CrossSection, MOST_CROSSINGS, cross_section};

use super::{PaneView, Shown};
use crate::tokens::{self, Palette};
use crate::window::action::Action;

use crate::window::{crossing, typing};

/// Width of a crossing, points.
const CROSSING: f32 = 30.0;
/// Threads that can be asked for from the first.
const FURTHEST: i64 = 1 << 30;

/// What is cut.
pub struct Section {
    /// The crossing in the middle of the cut.
    at: (i64, i64),
    along_pick: bool,
    /// Whether the cut follows the pointer.
    follows: bool,
    known: Option<(Question, Option<CrossSection>)>,
}

/// Revision, crossing, direction and length of a cut.
type Question = (u64, (i64, i64), bool, u32);

impl Default for Section {
    fn default() -> Self {
        Self {
            at: (0, 0),
            along_pick: true,
            follows: true,
            known: None,
        }
    }
}

impl PaneView for Section {
    fn show(&mut self, ui: &mut egui::Ui, shown: &Shown<'_>, _: &mut Vec<Action>) {
        let document = shown.document;
        let quiet = Palette::current(ui).quiet;
        ui.horizontal_wrapped(|ui| {
            ui.radio_value(&mut self.along_pick, true, "Along a pick");
            ui.radio_value(&mut self.along_pick, false, "Along an end");
            let shown = self.number(document);
            let mut number = shown;
            let label = ui.label("number");
            let field = egui::DragValue::new(&mut number).range(-FURTHEST..=FURTHEST);
            if typing::number(ui, field).labelled_by(label.id).changed() {
                let thread = if self.along_pick {
                    &mut self.at.1
                } else {
                    &mut self.at.0
                };
                *thread += number - shown;
                self.follows = false;
            }
            ui.checkbox(&mut self.follows, "follow the pointer");
        });
        let room = ui
            .available_size()
            .max(vec2(8.0 * CROSSING, 4.0 * CROSSING));
        let count = ((room.x / CROSSING) as u32).clamp(2, MOST_CROSSINGS);
        let question = (document.revision(), self.at, self.along_pick, count);
        if self
            .known
            .as_ref()
            .is_none_or(|(known, _)| *known != question)
        {
            let (direction, thread, middle) = match self.along_pick {
                true => (Direction::Weft, self.at.1, self.at.0),
                false => (Direction::Warp, self.at.0, self.at.1),
            };
            let first = middle - i64::from(count / 2);
            let (design, drawdown) = (document.design(), document.drawdown());
            let cut = cross_section(design, drawdown, direction, thread, first, count);
            self.known = Some((question, cut));
        }
        match &self.known {
            Some((_, Some(cut))) => {
                draw(ui, document, cut, self.along_pick, self.number(document));
            }
            _ => {
                ui.label(RichText::new("There is no cloth here.").color(quiet));
            }
        }
    }

    // Forgets the cut, and where it was.
    fn forget(&mut self) {
        self.at = (0, 0);
        self.known = None;
    }
}

impl Section {
    /// Follows the pointer over another view.
    pub fn follow(&mut self, crossing: Option<(i64, i64)>) {
        if let Some(crossing) = crossing.filter(|_| self.follows) {
            self.at = crossing;
        }
    }

    /// The number of the thread that is cut, as it is told of the crossing in the middle; where
    /// there is no cloth, how far it lies from the first.
    fn number(&self, document: &Document) -> i64 {
        let (end, pick) = match crossing::numbers(document.design(), self.at) {
            Some((end, pick)) => (i64::from(end), i64::from(pick)),
            None => (self.at.0 + 1, self.at.1 + 1),
        };
        if self.along_pick { pick } else { end }
    }
}

fn draw(ui: &mut egui::Ui, document: &Document, cut: &CrossSection, along_pick: bool, number: i64) {
    let palette = Palette::current(ui);
    let width = ui.available_width();
    let scale = width / cut.length_mm.max(1e-3);
    let points = cut.upper.iter().chain(&cut.lower);
    let outlines = cut.threads.iter().flat_map(|thread| &thread.outline);
    let (low, high) = points
        .chain(outlines)
        .fold((0.0f32, 0.0f32), |(low, high), point| {
            (low.min(point.y), high.max(point.y))
        });
    let height = (high - low) * scale + 2.0 * tokens::PAD;
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
    let what = if along_pick { "pick" } else { "end" };
    let spoken = format!("Cut along {what} {number}: the face is above");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &spoken));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, tokens::SURROUND);
    let base = rect.bottom() - tokens::PAD + low * scale;
    let at = |x: f32, y: f32| pos2(rect.left() + x * scale, base - y * scale);
    let fill = |id: YarnId| {
        let Srgb(red, green, blue) = document.design().yarn(id).colour;
        tokens::yarn_colour(red, green, blue)
    };
    let edge = Stroke::new(1.0, palette.deep);
    let thread = |over: bool| {
        for thread in cut.threads.iter().filter(|thread| thread.over == over) {
            let outline = thread
                .outline
                .iter()
                .map(|point| at(point.x, point.y))
                .collect();
            painter.add(Shape::convex_polygon(outline, fill(thread.yarn), edge));
        }
    };
    // Those behind the cut thread, the thread in short pieces, those before it.
    thread(true);
    thread(false);
    let own = fill(cut.yarn);
    for (upper, lower) in cut.upper.windows(2).zip(cut.lower.windows(2)) {
        let piece = [upper[0], upper[1], lower[1], lower[0]].map(|point| at(point.x, point.y));
        painter.add(Shape::convex_polygon(piece.to_vec(), own, Stroke::NONE));
    }
    for side in [&cut.upper, &cut.lower] {
        let line = side.iter().map(|point| at(point.x, point.y)).collect();
        painter.add(Shape::line(line, edge));
    }
    let yarn = visible(&document.design().yarn(cut.yarn).name);
    ui.label(
        RichText::new(format!("{spoken} · {yarn}"))
            .small()
            .color(palette.quiet),
    );
}
