//! Messages: what happened and what was kept. Errors stay until they are dismissed.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use pickglass::text::visible;

use egui::{Align2, Area, Frame, Id, Label, Order, RichText, Stroke, vec2};

use super::icons;
use crate::tokens::{self, Palette};

/// How grave a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grade {
    Done,
    Warning,
    Error,
}

impl Grade {
    /// The word that stands before a message.
    pub fn word(self) -> &'static str {
        match self {
            Self::Done => "Done",
            Self::Warning => "Warning",
            Self::Error => "Error",
        }
    }
}

struct Toast {
    grade: Grade,
    text: String,
    kept: String,
    until: Option<Instant>,
    /// A file that came of it.
    made: Option<PathBuf>,
}

/// The messages on the screen.
#[derive(Default)]
pub struct Toasts(Vec<Toast>);

/// How long a message that needs no answer stays.
const STAY: Duration = Duration::from_secs(6);
/// More messages than this push out the oldest.
const MOST: usize = 4;

impl Toasts {
    /// Says what happened and, where something might have been lost, what was kept.
    pub fn say(&mut self, grade: Grade, text: impl Into<String>, kept: impl Into<String>) {
        let text = visible(&text.into()).into_owned();
        self.0.retain(|toast| toast.text != text);
        self.0.push(Toast {
            grade,
            text,
            kept: visible(&kept.into()).into_owned(),
            until: (grade == Grade::Done).then(|| Instant::now() + STAY),
            made: None,
        });
        if self.0.len() > MOST {
            self.0.remove(0);
        }
    }

    /// Lets the newest message show a file that came of the work.
    pub fn made(&mut self, path: &Path) {
        if let Some(toast) = self.0.last_mut() {
            toast.made = Some(path.to_owned());
        }
    }

    /// Shows the messages above `bottom_right`.
    pub fn show(&mut self, ctx: &egui::Context, bottom_right: egui::Pos2) {
        let now = Instant::now();
        self.0
            .retain(|toast| toast.until.is_none_or(|until| now < until));
        if let Some(next) = self.0.iter().filter_map(|toast| toast.until).min() {
            ctx.request_repaint_after(next.saturating_duration_since(now));
        }
        if self.0.is_empty() {
            return;
        }
        Area::new(Id::unique("toasts"))
            .order(Order::Foreground)
            .pivot(Align2::RIGHT_BOTTOM)
            .fixed_pos(bottom_right - vec2(tokens::PAD, tokens::PAD))
            .show(ctx, |ui| {
                ui.set_width(tokens::TOAST_WIDTH);
                self.0.retain(|toast| !toast_ui(ui, toast));
            });
    }
}

/// Opens a file with the program that the system has for it; a failure is a line in the log.
fn open_with_system(path: &Path) {
    let program = if cfg!(target_os = "macos") {
        "open"
    } else if cfg!(target_os = "windows") {
        "explorer"
    } else {
        "xdg-open"
    };
    let started = std::process::Command::new(program)
        .arg(path)
        .stdin(std::process::Stdio::null())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn();
    match started {
        // Somebody has to wait for it, so that nothing is left of it once it ends.
        Ok(mut child) => drop(std::thread::spawn(move || child.wait())),
        Err(error) => log::warn!("{program} {}: {error}", path.display()),
    }
}

/// Shows one message; true when it was dismissed.
fn toast_ui(ui: &mut egui::Ui, toast: &Toast) -> bool {
    let palette = Palette::current(ui);
    let word = toast.grade.word();
    let colour = match toast.grade {
        Grade::Done => palette.text,
        Grade::Warning => palette.warning,
        Grade::Error => palette.error,
    };
    let mut dismissed = false;
    Frame::new()
        .fill(palette.raised)
        .stroke(Stroke::new(1.0, colour))
        .corner_radius(tokens::RADIUS)
        .inner_margin(tokens::PAD)
        .show(ui, |ui| {
            ui.horizontal(|ui| {
                icons::show(ui, toast.grade, colour);
                ui.label(RichText::new(word).color(colour).strong());
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    dismissed = ui.small_button("Dismiss").clicked();
                    if let Some(made) = &toast.made {
                        let show = ui.small_button("Show");
                        if show
                            .on_hover_text("Open it with the system's program")
                            .clicked()
                        {
                            open_with_system(made);
                        }
                    }
                });
            });
            ui.add(Label::new(&toast.text).wrap().selectable(true));
            if !toast.kept.is_empty() {
                ui.add(Label::new(RichText::new(&toast.kept).color(palette.quiet)).wrap());
            }
        });
    dismissed
}
