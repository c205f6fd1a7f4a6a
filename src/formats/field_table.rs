//! The fields of a format that change what is read, and what its reader does with each.
//!
//! A field is recognised when its format's specification says that it changes size,
//! position, scale, axis order, orientation, colour, transparency or which yarn lies where.
//! One table stands beside each reader and lists them all; a test walks every row with a
//! file that holds the field's example and a twin that does not.

/// What a reader does with a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Handling {
    /// The result follows it.
    Honoured,
    /// The result does not follow it, and a warning names it.
    Warned,
    /// The file is refused, and the message names it.
    Refused,
}

/// A field of a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field {
    /// As the format's specification calls it.
    pub name: &'static str,
    /// What becomes of it.
    pub handling: Handling,
    /// A value that changes what is read, as text, for the test's file.
    pub example: &'static str,
}

impl Field {
    /// A row of a table.
    pub const fn new(name: &'static str, handling: Handling, example: &'static str) -> Self {
        Self {
            name,
            handling,
            example,
        }
    }
}

/// The fields of one format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Table {
    /// The format's name, as its ending: `nrrd`.
    pub format: &'static str,
    /// Its fields.
    pub fields: &'static [Field],
}
