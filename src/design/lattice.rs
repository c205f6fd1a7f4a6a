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

/// A lattice that does not close.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("both directions are dropped: drop only one and let the other repeat straight")]
pub struct LatticeError;

impl Lattice {
    /// Refuses a lattice that is dropped both ways: its repeats would not tile.
    ///
    /// # Errors
    /// [`LatticeError`] if both directions are dropped by something.
    pub fn check(self) -> Result<(), LatticeError> {
        let dropped = |repeat| matches!(repeat, Repeat::Dropped(by) if by != 0);
        if dropped(self.across) && dropped(self.along) {
            return Err(LatticeError);
        }
        Ok(())
    }

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

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Where one repeat further across or along lands, in the endless cloth.
    fn next(lattice: Lattice, ends: u32, picks: u32) -> [(i64, i64); 2] {
        let (width, height) = (i64::from(ends), i64::from(picks));
        let drop = |repeat| match repeat {
            Repeat::Dropped(by) => i64::from(by),
            _ => 0,
        };
        [(width, drop(lattice.across)), (drop(lattice.along), height)]
    }

    proptest! {
        #[test]
        fn wrapping_is_the_same_one_repeat_further(
            ends in 1u32..40, picks in 1u32..40, by in 0u32..50, kind in 0..3,
            end in -500i64..500, pick in -500i64..500
        ) {
            let lattice = match kind {
                0 => Lattice::default(),
                1 => Lattice { across: Repeat::Dropped(by), along: Repeat::Straight },
                _ => Lattice { across: Repeat::Straight, along: Repeat::Dropped(by) },
            };
            let here = lattice.wrap(end, pick, ends, picks);
            prop_assert!(here.is_some_and(|(e, p)| e < ends && p < picks));
            for (across, along) in next(lattice, ends, picks) {
                prop_assert_eq!(lattice.wrap(end + across, pick + along, ends, picks), here);
            }
            // Inside the design nothing moves.
            if (0..i64::from(ends)).contains(&end) && (0..i64::from(picks)).contains(&pick) {
                prop_assert_eq!(here, Some((end as u32, pick as u32)));
            }
        }
    }

    #[test]
    fn a_dropped_repeat_is_not_a_straight_one() {
        let half = Lattice {
            across: Repeat::Dropped(3),
            along: Repeat::Straight,
        };
        assert_eq!(half.wrap(8, 0, 8, 6), Some((0, 3)));
        assert_eq!(Lattice::default().wrap(8, 0, 8, 6), Some((0, 0)));
    }

    #[test]
    fn a_panel_ends() {
        let panel = Lattice {
            across: Repeat::None,
            along: Repeat::Straight,
        };
        assert_eq!(panel.wrap(8, 0, 8, 6), None);
        assert_eq!(panel.wrap(-1, 0, 8, 6), None);
        assert_eq!(panel.wrap(7, -1, 8, 6), Some((7, 5)));
    }

    #[test]
    fn both_directions_dropped_are_refused() {
        let dropped = Repeat::Dropped(2);
        let both = Lattice {
            across: dropped,
            along: dropped,
        };
        assert_eq!(both.check(), Err(LatticeError));
        let one = Lattice {
            across: dropped,
            along: Repeat::None,
        };
        assert_eq!(one.check(), Ok(()));
    }
}
