//! One file a format, reading and writing.
//!
//! [`load`] recognises a design or draft by its content, not by its name.

pub mod atomic;
pub mod wif;

use crate::design::{Design, Family};

/// A design that was read, and what the reader had to decide for itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The design.
    pub design: Design,
    /// One line each: what was odd in the file and what was made of it.
    pub warnings: Vec<String>,
}

/// What the person who opens a file knows better than the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LoadOptions {
    /// Ends and picks per cm, instead of the file's.
    pub sett: Option<(f32, f32)>,
    /// What yarns are made of where the file does not say; `None` = cotton.
    pub family: Option<Family>,
}
