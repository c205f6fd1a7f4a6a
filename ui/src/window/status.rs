//! The status line: what is shown, how good it is, and what is under way.

use std::time::Duration;

use egui::{ProgressBar, RichText};
use pickglass::design::Design;

use super::cloth_pane::Shown;
use super::icons;
use super::toasts::Grade;
use super::worker::{Building, Done, Fibres, LONGEST, Phase, Quality};
use crate::tokens::{self, Palette};

/// What the status line tells of.
pub struct Status<'s> {
    pub design: Option<&'s Design>,
    pub shown: Option<&'s Shown>,
    /// Says when it will be how good, and how good such forecasts were.
    pub foretold: &'s dyn Fn() -> Vec<String>,
    pub phase: &'s Phase,
    pub building: Option<Building>,
    pub paused: bool,
    /// Seconds since the picture was asked for, while it is at work.
    pub working: Option<f64>,
    /// Refining waits to be seen.
    pub hidden: bool,
    /// A pane measures how long things take.
    pub measuring: bool,
    pub quality: Quality,
    pub export: Option<String>,
    /// The file that is being read or written, in words.
    pub files: Option<String>,
    /// The crossing under the pointer, in words.
    pub crossing: Option<&'s str>,
    /// The tool in use.
    pub tool: &'s str,
}

/// What the person wants ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cancel {
    Preview,
    Export,
}

/// Shows the line; returns what was cancelled.
pub fn show(ui: &mut egui::Ui, status: &Status<'_>) -> Option<Cancel> {
    let mut cancel = None;
    let quiet = Palette::current(ui).quiet;
    ui.horizontal_centered(|ui| {
        if let Some(design) = status.design {
            let (ends, picks) = (design.ends(), design.picks());
            ui.label(format!("{ends} ends × {picks} picks"));
            ui.label(RichText::new(status.tool).color(quiet));
        }
        if let Some(crossing) = status.crossing {
            ui.label(crossing);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if let Some(files) = &status.files {
                ui.label(files);
                ui.spinner();
                ui.separator();
            }
            if let Some(progress) = &status.export {
                if ui.small_button("Cancel export").clicked() {
                    cancel = Some(Cancel::Export);
                }
                ui.label(format!("Exporting: {progress}"));
                ui.separator();
            }
            if preview_ui(ui, status) {
                cancel = Some(Cancel::Preview);
            }
        });
    });
    cancel
}

/// The right end, laid out from right to left; true when its button was clicked.
fn preview_ui(ui: &mut egui::Ui, status: &Status<'_>) -> bool {
    let palette = Palette::current(ui);
    let mut cancelled = false;
    if let Some(Building { stage, fraction }) = &status.building {
        cancelled = ui.small_button("Cancel").clicked();
        ui.add(
            ProgressBar::new(*fraction)
                .fill(tokens::ACCENT)
                .desired_width(tokens::SCALE_BAR)
                .desired_height(tokens::GAP),
        );
        ui.label(stage);
        ui.separator();
    }
    if let Phase::Failed(_) = status.phase {
        ui.label(RichText::new("Error: not drawn").color(palette.error));
        icons::show(ui, Grade::Error, palette.error);
    } else if let Phase::AtSight(why) = status.phase {
        ui.label("First sight · look closer to refine")
            .on_hover_text(why);
    } else if let Some(shown) = status.shown {
        let about = "The error is that of single pixels before denoising. What is shown is \
                     denoised, and of squares of 4 × 4 pixels the error is a quarter.";
        ui.label(quality(shown, status)).on_hover_ui(|ui| {
            let foretold = (status.foretold)();
            let about = std::iter::once(about.to_owned()).chain(foretold);
            ui.label(about.collect::<Vec<_>>().join("\n\n"));
        });
        if status.working.is_some() {
            // Something moves, however long the next picture takes.
            ui.ctx().request_repaint_after(Duration::from_secs(1));
        }
    }
    cancelled
}

fn quality(shown: &Shown, status: &Status<'_>) -> String {
    let error = shown.error.map_or_else(String::new, |error| {
        format!(" · error {:.1} %", error * 100.0)
    });
    let state = match (status.phase, shown.fibres) {
        _ if status.paused => " · paused".to_owned(),
        (Phase::Stopped, _) => " · stopped".to_owned(),
        (Phase::Done(Done::Good), _) => format!(" · done: {}", status.quality.name()),
        (Phase::Done(Done::Long), _) => format!(" · done: {:.0} minutes", LONGEST / 60.0),
        (Phase::Done(Done::Waiting), _) => " · first sight".to_owned(),
        _ if status.measuring => " · waits while times are measured".to_owned(),
        _ if status.hidden => " · waits while hidden".to_owned(),
        (_, Fibres::Coarse { light_error }) => {
            let light = light_error.map_or_else(String::new, |error| {
                format!(", light ±{:.1} %", error * 100.0)
            });
            format!(" · coarse fibres{light}")
        }
        _ if !shown.full_size => " · coarse".to_owned(),
        _ => String::new(),
    };
    let seconds = match status.working {
        Some(seconds) => format!("{seconds:.0} s"),
        None => format!("{:.1} s", shown.seconds),
    };
    match shown.spp {
        0 if status.working.is_some() => format!("first sight · refining for {seconds}"),
        spp => format!("{spp} spp · {seconds}{error}{state}"),
    }
}
