//! Exemplars: voxels plus their small weave pattern; data to copy from.
//!
//! Zhao 2012 §4: each exemplar is a voxel grid (density, fibre direction, yarn) and the
//! weave pattern that it shows. Here they are built from recipes ([`crate::yarn`]); a
//! scan meets the program at the same type. An [`ExemplarSet`] belongs to one pair of
//! yarns and holds one exemplar for each weave of the catalogue, all with one block size.
//!
//! [`voxelise`] turns fibres into voxels, [`BrickVolume`] stores them sparsely, and
//! [`ExemplarSet`] builds, keeps and caches them.

mod bricks;
mod direction;
pub mod hairs;
mod heights;
mod lobes;
mod majorants;
mod room;
mod set;
mod store;
pub mod voxelise;

pub(crate) use bricks::cell_of;
pub use bricks::{BRICK, BrickVolume, PackedVoxel};
pub use direction::{decode_direction, encode_direction};
pub use lobes::Lobes;
pub(crate) use lobes::bits_of;
pub use majorants::{Allowance, BlockMajorants, CELL};
pub use room::{LIMITS, USUAL_LIMIT};
pub use set::{
    COARSEST_LEVEL, ExemplarError, ExemplarSet, Pair, bytes_at_most, common_grid, layout, quantise,
};
pub use store::ExemplarStore;
pub use voxelise::VoxelGrid;
