//! How often blocks meet at a seam, in a fixed set of weaves.
//!
//! The basis of edge fixing is fitted to the seams that cloth really has. It belongs to
//! the exemplars, not to a design: so the pairs of blocks are counted in weaves that never
//! change, as synthesised and randomised by default.

use std::collections::BTreeMap;

use crate::design::{Lattice, WeavePattern};
use crate::job::Job;

use super::SynthesisError;
use super::assign::{Method, assign};
use super::catalogue::{Catalogue, Side};
use super::hash::hash;
use super::lookup::Placement;
use super::shift::Randomisation;

/// Two blocks side by side that do not continue each other, and how often they do so.
#[derive(Debug, Clone, Copy)]
pub(super) struct Meeting {
    /// The left or lower block.
    pub first: u16,
    /// The right or upper block.
    pub second: u16,
    pub count: u32,
}

/// Meetings of the corpus across vertical edges (`[0]`) and horizontal ones (`[1]`), in
/// the order of the blocks.
pub(super) fn meetings(
    catalogue: &Catalogue,
    job: &Job,
) -> Result<[Vec<Meeting>; 2], SynthesisError> {
    let mut counts = [BTreeMap::new(), BTreeMap::new()];
    let randomisation = Randomisation { seed: 1, patch: 3 };
    for pattern in weaves() {
        let lattice = Lattice::default();
        let assignment = assign(&pattern, lattice, catalogue, Method::Dp, 1, job)?;
        let placement = Placement {
            catalogue,
            assignment: &assignment,
            randomisation,
        };
        for pick in 0..i64::from(pattern.picks()) {
            for end in 0..i64::from(pattern.ends()) {
                let Some(first) = placement.block(end, pick) else {
                    continue;
                };
                for (axis, side) in [Side::Right, Side::Above].into_iter().enumerate() {
                    let (dx, dy) = side.offset();
                    let Some(second) = placement.block(end + dx, pick + dy) else {
                        continue;
                    };
                    if !catalogue.continues(first, side, second) {
                        *counts[axis].entry((first, second)).or_insert(0) += 1;
                    }
                }
            }
        }
    }
    Ok(counts.map(|counts| {
        let list = counts.into_iter();
        list.map(|((first, second), count)| Meeting {
            first,
            second,
            count,
        })
        .collect()
    }))
}

/// Wavy, pointed and broken twills, satins in blocks, plain mixtures, and noise.
fn weaves() -> Vec<WeavePattern> {
    let diagonal = |end: i64, pick: i64, period: i64, up: i64| (end - pick).rem_euclid(period) < up;
    let pattern = |ends: u32, picks: u32, warp_up: &dyn Fn(i64, i64) -> bool| {
        WeavePattern::from_fn(ends, picks, |end, pick| {
            warp_up(i64::from(end), i64::from(pick))
        })
    };
    let wave =
        |pick: i64| (6.0 * (pick as f64 * std::f64::consts::TAU / 96.0).sin()).round() as i64;
    let noise = |end: i64, pick: i64| hash(7, end as u64, pick as u64);
    vec![
        pattern(96, 96, &|end, pick| diagonal(end + wave(pick), pick, 8, 4)),
        pattern(96, 96, &|end, pick| diagonal(end + 2 * wave(pick), 0, 6, 2)),
        pattern(64, 64, &|end, pick| {
            diagonal((end % 32).min(31 - end % 32), pick, 5, 2)
        }),
        pattern(64, 64, &|end, pick| {
            diagonal((end % 32).min(31 - end % 32), pick, 5, 3)
        }),
        pattern(72, 72, &|end, pick| {
            diagonal(end, pick, 9, 1 + (end / 9 + pick / 9) % 8)
        }),
        pattern(80, 80, &|end, pick| {
            let tie = (3 * end - pick).rem_euclid(8) == 0;
            tie != ((end / 16 + pick / 16) % 2 == 0)
        }),
        pattern(80, 80, &|end, pick| {
            let tie = (2 * end - pick).rem_euclid(5) == 0;
            tie != ((end / 20 + pick / 20) % 2 == 0)
        }),
        pattern(60, 60, &|end, pick| {
            let plain = (end + pick) % 2 == 0;
            if (end / 10 + pick / 15) % 2 == 0 {
                plain
            } else {
                diagonal(end, -pick, 4, 2)
            }
        }),
        pattern(48, 48, &|end, pick| noise(end, pick) % 2 == 0),
        pattern(48, 48, &|end, pick| {
            diagonal(end, pick, 5, 2) != (noise(end, pick) % 16 == 0)
        }),
    ]
}
