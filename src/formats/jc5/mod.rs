//! Stäubli .jc5, the card file of an electronic jacquard: reading and writing.
//!
//! Big-endian: `81 FE 01 01`; a count of records, each a tag, a length and as many bytes
//! (tag 1 the name, tag 2 the picks, tag 8 the program); a count of areas, each the tag
//! 0x64, a length, a 1, the hooks and a name; then for each pick the bytes of all areas one
//! behind the other, bit 0 (the least) of the first byte = the first hook. A 1 lifts.
//!
//! `areas` takes a file apart and says what each area is for, `read` makes a design of the
//! cloth, `write` puts a cloth into the areas of a file there is, `preset` makes such a
//! file for a loom whose areas are known.
//!
//! * The first row is pick 0 (woven first, at the bottom), the first hook of the cloth is
//!   end 0 (left, seen from the side of the cloth that faces up in the loom).
//! * **Face**: a lifted end lies on top *in the loom*. Cloth that is woven face down shows
//!   its face when it is turned over as one turns a page: lifts are inverted and the ends
//!   run the other way. Nothing in a file says which; who opens or writes it does.
//! * **Areas** have no role in the file. The widest is taken as the cloth; of the others,
//!   those that never change as controls, the rest as selvedge. The reader says so.

mod areas;
mod loom;
mod preset;
mod read;
mod write;

pub use areas::FIELDS;
pub use areas::{Area, CardFile, Role, parse, recognises};
pub use loom::{Hooks, Loom};
pub use preset::{LoomArea, LoomPreset, PRESETS, template};
pub use read::{FACE_UP, read};
pub use write::{WriteOptions, Written, write_into};
