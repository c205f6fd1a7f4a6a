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
//! | [`random`] | random numbers that are a hash of where they are used | `hash` |
//! | [`job`] | progress, cancelling, deadlines | – |
//! | [`limits`] | sizes beyond which nothing is tried | – |
//! | [`memory`] | one budget for what files and users ask for | – |
//! | [`text`] | texts of files, made safe to show | – |
//! | [`atomic`] | files that are written whole or not at all | – |
//! | [`design`] | what is made: weave, yarns, sett, repeat | `hash` `job` `limits` `memory` |
//! | [`yarn`] | yarn recipes: curves and fibres | `hash` `limits` `design` |
//! | [`synthesis`] | which block each crossing copies | `hash` `job` `design` |
//! | [`exemplar`] | voxels to copy from | `job` `limits` `memory` `atomic` `design` `yarn` `synthesis` |
//! | [`scene`] | rays, cameras, lights, skies | `random` |
//! | [`film`] | sums of paths, their error, the picture made of them | `job` `scene` |
//! | [`render`] | traces any medium into a film | `random` `job` `scene` `film` |
//! | [`volume`] | voxels in a grid, as a medium | `scene` `render` |
//! | [`cloth`] | the implicit volume of a design | `random` `job` `memory` `design` `yarn` `synthesis` `exemplar` `scene` `render` `volume` |
//! | [`posterise`] | a photograph becomes weaves | `job` `memory` `design` `cloth` |
//! | [`formats`] | files of other programs and our own | `job` `limits` `memory` `text` `atomic` `design` `yarn` `scene` `film` `volume` |
//! | [`edit`] | changes, undo, recovery | `atomic` `design` `formats` |
//! | [`mod@print`] | a design as PDF | `text` `design` |
//! | [`presets`] | designs inside the program | `design` `formats` |
//! | [`plan`] | what a picture simulates, and how closely | `synthesis` `exemplar` `render` `cloth` `formats` |
//! | [`engine`] | draws a design: the table of engines, stills, sheets | `random` `job` `limits` `memory` `text` `design` `synthesis` `exemplar` `scene` `film` `render` `volume` `cloth` `formats` `plan` |

pub mod atomic;
pub mod cloth;
pub mod design;
pub mod edit;
pub mod engine;
pub mod exemplar;
pub mod film;
pub mod formats;
pub mod hash;
pub mod job;
pub mod limits;
pub mod memory;
pub mod plan;
pub mod posterise;
pub mod presets;
pub mod print;
pub mod random;
pub mod render;
pub mod scene;
pub mod synthesis;
pub mod text;
pub mod volume;
pub mod yarn;
