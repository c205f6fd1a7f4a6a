//! Exporting a still: how large and how long, where to, and the work on its thread.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{ComboBox, DragValue, RichText};
use pickglass::design::Design;
use pickglass::formats::output;
use pickglass::render::Backing;

use super::pace::{self, Measured};
use super::task::{Outcome, Running};
use super::{dialog, typing};
use crate::tokens::{self, Palette};
use crate::values;
use pickglass::engine::{self, StillError, StillReport, StillRequest, Stop};
use pickglass::text::shell_word;

/// What became of an export.
pub enum Exported {
    Written(PathBuf, Box<StillReport>),
    Cancelled,
    Failed(String),
}

/// What the form starts with, where that is not what the machine can do.
#[derive(Default)]
pub struct Defaults {
    pub width: Option<u32>,
    pub seconds: Option<f64>,
    /// `None` = named after the design.
    pub path: Option<PathBuf>,
}

/// What may lie behind the cloth.
const BACKINGS: [(Backing, &str); 4] = [
    (Backing::Itself, "more of the cloth itself"),
    (Backing::White, "white paper"),
    (Backing::Black, "something black"),
    (Backing::None, "nothing: the picture can be seen through"),
];

/// The export form and the export under way.
#[derive(Default)]
pub struct Export {
    pub defaults: Defaults,
    /// The file that the design is from: not to be written over.
    pub source: Option<PathBuf>,
    form: Option<Form>,
    browse: dialog::Browse,
    work: Option<Running<Exported>>,
}

struct Form {
    design: Arc<Design>,
    still: StillRequest,
    width: u32,
    until: Until,
    seconds: f64,
    samples: u32,
    /// Per cent.
    error: f64,
    backing: Backing,
    measured: Option<Measured>,
    path: String,
    wrong: Option<String>,
}

/// What ends the refining.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Until {
    Seconds,
    Samples,
    Error,
}

impl Form {
    fn stop(&self) -> Stop {
        match self.until {
            Until::Seconds => Stop {
                seconds: Some(self.seconds),
                ..Stop::default()
            },
            Until::Samples => Stop {
                spp: Some(self.samples),
                ..Stop::default()
            },
            Until::Error => Stop {
                error: Some(self.error / 100.0),
                ..Stop::default()
            },
        }
    }
}

/// How far a picture is, in words, and the seconds that refining will still take.
fn refined(stop: &Stop, spp: u32, seconds: f64, error: Option<f64>) -> (String, Option<f64>) {
    let share = match (stop.seconds, stop.spp, stop.error, error) {
        (Some(all), ..) => seconds / all,
        (None, Some(all), ..) => f64::from(spp) / f64::from(all.max(1)),
        // The error falls with the square root of the samples.
        (None, None, Some(wanted), Some(now)) => (wanted / now).powi(2),
        _ => 0.0,
    };
    let left = seconds * (1.0 - share.min(1.0)) / share;
    let error = error.map_or_else(String::new, |error| {
        format!(" · error {:.1} %", 100.0 * error)
    });
    let text = format!("{spp} spp · {seconds:.0} s{error}");
    (text, left.is_finite().then_some(left))
}

impl Export {
    /// Shows the form for the cloth as it is seen now; `measured` says how that was traced.
    pub fn ask(&mut self, design: Arc<Design>, still: StillRequest, measured: Option<Measured>) {
        if self.work.is_none() {
            let proposal = pace::propose(measured, aspect(&still));
            self.form = Some(Form {
                path: match &self.defaults.path {
                    Some(path) => path.display().to_string(),
                    None => format!("{}.png", design.name.replace(['/', '\\'], "-")),
                },
                width: self.defaults.width.unwrap_or(proposal.width),
                until: Until::Seconds,
                seconds: self.defaults.seconds.unwrap_or(proposal.seconds),
                backing: Backing::Itself,
                measured,
                samples: 256,
                error: 5.0,
                design,
                still,
                wrong: None,
            });
        }
    }

    /// What the export under way is at.
    pub fn progress(&self) -> Option<String> {
        self.work.as_ref().map(Running::progress)
    }

    /// Cancels the export under way.
    pub fn cancel(&self) {
        if let Some(work) = &self.work {
            work.cancel();
        }
    }

    /// Picks up what the threads finished.
    pub fn poll(&mut self) -> Option<Exported> {
        if let (Some(path), Some(form)) = (self.browse.poll(), &mut self.form) {
            form.path = path.display().to_string();
            form.wrong = None;
        }
        let done = match self.work.as_ref()?.poll() {
            Outcome::Working => return None,
            Outcome::Ready(done) => done,
            Outcome::Lost => Exported::Failed(
                "the still: rendering it failed unexpectedly: try a smaller size".to_owned(),
            ),
        };
        self.work = None;
        Some(done)
    }

    /// Shows the form, when it is asked for.
    pub fn show(&mut self, ctx: &egui::Context) {
        let Some(form) = &mut self.form else {
            return;
        };
        let shown = dialog::show(ctx, "export", |ui| form_ui(ui, form));
        let choice = match shown.escaped {
            true => Choice::Close,
            false => shown.inner,
        };
        match choice {
            Choice::None => {}
            Choice::Close => self.form = None,
            Choice::Browse => {
                (self.browse).ask(ctx, "Export a still", "Pictures", &["png", "exr"]);
            }
            Choice::Render => match values::picture_path(form.path.trim()) {
                Ok(path) => {
                    let inputs = form
                        .still
                        .light
                        .file()
                        .into_iter()
                        .chain(self.source.as_deref());
                    match output::check(&path.0, inputs) {
                        Err(wrong) => form.wrong = Some(wrong.to_string()),
                        Ok(()) => {
                            if let Some(form) = self.form.take() {
                                self.begin(ctx, form, path.0);
                            }
                        }
                    }
                }
                Err(wrong) => form.wrong = Some(wrong),
            },
        }
    }

    fn begin(&mut self, ctx: &egui::Context, form: Form, path: PathBuf) {
        let stop = form.stop();
        let mut still = form.still;
        still.height = scaled_height(&still, form.width);
        still.width = form.width;
        still.stop = stop;
        still.backing = form.backing;
        // Other files are read by options of their own.
        let design = |path: &&PathBuf| path.extension().is_some_and(|ending| ending == "ron");
        let source = self.source.as_ref().filter(design);
        let source = source.map(|path| shell_word(&path.display().to_string()).into_owned());
        let design = form.design;
        let work = Running::start(ctx, "export", move |job, teller| {
            let rendered =
                engine::render_still(&design, &still, engine::reference(), job, &mut |pass| {
                    let (text, left) = refined(&stop, pass.spp, pass.seconds, pass.error);
                    teller.tell_left(text, left);
                });
            teller.tell("finishing: denoising and writing".to_owned());
            let rendered = rendered.map(|done| match source {
                Some(source) => done.made_from(source),
                None => done,
            });
            match rendered.and_then(|done| done.save(&path).map(|()| done.report)) {
                Ok(report) => Exported::Written(path, Box::new(report)),
                Err(StillError::Cancelled(_)) => Exported::Cancelled,
                Err(error) => Exported::Failed(error.to_string()),
            }
        });
        self.work = work.ok();
    }
}

enum Choice {
    None,
    Close,
    Browse,
    Render,
}

/// Height over width.
fn aspect(still: &StillRequest) -> f64 {
    f64::from(still.height) / f64::from(still.width.max(1))
}

fn scaled_height(still: &StillRequest, width: u32) -> u32 {
    ((f64::from(width) * aspect(still)).round() as u32).max(1)
}

/// What the picture that is asked for comes to on this machine.
fn expected(form: &Form) -> String {
    let Some(measured) = form.measured else {
        return "How long this takes shows once the cloth has been traced for a while.".to_owned();
    };
    let pixels = f64::from(form.width) * f64::from(scaled_height(&form.still, form.width));
    let percent = |error: f64| format!("about {:.0} %", (100.0 * error).max(1.0));
    let text = match form.until {
        Until::Seconds => {
            let error = measured.error_after(pixels, form.seconds);
            format!("An error of {}", percent(error))
        }
        Until::Samples => {
            let spp = f64::from(form.samples);
            let seconds = pace::in_words(measured.seconds_of(pixels, spp));
            let error = percent(measured.error_of(spp));
            format!("About {seconds}, and an error of {error}")
        }
        Until::Error => {
            let seconds = measured.seconds_to(pixels, form.error / 100.0);
            format!("About {}", pace::in_words(seconds))
        }
    };
    format!("{text} before it is denoised, as this machine traced the cloth so far.")
}

fn form_ui(ui: &mut egui::Ui, form: &mut Form) -> Choice {
    ui.set_width(tokens::TOAST_WIDTH);
    let palette = Palette::current(ui);
    let mut choice = Choice::None;
    ui.label(RichText::new("Export still").text_style(egui::TextStyle::Heading));
    ui.label(RichText::new("The cloth as it is shown now.").color(palette.quiet));
    ui.add_space(tokens::GAP);
    egui::Grid::new("export form")
        .num_columns(2)
        .show(ui, |ui| {
            let label = ui.label("Width");
            let field = DragValue::new(&mut form.width)
                .range(16..=16_384)
                .suffix(" px");
            typing::number(ui, field).labelled_by(label.id);
            ui.end_row();
            ui.label("Height");
            ui.label(format!("{} px", scaled_height(&form.still, form.width)));
            ui.end_row();
            for (until, name) in [
                (Until::Seconds, "Refine for"),
                (Until::Samples, "Refine up to"),
                (Until::Error, "Refine until the error is"),
            ] {
                ui.radio_value(&mut form.until, until, name);
                let field = match until {
                    Until::Seconds => DragValue::new(&mut form.seconds)
                        .range(0.1..=36_000.0)
                        .suffix(" s"),
                    Until::Samples => DragValue::new(&mut form.samples)
                        .range(1..=65_536)
                        .suffix(" samples a pixel"),
                    Until::Error => DragValue::new(&mut form.error)
                        .range(0.1..=50.0)
                        .speed(0.1)
                        .suffix(" %"),
                };
                let on = form.until == until;
                let field = ui.add_enabled_ui(on, |ui| typing::number(ui, field)).inner;
                let spoken = format!("{name}, value");
                field.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::SpinButton, true, &spoken)
                });
                ui.end_row();
            }
            let label = ui.label("Behind the cloth");
            let name = |backing: Backing| {
                let found = BACKINGS.iter().find(|(known, _)| *known == backing);
                found.map_or("", |(_, name)| name)
            };
            let shown = ComboBox::from_id_salt("backing")
                .selected_text(name(form.backing))
                .show_ui(ui, |ui| {
                    for (backing, name) in BACKINGS {
                        ui.selectable_value(&mut form.backing, backing, name);
                    }
                });
            shown.response.labelled_by(label.id);
            ui.end_row();
            let label = ui.label("File");
            ui.horizontal(|ui| {
                let field = ui.add(egui::TextEdit::singleline(&mut form.path));
                if typing::entered(ui, &field) {
                    field.request_focus();
                    choice = Choice::Render;
                }
                if field.changed() {
                    form.wrong = None;
                }
                field.labelled_by(label.id);
                if ui.button("Browse…").clicked() {
                    choice = Choice::Browse;
                }
            });
            ui.end_row();
        });
    ui.vertical(|ui| {
        ui.set_min_height(2.0 * ui.text_style_height(&egui::TextStyle::Body));
        ui.label(RichText::new(expected(form)).color(palette.quiet));
    });
    dialog::problem(ui, form.wrong.as_deref());
    ui.horizontal(|ui| {
        if ui.button("Render").clicked() {
            choice = Choice::Render;
        }
        if ui.button("Cancel").clicked() {
            choice = Choice::Close;
        }
    });
    choice
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_says_what_is_left_whatever_ends_it() {
        let seconds = Stop {
            seconds: Some(60.0),
            ..Stop::default()
        };
        let left = |stop: &Stop, error| refined(stop, 8, 15.0, error).1.map(f64::round);
        assert_eq!(refined(&seconds, 8, 15.0, None).0, "8 spp · 15 s");
        assert_eq!(left(&seconds, None), Some(45.0));
        let samples = Stop {
            spp: Some(32),
            ..Stop::default()
        };
        assert_eq!(left(&samples, None), Some(45.0));
        let error = Stop {
            error: Some(0.05),
            ..Stop::default()
        };
        // Half the error takes four times the samples.
        assert_eq!(left(&error, Some(0.1)), Some(45.0));
        assert_eq!(
            refined(&error, 8, 15.0, Some(0.1)).0,
            "8 spp · 15 s · error 10.0 %"
        );
        assert_eq!(left(&error, None), None);
    }
}
