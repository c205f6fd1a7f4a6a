//! The yarns: colour, gloss, count, diameter and family of each, where it lies and how
//! much of it a metre of cloth takes; stripes typed as an order.

use std::sync::Arc;

use egui::{DragValue, RichText, ScrollArea, TextEdit};
use pickglass::design::checks::{Interlacing, YarnNeed, take_up, yarn_needs};
use pickglass::design::{CountUnit, Design, Direction, Family, Yarn, YarnId, stripes};
use pickglass::edit::{Document, Edit};
use pickglass::text::visible;

use super::dragging::Dragging;
use super::later::Later;
use super::{PaneView, Shown};
use super::{columns, swatches};
use crate::tokens::{self, Palette};
use crate::window::action::{Action, Button, Mark};
use crate::window::typing;

/// Threads of an order that is offered as text.
const MOST_WRITTEN: usize = 4096;
/// Yarns beyond these are not listed.
const MOST_LISTED: usize = 512;

/// The list of yarns.
#[derive(Default)]
pub struct Yarns {
    unit: CountUnit,
    plies: u32,
    /// The yarn whose details are open.
    open: Option<u16>,
    /// The yarn that another is to be exchanged or joined with.
    with: u16,
    changing: Dragging,
    stripes: [Stripes; 2],
    needs: Later<u64, Vec<YarnNeed>>,
}

/// An order as text, and the revision it was written for.
#[derive(Default)]
struct Stripes {
    text: String,
    of: Option<u64>,
    problem: Option<String>,
}

impl PaneView for Yarns {
    fn show(&mut self, ui: &mut egui::Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
        let document = shown.document;
        self.plies = self.plies.max(1);
        self.ask_needs(ui.ctx(), document);
        let design = document.design();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            self.head_ui(ui, design, actions);
            let names = design.yarns().iter().take(MOST_LISTED);
            let column = columns::widest(ui, names.map(|yarn| yarn.name.as_str()));
            for index in 0..design.yarns().len().min(MOST_LISTED) {
                self.yarn_ui(ui, document, (index as u16, column), actions);
            }
            ui.separator();
            for (which, direction) in [Direction::Warp, Direction::Weft].into_iter().enumerate() {
                self.stripes_ui(ui, document, which, direction, actions);
            }
        });
    }

    // Forgets all of the design before but the units.
    fn forget(&mut self) {
        *self = Self {
            unit: self.unit,
            plies: self.plies,
            ..Self::default()
        };
    }
}

impl Yarns {
    fn ask_needs(&mut self, ctx: &egui::Context, document: &Document) {
        let (design, drawdown) = (
            Arc::clone(document.design()),
            Arc::clone(document.drawdown()),
        );
        self.needs.ask(ctx, &document.revision(), move |_| {
            let [warp, weft] = [Interlacing::Warp, Interlacing::Weft]
                .map(|whose| take_up(&design, &drawdown, whose));
            yarn_needs(&design, &warp, &weft).yarns
        });
    }

    fn head_ui(&mut self, ui: &mut egui::Ui, design: &Design, actions: &mut Vec<Action>) {
        ui.horizontal_wrapped(|ui| {
            if ui
                .button("Add yarn")
                .on_hover_text("A yarn more, like the last")
                .clicked()
                && let Some(last) = design.yarns().last()
            {
                let name = format!("yarn {}", design.yarns().len() + 1);
                let yarn = Yarn {
                    name,
                    ..last.clone()
                };
                actions.push(Action::edit(Edit::AddYarn(Box::new(yarn))));
            }
            let label = ui.label("Counts in");
            let units = egui::ComboBox::from_id_salt("unit").selected_text(self.unit.name());
            let shown = units.show_ui(ui, |ui| {
                for unit in CountUnit::ALL {
                    ui.selectable_value(&mut self.unit, unit, unit.name());
                }
            });
            shown.response.labelled_by(label.id);
            let label = ui.label("plies");
            typing::number(ui, DragValue::new(&mut self.plies).range(1..=12)).labelled_by(label.id);
        });
    }

    fn yarn_ui(
        &mut self,
        ui: &mut egui::Ui,
        document: &Document,
        (index, column): (u16, f32),
        actions: &mut Vec<Action>,
    ) {
        let id = YarnId(index);
        let design = document.design();
        let Some(yarn) = design.yarns().get(usize::from(index)) else {
            return;
        };
        let quiet = Palette::current(ui).quiet;
        let mut focused = false;
        let row = ui.horizontal(|ui| {
            let mut changed = yarn.clone();
            let colour = swatches::button(ui, &mut changed.colour, &yarn.name);
            self.changing.note(ui, &colour, "yarn colour", actions);
            if changed != *yarn {
                set(id, changed, actions);
            }
            let open = self.open == Some(index);
            let name = columns::cell(ui, column, |ui| {
                ui.selectable_label(open, visible(&yarn.name))
            });
            let name = name.on_hover_text("Where it lies shows in the draft; click for more");
            focused = name.has_focus() || colour.has_focus();
            if name.clicked() {
                self.open = if open { None } else { Some(index) };
            }
            let tex = f64::from(yarn.linear_density());
            let count = self.unit.of_tex(tex, self.plies);
            let plies = if self.plies > 1 {
                format!("/{}", self.plies)
            } else {
                String::new()
            };
            let mut told = format!(
                "{count:.1}{plies} {} · {:.2} mm · {}",
                self.unit.name(),
                yarn.diameter(),
                yarn.family.name()
            );
            if let Some(need) = self.needs.answer().and_then(|n| n.get(usize::from(index))) {
                told += &format!(" · {:.1} m per m", need.metres);
            }
            ui.label(RichText::new(told).color(quiet));
        });
        if focused || ui.rect_contains_pointer(row.response.rect) {
            actions.push(Action::Mark(Mark::Yarn(id)));
        }
        if self.open == Some(index) {
            ui.indent(("yarn", index), |ui| {
                self.details_ui(ui, design, id, yarn, actions);
            });
        }
    }

    fn details_ui(
        &mut self,
        ui: &mut egui::Ui,
        design: &Design,
        id: YarnId,
        yarn: &Yarn,
        actions: &mut Vec<Action>,
    ) {
        let mut changed = yarn.clone();
        egui::Grid::new(("details", id.0))
            .num_columns(2)
            .show(ui, |ui| {
                let label = ui.label("Name");
                let field = ui.add(TextEdit::singleline(&mut changed.name).char_limit(80));
                self.changing
                    .note(ui, &field.labelled_by(label.id), "rename yarn", actions);
                ui.end_row();
                let label = ui.label("Family");
                let families = egui::ComboBox::from_id_salt(("family", id.0));
                let shown = families
                    .selected_text(yarn.family.name())
                    .show_ui(ui, |ui| {
                        for &family in Family::ALL {
                            ui.selectable_value(&mut changed.family, family, family.name());
                        }
                    });
                shown.response.labelled_by(label.id);
                ui.end_row();
                let label = ui.label("Count");
                let tex = f64::from(yarn.linear_density());
                let mut count = self.unit.of_tex(tex, self.plies);
                let speed = 0.01 * count.abs().max(0.1);
                let field = DragValue::new(&mut count)
                    .speed(speed)
                    .suffix(format!(" {}", self.unit.name()));
                let field = typing::number(ui, field).labelled_by(label.id);
                self.changing.note(ui, &field, "yarn count", actions);
                let tex = self.unit.to_tex(count, self.plies);
                if field.changed() && (0.01..=1e6).contains(&tex) {
                    changed.tex = Some(tex as f32);
                    changed.diameter_mm = None;
                }
                ui.end_row();
                let label = ui.label("Diameter");
                let mut diameter = yarn.diameter();
                let field = DragValue::new(&mut diameter)
                    .speed(0.002)
                    .range(0.01..=20.0)
                    .suffix(" mm");
                let field = typing::number(ui, field).labelled_by(label.id);
                self.changing.note(ui, &field, "yarn diameter", actions);
                if field.changed() {
                    changed.diameter_mm = Some(diameter);
                }
                ui.end_row();
                let label = ui.label("Gloss");
                let mut gloss = 1.0 - yarn.alpha();
                let slider = egui::Slider::new(&mut gloss, 0.0..=0.99);
                let field = ui.add(slider).labelled_by(label.id);
                self.changing.note(ui, &field, "yarn gloss", actions);
                if field.changed() {
                    changed.gloss = Some(1.0 - gloss);
                }
                ui.end_row();
            });
        if changed != *yarn {
            set(id, changed, actions);
        }
        if let Some(need) = self
            .needs
            .answer()
            .and_then(|needs| needs.get(usize::from(id.0)))
        {
            ui.label(format!(
                "A metre of cloth takes {:.1} m in the warp and {:.1} m in the weft, {:.1} g",
                need.warp_metres, need.weft_metres, need.grams
            ));
        }
        self.others_ui(ui, design, id, actions);
    }

    /// Painting with a yarn, exchanging, joining and moving it.
    fn others_ui(
        &mut self,
        ui: &mut egui::Ui,
        design: &Design,
        id: YarnId,
        actions: &mut Vec<Action>,
    ) {
        let count = design.yarns().len() as u16;
        ui.horizontal_wrapped(|ui| {
            if ui.button("Paint with it").clicked() {
                actions.push(Action::PaintYarn(id, Button::First));
            }
            for (text, to) in [("Up", id.0.checked_sub(1)), ("Down", id.0.checked_add(1))] {
                let to = to.filter(|to| *to < count);
                let button = ui.add_enabled(to.is_some(), egui::Button::new(text));
                let button = button.on_hover_text("Move it in the list; the cloth stays");
                if button.clicked()
                    && let Some(to) = to
                {
                    let mut order: Vec<u16> = (0..count).collect();
                    order.swap(usize::from(id.0), usize::from(to));
                    actions.push(Action::edit(Edit::OrderYarns(order)));
                    self.open = Some(to);
                }
            }
            if count < 2 {
                return;
            }
            if self.with >= count || self.with == id.0 {
                self.with = if id.0 == 0 { 1 } else { 0 };
            }
            let name = |yarn: u16| visible(&design.yarn(YarnId(yarn)).name);
            let label = ui.label("with");
            let others = egui::ComboBox::from_id_salt(("with", id.0));
            let shown = others.selected_text(name(self.with)).show_ui(ui, |ui| {
                for other in (0..count.min(MOST_LISTED as u16)).filter(|other| *other != id.0) {
                    ui.selectable_value(&mut self.with, other, name(other));
                }
            });
            shown.response.labelled_by(label.id);
            let other = YarnId(self.with);
            if ui
                .button("Exchange")
                .on_hover_text("Their threads change places")
                .clicked()
            {
                actions.push(Action::edit(Edit::SwapYarns(id, other)));
            }
            let join = ui
                .button("Join")
                .on_hover_text("Its threads get the other yarn");
            if join.clicked() {
                let edit = Edit::RemoveYarn {
                    yarn: id,
                    instead: other,
                };
                actions.push(Action::edit(edit));
                self.open = None;
            }
        });
    }

    fn stripes_ui(
        &mut self,
        ui: &mut egui::Ui,
        document: &Document,
        which: usize,
        direction: Direction,
        actions: &mut Vec<Action>,
    ) {
        let design = document.design();
        let (name, map) = match direction {
            Direction::Warp => ("Warp stripes", &design.maps().warp),
            Direction::Weft => ("Weft stripes", &design.maps().weft),
        };
        let palette = Palette::current(ui);
        let Some(order) = map.order() else {
            let text = format!("{name}: this yarn changes along its threads (preview only)");
            ui.label(RichText::new(text).color(palette.quiet));
            return;
        };
        let typed = &mut self.stripes[which];
        let label = ui.label(name);
        let field = TextEdit::singleline(&mut typed.text)
            .desired_width(f32::INFINITY)
            .hint_text("12 navy 4 cream 12 navy");
        let field = ui.add(field).labelled_by(label.id);
        if !field.has_focus() && !field.lost_focus() && typed.of != Some(document.revision()) {
            typed.text = if order.len() <= MOST_WRITTEN {
                stripes::write(order, design.yarns())
            } else {
                String::new()
            };
            typed.of = Some(document.revision());
            typed.problem = None;
        }
        if typing::entered(ui, &field) {
            match stripes::parse(&typed.text, design.yarns()) {
                Ok(order) => {
                    typed.problem = None;
                    actions.push(Action::edit(Edit::SetOrder { direction, order }));
                }
                Err(error) => {
                    typed.problem = Some(error.to_string());
                    field.request_focus();
                }
            }
        } else if typing::given_up(ui, &field) {
            // The stripes are written again as they are.
            typed.of = None;
        }
        if let Some(problem) = &typed.problem {
            ui.horizontal(|ui| {
                crate::window::icons::show(ui, crate::window::toasts::Grade::Error, palette.error);
                ui.label(RichText::new(problem).color(palette.error));
            });
        }
        ui.add_space(tokens::GRID);
    }
}

fn set(id: YarnId, yarn: Yarn, actions: &mut Vec<Action>) {
    actions.push(Action::edit(Edit::SetYarn {
        yarn: id,
        to: Box::new(yarn),
    }));
}
