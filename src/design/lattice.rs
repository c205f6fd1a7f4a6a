//! How a design repeats: straight, dropped, or not at all, per direction.

use serde::{Deserialize, Serialize};

/// How one direction repeats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Repeat {
    /// Each repeat stands beside the last.
    #[default]
    Straight,
    /// Each repeat is shifted by this many threads in the other direction.
    Dropped(u32),
    /// The cloth ends where the design ends.
    None,
}

/// The lattice by which a design of `ends` × `picks` crossings fills the cloth.
///
/// At most one direction may be dropped. One function, [`Lattice::wrap`], serves edits,
/// floats, synthesis and rendering.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Lattice {
    /// Along the weft: what happens past the last end.
    pub across: Repeat,
    /// Along the warp: what happens past the last pick.
    pub along: Repeat,
}

impl Lattice {
    /// The crossing of the design that lies at (end, pick) of the cloth; `None` where
    /// there is no cloth.
    pub fn wrap(self, end: i64, pick: i64, ends: u32, picks: u32) -> Option<(u32, u32)> {
        let (width, height) = (i64::from(ends), i64::from(picks));
        let (mut end, mut pick) = (end, pick);
        match self.across {
            Repeat::None if !(0..width).contains(&end) => return None,
            Repeat::Dropped(drop) => pick -= i64::from(drop) * end.div_euclid(width),
            _ => {}
        }
        match self.along {
            Repeat::None if !(0..height).contains(&pick) => return None,
            Repeat::Dropped(drop) => end -= i64::from(drop) * pick.div_euclid(height),
            _ => {}
        }
        Some((end.rem_euclid(width) as u32, pick.rem_euclid(height) as u32))
    }
}
