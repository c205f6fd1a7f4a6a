//! Pickglass: woven cloth from drafts, path-traced.
//!
//! Data flows in one direction: [`design`] (what the designer makes) is changed by
//! [`edit`], read and written by [`formats`]; [`yarn`] and [`exemplar`] turn yarn recipes into voxels to
//! copy from; [`synthesis`] decides which exemplar block every crossing copies;
//! [`cloth`] is the implicit volume that results; [`render`] traces it, or any other
//! [`render::Medium`], into a film. [`posterise`] makes a design of a photograph.

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
