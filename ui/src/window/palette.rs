//! The palette: type a few letters of what you want to do.

use egui::{Key, RichText, ScrollArea};

use super::dialog;
use super::menu::Situation;
use crate::command_table::{Command, Row, TABLE, match_rank};
use crate::tokens::{self, Palette as Colours};

/// The palette while it is open.
#[derive(Default)]
pub struct CommandPalette {
    open: bool,
    typed: String,
    chosen: usize,
    focused: bool,
}

impl CommandPalette {
    /// Opens it with nothing typed.
    pub fn open(&mut self) {
        *self = Self {
            open: true,
            ..Self::default()
        };
    }

    /// Shows it; returns the command that was chosen.
    pub fn show(&mut self, ctx: &egui::Context, situation: &Situation<'_>) -> Option<Command> {
        if !self.open {
            return None;
        }
        let (up, down, enter) = ctx.input_mut(|input| {
            let mut pressed = |key| input.consume_key(egui::Modifiers::NONE, key);
            (
                pressed(Key::ArrowUp),
                pressed(Key::ArrowDown),
                pressed(Key::Enter),
            )
        });
        let mut command = None;
        let shown = dialog::show(ctx, "palette", |ui| {
            ui.set_width(1.5 * tokens::TOAST_WIDTH);
            let field = ui.add(
                egui::TextEdit::singleline(&mut self.typed)
                    .hint_text("What do you want to do?")
                    .desired_width(f32::INFINITY),
            );
            field.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Command to find")
            });
            if !self.focused {
                field.request_focus();
                self.focused = true;
            }
            if field.changed() {
                self.chosen = 0;
            }
            // Enter in the frame in which the letters came means what they found.
            let rows = matching(&self.typed);
            self.chosen = (self.chosen + usize::from(down))
                .saturating_sub(usize::from(up))
                .min(rows.len().saturating_sub(1));
            command = (enter)
                .then(|| rows.get(self.chosen))
                .flatten()
                .filter(|row| situation.allows(row.command))
                .map(|row| row.command);
            ui.add_space(tokens::GRID);
            let quiet = Colours::current(ui).quiet;
            let height = tokens::LIST_HEIGHT * 1.5;
            ScrollArea::vertical()
                .auto_shrink(false)
                .min_scrolled_height(height)
                .max_height(height)
                .show(ui, |ui| {
                    if rows.is_empty() {
                        ui.label(RichText::new("No command is called this.").color(quiet));
                    }
                    for (index, row) in rows.iter().enumerate() {
                        let chosen = index == self.chosen;
                        let clicked = row_ui(ui, row, chosen, up || down, situation);
                        command = clicked.then_some(row.command).or(command);
                    }
                });
        });
        let untyped = shown.beside && self.typed.is_empty();
        if command.is_some() || shown.escaped || untyped {
            self.open = false;
        }
        command
    }
}

fn row_ui(
    ui: &mut egui::Ui,
    row: &Row,
    chosen: bool,
    moved: bool,
    situation: &Situation<'_>,
) -> bool {
    let mut button = egui::Button::selectable(chosen, row.label.trim_end_matches('…'))
        .min_size(egui::vec2(ui.available_width(), 0.0));
    if let Some(shortcut) = row.shortcuts.first() {
        button = button.shortcut_text(ui.ctx().format_shortcut(shortcut));
    }
    let response = ui
        .add_enabled(situation.allows(row.command), button)
        .on_hover_text(row.tip);
    if chosen && moved {
        response.scroll_to_me(None);
    }
    response.clicked()
}

/// The rows that answer what was typed, the best first.
fn matching(typed: &str) -> Vec<&'static Row> {
    let mut rows: Vec<_> = (TABLE.iter())
        .filter(|row| row.command != Command::Palette)
        .filter_map(|row| Some((match_rank(row, typed)?, row)))
        .collect();
    rows.sort_by_key(|&(rank, _)| rank);
    rows.into_iter().map(|(_, row)| row).collect()
}
