//! The settings that are asked for in a form: the room that built exemplars may take on the
//! disk.

use egui::{Context, DragValue, RichText};
use pickglass::exemplar::{ExemplarStore, LIMITS, USUAL_LIMIT};
use pickglass::formats::volume::bytes_in_words;

use super::{dialog, typing};
use crate::tokens::{self, Palette};

/// Bytes of a GB.
const GB: f64 = 1e9;

/// The open form.
pub struct SettingsForm {
    store: ExemplarStore,
    /// Bytes that exemplars take now.
    size: u64,
    limit_gb: f64,
    wrong: Option<String>,
}

enum Choice {
    Empty,
    Apply,
    Close,
}

impl SettingsForm {
    /// The form of a store as it is now.
    pub fn new(store: &ExemplarStore) -> Self {
        Self {
            size: store.size(),
            limit_gb: store.limit() as f64 / GB,
            store: store.clone(),
            wrong: None,
        }
    }

    /// Shows the form; whether it stays open.
    pub fn show(&mut self, ctx: &Context) -> bool {
        let shown = dialog::show(ctx, "settings", |ui| self.ui(ui));
        let mut open = !shown.escaped;
        match shown.inner {
            Some(Choice::Empty) => {
                let emptied = self.store.empty();
                self.wrong = emptied.err().map(|error| self.failed(&error));
                self.size = self.store.size();
            }
            Some(Choice::Apply) => {
                let set = self.store.set_limit((self.limit_gb * GB) as u64);
                self.wrong = set.err().map(|error| self.failed(&error));
                open &= self.wrong.is_some();
            }
            Some(Choice::Close) => open = false,
            None => {}
        }
        open
    }

    fn failed(&self, error: &std::io::Error) -> String {
        let folder = self.store.folder().unwrap_or_else(|| "".as_ref());
        format!(
            "{}: {error}; check that you may write there",
            folder.display()
        )
    }

    fn ui(&mut self, ui: &mut egui::Ui) -> Option<Choice> {
        ui.set_width(tokens::TOAST_WIDTH);
        let quiet = Palette::current(ui).quiet;
        let mut choice = None;
        ui.label(RichText::new("Settings").text_style(egui::TextStyle::Heading));
        ui.label(RichText::new("Exemplars kept on the disk").strong());
        let what = "Voxels of yarns that were built once, so that cloth of the same yarns is there \
                    sooner. Beyond the limit those used least recently give way.";
        ui.label(RichText::new(what).color(quiet));
        if let Some(folder) = self.store.folder() {
            let folder = RichText::new(folder.display().to_string()).color(quiet);
            ui.add(egui::Label::new(folder.small()).truncate());
        }
        ui.add_space(tokens::GAP);
        egui::Grid::new("settings").num_columns(2).show(ui, |ui| {
            ui.label("Now");
            ui.horizontal(|ui| {
                ui.label(bytes_in_words(self.size));
                let empty = ui.add_enabled(self.size > 0, egui::Button::new("Empty"));
                let tip = "Remove all of them; what is needed is built again";
                if empty.on_hover_text(tip).clicked() {
                    choice = Some(Choice::Empty);
                }
            });
            ui.end_row();
            let label = ui.label("At most");
            let range = (*LIMITS.start() as f64 / GB)..=(*LIMITS.end() as f64 / GB);
            let field = DragValue::new(&mut self.limit_gb)
                .range(range)
                .speed(0.02)
                .max_decimals(1)
                .suffix(" GB");
            let tip = format!("Usually {}", bytes_in_words(USUAL_LIMIT));
            typing::number(ui, field)
                .labelled_by(label.id)
                .on_hover_text(tip);
            ui.end_row();
        });
        dialog::problem(ui, self.wrong.as_deref());
        ui.horizontal(|ui| {
            if ui.button("Apply").clicked() {
                choice = Some(Choice::Apply);
            }
            if ui.button("Cancel").clicked() {
                choice = Some(Choice::Close);
            }
        });
        choice
    }
}
