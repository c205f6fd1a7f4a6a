//! The sett: ends and picks per length, the reed, the cloth's size, take-up and shrinkage.

use std::sync::Arc;

use egui::{DragValue, RichText};
use pickglass::design::checks::{Interlacing, reed, take_up};
use pickglass::design::{Density, Sett};
use pickglass::edit::{Document, Edit};
use pickglass::limits::SETT_PER_CM;

use super::later::Later;
use super::{PaneView, Shown};
use crate::tokens::{self, Palette};
use crate::window::action::Action;

use crate::window::typing;

/// Centimetres in an inch.
const INCH: f32 = 2.54;

/// The fields.
pub struct SettPane {
    inches: bool,
    /// What was typed and not yet applied, threads a cm.
    typed: Option<[f32; 2]>,
    ends_a_dent: u32,
    /// Shrinkage of the finished cloth, % across and along.
    shrinkage: [f32; 2],
    take_up: Later<u64, [f64; 2]>,
}

impl Default for SettPane {
    fn default() -> Self {
        Self {
            inches: false,
            typed: None,
            ends_a_dent: 2,
            shrinkage: [0.0; 2],
            take_up: Later::default(),
        }
    }
}

impl PaneView for SettPane {
    fn show(&mut self, ui: &mut egui::Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
        let document = shown.document;
        let (design, drawdown) = (
            Arc::clone(document.design()),
            Arc::clone(document.drawdown()),
        );
        let (of, on) = (Arc::clone(&design), drawdown);
        self.take_up.ask(ui.ctx(), &document.revision(), move |_| {
            [Interlacing::Warp, Interlacing::Weft].map(|whose| take_up(&of, &on, whose).mean)
        });
        egui::ScrollArea::vertical()
            .auto_shrink(false)
            .show(ui, |ui| {
                self.sett_ui(ui, document, actions);
                ui.separator();
                self.reed_ui(ui, document);
            });
    }

    // Forgets what was typed for the design before and what was worked out of it.
    fn forget(&mut self) {
        self.typed = None;
        self.take_up = Later::default();
    }
}

#[cfg(test)]
impl SettPane {
    /// As if ends and picks per cm had been typed.
    pub fn type_in(&mut self, per_cm: [f32; 2]) {
        self.typed = Some(per_cm);
    }
}

impl SettPane {
    fn unit(&self) -> (f32, &'static str, &'static str) {
        if self.inches {
            (INCH, "ends/in", "picks/in")
        } else {
            (1.0, "ends/cm", "picks/cm")
        }
    }

    fn sett_ui(&mut self, ui: &mut egui::Ui, document: &Document, actions: &mut Vec<Action>) {
        let sett = document.design().sett();
        ui.horizontal(|ui| {
            ui.radio_value(&mut self.inches, false, "per cm");
            ui.radio_value(&mut self.inches, true, "per inch");
        });
        let present = [sett.ends.per_cm, sett.picks.per_cm];
        let mut typed = self.typed.unwrap_or(present);
        let (scale, ends_unit, picks_unit) = self.unit();
        let names = [("Ends", ends_unit), ("Picks", picks_unit)];
        egui::Grid::new("threads a length")
            .num_columns(2)
            .spacing([tokens::PAD, tokens::GRID])
            .show(ui, |ui| {
                for (which, (name, unit)) in names.into_iter().enumerate() {
                    let label = ui.label(name);
                    let mut number = typed[which] * scale;
                    let field = DragValue::new(&mut number)
                        .speed(0.05)
                        .range(SETT_PER_CM.start() * scale..=SETT_PER_CM.end() * scale)
                        .max_decimals(2)
                        .suffix(format!(" {unit}"));
                    if typing::number(ui, field).labelled_by(label.id).changed() {
                        typed[which] = number / scale;
                        self.typed = Some(typed);
                    }
                    ui.end_row();
                }
            });
        let uneven = sett.ends.pitches_mm.is_some() || sett.picks.pitches_mm.is_some();
        if uneven {
            let text = "Threads are spaced unequally; another sett spaces them evenly.";
            ui.label(RichText::new(text).color(Palette::current(ui).quiet));
        }
        if sett.assumed {
            let text = "Nobody chose this sett: it is the yarns' usual one.";
            ui.label(RichText::new(text).color(Palette::current(ui).quiet));
        }
        let changed = (0..2).any(|which| (typed[which] - present[which]).abs() > 1e-4);
        if !changed {
            self.typed = None;
            return;
        }
        ui.label("Keep the threads, so that the cloth changes its size, or the size of the cloth?");
        ui.horizontal_wrapped(|ui| {
            let wanted = || {
                let density = |which: usize, old: &Density| {
                    if (typed[which] - present[which]).abs() > 1e-4 {
                        Density::per_cm(typed[which])
                    } else {
                        old.clone()
                    }
                };
                Box::new(Sett {
                    ends: density(0, &sett.ends),
                    picks: density(1, &sett.picks),
                    assumed: false,
                })
            };
            if ui.button("Keep threads").clicked() {
                actions.push(Action::edit(Edit::SetSett(wanted())));
                self.typed = None;
            }
            let keep_size = ui.button("Keep size");
            if keep_size
                .on_hover_text("The artwork is resampled to the threads that fit")
                .clicked()
            {
                actions.push(Action::edit(Edit::SetSettKeepSize(wanted())));
                self.typed = None;
            }
            if ui.button("Leave it").clicked() {
                self.typed = None;
            }
        });
    }

    fn reed_ui(&mut self, ui: &mut egui::Ui, document: &Document) {
        let design = document.design();
        let palette = Palette::current(ui);
        let [warp, weft] = self.take_up.answer().copied().unwrap_or([0.0; 2]);
        ui.horizontal_wrapped(|ui| {
            let label = ui.label("Ends a dent");
            typing::number(ui, DragValue::new(&mut self.ends_a_dent).range(1..=64))
                .labelled_by(label.id);
            for (which, name) in ["Shrinkage across", "along"].into_iter().enumerate() {
                let label = ui.label(name);
                let field = DragValue::new(&mut self.shrinkage[which]);
                let field = field.speed(0.1).range(0.0..=60.0).suffix(" %");
                typing::number(ui, field).labelled_by(label.id);
            }
        });
        let shrinkage = self.shrinkage.map(|percent| f64::from(percent) / 100.0);
        let found = reed(design, weft, self.ends_a_dent, shrinkage);
        let (scale, unit) = if self.inches {
            (25.4, "in")
        } else {
            (10.0, "cm")
        };
        let reed_unit = if self.inches { f64::from(INCH) } else { 1.0 };
        egui::Grid::new("sizes")
            .num_columns(2)
            .spacing([tokens::PAD, tokens::GRID])
            .show(ui, |ui| {
                let mut row = |name: &str, value: String| {
                    ui.label(RichText::new(name).color(palette.quiet));
                    ui.label(value);
                    ui.end_row();
                };
                let size = |size: [f64; 2]| {
                    format!("{:.2} × {:.2} {unit}", size[0] / scale, size[1] / scale)
                };
                row("Repeat off the loom", size(found.cloth_mm));
                row("Finished repeat", size(found.finished_mm));
                row(
                    "Width in the reed",
                    format!("{:.2} {unit}", found.width_mm / scale),
                );
                row(
                    "Reed",
                    format!(
                        "{:.1} dents/{unit}, {} dents",
                        found.dents_per_cm * reed_unit,
                        found.dents
                    ),
                );
                row(
                    "Take-up",
                    format!("warp {:.1} %, weft {:.1} %", warp * 100.0, weft * 100.0),
                );
            });
    }
}
