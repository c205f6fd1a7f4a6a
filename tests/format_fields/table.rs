//! Who walks which table.

#[path = "exr.rs"]
mod exr;
#[path = "images.rs"]
mod images;

use super::{Outcome, Twins, Walker};

/// One walker a format.
pub fn walkers() -> Vec<Walker> {
    let mut walkers = exr::walkers();
    walkers.extend(images::walkers());
    walkers
}
