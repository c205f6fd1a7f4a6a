//! Everything one can do in the window, once: menus, shortcuts, tooltips, the palette, the
//! help sheet and `ui/docs/keys.md` are made from this list.

use std::sync::LazyLock;

use egui::{Key, KeyboardShortcut, Modifiers};
use pickglass::scene::View;

use crate::window::{Pane, panes};

/// How a loom's parts are laid round the drawdown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum DraftLayout {
    /// Threading above, draft and cloth turned by 180°: end 1 at the right, pick 1 at the top.
    #[default]
    Us,
    /// Threading below, end 1 at the left, pick 1 at the bottom.
    Scandinavian,
    /// The drawdown alone, as that lies.
    Jacquard,
}

impl DraftLayout {
    /// Whether draft and cloth are turned by 180°. No thread gets another number by that.
    pub fn turns(self) -> bool {
        self == Self::Us
    }
}

/// What the pointer does on the draft.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Tool {
    #[default]
    Pencil,
    Line,
    Rectangle,
    Fill,
    Replace,
    Picker,
    Select,
    Move,
    Stamp,
}

impl Tool {
    /// All tools, in the order of the palette.
    pub const ALL: [Self; 9] = [
        Self::Pencil,
        Self::Line,
        Self::Rectangle,
        Self::Fill,
        Self::Replace,
        Self::Picker,
        Self::Select,
        Self::Move,
        Self::Stamp,
    ];
}

/// A direction on the cloth as it is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Toward {
    Left,
    Right,
    Up,
    Down,
}

/// Something one can do. Each group has one handler, whose match leaves none of it out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    New,
    Open,
    OpenPath,
    Start,
    Save,
    SaveAs,
    ExportStill,
    ExportVolume,
    ExportDraft,
    Print,
    Settings,
    Quit,
    Undo,
    Redo,
    Reference,
    NextColourway,
    PreviousColourway,
    /// The colourway of this place by name, from 1.
    Colourway(u8),
    ContactSheet,
    SideBySide,
    Arrange(DraftLayout),
    Use(Tool),
    SwapColours,
    Glass,
    Theme,
    NextPane,
    Show(Pane),
    ResetLayout,
    Palette,
    Shortcuts,
    MachineCheck,
    /// Changes the weave, or what is selected of it.
    Weave(WeaveCommand),
    /// Looks at the cloth.
    Cloth(ClothCommand),
    /// Of the view that is in use.
    Zoom(ZoomCommand),
    /// Turns something on or off.
    Switch(Switch),
}

/// Changes the weave, or what is selected of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WeaveCommand {
    SelectAll,
    Deselect,
    Copy,
    Cut,
    Paste,
    Clear,
    Invert,
    MirrorAcross,
    MirrorAlong,
    TurnHalf,
    TurnQuarter,
    Roll(Toward),
    Resize,
    Repeat,
    StampWeave,
    FillSelection,
    Words,
    Loom,
    CropToSelection,
    Repeat2,
    RepeatMore,
    ClearCorrections,
    DeriveDraft,
    BecomeJacquard,
}

/// Looks at the cloth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClothCommand {
    Look(View),
    TurnOver,
    Straighten,
    /// The eye goes round the cloth.
    Orbit(Toward),
    /// The eye goes along the cloth.
    Pan(Toward),
    Pause,
}

/// How large the view in use shows what it shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ZoomCommand {
    Fit,
    ActualSize,
    In,
    Out,
}

/// What is on or off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Switch {
    Structure,
    GridLines,
    LongFloats,
    Ghosts,
    Navigator,
    SymmetryAcross,
    SymmetryAlong,
    SymmetrySteps,
    ReferenceShown,
    ReferenceFit,
}

/// The menu a command stands in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Menu {
    File,
    Edit,
    Weave,
    Colours,
    Tools,
    Cloth,
    View,
    Panes,
    Help,
}

impl Menu {
    /// All menus, from the left.
    pub const ALL: [Self; 9] = [
        Self::File,
        Self::Edit,
        Self::Weave,
        Self::Colours,
        Self::Tools,
        Self::Cloth,
        Self::View,
        Self::Panes,
        Self::Help,
    ];

    /// What the menu bar says.
    pub fn title(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::Weave => "Weave",
            Self::Colours => "Colours",
            Self::Tools => "Tools",
            Self::Cloth => "Cloth",
            Self::View => "View",
            Self::Panes => "Panes",
            Self::Help => "Help",
        }
    }
}

/// One row of the table.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    pub command: Command,
    pub menu: Menu,
    pub label: &'static str,
    pub tip: &'static str,
    /// Any of these; the first is shown.
    pub shortcuts: &'static [KeyboardShortcut],
    /// A line is drawn above it in its menu.
    pub apart: bool,
}

const fn with(modifiers: Modifiers, key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(modifiers, key)
}

const fn ctrl(key: Key) -> KeyboardShortcut {
    with(Modifiers::COMMAND, key)
}

const fn ctrl_shift(key: Key) -> KeyboardShortcut {
    with(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}

const fn ctrl_alt(key: Key) -> KeyboardShortcut {
    with(Modifiers::COMMAND.plus(Modifiers::ALT), key)
}

/// Alt and a key.
pub const fn alt(key: Key) -> KeyboardShortcut {
    with(Modifiers::ALT, key)
}

const fn shift(key: Key) -> KeyboardShortcut {
    with(Modifiers::SHIFT, key)
}

const fn plain(key: Key) -> KeyboardShortcut {
    with(Modifiers::NONE, key)
}

/// A row of the table.
pub const fn row(
    command: Command,
    menu: Menu,
    label: &'static str,
    tip: &'static str,
    shortcuts: &'static [KeyboardShortcut],
) -> Row {
    Row {
        command,
        menu,
        label,
        tip,
        shortcuts,
        apart: false,
    }
}

const fn apart(mut row: Row) -> Row {
    row.apart = true;
    row
}

/// The table, in the order of the menus.
pub static TABLE: LazyLock<Vec<Row>> = LazyLock::new(|| [ABOVE, panes::COMMANDS, BELOW].concat());

/// What the table says before the panes, whose rows stand in their own.
#[rustfmt::skip]
const ABOVE: &[Row] = &[
    row(Command::New, Menu::File, "New", "A plain weave to start from", &[ctrl(Key::N)]),
    row(Command::Open, Menu::File, "Open…", "Open a design, a draft or an image", &[ctrl(Key::O)]),
    row(Command::OpenPath, Menu::File, "Open by path…", "Type or paste the path of a file", &[ctrl(Key::L)]),
    row(Command::Start, Menu::File, "Start page", "Presets, recent files and what can be recovered", &[]),
    apart(row(Command::Save, Menu::File, "Save", "Write the design to its file", &[ctrl(Key::S)])),
    row(Command::SaveAs, Menu::File, "Save as…", "Write the design to another file", &[ctrl_shift(Key::S)]),
    apart(row(Command::ExportStill, Menu::File, "Export still…", "Render the cloth as shown into a file", &[ctrl(Key::E)])),
    row(Command::ExportVolume, Menu::File, "Export volume…", "The selected crossings as voxels; says the bytes first", &[]),
    row(Command::ExportDraft, Menu::File, "Export draft…", "Write a WIF or a loom image; says what has no place in it", &[ctrl_shift(Key::E)]),
    row(Command::Print, Menu::File, "Print to PDF…", "Draft with its numbers, yarns, heddles, and the cloth at true size", &[ctrl(Key::P)]),
    row(Command::Settings, Menu::File, "Settings…", "How much of the disk built exemplars may take; empty what is kept", &[ctrl(Key::Comma)]),
    apart(row(Command::Quit, Menu::File, "Quit", "Close the window", &[ctrl(Key::Q)])),

    row(Command::Undo, Menu::Edit, "Undo", "Take back the last change", &[ctrl(Key::Z), plain(Key::Z)]),
    row(Command::Redo, Menu::Edit, "Redo", "Make the change again", &[ctrl_shift(Key::Z), ctrl(Key::Y), shift(Key::Z)]),
    apart(row(Command::Weave(WeaveCommand::Cut), Menu::Edit, "Cut", "Copy the selection and leave weft up there", &[ctrl(Key::X)])),
    row(Command::Weave(WeaveCommand::Copy), Menu::Edit, "Copy", "Copy the selected crossings", &[ctrl(Key::C)]),
    row(Command::Weave(WeaveCommand::Paste), Menu::Edit, "Paste", "Stamp what was copied; click to place it", &[ctrl(Key::V)]),
    row(Command::Weave(WeaveCommand::Clear), Menu::Edit, "Clear", "Weft up in the whole selection", &[plain(Key::Delete)]),
    apart(row(Command::Weave(WeaveCommand::StampWeave), Menu::Edit, "Stamp a weave…", "Take a weave by its notation, or from the library, as the stamp", &[ctrl(Key::B)])),
    row(Command::Weave(WeaveCommand::FillSelection), Menu::Edit, "Fill with the stamp", "The selection is filled with what was copied, repeated", &[ctrl(Key::F)]),
    apart(row(Command::Weave(WeaveCommand::SelectAll), Menu::Edit, "Select all", "Select one whole repeat", &[ctrl(Key::A)])),
    row(Command::Weave(WeaveCommand::Deselect), Menu::Edit, "Select nothing", "Forget the selection", &[ctrl_shift(Key::A)]),

    row(Command::Weave(WeaveCommand::Invert), Menu::Weave, "Invert", "Exchange warp up and weft up", &[ctrl(Key::I)]),
    row(Command::Weave(WeaveCommand::MirrorAcross), Menu::Weave, "Mirror left and right", "Z twill becomes S", &[ctrl(Key::H)]),
    row(Command::Weave(WeaveCommand::MirrorAlong), Menu::Weave, "Mirror top and bottom", "Z twill becomes S", &[ctrl_shift(Key::H)]),
    row(Command::Weave(WeaveCommand::TurnHalf), Menu::Weave, "Turn by half", "Turn by 180°; twills keep their hand", &[]),
    row(Command::Weave(WeaveCommand::TurnQuarter), Menu::Weave, "Turn by a quarter", "Turn by 90°; ends become picks", &[]),
    apart(row(Command::Weave(WeaveCommand::Roll(Toward::Left)), Menu::Weave, "Roll left", "Move the repeat by one end, round the edge", &[alt(Key::ArrowLeft)])),
    row(Command::Weave(WeaveCommand::Roll(Toward::Right)), Menu::Weave, "Roll right", "Move the repeat by one end, round the edge", &[alt(Key::ArrowRight)]),
    row(Command::Weave(WeaveCommand::Roll(Toward::Up)), Menu::Weave, "Roll up", "Move the repeat by one pick, round the edge", &[alt(Key::ArrowUp)]),
    row(Command::Weave(WeaveCommand::Roll(Toward::Down)), Menu::Weave, "Roll down", "Move the repeat by one pick, round the edge", &[alt(Key::ArrowDown)]),
    apart(row(Command::Weave(WeaveCommand::Resize), Menu::Weave, "Resize…", "Another number of ends and picks: cut off, or repeated to fill", &[])),
    row(Command::Weave(WeaveCommand::Repeat), Menu::Weave, "Repeat…", "Straight, shifted like bricks, or not at all", &[]),
    row(Command::Weave(WeaveCommand::CropToSelection), Menu::Weave, "Crop to the selection", "Keep the selected crossings alone", &[]),
    row(Command::Weave(WeaveCommand::Repeat2), Menu::Weave, "Repeat 2 × 2", "Four repeats become one, so that they can differ", &[]),
    row(Command::Weave(WeaveCommand::RepeatMore), Menu::Weave, "Repeat more often…", "As many repeats as you like become one", &[]),
    row(Command::Weave(WeaveCommand::ClearCorrections), Menu::Weave, "Clear hand corrections", "The weaves of the regions again, where selected or everywhere", &[]),
    apart(row(Command::Weave(WeaveCommand::DeriveDraft), Menu::Weave, "Derive the draft", "Threading, tie-up and treadling on the fewest shafts", &[])),
    row(Command::Weave(WeaveCommand::Loom), Menu::Weave, "Loom…", "Shafts and treadles, lift plan, rising or sinking shed", &[]),
    row(Command::Weave(WeaveCommand::BecomeJacquard), Menu::Weave, "Become a jacquard", "Every crossing free; the draft is let go", &[])
    ,
    apart(row(Command::Weave(WeaveCommand::Words), Menu::Weave, "Name and notes…", "What the design is called, and what to remember", &[])),
    apart(row(Command::Arrange(DraftLayout::Us), Menu::Weave, "US layout", "Threading above; end 1 at the right, pick 1 at the top. The cloth is turned under the same light: satin areas swap between light and dark", &[])),
    row(Command::Arrange(DraftLayout::Scandinavian), Menu::Weave, "Scandinavian layout", "Threading below; end 1 at the left, pick 1 at the bottom", &[]),
    row(Command::Arrange(DraftLayout::Jacquard), Menu::Weave, "Drawdown alone", "Neither threading nor treadling; end 1 at the left, pick 1 at the bottom", &[]),

    row(Command::NextColourway, Menu::Colours, "Next colourway", "Weave in the next set of yarns, by name", &[plain(Key::Period)]),
    row(Command::PreviousColourway, Menu::Colours, "Previous colourway", "Weave in the set of yarns before, by name", &[plain(Key::Comma)]),
    apart(row(Command::Colourway(1), Menu::Colours, "Colourway 1", "The first by name", &[ctrl_alt(Key::Num1)])),
    row(Command::Colourway(2), Menu::Colours, "Colourway 2", "The second by name", &[ctrl_alt(Key::Num2)]),
    row(Command::Colourway(3), Menu::Colours, "Colourway 3", "The third by name", &[ctrl_alt(Key::Num3)]),
    row(Command::Colourway(4), Menu::Colours, "Colourway 4", "The fourth by name", &[ctrl_alt(Key::Num4)]),
    row(Command::Colourway(5), Menu::Colours, "Colourway 5", "The fifth by name", &[ctrl_alt(Key::Num5)]),
    row(Command::Colourway(6), Menu::Colours, "Colourway 6", "The sixth by name", &[ctrl_alt(Key::Num6)]),
    row(Command::Colourway(7), Menu::Colours, "Colourway 7", "The seventh by name", &[ctrl_alt(Key::Num7)]),
    row(Command::Colourway(8), Menu::Colours, "Colourway 8", "The eighth by name", &[ctrl_alt(Key::Num8)]),
    row(Command::Colourway(9), Menu::Colours, "Colourway 9", "The ninth by name", &[ctrl_alt(Key::Num9)]),
    apart(row(Command::ContactSheet, Menu::Colours, "Contact sheet", "All colourways of the cloth at once", &[plain(Key::K)])),
    row(Command::SideBySide, Menu::Colours, "Two side by side", "The colourway in use beside another", &[shift(Key::K)]),

    row(Command::Use(Tool::Pencil), Menu::Tools, "Pencil", "Paint crossings; the right button paints the other value", &[plain(Key::P)]),
    row(Command::Use(Tool::Line), Menu::Tools, "Line", "A straight line of crossings", &[plain(Key::L)]),
    row(Command::Use(Tool::Rectangle), Menu::Tools, "Rectangle", "A filled rectangle; Shift draws the outline", &[plain(Key::R)]),
    row(Command::Use(Tool::Fill), Menu::Tools, "Fill", "Fill an area of equal crossings, round the repeat", &[plain(Key::G)]),
    row(Command::Use(Tool::Replace), Menu::Tools, "Replace", "Every equal crossing or yarn, wherever it is", &[plain(Key::E)]),
    row(Command::Use(Tool::Picker), Menu::Tools, "Picker", "Take the yarn or region under the pointer", &[plain(Key::I)]),
    row(Command::Use(Tool::Select), Menu::Tools, "Select", "Select a rectangle of crossings", &[plain(Key::S)]),
    row(Command::Use(Tool::Move), Menu::Tools, "Move", "Move the selected crossings", &[plain(Key::M)]),
    row(Command::Use(Tool::Stamp), Menu::Tools, "Stamp", "Stamp what was copied", &[plain(Key::B)]),
    apart(row(Command::SwapColours, Menu::Tools, "Exchange the paint", "Exchange what the first and the second button paint", &[plain(Key::X)])),
    row(Command::Switch(Switch::SymmetryAcross), Menu::Tools, "Paint mirrored left and right", "What is painted left is painted right as well", &[]),
    row(Command::Switch(Switch::SymmetryAlong), Menu::Tools, "Paint mirrored top and bottom", "What is painted above is painted below as well", &[]),
    row(Command::Switch(Switch::SymmetrySteps), Menu::Tools, "Paint in steps", "What is painted is painted again every so many ends and picks", &[]),
    apart(row(Command::Reference, Menu::Tools, "Reference image…", "A picture over the draft to draw by; it is no part of the weave", &[])),
    row(Command::Switch(Switch::ReferenceShown), Menu::Tools, "Show the reference", "Show or hide the picture that is drawn by", &[plain(Key::V)]),
    row(Command::Switch(Switch::ReferenceFit), Menu::Tools, "How the reference lies…", "How strongly it shows, and whether it is stretched", &[]),

    row(Command::Cloth(ClothCommand::TurnOver), Menu::Cloth, "Turn the cloth over", "From the face to the back and again, as one turns a page", &[plain(Key::T)]),
    row(Command::Cloth(ClothCommand::Straighten), Menu::Cloth, "Look straight on", "The eye above the cloth again", &[plain(Key::Num0)]),
    apart(row(Command::Cloth(ClothCommand::Orbit(Toward::Left)), Menu::Cloth, "Turn the eye left", "Round the cloth; lower the eye first", &[plain(Key::OpenBracket)])),
    row(Command::Cloth(ClothCommand::Orbit(Toward::Right)), Menu::Cloth, "Turn the eye right", "Round the cloth; lower the eye first", &[plain(Key::CloseBracket)]),
    row(Command::Cloth(ClothCommand::Orbit(Toward::Up)), Menu::Cloth, "Raise the eye", "Towards straight above the cloth", &[plain(Key::PageUp)]),
    row(Command::Cloth(ClothCommand::Orbit(Toward::Down)), Menu::Cloth, "Lower the eye", "Towards the edge of the cloth", &[plain(Key::PageDown)]),
    apart(row(Command::Cloth(ClothCommand::Pan(Toward::Left)), Menu::Cloth, "Look further left", "Along the cloth; the arrow keys do it too while the cloth has the keyboard", &[ctrl_shift(Key::ArrowLeft)])),
    row(Command::Cloth(ClothCommand::Pan(Toward::Right)), Menu::Cloth, "Look further right", "Along the cloth", &[ctrl_shift(Key::ArrowRight)]),
    row(Command::Cloth(ClothCommand::Pan(Toward::Up)), Menu::Cloth, "Look further up", "Along the cloth", &[ctrl_shift(Key::ArrowUp)]),
    row(Command::Cloth(ClothCommand::Pan(Toward::Down)), Menu::Cloth, "Look further down", "Along the cloth", &[ctrl_shift(Key::ArrowDown)]),
    apart(row(Command::Glass, Menu::Cloth, "Pick glass", "Ten times closer at the pointer, or in the middle, while the key is held over the cloth", &[plain(Key::Q)])),

    row(Command::Cloth(ClothCommand::Look(View::Face)), Menu::View, "Face", "Straight on the face: one repeat, or 20 cm where it is wider", &[ctrl(Key::Num1)]),
    row(Command::Cloth(ClothCommand::Look(View::Back)), Menu::View, "Back", "The other side, turned over as one turns a page", &[ctrl(Key::Num2)]),
    row(Command::Cloth(ClothCommand::Look(View::Close)), Menu::View, "Close", "A few threads, as under a hand lens", &[ctrl(Key::Num3)]),
    row(Command::Cloth(ClothCommand::Look(View::Oblique)), Menu::View, "Oblique", "From the lower edge, 45° above the cloth", &[ctrl(Key::Num4)]),
    row(Command::Cloth(ClothCommand::Look(View::Grazing)), Menu::View, "Grazing", "From the lower edge, 18° above the cloth", &[ctrl(Key::Num5)]),
    apart(row(Command::Zoom(ZoomCommand::Fit), Menu::View, "Fit the design", "Show one repeat of the whole design", &[plain(Key::F)])),
    row(Command::Zoom(ZoomCommand::ActualSize), Menu::View, "Actual size", "Cloth at its true size; in the draft a point a crossing", &[plain(Key::Num1)]),
    row(Command::Zoom(ZoomCommand::In), Menu::View, "Zoom in", "Look closer", &[plain(Key::Plus), plain(Key::Equals)]),
    row(Command::Zoom(ZoomCommand::Out), Menu::View, "Zoom out", "Look from further away", &[plain(Key::Minus)]),
    apart(row(Command::Switch(Switch::Structure), Menu::View, "Structure alone", "Warp up black and weft up white, or the colours of the yarns", &[plain(Key::C)])),
    row(Command::Switch(Switch::GridLines), Menu::View, "Grid lines", "Lines between the crossings", &[plain(Key::H)]),
    row(Command::Switch(Switch::LongFloats), Menu::View, "Long floats", "Mark floats longer than the limit", &[plain(Key::O)]),
    row(Command::Switch(Switch::Ghosts), Menu::View, "Ghost repeats", "Show faded how the design goes on", &[]),
    row(Command::Switch(Switch::Navigator), Menu::View, "Navigator", "Three by three repeats, small", &[plain(Key::N)]),
    apart(row(Command::Cloth(ClothCommand::Pause), Menu::View, "Pause refining", "Stop and resume the refining of the picture", &[shift(Key::P)])),
    row(Command::NextPane, Menu::View, "Draft or cloth", "Exchange the keyboard between draft and cloth", &[plain(Key::F6)]),
    row(Command::Theme, Menu::View, "Light or dark", "Change between the light and the dark theme", &[ctrl(Key::T)]),
];

/// What the table says after the panes.
#[rustfmt::skip]
const BELOW: &[Row] = &[
    apart(row(Command::Show(Pane::Draft), Menu::Panes, "Show draft", "Bring the draft to the front", &[])),
    row(Command::Show(Pane::Cloth), Menu::Panes, "Show cloth", "Bring the cloth to the front", &[]),
    apart(row(Command::ResetLayout, Menu::Panes, "Reset layout", "Put all panes back to their usual places", &[])),

    row(Command::Palette, Menu::Help, "Find a command…", "Type a few letters of what you want to do", &[ctrl(Key::K)]),
    row(Command::Shortcuts, Menu::Help, "Keyboard shortcuts", "Show this table", &[plain(Key::F1)]),
    apart(row(Command::MachineCheck, Menu::Help, "Check this machine…", "Try hard cases: whether everything comes out here as it should", &[])),
];

/// The row of a command.
pub fn row_of(command: Command) -> Option<&'static Row> {
    TABLE.iter().find(|row| row.command == command)
}

/// How well a row answers what was typed: `None` = not at all, smaller = better.
///
/// The letters must occur in this order in label or tip; a label that holds the words as
/// they stand comes first.
pub fn match_rank(row: &Row, typed: &str) -> Option<usize> {
    let typed = typed.trim().to_lowercase();
    let (label, tip) = (row.label.to_lowercase(), row.tip.to_lowercase());
    if let Some(place) = label.find(&typed) {
        return Some(place);
    }
    if let Some(spread) = spread(&label, &typed) {
        return Some(100 + spread);
    }
    tip.find(&typed).map(|place| 1000 + place)
}

/// How many letters lie between the typed ones, if they all occur in order.
fn spread(text: &str, typed: &str) -> Option<usize> {
    let mut letters = text.chars();
    let mut skipped = 0;
    for wanted in typed.chars().filter(|letter| !letter.is_whitespace()) {
        skipped += letters.by_ref().position(|letter| letter == wanted)?;
    }
    Some(skipped)
}

/// The table as Markdown.
#[cfg(test)]
pub fn markdown() -> String {
    let names = egui::ModifierNames::NAMES;
    let mut text = String::from("| key | does |\n|---|---|\n");
    for row in TABLE.iter() {
        let keys: Vec<_> = (row.shortcuts.iter())
            .map(|shortcut| format!("`{}`", shortcut.format(&names, false)))
            .collect();
        if !keys.is_empty() {
            let label = row.label.trim_end_matches('…');
            text += &format!("| {} | {label}: {} |\n", keys.join(" "), row.tip);
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
                for shortcut in a.shortcuts {
                    assert!(!b.shortcuts.contains(shortcut), "{} {}", a.label, b.label);
                }
            }
        }
    }

    #[test]
    fn every_view_tool_and_pane_has_a_command() {
        for &view in View::ALL {
            assert!(row_of(Command::Cloth(ClothCommand::Look(view))).is_some());
        }
        for tool in Tool::ALL {
            assert!(row_of(Command::Use(tool)).is_some());
        }
        for pane in Pane::ALL {
            assert!(row_of(Command::Show(pane)).is_some());
        }
    }

    #[test]
    fn typed_letters_find_the_command_that_is_meant() {
        let best = |typed: &str| {
            (TABLE.iter())
                .filter_map(|row| Some((match_rank(row, typed)?, row.label)))
                .min()
                .map(|(_, label)| label)
        };
        assert_eq!(best("undo"), Some("Undo"));
        assert_eq!(best("deriv"), Some("Derive the draft"));
        assert_eq!(best("rsl"), Some("Reset layout"));
        assert_eq!(best("180°"), Some("Turn by half"));
        assert_eq!(best("qqq"), None);
    }
}
