//! The start page: presets as woven thumbnails, recent files, and where to drop a file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Color32, Rect, RichText, Sense, TextureHandle, TextureOptions, vec2};
use pickglass::design::{Colouring, Design, SwatchWindow, swatch};
use pickglass::edit::recovery::Found;
use pickglass::formats::presets;

use super::autosave::ago;
use super::focus;
use super::task::{Outcome, Task};
use crate::command_table::{Command, row_of};
use crate::tokens::{self, Palette};

/// Side of a thumbnail, points.
const SIDE: f32 = 148.0;
/// Pixels along the side of a thumbnail's picture.
const PIXELS: usize = 296;
/// A crossing is at most this many pixels of a thumbnail.
const LARGEST_CELL: usize = 6;

/// What was chosen.
pub enum Choice {
    Command(Command),
    Preset(&'static str),
    Recent(PathBuf),
    Recover(Found),
    Discard(PathBuf),
}

/// A preset's picture and what is written below it.
struct Thumbnail {
    name: &'static str,
    title: String,
    caption: String,
    texture: TextureHandle,
}

type Drawn = Vec<(&'static str, Arc<Design>, Vec<[u8; 4]>)>;

/// The start page's state.
#[derive(Default)]
pub struct StartPage {
    drawing: Option<Task<Drawn>>,
    thumbnails: Option<Vec<Thumbnail>>,
}

impl StartPage {
    /// Shows the page.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        recent: &[PathBuf],
        found: &[Found],
    ) -> Option<Choice> {
        self.draw(ui.ctx());
        let mut choice = None;
        egui::ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                ui.add_space(2.0 * tokens::PAD);
                egui::Frame::new()
                    .inner_margin(egui::Margin::symmetric(2 * tokens::PAD as i8, 0))
                    .show(ui, |ui| {
                        choice = begin_ui(ui);
                        choice = recover_ui(ui, found).or(choice.take());
                        choice = recent_ui(ui, recent).or(choice.take());
                        choice = self.presets_ui(ui).or(choice.take());
                    });
            });
        choice
    }

    /// Has the thumbnails drawn, on a thread the first time.
    fn draw(&mut self, ctx: &egui::Context) {
        if self.thumbnails.is_some() {
            return;
        }
        let Some(drawing) = &self.drawing else {
            self.drawing = Task::start(ctx, "thumbnails", draw_all).ok();
            return;
        };
        match drawing.poll() {
            Outcome::Working => {}
            Outcome::Lost => self.thumbnails = Some(Vec::new()),
            Outcome::Ready(drawn) => {
                let load = |(name, design, pixels): (&'static str, Arc<Design>, Vec<[u8; 4]>)| {
                    let image = egui::ColorImage::from_rgba_unmultiplied(
                        [PIXELS; 2],
                        pixels.as_flattened(),
                    );
                    Thumbnail {
                        name,
                        title: design.name.clone(),
                        caption: format!("{} × {}", design.ends(), design.picks()),
                        texture: ctx.load_texture(name, image, TextureOptions::LINEAR),
                    }
                };
                self.thumbnails = Some(drawn.into_iter().map(load).collect());
            }
        }
    }

    fn presets_ui(&self, ui: &mut egui::Ui) -> Option<Choice> {
        ui.label(RichText::new("Presets").text_style(egui::TextStyle::Heading));
        ui.add_space(tokens::GRID);
        let Some(thumbnails) = &self.thumbnails else {
            ui.spinner();
            return None;
        };
        let mut choice = None;
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(tokens::PAD, tokens::PAD);
            for thumbnail in thumbnails {
                if thumbnail_ui(ui, thumbnail) {
                    choice = Some(Choice::Preset(thumbnail.name));
                }
            }
        });
        choice
    }
}

/// New, open, and what else one can do.
fn begin_ui(ui: &mut egui::Ui) -> Option<Choice> {
    let quiet = Palette::current(ui).quiet;
    let mut choice = None;
    ui.label(RichText::new("Pickglass").text_style(tokens::title()));
    ui.label(RichText::new("Paint a weave, watch the cloth.").color(quiet));
    ui.add_space(tokens::PAD);
    ui.horizontal_wrapped(|ui| {
        for command in [Command::New, Command::Open, Command::OpenPath] {
            let Some(row) = row_of(command) else { continue };
            let button = egui::Button::new(row.label).min_size(vec2(0.0, 32.0));
            if ui.add(button).on_hover_text(row.tip).clicked() {
                choice = Some(Choice::Command(command));
            }
        }
        ui.label(RichText::new("or drop a design, a draft or an image here").color(quiet));
    });
    ui.add_space(2.0 * tokens::PAD);
    choice
}

/// Work that an earlier run left unsaved.
fn recover_ui(ui: &mut egui::Ui, found: &[Found]) -> Option<Choice> {
    if found.is_empty() {
        return None;
    }
    let palette = Palette::current(ui);
    let mut choice = None;
    ui.label(RichText::new("Unsaved work").text_style(egui::TextStyle::Heading));
    ui.label(RichText::new("Pickglass ended before these were saved.").color(palette.quiet));
    ui.add_space(tokens::GRID);
    for copy in found {
        ui.horizontal(|ui| {
            let name = match copy.name.trim() {
                "" => "untitled",
                name => name,
            };
            if ui.button(format!("Recover {name}")).clicked() {
                choice = Some(Choice::Recover(copy.clone()));
            }
            let discard = ui.button("Discard");
            discard.widget_info(|| {
                let label = format!("Discard {name}");
                egui::WidgetInfo::labeled(egui::Role::Button, true, label)
            });
            if discard.clicked() {
                choice = Some(Choice::Discard(copy.path.clone()));
            }
            let from = match &copy.original {
                Some(path) => format!("{} · {}", ago(copy.time), path.display()),
                None => format!("{} · in no file yet", ago(copy.time)),
            };
            ui.add(egui::Label::new(RichText::new(from).color(palette.quiet)).truncate());
        });
    }
    ui.add_space(2.0 * tokens::PAD);
    choice
}

fn recent_ui(ui: &mut egui::Ui, recent: &[PathBuf]) -> Option<Choice> {
    if recent.is_empty() {
        return None;
    }
    let mut choice = None;
    ui.label(RichText::new("Recent files").text_style(egui::TextStyle::Heading));
    ui.add_space(tokens::GRID);
    let quiet = Palette::current(ui).quiet;
    for path in recent.iter().take(5) {
        ui.horizontal(|ui| {
            let name = path
                .file_name()
                .unwrap_or(path.as_os_str())
                .to_string_lossy();
            let there = path.exists();
            if ui.add_enabled(there, egui::Button::new(name)).clicked() {
                choice = Some(Choice::Recent(path.clone()));
            }
            let folder = path.parent().unwrap_or(Path::new("")).display().to_string();
            let note = if there {
                folder
            } else {
                format!("{folder} (not there any more)")
            };
            ui.add(egui::Label::new(RichText::new(note).color(quiet)).truncate());
        });
    }
    ui.add_space(2.0 * tokens::PAD);
    choice
}

fn thumbnail_ui(ui: &mut egui::Ui, thumbnail: &Thumbnail) -> bool {
    let palette = Palette::current(ui);
    let size = vec2(SIDE, SIDE + 10.0 * tokens::GRID);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Button, true, thumbnail.title.as_str())
    });
    let painter = ui.painter();
    let lit = response.hovered() || response.has_focus();
    let fill = if lit { palette.lit } else { palette.raised };
    painter.rect_filled(rect, tokens::RADIUS, fill);
    let picture = Rect::from_min_size(rect.min, vec2(SIDE, SIDE));
    let whole = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
    painter.image(
        thumbnail.texture.id(),
        picture.shrink(tokens::GRID),
        whole,
        Color32::WHITE,
    );
    let text = picture.left_bottom() + vec2(tokens::GAP, 0.0);
    let clipped = painter.with_clip_rect(rect);
    clipped.text(
        text,
        egui::Align2::LEFT_TOP,
        &thumbnail.title,
        egui::TextStyle::Body.resolve(ui.style()),
        palette.text,
    );
    clipped.text(
        text + vec2(0.0, 4.5 * tokens::GRID),
        egui::Align2::LEFT_TOP,
        &thumbnail.caption,
        egui::TextStyle::Small.resolve(ui.style()),
        palette.quiet,
    );
    if response.has_focus() {
        focus::ring(painter, rect, &palette);
    }
    response
        .on_hover_cursor(egui::CursorIcon::PointingHand)
        .clicked()
}

fn draw_all() -> Drawn {
    let draw = |name: &'static str| {
        let design = presets::design(name)?.ok()?;
        let pixels = draw_one(&design);
        Some((name, Arc::new(design), pixels))
    };
    presets::names().filter_map(draw).collect()
}

/// As much of the drawdown as fits, in cells of whole pixels; large designs from afar.
fn draw_one(design: &Design) -> Vec<[u8; 4]> {
    let drawdown = design.weave();
    let longest = design.ends().max(design.picks()) as usize;
    let cell = (PIXELS / longest.max(1)).clamp(1, LARGEST_CELL);
    let level = (0..16)
        .find(|level| longest >> level <= PIXELS)
        .unwrap_or(16);
    let side = PIXELS.div_ceil(cell);
    let window = SwatchWindow {
        end: 0,
        pick: 0,
        size: [side, side],
        level: level as u32,
    };
    let small = swatch(design, &drawdown, window, Colouring::Yarns);
    (0..PIXELS * PIXELS)
        .map(|at| small[(at / PIXELS / cell) * side + at % PIXELS / cell])
        .collect()
}
