//! The colourways in the cloth view: all of them as a contact sheet, or two side by side,
//! each with its name, at first sight and at one scale.

use std::sync::Arc;

use egui::{
    Button, ColorImage, ComboBox, Rect, Role, Sense, TextureHandle, TextureOptions, UiBuilder,
    WidgetInfo, pos2, vec2,
};
use pickglass::edit::{Document, Edit};
use pickglass::engine::{FirstSight, SightTables, StillRequest};

use crate::tokens::{self, Palette};
use crate::window::action::Action;
use crate::window::cloth_pane::{draw_picture, move_view};
use crate::window::panes::later::Later;
use crate::window::view::ClothView;

/// Colourways on a sheet; the pane of the colourways has them all.
const MOST: usize = 36;
/// Height of a name below its cloth.
const NAME: f32 = 7.0 * tokens::GRID;
/// Least side of a cloth on the sheet that is worth drawing, points.
const LEAST: f32 = 24.0;

/// What is laid side by side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Every colourway.
    All,
    /// The one in use and another.
    Two,
}

/// A colourway by name and place in the design's list; `None` = the yarns in use.
type Place = (String, Option<usize>);

/// What is to be drawn.
#[derive(Clone, PartialEq)]
struct Question {
    revision: u64,
    /// Of one cloth's size.
    still: StillRequest,
    places: Vec<Place>,
}

/// The sheet and its pictures.
pub struct Sheet {
    pub kind: Kind,
    /// The colourway beside the one in use, by name.
    other: Option<String>,
    drawn: Later<Question, Vec<Option<ColorImage>>>,
    /// What the textures show.
    shown: Option<Question>,
    textures: Vec<Option<TextureHandle>>,
    tables: Arc<SightTables>,
}

impl Sheet {
    /// A sheet that is drawn when it is shown.
    pub fn new(kind: Kind) -> Self {
        Self {
            kind,
            other: None,
            drawn: Later::default(),
            shown: None,
            textures: Vec::new(),
            tables: Arc::default(),
        }
    }

    /// Whether every colourway has its picture.
    #[cfg(test)]
    pub fn is_drawn(&self) -> bool {
        !self.textures.is_empty() && self.textures.iter().all(Option::is_some)
    }

    /// Shows the sheet; `still` says from where and in which light. False once it is closed.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        document: &Document,
        view: &mut ClothView,
        still: &StillRequest,
        actions: &mut Vec<Action>,
    ) -> bool {
        let pane = ui.available_rect_before_wrap();
        ui.allocate_rect(pane, Sense::hover());
        ui.painter().rect_filled(pane, 0.0, tokens::SURROUND);
        let all = document.design().colourway_order();
        let open = self.bar_ui(ui, pane, &all);
        let places = self.places(&all);
        let room = pane.with_min_y(pane.top() + tokens::GAP + 9.0 * tokens::GRID);
        let cells = cells(room.shrink(tokens::GAP), places.len());
        let Some(size) = cells.first().map(Rect::size) else {
            return open;
        };
        if size.min_elem() < LEAST {
            return open;
        }
        self.ask(ui, document, size, *view, still, &places);
        for (index, (cell, (name, place))) in cells.into_iter().zip(&places).enumerate() {
            self.cell_ui(ui, cell, index, name, view);
            let plate = Rect::from_min_size(cell.left_bottom(), vec2(cell.width(), NAME));
            let button = Button::new(name.as_str())
                .truncate()
                .selected(place.is_none());
            let response = ui.put(plate.shrink2(vec2(0.0, 0.5 * tokens::GRID)), button);
            let spoken = match place {
                None => format!("{name}, in use"),
                Some(_) => format!("Weave in {name}"),
            };
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &spoken));
            if response.on_hover_text(&spoken).clicked()
                && let Some(place) = place
            {
                actions.push(Action::edit(Edit::UseColourway(*place)));
            }
        }
        open
    }

    /// The colourways that are shown, in their order.
    fn places(&self, all: &[Place]) -> Vec<Place> {
        match self.kind {
            Kind::All => all.iter().take(MOST).cloned().collect(),
            Kind::Two => {
                let own = all.iter().find(|(_, place)| place.is_none());
                let others = || all.iter().filter(|(_, place)| place.is_some());
                let named = others().find(|(name, _)| Some(name) == self.other.as_ref());
                let other = named.or_else(|| others().next());
                own.into_iter().chain(other).cloned().collect()
            }
        }
    }

    /// Which other colourway, how many do not fit, and the way back. False = close.
    fn bar_ui(&mut self, ui: &mut egui::Ui, pane: Rect, all: &[Place]) -> bool {
        let bar = Rect::from_min_size(
            pane.min + vec2(tokens::GAP, tokens::GAP),
            vec2(pane.width() - 2.0 * tokens::GAP, 8.0 * tokens::GRID),
        );
        let mut bar = ui.new_child(UiBuilder::new().max_rect(bar));
        let palette = Palette::current(ui);
        let mut open = true;
        egui::Frame::new()
            .fill(palette.raised)
            .corner_radius(tokens::RADIUS)
            .inner_margin(tokens::GRID)
            .show(&mut bar, |ui| {
                ui.horizontal(|ui| {
                    match self.kind {
                        Kind::All if all.len() > MOST => {
                            ui.label(format!("{MOST} of {} colourways", all.len()));
                        }
                        Kind::All => {
                            ui.label(format!("{} colourways", all.len()));
                        }
                        Kind::Two => self.other_ui(ui, all),
                    }
                    let close = ui.button("Close").on_hover_text("The cloth alone again");
                    open = !close.clicked();
                });
            });
        open
    }

    fn other_ui(&mut self, ui: &mut egui::Ui, all: &[Place]) {
        let chosen = self.places(all).get(1).map(|(name, _)| name.clone());
        let mut name = chosen.clone().unwrap_or_default();
        let label = ui.label("Beside");
        let shown = ComboBox::from_id_salt("other colourway")
            .selected_text(&name)
            .show_ui(ui, |ui| {
                for (other, _) in all.iter().filter(|(_, place)| place.is_some()) {
                    ui.selectable_value(&mut name, other.clone(), other);
                }
            });
        shown.response.labelled_by(label.id);
        if chosen.as_ref() != Some(&name) {
            self.other = Some(name);
        }
    }

    /// Has the colourways drawn that are in view now.
    fn ask(
        &mut self,
        ui: &egui::Ui,
        document: &Document,
        size: egui::Vec2,
        view: ClothView,
        still: &StillRequest,
        places: &[Place],
    ) {
        let pixels = size * ui.ctx().pixels_per_point();
        let question = Question {
            revision: document.revision(),
            still: StillRequest {
                width: (pixels.x as u32).max(1),
                height: (pixels.y as u32).max(1),
                width_mm: Some(view.mm_per_point * size.x),
                centre_mm: Some(view.centre_mm),
                ..still.clone()
            },
            places: places.to_vec(),
        };
        let (design, drawdown) = (
            Arc::clone(document.design()),
            Arc::clone(document.drawdown()),
        );
        let (tables, wanted) = (Arc::clone(&self.tables), question.clone());
        self.drawn.ask(ui.ctx(), &question, move |job| {
            let one = |(name, place): &Place| {
                let request = StillRequest {
                    colourway: place.map(|_| name.clone()),
                    ..wanted.still.clone()
                };
                let (design, drawdown) = (Arc::clone(&design), Arc::clone(&drawdown));
                let sight = FirstSight::new(design, drawdown, Arc::clone(&tables));
                let seen = sight.look(&request, job).ok()?;
                let size = [request.width, request.height].map(|side| side as usize);
                Some(ColorImage::from_rgba_unmultiplied(size, &seen.rgba))
            };
            wanted.places.iter().map(one).collect()
        });
        if self.drawn.question() != self.shown.as_ref()
            && let Some(images) = self.drawn.answer()
        {
            self.textures = (images.iter())
                .map(|image| {
                    let image = image.clone()?;
                    Some(
                        ui.ctx()
                            .load_texture("colourway", image, TextureOptions::LINEAR),
                    )
                })
                .collect();
            self.shown = self.drawn.question().cloned();
        }
    }

    /// One cloth; all of them move together.
    fn cell_ui(
        &self,
        ui: &mut egui::Ui,
        cell: Rect,
        index: usize,
        name: &str,
        view: &mut ClothView,
    ) {
        let id = egui::Id::unique(("colourway cloth", index));
        let response = ui.interact(cell, id, Sense::click_and_drag());
        let spoken = format!("Cloth in {name}");
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &spoken));
        move_view(ui, &response, cell, view);
        let painter = ui.painter_at(cell);
        let texture = self.textures.get(index).and_then(Option::as_ref);
        if let (Some(shown), Some(texture)) = (&self.shown, texture) {
            draw_picture(&painter, cell, *view, &shown.still, texture);
        }
        let colour = if response.has_focus() {
            tokens::ACCENT
        } else {
            Palette::current(ui).line
        };
        let stroke = egui::Stroke::new(1.0, colour);
        painter.rect_stroke(cell, 0.0, stroke, egui::StrokeKind::Inside);
    }
}

/// Cells of one size for `count` cloths with room for a name below each, as large as the
/// room allows.
fn cells(room: Rect, count: usize) -> Vec<Rect> {
    let size = |columns: usize| {
        let rows = count.div_ceil(columns.max(1)).max(1) as f32;
        let width = (room.width() + tokens::GAP) / columns.max(1) as f32 - tokens::GAP;
        let height = (room.height() + tokens::GAP) / rows - tokens::GAP - NAME;
        vec2(width, height)
    };
    let best = (1..=count).max_by(|&a, &b| {
        let least = |columns| size(columns).min_elem();
        least(a).total_cmp(&least(b))
    });
    let Some(columns) = best else {
        return Vec::new();
    };
    let size = size(columns).max(vec2(1.0, 1.0));
    (0..count)
        .map(|index| {
            let (column, row) = ((index % columns) as f32, (index / columns) as f32);
            let corner = pos2(
                room.left() + column * (size.x + tokens::GAP),
                room.top() + row * (size.y + NAME + tokens::GAP),
            );
            Rect::from_min_size(corner, size)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_lie_in_the_room_apart_from_each_other() {
        let room = Rect::from_min_size(pos2(10.0, 20.0), vec2(600.0, 400.0));
        for count in 1..=MOST {
            let cells = cells(room, count);
            assert_eq!(cells.len(), count);
            for (index, cell) in cells.iter().enumerate() {
                let named = cell.with_max_y(cell.bottom() + NAME);
                assert!(room.expand(0.1).contains_rect(named), "{count}: {named:?}");
                for other in &cells[index + 1..] {
                    assert!(!named.shrink(0.1).intersects(other.shrink(0.1)), "{count}");
                }
            }
        }
        // Two lie beside each other where there is more width.
        let two = cells(room, 2);
        assert!(two[0].top() == two[1].top() && two[0].right() < two[1].left());
    }
}
