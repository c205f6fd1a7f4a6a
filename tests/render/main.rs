//! The tracer: tracking, fibres, films, denoising, stills, first sight, what a picture calls
//! for, what accuracy costs, and what its references agree with.

#[path = "../common/named_tests/mod.rs"]
mod named_tests;
#[path = "../common/picture_likeness/mod.rs"]
mod picture_likeness;
#[path = "../common/render_scenes/mod.rs"]
mod render_scenes;

mod accuracy;
mod denoise;
mod engines;
mod film;
mod first_sight;
mod follow;
mod needs;
mod references;
mod sggx;
mod still;
mod tracking;
