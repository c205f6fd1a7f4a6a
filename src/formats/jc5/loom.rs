//! The loom that a card file is for.

use std::path::PathBuf;

/// The loom that a card file is for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loom {
    /// Whose hooks.
    pub hooks: Hooks,
    /// It weaves face down.
    pub face_down: bool,
}

/// Whose hooks the cloth is put into.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Hooks {
    /// Those of a card file of the loom.
    Like(PathBuf),
    /// Those of a loom by name, or of a `.ron` file as in `presets/looms`.
    Named(String),
}
