//! What one region of a jacquard is called, where its weave begins, and into which other
//! it goes.

use std::borrow::Cow;

use egui::{ComboBox, DragValue, RichText, TextEdit};
use pickglass::design::{Region, Regions, Srgb};
use pickglass::edit::Edit;
use pickglass::text::visible;

use super::dragging::Dragging;
use super::swatches;
use crate::tokens::Palette;
use crate::window::action::Action;
use crate::window::typing;

/// Regions that are offered to join.
const MOST_OFFERED: usize = 256;

/// The fields that are being changed.
#[derive(Default)]
pub struct RegionDetails {
    /// Another region, to join this one with.
    into: u16,
    /// The name while it is typed.
    typed: Option<(u16, String)>,
    changing: Dragging,
}

impl RegionDetails {
    /// Shows the fields of a region.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        regions: &Regions,
        number: u16,
        actions: &mut Vec<Action>,
    ) {
        let Some(region) = regions.palette().get(usize::from(number)) else {
            return;
        };
        ui.indent(("region", number), |ui| {
            self.words_ui(ui, number, region, actions);
            self.origin_ui(ui, number, region, actions);
            self.join_ui(ui, regions, number, actions);
        });
    }

    fn words_ui(
        &mut self,
        ui: &mut egui::Ui,
        region: u16,
        known: &Region,
        actions: &mut Vec<Action>,
    ) {
        ui.horizontal(|ui| {
            let label = ui.label("Name");
            let (_, text) = match &mut self.typed {
                Some(typed) if typed.0 == region => typed,
                other => other.insert((region, known.name.clone())),
            };
            let field = TextEdit::singleline(text).char_limit(80);
            let field = ui.add(field).labelled_by(label.id);
            let name = text.trim().to_owned();
            if name.is_empty() && field.has_focus() {
                let text = RichText::new("a region needs a name");
                ui.label(text.color(Palette::current(ui).warning));
            }
            if typing::entered(ui, &field) && name.is_empty() {
                field.request_focus();
            } else if field.lost_focus() {
                if !name.is_empty() && name != known.name && !typing::given_up(ui, &field) {
                    actions.push(Action::edit(Edit::NameRegion {
                        region,
                        name,
                        colour: known.colour,
                    }));
                }
                self.typed = None;
            }
            let mut colour = known.colour.unwrap_or(Srgb(128, 128, 128));
            let before = colour;
            let response = swatches::button(ui, &mut colour, &known.name);
            self.changing
                .note(ui, &response, "colour of a region", actions);
            if colour != before {
                actions.push(Action::edit(Edit::NameRegion {
                    region,
                    name: known.name.clone(),
                    colour: Some(colour),
                }));
            }
        });
    }

    fn origin_ui(
        &mut self,
        ui: &mut egui::Ui,
        region: u16,
        known: &Region,
        actions: &mut Vec<Action>,
    ) {
        ui.horizontal(|ui| {
            ui.label("Its weave begins at");
            let mut origin = known.origin;
            let fields = [(&mut origin.0, "end"), (&mut origin.1, "pick")].map(|(value, name)| {
                // People count from 1.
                let mut shown = value.saturating_add(1);
                let field = DragValue::new(&mut shown)
                    .range(-99_999..=99_999)
                    .clamp_existing_to_range(false)
                    .speed(0.1)
                    .prefix(format!("{name} "));
                let field = typing::number(ui, field);
                *value = shown.saturating_sub(1);
                let spoken = format!("First {name} of the weave of {}", visible(&known.name));
                field.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::SpinButton, true, &spoken)
                });
                field
            });
            for field in &fields {
                self.changing.note(ui, field, "origin of a region", actions);
            }
            if origin != known.origin {
                actions.push(Action::edit(Edit::SetFillOrigin { region, origin }));
            }
        });
    }

    fn join_ui(
        &mut self,
        ui: &mut egui::Ui,
        regions: &Regions,
        region: u16,
        actions: &mut Vec<Action>,
    ) {
        let count = regions.palette().len() as u16;
        if count < 2 {
            return;
        }
        if self.into >= count || self.into == region {
            self.into = u16::from(region == 0);
        }
        let name = |number: u16| {
            let region = regions.palette().get(usize::from(number));
            region.map_or(Cow::Borrowed(""), |region| visible(&region.name))
        };
        ui.horizontal(|ui| {
            let label = ui.label("Join with");
            let shown = ComboBox::from_id_salt(("into", region))
                .selected_text(name(self.into))
                .show_ui(ui, |ui| {
                    for other in (0..count.min(MOST_OFFERED as u16)).filter(|o| *o != region) {
                        ui.selectable_value(&mut self.into, other, name(other));
                    }
                });
            shown.response.labelled_by(label.id);
            let join = ui.button("Join");
            let tip = "Its crossings go to the other region, and it leaves the list";
            if join.on_hover_text(tip).clicked() {
                let into = self.into;
                actions.push(Action::edit(Edit::MergeRegion { region, into }));
            }
        });
    }
}
