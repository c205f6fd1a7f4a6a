//! Hard cases tried on this machine, and how each went.

use std::sync::{Arc, Mutex, PoisonError};

use egui::{Context, Grid, Label, RichText, ScrollArea, Ui};
use pickglass::job::Job;
use pickglass::selftest::{self, SelftestError, Verdict};
use pickglass::text::visible;

use super::task::{Outcome, Running};
use super::{dialog, icons, toasts::Grade};
use crate::tokens::{self, Palette};

/// The open form. Closing it ends the work.
pub struct MachineCheck {
    verdicts: Arc<Mutex<Vec<Verdict>>>,
    running: Option<Running<Result<(), SelftestError>>>,
    wrong: Option<String>,
}

impl MachineCheck {
    /// Tries all cases from now on.
    pub fn start(ctx: &Context) -> Self {
        let verdicts: Arc<Mutex<Vec<Verdict>>> = Arc::default();
        let kept = Arc::clone(&verdicts);
        let running = Running::start(ctx, "hard cases", move |job: &Job, _| {
            selftest::run(&[], job, &mut |verdict| {
                let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
                kept.push(verdict.clone());
            })
            .map(drop)
        });
        let (running, wrong) = match running {
            Ok(running) => (Some(running), None),
            Err(error) => (None, Some(format!("no thread to try them on: {error}"))),
        };
        Self {
            verdicts,
            running,
            wrong,
        }
    }

    /// Shows the form; whether it stays open.
    pub fn show(&mut self, ctx: &Context) -> bool {
        self.poll();
        let mut open = true;
        let shown = dialog::show(ctx, "machine check", |ui| {
            ui.set_width(2.0 * tokens::TOAST_WIDTH);
            ui.label(RichText::new("Hard cases on this machine").text_style(tokens::title()));
            let quiet = Palette::current(ui).quiet;
            let what = "Pictures, designs and files that are hard to get right: whether they come \
                        out here as they should.";
            ui.label(RichText::new(what).color(quiet));
            ui.add_space(tokens::GAP);
            self.list_ui(ui);
            self.outcome_ui(ui);
            ui.horizontal(|ui| {
                let some = !self.verdicts().is_empty();
                let copy = ui.add_enabled(some, egui::Button::new("Copy"));
                if copy.on_hover_text("The table, for a report").clicked() {
                    ui.ctx().copy_text(table(&self.verdicts()));
                }
                if ui.button("Close").clicked() {
                    open = false;
                }
            });
        });
        open && !shown.escaped
    }

    fn verdicts(&self) -> std::sync::MutexGuard<'_, Vec<Verdict>> {
        self.verdicts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn poll(&mut self) {
        let Some(running) = &self.running else { return };
        match running.poll() {
            Outcome::Working => return,
            Outcome::Ready(done) => self.wrong = done.err().map(|error| error.to_string()),
            Outcome::Lost => self.wrong = Some("the cases ended before all were tried".to_owned()),
        }
        self.running = None;
    }

    fn list_ui(&self, ui: &mut Ui) {
        let room = (ui.ctx().content_rect().height() - 24.0 * tokens::PAD).max(tokens::LIST_HEIGHT);
        let palette = Palette::current(ui);
        ScrollArea::vertical()
            .max_height(room.min(80.0 * tokens::GRID))
            .auto_shrink([false, false])
            .stick_to_bottom(true)
            .show(ui, |ui| {
                Grid::new("hard cases").num_columns(3).show(ui, |ui| {
                    for verdict in self.verdicts().iter() {
                        let (grade, colour, seen) = match &verdict.seen {
                            Ok(seen) => (Grade::Done, palette.quiet, seen),
                            Err(wrong) => (Grade::Error, palette.error, wrong),
                        };
                        icons::show(ui, grade, colour);
                        ui.label(&verdict.name).on_hover_text(verdict.about);
                        let seen = RichText::new(visible(seen)).color(colour);
                        ui.add(Label::new(seen).truncate());
                        ui.end_row();
                    }
                });
            });
    }

    /// What is being tried, or what came of all.
    fn outcome_ui(&self, ui: &mut Ui) {
        if let Some(running) = &self.running {
            ui.label(running.progress());
            return;
        }
        let wrong = self.wrong.clone().or_else(|| {
            let verdicts = self.verdicts();
            let failed = verdicts.iter().filter(|verdict| verdict.seen.is_err());
            match failed.count() {
                0 => None,
                failed => Some(format!(
                    "{failed} of {} do not hold here: please report them, with this table",
                    verdicts.len()
                )),
            }
        });
        match &wrong {
            Some(wrong) => dialog::problem(ui, Some(wrong)),
            None => {
                ui.label(format!(
                    "All {} hold on this machine",
                    self.verdicts().len()
                ));
            }
        }
    }
}

/// The table in words, a line a case.
fn table(verdicts: &[Verdict]) -> String {
    let line = |verdict: &Verdict| match &verdict.seen {
        Ok(seen) => format!("ok      {}: {seen}", verdict.name),
        Err(wrong) => format!("FAILED  {}: {wrong}", verdict.name),
    };
    let version = format!("Pickglass {}", env!("CARGO_PKG_VERSION"));
    let lines: Vec<String> = std::iter::once(version)
        .chain(verdicts.iter().map(line))
        .collect();
    lines.join("\n")
}
