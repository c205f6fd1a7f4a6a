//! Pickglass: woven cloth from drafts, path-traced. What becomes of what:
//!
//! ```text
//!   formats ──▶ design ◀── edit          what is made: weave, yarns, sett
//!   posterise ──▶ │
//!          ┌──────┴───────┐
//!          ▼              ▼
//!   yarn ─▶ exemplar   synthesis         voxels to copy from; which block each crossing copies
//!          └──────┬───────┘
//!                 ▼
//!               cloth                    the implicit volume: a position becomes a voxel
//!                 │
//!                 ▼
//!   scene ─▶ render ─▶ film              paths through it from a camera, summed in pixels
//!                 │
//!                 ▼
//!   plan ─▶ engine ─▶ formats            what is simulated; stills, sheets, first sight
//! ```
//!
//! A *crossing* is where an end (of the warp) and a pick (of the weft) cross; an *exemplar* is a
//! small piece of cloth as voxels, a *block* one crossing of it; *edge fixing* closes the *seams*
//! between blocks; a *tap* is one look into voxels; *first sight* is the picture that is there
//! before any path is traced.
//!
//! A crossing becomes a pixel like this: [`synthesis`] gives each crossing of the drawdown the
//! block of an exemplar ([`exemplar`], made of the curves of [`yarn`]); [`cloth`] finds the
//! crossing of a position and reads that block's voxel, moved by edge fixing and by chance;
//! [`render`] walks rays through any such [`render::Medium`] and scatters them; [`film`] sums
//! them, denoises, and shows them. An [`engine`] makes a picture of one design, by all of that or,
//! as first sight does, by less; [`plan`] says which effects and which settings it takes.
//!
//! A still of a design that comes with the program:
//!
//! ```
//! use std::sync::Arc;
//! use pickglass::{engine, job::Job, presets};
//!
//! let design = Arc::new(presets::design("denim").ok_or("no such preset")??);
//! let request = engine::StillRequest { width: 320, height: 240, ..Default::default() };
//! // First sight is there at once; engine::reference() traces paths.
//! let sight = engine::renderer("sight")?;
//! let still = engine::render_still(&design, &request, sight, &Job::new(), &mut |_| {})?;
//! still.save(&std::env::temp_dir().join("denim.png"))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The house
//! Imports go up this table only, and `tests/house.rs` keeps both as they are: an import that
//! is not in its row fails, and so does a row that allows more than is needed. One that is
//! needed and points up is written into its row; one that points down asks for the piece that
//! both need, in a folder above both. (Imports from below that have still to go would stand in
//! italics; there are none.) Tests import what they like. Files that import each other in
//! circles are counted, and may not become more.
//!
//! | folder | what it is | imports |
//! |---|---|---|
//! | [`hash`] | a stable hash of what is said | – |
//! | [`random`] | random numbers that are a hash of where they are used | `hash` |
//! | [`job`] | progress, cancelling, deadlines | – |
//! | [`clock`] | what passed, and what processors worked | – |
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
//! | [`render`] | traces any medium into a film | `random` `job` `clock` `scene` `film` |
//! | [`volume`] | voxels in a grid, as a medium | `scene` `render` |
//! | [`cloth`] | the implicit volume of a design | `random` `job` `memory` `design` `yarn` `synthesis` `exemplar` `scene` `render` `volume` |
//! | [`posterise`] | a photograph becomes weaves | `job` `memory` `design` `cloth` |
//! | [`formats`] | files of other programs and our own | `job` `limits` `memory` `text` `atomic` `design` `yarn` `scene` `film` `volume` |
//! | [`edit`] | changes, undo, recovery | `atomic` `design` `formats` |
//! | [`mod@print`] | a design as PDF | `text` `design` |
//! | [`presets`] | designs inside the program | `design` `formats` |
//! | [`plan`] | what a picture simulates, and how closely | `limits` `synthesis` `exemplar` `render` `cloth` `formats` |
//! | [`engine`] | draws a design: the table of engines, stills, sheets | `random` `job` `limits` `memory` `text` `design` `synthesis` `exemplar` `scene` `film` `render` `volume` `cloth` `formats` `plan` |
//! | [`needs`] | which effects a picture calls for | `random` `job` `design` `exemplar` `scene` `film` `render` `cloth` `plan` `engine` |
//! | [`accuracy`] | what each dial's settings cost and how wrong they are, measured | `random` `job` `clock` `limits` `atomic` `design` `synthesis` `exemplar` `scene` `film` `cloth` `formats` `plan` `engine` |
//! | [`selftest`] | hard cases, tried on a user's machine | `hash` `random` `job` `design` `synthesis` `exemplar` `scene` `film` `render` `volume` `formats` `edit` `presets` `plan` `engine` |

pub mod accuracy;
pub mod atomic;
pub mod clock;
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
pub mod needs;
pub mod plan;
pub mod posterise;
pub mod presets;
pub mod print;
pub mod random;
pub mod render;
pub mod scene;
pub mod selftest;
pub mod synthesis;
pub mod text;
pub mod volume;
pub mod yarn;
