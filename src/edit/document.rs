//! A design under edit: its present state, its drawdown, and the way back.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::change::Change;
use super::edits::Edit;
use super::error::EditError;
use super::history::{Entry, History, State};
use crate::design::{Design, WeavePattern};

/// The next revision of any document of this process. What is worked out of a document is
/// kept by its revision: two documents that shared one would pass for each other.
static NEXT_REVISION: AtomicU64 = AtomicU64::new(1);

fn next_revision() -> u64 {
    NEXT_REVISION.fetch_add(1, Ordering::Relaxed)
}

/// A gesture that is being made: what it is called and where it began.
#[derive(Debug, Clone)]
struct Gesture {
    name: String,
    from: State,
}

/// A design and its drawdown under edit, with undo.
#[derive(Debug, Clone)]
pub struct Document {
    present: State,
    history: History,
    gesture: Option<Gesture>,
    /// The id of the entry that is on the disk, if any is.
    saved: Option<u64>,
    revision: u64,
}

impl Document {
    /// A document that begins with this design, as saved.
    pub fn new(design: Design) -> Self {
        let drawdown = Arc::new(design.weave());
        let present = State {
            design: Arc::new(design),
            drawdown,
        };
        Self {
            history: History::new("opened", present.clone()),
            present,
            gesture: None,
            saved: Some(0),
            revision: next_revision(),
        }
    }

    /// A document that begins with a design that is on no disk yet: an import, a recovery.
    pub fn unsaved(design: Design) -> Self {
        Self {
            saved: None,
            ..Self::new(design)
        }
    }

    /// The design as it is now.
    pub fn design(&self) -> &Arc<Design> {
        &self.present.design
    }

    /// Its drawdown.
    pub fn drawdown(&self) -> &Arc<WeavePattern> {
        &self.present.drawdown
    }

    /// A number that is another after every change, undo included, and another in every
    /// document: no two states of this process share one, unless one is a copy of the other.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Does an edit: an entry of the history, or a part of the gesture that is being made.
    ///
    /// # Errors
    /// [`EditError`]; the document is then as it was.
    pub fn apply(&mut self, edit: Edit) -> Result<Change, EditError> {
        let name = edit.name();
        let work = self.done(edit)?;
        let after = State {
            design: Arc::new(work.design),
            drawdown: Arc::new(work.drawdown),
        };
        let change = Change::between(&self.present, &after);
        if change.is_nothing() {
            return Ok(change);
        }
        self.present = after;
        self.revision = next_revision();
        if self.gesture.is_none() {
            self.history.push(name.to_owned(), self.present.clone());
        }
        Ok(change)
    }

    /// Whether an edit can be done; the document stays as it is.
    ///
    /// # Errors
    /// As [`Document::apply`].
    pub fn check(&self, edit: Edit) -> Result<(), EditError> {
        self.done(edit).map(drop)
    }

    fn done(&self, edit: Edit) -> Result<Work, EditError> {
        let mut work = Work {
            design: Design::clone(&self.present.design),
            drawdown: WeavePattern::clone(&self.present.drawdown),
        };
        work.apply(edit)?;
        Ok(work)
    }

    /// Begins a gesture: what [`Document::apply`] does until [`Document::finish`] is one
    /// entry of this name. One that was being made is finished first.
    pub fn begin(&mut self, name: impl Into<String>) {
        self.finish();
        self.gesture = Some(Gesture {
            name: name.into(),
            from: self.present.clone(),
        });
    }

    /// Whether a gesture is being made.
    pub fn in_gesture(&self) -> bool {
        self.gesture.is_some()
    }

    /// Ends the gesture; it becomes an entry if it changed anything.
    pub fn finish(&mut self) {
        if let Some(gesture) = self.gesture.take()
            && !Change::between(&gesture.from, &self.present).is_nothing()
        {
            self.history.push(gesture.name, self.present.clone());
        }
    }

    /// Goes back to where the gesture began, and goes on with it: what a tool does that
    /// shows a line while its end is being dragged.
    pub fn restart(&mut self) -> Change {
        let Some(from) = self.gesture.as_ref().map(|gesture| gesture.from.clone()) else {
            return Change::default();
        };
        self.show(from)
    }

    /// Ends the gesture and goes back to where it began.
    pub fn cancel(&mut self) -> Change {
        match self.gesture.take() {
            Some(gesture) => self.show(gesture.from),
            None => Change::default(),
        }
    }

    /// Takes the last entry back, or cancels the gesture that is being made; `None` if
    /// there is nothing to take back.
    pub fn undo(&mut self) -> Option<Change> {
        if self.gesture.is_some() {
            return Some(self.cancel());
        }
        self.go_to(self.history.position().checked_sub(1)?)
    }

    /// Does again what was taken back; `None` if there is nothing.
    pub fn redo(&mut self) -> Option<Change> {
        if self.gesture.is_some() {
            return None;
        }
        self.go_to(self.history.position() + 1)
    }

    /// Goes to an entry of the history; `None` if it is the present one or is not there.
    /// A gesture that is being made is cancelled.
    pub fn go_to(&mut self, entry: usize) -> Option<Change> {
        let _ = self.cancel();
        let state = self.history.go_to(entry)?.state.clone();
        Some(self.show(state))
    }

    /// The entries of the history, the state the document began with first.
    pub fn entries(&self) -> &[Entry] {
        self.history.entries()
    }

    /// Which entry is the present one.
    pub fn position(&self) -> usize {
        self.history.position()
    }

    /// Whether there is an entry to take back.
    pub fn can_undo(&self) -> bool {
        self.gesture.is_some() || self.history.position() > 0
    }

    /// Whether there is an entry to do again.
    pub fn can_redo(&self) -> bool {
        self.gesture.is_none() && self.history.position() + 1 < self.history.entries().len()
    }

    /// Bytes that the history keeps beside the document itself.
    pub fn history_bytes(&self) -> usize {
        self.history.bytes()
    }

    /// Lets the history keep so many bytes, [`super::HISTORY_BYTES`] without this; the
    /// oldest entries are forgotten beyond.
    pub fn set_history_limit(&mut self, bytes: usize) {
        self.history.set_limit(bytes);
    }

    /// Whether the present state differs from the one that was saved: false again when
    /// undo returns to that.
    pub fn is_modified(&self) -> bool {
        let moved = self
            .gesture
            .as_ref()
            .is_some_and(|gesture| !Change::between(&gesture.from, &self.present).is_nothing());
        moved || self.saved != Some(self.history.present().id)
    }

    /// Says that the present state is on the disk. A gesture is finished first.
    pub fn mark_saved(&mut self) {
        self.finish();
        self.saved = Some(self.history.present().id);
    }

    /// The id of the present entry, to be remembered while it is being written.
    pub fn state_id(&self) -> u64 {
        self.history.present().id
    }

    /// Says that the entry of this id is on the disk, whatever was done since.
    pub fn mark_saved_as(&mut self, id: u64) {
        self.saved = Some(id);
    }

    fn show(&mut self, state: State) -> Change {
        let change = Change::between(&self.present, &state);
        self.present = state;
        self.revision = next_revision();
        change
    }
}

/// A design and its drawdown while an edit changes them; thrown away if the edit fails.
pub(super) struct Work {
    pub(super) design: Design,
    pub(super) drawdown: WeavePattern,
}

impl Work {
    /// Puts another design in its place and weaves it.
    pub(super) fn replace(&mut self, design: Design) {
        self.drawdown = design.weave();
        self.design = design;
    }
}
