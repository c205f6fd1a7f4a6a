//! What accuracy costs: time and error of every setting of every dial, measured on this machine
//! and of the open design. A click on a setting takes it.

mod budget;
mod plot;
mod words;

use std::sync::{Arc, Mutex, PoisonError};

use egui::{Button, Label, RichText, ScrollArea, TextureHandle, TextureOptions, Ui, vec2};
use pickglass::accuracy::{self, Accuracy, AccuracyError, Asked, Axis, Curve, Effort, Measuring};
use pickglass::design::Design;
use pickglass::edit::Document;
use pickglass::engine::{self, StillRequest};
use pickglass::exemplar::ExemplarStore;
use pickglass::film::Picture;
use pickglass::job::Job;
use strum::EnumMessage;

use super::columns::column;
use super::of_design::OfDesign;
use super::{PaneView, Shown};
use crate::tokens::{self, Palette};
use crate::window::action::Action;
use crate::window::picture::image;
use crate::window::task::{Outcome, Running};
use budget::BudgetForm;
#[cfg(test)]
pub use words::title;

/// Width of the list of dials and of that of settings, points.
const LIST: f32 = 44.0 * tokens::GRID;
const SETTINGS: f32 = 84.0 * tokens::GRID;
/// Width from which they stand beside the plot, points.
const BESIDE: f32 = 170.0 * tokens::GRID;
/// Height up to which all of it scrolls together, points.
const LOW: f32 = 56.0 * tokens::GRID;
/// Height of a plot above them, and of the picture of a setting, points.
const PLOT: f32 = 52.0 * tokens::GRID;
const PICTURE: f32 = 30.0 * tokens::GRID;
/// Said where dials are set.
const NOT_UNDONE: &str = "A setting is no part of the design: undo leaves it.";

/// What was measured so far, and what the settings of each dial look like.
#[derive(Default)]
struct Found {
    accuracy: Option<Accuracy>,
    pictures: Vec<(String, Vec<Picture>)>,
}

/// What is measured, and what is looked at of it.
#[derive(Default)]
pub struct AccuracyPane {
    /// The picture of the cloth, as it is looked at.
    asked: Option<StillRequest>,
    effort: Effort,
    found: Arc<Mutex<Found>>,
    running: Option<Running<Result<(), String>>>,
    failed: Option<String>,
    /// The dial whose curve is shown.
    dial: Option<String>,
    budget: BudgetForm,
    /// Another number for each measurement, and the design that it is of.
    measurement: u64,
    of: Option<OfDesign>,
    /// A setting's picture, by measurement, dial and place.
    texture: Option<((u64, String, usize), TextureHandle)>,
}

impl PaneView for AccuracyPane {
    fn show(&mut self, ui: &mut Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
        self.poll();
        self.head_ui(ui, shown.document);
        let quiet = Palette::current(ui).quiet;
        let accuracy = self.found().accuracy.clone();
        let Some(accuracy) = accuracy.filter(|accuracy| !accuracy.dials.is_empty()) else {
            let told = "What each approximation costs in time, and how wrong it is: measured on \
                        this machine, of this design as it is looked at. The cloth waits meanwhile. \
                        Then each dial has its curve, a click on a setting takes it, and a budget \
                        of seconds, of error or of colour sets them all.";
            ui.label(RichText::new(told).color(quiet));
            return;
        };
        let changed = self.of.as_ref().is_some_and(|of| !of.is(shown.document));
        if changed || self.is_of_another_picture(&accuracy) {
            let told = match changed {
                true => "This was measured before the design was changed.",
                false => "This was measured of another view, or with dials that no curve is of.",
            };
            ui.label(RichText::new(told).color(Palette::current(ui).warning));
        }
        if let (None, Some(asked)) = (&self.running, self.asked()) {
            let numbered = (&accuracy, self.measurement);
            self.budget.show(ui, numbered, &asked, actions);
        }
        let known = |name: &String| accuracy.dials.iter().any(|curve| curve.name == *name);
        let dial = self.dial.clone().filter(known);
        let dial = dial.unwrap_or_else(|| accuracy.dials[0].name.clone());
        let Some(curve) = accuracy.dials.iter().find(|curve| curve.name == dial) else {
            return;
        };
        let room = ui.available_size();
        if room.x > BESIDE && room.y > LOW {
            let settings = SETTINGS.min(0.4 * room.x);
            let plot = room.x - LIST - settings - 2.0 * ui.spacing().item_spacing.x;
            ui.horizontal_top(|ui| {
                column(ui, vec2(LIST, room.y), |ui| {
                    self.list_ui(ui, &accuracy, &dial);
                });
                let pointed = column(ui, vec2(plot, room.y), |ui| self.curve_ui(ui, curve));
                column(ui, vec2(settings, room.y), |ui| {
                    self.settings_ui(ui, curve, pointed, actions);
                });
            });
        } else {
            ScrollArea::vertical().id_salt("all").show(ui, |ui| {
                ui.horizontal_wrapped(|ui| self.dials_ui(ui, &accuracy, &dial));
                let size = vec2(ui.available_width(), PLOT);
                let pointed = column(ui, size, |ui| self.curve_ui(ui, curve));
                self.settings_ui(ui, curve, pointed, actions);
            });
        }
    }

    // Forgets what was measured of the design before.
    fn forget(&mut self) {
        *self = Self {
            effort: self.effort,
            ..Self::default()
        };
    }
}

impl AccuracyPane {
    /// How the cloth is looked at now.
    pub fn look(&mut self, asked: Option<&StillRequest>) {
        if self.asked.as_ref() != asked {
            self.asked = asked.cloned();
        }
    }

    /// Whether it measures: all else that works would be measured as well.
    pub fn is_measuring(&self) -> bool {
        self.running.is_some()
    }

    /// What was measured so far.
    #[cfg(test)]
    pub fn measured(&self) -> Option<Accuracy> {
        self.found().accuracy.clone()
    }

    /// Writes a budget.
    #[cfg(test)]
    pub fn budget(&mut self, text: &str) {
        self.budget.write(text);
    }

    fn found(&self) -> std::sync::MutexGuard<'_, Found> {
        self.found.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn poll(&mut self) {
        let Some(running) = &self.running else { return };
        match running.poll() {
            Outcome::Working => {}
            Outcome::Ready(done) => {
                self.failed = done.err();
                self.running = None;
            }
            Outcome::Lost => {
                self.failed = Some("measuring ended before it was done".to_owned());
                self.running = None;
            }
        }
    }

    /// What is being done, and what can be.
    fn head_ui(&mut self, ui: &mut Ui, document: &Document) {
        ui.horizontal_wrapped(|ui| {
            if let Some(running) = &self.running {
                ui.label(format!("{}: {}", self.effort, running.progress()));
                if ui.button("Stop measuring").clicked() {
                    running.cancel();
                }
                return;
            }
            let ready = self.asked.is_some();
            let button = ui.add_enabled(ready, Button::new("Measure"));
            if button.clicked()
                && let Some(asked) = self.asked.clone()
            {
                self.of = Some(OfDesign::new(document));
                self.start(ui.ctx(), document.design(), asked);
            }
            for effort in [Effort::Quick, Effort::Default, Effort::Full] {
                let about = effort.get_documentation().unwrap_or_default();
                ui.radio_value(&mut self.effort, effort, effort.to_string())
                    .on_hover_text(about);
            }
        });
        if let Some(failed) = &self.failed {
            ui.label(RichText::new(failed).color(Palette::current(ui).error));
        }
    }

    /// Measures from now on.
    fn start(&mut self, ctx: &egui::Context, design: &Arc<Design>, request: StillRequest) {
        let renderer = engine::reference();
        let before = self.found().accuracy.clone();
        let measuring = Measuring {
            asked: Asked { request, renderer },
            effort: self.effort,
            axes: Vec::new(),
            before,
        };
        let (design, found) = (Arc::clone(design), Arc::clone(&self.found));
        let running = Running::start(ctx, "accuracy", move |job: &Job, _| {
            let keep = |accuracy: &Accuracy, crops: &Vec<Picture>| {
                let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
                // Dials together have no pictures.
                if let (Some(curve), false) = (accuracy.dials.last(), crops.is_empty()) {
                    found.pictures.retain(|(name, _)| *name != curve.name);
                    found.pictures.push((curve.name.clone(), crops.clone()));
                }
                found.accuracy = Some(accuracy.clone());
                Ok(())
            };
            let store = ExemplarStore::user();
            match accuracy::measure(&design, &measuring, &store, job, &mut { keep }) {
                Ok(_) | Err(AccuracyError::Cancelled(_)) => Ok(()),
                Err(error) => Err(error.to_string()),
            }
        });
        self.failed = None;
        self.measurement += 1;
        match running {
            Ok(running) => self.running = Some(running),
            Err(error) => self.failed = Some(format!("no thread to measure on: {error}")),
        }
    }

    /// The picture that is looked at, and what draws it.
    fn asked(&self) -> Option<Asked> {
        let request = self.asked.clone()?;
        let renderer = engine::reference();
        Some(Asked { request, renderer })
    }

    /// Whether what was measured is of another picture than the one that is looked at.
    fn is_of_another_picture(&self, accuracy: &Accuracy) -> bool {
        self.asked().is_some_and(|asked| !accuracy.is_of(&asked))
    }

    /// The dials, each with what it is set to.
    fn list_ui(&mut self, ui: &mut Ui, accuracy: &Accuracy, shown: &str) {
        ScrollArea::vertical()
            .id_salt("dials")
            .auto_shrink([false, false])
            .show(ui, |ui| self.dials_ui(ui, accuracy, shown));
    }

    fn dials_ui(&mut self, ui: &mut Ui, accuracy: &Accuracy, shown: &str) {
        for curve in &accuracy.dials {
            let text = format!("{}: {}", words::title_of(curve), self.set_to(curve));
            let entry = ui.selectable_label(curve.name == shown, text);
            let about = format!("{}. On the command line: {}", curve.about, curve.name);
            if entry.on_hover_text(about).clicked() {
                self.dial = Some(curve.name.clone());
            }
        }
    }

    /// What a dial is set to now.
    fn set_to(&self, curve: &Curve) -> String {
        let axis = Axis::named(&curve.name).ok();
        let now = axis.zip(self.asked());
        let now = now.map(|(axis, asked)| axis.current(&asked));
        now.unwrap_or_else(|| curve.current.clone())
    }

    /// The curve of one dial; says which setting the pointer is at, and whether it was clicked.
    fn curve_ui(&mut self, ui: &mut Ui, curve: &Curve) -> Option<(usize, bool)> {
        let quiet = Palette::current(ui).quiet;
        let about = format!(
            "{}. Error: {}; what other dials make wrong is not in it. Time: of the whole picture, \
             dial after dial, so that other work on this machine shows in it.",
            super::effects::sentence(&curve.about),
            curve.measure.about()
        );
        ui.add(Label::new(RichText::new(about).color(quiet)).wrap());
        plot::show(ui, curve, &self.set_to(curve))
    }

    /// The settings of a dial one by one, and what one of them looks like; `pointed` is at one
    /// of them.
    fn settings_ui(
        &mut self,
        ui: &mut Ui,
        curve: &Curve,
        pointed: Option<(usize, bool)>,
        actions: &mut Vec<Action>,
    ) {
        let now = self.set_to(curve);
        let axis = Axis::named(&curve.name).ok();
        let elsewhere = axis.and_then(|axis| axis.elsewhere());
        let can_set = elsewhere.is_none();
        let mut looked_at = pointed.map(|(at, _)| at);
        let mut taken = pointed.and_then(|(at, clicked)| clicked.then_some(at));
        ScrollArea::vertical()
            .id_salt("settings")
            .auto_shrink([false, true])
            .show(ui, |ui| {
                for (at, point) in curve.settings.iter().enumerate() {
                    let chosen = point.value == now;
                    let row = ui.add_enabled(
                        can_set,
                        Button::selectable(chosen, words::row(curve, point)).truncate(),
                    );
                    let pointed_at = row.hovered() || row.has_focus();
                    if pointed_at || row.contains_pointer() {
                        looked_at = Some(at);
                    }
                    let row = row.on_disabled_hover_text(elsewhere.unwrap_or_default());
                    if row.clicked() {
                        taken = Some(at);
                    }
                }
                let at = looked_at.or_else(|| curve.settings.iter().position(|p| p.value == now));
                if let Some(at) = at {
                    self.picture_ui(ui, curve, at);
                }
                if can_set {
                    ui.label(RichText::new(NOT_UNDONE).color(Palette::current(ui).quiet));
                }
            });
        if let (true, Some(at)) = (can_set, taken) {
            actions.push(Action::Set(
                curve.name.clone(),
                curve.settings[at].value.clone(),
            ));
        }
    }

    /// What a setting looks like.
    fn picture_ui(&mut self, ui: &mut Ui, curve: &Curve, at: usize) {
        let key = (self.measurement, curve.name.clone(), at);
        if self.texture.as_ref().is_none_or(|(known, _)| *known != key) {
            let found = self.found();
            let pictures = found.pictures.iter().find(|(name, _)| *name == curve.name);
            let picture = pictures.and_then(|(_, pictures)| pictures.get(at));
            let image = picture.map(image);
            drop(found);
            self.texture = image.map(|image| {
                let options = TextureOptions::NEAREST;
                (key, ui.ctx().load_texture("accuracy", image, options))
            });
        }
        if let Some((_, texture)) = &self.texture {
            let size = texture.size_vec2();
            let at = format!("At {}:", curve.settings[at].value);
            ui.label(RichText::new(at).color(Palette::current(ui).quiet));
            let shown = egui::Image::new(texture).fit_to_exact_size(size * (PICTURE / size.y));
            ui.add(shown)
                .on_hover_text("What a piece of the cloth looks like at this setting");
        }
    }
}
