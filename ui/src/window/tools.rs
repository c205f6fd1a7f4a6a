//! The palette at the left: tools, what painting changes, and with which yarns.

use egui::{Button, Color32, DragValue, Rect, RichText, Sense, Stroke, StrokeKind, vec2};
use pickglass::design::{Srgb, Structure, YarnId, region_colour};
use pickglass::edit::Document;
use pickglass::text::visible;

use super::action::{Action, Button as PaintButton};
use super::draft::{DraftPane, Layer};
use super::focus;
use super::icons;
use super::panes::Pane;
use super::typing;
use crate::command_table::{Command, Switch, Tool, row_of};
use crate::tokens::{self, Palette};

/// Side of a tool's button.
const SIDE: f32 = 28.0;
/// Swatches are shown for so many yarns; the pane of the yarns has them all.
const MOST_SWATCHES: usize = 48;

/// Shows the palette.
pub fn show(
    ui: &mut egui::Ui,
    draft: &mut DraftPane,
    document: &Document,
    actions: &mut Vec<Action>,
) {
    egui::ScrollArea::vertical().show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(tokens::GRID, tokens::GRID);
        ui.add_space(tokens::GRID);
        ui.horizontal_wrapped(|ui| {
            for tool in Tool::ALL {
                if tool_ui(ui, tool, tool == draft.tool()) {
                    actions.push(Action::Command(Command::Use(tool)));
                }
            }
        });
        ui.separator();
        mirror_ui(ui, draft);
        steps_ui(ui, draft, document);
        if let Structure::Regions(_) = document.design().structure() {
            ui.separator();
            layers_ui(ui, draft, document);
        }
        ui.separator();
        if draft.layer(document) == Layer::Regions {
            regions_ui(ui, draft, document, actions);
        } else {
            yarns_ui(ui, draft, document, actions);
        }
    });
}

fn tool_ui(ui: &mut egui::Ui, tool: Tool, on: bool) -> bool {
    let Some(row) = row_of(Command::Use(tool)) else {
        return false;
    };
    let key = (row.shortcuts.first()).map(|key| ui.ctx().format_shortcut(key));
    let tip = format!("{} ({})\n{}", row.label, key.unwrap_or_default(), row.tip);
    let sign = |painter: &egui::Painter, rect, ink| icons::tool(painter, rect, tool, ink);
    sign_button(ui, row.label, &tip, on, sign)
}

/// A button with a drawn sign; true when it was clicked.
fn sign_button(
    ui: &mut egui::Ui,
    name: &str,
    tip: &str,
    on: bool,
    sign: impl FnOnce(&egui::Painter, Rect, Color32),
) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(SIDE, SIDE), Sense::click());
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, on, name));
    let palette = Palette::current(ui);
    let (fill, ink) = if on {
        (tokens::ACCENT, Color32::WHITE)
    } else if response.hovered() {
        (palette.lit, palette.text)
    } else {
        (Color32::TRANSPARENT, palette.text)
    };
    ui.painter().rect_filled(rect, tokens::RADIUS, fill);
    if response.has_focus() {
        focus::ring(ui.painter(), rect, &palette);
    }
    sign(ui.painter(), rect, ink);
    response.on_hover_text(tip).clicked()
}

fn mirror_ui(ui: &mut egui::Ui, draft: &mut DraftPane) {
    ui.label(RichText::new("Mirror").small());
    ui.horizontal(|ui| {
        for (axis, command) in [
            Command::Switch(Switch::SymmetryAcross),
            Command::Switch(Switch::SymmetryAlong),
        ]
        .into_iter()
        .enumerate()
        {
            let Some(row) = row_of(command) else { continue };
            let sign = |painter: &egui::Painter, rect, ink| icons::mirror(painter, rect, axis, ink);
            let label = format!("{}\n{}", row.label, row.tip);
            if sign_button(ui, row.label, &label, draft.symmetry[axis], sign) {
                draft.symmetry[axis] = !draft.symmetry[axis];
            }
        }
    });
}

/// Whether painting goes on in steps, and of how many ends and picks.
fn steps_ui(ui: &mut egui::Ui, draft: &mut DraftPane, document: &Document) {
    let Some(row) = row_of(Command::Switch(Switch::SymmetrySteps)) else {
        return;
    };
    let steps = &mut draft.steps;
    let on = ui.checkbox(&mut steps.on, "steps").on_hover_text(row.tip);
    on.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, steps.on, row.label));
    if !steps.on {
        return;
    }
    let design = document.design();
    let sizes = [design.ends(), design.picks()];
    for (axis, name) in ["ends", "picks"].into_iter().enumerate() {
        let every = &mut steps.every[axis];
        let shown = |value: f64, _: std::ops::RangeInclusive<usize>| match value as u32 {
            0 => format!("no {name}"),
            count => format!("{count} {name}"),
        };
        let field = DragValue::new(every)
            .range(0..=sizes[axis])
            .speed(0.1)
            .custom_formatter(shown);
        let read = |text: &str| match text.trim().trim_end_matches(name).trim() {
            "no" => Some(0.0),
            number => typing::parsed(number),
        };
        let field = typing::number_by(ui, field, read);
        let spoken = format!("Step in {name}");
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, &spoken));
        let tip = format!("Painting is repeated every so many {name}; 0 = not across them");
        field.on_hover_text(tip);
    }
}

fn layers_ui(ui: &mut egui::Ui, draft: &mut DraftPane, document: &Document) {
    ui.label(RichText::new("Paint").small());
    let layer = draft.layer(document);
    for (wanted, label, tip) in [
        (
            Layer::Weave,
            "weave",
            "Corrects crossings by hand, over what the regions weave",
        ),
        (
            Layer::Regions,
            "regions",
            "Gives crossings to a region; its weave fills them",
        ),
    ] {
        let button = Button::selectable(layer == wanted, label);
        if ui.add(button).on_hover_text(tip).clicked() {
            draft.set_layer(wanted);
        }
    }
}

/// Two large swatches, the paint of the two buttons, and all yarns below.
fn yarns_ui(ui: &mut egui::Ui, draft: &DraftPane, document: &Document, actions: &mut Vec<Action>) {
    let design = document.design();
    let colours: Vec<(String, Color32)> = (design.yarns().iter())
        .map(|yarn| (visible(&yarn.name).into_owned(), colour(yarn.colour)))
        .collect();
    let chosen = draft.yarns.map(|yarn| usize::from(yarn.0));
    let heading = "yarns";
    let wish = |index: usize, button| Action::PaintYarn(YarnId(index as u16), button);
    swatches_ui(ui, heading, &colours, chosen, &wish, actions);
    if ui
        .small_button("edit")
        .on_hover_text("Show the pane of the yarns")
        .clicked()
    {
        actions.push(Action::Show(Pane::Yarns));
    }
}

fn regions_ui(
    ui: &mut egui::Ui,
    draft: &DraftPane,
    document: &Document,
    actions: &mut Vec<Action>,
) {
    let Structure::Regions(regions) = document.design().structure() else {
        return;
    };
    let colours: Vec<(String, Color32)> = (regions.palette().iter().enumerate())
        .map(|(index, region)| {
            (
                visible(&region.name).into_owned(),
                colour(region_colour(index, region)),
            )
        })
        .collect();
    let chosen = draft.regions.map(usize::from);
    let wish = |index: usize, button| Action::PaintRegion(index as u16, button);
    swatches_ui(ui, "regions", &colours, chosen, &wish, actions);
}

fn swatches_ui(
    ui: &mut egui::Ui,
    heading: &str,
    colours: &[(String, Color32)],
    chosen: [usize; 2],
    wish: &dyn Fn(usize, PaintButton) -> Action,
    actions: &mut Vec<Action>,
) {
    let palette = Palette::current(ui);
    let border = Stroke::new(1.0, palette.line);
    let both = vec2(1.6 * SIDE, 1.6 * SIDE);
    let (rect, response) = ui.allocate_exact_size(both, Sense::click());
    let label = format!("Exchange the {heading} of the two buttons");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
    let part = both * 0.62;
    let second = Rect::from_min_size(rect.max - part, part);
    let first = Rect::from_min_size(rect.min, part);
    for (place, index) in [(second, chosen[1]), (first, chosen[0])] {
        let fill = colours
            .get(index)
            .map_or(palette.deep, |(_, colour)| *colour);
        ui.painter()
            .rect(place, tokens::RADIUS, fill, border, StrokeKind::Inside);
    }
    if response.has_focus() {
        focus::ring(ui.painter(), rect, &palette);
    }
    let name = |index: usize| colours.get(index).map_or("–", |(name, _)| name.as_str());
    let tip = format!(
        "Left button: {}\nRight button: {}\nClick or X exchanges them",
        name(chosen[0]),
        name(chosen[1])
    );
    if response.on_hover_text(tip).clicked() {
        actions.push(Action::Command(Command::SwapColours));
    }
    ui.horizontal_wrapped(|ui| {
        for (index, (name, colour)) in colours.iter().take(MOST_SWATCHES).enumerate() {
            let side = 20.0;
            let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::click());
            response.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::Button, true, index == chosen[0], name)
            });
            let inside = StrokeKind::Inside;
            ui.painter()
                .rect(rect, tokens::RADIUS, *colour, border, inside);
            if index == chosen[0] {
                let stroke = Stroke::new(2.0, tokens::ACCENT);
                ui.painter()
                    .rect_stroke(rect.expand(1.0), tokens::RADIUS, stroke, inside);
            }
            if response.has_focus() {
                focus::ring(ui.painter(), rect, &palette);
            }
            let second = ui.input(|input| input.modifiers.shift);
            if response.secondary_clicked() || (response.clicked() && second) {
                actions.push(wish(index, PaintButton::Second));
            } else if response.clicked() {
                actions.push(wish(index, PaintButton::First));
            }
            let tip = format!(
                "{name}\nClick: paint of the left button\nRight click, or with Shift: of the right"
            );
            response.on_hover_text(tip);
        }
    });
}

fn colour(Srgb(red, green, blue): Srgb) -> Color32 {
    tokens::yarn_colour(red, green, blue)
}
