//! Path tracing of participating media made of fibres.

mod medium;

pub use medium::{Bounds, MajorantWalk, Medium, Ray, Stretch, Voxel};
