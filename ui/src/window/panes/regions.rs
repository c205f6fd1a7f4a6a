//! The regions of a jacquard: each colour's weave, area and lock.

use std::sync::Arc;

use egui::RichText;
use pickglass::design::{
    Design, Fill, Region, RegionYarns, Regions, Structure, YarnId, region_colour,
};
use pickglass::edit::{Document, Edit};
use pickglass::text::visible;

use super::columns;
use super::later::Later;
use super::region_details::RegionDetails;
use super::swatches;
use super::weave_picker::{Picked, WeavePicker};
use crate::tokens::Palette;
use crate::window::action::{Action, Button, Mark};

/// Yarns that are offered for a region.
const MOST_YARNS: usize = 64;

/// Widths of what stands in columns.
#[derive(Clone, Copy)]
struct Columns {
    name: f32,
    weave: f32,
    share: f32,
}

/// The list of regions.
#[derive(Default)]
pub struct RegionList {
    picker: Option<(u16, WeavePicker)>,
    areas: Later<u64, Vec<f64>>,
    /// The region whose details are open.
    open: Option<u16>,
    details: RegionDetails,
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
            let add = ui.button("Add region");
            let tip = "A region more in plain weave; choose it to paint with";
            if add.on_hover_text(tip).clicked()
                && let Ok(fill) = Fill::by_notation("plain")
            {
                let name = format!("region {}", count + 1);
                actions.push(Action::edit(Edit::AddRegion(Box::new(Region::new(
                    name, fill,
                )))));
            }
            let weavable = document.design().weavable();
            let word = if weavable { "weavable" } else { "preview only" };
            ui.label(RichText::new(word).color(Palette::current(ui).quiet));
        });
        let palette = regions.palette();
        let weaves: Vec<String> = palette.iter().map(weave_of).collect();
        let columns = Columns {
            name: columns::widest(ui, palette.iter().map(|region| region.name.as_str())),
            weave: columns::widest(ui, weaves.iter().map(String::as_str)),
            share: columns::widest(ui, ["100.0 %"]),
        };
        for (number, region) in palette.iter().enumerate() {
            let design = document.design();
            let place = (number as u16, count as u16);
            self.region_ui(ui, design, place, columns, region, actions);
            if self.open == Some(number as u16) {
                self.details.show(ui, regions, number as u16, actions);
            }
        }
        let Some((number, picker)) = &mut self.picker else {
            return;
        };
        let name = regions
            .palette()
            .get(usize::from(*number))
            .map(|region| visible(&region.name).into_owned());
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
        design: &Design,
        (number, count): (u16, u16),
        columns: Columns,
        region: &Region,
        actions: &mut Vec<Action>,
    ) {
        let name = visible(&region.name).into_owned();
        let mut focused = false;
        let row = ui.horizontal(|ui| {
            let colour = region_colour(usize::from(number), region);
            let paint = swatches::field(ui, colour, &format!("Paint region {name}"));
            focused |= paint.has_focus();
            if paint.clicked() {
                actions.push(Action::PaintRegion(number, Button::First));
            }
            let open = self.open == Some(number);
            let more = columns::cell(ui, columns.name, |ui| ui.selectable_label(open, &name));
            let tip = "Where it lies shows in the draft; click for more";
            if more.on_hover_text(tip).clicked() {
                self.open = (!open).then_some(number);
            }
            let weave = weave_of(region);
            let button = columns::cell(ui, columns.weave, |ui| ui.button(&weave))
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
            let share = share.map_or_else(String::new, |share| format!("{:.1} %", share * 100.0));
            columns::cell(ui, columns.share, |ui| ui.label(share));
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
                let to = to.filter(|to| *to < count);
                let button = ui.add_enabled(to.is_some(), egui::Button::new(text));
                let button = button.on_hover_text("Move it in the list; the cloth stays");
                let spoken = format!("{text}: {name}");
                button.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, to.is_some(), &spoken)
                });
                if button.clicked()
                    && let Some(to) = to
                {
                    let mut order: Vec<u16> = (0..count).collect();
                    order.swap(usize::from(number), usize::from(to));
                    actions.push(Action::edit(Edit::OrderRegions(order)));
                }
            }
            yarns_ui(ui, design, number, region, actions);
        });
        if focused || ui.rect_contains_pointer(row.response.rect) {
            actions.push(Action::Mark(Mark::Region(number)));
        }
    }
}

/// What a region's weave is called.
fn weave_of(region: &Region) -> String {
    match region.fill.notation() {
        Some(notation) => notation.to_owned(),
        None => {
            let pattern = region.fill.pattern();
            format!("drawn {} × {}", pattern.ends(), pattern.picks())
        }
    }
}

/// Which yarns lie in a region: the design's, or some of its own, which no loom can do.
fn yarns_ui(
    ui: &mut egui::Ui,
    design: &Design,
    number: u16,
    region: &Region,
    actions: &mut Vec<Action>,
) {
    let name_of = |yarn: YarnId| visible(&design.yarn(yarn).name);
    let told = match region.yarns {
        None => "design's yarns".to_owned(),
        Some(own) => format!("{} × {}", name_of(own.warp), name_of(own.weft)),
    };
    let usual = RegionYarns {
        warp: design.warp_yarn(0, 0),
        weft: design.weft_yarn(0, 0),
    };
    let present = region.yarns.unwrap_or(usual);
    let mut chosen: Option<Option<RegionYarns>> = None;
    let menu = ui.menu_button(&told, |ui| {
        if ui
            .add(egui::Button::selectable(
                region.yarns.is_none(),
                "The design's yarns",
            ))
            .on_hover_text("As warped and woven: a loom can do it")
            .clicked()
        {
            chosen = Some(None);
            ui.close();
        }
        for (warp, title) in [(true, "Warp"), (false, "Weft")] {
            ui.menu_button(title, |ui| {
                for index in 0..design.yarns().len().min(MOST_YARNS) as u16 {
                    let yarn = YarnId(index);
                    let here = if warp { present.warp } else { present.weft };
                    let on = region.yarns.is_some() && here == yarn;
                    if ui
                        .add(egui::Button::selectable(on, name_of(yarn)))
                        .clicked()
                    {
                        chosen = Some(Some(match warp {
                            true => RegionYarns {
                                warp: yarn,
                                ..present
                            },
                            false => RegionYarns {
                                weft: yarn,
                                ..present
                            },
                        }));
                        ui.close();
                    }
                }
            });
        }
    });
    let spoken = format!("Yarns of {}: {told}", visible(&region.name));
    (menu.response)
        .on_hover_text("Yarns of its own change along their threads: preview only")
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &spoken));
    if let Some(yarns) = chosen.filter(|chosen| *chosen != region.yarns) {
        let region = number;
        actions.push(Action::edit(Edit::SetRegionYarns { region, yarns }));
    }
}

/// The share of the design's crossings that each region has.
fn areas(design: &Design) -> Vec<f64> {
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
