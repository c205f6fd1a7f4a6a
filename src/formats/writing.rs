//! What every writer of designs is told, and what it gives.

use super::image::{Black, Corner, ImageContent};
use super::jc5::Loom;

/// How a design is written as an image or for a loom.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SaveOptions {
    /// What of the design an image shows.
    pub content: ImageContent,
    /// Which thread black puts on the face.
    pub black: Black,
    /// Where an image starts to count; `None` = where the file did that the design is from.
    pub corner: Option<Corner>,
    /// The loom that a card file is for.
    pub loom: Option<Loom>,
}

/// A design as the bytes of a file, and what of it has no place there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Saved {
    /// The file.
    pub bytes: Vec<u8>,
    /// One line each.
    pub lost: Vec<String>,
}
