//! The few buttons over the cloth, faint until the pointer comes near.

use std::ops::RangeInclusive;

use egui::{Align, Layout, Rect, UiBuilder, pos2, vec2};

use crate::tokens::{self, Palette};

/// What a button asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wish {
    TurnOver,
    /// Straight on the cloth again.
    Straighten,
    Keep,
    Forget,
    Calibrate,
}

/// What the buttons say.
pub struct Says {
    pub back: bool,
    pub slanting: bool,
    pub kept: bool,
    /// Drawn without fading, for whoever is near.
    pub near: bool,
}

/// Shows the bar at the upper right of a pane.
pub fn show(ui: &mut egui::Ui, pane: Rect, says: &Says) -> Option<Wish> {
    let palette = Palette::current(ui);
    let height = 8.0 * tokens::GRID;
    let area = Rect::from_min_max(
        pos2(pane.left() + tokens::GAP, pane.top() + tokens::GAP),
        pos2(
            pane.right() - tokens::GAP,
            pane.top() + tokens::GAP + height,
        ),
    );
    let mut wish = None;
    let builder = UiBuilder::new()
        .max_rect(area)
        .layout(Layout::right_to_left(Align::Center));
    let mut bar = ui.new_child(builder);
    bar.set_clip_rect(pane.intersect(ui.clip_rect()));
    if !says.near {
        bar.multiply_opacity(tokens::FADED);
    }
    bar.spacing_mut().item_spacing = vec2(tokens::GRID, 0.0);
    bar.visuals_mut().widgets.inactive.weak_bg_fill = palette.raised;
    let mut button = |text: &str, tip: &str, asks: Wish| {
        if bar.button(text).on_hover_text(tip).clicked() {
            wish = Some(asks);
        }
    };
    if says.kept {
        button(
            "Forget kept",
            "Show the present picture alone",
            Wish::Forget,
        );
    } else {
        button(
            "Keep",
            "Keep this picture and compare the next with it",
            Wish::Keep,
        );
    }
    if says.slanting {
        button(
            "Straighten",
            "Look straight on the cloth again",
            Wish::Straighten,
        );
    }
    let side = if says.back { "See face" } else { "See back" };
    button(
        side,
        "Turn the cloth over as one turns a page",
        Wish::TurnOver,
    );
    button(
        "Calibrate",
        "Make actual size true on this screen",
        Wish::Calibrate,
    );
    wish
}

/// A bank card is this wide, mm (ISO/IEC 7810 ID-1).
const CARD_MM: f32 = 85.6;
/// Points that it may be wide on a screen.
const CARD_POINTS: RangeInclusive<f32> = 150.0..=900.0;

/// Whether a screen may have so many millimetres a point.
pub fn is_scale(mm_per_point: f32) -> bool {
    CARD_POINTS.contains(&(CARD_MM / mm_per_point))
}

/// The window in which the screen's scale is set against a bank card. Returns whether it
/// stays open.
pub fn calibrate(ctx: &egui::Context, mm_per_point: &mut f32) -> bool {
    let (mut open, mut done) = (true, false);
    egui::Window::new("Actual size on this screen")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .show(ctx, |ui| {
            ui.label("Hold a bank card against the bar and make the bar as wide.");
            let mut width = CARD_MM / mm_per_point.max(1e-4);
            let (rect, _) =
                ui.allocate_exact_size(vec2(width, 12.0 * tokens::GRID), egui::Sense::hover());
            let palette = Palette::current(ui);
            ui.painter().rect_filled(rect, tokens::RADIUS, palette.text);
            let slider = egui::Slider::new(&mut width, CARD_POINTS)
                .text("width of the bar")
                .suffix(" points");
            if ui.add(slider).changed() {
                *mm_per_point = CARD_MM / width.max(1.0);
            }
            ui.label(format!("{:.1} points a mm", 1.0 / mm_per_point.max(1e-4)));
            done = ui.button("Done").clicked();
        });
    open && !done
}
