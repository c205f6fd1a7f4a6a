//! Who walks which table.

use crate::Walker;

#[path = "volumes.rs"]
mod volumes;

/// One walker a format.
pub fn walkers() -> Vec<Walker> {
    volumes::walkers().into()
}
