//! The log: everything the program said, the newest last.

use egui::{RichText, ScrollArea};
use pickglass::text::visible;

use super::{PaneView, Shown};
use crate::tokens::Palette;
use crate::window::action::Action;

use crate::window::toasts::Grade;

/// The most lines that are kept.
const MOST: usize = 500;

/// The lines of the log.
#[derive(Default)]
pub struct Log(std::collections::VecDeque<(Grade, String)>);

impl PaneView for Log {
    fn show(&mut self, ui: &mut egui::Ui, _: &Shown<'_>, _: &mut Vec<Action>) {
        if self.0.is_empty() {
            let quiet = Palette::current(ui).quiet;
            ui.label(RichText::new("Nothing to tell yet: messages are kept here.").color(quiet));
        }
        ScrollArea::vertical().stick_to_bottom(true).show(ui, |ui| {
            for (grade, line) in &self.0 {
                ui.label(format!("{}: {line}", grade.word()));
            }
        });
    }
}

impl Log {
    /// Adds what was said.
    pub fn add(&mut self, grade: Grade, text: &str, kept: &str) {
        let line = format!("{text} {kept}");
        self.0
            .push_back((grade, visible(line.trim_end()).into_owned()));
        if self.0.len() > MOST {
            self.0.pop_front();
        }
    }
}
