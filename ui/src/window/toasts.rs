//! Messages: what happened and what was kept. Success and notes pass by themselves; warnings
//! and errors stay until they are dismissed.

use std::path::{Path, PathBuf};
use std::time::Duration;

use pickglass::text::visible;

use egui::{Align2, Area, Frame, Id, Label, Order, RichText, Stroke, vec2};

use super::icons;
use crate::tokens::{self, Palette};

/// How grave a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grade {
    /// Nothing happened, and why.
    Note,
    Done,
    Warning,
    Error,
}

impl Grade {
    /// The word that stands before a message.
    pub fn word(self) -> &'static str {
        match self {
            Self::Note => "Note",
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
    /// When it was seen first, or the pointer was on it last, s of the window's clock.
    seen: Option<f64>,
    /// A file that came of it.
    made: Option<PathBuf>,
}

/// The messages on the screen.
#[derive(Default)]
pub struct Toasts(Vec<Toast>);

/// How long a message that needs no answer stays, s.
const STAY: f64 = 6.0;
/// More messages than this push out the oldest of the least grave; the log has them all.
const MOST: usize = 4;

impl Toast {
    /// Seconds until it passes by itself; `None` = never.
    fn left(&self, now: f64) -> Option<f64> {
        let passes = matches!(self.grade, Grade::Note | Grade::Done);
        passes.then(|| STAY - (now - self.seen.unwrap_or(now)))
    }
}

impl Toasts {
    /// Says what happened and, where something might have been lost, what was kept.
    pub fn say(&mut self, grade: Grade, text: impl Into<String>, kept: impl Into<String>) {
        let text = visible(&text.into()).into_owned();
        self.0.retain(|toast| toast.text != text);
        self.0.push(Toast {
            grade,
            text,
            kept: visible(&kept.into()).into_owned(),
            seen: None,
            made: None,
        });
        let least = [Grade::Note, Grade::Done, Grade::Warning, Grade::Error].into_iter();
        let place = |grade: Grade| self.0.iter().position(|toast| toast.grade == grade);
        if self.0.len() > MOST
            && let Some(oldest) = least.filter_map(place).next()
        {
            self.0.remove(oldest);
        }
    }

    /// Puts away what was said of a design that is not open any more; what went wrong stays.
    pub fn leave_design(&mut self) {
        self.0.retain(|toast| toast.grade == Grade::Error);
    }

    /// Lets the newest message show a file that came of the work.
    pub fn made(&mut self, path: &Path) {
        if let Some(toast) = self.0.last_mut() {
            toast.made = Some(path.to_owned());
        }
    }

    /// Shows the messages above `bottom_right`.
    pub fn show(&mut self, ctx: &egui::Context, bottom_right: egui::Pos2) {
        let now = ctx.input(|input| input.time);
        for toast in &mut self.0 {
            toast.seen.get_or_insert(now);
        }
        self.0
            .retain(|toast| toast.left(now).is_none_or(|left| left > 0.0));
        let next = self.0.iter().filter_map(|toast| toast.left(now));
        if let Some(next) = next.reduce(f64::min) {
            ctx.request_repaint_after(Duration::from_secs_f64(next.clamp(0.0, STAY)));
        }
        if self.0.is_empty() {
            return;
        }
        let area = Area::new(Id::unique("toasts"))
            .order(Order::Foreground)
            .pivot(Align2::RIGHT_BOTTOM)
            .fixed_pos(bottom_right - vec2(tokens::PAD, tokens::PAD))
            .show(ctx, |ui| {
                ui.set_width(tokens::TOAST_WIDTH);
                self.0.retain(|toast| !toast_ui(ui, toast));
            });
        // Nobody loses what he is reading.
        if area.response.contains_pointer() {
            self.0.iter_mut().for_each(|toast| toast.seen = Some(now));
        }
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
        Grade::Note | Grade::Done => palette.text,
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What is left after the window's clock went on to `time`.
    fn after(toasts: &mut Toasts, ctx: &egui::Context, time: f64) -> Vec<String> {
        let input = egui::RawInput {
            time: Some(time),
            ..Default::default()
        };
        let _ = ctx.run_ui(input, |ui| {
            let corner = ui.ctx().content_rect().right_bottom();
            toasts.show(&ui.ctx().clone(), corner);
        });
        toasts.0.iter().map(|toast| toast.text.clone()).collect()
    }

    #[test]
    fn success_passes_by_itself_and_what_went_wrong_stays() {
        let ctx = egui::Context::default();
        let mut toasts = Toasts::default();
        toasts.say(Grade::Note, "nothing selected", "");
        toasts.say(Grade::Done, "saved", "");
        toasts.say(Grade::Warning, "cut", "");
        toasts.say(Grade::Error, "lost", "");
        let all = ["nothing selected", "saved", "cut", "lost"];
        assert_eq!(after(&mut toasts, &ctx, 10.0), all);
        assert_eq!(after(&mut toasts, &ctx, 10.0 + STAY - 0.5).len(), 4);
        assert_eq!(after(&mut toasts, &ctx, 10.5 + STAY), ["cut", "lost"]);
        assert_eq!(after(&mut toasts, &ctx, 1e4), ["cut", "lost"]);
    }

    #[test]
    fn what_was_said_of_a_design_goes_with_it() {
        let ctx = egui::Context::default();
        let mut toasts = Toasts::default();
        toasts.say(Grade::Done, "saved", "");
        toasts.say(Grade::Warning, "a sett was assumed", "");
        toasts.say(Grade::Error, "lost", "");
        toasts.leave_design();
        toasts.say(Grade::Warning, "the next one's", "");
        assert_eq!(after(&mut toasts, &ctx, 1.0), ["lost", "the next one's"]);
    }

    #[test]
    fn the_gravest_are_pushed_out_last() {
        let mut toasts = Toasts::default();
        toasts.say(Grade::Error, "lost", "");
        toasts.say(Grade::Warning, "cut", "");
        for number in 0..MOST {
            toasts.say(Grade::Done, format!("saved {number}"), "");
        }
        let texts: Vec<&str> = toasts.0.iter().map(|toast| toast.text.as_str()).collect();
        assert_eq!(texts, ["lost", "cut", "saved 2", "saved 3"]);
    }
}
