//! What the designer makes: weave, yarns, where each yarn lies, sett and repeat.
//!
//! Zhao 2012 §5.1: a binary weave pattern, a warp and a weft yarn at every crossing,
//! and colour and gloss of each yarn. A [`Design`] holds these and resolves, for any
//! crossing of the endless cloth, which yarn is where and which lies on top.

mod lattice;
mod pattern;
mod yarn;

pub use lattice::{Lattice, Repeat};
pub use pattern::WeavePattern;
pub use yarn::{Family, Srgb, Yarn, YarnId};
