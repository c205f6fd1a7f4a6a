//! What accuracy costs: time and error of every setting of every dial, measured on this machine
//! and of the open design. A click on a setting takes it.

use std::sync::{Arc, Mutex, PoisonError};

use egui::{Button, Label, RichText, ScrollArea, TextureHandle, TextureOptions, Ui, vec2};
use egui_plot::{GridInput, GridMark, Line, MarkerShape, Plot, PlotPoint, PlotPoints, Points};
use pickglass::accuracy::{
    self, Accuracy, AccuracyError, Asked, Axis, Curve, Effort, Measuring, Point, number,
};
use pickglass::design::Design;
use pickglass::edit::Document;
use pickglass::engine::{self, StillRequest};
use pickglass::exemplar::ExemplarStore;
use pickglass::film::Picture;
use pickglass::job::Job;
use strum::EnumMessage;

use super::columns::column;
use super::{PaneView, Shown};
use crate::tokens::{self, Palette};
use crate::window::action::Action;
use crate::window::picture::image;
use crate::window::task::{Outcome, Running};

/// Width of the list of dials and of that of settings, points.
const LIST: f32 = 44.0 * tokens::GRID;
const SETTINGS: f32 = 84.0 * tokens::GRID;
/// Width from which they stand beside the plot, points.
const BESIDE: f32 = 170.0 * tokens::GRID;
/// Height of a plot above them, and of the picture of a setting, points.
const PLOT: f32 = 52.0 * tokens::GRID;
const PICTURE: f32 = 30.0 * tokens::GRID;
/// Least height of a plot, points.
const LEAST_PLOT: f32 = 30.0 * tokens::GRID;
/// How near to a setting the pointer has to be, points.
const NEAR: f32 = 20.0;
/// Errors of nothing are drawn at this share of the least that there is.
const BELOW: f64 = 0.3;

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
    /// Another number for each measurement, and the document's state that it is of.
    measurement: u64,
    revision: u64,
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
                        this machine, of this design as it is looked at. The cloth waits meanwhile.";
            ui.label(RichText::new(told).color(quiet));
            return;
        };
        let changed = shown.document.revision() != self.revision;
        if changed || self.is_of_another_picture(&accuracy) {
            let told = match changed {
                true => "This was measured before the design was changed.",
                false => "This was measured of another view, or with other settings.",
            };
            ui.label(RichText::new(told).color(Palette::current(ui).warning));
        }
        let known = |name: &String| accuracy.dials.iter().any(|curve| curve.name == *name);
        let dial = self.dial.clone().filter(known);
        let dial = dial.unwrap_or_else(|| accuracy.dials[0].name.clone());
        let Some(curve) = accuracy.dials.iter().find(|curve| curve.name == dial) else {
            return;
        };
        let room = ui.available_size();
        if room.x > BESIDE {
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
                ui.label(running.progress());
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
                self.revision = document.revision();
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

    /// Whether what was measured is of another picture than the one that is looked at.
    fn is_of_another_picture(&self, accuracy: &Accuracy) -> bool {
        let renderer = engine::reference();
        self.asked.as_ref().is_some_and(|request| {
            let request = request.clone();
            accuracy::options(&Asked { request, renderer }) != accuracy.picture
        })
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
            let text = format!("{}: {}", curve.name, self.set_to(curve));
            let entry = ui.selectable_label(curve.name == shown, text);
            if entry.on_hover_text(&curve.about).clicked() {
                self.dial = Some(curve.name.clone());
            }
        }
    }

    /// What a dial is set to now.
    fn set_to(&self, curve: &Curve) -> String {
        let axis = Axis::named(&curve.name).ok();
        let now = axis.zip(self.asked.clone()).map(|(axis, request)| {
            let renderer = engine::reference();
            axis.current(&Asked { request, renderer })
        });
        now.unwrap_or_else(|| curve.current.clone())
    }

    /// The curve of one dial; says which setting the pointer is at, and whether it was clicked.
    fn curve_ui(&mut self, ui: &mut Ui, curve: &Curve) -> Option<(usize, bool)> {
        let quiet = Palette::current(ui).quiet;
        let what = curve.about.trim_end_matches('.');
        let about = format!("{what}. Error: {}.", curve.measure.about());
        ui.add(Label::new(RichText::new(about).color(quiet)).truncate());
        plot_ui(ui, curve, &self.set_to(curve))
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
                        Button::selectable(chosen, row(curve, point)).truncate(),
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
            let shown = egui::Image::new(texture).fit_to_exact_size(size * (PICTURE / size.y));
            ui.add(shown).on_hover_text(format!(
                "What it looks like at {}",
                curve.settings[at].value
            ));
        }
    }
}

/// A setting in words.
fn row(curve: &Curve, point: &Point) -> String {
    let error = match curve.unit.as_str() {
        "yarn diameters" => format!("{} {}", number(point.error), curve.unit),
        _ => format!("{} %", number(100.0 * point.error)),
    };
    let seen = point.delta_e.map_or_else(String::new, |delta_e| {
        format!(" · ΔE {delta_e:.1} from 30 cm")
    });
    let knee = match curve.knee.as_ref() == Some(&point.value) {
        true => " · after it more time brings little",
        false => "",
    };
    let predicted = if point.measured { "" } else { " · predicted" };
    format!(
        "{} · {} s · {error}{seen}{knee}{predicted}",
        point.value,
        number(point.seconds)
    )
}

/// Decimal logarithms of time and error of each setting.
fn places(curve: &Curve) -> Vec<[f64; 2]> {
    let errors = curve.settings.iter().map(|point| point.error);
    let least = (errors.filter(|error| *error > 0.0)).fold(f64::INFINITY, f64::min);
    let floor = if least.is_finite() {
        BELOW * least
    } else {
        1e-3
    };
    let place = |point: &Point| {
        let error = point.error.max(floor);
        [point.seconds.max(1e-9).log10(), error.log10()]
    };
    curve.settings.iter().map(place).collect()
}

/// Draws the curve; says which setting the pointer is at, and whether it was clicked.
fn plot_ui(ui: &mut Ui, curve: &Curve, now: &str) -> Option<(usize, bool)> {
    let places = places(curve);
    let palette = Palette::current(ui);
    let of_power = |mark: GridMark| number(10f64.powf(mark.value));
    let plot = Plot::new(("accuracy", &curve.name))
        .height(ui.available_height().max(LEAST_PLOT))
        .grid_color(palette.line)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .x_axis_label("seconds")
        .y_axis_label(curve.unit.as_str())
        .x_axis_formatter(move |mark, _| of_power(mark))
        .y_axis_formatter(move |mark, _| of_power(mark))
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .set_margin_fraction(vec2(0.12, 0.15))
        .label_formatter(|_| None);
    let shown = plot.show(ui, |plot| {
        let series = |keep: &dyn Fn(usize) -> bool| -> PlotPoints<'_> {
            let kept = places.iter().enumerate().filter(|(at, _)| keep(*at));
            kept.map(|(_, place)| *place).collect()
        };
        let measured = |at: usize| curve.settings[at].measured;
        plot.line(Line::new("", series(&|_| true)).color(palette.focus));
        for filled in [true, false] {
            let points = Points::new("", series(&|at| measured(at) == filled));
            plot.points(points.filled(filled).radius(4.0).color(palette.focus));
        }
        let here = series(&|at| curve.settings[at].value == now);
        plot.points(
            Points::new("", here)
                .shape(MarkerShape::Circle)
                .filled(false)
                .radius(8.0)
                .color(palette.warning),
        );
        for (at, [x, y]) in places.iter().enumerate() {
            let said = RichText::new(&curve.settings[at].value).color(palette.text);
            let text = egui_plot::Text::new("", PlotPoint::new(*x, *y), said);
            plot.text(text.anchor(egui::Align2::LEFT_BOTTOM));
        }
    });
    let pointer = shown.response.hover_pos()?;
    let distance = |place: &[f64; 2]| {
        let at = PlotPoint::new(place[0], place[1]);
        shown.transform.position_from_point(&at).distance(pointer)
    };
    let nearest = (places.iter().map(distance).enumerate())
        .min_by(|one, other| one.1.total_cmp(&other.1))
        .filter(|(_, distance)| *distance < NEAR);
    nearest.map(|(at, _)| (at, shown.response.clicked()))
}

/// What is marked in a decade, and how far it is to the next mark of its kind.
const DECADE: [(f64, f64); 6] = [
    (1.0, 1.0),
    (2.0, 0.3),
    (5.0, 0.3),
    (1.5, 0.1),
    (3.0, 0.1),
    (7.0, 0.1),
];

/// Powers of ten, and what stands between them.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let (first, last) = (low.floor() as i32, high.ceil().min(low + 40.0) as i32);
    let marks = (first..=last).flat_map(|power| {
        DECADE.map(|(times, step_size)| GridMark {
            value: f64::from(power) + times.log10(),
            step_size,
        })
    });
    marks
        .filter(|mark| mark.value >= low && mark.value <= high)
        .collect()
}
