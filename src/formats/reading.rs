//! What every reader of designs is told, and what it gives.

use super::image::ImageReading;
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
    /// Loom files are woven face down: what they lift shows on the back.
    pub face_down: bool,
    /// How an image is read.
    pub image: ImageReading,
}

/// A file's name without folders and ending.
pub(super) fn stem(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    match last.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem.to_owned(),
        _ => last.to_owned(),
    }
}
