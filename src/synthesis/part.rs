//! The part of a large design that is assigned at once: the columns that a view shows.
//!
//! A column's blocks depend on five columns of the pattern and on nothing else, so the
//! columns of a part are those of the whole design, bit for bit. What is outside counts as
//! no cloth until it is asked for.

use std::ops::Range;

use super::SynthesisError;
use crate::design::{Lattice, Repeat};

/// The most crossings that are assigned at once (2²⁶, 128 MiB of blocks): twice the largest
/// loom file seen. Larger designs are assigned where one looks.
pub const MOST_AT_ONCE: u64 = 1 << 26;

/// A rectangle of crossings of the endless cloth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stretch {
    /// Its ends.
    pub ends: Range<i64>,
    /// Its picks.
    pub picks: Range<i64>,
}

impl Stretch {
    /// Whether all of another lies in it.
    pub fn holds(&self, other: &Self) -> bool {
        let within = |inner: &Range<i64>, outer: &Range<i64>| {
            outer.start <= inner.start && inner.end <= outer.end
        };
        within(&other.ends, &self.ends) && within(&other.picks, &self.picks)
    }

    /// The same with so many threads more all round.
    pub fn grown(&self, ends: i64, picks: i64) -> Self {
        let grow = |range: &Range<i64>, by: i64| {
            range.start.saturating_sub(by)..range.end.saturating_add(by)
        };
        Self {
            ends: grow(&self.ends, ends),
            picks: grow(&self.picks, picks),
        }
    }

    /// Which columns of a design of `ends` × `picks` lie in it, with all that continue in
    /// them along the warp.
    ///
    /// # Errors
    /// [`SynthesisError::TooWide`] for columns of more than [`MOST_AT_ONCE`] crossings.
    pub fn columns(
        &self,
        ends: u32,
        picks: u32,
        lattice: Lattice,
    ) -> Result<Vec<bool>, SynthesisError> {
        // Columns so many ends apart continue in each other.
        let apart = match lattice.along {
            Repeat::Dropped(by) => common_divisor(by, ends),
            Repeat::Straight | Repeat::None => ends,
        }
        .max(1);
        let mut classes = vec![false; apart as usize];
        let own = match lattice.across {
            Repeat::None => self.ends.start.max(0)..self.ends.end.min(i64::from(ends)),
            Repeat::Straight | Repeat::Dropped(_) => self.ends.clone(),
        };
        for end in own.take(apart as usize) {
            classes[end.rem_euclid(i64::from(apart)) as usize] = true;
        }
        let wanted: Vec<bool> = (0..ends)
            .map(|end| classes[(end % apart) as usize])
            .collect();
        let count = wanted.iter().filter(|&&wanted| wanted).count() as u64;
        if count * u64::from(picks) > MOST_AT_ONCE {
            return Err(SynthesisError::TooWide {
                ends: count,
                picks,
                most: MOST_AT_ONCE / u64::from(picks),
            });
        }
        Ok(wanted)
    }
}

fn common_divisor(mut a: u32, mut b: u32) -> u32 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn listed(stretch: &Stretch, ends: u32, lattice: Lattice) -> Vec<usize> {
        let columns = stretch.columns(ends, 10, lattice).unwrap();
        (0..columns.len()).filter(|&end| columns[end]).collect()
    }

    #[test]
    fn columns_follow_the_lattice() {
        let stretch = Stretch {
            ends: -2..3,
            picks: 0..4,
        };
        assert_eq!(listed(&stretch, 12, Lattice::default()), [0, 1, 2, 10, 11]);
        let panel = Lattice {
            across: Repeat::None,
            along: Repeat::Straight,
        };
        assert_eq!(listed(&stretch, 12, panel), [0, 1, 2]);
        let dropped = Lattice {
            across: Repeat::Straight,
            along: Repeat::Dropped(4),
        };
        let one = Stretch {
            ends: 5..6,
            picks: 0..1,
        };
        assert_eq!(listed(&one, 12, dropped), [1, 5, 9]);
    }

    #[test]
    fn every_column_that_a_view_meets_is_wanted() {
        for lattice in [
            Lattice::default(),
            Lattice {
                across: Repeat::Dropped(7),
                along: Repeat::Straight,
            },
            Lattice {
                across: Repeat::Straight,
                along: Repeat::Dropped(8),
            },
        ] {
            let stretch = Stretch {
                ends: 33..36,
                picks: -25..31,
            };
            let columns = stretch.columns(20, 10, lattice).unwrap();
            for end in stretch.ends.clone() {
                for pick in stretch.picks.clone() {
                    let (end, _) = lattice.wrap(end, pick, 20, 10).unwrap();
                    assert!(columns[end as usize], "{lattice:?} {end}");
                }
            }
            assert!(columns.contains(&false), "{lattice:?}: not all of them");
        }
    }

    #[test]
    fn a_view_of_too_much_is_refused_before_memory_is_asked_for() {
        let all = Stretch {
            ends: i64::MIN..i64::MAX,
            picks: 0..1,
        };
        let refused = all.columns(16_000, 20_000, Lattice::default());
        let message = refused.unwrap_err().to_string();
        assert!(message.contains("look closer"), "{message}");
        assert!(all.columns(1600, 2000, Lattice::default()).is_ok());
    }
}
