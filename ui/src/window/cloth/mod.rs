//! What lies over the cloth: the pick glass, a kept picture to compare with, the lamp.

pub mod bar;
pub mod compare;
pub mod glass;
pub mod lamp;
#[cfg(test)]
mod tests;
