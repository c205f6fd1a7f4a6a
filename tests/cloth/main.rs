//! The implicit volume: seams, bounds, walks, hairs, levels, colours.

#[path = "../common/cloth_scenes/mod.rs"]
mod cloth_scenes;

mod colour;
mod edit;
mod families;
mod hairs;
mod interlacing;
mod levels;
mod majorants;
mod seams;
mod walk;
