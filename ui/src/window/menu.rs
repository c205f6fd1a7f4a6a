//! The menu bar, the keys and the help sheet, all made from the command table.

use std::path::PathBuf;

use egui::containers::menu::MenuConfig;
use egui::{Button, Grid, Key, KeyboardShortcut, MenuBar, Modifiers, RichText};
use pickglass::engine::LightChoice;
use pickglass::presets;
use pickglass::scene::{PRESET_NAMES, View};
use pickglass::text::visible;

use super::cloth::sheet::Kind as SheetKind;
use super::dialog;
use super::worker::{LONGEST, Quality};
use crate::command_table::{
    ClothCommand, Command, DraftLayout, Menu, Row, Switch, TABLE, Tool, WeaveCommand, ZoomCommand,
};
use crate::tokens::{self, Palette};

/// What was chosen.
pub enum Choice {
    Command(Command),
    Preset(&'static str),
    Recent(PathBuf),
    Light(&'static str),
    Quality(Quality),
}

/// What the menus show as chosen, and what can be done now.
pub struct Situation<'s> {
    pub open: bool,
    /// What would be undone and redone.
    pub undo: Option<String>,
    pub redo: Option<String>,
    pub selection: bool,
    pub view: View,
    pub light: &'s LightChoice,
    pub quality: Quality,
    pub paused: bool,
    pub tool: Tool,
    pub arrangement: DraftLayout,
    pub structure_alone: bool,
    pub grid_lines: bool,
    pub long_floats: bool,
    pub ghosts: bool,
    pub navigator: bool,
    pub symmetry: [bool; 2],
    /// Painting goes on in steps.
    pub steps: bool,
    /// The reference is shown; `None` = there is none.
    pub reference: Option<bool>,
    /// Colourways beside the one in use.
    pub colourways: usize,
    pub sheet: Option<SheetKind>,
    pub recent: &'s [PathBuf],
}

impl Situation<'_> {
    /// Whether a command can be done now.
    pub fn allows(&self, command: Command) -> bool {
        match command {
            Command::New
            | Command::Open
            | Command::OpenPath
            | Command::Quit
            | Command::Theme
            | Command::ResetLayout
            | Command::Settings
            | Command::Palette
            | Command::MachineCheck
            | Command::Shortcuts => true,
            Command::Undo => self.undo.is_some(),
            Command::Redo => self.redo.is_some(),
            Command::Weave(WeaveCommand::Cut)
            | Command::Weave(WeaveCommand::Copy)
            | Command::Weave(WeaveCommand::Clear)
            | Command::Weave(WeaveCommand::Deselect)
            | Command::Weave(WeaveCommand::FillSelection)
            | Command::Weave(WeaveCommand::CropToSelection) => self.open && self.selection,
            Command::NextColourway
            | Command::PreviousColourway
            | Command::ContactSheet
            | Command::SideBySide => self.open && self.colourways > 0,
            Command::Colourway(place) => {
                self.open && self.colourways > 0 && usize::from(place) <= self.colourways + 1
            }
            Command::Switch(Switch::ReferenceShown) | Command::Switch(Switch::ReferenceFit) => {
                self.open && self.reference.is_some()
            }
            _ => self.open,
        }
    }

    /// Whether a command stands for something that is on.
    fn on(&self, command: Command) -> bool {
        match command {
            Command::Cloth(ClothCommand::Look(view)) => view == self.view,
            Command::Cloth(ClothCommand::Pause) => self.paused,
            Command::Use(tool) => tool == self.tool,
            Command::Arrange(arrangement) => arrangement == self.arrangement,
            Command::Switch(Switch::Structure) => self.structure_alone,
            Command::Switch(Switch::GridLines) => self.grid_lines,
            Command::Switch(Switch::LongFloats) => self.long_floats,
            Command::Switch(Switch::Ghosts) => self.ghosts,
            Command::Switch(Switch::Navigator) => self.navigator,
            Command::Switch(Switch::SymmetryAcross) => self.symmetry[0],
            Command::Switch(Switch::SymmetryAlong) => self.symmetry[1],
            Command::Switch(Switch::SymmetrySteps) => self.steps,
            Command::Switch(Switch::ReferenceShown) => self.reference == Some(true),
            Command::ContactSheet => self.sheet == Some(SheetKind::All),
            Command::SideBySide => self.sheet == Some(SheetKind::Two),
            _ => false,
        }
    }

    /// What a row says now: undo and redo name what they would do.
    fn label(&self, row: &Row) -> String {
        let named = match row.command {
            Command::Undo => self.undo.as_deref(),
            Command::Redo => self.redo.as_deref(),
            _ => None,
        };
        match named {
            Some(entry) => format!("{}: {entry}", row.label),
            None => row.label.to_owned(),
        }
    }
}

/// Shows the menu bar with the design's name at its end.
pub fn show(ui: &mut egui::Ui, situation: &Situation<'_>, title: &str) -> Option<Choice> {
    let mut choice = None;
    let config = MenuConfig::new().style(tokens::menu);
    let bar = MenuBar::new().style(tokens::menu).config(config);
    bar.ui(ui, |ui| {
        for menu in Menu::ALL {
            ui.menu_button(menu.title(), |ui| {
                choice = menu_ui(ui, menu, situation).or(choice.take());
            });
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let quiet = Palette::current(ui).quiet;
            let find = Button::new(RichText::new("Find a command").color(quiet)).small();
            if ui.add(find).on_hover_text("Ctrl+K").clicked() {
                choice = Some(Choice::Command(Command::Palette));
            }
            ui.add(egui::Label::new(RichText::new(title).strong()).truncate());
        });
    });
    choice
}

fn menu_ui(ui: &mut egui::Ui, menu: Menu, situation: &Situation<'_>) -> Option<Choice> {
    let mut choice = None;
    // The longest menu fits a window of 640 points.
    let spacing = ui.spacing_mut();
    spacing.item_spacing.y = 0.0;
    spacing.interact_size.y = 5.0 * tokens::GRID;
    spacing.button_padding.y = 0.5 * tokens::GRID;
    for row in TABLE.iter().filter(|row| row.menu == menu) {
        if row.apart {
            ui.separator();
        }
        let chosen = row_ui(ui, row, situation).map(Choice::Command);
        choice = chosen.or(choice);
        if row.command == Command::OpenPath {
            choice = recent_ui(ui, situation.recent).or(choice);
            choice = presets_ui(ui).or(choice);
        }
    }
    if menu == Menu::View {
        ui.separator();
        choice = lights_ui(ui, situation.light).or(choice);
        choice = quality_ui(ui, situation.quality).or(choice);
    }
    choice
}

/// One command as a row of a menu.
pub fn row_ui(ui: &mut egui::Ui, row: &Row, situation: &Situation<'_>) -> Option<Command> {
    let mut button = Button::selectable(situation.on(row.command), situation.label(row));
    if let Some(shortcut) = row.shortcuts.first() {
        button = button.shortcut_text(ui.ctx().format_shortcut(shortcut));
    }
    let clicked = ui
        .add_enabled(situation.allows(row.command), button)
        .on_hover_text(row.tip)
        .clicked();
    if clicked {
        ui.close();
    }
    clicked.then_some(row.command)
}

fn recent_ui(ui: &mut egui::Ui, recent: &[PathBuf]) -> Option<Choice> {
    let mut choice = None;
    ui.menu_button("Recent files", |ui| {
        if recent.is_empty() {
            ui.label("None yet: files you open or save are listed here.");
        }
        for path in recent {
            let name = path.file_name().unwrap_or(path.as_os_str());
            let there = path.exists();
            let gone = if there { "" } else { " (not there any more)" };
            let button = Button::new(format!("{}{gone}", visible(&name.to_string_lossy())));
            // A file that is gone stays listed, greyed, until newer ones push it out.
            let shown = ui.add_enabled(there, button);
            if shown
                .on_hover_text(visible(&path.display().to_string()))
                .clicked()
            {
                choice = Some(Choice::Recent(path.clone()));
                ui.close();
            }
        }
    });
    choice
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

fn quality_ui(ui: &mut egui::Ui, current: Quality) -> Option<Choice> {
    let mut choice = None;
    let tip = format!(
        "When the picture has so little noise left, before denoising, it is done; and after {:.0} \
         minutes",
        LONGEST / 60.0
    );
    ui.menu_button("Refine until", |ui| {
        for quality in Quality::ALL {
            let button = Button::selectable(quality == current, quality.says());
            if ui.add(button).on_hover_text(&tip).clicked() {
                choice = Some(Choice::Quality(quality));
                ui.close();
            }
        }
    });
    choice
}

/// The single key of a command.
pub fn key_of(command: Command) -> Option<egui::Key> {
    let row = TABLE.iter().find(|row| row.command == command)?;
    let single = row
        .shortcuts
        .iter()
        .find(|shortcut| shortcut.modifiers.is_none())?;
    Some(single.logical_key)
}

/// The command whose shortcut was pressed first, and the place that its event had, which is
/// then none any more. Keys without Ctrl or Alt act only while no text field has the focus.
pub fn pressed(ctx: &egui::Context) -> Option<(Command, usize)> {
    let typing = ctx.egui_wants_keyboard_input() && ctx.text_edit_focused();
    ctx.input_mut(|input| {
        let found = (input.events.iter().enumerate())
            .find_map(|(place, event)| Some((meant(event, typing)?, place)))?;
        input.events.remove(found.1);
        Some(found)
    })
}

/// The command that an event stands for.
fn meant(event: &egui::Event, typing: bool) -> Option<Command> {
    match event {
        // Systems send cut, copy and paste as events of their own, not as keys.
        egui::Event::Copy if !typing => Some(Command::Weave(WeaveCommand::Copy)),
        egui::Event::Cut if !typing => Some(Command::Weave(WeaveCommand::Cut)),
        egui::Event::Paste(_) if !typing => Some(Command::Weave(WeaveCommand::Paste)),
        egui::Event::Key {
            key,
            pressed: true,
            modifiers,
            ..
        } => command_of(*key, *modifiers, typing)
            // In a text field, select all, undo and the like mean its text.
            .filter(|command| !typing || outside_text(*command))
            // Its key holds the glass as long as it is down, and nothing more.
            .filter(|command| *command != Command::Glass),
        _ => None,
    }
}

/// What a key means with what was held when it went down: by the end of a slow frame, Shift
/// may be up again.
fn command_of(key: Key, held: Modifiers, typing: bool) -> Option<Command> {
    let shortcuts =
        (TABLE.iter()).flat_map(|row| row.shortcuts.iter().map(|shortcut| (shortcut, row.command)));
    let fits = |shortcut: &KeyboardShortcut| {
        let named = shortcut.modifiers;
        if named.command || named.alt {
            held.matches_logically(named)
        } else {
            !typing && plain(held, named)
        }
    };
    // A shortcut also matches with more held than it names: the one that names most is meant.
    shortcuts
        .filter(|(shortcut, _)| shortcut.logical_key == key && fits(shortcut))
        .max_by_key(|(shortcut, _)| count(shortcut.modifiers))
        .map(|(_, command)| command)
}

/// Whether a command can be followed by another in the same frame: it opens nothing that
/// the next key might be meant for.
pub fn goes_on(command: Command) -> bool {
    matches!(
        command,
        Command::Undo
            | Command::Redo
            | Command::Weave(WeaveCommand::Roll(_))
            | Command::Use(_)
            | Command::SwapColours
            | Command::Switch(Switch::SymmetryAcross)
            | Command::Switch(Switch::SymmetryAlong)
            | Command::Switch(Switch::SymmetrySteps)
            | Command::NextColourway
            | Command::PreviousColourway
            | Command::Colourway(_)
            | Command::Cloth(ClothCommand::Look(_))
            | Command::Cloth(ClothCommand::TurnOver)
            | Command::Cloth(ClothCommand::Straighten)
            | Command::Cloth(ClothCommand::Orbit(_))
            | Command::Cloth(ClothCommand::Pan(_))
            | Command::Zoom(ZoomCommand::Fit)
            | Command::Zoom(ZoomCommand::ActualSize)
            | Command::Zoom(ZoomCommand::In)
            | Command::Zoom(ZoomCommand::Out)
            | Command::Switch(Switch::Structure)
            | Command::Switch(Switch::GridLines)
            | Command::Switch(Switch::LongFloats)
            | Command::Switch(Switch::Ghosts)
            | Command::Switch(Switch::Navigator)
            | Command::Cloth(ClothCommand::Pause)
    )
}

/// Whether a command's keys act while a text is typed: those of files and of the palette.
fn outside_text(command: Command) -> bool {
    let menu = TABLE
        .iter()
        .find(|row| row.command == command)
        .map(|row| row.menu);
    matches!(menu, Some(Menu::File | Menu::Help))
}

fn count(modifiers: Modifiers) -> u32 {
    u32::from(modifiers.command) + u32::from(modifiers.shift) + u32::from(modifiers.alt)
}

/// Whether nothing but what a single key names is held; Shift may be part of typing a
/// sign such as `+`.
fn plain(held: Modifiers, named: Modifiers) -> bool {
    !held.command && !held.ctrl && !held.alt && (held.shift || !named.shift)
}

/// Shows the table of shortcuts; false when it was closed.
pub fn shortcuts_ui(ctx: &egui::Context) -> bool {
    let mut open = true;
    let room = (ctx.content_rect().height() - 14.0 * tokens::PAD).max(tokens::LIST_HEIGHT);
    let shown = dialog::show(ctx, "shortcuts", |ui| {
        ui.label(RichText::new("Keyboard shortcuts").text_style(tokens::title()));
        ui.add_space(tokens::GAP);
        egui::ScrollArea::vertical()
            .min_scrolled_height(room)
            .max_height(room)
            .show(ui, |ui| {
                for menu in Menu::ALL {
                    sheet_ui(ui, menu);
                }
                gestures_ui(ui);
            });
        ui.add_space(tokens::GAP);
        if ui.button("Close").clicked() {
            open = false;
        }
    });
    open && !shown.escaped && !shown.beside
}

fn sheet_ui(ui: &mut egui::Ui, menu: Menu) {
    sheet(ui, menu.title(), |ui| {
        let rows = TABLE.iter().filter(|row| row.menu == menu);
        for row in rows.filter(|row| !row.shortcuts.is_empty()) {
            let keys: Vec<_> = (row.shortcuts.iter())
                .map(|shortcut| ui.ctx().format_shortcut(shortcut))
                .collect();
            ui.label(RichText::new(keys.join("  ")).monospace());
            ui.label(format!("{}: {}", row.label.trim_end_matches('…'), row.tip));
            ui.end_row();
        }
    });
}

/// A part of the sheet: all parts have their columns at the same places.
fn sheet(ui: &mut egui::Ui, title: &str, rows: impl FnOnce(&mut egui::Ui)) {
    ui.add_space(tokens::GAP);
    ui.label(RichText::new(title).text_style(egui::TextStyle::Heading));
    Grid::new(("shortcut table", title))
        .num_columns(2)
        .min_col_width(tokens::KEYS_WIDTH)
        .spacing([tokens::PAD * 2.0, tokens::GRID])
        .show(ui, rows);
}

/// What the pointer does, which no table of keys can say.
fn gestures_ui(ui: &mut egui::Ui) {
    sheet(ui, "Pointer", |ui| {
        for (gesture, tip) in [
            (
                "Left button",
                "Draft: warp up, or the first paint. Cloth: move it",
            ),
            ("Right button", "Draft: weft up, or the second paint"),
            ("Space or middle", "Move what is seen"),
            ("Wheel", "Zoom at the pointer"),
            ("Hold a tool's key", "That tool until the key is let go"),
            (
                "Arrow keys",
                "Draft: move the cell cursor, with Ctrl by 8. Cloth: move it",
            ),
            ("Shift+arrows", "Draft: make a range from the cursor on"),
            (
                "Space, Enter",
                "Draft: exchange warp and weft at the cursor, or paint the range; with \
                     Shift the other paint",
            ),
            ("Menu, Shift+F10", "Draft: its menu"),
            ("Tab", "From one field or button to the next"),
            ("Esc", "Give up the gesture, or forget the selection"),
        ] {
            ui.label(RichText::new(gesture).monospace());
            ui.label(tip);
            ui.end_row();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_means_what_was_held_with_it() {
        let shift = Modifiers::SHIFT;
        let of = |key, held| command_of(key, held, false);
        assert_eq!(
            of(Key::P, Modifiers::NONE),
            Some(Command::Use(Tool::Pencil))
        );
        assert_eq!(of(Key::P, shift), Some(Command::Cloth(ClothCommand::Pause)));
        assert_eq!(of(Key::P, Modifiers::COMMAND), Some(Command::Print));
        assert_eq!(of(Key::Z, shift), Some(Command::Redo));
        assert_eq!(
            of(Key::Z, Modifiers::COMMAND.plus(shift)),
            Some(Command::Redo)
        );
        // A sign that is typed with Shift on some keyboards.
        assert_eq!(of(Key::Plus, shift), Some(Command::Zoom(ZoomCommand::In)));
        assert_eq!(of(Key::R, Modifiers::ALT), None);
        assert_eq!(command_of(Key::P, Modifiers::NONE, true), None);
    }
}
