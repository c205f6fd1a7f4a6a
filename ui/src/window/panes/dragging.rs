//! A drag or some typing in a field is one entry of the history.

use egui::{Id, Response};

use crate::window::action::Action;

/// Which field is being changed.
#[derive(Default)]
pub struct Dragging(Option<Id>);

impl Dragging {
    /// Opens a gesture of this name with the first change in a field, and ends it when the
    /// field is let go.
    pub fn note(&mut self, ui: &egui::Ui, field: &Response, name: &str, actions: &mut Vec<Action>) {
        let popup = egui::Popup::is_any_open(ui.ctx());
        let busy = field.dragged() || field.has_focus() || (popup && field.changed());
        let ours = self.0 == Some(field.id);
        if field.changed() && !ours {
            actions.push(Action::Begin(name.to_owned()));
            self.0 = Some(field.id);
        } else if ours && !busy && !field.changed() && !popup {
            actions.push(Action::Finish);
            self.0 = None;
        }
    }
}
