//! Drafts and loom files of other programs, and what is printed.

#[path = "../common/image_files/mod.rs"]
mod image_files;
#[path = "../common/memory/mod.rs"]
mod memory;

mod collection;
mod fields;
mod floods;
mod jc5;
mod loom_drafts;
mod loom_fixtures;
mod loom_fuzz;
mod loom_limits;
mod print;
mod wif_drafts;
mod wif_fuzz;
mod wif_limits;
mod wif_quirks;
