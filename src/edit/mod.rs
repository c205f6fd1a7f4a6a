//! The document under edit: what changes a design, and the way back.
//!
//! A [`Document`] holds a [`Design`](crate::design::Design) and its drawdown, kept up to
//! date. [`Document::apply`] takes an [`Edit`], checks it, changes what it names in place
//! and says in a [`Change`] what a view must draw again. Every gesture is one entry of the
//! history; entries share tiles with their neighbours, so that thousands are kept.
//!
//! | file | holds |
//! |---|---|
//! | `document`, `history` | the design in its present state, and those before and after |
//! | `edits` | all that can be done to a design, and what each is called |
//! | `cells` | a set of crossings: a stroke, a fill, a selection |
//! | `change` | what differs between two states |
//! | `symmetry`, `shapes`, `fill`, `selection` | tools: from pointer positions to crossings |
//! | `recovery` | what is left of unsaved work after a crash |
//! | `crossings`, `drafts`, `regions`, `threads`, `colourways`, `whole`, `turn` | how each kind is done |

mod cells;
mod change;
mod colourways;
mod crossings;
mod document;
mod drafts;
mod edits;
mod error;
pub mod fill;
mod history;
pub mod recovery;
mod regions;
mod selection;
pub mod shapes;
mod symmetry;
mod threads;
mod turn;
mod whole;

pub use cells::{Cells, Rect};
pub use change::{Change, Touched};
pub use document::Document;
pub use edits::{Edit, Rows};
pub use error::EditError;
pub use history::{Entry, HISTORY_BYTES};
pub use selection::{Clip, Picked, moved, picked};
pub use symmetry::{MOST_COPIES, Point, Span, Surface, Symmetry};

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]
mod tests;
