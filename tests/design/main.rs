//! What is made: weaves, drafts, yarns, documents and their checks.

#[path = "../common/memory/mod.rs"]
mod memory;

mod checks;
mod colourways;
mod derive;
mod documents;
mod large;
mod panel;
mod presets;
mod turned;
mod weave_library;
mod weave_properties;
