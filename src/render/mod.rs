//! Path tracing of participating media made of fibres (Zhao 2012 §6, after Jakob 2010
//! and Heitz 2015).
//!
//! A [`Medium`] answers two questions: what is at a point, and how much can be on a
//! stretch of a ray. [`track`] makes free flights and shadows of that for anything that
//! is a [`Scatterer`]; [`path`] strings flights to paths with [`sggx`] scattering under the
//! light of a [`scene`](crate::scene); [`still::render`] sums paths on a
//! [`Film`](crate::film::Film), pass by pass, with the error reached.

pub mod blocks;
pub mod counters;
pub mod effects;
mod medium;
pub mod orders;
pub mod path;
pub mod settings;
pub mod sggx;
pub mod stack;
pub mod still;
pub mod track;

pub use blocks::{BLOCK, BlockLight, BlocksSeen, look_at_blocks};
pub use counters::Counters;
pub use medium::{Arrival, MajorantWalk, Medium, PLACE, SYSTEM, Stretch, Voxel};
pub use orders::{OrderHistogram, order_histogram};
pub use settings::{Background, Backing, RenderSettings};
pub use sggx::Fibre;
pub use stack::Stack;
pub use still::{Progress, RenderOutcome, render};
pub use track::{Both, Collision, Nothing, SECOND, Scatterer};
