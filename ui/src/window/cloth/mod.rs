//! What lies over the cloth or in its place: the pick glass, a kept picture to compare
//! with, the lamp, and the sheet of the colourways.

pub mod bar;
pub mod compare;
pub mod glass;
pub mod lamp;
pub mod sheet;
#[cfg(test)]
mod tests;
