//! Who walks which table.

use super::Walker;

/// One walker a format.
pub fn walkers() -> Vec<Walker> {
    Vec::new()
}
