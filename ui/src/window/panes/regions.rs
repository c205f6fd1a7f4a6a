//! The regions of a jacquard: each colour's weave, area and lock.

use std::sync::Arc;

use egui::RichText;
use pickglass::design::{Region, Regions, Srgb, Structure};
use pickglass::edit::{Document, Edit};

use super::later::Later;
use super::swatches;
use super::weave_picker::{Picked, WeavePicker};
use crate::tokens::Palette;
use crate::window::action::{Action, Button, Mark};

/// The list of regions.
#[derive(Default)]
pub struct RegionList {
    picker: Option<(u16, WeavePicker)>,
    areas: Later<u64, Vec<f64>>,
}

impl RegionList {
    /// Shows the list.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        document: &Document,
        regions: &Regions,
        actions: &mut Vec<Action>,
    ) {
        let design = Arc::clone(document.design());
        self.areas
            .ask(ui.ctx(), &document.revision(), move |_| areas(&design));
        let count = regions.palette().len();
        ui.horizontal_wrapped(|ui| {
            let regions = if count == 1 { "region" } else { "regions" };
            ui.label(RichText::new(format!("{count} {regions}")).strong());
            let sort = ui.button("Sort by area");
            if sort
                .on_hover_text("The largest first; the cloth stays")
                .clicked()
            {
                actions.push(Action::edit(Edit::SortRegions));
            }
            let weavable = document.design().weavable();
            let word = if weavable { "weavable" } else { "preview only" };
            ui.label(RichText::new(word).color(Palette::current(ui).quiet));
        });
        for (number, region) in regions.palette().iter().enumerate() {
            self.region_ui(ui, number as u16, count as u16, region, actions);
        }
        let Some((number, picker)) = &mut self.picker else {
            return;
        };
        let name = regions
            .palette()
            .get(usize::from(*number))
            .map(|region| region.name.clone());
        let region = *number;
        match picker.show(ui.ctx(), &name.unwrap_or_default()) {
            Picked::Nothing => {}
            Picked::Weave(fill) => actions.push(Action::edit(Edit::SetFill {
                region,
                fill: *fill,
            })),
            Picked::Closed => self.picker = None,
        }
    }

    fn region_ui(
        &mut self,
        ui: &mut egui::Ui,
        number: u16,
        count: u16,
        region: &Region,
        actions: &mut Vec<Action>,
    ) {
        let name = region.name.clone();
        let mut focused = false;
        let row = ui.horizontal(|ui| {
            let colour = region.colour.unwrap_or(Srgb(128, 128, 128));
            let paint = swatches::field(ui, colour, &format!("Paint region {name}"));
            focused |= paint.has_focus();
            if paint.clicked() {
                actions.push(Action::PaintRegion(number, Button::First));
            }
            let weave = match region.fill.notation() {
                Some(notation) => notation.to_owned(),
                None => {
                    let pattern = region.fill.pattern();
                    format!("drawn {} × {}", pattern.ends(), pattern.picks())
                }
            };
            let button = ui
                .button(&weave)
                .on_hover_text("Another weave; the outlines stay");
            let spoken = format!("Weave of {name}: {weave}");
            button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &spoken));
            focused |= button.has_focus();
            if button.clicked() {
                self.picker = Some((number, WeavePicker::default()));
            }
            let share = self
                .areas
                .answer()
                .and_then(|areas| areas.get(usize::from(number)));
            if let Some(share) = share {
                ui.label(format!("{:.1} %", share * 100.0));
            }
            let mut locked = region.locked;
            let lock = ui
                .checkbox(&mut locked, "lock")
                .on_hover_text("Proposals leave its weave");
            let spoken = format!("Lock {name}");
            lock.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::CheckBox, true, region.locked, &spoken)
            });
            if locked != region.locked {
                actions.push(Action::edit(Edit::LockRegion {
                    region: number,
                    locked,
                }));
            }
            for (text, to) in [
                ("Up", number.checked_sub(1)),
                ("Down", number.checked_add(1)),
            ] {
                let Some(to) = to.filter(|to| *to < count) else {
                    continue;
                };
                let button = ui.small_button(text);
                let spoken = format!("{text}: {name}");
                button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &spoken));
                if button.clicked() {
                    let mut order: Vec<u16> = (0..count).collect();
                    order.swap(usize::from(number), usize::from(to));
                    actions.push(Action::edit(Edit::OrderRegions(order)));
                }
            }
            ui.label(
                RichText::new(&name)
                    .small()
                    .color(Palette::current(ui).quiet),
            );
        });
        if focused || ui.rect_contains_pointer(row.response.rect) {
            actions.push(Action::Mark(Mark::Region(number)));
        }
    }
}

/// The share of the design's crossings that each region has.
fn areas(design: &pickglass::design::Design) -> Vec<f64> {
    let Structure::Regions(regions) = design.structure() else {
        return Vec::new();
    };
    let mut counts = vec![0u64; regions.palette().len()];
    for region in regions.map().iter() {
        if let Some(count) = counts.get_mut(usize::from(region)) {
            *count += 1;
        }
    }
    let all: u64 = counts.iter().sum();
    let share = |count: u64| count as f64 / all.max(1) as f64;
    counts.into_iter().map(share).collect()
}
