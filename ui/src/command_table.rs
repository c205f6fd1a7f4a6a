//! Everything one can do in the window, once: menus, shortcuts, the help sheet and the
//! README's table are made from this list.

use egui::{Key, KeyboardShortcut, Modifiers};
use pickglass::render::View;

/// Something one can do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    Open,
    OpenPath,
    Export,
    Quit,
    Look(View),
    Fit,
    ActualSize,
    ZoomIn,
    ZoomOut,
    Strip,
    Pause,
    Theme,
    Shortcuts,
}

/// The menu a command stands in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Menu {
    File,
    View,
    Help,
}

/// One row of the table.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    pub command: Command,
    pub menu: Menu,
    pub label: &'static str,
    pub tip: &'static str,
    pub shortcut: Option<KeyboardShortcut>,
}

const fn ctrl(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::COMMAND, key))
}

const fn plain(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::NONE, key))
}

const fn row(
    command: Command,
    menu: Menu,
    label: &'static str,
    tip: &'static str,
    shortcut: Option<KeyboardShortcut>,
) -> Row {
    Row {
        command,
        menu,
        label,
        tip,
        shortcut,
    }
}

/// The table, in the order of the menus.
#[rustfmt::skip]
pub const TABLE: &[Row] = &[
    row(Command::Open, Menu::File, "Open…", "Open a design or a draft", ctrl(Key::O)),
    row(Command::OpenPath, Menu::File, "Open by path…", "Type or paste the path of a file", ctrl(Key::L)),
    row(Command::Export, Menu::File, "Export still…", "Render the cloth as shown into a file", ctrl(Key::E)),
    row(Command::Quit, Menu::File, "Quit", "Close the window", ctrl(Key::Q)),
    row(Command::Look(View::Face), Menu::View, "Face", "Straight on the face, to true scale", ctrl(Key::Num1)),
    row(Command::Look(View::Back), Menu::View, "Back", "The other side, turned over as one turns a page", ctrl(Key::Num2)),
    row(Command::Look(View::Close), Menu::View, "Close", "A few threads, as under a hand lens", ctrl(Key::Num3)),
    row(Command::Look(View::Oblique), Menu::View, "Oblique", "From the lower edge, 45° above the cloth", ctrl(Key::Num4)),
    row(Command::Look(View::Grazing), Menu::View, "Grazing", "From the lower edge, 18° above the cloth", ctrl(Key::Num5)),
    row(Command::Fit, Menu::View, "Fit the design", "Show one repeat of the whole design", plain(Key::F)),
    row(Command::ActualSize, Menu::View, "Actual size", "1 cm of cloth is about 1 cm of screen", plain(Key::Num1)),
    row(Command::ZoomIn, Menu::View, "Zoom in", "Look closer", plain(Key::Plus)),
    row(Command::ZoomOut, Menu::View, "Zoom out", "Look from further away", plain(Key::Minus)),
    row(Command::Strip, Menu::View, "Drawdown and yarns", "Show or hide the strip beside the cloth", plain(Key::D)),
    row(Command::Pause, Menu::View, "Pause refining", "Stop and resume the refining of the picture", plain(Key::P)),
    row(Command::Theme, Menu::View, "Light or dark", "Change between the light and the dark theme", plain(Key::T)),
    row(Command::Shortcuts, Menu::Help, "Keyboard shortcuts", "Show this table", plain(Key::F1)),
];

/// The table as Markdown, for the README.
#[cfg(test)]
pub fn markdown() -> String {
    let names = egui::ModifierNames::NAMES;
    let mut text = String::from("| key | does |\n|---|---|\n");
    for row in TABLE {
        if let Some(shortcut) = row.shortcut {
            let key = shortcut.format(&names, false);
            text += &format!(
                "| `{key}` | {}: {} |\n",
                row.label.trim_end_matches('…'),
                row.tip
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_commands_share_a_shortcut_or_a_label() {
        for (index, a) in TABLE.iter().enumerate() {
            for b in &TABLE[index + 1..] {
                assert_ne!(a.label, b.label);
                assert_ne!(a.command, b.command);
                assert!(
                    a.shortcut.is_none() || a.shortcut != b.shortcut,
                    "{}",
                    a.label
                );
            }
        }
    }

    #[test]
    fn the_readme_has_this_table() {
        let readme = include_str!("../../README.md");
        assert!(
            readme.contains(&markdown()),
            "put into README.md:\n{}",
            markdown()
        );
    }

    #[test]
    fn every_view_has_a_command() {
        for view in View::ALL {
            assert!(TABLE.iter().any(|row| row.command == Command::Look(view)));
        }
    }
}
