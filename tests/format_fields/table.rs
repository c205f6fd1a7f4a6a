//! Who walks which table.

use crate::Walker;

#[path = "volumes.rs"]
mod volumes;

#[path = "drafts.rs"]
mod drafts;

/// One walker a format.
pub fn walkers() -> Vec<Walker> {
    let mut walkers = Vec::new();
    walkers.extend(drafts::walkers());
    walkers.extend(volumes::walkers());
    walkers
}
