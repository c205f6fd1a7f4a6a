//! Pickglass: woven cloth from drafts, path-traced.
//!
//! Data flows in one direction: [`design`] (what the designer makes) is changed by
//! [`edit`], read and written by [`formats`]; [`yarn`] and [`exemplar`] turn yarn recipes into voxels to
//! copy from; [`synthesis`] decides which exemplar block every crossing copies;
//! [`cloth`] is the implicit volume that results; [`render`] traces it, or any other
//! [`render::Medium`], into a film. [`posterise`] makes a design of a photograph.
//!
//! # The house
//! Imports go up this table only. Those in italics have still to go; `tests/house.rs` keeps
//! the rest as it is.
//!
//! | folder | what it is | imports |
//! |---|---|---|
//! | [`hash`] | a stable hash of what is said | – |
//! | [`job`] | progress, cancelling, deadlines | – |
//! | [`limits`] | sizes beyond which nothing is tried | – |
//! | [`memory`] | one budget for what files and users ask for | – |
//! | [`text`] | texts of files, made safe to show | – |
//! | [`design`] | what is made: weave, yarns, sett, repeat | `hash` `job` `limits` `memory` |
//! | [`yarn`] | yarn recipes: curves and fibres | `hash` `limits` `design` |
//! | [`synthesis`] | which block each crossing copies | `hash` `job` `design` |
//! | [`exemplar`] | voxels to copy from | `job` `limits` `memory` `yarn` `synthesis` *`formats`* |
//! | [`render`] | traces any medium into a film | `hash` `job` *`formats`* |
//! | [`volume`] | voxels in a grid, as a medium | `render` |
//! | [`cloth`] | the implicit volume of a design | `job` `design` `yarn` `synthesis` `exemplar` `render` `volume` |
//! | [`edit`] | changes, undo, recovery | `design` *`formats`* |
//! | [`posterise`] | a photograph becomes weaves | `job` `memory` `design` `cloth` |
//! | [`formats`] | files of other programs and our own | `job` `limits` `memory` `text` `design` `yarn` `render` `volume` |
//! | [`still`] | a design becomes a picture | `job` `memory` `design` `synthesis` `exemplar` `render` `volume` `cloth` `formats` |

pub mod cloth;
pub mod design;
pub mod edit;
pub mod exemplar;
pub mod formats;
pub mod hash;
pub mod job;
pub mod limits;
pub mod memory;
pub mod posterise;
pub mod render;
pub mod still;
pub mod synthesis;
pub mod text;
pub mod volume;
pub mod yarn;
