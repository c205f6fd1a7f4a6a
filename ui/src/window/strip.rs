//! The strip beside the cloth: the drawdown, crisp to the pixel, and the yarns.

use std::sync::Arc;

use egui::{
    Color32, ColorImage, Rect, RichText, Sense, Stroke, TextureHandle, TextureOptions, vec2,
};
use pickglass::design::{Design, Srgb, YarnId, YarnMap};

use crate::opened::Opened;
use crate::tokens::{self, Palette};

/// Grid lines are drawn between cells of at least this many pixels.
const GRID_FROM: usize = 6;
/// Every so manieth grid line is stronger.
const STRONG_EVERY: u32 = 4;
/// A drawdown takes at most this share of the strip's height.
const LARGEST_SHARE: f32 = 0.6;
/// A cell is at most this many pixels.
const LARGEST_CELL: usize = 24;

/// The drawdown's texture and what it was made for.
#[derive(Default)]
pub struct Strip {
    made: Option<Made>,
}

struct Made {
    design: Arc<Design>,
    room: [usize; 2],
    drawdown: Drawdown,
    texture: TextureHandle,
}

/// A drawdown as pixels.
struct Drawdown {
    image: ColorImage,
    /// Crossings a pixel; 1 unless the design is larger than the room.
    crossings_a_pixel: u32,
}

impl Strip {
    /// Shows the strip; returns the point of the design, in repeats from its lower left
    /// corner, that was clicked.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        opened: &Opened,
        shown: Option<Rect>,
    ) -> Option<[f32; 2]> {
        let palette = Palette::current(ui);
        ui.add_space(tokens::GAP);
        ui.label(RichText::new(opened.name()).text_style(egui::TextStyle::Heading));
        let design = &opened.design;
        let (ends, picks) = (design.ends(), design.picks());
        ui.label(RichText::new(format!("{ends} ends × {picks} picks")).color(palette.quiet));
        ui.add_space(tokens::GAP);
        let clicked = self.drawdown_ui(ui, opened, shown);
        ui.add_space(tokens::PAD);
        ui.label(RichText::new("Yarns").text_style(egui::TextStyle::Heading));
        egui::ScrollArea::vertical().show(ui, |ui| yarns_ui(ui, design));
        clicked
    }

    fn drawdown_ui(
        &mut self,
        ui: &mut egui::Ui,
        opened: &Opened,
        shown: Option<Rect>,
    ) -> Option<[f32; 2]> {
        let density = ui.ctx().pixels_per_point();
        let room_points = vec2(ui.available_width(), ui.available_height() * LARGEST_SHARE);
        let room = [
            (room_points.x * density).floor().max(1.0) as usize,
            (room_points.y * density).floor().max(1.0) as usize,
        ];
        let fresh = self
            .made
            .as_ref()
            .is_some_and(|made| Arc::ptr_eq(&made.design, &opened.design) && made.room == room);
        if !fresh {
            let drawdown = draw(opened, room);
            let texture =
                ui.ctx()
                    .load_texture("drawdown", drawdown.image.clone(), TextureOptions::NEAREST);
            self.made = Some(Made {
                design: Arc::clone(&opened.design),
                room,
                drawdown,
                texture,
            });
        }
        let made = self.made.as_ref()?;
        let [width, height] = made.drawdown.image.size;
        let size = vec2(width as f32, height as f32) / density;
        let (place, response) = ui.allocate_exact_size(size, Sense::click());
        let rect = snapped(place, size, density);
        let whole = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
        let painter = ui.painter_at(rect.expand(1.0));
        painter.image(made.texture.id(), rect, whole, Color32::WHITE);
        if let Some(shown) = shown {
            let frame = Rect::from_min_max(
                rect.left_bottom() + vec2(shown.min.x * rect.width(), -shown.max.y * rect.height()),
                rect.left_bottom() + vec2(shown.max.x * rect.width(), -shown.min.y * rect.height()),
            );
            let stroke = Stroke::new(2.0, tokens::ACCENT);
            painter.rect_stroke(frame.intersect(rect), 0.0, stroke, egui::StrokeKind::Inside);
        }
        let name = opened.name().to_owned();
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Image, true, format!("Drawdown of {name}"))
        });
        if made.drawdown.crossings_a_pixel > 1 {
            let step = made.drawdown.crossings_a_pixel;
            ui.label(
                RichText::new(format!(
                    "Larger than the strip: a pixel is {step} × {step} crossings"
                ))
                .small()
                .color(Palette::current(ui).quiet),
            );
        }
        let at = response
            .on_hover_text(
                "One repeat; warp or weft on top at every crossing. Click to look there.",
            )
            .interact_pointer_pos()
            .filter(|_| ui.input(|input| input.pointer.primary_clicked()))?;
        let offset = (at - rect.left_bottom()) / rect.size();
        Some([offset.x, -offset.y])
    }
}

/// The rectangle of this size whose corners lie on physical pixels.
fn snapped(place: Rect, size: egui::Vec2, density: f32) -> Rect {
    let corner = (place.min.to_vec2() * density).round() / density;
    Rect::from_min_size(corner.to_pos2(), size)
}

/// Draws one repeat into at most `room` pixels.
fn draw(opened: &Opened, room: [usize; 2]) -> Drawdown {
    let (ends, picks) = opened.whole();
    let cell = (room[0] / ends as usize)
        .min(room[1] / picks as usize)
        .min(LARGEST_CELL);
    if cell >= 1 {
        return Drawdown {
            image: draw_cells(opened, cell),
            crossings_a_pixel: 1,
        };
    }
    let step = (ends as usize)
        .div_ceil(room[0])
        .max((picks as usize).div_ceil(room[1])) as u32;
    Drawdown {
        image: draw_means(opened, step),
        crossings_a_pixel: step,
    }
}

/// Each crossing as a square of `cell` pixels. The sides along which the yarn on top
/// lies are shaded, so that equal colours can be told apart.
fn draw_cells(opened: &Opened, cell: usize) -> ColorImage {
    let (ends, picks) = opened.whole();
    let (width, height) = (ends as usize * cell, picks as usize * cell);
    let mut image = ColorImage::filled([width, height], Color32::BLACK);
    for pick in 0..picks {
        let top = (picks - 1 - pick) as usize * cell;
        for end in 0..ends {
            let left = end as usize * cell;
            let Srgb(red, green, blue) = opened.colour_on_top(end, pick);
            let colour = tokens::yarn_colour(red, green, blue);
            let shaded = colour.lerp_to_gamma(Color32::BLACK, 0.28);
            let up = opened.warp_up(end, pick);
            for y in 0..cell {
                for x in 0..cell {
                    let across = if up { x } else { y };
                    let edge = cell >= 4 && (across == 0 || across == cell - 1);
                    let mut pixel = if edge { shaded } else { colour };
                    if cell >= GRID_FROM && (x == 0 || y == cell - 1) {
                        pixel = pixel.blend(grid_line(x == 0, end, y == cell - 1, pick));
                    }
                    image[(left + x, top + y)] = pixel;
                }
            }
        }
    }
    image
}

fn grid_line(on_end: bool, end: u32, on_pick: bool, pick: u32) -> Color32 {
    let strong = (on_end && end.is_multiple_of(STRONG_EVERY))
        || (on_pick && pick.is_multiple_of(STRONG_EVERY));
    if strong {
        tokens::GRID_LINE_STRONG
    } else {
        tokens::GRID_LINE
    }
}

/// Each pixel as the mean of `step` × `step` crossings, in linear light.
fn draw_means(opened: &Opened, step: u32) -> ColorImage {
    let (ends, picks) = opened.whole();
    let size = [ends.div_ceil(step) as usize, picks.div_ceil(step) as usize];
    let mut image = ColorImage::filled(size, Color32::BLACK);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let (left, bottom) = (x as u32 * step, (size[1] - 1 - y) as u32 * step);
            let mut sum = egui::Rgba::TRANSPARENT;
            let mut count = 0.0;
            for pick in bottom..(bottom + step).min(picks) {
                for end in left..(left + step).min(ends) {
                    let Srgb(red, green, blue) = opened.colour_on_top(end, pick);
                    sum = sum + egui::Rgba::from(tokens::yarn_colour(red, green, blue));
                    count += 1.0;
                }
            }
            image[(x, y)] = Color32::from(sum * (1.0 / f32::max(count, 1.0)));
        }
    }
    image
}

fn yarns_ui(ui: &mut egui::Ui, design: &Design) {
    let palette = Palette::current(ui);
    for (index, yarn) in design.yarns().iter().enumerate() {
        ui.horizontal(|ui| {
            let side = 6.0 * tokens::GRID;
            let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::hover());
            let Srgb(red, green, blue) = yarn.colour;
            ui.painter().rect(
                rect,
                tokens::RADIUS,
                tokens::yarn_colour(red, green, blue),
                Stroke::new(1.0, palette.line),
                egui::StrokeKind::Inside,
            );
            response.on_hover_text(format!("sRGB {red} {green} {blue}"));
            ui.vertical(|ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                ui.label(&yarn.name);
                let roles = roles(design, index);
                ui.label(
                    RichText::new(format!("{} · {roles}", yarn.family.name()))
                        .small()
                        .color(palette.quiet),
                );
            });
        });
    }
}

fn roles(design: &Design, yarn: usize) -> &'static str {
    let maps = design.maps();
    match (uses(&maps.warp, yarn), uses(&maps.weft, yarn)) {
        (true, true) => "warp and weft",
        (true, false) => "warp",
        (false, true) => "weft",
        (false, false) => "not used",
    }
}

fn uses(map: &YarnMap, yarn: usize) -> bool {
    let is = |id: YarnId| usize::from(id.0) == yarn;
    match map {
        YarnMap::Order(order) => order.iter().copied().any(is),
        YarnMap::Crossings(grid) => {
            (0..grid.picks()).any(|pick| (0..grid.ends()).any(|end| is(grid.get(end, pick))))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_drawdown_shows_the_yarn_on_top_with_pick_0_below() {
        let opened = Opened::preset("herringbone").expect("a preset");
        let cell = 5;
        let image = draw_cells(&opened, cell);
        let (ends, picks) = opened.whole();
        for pick in 0..picks {
            for end in 0..ends {
                let Srgb(red, green, blue) = opened.colour_on_top(end, pick);
                let x = end as usize * cell + cell / 2;
                let y = (picks - 1 - pick) as usize * cell + cell / 2;
                assert_eq!(image[(x, y)], tokens::yarn_colour(red, green, blue));
            }
        }
    }

    #[test]
    fn a_design_larger_than_the_room_is_averaged() {
        let opened = Opened::preset("herringbone").expect("a preset");
        let (ends, picks) = opened.whole();
        let largest = ends.max(picks);
        let drawdown = draw(&opened, [1, 1]);
        assert_eq!(
            (drawdown.image.size, drawdown.crossings_a_pixel),
            ([1, 1], largest)
        );
    }
}
