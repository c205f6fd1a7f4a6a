//! Sizes and colours of the window: the one file that names them.
//!
//! Greys are steps of CIE L*, equal channels, so that the interface never tints the
//! eye's judgement of a yarn. One accent; warning and error always come with a word.
#![allow(
    clippy::disallowed_methods,
    reason = "colours are made here so that they are made nowhere else"
)]

use std::collections::BTreeMap;

use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, Theme, vec2};

/// The 4-point grid.
pub const GRID: f32 = 4.0;
/// Space between neighbours.
pub const GAP: f32 = 2.0 * GRID;
/// Space round a group.
pub const PAD: f32 = 3.0 * GRID;
/// Width of the frame of what has the keyboard.
pub const FOCUS: f32 = 2.0;
/// Corner radius of everything that has one.
pub const RADIUS: u8 = 4;

/// Type sizes.
pub const TEXT_SMALL: f32 = 11.0;
pub const TEXT_BODY: f32 = 13.0;
pub const TEXT_HEADING: f32 = 16.0;
pub const TEXT_TITLE: f32 = 20.0;

/// Width of the palette of tools.
pub const TOOLS_WIDTH: f32 = 80.0;
/// Least height of a list that scrolls.
pub const LIST_HEIGHT: f32 = 240.0;
/// Least side of a pane.
pub const SMALLEST_PANE: f32 = 120.0;
/// Longer side of the navigator.
pub const NAVIGATOR: f32 = 128.0;
/// Longest a scale bar may get.
pub const SCALE_BAR: f32 = 160.0;
/// Width of the keys in the sheet of shortcuts.
pub const KEYS_WIDTH: f32 = 57.0 * GRID;
/// Width of a message.
pub const TOAST_WIDTH: f32 = 340.0;

/// Surround of the cloth, L* 50 in both themes.
pub const SURROUND: Color32 = Color32::from_gray(119);
/// The one accent.
pub const ACCENT: Color32 = Color32::from_rgb(53, 117, 206);
/// Grid lines over a drawdown.
pub const GRID_LINE: Color32 = Color32::from_rgba_premultiplied(0, 0, 0, 70);
/// Every fourth grid line.
pub const GRID_LINE_STRONG: Color32 = Color32::from_rgba_premultiplied(0, 0, 0, 130);
/// Every eighth grid line.
pub const GRID_LINE_STRONGEST: Color32 = Color32::from_rgba_premultiplied(0, 0, 0, 200);
/// The edges of a thread that lies on top.
pub const THREAD_EDGE: Color32 = Color32::from_rgba_premultiplied(0, 0, 0, 72);
/// Over all that is not marked.
pub const VEIL: Color32 = Color32::from_rgba_premultiplied(70, 70, 70, 190);
/// Buttons over the cloth while nobody is near: faint, and still to be read on any cloth.
pub const FADED: f32 = 0.8;
/// Row and column of the crossing under the pointer.
pub const CROSSHAIR: Color32 = Color32::from_rgba_premultiplied(16, 34, 58, 70);

/// The title style's name.
pub fn title() -> TextStyle {
    TextStyle::Name("title".into())
}

/// The greys and signals of one theme.
#[derive(Debug, Clone, Copy)]
pub struct Palette {
    /// Deepest plane: fields and tracks.
    pub deep: Color32,
    /// Panels.
    pub panel: Color32,
    /// Raised things: buttons, menus, plates over cloth.
    pub raised: Color32,
    /// Raised things under the pointer or with the keyboard.
    pub lit: Color32,
    /// Hairlines; no text stands on them.
    pub line: Color32,
    /// Ground and text of what is chosen.
    pub chosen: Color32,
    pub on_chosen: Color32,
    /// The frame of what has the keyboard, and the line beside it: one of the two is seen
    /// on any ground, a picture's too.
    pub focus: Color32,
    pub focus_edge: Color32,
    /// Text that may be overlooked.
    pub quiet: Color32,
    /// Text.
    pub text: Color32,
    pub warning: Color32,
    pub error: Color32,
    /// Ground, marks and lines of threading, tie-up and treadling.
    pub paper: Color32,
    pub ink: Color32,
    pub rule: Color32,
}

impl Palette {
    /// The palette of a theme.
    pub const fn of(theme: Theme) -> Self {
        match theme {
            Theme::Dark => Self {
                deep: Color32::from_gray(31),
                panel: Color32::from_gray(44),
                raised: Color32::from_gray(57),
                lit: Color32::from_gray(70),
                line: Color32::from_gray(80),
                chosen: Color32::from_rgb(30, 72, 135),
                on_chosen: Color32::WHITE,
                focus: Color32::from_rgb(130, 180, 248),
                focus_edge: Color32::BLACK,
                quiet: Color32::from_gray(185),
                text: Color32::from_gray(221),
                warning: Color32::from_rgb(232, 176, 74),
                error: Color32::from_rgb(244, 138, 126),
                paper: Color32::from_gray(57),
                ink: Color32::from_gray(221),
                rule: Color32::from_gray(88),
            },
            Theme::Light => Self {
                deep: Color32::from_gray(249),
                panel: Color32::from_gray(238),
                raised: Color32::from_gray(221),
                lit: Color32::from_gray(249),
                line: Color32::from_gray(193),
                chosen: Color32::from_rgb(200, 221, 247),
                on_chosen: Color32::from_rgb(20, 64, 140),
                focus: Color32::from_rgb(20, 64, 140),
                focus_edge: Color32::WHITE,
                quiet: Color32::from_gray(94),
                text: Color32::from_gray(38),
                warning: Color32::from_rgb(138, 84, 0),
                error: Color32::from_rgb(176, 32, 24),
                paper: Color32::from_gray(252),
                ink: Color32::from_gray(38),
                rule: Color32::from_gray(200),
            },
        }
    }

    /// The palette of the theme in use.
    pub fn current(ui: &egui::Ui) -> Self {
        Self::of(ui.theme())
    }
}

/// An opaque colour of a yarn, as sRGB bytes.
pub const fn yarn_colour(red: u8, green: u8, blue: u8) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

/// Sets both themes of a context.
pub fn apply(ctx: &egui::Context) {
    for theme in [Theme::Dark, Theme::Light] {
        let mut style = (*ctx.style_of(theme)).clone();
        style.text_styles = text_styles();
        style.spacing.item_spacing = vec2(GAP, GRID);
        style.spacing.button_padding = vec2(GAP, GRID);
        style.spacing.menu_margin = Margin::same(GRID as i8);
        style.spacing.window_margin = Margin::same(PAD as i8);
        style.spacing.interact_size.y = 6.0 * GRID;
        style.interaction.tooltip_delay = 0.4;
        style.visuals = visuals(theme, Palette::of(theme));
        ctx.set_style_of(theme, style);
    }
}

/// Buttons of menus: no frames, except of the one with the keyboard.
pub fn menu(style: &mut egui::Style) {
    egui::containers::menu::menu_style(style);
    let focus = Palette::of(match style.visuals.dark_mode {
        true => Theme::Dark,
        false => Theme::Light,
    });
    style.visuals.widgets.active.bg_stroke = Stroke::new(FOCUS, focus.focus);
}

fn text_styles() -> BTreeMap<TextStyle, FontId> {
    let face = |size| FontId::new(size, FontFamily::Proportional);
    BTreeMap::from([
        (TextStyle::Small, face(TEXT_SMALL)),
        (TextStyle::Body, face(TEXT_BODY)),
        (TextStyle::Button, face(TEXT_BODY)),
        (TextStyle::Heading, face(TEXT_HEADING)),
        (title(), face(TEXT_TITLE)),
        (
            TextStyle::Monospace,
            FontId::new(TEXT_BODY, FontFamily::Monospace),
        ),
    ])
}

fn visuals(theme: Theme, palette: Palette) -> egui::Visuals {
    let mut visuals = match theme {
        Theme::Dark => egui::Visuals::dark(),
        Theme::Light => egui::Visuals::light(),
    };
    let radius = CornerRadius::same(RADIUS);
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.raised;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.window_corner_radius = radius;
    visuals.menu_corner_radius = radius;
    visuals.extreme_bg_color = palette.deep;
    visuals.faint_bg_color = palette.raised;
    visuals.weak_text_color = Some(palette.quiet);
    visuals.warn_fg_color = palette.warning;
    visuals.error_fg_color = palette.error;
    visuals.hyperlink_color = palette.text;
    visuals.selection.bg_fill = palette.chosen;
    // Also the frame of a text field with the keyboard.
    visuals.selection.stroke = Stroke::new(FOCUS, palette.on_chosen);
    for (widget, fill) in [
        (&mut visuals.widgets.noninteractive, palette.panel),
        (&mut visuals.widgets.inactive, palette.raised),
        (&mut visuals.widgets.hovered, palette.lit),
        (&mut visuals.widgets.active, palette.lit),
        (&mut visuals.widgets.open, palette.lit),
    ] {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::new(1.0, palette.line);
        widget.fg_stroke = Stroke::new(1.0, palette.text);
        widget.corner_radius = radius;
        widget.expansion = 0.0;
    }
    // A widget with the keyboard has these.
    visuals.widgets.active.bg_stroke = Stroke::new(FOCUS, palette.focus);
    visuals.widgets.hovered.bg_stroke = Stroke::new(1.0, palette.quiet);
    visuals
}

#[cfg(test)]
mod tests;
