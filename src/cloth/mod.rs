//! The implicit cloth volume: position → voxel and majorant. Zhao 2012 §5.5.
//!
//! Nothing is stored per voxel of cloth. A position is located among the ends and picks,
//! the crossing's block is looked up in the assignment and moved by the randomisation,
//! the edge fixing shifts it in z, and the exemplar's voxel is read. Which yarn it is, and
//! so its colour and gloss, is looked up in the design's maps at that moment: recolouring
//! never makes a new assignment.
//!
//! [`prepare`] makes a design into a [`PreparedCloth`], which follows its edits. Its
//! [`ClothVolume`] is a [`Medium`](crate::render::Medium) like any dense grid.

mod build;
pub mod colour;
pub mod expected;
mod export;
mod face_relief;
mod face_table;
mod follow;
mod hair_cells;
mod hairs;
pub mod levels;
mod lookup;
mod prepare;
mod walk;
mod window;

pub use build::{ClothError, ClothSettings, ClothVolume, YarnClasses};
pub use export::{ClothWindow, Part, Region, WindowError};
pub use face_relief::{FaceRelief, TEXELS};
pub use face_table::{FaceTable, Texel};
pub use hairs::{HairLayer, HairStock, HairWalk};
pub use prepare::{
    Followed, PreparedCloth, UnfinishedCloth, check_extent, needed, prepare, prepare_woven,
};
pub use walk::{ClothWalk, REACH_MM};
