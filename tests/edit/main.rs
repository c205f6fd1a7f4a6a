//! Changes, undo and recovery.

#[path = "../common/memory/mod.rs"]
mod memory;

mod history;
mod properties;
mod recovery;
