//! What a pane asks for. Panes change nothing themselves: they push actions, and the app
//! does them in one place, in order, after the panes were shown.

use pickglass::design::YarnId;
use pickglass::edit::{Cells, Edit};
use pickglass::plan::Effect;

use super::panes::Pane;
use super::toasts::Grade;
use crate::command_table::Command;

/// One wish of a pane.
#[derive(Debug, Clone)]
pub enum Action {
    /// Change the design; one entry of the history, unless a gesture is open. Boxed, since
    /// an edit may carry a whole design.
    Edit(Box<Edit>),
    /// A gesture of this name begins: edits up to [`Action::Finish`] are one entry.
    Begin(String),
    /// Back to where the gesture began, and on with it: a line whose end is dragged.
    Restart,
    /// Move these crossings by so many ends and picks; region `behind` is left there where
    /// regions are moved, else weft.
    Move {
        cells: Box<Cells>,
        by: (i64, i64),
        behind: Option<u16>,
    },
    /// The gesture is complete.
    Finish,
    /// The gesture is given up: back to where it began.
    Cancel,
    /// Undo or redo to this place of the history.
    GoTo(usize),
    /// As if chosen from a menu.
    Command(Command),
    /// The pointer is over a crossing of the endless cloth (`None` = left it); every view
    /// marks it.
    Hover(Option<(i64, i64)>),
    /// Make something easy to find in the draft while the pointer is over its name.
    Mark(Mark),
    /// Bring these crossings into the middle of the draft.
    LookAt { end: i64, pick: i64 },
    /// The yarn that colour bars and yarn tools paint with: first or second button.
    PaintYarn(YarnId, Button),
    /// The region that region tools paint with: first or second button.
    PaintRegion(u16, Button),
    /// Threads that an end and a pick may pass over before the draft marks the float.
    Limits([u32; 2]),
    /// The screen was found to have so many millimetres a point.
    Calibrated(f32),
    /// Turn the dial, or switch the effect, of this name, for the cloth that is shown.
    Set(String, String),
    /// Switch an effect on or off for the cloth that is shown; `None` = by itself again.
    Switch(Effect, Option<bool>),
    /// Bring a pane to the front.
    Show(Pane),
    /// Tell the person what happened and what was kept.
    Say(Grade, String, String),
}

impl Action {
    /// An edit as an action.
    pub fn edit(edit: Edit) -> Self {
        Self::Edit(Box::new(edit))
    }
}

/// Which button of the pointer paints with something.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Button {
    First,
    Second,
}

/// What the draft makes easy to find.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mark {
    #[default]
    Nothing,
    /// Where a yarn shows on the face.
    Yarn(YarnId),
    /// Where a region lies.
    Region(u16),
    /// One float: its first crossing and how many ends and picks it covers.
    Float {
        end: u32,
        pick: u32,
        ends: u32,
        picks: u32,
    },
}
