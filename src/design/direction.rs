//! Warp and weft.

/// One of the two directions of a cloth's threads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Ends: along +y.
    Warp = 0,
    /// Picks: along +x.
    Weft = 1,
}
