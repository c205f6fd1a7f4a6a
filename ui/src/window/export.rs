//! Exporting a still: how large and how long, where to, and the work on its thread.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{DragValue, RichText};
use pickglass::design::Design;

use super::task::{Outcome, Running, left};
use super::toasts::Grade;
use super::{dialog, icons};
use crate::tokens::{self, Palette};
use crate::values;
use pickglass::still::{self, StillError, StillReport, StillRequest, Stop};
use pickglass::text::visible;

/// What became of an export.
pub enum Exported {
    Written(PathBuf, Box<StillReport>),
    Cancelled,
    Failed(String),
}

/// What the form starts with.
pub struct Defaults {
    pub width: u32,
    pub seconds: f64,
    /// `None` = named after the design.
    pub path: Option<PathBuf>,
}

impl Default for Defaults {
    fn default() -> Self {
        Self {
            width: 2560,
            seconds: 60.0,
            path: None,
        }
    }
}

/// The export form and the export under way.
#[derive(Default)]
pub struct Export {
    pub defaults: Defaults,
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

/// How far a picture is, in words.
fn refined(stop: &Stop, spp: u32, seconds: f64, error: Option<f64>) -> String {
    let share = match (stop.seconds, stop.spp, stop.error, error) {
        (Some(all), ..) => seconds / all,
        (None, Some(all), ..) => f64::from(spp) / f64::from(all.max(1)),
        // The error falls with the square root of the samples.
        (None, None, Some(wanted), Some(now)) => (wanted / now).powi(2),
        _ => 0.0,
    };
    let left = left(seconds, share.min(1.0));
    let error = error.map_or_else(String::new, |error| {
        format!(" · error {:.1} %", 100.0 * error)
    });
    format!("{spp} spp · {seconds:.0} s{error}{left}")
}

impl Export {
    /// Shows the form for the cloth as it is seen now.
    pub fn ask(&mut self, design: Arc<Design>, still: StillRequest) {
        if self.work.is_none() {
            self.form = Some(Form {
                path: match &self.defaults.path {
                    Some(path) => path.display().to_string(),
                    None => format!("{}.png", design.name.replace(['/', '\\'], "-")),
                },
                width: self.defaults.width,
                until: Until::Seconds,
                seconds: self.defaults.seconds,
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
        let mut choice = Choice::None;
        let modal = dialog::modal(ctx, "export").show(ctx, |ui| choice = form_ui(ui, form));
        if modal.should_close() {
            choice = Choice::Close;
        }
        match choice {
            Choice::None => {}
            Choice::Close => self.form = None,
            Choice::Browse => {
                (self.browse).ask(ctx, "Export a still", "Pictures", &["png", "exr"]);
            }
            Choice::Render => match values::picture_path(form.path.trim()) {
                Ok(path) => {
                    if let Some(form) = self.form.take() {
                        self.begin(ctx, form, path.0);
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
        let design = form.design;
        let work = Running::start(ctx, "export", move |job, teller| {
            let rendered = still::render_still(&design, &still, job, &mut |pass| {
                teller.tell(refined(&stop, pass.spp, pass.seconds, pass.error));
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

fn scaled_height(still: &StillRequest, width: u32) -> u32 {
    let aspect = f64::from(still.height) / f64::from(still.width.max(1));
    ((f64::from(width) * aspect).round() as u32).max(1)
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
            ui.add(
                DragValue::new(&mut form.width)
                    .range(16..=16_384)
                    .suffix(" px"),
            )
            .labelled_by(label.id);
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
                let field = ui.add_enabled(form.until == until, field);
                let spoken = format!("{name}, value");
                field.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::SpinButton, true, &spoken)
                });
                ui.end_row();
            }
            let label = ui.label("File");
            ui.horizontal(|ui| {
                ui.add(egui::TextEdit::singleline(&mut form.path))
                    .labelled_by(label.id);
                if ui.button("Browse…").clicked() {
                    choice = Choice::Browse;
                }
            });
            ui.end_row();
        });
    if let Some(wrong) = &form.wrong {
        ui.horizontal(|ui| {
            icons::show(ui, Grade::Error, palette.error);
            ui.label(RichText::new(format!("Error: {}", visible(wrong))).color(palette.error));
        });
    }
    ui.add_space(tokens::GAP);
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
        assert_eq!(refined(&seconds, 8, 15.0, None), "8 spp · 15 s · 45 s left");
        let samples = Stop {
            spp: Some(32),
            ..Stop::default()
        };
        assert_eq!(refined(&samples, 8, 15.0, None), "8 spp · 15 s · 45 s left");
        let error = Stop {
            error: Some(0.05),
            ..Stop::default()
        };
        // Half the error takes four times the samples.
        let told = refined(&error, 8, 15.0, Some(0.1));
        assert_eq!(told, "8 spp · 15 s · error 10.0 % · 45 s left");
        assert_eq!(refined(&error, 8, 15.0, None), "8 spp · 15 s");
    }
}
