//! Questions that must be answered before something goes on: unsaved work, a drawdown that
//! follows from a draft, the forms of the weave menu. One at a time, each with the least harmful answer
//! first.

use std::path::PathBuf;

use egui::RichText;
use pickglass::design::WeavePattern;
use pickglass::edit::Edit;

use super::dialog;
use super::forms::{Filled, Form};
use crate::tokens;

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
    /// A form of the weave menu.
    Form(Form),
}

/// An answer.
pub enum Answer {
    /// Save, then go on.
    Save(Next),
    /// Leave the design as it is and go on.
    Discard(Next),
    /// Do this instead of what was refused, and from now on without asking if `always`.
    Instead { edit: Edit, always: bool },
    /// What a form came to: the entry of the history, and its edits.
    Filled(&'static str, Vec<Edit>),
    /// A weave to stamp.
    Stamp(WeavePattern),
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

    /// Shows a form.
    pub fn fill_in(&mut self, form: Form) {
        self.question = Some(Question::Form(form));
    }

    /// Shows the question; returns the answer.
    pub fn show(&mut self, ctx: &egui::Context, name: &str) -> Option<Answer> {
        let question = self.question.as_mut()?;
        let mut answer = None;
        let mut close = false;
        let shown = dialog::show(ctx, "question", |ui| {
            ui.set_width(tokens::TOAST_WIDTH);
            match question {
                Question::Unsaved(next) => unsaved_ui(ui, name, next, &mut answer, &mut close),
                Question::Refused { why, remedies } => {
                    refused_ui(ui, why, remedies, &mut answer, &mut close);
                }
                Question::Form(form) => match form.show(ui) {
                    Filled::Open => {}
                    Filled::Closed => close = true,
                    Filled::Done(name, edits) => answer = Some(Answer::Filled(name, edits)),
                    Filled::Stamp(weave) => answer = Some(Answer::Stamp(weave)),
                },
            }
        });
        if answer.is_some() || close || shown.escaped {
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
