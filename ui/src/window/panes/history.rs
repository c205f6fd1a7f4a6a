//! The history: every gesture by name; a click goes back to it.

use egui::{RichText, ScrollArea};
use pickglass::text::visible;

use super::{PaneView, Shown};
use crate::tokens::Palette;
use crate::window::action::Action;

/// The list.
#[derive(Default)]
pub struct History {
    shown: Option<usize>,
}

impl PaneView for History {
    fn show(&mut self, ui: &mut egui::Ui, shown: &Shown<'_>, actions: &mut Vec<Action>) {
        let document = shown.document;
        let quiet = Palette::current(ui).quiet;
        let (entries, present) = (document.entries(), document.position());
        let megabytes = document.history_bytes() as f64 / f64::from(1 << 20);
        let past = match entries.len() {
            1 => format!("1 entry · {megabytes:.1} MB kept"),
            count => format!("{count} entries · {megabytes:.1} MB kept"),
        };
        ui.label(RichText::new(past).small().color(quiet));
        let moved = self.shown != Some(present);
        self.shown = Some(present);
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for (place, entry) in entries.iter().enumerate() {
                let mut text = RichText::new(format!("{} {}", place + 1, visible(entry.name())));
                if place > present {
                    text = text.color(quiet).italics();
                }
                let response = ui.selectable_label(place == present, text);
                let tip = if place > present {
                    "Taken back: click to do it again, up to here"
                } else {
                    "Click to go back to here"
                };
                let response = response.on_hover_text(tip);
                if response.clicked() && place != present {
                    actions.push(Action::GoTo(place));
                }
                if place == present && moved {
                    response.scroll_to_me(None);
                }
            }
        });
    }
}
