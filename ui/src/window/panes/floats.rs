//! Floats: those longer than a limit, the longest first; a click looks at one.

use std::sync::Arc;

use egui::{DragValue, RichText, ScrollArea};
use pickglass::design::{FaceFloat, longest_floats};

use super::later::Later;
use super::{PaneView, Shown};
use crate::tokens::{self, Palette};
use crate::window::action::{Action, Mark};
use crate::window::typing;

/// Floats that are listed.
const MOST_LISTED: usize = 400;
/// A limit in threads that no cloth reaches.
const MOST_THREADS: u32 = 999;

/// The floats of a drawdown, longest first, and how many there are.
#[derive(Default)]
struct Found {
    floats: Vec<FaceFloat>,
    all: u64,
}

/// The list and its limit.
pub struct Floats {
    /// Threads that an end and a pick may pass over.
    limits: [u32; 2],
    in_mm: bool,
    found: Later<(u64, [u32; 2]), Found>,
}

impl Default for Floats {
    fn default() -> Self {
        Self {
            limits: [7, 7],
            in_mm: false,
            found: Later::default(),
        }
    }
}

impl PaneView for Floats {
    fn show(&mut self, ui: &mut egui::Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
        let document = shown.document;
        let quiet = Palette::current(ui).quiet;
        let design = document.design();
        // An end floats over picks, a pick over ends.
        let sett = design.sett();
        let pitch = [sett.picks.mean_pitch_mm(), sett.ends.mean_pitch_mm()];
        if self.limits_ui(ui, pitch) {
            actions.push(Action::Limits(self.limits));
        }
        let (limits, drawdown) = (self.limits, Arc::clone(document.drawdown()));
        let lattice = design.lattice();
        let question = (document.revision(), limits);
        self.found.ask(ui.ctx(), &question, move |job| {
            // What was cancelled is never shown.
            longest_floats(&drawdown, lattice, limits, MOST_LISTED, job)
                .map(|(floats, all)| Found { floats, all })
                .unwrap_or_default()
        });
        let Some(found) = self.found.answer() else {
            ui.label(RichText::new("Looking for floats…").color(quiet));
            return;
        };
        let working = if self.found.is_working() {
            " · looking again"
        } else {
            ""
        };
        if found.floats.is_empty() {
            ui.label(format!("No float is longer than the limit.{working}"));
            return;
        }
        let listed = found.floats.len();
        let more = if found.all > listed as u64 {
            format!(", the longest {listed} listed")
        } else {
            String::new()
        };
        let floats = if found.all == 1 { "float" } else { "floats" };
        let told = format!("{} long {floats}{more}{working}", found.all);
        ui.label(RichText::new(told).color(quiet));
        let row = ui.spacing().interact_size.y;
        ScrollArea::vertical()
            .auto_shrink(false)
            .show_rows(ui, row, listed, |ui, rows| {
                for float in &found.floats[rows] {
                    float_ui(ui, float, pitch, actions);
                }
            });
    }

    // Forgets what was found.
    fn forget(&mut self) {
        self.found = Later::default();
    }
}

#[cfg(test)]
impl Floats {
    pub fn with_limits(limits: [u32; 2]) -> Self {
        Self {
            limits,
            ..Self::default()
        }
    }
}

impl Floats {
    /// The limit in threads or mm; true when it was changed.
    fn limits_ui(&mut self, ui: &mut egui::Ui, pitch: [f32; 2]) -> bool {
        let before = self.limits;
        ui.horizontal_wrapped(|ui| {
            for (which, name) in ["Ends over", "Picks over"].into_iter().enumerate() {
                let label = ui.label(name);
                let limit = &mut self.limits[which];
                if self.in_mm {
                    let mut mm = *limit as f32 * pitch[which];
                    let field = DragValue::new(&mut mm)
                        .speed(0.1)
                        .range(0.05..=100.0)
                        .suffix(" mm");
                    if typing::number(ui, field).labelled_by(label.id).changed() {
                        *limit = ((mm / pitch[which]).round() as u32).clamp(1, MOST_THREADS);
                    }
                } else {
                    let field = DragValue::new(limit)
                        .range(1..=MOST_THREADS)
                        .suffix(" threads");
                    typing::number(ui, field).labelled_by(label.id);
                }
                ui.add_space(tokens::GAP);
            }
            ui.checkbox(&mut self.in_mm, "in mm");
        });
        before != self.limits
    }
}

/// One float, from its first end and pick.
fn float_ui(ui: &mut egui::Ui, float: &FaceFloat, pitch: [f32; 2], actions: &mut Vec<Action>) {
    let end = float.end + 1;
    let (what, thread, mm) = if float.warp {
        ("End", end, float.length as f32 * pitch[0])
    } else {
        ("Pick", float.pick + 1, float.length as f32 * pitch[1])
    };
    let text = format!(
        "{what} {thread} over {} ({mm:.1} mm), from end {end}, pick {}",
        float.length,
        float.pick + 1
    );
    let response = ui.selectable_label(false, text);
    let home = |at: i64| u32::try_from(at).unwrap_or(0);
    let (ends, picks) = if float.warp {
        (1, float.length)
    } else {
        (float.length, 1)
    };
    if response.hovered() || response.has_focus() {
        actions.push(Action::Mark(Mark::Float {
            end: home(float.end),
            pick: home(float.pick),
            ends,
            picks,
        }));
    }
    if response.clicked() {
        actions.push(Action::LookAt {
            end: float.end + i64::from(ends) / 2,
            pick: float.pick + i64::from(picks) / 2,
        });
    }
}
