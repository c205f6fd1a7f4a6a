//! What other programs say of our files and pictures.

#[path = "../common/cloth_scenes/mod.rs"]
mod cloth_scenes;
#[path = "../common/render_scenes/mod.rs"]
mod render_scenes;
#[path = "../common/volume_sources/mod.rs"]
mod volume_sources;

mod images;
mod mitsuba;
mod mitsuba_volume;
mod volumes;
mod wif;
