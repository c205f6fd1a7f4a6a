//! Who walks which table.

use super::Walker;

#[path = "drafts.rs"]
mod drafts;

/// One walker a format.
pub fn walkers() -> Vec<Walker> {
    let mut walkers = Vec::new();
    walkers.extend(drafts::walkers());
    walkers
}
