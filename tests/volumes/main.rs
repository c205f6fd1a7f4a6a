//! Voxels in a grid: read, written, traced.

#[path = "../common/cloth_scenes/mod.rs"]
mod cloth_scenes;
#[path = "../common/memory/mod.rs"]
mod memory;
#[path = "../common/render_scenes/mod.rs"]
mod render_scenes;
#[path = "../common/volume_sources/mod.rs"]
mod volume_sources;

mod dense;
mod files;
mod memory_taken;
