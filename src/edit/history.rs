//! The states of a document, one for each gesture, as many as fit the bytes allowed.

use std::sync::Arc;

use crate::design::{Design, WeavePattern};

/// The bytes that a history may keep beside the document itself.
pub const HISTORY_BYTES: usize = 256 << 20;

/// A design and its drawdown.
#[derive(Debug, Clone)]
pub(super) struct State {
    pub(super) design: Arc<Design>,
    pub(super) drawdown: Arc<WeavePattern>,
}

impl State {
    /// Bytes of memory that this state does not share with another.
    fn bytes_beyond(&self, other: &Self) -> usize {
        let design = match Arc::ptr_eq(&self.design, &other.design) {
            true => 0,
            false => self.design.bytes_beyond(Some(&other.design)),
        };
        let drawdown = match Arc::ptr_eq(&self.drawdown, &other.drawdown) {
            true => 0,
            false => self.drawdown.bytes_beyond(Some(&other.drawdown)),
        };
        design + drawdown
    }
}

/// One entry of the history: a state and the gesture that led to it.
#[derive(Debug, Clone)]
pub struct Entry {
    name: String,
    pub(super) id: u64,
    pub(super) state: State,
    /// What it holds that the entry before does not.
    bytes: usize,
}

impl Entry {
    /// What the gesture is called: "pencil", "tie-up".
    pub fn name(&self) -> &str {
        &self.name
    }

    /// A number that no other state of the document has.
    pub fn id(&self) -> u64 {
        self.id
    }

    /// The design after the gesture.
    pub fn design(&self) -> &Arc<Design> {
        &self.state.design
    }
}

/// The entries in order, and which of them is the present one.
#[derive(Debug, Clone)]
pub(super) struct History {
    entries: Vec<Entry>,
    position: usize,
    next: u64,
    limit: usize,
}

impl History {
    /// A history whose first entry is the state the document begins with.
    pub(super) fn new(name: &str, state: State) -> Self {
        let first = Entry {
            name: name.to_owned(),
            id: 0,
            state,
            bytes: 0,
        };
        Self {
            entries: vec![first],
            position: 0,
            next: 1,
            limit: HISTORY_BYTES,
        }
    }

    pub(super) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    pub(super) fn position(&self) -> usize {
        self.position
    }

    /// The present entry; there is always one.
    pub(super) fn present(&self) -> &Entry {
        &self.entries[self.position]
    }

    /// A state more; what was undone is forgotten.
    pub(super) fn push(&mut self, name: String, state: State) {
        self.entries.truncate(self.position + 1);
        let bytes = size_of::<Entry>() + name.len() + state.bytes_beyond(&self.present().state);
        self.entries.push(Entry {
            name,
            id: self.next,
            state,
            bytes,
        });
        self.next += 1;
        self.position += 1;
        self.trim();
    }

    /// Goes to an entry; `None` if there is no such entry or it is the present one.
    pub(super) fn go_to(&mut self, entry: usize) -> Option<&Entry> {
        if entry >= self.entries.len() || entry == self.position {
            return None;
        }
        self.position = entry;
        self.entries.get(entry)
    }

    /// Bytes that the entries hold beyond one state of the document.
    pub(super) fn bytes(&self) -> usize {
        self.entries.iter().skip(1).map(|entry| entry.bytes).sum()
    }

    pub(super) fn set_limit(&mut self, bytes: usize) {
        self.limit = bytes;
        self.trim();
    }

    /// Forgets the oldest entries until the rest fits; the present one and the one before
    /// it always stay, so that the last gesture can be taken back whatever it costs.
    fn trim(&mut self) {
        let (mut bytes, mut drop) = (self.bytes(), 0);
        while bytes > self.limit && drop + 1 < self.position {
            // The next entry becomes the first, whose bytes are the document's own.
            bytes -= self.entries[drop + 1].bytes;
            drop += 1;
        }
        self.entries.drain(..drop);
        self.position -= drop;
    }
}
