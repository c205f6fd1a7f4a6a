//! The panes of the window. A pane is one file with a struct whose
//! `show(&mut self, ui, document, actions)` draws it; [`Pane`] names them for the layout
//! and [`Panes`] holds them. A new pane is one file, one variant and one field.

mod log;

use pickglass::edit::Document;
use serde::{Deserialize, Serialize};

use super::action::Action;
use log::Log;

/// A pane by name: what the layout moves about and writes into the settings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Pane {
    Draft,
    Cloth,
    Floats,
    Yarns,
    Colourways,
    Sett,
    Posterise,
    History,
    Log,
}

impl Pane {
    /// All panes, in the order of the usual tabs.
    pub const ALL: [Self; 9] = [
        Self::Draft,
        Self::Cloth,
        Self::Floats,
        Self::Yarns,
        Self::Colourways,
        Self::Sett,
        Self::Posterise,
        Self::History,
        Self::Log,
    ];

    /// What its tab says.
    pub fn title(self) -> &'static str {
        match self {
            Self::Draft => "Draft",
            Self::Cloth => "Cloth",
            Self::Floats => "Floats",
            Self::Yarns => "Yarns",
            Self::Colourways => "Colourways",
            Self::Sett => "Sett",
            Self::Posterise => "Posterise",
            Self::History => "History",
            Self::Log => "Log",
        }
    }
}

/// The state of the panes below the views.
#[derive(Default)]
pub struct Panes {
    pub log: Log,
}

impl Panes {
    /// Shows a pane.
    pub fn show(
        &mut self,
        pane: Pane,
        ui: &mut egui::Ui,
        document: &Document,
        actions: &mut Vec<Action>,
    ) {
        match pane {
            Pane::Log => self.log.show(ui, document, actions),
            // Views of their own.
            Pane::Draft | Pane::Cloth => {}
            _ => {}
        }
    }
}
