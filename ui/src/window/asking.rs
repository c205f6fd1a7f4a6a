//! Questions that must be answered before something goes on: unsaved work, a drawdown that
//! follows from a draft, a new size. One at a time, each with the least harmful answer
//! first.

use std::path::PathBuf;

use egui::{DragValue, Id, Modal, RichText};
use pickglass::design::MAX_CROSSINGS;
use pickglass::edit::{Document, Edit};

use crate::tokens::{self, Palette};

/// What follows when the open design may be left.
#[derive(Debug, Clone, PartialEq)]
pub enum Next {
    Close,
    Start,
    New,
    Preset(&'static str),
    File(PathBuf),
    /// The system's dialog, or the field for a path.
    Ask,
    AskPath,
}

/// A question.
enum Question {
    /// Unsaved work would be lost.
    Unsaved(Next),
    /// An edit was refused; other edits that would do it.
    Refused { why: String, remedies: Vec<Edit> },
    /// How many ends and picks.
    Size { ends: u32, picks: u32 },
}

/// An answer.
pub enum Answer {
    /// Save, then go on.
    Save(Next),
    /// Leave the design as it is and go on.
    Discard(Next),
    /// Do this instead of what was refused, and from now on without asking if `always`.
    Instead { edit: Edit, always: bool },
    /// An edit from a form.
    Edit(Edit),
}

/// The question that is asked, and what waits for a save.
#[derive(Default)]
pub struct Asking {
    question: Option<Question>,
    /// Goes on once the design is saved.
    pub after_save: Option<Next>,
    /// Edits of a draft's drawdown derive the draft again without a question.
    pub derive_always: bool,
}

impl Asking {
    /// Asks whether unsaved work is to be saved.
    pub fn about_unsaved(&mut self, next: Next) {
        self.question = Some(Question::Unsaved(next));
    }

    /// Offers what can be done instead of an edit that was refused.
    pub fn about_refused(&mut self, why: String, remedies: Vec<Edit>) {
        self.question = Some(Question::Refused { why, remedies });
    }

    /// Asks for a size.
    pub fn about_size(&mut self, document: &Document) {
        let design = document.design();
        self.question = Some(Question::Size {
            ends: design.ends(),
            picks: design.picks(),
        });
    }

    /// Shows the question; returns the answer.
    pub fn show(&mut self, ctx: &egui::Context, name: &str) -> Option<Answer> {
        let question = self.question.as_mut()?;
        let mut answer = None;
        let mut close = false;
        let modal = Modal::new(Id::unique("question")).show(ctx, |ui| {
            ui.set_width(tokens::TOAST_WIDTH);
            match question {
                Question::Unsaved(next) => unsaved_ui(ui, name, next, &mut answer, &mut close),
                Question::Refused { why, remedies } => {
                    refused_ui(ui, why, remedies, &mut answer, &mut close);
                }
                Question::Size { ends, picks } => {
                    size_ui(ui, ends, picks, &mut answer, &mut close);
                }
            }
        });
        if answer.is_some() || close || modal.should_close() {
            self.question = None;
        }
        answer
    }
}

fn heading(ui: &mut egui::Ui, text: &str) {
    ui.label(RichText::new(text).text_style(egui::TextStyle::Heading));
    ui.add_space(tokens::GRID);
}

fn unsaved_ui(
    ui: &mut egui::Ui,
    name: &str,
    next: &Next,
    answer: &mut Option<Answer>,
    close: &mut bool,
) {
    heading(ui, "Save the changes?");
    ui.label(format!("{name} has changes that are in no file yet."));
    ui.add_space(tokens::PAD);
    ui.horizontal(|ui| {
        let save = ui.button("Save");
        save.request_focus();
        if save.clicked() {
            *answer = Some(Answer::Save(next.clone()));
        }
        if ui.button("Do not save").clicked() {
            *answer = Some(Answer::Discard(next.clone()));
        }
        *close |= ui.button("Cancel").clicked();
    });
}

fn refused_ui(
    ui: &mut egui::Ui,
    why: &str,
    remedies: &mut Vec<Edit>,
    answer: &mut Option<Answer>,
    close: &mut bool,
) {
    heading(ui, "The drawdown follows from the draft");
    ui.label(why);
    ui.add_space(tokens::PAD);
    let mut chosen = None;
    for (index, edit) in remedies.iter().enumerate() {
        let (label, tip) = match edit {
            Edit::DeriveDraft { .. } => (
                "Derive the draft again, now and after each stroke",
                "Threading, tie-up and treadling are worked out from the drawdown",
            ),
            Edit::BecomeJacquard { .. } => (
                "Become a jacquard",
                "Every crossing is free; threading and tie-up are let go",
            ),
            other => (other.name(), ""),
        };
        if ui.button(label).on_hover_text(tip).clicked() {
            chosen = Some(index);
        }
    }
    *close |= ui.button("Cancel").clicked();
    if let Some(index) = chosen {
        let edit = remedies.swap_remove(index);
        let always = matches!(edit, Edit::DeriveDraft { .. });
        *answer = Some(Answer::Instead { edit, always });
    }
}

fn size_ui(
    ui: &mut egui::Ui,
    ends: &mut u32,
    picks: &mut u32,
    answer: &mut Option<Answer>,
    close: &mut bool,
) {
    heading(ui, "Resize");
    let quiet = Palette::current(ui).quiet;
    ui.label(
        RichText::new("The design repeats into what is new; the rest is cut off.").color(quiet),
    );
    ui.add_space(tokens::GAP);
    egui::Grid::new("size").num_columns(2).show(ui, |ui| {
        for (name, count) in [("Ends", &mut *ends), ("Picks", &mut *picks)] {
            let label = ui.label(name);
            ui.add(DragValue::new(count).range(1..=65_535))
                .labelled_by(label.id);
            ui.end_row();
        }
    });
    let crossings = u64::from(*ends) * u64::from(*picks);
    let fits = crossings <= MAX_CROSSINGS;
    if !fits {
        let error = Palette::current(ui).error;
        let text = format!("Error: {crossings} crossings; the most is {MAX_CROSSINGS}.");
        ui.label(RichText::new(text).color(error));
    }
    ui.add_space(tokens::PAD);
    ui.horizontal(|ui| {
        if ui.add_enabled(fits, egui::Button::new("Resize")).clicked() {
            *answer = Some(Answer::Edit(Edit::Resize {
                ends: *ends,
                picks: *picks,
            }));
        }
        *close |= ui.button("Cancel").clicked();
    });
}
