//! The panes of the window. A pane is one file with a struct that is a [`PaneView`], and one
//! row of the table here: the layout, the commands that show it, their keys and the settings
//! come from the row. Draft and cloth are views of their own, which the window holds.

mod accuracy;
mod colourways;
mod columns;
mod dragging;
mod effects;
mod floats;
mod history;
pub mod later;
mod log;
mod of_design;
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

use egui::{Key, Ui};
use pickglass::edit::Document;
use pickglass::engine::StillRequest;
use serde::{Deserialize, Serialize};

use super::action::Action;
use crate::command_table::{Command, Menu, Row, alt, row};

/// What a pane is shown.
pub struct Shown<'s> {
    pub document: &'s Document,
    /// The cloth is turned by 180°, as on the draft.
    pub turned: bool,
}

/// One of the panes below the views.
pub trait PaneView: Default {
    /// Draws it; what the person asks for goes into `actions`.
    fn show(&mut self, ui: &mut Ui, shown: &Shown<'_>, actions: &mut Vec<Action>);

    /// Another design is open: forgets what was shown and typed of the one before. Units and
    /// limits that were chosen stay.
    fn forget(&mut self) {}
}

/// Makes [`Pane`], [`Panes`] and the commands that show panes from one row each: the name of
/// its place and of its type, the name that layouts keep, what its tab says, the key that
/// shows it with Alt if it has one, the words of the command and what that says.
macro_rules! panes {
    ($($place:ident: $State:ty, $Pane:ident, $tab:literal, [$($key:ident)?], $command:literal, $tip:literal;)*) => {
        /// A pane by name: what the layout moves about and writes into the settings.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum Pane {
            Draft,
            Cloth,
            $($Pane,)*
        }

        impl Pane {
            /// How many there are.
            const COUNT: usize = 2 + [$($tab),*].len();

            /// All panes, in the order of the usual tabs.
            pub const ALL: [Self; Self::COUNT] = [Self::Draft, Self::Cloth, $(Self::$Pane),*];

            /// What its tab says.
            pub fn title(self) -> &'static str {
                match self {
                    Self::Draft => "Draft",
                    Self::Cloth => "Cloth",
                    $(Self::$Pane => $tab,)*
                }
            }
        }

        /// The commands that show panes, as rows of the table of commands.
        pub const COMMANDS: &[Row] = &[
            $(row(Command::Show(Pane::$Pane), Menu::Panes, $command, $tip, &[$(alt(Key::$key))?]),)*
        ];

        /// The state of the panes below the views.
        #[derive(Default)]
        pub struct Panes {
            /// The cloth is turned by 180°, as on the draft.
            pub turned: bool,
            $(pub(super) $place: $State,)*
        }

        impl Panes {
            /// Forgets what was shown and typed of the design before.
            pub fn forget(&mut self) {
                $(self.$place.forget();)*
            }

            /// Shows a pane; draft and cloth are shown by the window.
            pub fn show(
                &mut self,
                pane: Pane,
                ui: &mut Ui,
                document: &Document,
                actions: &mut Vec<Action>,
            ) {
                let turned = self.turned;
                let shown = Shown { document, turned };
                match pane {
                    Pane::Draft | Pane::Cloth => {}
                    $(Pane::$Pane => self.$place.show(ui, &shown, actions),)*
                }
            }
        }
    };
}

#[rustfmt::skip]
panes! {
    floats: floats::Floats, Floats, "Floats", [Num1], "Show floats", "Floats that are too long, one by one";
    yarns: yarns::Yarns, Yarns, "Yarns", [Num2], "Show yarns", "Colour, count and family of each yarn, stripes, metres";
    colourways: colourways::Colourways, Colourways, "Colourways", [Num3], "Show colourways", "Named sets of yarns for one structure, side by side";
    sett: sett::SettPane, Sett, "Sett", [Num4], "Show sett", "Ends and picks per cm or inch, reed, take-up, shrinkage";
    posterise: posterise::Posterise, Posterise, "Posterise", [Num5], "Show posterising", "A picture in a few colours, each with a weave";
    section: section::Section, Section, "Cut", [Num6], "Show the section", "How the yarns pass over and under along an end or a pick";
    history: history::History, History, "History", [Num7], "Show history", "All changes by name; a click goes back to one";
    log: log::Log, Log, "Log", [Num8], "Show log", "All that was said, warnings and errors";
    accuracy: accuracy::AccuracyPane, Accuracy, "Accuracy", [Num9], "Show accuracy", "What each approximation costs in time and how wrong it is, measured; a budget sets the dials";
    effects: effects::EffectsPane, Effects, "Effects", [Num0], "Show effects", "What the picture simulates; a look says what each part of it costs and what may be left out";
}

impl Panes {
    /// How the cloth is looked at.
    pub fn look(&mut self, asked: Option<&StillRequest>) {
        self.accuracy.look(asked);
        self.effects.look(asked);
    }

    /// Whether a pane measures how long things take.
    pub fn is_measuring(&self) -> bool {
        self.accuracy.is_measuring() || self.effects.is_looking()
    }

    /// Reads a picture to be posterised.
    pub fn read_picture(&mut self, ctx: &egui::Context, path: &Path) {
        self.posterise.read_file(ctx, path);
    }

    /// Ends and regions of the picture that was posterised.
    #[cfg(test)]
    pub fn posterised(&self) -> Option<(u32, usize)> {
        self.posterise.made_of()
    }
}
