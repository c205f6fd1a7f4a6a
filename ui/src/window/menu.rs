//! The menu bar and the help sheet, both made from the command table.

use egui::{Button, Grid, Id, MenuBar, Modal, RichText};
use pickglass::formats::presets;
use pickglass::render::{PRESET_NAMES, View};

use crate::command_table::{Command, Menu, TABLE};
use crate::tokens::{self, Palette};
use pickglass::still::LightChoice;

/// What was chosen.
pub enum Choice {
    Command(Command),
    Preset(&'static str),
    Light(&'static str),
}

/// What the menus show as chosen.
pub struct Chosen<'s> {
    pub view: View,
    pub light: &'s LightChoice,
    pub strip: bool,
    pub paused: bool,
    pub has_design: bool,
}

/// Shows the menu bar with the design's name at its end.
pub fn show(ui: &mut egui::Ui, chosen: &Chosen<'_>, title: &str) -> Option<Choice> {
    let mut choice = None;
    MenuBar::new().ui(ui, |ui| {
        for (menu, label) in [
            (Menu::File, "File"),
            (Menu::View, "View"),
            (Menu::Help, "Help"),
        ] {
            ui.menu_button(label, |ui| {
                for row in TABLE.iter().filter(|row| row.menu == menu) {
                    if row.command == Command::Quit || row.command == Command::Fit {
                        ui.separator();
                    }
                    choice = row_ui(ui, row, chosen)
                        .map(Choice::Command)
                        .or(choice.take());
                    if row.command == Command::OpenPath {
                        choice = presets_ui(ui).or(choice.take());
                    }
                }
                if menu == Menu::View {
                    ui.separator();
                    choice = lights_ui(ui, chosen.light).or(choice.take());
                }
            });
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(title).color(Palette::current(ui).quiet));
        });
    });
    choice
}

fn row_ui(
    ui: &mut egui::Ui,
    row: &crate::command_table::Row,
    chosen: &Chosen<'_>,
) -> Option<Command> {
    let on = match row.command {
        Command::Look(view) => view == chosen.view,
        Command::Strip => chosen.strip,
        Command::Pause => chosen.paused,
        _ => false,
    };
    let enabled = chosen.has_design
        || matches!(
            row.command,
            Command::Open | Command::OpenPath | Command::Quit | Command::Theme | Command::Shortcuts
        );
    let mut button = Button::selectable(on, row.label);
    if let Some(shortcut) = &row.shortcut {
        button = button.shortcut_text(ui.ctx().format_shortcut(shortcut));
    }
    let clicked = ui
        .add_enabled(enabled, button)
        .on_hover_text(row.tip)
        .clicked();
    if clicked {
        ui.close();
    }
    clicked.then_some(row.command)
}

fn presets_ui(ui: &mut egui::Ui) -> Option<Choice> {
    let mut choice = None;
    ui.menu_button("Presets", |ui| {
        for preset in presets::names() {
            if ui.button(preset).clicked() {
                choice = Some(Choice::Preset(preset));
                ui.close();
            }
        }
    });
    choice
}

fn lights_ui(ui: &mut egui::Ui, light: &LightChoice) -> Option<Choice> {
    let mut choice = None;
    ui.menu_button("Light", |ui| {
        for preset in PRESET_NAMES {
            let on = matches!(light, LightChoice::Preset(current) if current == preset);
            if ui.add(Button::selectable(on, preset)).clicked() {
                choice = Some(Choice::Light(preset));
                ui.close();
            }
        }
    });
    choice
}

/// The command whose shortcut was pressed. Single keys act only while no text field has
/// the focus.
pub fn pressed(ctx: &egui::Context) -> Option<Command> {
    let typing = ctx.egui_wants_keyboard_input() && ctx.text_edit_focused();
    TABLE.iter().find_map(|row| {
        let shortcut = row.shortcut?;
        if typing && shortcut.modifiers.is_none() {
            return None;
        }
        ctx.input_mut(|input| input.consume_shortcut(&shortcut))
            .then_some(row.command)
    })
}

/// Shows the table of shortcuts; false when it was closed.
pub fn shortcuts_ui(ctx: &egui::Context) -> bool {
    let mut open = true;
    let modal = Modal::new(Id::unique("shortcuts")).show(ctx, |ui| {
        ui.label(RichText::new("Keyboard shortcuts").text_style(tokens::title()));
        ui.add_space(tokens::GAP);
        Grid::new("shortcut table")
            .num_columns(2)
            .spacing([tokens::PAD * 2.0, tokens::GRID])
            .show(ui, |ui| {
                for row in TABLE {
                    let Some(shortcut) = row.shortcut else {
                        continue;
                    };
                    ui.label(RichText::new(ui.ctx().format_shortcut(&shortcut)).monospace());
                    ui.label(row.tip);
                    ui.end_row();
                }
                for (gesture, tip) in [
                    ("Drag", "Move the cloth"),
                    ("Wheel", "Zoom at the pointer"),
                    ("Arrow keys", "Move the cloth, once it was clicked"),
                ] {
                    ui.label(RichText::new(gesture).monospace());
                    ui.label(tip);
                    ui.end_row();
                }
            });
        ui.add_space(tokens::GAP);
        if ui.button("Close").clicked() {
            open = false;
        }
    });
    open && !modal.should_close()
}
