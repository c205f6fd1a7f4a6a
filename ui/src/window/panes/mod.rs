//! The panes of the window. A pane is one file with a struct whose
//! `show(&mut self, ui, document, actions)` draws it; [`Pane`] names them for the layout
//! and [`Panes`] holds them. A new pane is one file, one variant and one field.

mod colourways;
mod columns;
mod dragging;
mod floats;
mod history;
pub mod later;
mod log;
mod posterise;
mod region_details;
mod regions;
mod section;
mod sett;
mod swatches;
#[cfg(test)]
mod tests;
mod weave_picker;
mod yarns;

use std::path::Path;

use pickglass::edit::Document;
use serde::{Deserialize, Serialize};

use super::action::Action;
use colourways::Colourways;
use floats::Floats;
use history::History;
use log::Log;
use posterise::Posterise;
use section::Section;
use sett::SettPane;
use yarns::Yarns;

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
    Section,
    History,
    Log,
}

impl Pane {
    /// All panes, in the order of the usual tabs.
    pub const ALL: [Self; 10] = [
        Self::Draft,
        Self::Cloth,
        Self::Floats,
        Self::Yarns,
        Self::Colourways,
        Self::Sett,
        Self::Posterise,
        Self::Section,
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
            Self::Section => "Cut",
            Self::History => "History",
            Self::Log => "Log",
        }
    }
}

/// The state of the panes below the views.
#[derive(Default)]
pub struct Panes {
    /// The cloth is turned by 180°, as on the draft.
    pub turned: bool,
    pub log: Log,
    pub section: Section,
    floats: Floats,
    yarns: Yarns,
    colourways: Colourways,
    sett: SettPane,
    posterise: Posterise,
    history: History,
}

#[cfg(test)]
impl Panes {
    /// Ends and regions of the picture that was posterised.
    pub fn posterised(&self) -> Option<(u32, usize)> {
        self.posterise.made_of()
    }
}

impl Panes {
    /// Forgets what was shown and typed of the design before: another one is open. Units and
    /// limits that were chosen stay, and so does a picture that was read from a file.
    pub fn forget(&mut self) {
        self.section.forget();
        self.floats.forget();
        self.yarns.forget();
        self.colourways = Colourways::default();
        self.sett.forget();
        self.posterise.forget();
    }

    /// Reads a picture to be posterised.
    pub fn posterise(&mut self, ctx: &egui::Context, path: &Path) {
        self.posterise.read_file(ctx, path);
    }

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
            Pane::Floats => {
                self.floats.show(ui, document, actions);
            }
            Pane::Yarns => self.yarns.show(ui, document, actions),
            Pane::Colourways => self.colourways.show(ui, document, self.turned, actions),
            Pane::Sett => self.sett.show(ui, document, actions),
            Pane::Posterise => self.posterise.show(ui, document, actions),
            Pane::Section => {
                self.section.show(ui, document, actions);
            }
            Pane::History => self.history.show(ui, document, actions),
            // Views of their own.
            Pane::Draft | Pane::Cloth => {}
        }
    }
}
