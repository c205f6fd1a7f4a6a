//! One file a format, reading and writing.

pub mod atomic;
pub mod exr;
pub mod png;
