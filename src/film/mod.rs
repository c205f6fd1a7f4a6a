//! What paths leave behind, and the picture that is made of it.
//!
//! A [`Film`] sums the [`Sample`]s of each pixel, with what is needed to say how far they are
//! from their mean: [`estimate`] gives the picture's [`error`]. [`mod@denoise`] smooths what is
//! left of it, guided by what the first hit was; [`tone`] makes a [`Picture`] for display. No
//! file is known here.

pub mod denoise;
pub mod error;
mod picture;
mod pixels;
pub mod tone;

pub use denoise::Denoise;
pub use error::{ErrorEstimate, estimate};
pub use picture::Picture;
pub use pixels::{Film, FirstHit, Pixel, Sample};
pub use tone::Tone;
