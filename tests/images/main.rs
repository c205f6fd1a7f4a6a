//! Images read and written, and photographs made into weaves.

#[path = "../common/image_files/mod.rs"]
mod image_files;
#[path = "../common/memory/mod.rs"]
mod memory;

mod fuzz;
mod limits;
mod posterise_design;
mod posterise_photo;
mod posterise_still;
mod read;
mod roundtrip;
