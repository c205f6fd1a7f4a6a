//! Who walks which table.

use crate::Walker;

#[path = "drafts.rs"]
mod drafts;
#[path = "exr.rs"]
mod exr;
#[path = "images.rs"]
mod images;
#[path = "volumes.rs"]
mod volumes;

/// One walker a format.
pub fn walkers() -> Vec<Walker> {
    let mut walkers = exr::walkers();
    walkers.extend(images::walkers());
    walkers.extend(drafts::walkers());
    walkers.extend(volumes::walkers());
    walkers
}
