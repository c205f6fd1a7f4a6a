//! What a picture calls for: which effects change it by more than anybody cares about.
//!
//! [`settle`] looks at some blocks of the picture, scattered over all of it, before it is
//! traced, and leaves out what changes 95 of 100 of them by less than a tolerance: the sum of
//! the bounds of all that is left out stays below it. What it can bound is what only ever adds
//! light, as one look says how much that is: the orders of scattering beyond the n-th, and the
//! sky ([`look_at_blocks`](crate::render::look_at_blocks)). Effects that there is nothing of in
//! a design or a light are left out with a bound of nothing. [`survey`] looks at all others too,
//! with and without: that says what they change and cost, but not to a per cent, so that they
//! are never left out by that; [`survey_in_pictures`] shows it as well. [`afford`] does for a
//! [`Budget`](crate::plan::Budget) of time or of error what `settle` does for a tolerance, and
//! says beforehand what the picture will come to.

mod afford;
mod block_change;
mod pair;
mod settling;
mod survey;

pub use afford::{Promise, afford};
pub use block_change::upper_percentile;
pub use pair::Pair;
pub use settling::{Need, Needs, at_most, settle};
pub use survey::{survey, survey_in_pictures};
