//! Who walks which table.

use super::{Walker, drafts, exr, images, volumes};

/// One walker a format.
pub fn walkers() -> Vec<Walker> {
    let mut walkers = exr::walkers();
    walkers.extend(images::walkers());
    walkers.extend(drafts::walkers());
    walkers.extend(volumes::walkers());
    walkers
}
