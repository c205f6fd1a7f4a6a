//! The start page: what to begin with, unsaved work, recent files and presets as woven
//! thumbnails, and where to drop a file.

use std::path::{Path, PathBuf};

use egui::{Color32, Rect, RichText, Sense, Stroke, vec2};
use pickglass::edit::recovery::Found;
use pickglass::presets;
use pickglass::text::visible;

use super::autosave::ago;
use super::focus;
use super::thumbs::{Source, Thumb, Thumbs};
use crate::command_table::{Command, row_of};
use crate::out::shown;
use crate::tokens::{self, Palette};

/// Thumbnails beside each other in a wide window.
const COLUMNS: f32 = 6.0;
/// Side of a thumbnail, at least and at most, points.
const SIDE: [f32; 2] = [148.0, 224.0];
/// Side of the small picture beside a file, points.
const SMALL: f32 = 10.0 * tokens::GRID;
/// Recent files that are shown.
const MOST_RECENT: usize = 5;

/// What was chosen.
pub enum Choice {
    Command(Command),
    Preset(&'static str),
    Recent(PathBuf),
    Recover(Found),
    Discard(PathBuf),
}

/// The start page's state.
#[derive(Default)]
pub struct StartPage {
    thumbs: Thumbs,
}

impl StartPage {
    /// Shows the page.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        recent: &[PathBuf],
        found: &[Found],
    ) -> Option<Choice> {
        self.draw(ui.ctx(), recent, found);
        let mut choice = None;
        egui::ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                ui.add_space(2.0 * tokens::PAD);
                // In a wide window the page is a column in the middle.
                let widest = COLUMNS * (SIDE[1] + tokens::PAD) - tokens::PAD;
                let beside = (ui.available_width() - widest) / 2.0;
                let beside = beside.floor().max(2.0 * tokens::PAD);
                let column = ui.available_rect_before_wrap().shrink2(vec2(beside, 0.0));
                ui.scope_builder(egui::UiBuilder::new().max_rect(column), |ui| {
                    choice = begin_ui(ui);
                    choice = self.recover_ui(ui, found).or(choice.take());
                    choice = self.recent_ui(ui, recent).or(choice.take());
                    choice = self.presets_ui(ui).or(choice.take());
                });
            });
        choice
    }

    /// Has everything drawn that is on the page, on a thread.
    fn draw(&mut self, ctx: &egui::Context, recent: &[PathBuf], found: &[Found]) {
        for name in presets::names() {
            self.thumbs.ask(ctx, Source::Preset(name));
        }
        for copy in found {
            self.thumbs.ask(ctx, Source::Copy(copy.path.clone()));
        }
        for path in recent.iter().take(MOST_RECENT) {
            self.thumbs.ask(ctx, Source::File(path.clone()));
        }
        self.thumbs.poll(ctx);
    }

    fn presets_ui(&self, ui: &mut egui::Ui) -> Option<Choice> {
        ui.horizontal(|ui| {
            ui.label(RichText::new("Presets").text_style(egui::TextStyle::Heading));
            if self.thumbs.is_working() {
                ui.spinner();
            }
        });
        ui.add_space(tokens::GRID);
        let mut choice = None;
        let fits = (ui.available_width() + tokens::PAD) / COLUMNS - tokens::PAD;
        let side = fits.floor().clamp(SIDE[0], SIDE[1]);
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(tokens::PAD, tokens::PAD);
            for name in presets::names() {
                let thumb = self.thumbs.get(&Source::Preset(name));
                if thumbnail_ui(ui, name, thumb, side) {
                    choice = Some(Choice::Preset(name));
                }
            }
        });
        choice
    }

    /// The small picture beside a file; an empty field until there is one.
    fn small_ui(&self, ui: &mut egui::Ui, source: &Source) {
        let (rect, _) = ui.allocate_exact_size(vec2(SMALL, SMALL), Sense::hover());
        let palette = Palette::current(ui);
        ui.painter().rect_filled(rect, 0.0, palette.deep);
        if let Some(thumb) = self.thumbs.get(source) {
            let whole = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
            (ui.painter()).image(thumb.texture.id(), rect, whole, Color32::WHITE);
        }
    }

    /// Work that an earlier run left unsaved.
    fn recover_ui(&self, ui: &mut egui::Ui, found: &[Found]) -> Option<Choice> {
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
                self.small_ui(ui, &Source::Copy(copy.path.clone()));
                let name = match copy.name.trim() {
                    "" => "untitled".into(),
                    name => visible(name),
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
                    Some(path) => format!("{} · {}", ago(copy.time), shown(path)),
                    None => format!("{} · in no file yet", ago(copy.time)),
                };
                ui.add(egui::Label::new(RichText::new(from).color(palette.quiet)).truncate());
            });
        }
        ui.add_space(2.0 * tokens::PAD);
        choice
    }

    fn recent_ui(&self, ui: &mut egui::Ui, recent: &[PathBuf]) -> Option<Choice> {
        if recent.is_empty() {
            return None;
        }
        let mut choice = None;
        ui.label(RichText::new("Recent files").text_style(egui::TextStyle::Heading));
        ui.add_space(tokens::GRID);
        let quiet = Palette::current(ui).quiet;
        for path in recent.iter().take(MOST_RECENT) {
            ui.horizontal(|ui| {
                self.small_ui(ui, &Source::File(path.clone()));
                let name = shown(Path::new(path.file_name().unwrap_or(path.as_os_str())));
                let there = path.exists();
                if ui.add_enabled(there, egui::Button::new(name)).clicked() {
                    choice = Some(Choice::Recent(path.clone()));
                }
                let folder = shown(path.parent().unwrap_or(Path::new("")));
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
    });
    ui.add_space(tokens::GAP);
    drop_ui(ui);
    ui.add_space(2.0 * tokens::PAD);
    choice
}

/// A preset's picture and what is written below it.
fn thumbnail_ui(ui: &mut egui::Ui, name: &str, thumb: Option<&Thumb>, side: f32) -> bool {
    let palette = Palette::current(ui);
    let size = vec2(side, side + 10.0 * tokens::GRID);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let title = thumb.map_or(name, |thumb| thumb.title.as_str());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, title));
    let painter = ui.painter();
    let lit = response.hovered() || response.has_focus();
    let fill = if lit { palette.lit } else { palette.raised };
    painter.rect_filled(rect, tokens::RADIUS, fill);
    let picture = Rect::from_min_size(rect.min, vec2(side, side));
    if let Some(thumb) = thumb {
        let whole = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
        let place = picture.shrink(tokens::GRID);
        painter.image(thumb.texture.id(), place, whole, Color32::WHITE);
    }
    let text = picture.left_bottom() + vec2(tokens::GAP, 0.0);
    let clipped = painter.with_clip_rect(rect);
    clipped.text(
        text,
        egui::Align2::LEFT_TOP,
        title,
        egui::TextStyle::Body.resolve(ui.style()),
        palette.text,
    );
    clipped.text(
        text + vec2(0.0, 4.5 * tokens::GRID),
        egui::Align2::LEFT_TOP,
        thumb.map_or("", |thumb| thumb.caption.as_str()),
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

/// Where a file may be dropped: anywhere, but a place to aim at is easier to find.
fn drop_ui(ui: &mut egui::Ui) {
    let palette = Palette::current(ui);
    let width = ui.available_width().min(tokens::TOAST_WIDTH);
    let (rect, _) = ui.allocate_exact_size(vec2(width, 14.0 * tokens::GRID), Sense::hover());
    let hovering = ui.input(|input| !input.raw.hovered_files.is_empty());
    let colour = if hovering {
        tokens::ACCENT
    } else {
        palette.quiet
    };
    let corners = [
        rect.left_top(),
        rect.right_top(),
        rect.right_bottom(),
        rect.left_bottom(),
        rect.left_top(),
    ];
    let stroke = Stroke::new(1.0, colour);
    let dashes = egui::Shape::dashed_line(&corners, stroke, 2.0 * tokens::GRID, tokens::GRID);
    ui.painter().extend(dashes);
    let text = egui::Label::new(
        RichText::new("Drop a design, a draft or an image here").color(palette.quiet),
    );
    ui.put(rect, text);
}

#[cfg(test)]
impl StartPage {
    /// Whether every picture is there.
    pub fn is_drawn(&self) -> bool {
        !self.thumbs.is_working()
    }
}
