//! What the actions of the panes do: the one place where the document changes.

use pickglass::edit::{Change, Edit, EditError, moved};

use super::action::{Action, Button, Mark};
use super::app::App;
use super::draft::HeldBack;
use super::panes::Pane;
use super::session::Session;
use super::toasts::Grade;

impl App {
    /// Does what the panes asked for, in order.
    pub(super) fn act(&mut self, ctx: &egui::Context, actions: Vec<Action>) {
        let before = (self.hover.take(), self.draft.mark);
        self.draft.mark = Mark::Nothing;
        for action in actions {
            match action {
                Action::Edit(edit) => self.edit(*edit),
                Action::Begin(name) => self.begin(&name),
                Action::Move { cells, by, behind } => {
                    let edits = self
                        .session
                        .as_ref()
                        .map(|session| moved(&session.document, &cells, by, behind));
                    edits.into_iter().flatten().for_each(|edit| self.edit(edit));
                }
                Action::Restart => {
                    self.draft.held_back = None;
                    self.rework(|session| Some(session.document.restart()));
                }
                Action::Finish => self.finish(),
                Action::Cancel => {
                    self.draft.held_back = None;
                    self.rework(|session| Some(session.document.cancel()));
                }
                Action::GoTo(entry) => self.rework(|session| session.document.go_to(entry)),
                Action::Command(command) => self.run_command(ctx, command),
                Action::Hover(at) => self.hover = at.or(self.hover),
                Action::Mark(mark) => self.draft.mark = mark,
                Action::LookAt { end, pick } => {
                    self.draft.look_at(end, pick);
                    self.layout.bring(Pane::Draft);
                }
                Action::PaintYarn(yarn, button) => {
                    self.draft.yarns[usize::from(button == Button::Second)] = yarn;
                }
                Action::PaintRegion(region, button) => {
                    self.draft.regions[usize::from(button == Button::Second)] = region;
                }
                Action::Limits(limits) => self.draft.limits = limits,
                Action::Calibrated(mm_per_point) => {
                    self.settings.mm_per_point = Some(mm_per_point);
                    self.write_settings();
                }
                Action::Set(name, value) => {
                    if let Err(error) = self.preview.set(&name, &value) {
                        self.warn(error, "Nothing was set.");
                    }
                }
                Action::Switch(effect, on) => self.preview.switch(effect, on),
                Action::Show(pane) => self.layout.bring(pane),
                Action::Say(grade, text, kept) => self.say(grade, text, kept),
            }
        }
        // The other views mark it in the next frame.
        if before != (self.hover, self.draft.mark) {
            ctx.request_repaint();
        }
    }

    /// Begins a gesture: what follows is one entry of the history.
    pub(super) fn begin(&mut self, name: &str) {
        if let Some(session) = &mut self.session {
            session.document.begin(name);
        }
    }

    /// Ends the gesture, and derives the draft of a stroke that was held back, or asks
    /// about it.
    pub(super) fn finish(&mut self) {
        if let Some(held) = self.draft.held_back.take() {
            self.rework(|session| Some(session.document.cancel()));
            self.edit(held.into_edit());
            return;
        }
        if let Some(session) = &mut self.session {
            session.document.finish();
        }
    }

    /// Tells the person, and keeps it in the log.
    pub(super) fn say(&mut self, grade: Grade, text: impl Into<String>, kept: impl Into<String>) {
        let (text, kept) = (text.into(), kept.into());
        self.panes.log.add(grade, &text, &kept);
        self.toasts.say(grade, text, kept);
    }

    pub(super) fn warn(&mut self, text: impl Into<String>, kept: &str) {
        self.say(Grade::Warning, text, kept);
    }

    /// Does an edit, or asks what to do instead where it is refused.
    pub(super) fn edit(&mut self, edit: Edit) {
        let Some(session) = &self.session else {
            return;
        };
        let derives = self.asking.derive_always
            && super::draft::is_shaft_draft(&session.document)
            && matches!(
                edit,
                Edit::Paint { .. } | Edit::Place { .. } | Edit::Flip(_)
            );
        // Another draft has other shafts, and moves the drawdown: not while one draws on it.
        if derives && self.hold_back(&EditError::ShaftDraft, &edit) {
            return;
        }
        let Some(session) = &mut self.session else {
            return;
        };
        let edit = match derives {
            true => Edit::DeriveDraft {
                after: Some(Box::new(edit)),
            },
            false => edit,
        };
        // Only what a question could be about is kept for it.
        let refused = matches!(
            edit,
            Edit::Paint { .. } | Edit::Place { .. } | Edit::Flip(_) | Edit::PaintRegion { .. }
        )
        .then(|| edit.clone());
        let another = matches!(edit, Edit::Replace(_));
        match session.document.apply(edit) {
            Ok(change) => {
                if another {
                    self.preview.look_anew();
                }
                self.changed(&change);
            }
            Err(error) => match refused {
                Some(edit) if self.hold_back(&error, &edit) => {}
                refused => self.refused(&error, refused),
            },
        }
    }

    /// Keeps what a stroke painted on the drawdown of a draft until it ends, so that the
    /// draft is derived, or the question asked, once for the whole stroke; false where that
    /// is to be done at once.
    fn hold_back(&mut self, error: &EditError, edit: &Edit) -> bool {
        let stroke = (self.session.as_ref()).is_some_and(|session| session.document.in_gesture());
        if !stroke || *error != EditError::ShaftDraft {
            return false;
        }
        let before = self.draft.held_back.take();
        self.draft.held_back = HeldBack::of(edit, before);
        self.draft.held_back.is_some()
    }

    pub(super) fn refused(&mut self, error: &EditError, edit: Option<Edit>) {
        self.draft.give_up();
        self.rework(|session| Some(session.document.cancel()));
        let remedies = edit.map_or_else(Vec::new, |edit| error.remedies(&edit));
        if remedies.is_empty() {
            self.say(Grade::Error, error.to_string(), "The design is as it was.");
        } else {
            self.asking.about_refused(error.to_string(), remedies);
        }
    }

    /// Goes to another state of the document.
    pub(super) fn rework(&mut self, go: impl FnOnce(&mut Session) -> Option<Change>) {
        if let Some(change) = self.session.as_mut().and_then(go) {
            self.changed(&change);
        }
    }

    /// Lets every view know what to draw again.
    pub(super) fn changed(&mut self, change: &Change) {
        let Some(session) = &self.session else {
            return;
        };
        if !change.is_nothing() {
            // What was drawn in this frame shows the state before.
            self.ctx.request_repaint();
            self.draft.changed(&session.document, change);
            // What becomes a picture, or is one no more, is laid out as when it is opened.
            let pictured = session.is_pictured();
            if pictured != self.pictured {
                self.lay_out();
            }
        }
    }
}
